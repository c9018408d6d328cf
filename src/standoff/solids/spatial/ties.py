"""Several nearest pairs: single ones that tie, or a continuum of them, with its ends."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from standoff.geometry.validation import Array
from standoff.solids.answer import Continuum
from standoff.solids.spatial.pair import Place, PlacedPair
from standoff.solids.spatial.tolerances import CONTINUUM_LENGTH, SAME_BASIN, SAME_PAIR, VALLEY

# How many neighbours of a pair are tried for a continuum between them.
TRIED = 4
MOST_CORNERS = 8


def distinct(pair: PlacedPair, places: Sequence[Place]) -> list[Place]:
    """Without those that were found twice."""
    kept: list[Place] = []
    for place in sorted(places, key=lambda each: each.distance):
        if not any(_same(place, other, pair.size) for other in kept):
            kept.append(place)
    return kept


def _same(place: Place, other: Place, size: float) -> bool:
    """Is a pair another one again, or cut off its valley by the side of a leaf?"""
    away = max(
        float(np.linalg.norm(place.point_a - other.point_a)),
        float(np.linalg.norm(place.point_b - other.point_b)),
    )
    farther = place.distance - other.distance > VALLEY * size
    return away <= (SAME_BASIN if farther else SAME_PAIR) * size


def continuum_of(
    pair: PlacedPair, places: Sequence[Place], distance: float, tolerance: float
) -> Continuum | None:
    """The continuum that distinct places belong to; None if they are single ones.

    It is one where points between two of them are nearest pairs too.
    """
    if len(places) < 2:
        return None
    spots = np.array([p.point_a for p in places])
    away = np.linalg.norm(spots - spots[0], axis=1)
    order = [k for k in np.argsort(away) if away[k] > CONTINUUM_LENGTH * pair.size][:TRIED]
    for k in order:
        if _held(pair, 0.5 * (spots[0] + spots[k]), distance, tolerance):
            return _described(pair, places, int(k), distance, tolerance)
    # or the points of A are one, and those of B are not
    other = np.array([p.point_b for p in places])
    if order or float(np.ptp(other, axis=0).max()) <= CONTINUUM_LENGTH * pair.size:
        return None
    return None


def _held(pair: PlacedPair, point: Array, distance: float, tolerance: float) -> bool:
    """Is A's boundary near a world point at the least distance from B's?"""
    return bool(pair.distance_to_b(pair.on_a(point)) <= distance + 2.0 * tolerance)


def _described(
    pair: PlacedPair, places: Sequence[Place], k: int, distance: float, tolerance: float
) -> Continuum:
    spots = np.array([p.point_a for p in places])
    along = spots[k] - spots[0]
    across = np.cross(places[0].normal, along)
    step = 0.05 * across
    middle = 0.5 * (spots[0] + spots[k])
    surface = any(_held(pair, middle + s * step, distance, tolerance) for s in (1.0, -1.0))
    if surface:
        return Continuum("surface", _corners(places, spots))
    straight = np.linalg.svd(spots - spots.mean(axis=0), compute_uv=False)
    if straight[1] <= 1e-6 * straight[0]:
        return Continuum("line", _ends(places, spots))
    return Continuum("arc", () if _closed(spots) else _ends(places, spots))


def _ends(places: Sequence[Place], spots: Array) -> tuple[tuple[Array, Array], ...]:
    first = int(np.linalg.norm(spots - spots.mean(axis=0), axis=1).argmax())
    last = int(np.linalg.norm(spots - spots[first], axis=1).argmax())
    return tuple((places[k].point_a, places[k].point_b) for k in (first, last))


def _corners(places: Sequence[Place], spots: Array) -> tuple[tuple[Array, Array], ...]:
    """Those that are farthest from each other, one after the other."""
    chosen = [int(np.linalg.norm(spots - spots.mean(axis=0), axis=1).argmax())]
    away = np.linalg.norm(spots - spots[chosen[0]], axis=1)
    while len(chosen) < min(MOST_CORNERS, len(spots)):
        k = int(away.argmax())
        if away[k] <= CONTINUUM_LENGTH * float(np.ptp(spots)):
            break
        chosen.append(k)
        away = np.minimum(away, np.linalg.norm(spots - spots[k], axis=1))
    return tuple((places[k].point_a, places[k].point_b) for k in chosen)


def _closed(spots: Array) -> bool:
    """Do the points go all around their middle?"""
    middle = spots.mean(axis=0)
    _, _, axes = np.linalg.svd(spots - middle)
    flat = (spots - middle) @ axes[:2].T
    angles = np.sort(np.arctan2(flat[:, 1], flat[:, 0]))
    gaps = np.diff(np.concatenate([angles, angles[:1] + 2.0 * np.pi]))
    return bool(gaps.max() < 1.6)
