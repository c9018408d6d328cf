"""Which pairs of points are local minima of the distance of two boundaries, to first order.

At one no direction into a boundary leads towards the other point. The directions are those of a
face's tangents, of an edge and into its faces, of the corners and edges of a vertex.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from standoff.geometry.validation import Array
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import coedge_conormal
from standoff.kernels.solids.planar_tolerances import AT_OPTIMUM
from standoff.solids.spatial.minimum import leaf_jet_of
from standoff.solids.spatial.pair import Place, PlacedPair
from standoff.solids.spatial.sides import corner_of
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.tolerances import COLLAPSED_SIDE

# Directions that are looked into at a vertex that is a face's collapsed side.
WAYS_AROUND = 17


def is_stationary(pair: PlacedPair, place: Place, sine: float = AT_OPTIMUM) -> bool:
    """Can no small step on either boundary make a pair nearer along its normal, to first order?
    `sine`: of the angle by which one may."""
    n, row = place.normal, place.row
    return (
        _steepest(pair.a, int(row[1]), row[3:5], pair.ra.T @ n) <= sine
        and _steepest(pair.b, int(row[2]), row[5:7], -pair.rb.T @ n) <= sine
    )


def _steepest(solid: SolidModel, leaf: int, at: Array, n: Array) -> float:
    """The greatest component along n, own frame, of a unit direction into the boundary from a
    leaf's point."""
    part = solid.leaves[leaf]
    jet = leaf_jet_of(solid.packed, leaf, float(at[0]), float(at[1]))
    if part.dim == 2:
        normal = np.cross(jet[1], jet[2])
        size = float(np.linalg.norm(normal))
        return float(np.linalg.norm(np.cross(n, normal))) / size if size > 0.0 else 1.0
    if part.dim == 0:
        return _steepest_at_vertex(solid, part.feature, n)
    size = float(np.linalg.norm(jet[1]))
    if size == 0.0:
        return 1.0
    along = jet[1] / size
    ints, reals = solid.boundary.ints, solid.boundary.reals
    row = int(ints[L.EDGES]) + L.EDGE_STRIDE * (part.feature - solid.boundary.n_faces)
    tangent = (float(along[0]), float(along[1]), float(along[2]))
    ways = [
        np.array(coedge_conormal(ints, reals, int(ints[row + k]), tangent, float(at[0]))[0])
        for k in (L.EDGE_COEDGE_0, L.EDGE_COEDGE_1)
    ]
    return max(abs(float(along @ n)), *(float(way @ n) for way in ways))


class Fan(NamedTuple):
    """The directions into a boundary from a vertex, own frame.

    Attributes
    ----------
    ways : (n, 3) array
        Unit ones, along edges and into faces from collapsed sides.
    corners : (m, 3, 3) array
        Of each face's corner: the edge that leaves it, what is a quarter turn from there, and the
        one that arrives.
    angles : (m,) array
        From the first to the last, counterclockwise, radians.
    """

    ways: Array
    corners: Array
    angles: Array


def _steepest_at_vertex(solid: SolidModel, feature: int, n: Array) -> float:
    number = feature - solid.boundary.n_faces - solid.boundary.n_edges
    if number not in solid.vertex_fans:
        solid.vertex_fans[number] = _fan_of(solid, number)
    fan = solid.vertex_fans[number]
    found = float((fan.ways @ n).max(initial=-1.0))
    along = fan.corners @ n
    turned = np.arctan2(along[:, 1], along[:, 0]) % (2.0 * np.pi)
    within = turned <= fan.angles
    flat = np.hypot(along[:, 0], along[:, 1])
    return max(found, float(flat[within].max(initial=-1.0)))


def _fan_of(solid: SolidModel, vertex: int) -> Fan:
    ways, corners, angles = [], [], []
    for chart in range(int(solid.boundary.ints[L.N_CHARTS])):
        out, into, normal = corner_of(solid, chart, vertex)
        if normal is None:
            if into:
                ways += list(_ways_from_side(solid, chart, vertex))
            continue
        outward = normal / np.linalg.norm(normal)
        for a, b in zip(out, into, strict=False):
            across = np.cross(outward, a)
            ways += [a, b]
            corners.append([a, across, b])
            angles.append(np.arctan2(across @ b, a @ b) % (2.0 * np.pi))
    return Fan(
        np.reshape(ways, (-1, 3)), np.reshape(corners, (-1, 3, 3)), np.array(angles, dtype=float)
    )


def _ways_from_side(solid: SolidModel, chart: int, vertex: int) -> Array:
    """Unit directions (n, 3) into a face from its side that is collapsed to a vertex."""
    point = np.asarray(solid.boundary.vertex_points[vertex], dtype=float)
    found = [np.empty((0, 3))]
    for k, leaf in enumerate(solid.leaves):
        if leaf.dim != 2 or leaf.chart != chart:
            continue
        rect = leaf.reals[:4]
        for side in range(4):
            across, other = divmod(side, 2)
            first, last = rect[2 - 2 * across : 4 - 2 * across].tolist()
            spots = np.linspace(first, last, WAYS_AROUND)
            level = np.full(WAYS_AROUND, rect[side])
            where = (level, spots) if across == 0 else (spots, level)
            jets = [leaf_jet_of(solid.packed, k, u, v) for u, v in zip(*where, strict=True)]
            if np.linalg.norm(jets[0][0] - point) > COLLAPSED_SIDE * solid.size:
                continue
            if np.linalg.norm(jets[-1][0] - point) > COLLAPSED_SIDE * solid.size:
                continue
            ways = np.array([jet[1 + across] for jet in jets]) * (1.0 - 2.0 * other)
            sizes = np.linalg.norm(ways, axis=1)
            found.append(ways[sizes > 0.0] / sizes[sizes > 0.0, None])
    return np.concatenate(found)
