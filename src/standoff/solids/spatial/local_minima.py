"""Local minima of the distance of two solids in space: of the pairs that a search found, those that
are one, each once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from standoff.geometry.validation import Array
from standoff.kernels.entries.queries import on_face
from standoff.kernels.solids.spatial_progress import BOUND
from standoff.kernels.solids.spatial_tolerances import SURE_NORMAL, VALLEY
from standoff.solids.spatial.minimum import Found, leaf_jet_of
from standoff.solids.spatial.pair import Place, PlacedPair
from standoff.solids.spatial.points import distance_to_boundary
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.stationary import is_minimum
from standoff.solids.spatial.ties import is_same

# Where between two pairs the boundaries are looked at: what is half way may be on another piece of
# them by symmetry.
BETWEEN = (0.5, 0.19, 0.81)


def local_minima(pair: PlacedPair, found: Found, senses: tuple[int, int]) -> list[Place]:
    """All that were found, the nearest first; of each set of nearest pairs one."""
    places = [pair.place(row, senses) for row in [found.best, *found.minima]]
    places = [each for k, each in enumerate(places) if k == 0 or is_minimum(pair, each)]

    def same(place: Place, other: Place) -> bool:
        near = abs(place.distance - other.distance) <= found.tolerance
        return near and is_same(place, other, pair.size)

    def joined(place: Place, other: Place) -> bool:
        return _are_joined(pair, place, other, found.tolerance)

    single = [_best(pair, each) for each in _sets(places, same)]
    return [_best(pair, each) for each in _sets(single, joined)]


def _sets(places: list[Place], are_one: Callable[[Place, Place], bool]) -> list[list[Place]]:
    """Those that are one, or one with others that are, each set in the order of its first."""
    sets: list[list[Place]] = []
    for place in places:
        mine = [each for each in sets if any(are_one(place, other) for other in each)]
        if not mine:
            sets.append([place])
            continue
        mine[0].append(place)
        for other in mine[1:]:
            mine[0].extend(other)
            sets = [each for each in sets if each is not other]
    return sets


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


def _are_joined(pair: PlacedPair, place: Place, other: Place, tolerance: float) -> bool:
    """Are those between two pairs as near?"""
    if abs(place.distance - other.distance) > tolerance:
        return False
    most = max(place.distance, other.distance) + tolerance
    return all(_gap_between(pair, place, other, share) <= most for share in BETWEEN)


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
