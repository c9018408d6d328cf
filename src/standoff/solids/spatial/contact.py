"""Local minima of the signed distance of two solids, and at which of them they overlap.

A minimum of signed distance d < 0 has a normal n of both boundaries and points y - x = d n: B,
moved by -d along n, only touches there.
"""

from __future__ import annotations

import threading
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.entries.solid_contact import pieces_parted, signed_minima
from standoff.kernels.solids import spatial_progress as C
from standoff.kernels.solids.minima_sets import MOST_SETS, SET_REALS, SET_ROW
from standoff.kernels.solids.overlap_depth import BALL, ENOUGH, MOST_PUSHES
from standoff.solids.answer import Overlap
from standoff.solids.spatial.minimum import MOST_LOCAL, SearchOptions, evaluations_of, started
from standoff.solids.spatial.pair import NearestPlace, PlacedPair
from standoff.solids.spatial.points import depth_beside
from standoff.solids.spatial.stationary import fans_of
from standoff.solids.spatial.tolerances import LEAST_LENGTH
from standoff.typing import Array

MOST_REGIONS = 64
"""Minima below 0 that are looked at."""
MOST_BALLS = 8
"""Balls by which two places are joined."""
NEXT_BALL = 0.9
"""Of a ball's radius: how far the middle of the next one is."""
MOST_WAITING = 1 << 14
"""Pairs of nodes that wait in the search."""


class SignedMinima(NamedTuple):
    """Minima of the signed distance as the kernel tells them.

    Attributes
    ----------
    rows : (n, MINIMUM_REALS) array
        All pairs of points with a common normal, minima or not.
    sets : (m, SET_REALS) array
        The minima, the deepest first.
    evaluations : int
    """

    rows: Array
    sets: Array
    evaluations: int

    def row_of(self, one: Array) -> Array:
        """The row of points that stands for a minimum."""
        found: Array = self.rows[int(one[SET_ROW])]
        return found


class Region(NamedTuple):
    """A place in which two solids overlap: its minimum as a row of sets, and a length that no
    translation is less than which parts the solids."""

    row: Array
    place: NearestPlace
    depth: float


@lru_cache(maxsize=8)
def _room(thread: int) -> tuple[Array, Array, NDArray[np.int64]]:
    del thread
    return (
        np.empty(C.MINIMUM_REALS * MOST_LOCAL),
        np.empty(SET_REALS * MOST_SETS),
        np.empty(2 * MOST_WAITING, dtype=np.int64),
    )


def signed_minima_of(pair: PlacedPair, sought: SearchOptions) -> SignedMinima:
    """Those whose signed distance is at most `sought.above`, on either side of 0."""
    best, _ = started(sought, pair.size, float(np.linalg.norm(pair.relative[9:])))
    best[C.MOST_MINIMA] = MOST_LOCAL
    rows, sets, stack = _room(threading.get_ident())
    counts = np.zeros(8, dtype=np.int64)
    solids, fans = (pair.a.packed, pair.b.packed), (fans_of(pair.a), fans_of(pair.b))
    lists, asked = (best, rows, sets), np.array([sought.patch])
    n = int(signed_minima(solids, pair.relative, fans, lists, asked, stack, counts))
    return signed_told(best, rows, sets[: SET_REALS * max(n, 0)], counts)


def signed_told(best: Array, rows: Array, sets: Array, counts: NDArray[np.int64]) -> SignedMinima:
    """Copies of what a kernel tells."""
    count = C.MINIMUM_REALS * int(best[C.N_MINIMA])
    return SignedMinima(
        rows[:count].reshape(-1, C.MINIMUM_REALS).copy(),
        sets.reshape(-1, SET_REALS).copy(),
        evaluations_of(counts),
    )


def place_of(pair: PlacedPair, found: SignedMinima, row: Array) -> NearestPlace:
    """Of a row of sets, in world axes; nothing is proven of it yet."""
    whole = found.row_of(row)
    x, y = (whole[o : o + 3] @ pair.ra.T + pair.pa for o in (C.POINTS, C.POINTS + 3))
    told = row[: C.POINTS].copy()
    told[C.BOUND] = -np.inf
    return NearestPlace(told, x, y, pair.ra @ whole[C.NORMAL : C.NORMAL + 3])


