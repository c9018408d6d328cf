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


def common_ball(pair: PlacedPair, starts: Array, least: float) -> Overlap | None:
    """By ascent of the lesser depth from world points; None if no ball is deeper than `least`.

    A local maximum: the ball is inside both solids, but another one may be larger.
    """
    best, where = -np.inf, starts[0]
    for start in starts:
        depth, point = _climbed(pair, start, FIRST_STEP)
        if depth > best:
            best, where = depth, point
    return (
        Overlap(where, best, 2.0 * best) if best > least else ball_beside(pair, starts[:1], least)
    )


def ball_beside(pair: PlacedPair, starts: Array, least: float) -> Overlap | None:
    """The same from the first point inside both that is found beside common points of the
    boundaries."""
    for start in starts:
        depth, point = _beside(pair, start, least)
        if depth > least:
            return Overlap(point, depth, 2.0 * depth)
    return None


def _beside(pair: PlacedPair, start: Array, least: float) -> tuple[float, Array]:
    """From a point inside both that is sought beside a common point of the boundaries."""
    size = min(pair.a.size, pair.b.size)
    ways = WAYS / np.linalg.norm(WAYS, axis=1)[:, None]
    for look in LOOKS:
        spots = start + look * size * ways
        depths = [min(pair.depths(spot)[:2]) for spot in spots]
        k = int(np.argmax(depths))
        if depths[k] > least:
            return _climbed(pair, spots[k], look)
    return -np.inf, start


def _climbed(pair: PlacedPair, start: Array, first: float) -> tuple[float, Array]:
    size = min(pair.a.size, pair.b.size)
    point, (da, db, ga, gb) = start, pair.depths(start)
    step = first * size
    for _ in range(MOST_STEPS):
        if step <= LAST_CLIMB * size:
            break
        worse, other = (ga, gb) if da <= db else (gb, ga)
        ways = [worse, worse + other, worse - (worse @ other) * other]
        for way in ways:
            length = float(np.linalg.norm(way))
            if length < LEADS_NOWHERE:
                continue
            trial = point + step * way / length
            told = pair.depths(trial)
            if min(told[:2]) > min(da, db):
                point, (da, db, ga, gb) = trial, told
                break
        else:
            step *= 0.4
    return min(da, db), point
