"""Local minima of the distance of two solids in space: of the pairs that a search found, those that
are one, each once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.entries.minima import greatest_gap
from standoff.kernels.entries.queries import on_face
from standoff.kernels.solids.spatial_progress import BOUND
from standoff.kernels.solids.spatial_tolerances import SURE_NORMAL, VALLEY
from standoff.solids.spatial.minimum import Found, leaf_jet_of
from standoff.solids.spatial.pair import Place, PlacedPair
from standoff.solids.spatial.points import distance_to_boundary
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.stationary import is_minimum
from standoff.solids.spatial.ties import same_as, spots_of
from standoff.typing import Array

# Where between two pairs the boundaries are looked at: what is half way may be on another piece of
# them by symmetry.
BETWEEN = np.array([0.5, 0.19, 0.81])


def local_minima(pair: PlacedPair, found: Found, senses: tuple[int, int]) -> list[Place]:
    """All that were found, the nearest first; of each set of nearest pairs one."""
    places = pair.places([found.best, *found.minima], senses)
    places = [each for k, each in enumerate(places) if k == 0 or is_minimum(pair, each)]
    spots = spots_of(places)

    def same(k: int) -> NDArray[np.bool_]:
        near = np.abs(spots[:k, 6] - spots[k, 6]) <= found.tolerance
        return np.asarray(near & same_as(spots, k, pair.size)[:k])

    sets = _sets(len(places), [(same, lambda k, i: True)])
    single = [_best(pair, [places[i] for i in each]) for each in sets]
    distances = np.array([place.distance for place in single])
    parts = np.unique(_parts_of(pair, single), axis=0, return_inverse=True)[1].ravel()

    def tied(k: int) -> NDArray[np.bool_]:
        return np.asarray(np.abs(distances[:k] - distances[k]) <= found.tolerance)

    def tied_alike(k: int) -> NDArray[np.bool_]:
        return np.asarray(tied(k) & (parts[:k] == parts[k]))

    def joined(k: int, i: int) -> bool:
        most = float(max(distances[k], distances[i])) + found.tolerance
        alike = bool(parts[k] == parts[i])
        return _greatest_gap(pair, single[k], single[i], alike, most) <= most

    # what is on the same parts of the boundaries first, as it takes least
    sets = _sets(len(single), [(tied_alike, joined), (tied, joined)])
    return [_best(pair, [single[i] for i in each]) for each in sets]


def _sets(
    n: int, passes: Sequence[tuple[Callable[[int], NDArray[np.bool_]], Callable[[int, int], bool]]]
) -> list[list[int]]:
    """Those of `n` that are one, or one with others that are; sets in the order of their first.
    `passes`: which before the k-th may be one with it, and whether two are."""
    first = np.arange(n)
    for may_be, are_one in passes:
        for k in range(n):
            for i in np.flatnonzero(may_be(k) & (first[:k] != first[k])).tolist():
                low, high = sorted((first[i], first[k]))
                if low < high and are_one(k, i):
                    first[first == high] = low
    return [np.flatnonzero(first == k).tolist() for k in np.unique(first)]


def _parts_of(pair: PlacedPair, places: Sequence[Place]) -> NDArray[np.int64]:
    """The parts of both boundaries, and the charts, that places are on: rows (n, 4)."""
    leaves = np.array([place.row[1:3] for place in places]).astype(np.int64)
    sides = [solid.leaf_table.chart[leaves[:, k]] for k, solid in enumerate((pair.a, pair.b))]
    return np.concatenate(sides, axis=1)


def _best(pair: PlacedPair, places: list[Place]) -> Place:
    """The nearest of some that are one, with the best bound that any of their pieces has; of those
    as near up to rounding the one on features with the fewest parameters."""
    least = min(place.distance for place in places)

    def rank(place: Place) -> tuple[bool, int]:
        dims = (solid.leaves[int(place.row[1 + k])].dim for k, solid in enumerate((pair.a, pair.b)))
        return place.distance > least + VALLEY * pair.size, sum(dims)

    best = min(places, key=rank)
    row = best.row.copy()
    row[0] = least
    row[BOUND] = max(float(place.row[BOUND]) for place in places)
    return replace(best, row=row)


def _greatest_gap(pair: PlacedPair, place: Place, other: Place, alike: bool, most: float) -> float:
    """How far those between two pairs are apart, at most, as far as it matters whether this is more
    than `most`. `alike`: on the same parts."""
    if alike:
        rows = np.array([place.row[:7], other.row[:7]])
        return float(greatest_gap((pair.a.packed, pair.b.packed), pair.relative, rows, BETWEEN))
    gap = 0.0
    for share in BETWEEN:
        if gap <= most:
            gap = max(gap, _gap_between(pair, place, other, float(share)))
    return gap


def _gap_between(pair: PlacedPair, place: Place, other: Place, share: float) -> float:
    """How far two points are apart that are on the boundaries, a share of the way from one pair's
    to the other's; infinite where there are none."""
    spots = []
    for side, (solid, turn, shift) in enumerate(
        ((pair.a, pair.ra, pair.pa), (pair.b, pair.rb, pair.pb))
    ):
        spot = _between(solid, side, place.row, other.row, share)
        if spot is None:
            return float(np.inf)
        spots.append(spot @ turn.T + shift)
    return float(np.linalg.norm(spots[1] - spots[0]))


def _between(solid: SolidModel, side: int, row: Array, other: Array, share: float) -> Array | None:
    """The point a share of the way between two points, own frame: by the parameters of one feature,
    or else straight ahead. None where that is not on the boundary."""
    leaves = int(row[1 + side]), int(other[1 + side])
    start, end = (each[3 + 2 * side : 5 + 2 * side] for each in (row, other))
    at = (1.0 - share) * start + share * end
    parts = [solid.leaves[leaf] for leaf in leaves]
    if solid.part_of(leaves[0]) == solid.part_of(leaves[1]) and parts[0].chart == parts[1].chart:
        if parts[0].dim == 2:
            ints, reals = solid.boundary.ints, solid.boundary.reals
            if not on_face(ints, reals, parts[0].chart, float(at[0]), float(at[1])):
                return None
        return np.asarray(leaf_jet_of(solid.packed, leaves[0], float(at[0]), float(at[1]))[0])
    ends = [
        leaf_jet_of(solid.packed, leaf, *each)[0]
        for leaf, each in zip(leaves, (start, end), strict=True)
    ]
    spot = (1.0 - share) * ends[0] + share * ends[1]
    off = distance_to_boundary(solid, spot).upper
    return np.asarray(spot) if off <= SURE_NORMAL * solid.size else None
