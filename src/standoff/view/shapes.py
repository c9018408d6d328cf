"""What of a body is shown on a page, as arrays of its own frame; distances never use them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import scipy

from standoff.bodies.boundary import Boundary
from standoff.bodies.features import Feature
from standoff.bodies.tessellation import FaceMesh, edge_lines, face_meshes
from standoff.solids.planar.loops import points_along
from standoff.solids.planar.solid import PlanarSolid
from standoff.typing import Array, Ints
from standoff.view.tolerances import LIFT
from standoff.world.shapes import boundary_of

DIRECTIONS = 1500
"""Directions in which the skin of a swept body is drawn."""


class ShownTriangles(NamedTuple):
    """Triangles: points (n, 3) and the numbers of their corners (m, 3)."""

    points: Array
    triangles: Ints


@dataclass(frozen=True)
class ShownShape:
    """A body as it is shown.

    Attributes
    ----------
    body : Boundary or PlanarSolid
    skin : ShownTriangles or None
        The whole surface; None of a planar body, and of a point or segment without a radius.
    faces : dict of int to Mesh
        Of each face, swept radius included and a little off the skin.
    edges : dict of int to (n, 3) array
        Points along each edge, on the core or, of a swept body, on its skin where faces meet it.
    drawn : tuple of int
        The edges that are seen: not those over which the surface is smooth.
    vertices : (n, 3) array
    size : float
        Diagonal of the box around all that is shown [length].
    middle : (3,) array
        Of that box.
    """

    body: Boundary | PlanarSolid
    skin: ShownTriangles | None
    faces: dict[int, ShownTriangles]
    edges: dict[int, Array]
    drawn: tuple[int, ...]
    vertices: Array
    size: float
    middle: Array

    @property
    def radius(self) -> float:
        """Swept over the body [length]; 0 of a planar solid."""
        return self.body.radius if isinstance(self.body, Boundary) else 0.0

    def segments(self) -> Array:
        """Return all edges that are seen as pieces of line, (n, 2, 3)."""
        pieces = [_pieces(self.edges[number]) for number in self.drawn]
        return np.concatenate(pieces) if pieces else np.zeros((0, 2, 3))

    def of(self, feature: Feature) -> ShownTriangles | Array:
        """Return what is highlighted of a feature: triangles, pieces of line, or one point (3,)."""
        if feature.kind == "face":
            return self.faces.get(
                feature.index, ShownTriangles(np.zeros((0, 3)), np.zeros((0, 3), int))
            )
        if feature.kind == "edge":
            return _pieces(self.edges[feature.index])
        if not feature.kind:  # beyond the horizon
            return ShownTriangles(np.zeros((0, 3)), np.zeros((0, 3), int))
        point: Array = self.vertices[feature.index]
        return point


def shape_of(given: Any) -> ShownShape:
    """Return what is shown of a body.

    Parameters
    ----------
    given : Body, Solid, PlanarSolid or Boundary
        Of a solid that need not be convex its boundary is shown.

    Returns
    -------
    Shape
    """
    body = boundary_of(given)
    if hasattr(body, "outline"):
        return _flat_shape(body)
    meshes, lines = face_meshes(body, fine=True), edge_lines(body)
    vertices = np.asarray(body.vertex_points, dtype=float).reshape(-1, 3)
    cloud = [vertices, *(line.points for line in lines), *(mesh.points for mesh in meshes)]
    points = np.concatenate(cloud)
    low, high = points.min(axis=0) - body.radius, points.max(axis=0) + body.radius
    size = float(np.linalg.norm(high - low)) or 1.0
    swept = body.radius > 0.0 and body.dimension == 3
    skin = _swept(points, body.radius) if swept else _joined(meshes)
    return ShownShape(
        body,
        skin,
        {face: _lifted(meshes, face, body.radius, LIFT * size) for face in range(body.n_faces)},
        {line.edge: line.points for line in lines},
        # The edges of a swept body's core lie inside it.
        () if swept else tuple(line.edge for line in lines if not line.smooth),
        vertices,
        size,
        0.5 * (low + high),
    )


def _flat_shape(solid: PlanarSolid) -> ShownShape:
    """Of a planar solid its edges, as of any planar body."""
    lines = [line for loop in solid.loops for line in points_along(loop)]
    low, high = np.min([x.min(0) for x in lines], 0), np.max([x.max(0) for x in lines], 0)
    edges = dict(enumerate(lines))
    vertices = np.array([line[0] for line in lines])
    size, middle = float(np.linalg.norm(high - low)), 0.5 * (low + high)
    return ShownShape(solid, None, {}, edges, tuple(edges), vertices, size, middle)


def _pieces(points: Array) -> Array:
    return np.stack([points[:-1], points[1:]], axis=1)


def _joined(meshes: list[FaceMesh]) -> ShownTriangles | None:
    if not meshes:
        return None
    firsts = np.cumsum([0, *(len(mesh.points) for mesh in meshes[:-1])])
    triangles = [mesh.triangles + k for mesh, k in zip(meshes, firsts, strict=True)]
    whole = ShownTriangles(np.concatenate([m.points for m in meshes]), np.concatenate(triangles))
    return _outward(whole, np.concatenate([mesh.normals for mesh in meshes]))


def _outward(mesh: ShownTriangles, normals: Array) -> ShownTriangles:
    """The same triangles, each counterclockwise as seen from outside."""
    corners = mesh.points[mesh.triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    turned = np.einsum("ij,ij->i", across, normals[mesh.triangles].sum(axis=1)) < 0.0
    triangles = np.where(turned[:, None], mesh.triangles[:, ::-1], mesh.triangles)
    return ShownTriangles(mesh.points, triangles)


def _lifted(meshes: list[FaceMesh], face: int, radius: float, lift: float) -> ShownTriangles:
    own = [mesh for mesh in meshes if mesh.face == face]
    whole = _joined(own)
    if whole is None:
        return ShownTriangles(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))
    normals = np.concatenate([mesh.normals for mesh in own])
    return ShownTriangles(whole.points + (radius + lift) * normals, whole.triangles)


def _swept(cloud: Array, radius: float) -> ShownTriangles:
    """The farthest point of the swept body in each of many directions, and their hull."""
    k = np.arange(DIRECTIONS) + 0.5
    height, turn = 1.0 - 2.0 * k / DIRECTIONS, np.pi * (1.0 + np.sqrt(5.0)) * k
    level = np.sqrt(1.0 - height**2)
    normals = np.column_stack([level * np.cos(turn), level * np.sin(turn), height])
    points = cloud[(normals @ cloud.T).argmax(axis=1)] + radius * normals
    # QJ: many of them lie in the planes of flat faces.
    triangles = scipy.spatial.ConvexHull(points, qhull_options="QJ").simplices.astype(np.int64)
    return _outward(ShownTriangles(points, triangles), normals)
