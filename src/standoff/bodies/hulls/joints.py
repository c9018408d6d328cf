"""How faces of a polyhedron meet: turns of edges, cones of vertices, wide corners of faces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from standoff.bodies.hulls.polyhedron import Polyhedron
from standoff.bodies.tolerances import LEAST_AXIS, WIDE_ANGLE
from standoff.typing import Array, Ints

# Corrections of an axis amid a vertex's normals.
AXIS_STEPS = 32


class VertexCones(NamedTuple):
    """Normals of the faces around vertices.

    Attributes
    ----------
    counts : (v,) how many each vertex has.
    faces : (k,) the faces, vertex by vertex, each vertex's in their order around it.
    """

    counts: Ints
    faces: Ints


class WideCorners(NamedTuple):
    """Corners of faces of 180 degrees or more, by vertices ascending.

    Attributes
    ----------
    vertices, faces : (n,) their numbers.
    spots : (n, 2) parameters (u, v).
    spans : (n, 2) directions in (u, v) between which the face is, radians.
    """

    vertices: Ints
    faces: Ints
    spots: Array
    spans: Array


def edge_turns(solid: Polyhedron) -> Array:
    """(e,) the angle from one outward normal to the other, positive where an edge is convex."""
    normals = solid.normals
    one, other = (normals[solid.faces_of_edges[:, k]] for k in range(2))
    along = solid.vertices[solid.ends[:, 1]] - solid.vertices[solid.ends[:, 0]]
    along *= solid.senses[solid.sides[:, 0], None] / np.linalg.norm(along, axis=1)[:, None]
    inward = np.cross(one, along)
    across = -np.einsum("ij,ij->i", inward, other)
    return np.asarray(np.arctan2(across, np.einsum("ij,ij->i", one, other)))


def vertex_cones(solid: Polyhedron) -> VertexCones:
    """The faces around every vertex; the certificate pairs neighbours.

    Three or fewer are neighbours in any order, and keep that of their numbers.
    """
    owners, n = solid.owners, len(solid.vertices)
    counts = np.bincount(solid.corners, minlength=n)
    order = np.argsort(solid.corners, kind="stable")
    at, faces = solid.corners[order], owners[order]
    normals = solid.normals[faces]
    begins = np.concatenate([[0], np.cumsum(counts)[:-1]])
    axes = np.add.reduceat(normals, begins)
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    x = np.cross(axes, np.eye(3)[np.abs(axes).argmin(axis=1)])
    y = np.cross(axes, x)
    angle = np.arctan2(np.einsum("ij,ij->i", normals, y[at]), np.einsum("ij,ij->i", normals, x[at]))
    angle[counts[at] < 4] = 0.0
    return VertexCones(counts, faces[np.lexsort((angle, at))])


def wide_corners(solid: Polyhedron, pcurves: Array) -> WideCorners:
    """The corners that edges alone do not bound (see ``kernels.body.layout``)."""
    steps = pcurves[:, :, 0] * solid.senses[:, None]
    spots = np.where((solid.senses > 0)[:, None], pcurves[:, :, 2], pcurves.sum(axis=2))
    before = np.arange(-1, len(solid.corners) - 1)
    before[solid.starts[:-1]] = solid.starts[1:] - 1
    out, back = steps, -steps[before]
    size = np.linalg.norm(out, axis=1) * np.linalg.norm(back, axis=1)
    turn = out[:, 0] * back[:, 1] - out[:, 1] * back[:, 0]
    same = np.einsum("ij,ij->i", out, back)
    # by the turn from the way out to the way back: below half a turn it is positive
    wide = (turn < 0.0) | ((np.abs(turn) <= WIDE_ANGLE * size) & (same < 0.0))
    places = np.flatnonzero(wide)
    places = places[np.argsort(solid.corners[places], kind="stable")]
    start = np.arctan2(out[places, 1], out[places, 0])
    stop = np.arctan2(back[places, 1], back[places, 0])
    width = (stop - start) % (2.0 * np.pi)
    return WideCorners(
        solid.corners[places],
        solid.owners[places],
        spots[places],
        np.column_stack([start, start + width]),
    )


def widening(solid: Polyhedron, turns: Array, cones: VertexCones) -> float:
    """1/h, h the least cosine between normals that meet and the axis of their cone, as
    ``convexity.widening`` has it; inf where a cone is too wide."""
    normals = solid.normals[cones.faces]
    begins = np.concatenate([[0], np.cumsum(cones.counts)[:-1]])
    at = np.repeat(np.arange(len(cones.counts)), cones.counts)
    axes = np.add.reduceat(normals, begins)
    best = np.zeros(len(begins))
    for k in range(AXIS_STEPS):
        length = np.linalg.norm(axes, axis=1)
        axes /= np.where(length > 0.0, length, 1.0)[:, None]
        cosines = np.einsum("ij,ij->i", normals, axes[at])
        least = np.minimum.reduceat(cosines, begins)
        best = np.maximum(best, least)
        # the normal farthest from the axis, the first of several
        farthest = np.flatnonzero(cosines == least[at])
        _, first = np.unique(at[farthest], return_index=True)
        axes += normals[farthest[first]] / (k + 2.0)
    lowest = min(1.0, float(best.min()), float(np.cos(0.5 * max(turns.max(), 0.0))))
    return 1.0 / lowest if lowest > LEAST_AXIS else np.inf
