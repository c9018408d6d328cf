"""The largest ball that is found inside both of two solids that overlap."""

from __future__ import annotations

import numpy as np

from standoff.geometry.validation import Array
from standoff.solids.answer import Overlap
from standoff.solids.spatial.pair import PlacedPair

# Parts of the size: the first step of the ascent, and the last.
FIRST_STEP, LAST_STEP = 0.1, 1e-5
MOST_STEPS = 60


def common_ball(pair: PlacedPair, starts: Array, least: float) -> Overlap | None:
    """By ascent of the lesser depth from world points; None if no ball is deeper than `least`.

    A local maximum: the ball is inside both solids, but another one may be larger.
    """
    best, where = -np.inf, starts[0]
    for start in starts:
        depth, point = _climbed(pair, start)
        if depth > best:
            best, where = depth, point
    return Overlap(where, best) if best > least else None


def _climbed(pair: PlacedPair, start: Array) -> tuple[float, Array]:
    size = min(pair.a.size, pair.b.size)
    point, (da, db, ga, gb) = start, pair.depths(start)
    step = FIRST_STEP * size
    for _ in range(MOST_STEPS):
        if step < LAST_STEP * size:
            break
        worse, other = (ga, gb) if da <= db else (gb, ga)
        ways = [worse, worse + other, worse - (worse @ other) * other]
        for way in ways:
            length = float(np.linalg.norm(way))
            if length < 1e-6:
                continue
            trial = point + step * way / length
            told = pair.depths(trial)
            if min(told[:2]) > min(da, db):
                point, (da, db, ga, gb) = trial, told
                break
        else:
            step *= 0.4
    return min(da, db), point
