"""A body as a shaded solid at a pose: only what faces the viewer, which is enough if convex."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.drawing.body_view import LIGHT, Space, across, seen_points
from standoff.bodies.features import Feature
from standoff.bodies.tessellation import EdgeLine, edge_lines, face_meshes
from standoff.errors import of_extra
from standoff.typing import Array

with of_extra("matplotlib", "plot"):
    from matplotlib.colors import to_rgb
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

DIRECTIONS = 1500
"""Number of directions in which a swept body's surface is drawn."""

DARKEST = 0.55
"""Brightness of what is seen against the light, as a fraction of its colour."""

NO_FACE = -1
"""Face number of the triangles of a swept surface."""


@dataclass(frozen=True)
class PictureSurface:
    """A body's surface for pictures, in its own frame.

    Attributes
    ----------
    body : Body
    points, normals : (n, 3) arrays
        Points of the surface, including the swept radius, and the outward unit normals there.
    triangles : (m, 3) array of int
    faces : (m,) array of int
        The face to which each triangle belongs.
    lines : sequence of EdgeLine
        The edges of a body without a radius.
    """

    body: Body
    points: Array
    normals: Array
    triangles: NDArray[np.int64]
    faces: NDArray[np.int64]
    lines: Sequence[EdgeLine]


class Look(NamedTuple):
    """How a solid is drawn: two colours, the second for its active feature; order and opacity."""

    colour: str
    active_colour: str
    order: int
    opacity: float


def solid_of(body: Body) -> PictureSurface:
    """Return a body's surface: its faces, or the envelope of the ball swept over its core."""
    meshes, lines = face_meshes(body, fine=True), edge_lines(body)
    cloud = [body.vertex_points, *(line.points for line in lines), *(m.points for m in meshes)]
    if body.radius and body.dimension == 3:
        return _swept(body, np.concatenate(cloud))
    if not meshes:
        none = np.zeros((0, 3))
        empty = np.zeros((0, 3), dtype=np.int64)
        # the outline of a planar body, or a core that is a point or a segment
        return PictureSurface(body, np.concatenate([none, *cloud]), none, empty, empty[:, 0], lines)
    first = np.cumsum([0, *(len(mesh.points) for mesh in meshes[:-1])])
    return PictureSurface(
        body,
        np.concatenate([mesh.points for mesh in meshes]),
        np.concatenate([mesh.normals for mesh in meshes]),
        np.concatenate([m.triangles + k for m, k in zip(meshes, first, strict=True)]),
        np.concatenate([np.full(len(mesh.triangles), mesh.face) for mesh in meshes]),
        lines,
    )


def _swept(body: Body, cloud: Array) -> PictureSurface:
    """The farthest point of the swept body in each of many directions, and their hull."""
    k = np.arange(DIRECTIONS) + 0.5
    height, turn = 1.0 - 2.0 * k / DIRECTIONS, np.pi * (1.0 + np.sqrt(5.0)) * k
    level = np.sqrt(1.0 - height**2)
    normals = np.column_stack([level * np.cos(turn), level * np.sin(turn), height])
    points = cloud[(normals @ cloud.T).argmax(axis=1)] + body.radius * normals
    # QJ: many of them lie in the planes of flat faces.
    triangles = scipy.spatial.ConvexHull(points, qhull_options="QJ").simplices.astype(np.int64)
    return PictureSurface(body, points, normals, triangles, np.full(len(triangles), NO_FACE), [])


def draw_solid(
    axes: Space,
    solid: PictureSurface,
    pose: Array,
    towards: Array,
    look: Look,
    active: Feature | None,
) -> None:
    """Draw what a viewer sees of a solid.

    Parameters
    ----------
    axes : Axes3D
    solid : PictureSurface
    pose : (12,) array
        World pose of its body: R row-major, p.
    towards : (3,) array
        Unit vector from the scene to the viewer.
    look : Look
    active : Feature or None
        Drawn in the second colour.
    """
    rotation, shift = pose[:9].reshape(3, 3), pose[9:]
    if len(solid.triangles):
        _draw_skin(axes, solid, (rotation, shift), towards, look, active)
    for line in solid.lines:
        points = line.points @ rotation.T + shift
        seen = seen_points(line.normals @ rotation.T, towards)
        chosen = active == Feature("edge", line.edge)
        if line.smooth and not chosen:
            continue
        axes.plot(
            *np.where(seen[:, None], points, np.nan).T,
            color=look.active_colour if chosen else "black",
            linewidth=2.6 if chosen else 0.9,
            zorder=look.order + 1,
        )
    if not len(solid.triangles) and not solid.lines:
        spots = solid.points @ rotation.T + shift
        axes.plot(*spots.T, "o", color=look.active_colour, markersize=5.0, zorder=look.order + 1)


def _draw_skin(
    axes: Space,
    solid: PictureSurface,
    pose: tuple[Array, Array],
    towards: Array,
    look: Look,
    active: Feature | None,
) -> None:
    rotation, shift = pose
    points, normals = solid.points @ rotation.T + shift, solid.normals @ rotation.T
    corners, upright = points[solid.triangles], normals[solid.triangles].mean(axis=1)
    # Also the triangles that the outline crosses: without them it would be jagged.
    seen = (normals @ towards > 0.0)[solid.triangles].any(axis=1)
    right, up = across(towards)
    lamp = LIGHT @ np.array([right, towards, up])
    lengths = np.maximum(np.linalg.norm(upright[seen], axis=1), np.finfo(float).tiny)
    bright = DARKEST + (1.0 - DARKEST) * np.clip(upright[seen] @ lamp / lengths, 0.0, 1.0)
    chosen = active is not None and active.kind == "face"
    of_active = (solid.faces[seen] == active.index) if chosen and active else np.zeros(len(bright))
    plain, strong = np.array(to_rgb(look.colour)), np.array(to_rgb(look.active_colour))
    shaded = bright[:, None] * np.where(of_active[:, None] > 0, strong, plain)
    axes.add_collection3d(
        Poly3DCollection(
            corners[seen],
            facecolors=shaded,
            # without them, hairlines show between the triangles; with opacity they would show twice
            edgecolors=shaded if look.opacity == 1.0 else "none",
            linewidths=0.3,
            alpha=look.opacity,
            zorder=look.order,
        )
    )
