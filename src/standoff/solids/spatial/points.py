"""Points and solids: proven signed distances, many at once."""

from __future__ import annotations

import threading
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.body import layout as L
from standoff.kernels.entries.solid_points import point_depth, side_beside
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.point_depth import MOST_PLACES
from standoff.kernels.solids.torus_potential import CENTRE_OF
from standoff.solids.asked import DEADLINE
from standoff.solids.spatial.minimum import (
    EITHER,
    IDENTITY,
    LeastFound,
    SearchOptions,
    leaf_jet_of,
    least_distance,
    scratch,
    started,
)
from standoff.solids.spatial.sides import number_of, outside_direction, vertex_normals_of
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.tolerances import PROOF_ROUNDING, PROOF_TOLERANCE, SAME_SPOT
from standoff.typing import Array


class PointDistances(NamedTuple):
    """Signed distances of n points from a solid's boundary.

    Attributes
    ----------
    distance : (n,) array
        Length, negative inside.
    lower_bound, upper_bound : (n,) arrays
        Proven, of the signed distance.
    gradient : (n, 3) array
        Unit vectors, own frame: how the distance grows; zero on the boundary itself where it has
        none. At a point with several nearest ones it is that of one of them.
    nearest : (n, 3) array
        On the boundary, own frame.
    converged : (n,) array of bool
        Are the bounds within the tolerance?
    smooth : (n,) array of bool
        Was only one nearest point found?
    evaluations : (n,) array of int
        Of points and bounds, which it took.
    """

    distance: Array
    lower_bound: Array
    upper_bound: Array
    gradient: Array
    nearest: Array
    converged: NDArray[np.bool_]
    smooth: NDArray[np.bool_]
    evaluations: NDArray[np.int64]


def packed_point() -> tuple[NDArray[np.int64], Array, NDArray[np.int64], Array]:
    """The origin as a solid that consists of one vertex, for the compiled search."""
    ints = np.zeros(L.INT_HEADER + L.VERTEX_STRIDE, dtype=np.int64)
    ints[L.DIMENSION], ints[L.N_VERTICES], ints[L.VERTICES] = 3, 1, L.INT_HEADER
    ints[L.INT_HEADER + L.VERTEX_REALS] = L.REAL_HEADER
    reals = np.zeros(L.REAL_HEADER + 3)
    own = np.zeros(S.INT_HEADER + S.LEAF_INTS + S.NODE_INTS, dtype=np.int64)
    own[S.N_LEAVES] = own[S.N_NODES] = 1
    own[S.LEAVES], own[S.NODES] = S.INT_HEADER, S.INT_HEADER + S.LEAF_INTS
    own[S.R_LEAVES], own[S.R_NODES] = S.REAL_HEADER, S.REAL_HEADER + S.LEAF_STRIDE
    own[S.LEAVES] = S.INT_HEADER
    own[S.INT_HEADER + S.CHART], own[S.INT_HEADER + S.NATURAL] = -1, CENTRE_OF
    own[own[S.NODES] :] = [-1, -1, 0]
    numbers = np.zeros(S.REAL_HEADER + S.LEAF_STRIDE + S.NODE_REALS)
    numbers[S.REAL_HEADER + S.NATURAL_REALS] = 1.0
    numbers[S.REAL_HEADER + S.NATURAL_REALS + 6 :][:3] = [0.0, 0.0, 1.0]
    node = numbers[S.REAL_HEADER + S.LEAF_STRIDE :]
    node[S.AXES : S.AXES + 9] = np.eye(3).ravel()
    node[S.N_OUT : S.N_OUT + 4] = node[S.N_IN : S.N_IN + 4] = [0.0, 0.0, 1.0, np.pi]
    for array in (ints, reals, own, numbers):
        array.flags.writeable = False
    return ints, reals, own, numbers


POINT = packed_point()


def distance_to_boundary(solid: SolidModel, point: Array) -> LeastFound:
    """From one point, own frame, without a sign."""
    # the solid is seen from the point, which is the origin
    pose = np.concatenate([IDENTITY[:9], -point])
    return least_distance(POINT, solid.packed, pose, (EITHER, EITHER), solid.size)


