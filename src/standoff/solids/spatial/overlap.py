"""The largest ball that is found inside both of two solids that overlap."""

from __future__ import annotations

from itertools import product

import numpy as np

from standoff.geometry.validation import Array
from standoff.solids.answer import Overlap
from standoff.solids.spatial.pair import PlacedPair
from standoff.solids.spatial.tolerances import LAST_CLIMB, LEADS_NOWHERE, LOOKS

# Part of the size: the first step of the ascent.
FIRST_STEP = 0.1
MOST_STEPS = 60
WAYS = np.array([w for w in product((-1.0, 0.0, 1.0), repeat=3) if any(w)])


class Ascent:
    """Depths of world points in both solids, for as long as evaluations are left."""

    def __init__(self, pair: PlacedPair, left: int) -> None:
        self.pair, self.left = pair, left
        self.size = min(pair.a.size, pair.b.size)

    def depths(self, point: Array) -> tuple[float, float, Array, Array]:
        da, db, ga, gb, spent = self.pair.depths(point)
        self.left -= spent
        return da, db, ga, gb


def common_ball(pair: PlacedPair, starts: Array, least: float, left: int) -> Overlap | None:
    """By ascent of the lesser depth from world points; None if no ball is deeper than `least`.

    A local maximum, or what was found before `left` evaluations were spent: the ball is inside both
    solids, but another one may be larger.
    """
    best, where, ascent = -np.inf, starts[0], Ascent(pair, left)
    for start in starts:
        depth, point = _climbed(ascent, start, FIRST_STEP)
        if depth > best:
            best, where = depth, point
        if ascent.left <= 0:
            break
    return Overlap(where, best, 2.0 * best) if best > least else None


def ball_beside(pair: PlacedPair, starts: Array, least: float, left: int) -> Overlap | None:
    """The same from the first point inside both that is found beside common points of the
    boundaries."""
    ascent = Ascent(pair, left)
    for start in starts:
        depth, point = _beside(ascent, start, least)
        if depth > least:
            return Overlap(point, depth, 2.0 * depth)
    return None


def _beside(ascent: Ascent, start: Array, least: float) -> tuple[float, Array]:
    """From a point inside both that is sought beside a common point of the boundaries."""
    ways = WAYS / np.linalg.norm(WAYS, axis=1)[:, None]
    for look in LOOKS:
        spots = start + look * ascent.size * ways
        depths = [min(ascent.depths(spot)[:2]) for spot in spots if ascent.left > 0]
        k = int(np.argmax(depths)) if depths else 0
        if depths and depths[k] > least:
            return _climbed(ascent, spots[k], look)
    return -np.inf, start


def _climbed(ascent: Ascent, start: Array, first: float) -> tuple[float, Array]:
    point, (da, db, ga, gb) = start, ascent.depths(start)
    step = first * ascent.size
    for _ in range(MOST_STEPS):
        if step <= LAST_CLIMB * ascent.size or ascent.left <= 0:
            break
        worse, other = (ga, gb) if da <= db else (gb, ga)
        ways = [worse, worse + other, worse - (worse @ other) * other]
        for way in ways:
            length = float(np.linalg.norm(way))
            if length < LEADS_NOWHERE:
                continue
            trial = point + step * way / length
            told = ascent.depths(trial)
            if min(told[:2]) > min(da, db):
                point, (da, db, ga, gb) = trial, told
                break
        else:
            step *= 0.4
    return min(da, db), point