def regions_of(pair: PlacedPair, found: SignedMinima, tolerance: float) -> list[Region]:
    """The regions in which the solids overlap, the deepest first; of minima that are proven to be
    in one region the one of the least depth. Solids whose deepest minimum is within the tolerance
    are not told apart from solids that touch by them."""
    told: list[Region] = []
    balls: list[Overlap] = []
    below = [row for row in found.sets if row[0] < 0.0][:MOST_REGIONS]
    if not any(row[0] < -tolerance for row in below):
        return told
    for row in reversed(below):  # the least depth first
        place, about = place_of(pair, found, row), -float(row[0])
        depth = least_depth(pair, place)
        if len(below) > 1 or depth < ENOUGH * about:
            ball = ball_of(pair, found, row)
            depth = max(depth, ball.depth)
            if any(are_joined(pair, place, ball, other) for other in balls):
                continue
            balls.append(ball)
        if depth > tolerance:
            told.append(Region(row, place, depth))
    return told[::-1]


def least_depth(pair: PlacedPair, place: NearestPlace) -> float:
    """No translation shorter than this parts the solids; 0 or less: nothing is proven.

    A point of one boundary is as deep as that inside the other solid, and stays inside it.
    """
    about = -place.distance
    depth = depth_beside(pair.a, pair.in_a(place.point_b), about)[0]
    if depth >= ENOUGH * about:
        return depth
    return max(depth, depth_beside(pair.b, pair.in_b(place.point_a), about)[0])


def are_joined(pair: PlacedPair, place: NearestPlace, ball: Overlap, end: Overlap) -> bool:
    """Are two balls, the first one's at a place, joined by others that are inside both solids, in a
    straight line?"""
    if min(ball.radius, end.radius) <= 0.0:
        return False
    for _ in range(MOST_BALLS):
        way = end.common_point - ball.common_point
        length = float(np.linalg.norm(way))
        if length < ball.radius + end.radius:
            return True
        middle = ball.common_point + NEXT_BALL * ball.radius / length * way
        about = float(np.linalg.norm(middle - place.point_a))
        radius = min(depth for depth, _ in depths_beside(pair, middle, about))
        if radius <= 0.0:
            return False
        ball = Overlap(middle, radius, 2.0 * radius)
    return False


def depths_beside(pair: PlacedPair, point: Array, about: float) -> list[tuple[float, Array]]:
    """How deep a world point is in A and in B, at least, and the ways away from their nearest
    points, world axes; of a solid that it is outside of the way to it."""
    found = []
    for solid, own, turn in (
        (pair.a, pair.in_a(point), pair.ra),
        (pair.b, pair.in_b(point), pair.rb),
    ):
        depth, nearest = depth_beside(solid, own, about)
        away = turn @ (own - nearest if depth > 0.0 else nearest - own)
        found.append((depth, away / max(float(np.linalg.norm(away)), LEAST_LENGTH)))
    return found


def ball_of(pair: PlacedPair, found: SignedMinima, row: Array) -> Overlap:
    """A ball that is proven to be inside both solids, at a minimum of the signed distance: around
    the middle of its points, moved to where both boundaries are farther away. A radius of 0: none
    was found."""
    mine = found.rows[found.rows[:, C.BOUND] == row[C.BOUND]]
    points = mine[:, C.POINTS : C.POINTS + 6].reshape(-1, 3)
    middle = points.mean(axis=0) @ pair.ra.T + pair.pa
    about, best = 0.5 * abs(float(row[0])), Overlap(middle, 0.0, 0.0)
    for _ in range(MOST_PUSHES):
        depths = depths_beside(pair, middle, about)
        least = min(depth for depth, _ in depths)
        if least > best.radius:
            best = Overlap(middle, least, sum(depth for depth, _ in depths))
        if least >= BALL * about:
            break
        for depth, away in depths:
            middle = middle + max(about - depth, 0.0) * away
    return best


def bound_of(pair: PlacedPair, found: SignedMinima, row: Array, sought: SearchOptions) -> float:
    """A lower bound of the signed distance of both leaves at a minimum: B, moved by as much along
    the normal, is proven not to meet A there; -inf: not proven."""
    best, _ = started(sought, pair.size, float(np.linalg.norm(pair.relative[9:])))
    lists = best, _room(threading.get_ident())[0]
    counts = np.zeros(8, dtype=np.int64)
    solids = (pair.a.packed, pair.b.packed)
    by = float(pieces_parted(solids, pair.relative, found.row_of(row).copy(), lists, counts))
    return -by if by > 0.0 else -np.inf