def depth_beside(
    solid: SolidModel, point: Array, about: float, counts: NDArray[np.int64] | None = None
) -> tuple[float, Array]:
    """(how deep a point is inside, at least; the nearest point of the boundary), own frame, where
    the boundary is known to be no farther than `about`, length. Below 0: it is outside, or on it.

    It is proven to a share of itself only, which takes a tenth of the time.
    """
    best, minima = started(SearchOptions(0.0), solid.size, 0.0)
    told, asked = np.empty(5), [about, solid.size, PROOF_ROUNDING, PROOF_TOLERANCE, DEADLINE]
    point_depth(
        solid.packed,
        POINT,
        vertex_normals_of(solid).ravel(),
        np.array([*point, *asked]),
        (best, minima, told),
        scratch(threading.get_ident()),
        np.zeros(8, dtype=np.int64) if counts is None else counts,
    )
    side = float(told[0])
    if side == 0.0:  # within the tolerance of the boundary it has no side
        near = float(told[1]) <= PROOF_TOLERANCE * solid.size
        side = 1.0 if near else _by_ray(solid, point)
    return -side * float(told[1]), told[2:]


def signed_distances(solid: SolidModel, points: Array) -> PointDistances:
    """As `Solid.signed_distance`."""
    n = len(points)
    distance, low, high = np.zeros((3, n))
    gradient, nearest = np.zeros((2, n, 3))
    converged, smooth = np.zeros((2, n), dtype=bool)
    evaluations = np.zeros(n, dtype=np.int64)
    for k, point in enumerate(points):
        found = distance_to_boundary(solid, point)
        leaf, u, v = int(found.best[2]), found.best[5], found.best[6]
        at = leaf_jet_of(solid.packed, leaf, u, v)[0]
        away = point - at
        length = float(np.linalg.norm(away))
        on_it = found.met or length <= found.tolerance
        sign = 1.0 if on_it else side_of(solid, found.best, found.minima, point)
        least = 0.0 if on_it else found.lower
        distance[k] = sign * found.upper
        bounds = sign * np.array([least, found.upper])
        low[k], high[k] = bounds.min(), bounds.max()
        if on_it:
            low[k], high[k] = -found.tolerance, max(found.upper, found.tolerance)
            direction = outside_direction(solid, leaf, float(u), float(v))
            gradient[k] = 0.0 if direction is None else direction
        else:
            gradient[k] = sign * away / length
        if not on_it and found.lower <= 0.0:
            low[k], high[k] = -found.upper, found.upper  # a nearer place may be on the other side
        nearest[k] = at
        converged[k] = high[k] - low[k] <= 3.0 * found.tolerance
        smooth[k] = _alone(solid, found) and not on_it
        evaluations[k] = found.told.evaluations
    return PointDistances(distance, low, high, gradient, nearest, converged, smooth, evaluations)


def side_of(solid: SolidModel, best: Array, others: Array, point: Array) -> float:
    """+1 for a point outside, -1 inside, by the nearest places of the boundary.

    A nearest place on a side of a face may be found as one of that face, whose plane may hold the
    point: so only a place decides from which the point is along the normal, or clearly on one side
    of an edge's or a vertex's normals. At an edge's end the point may be off across it, and the
    vertex decides. A ray decides where none does.
    """
    rows = np.array([best[:7], *others[:MOST_PLACES, :7]])
    leaves = {int(leaf) for leaf in rows[:, 2]}
    vertices = [number_of(solid, leaf) for leaf in leaves if solid.leaves[leaf].dim == 0]
    normals = vertex_normals_of(solid, vertices).ravel()
    return float(side_beside(solid.packed, normals, rows, point)) or _by_ray(solid, point)


def _by_ray(solid: SolidModel, point: Array) -> float:
    return -1.0 if solid.rays.inside(point) else 1.0


def _alone(solid: SolidModel, found: LeastFound) -> bool:
    """Are all nearest points that were found one point?"""
    spots = np.array(
        [leaf_jet_of(solid.packed, int(r[2]), r[5], r[6])[0] for r in found.minima[:16]]
    )
    return len(spots) < 2 or float(np.ptp(spots, axis=0).max()) <= SAME_SPOT * solid.size
