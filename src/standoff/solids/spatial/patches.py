"""The patch of a local minimum: a few pairs of points that span where the gap is hardly wider."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from standoff.geometry.validation import Array
from standoff.solids.answer import PointPair
from standoff.solids.spatial.minimum import Found
from standoff.solids.spatial.pair import Place, PlacedPair
from standoff.solids.spatial.tolerances import ONE_PATCH, SAME_NEAREST


def patches_of(
    pair: PlacedPair,
    minima: Sequence[Place],
    found: Found,
    senses: tuple[int, int],
    wider: float,
) -> list[tuple[PointPair, ...]]:
    """Of each local minimum up to four pairs out of those that were found: those whose distance is
    from its own to `wider` more, along nearly the same normal, and nearer to it than to any other
    minimum. Its own is one of them, unless others are as near and span the rest."""
    spots = np.array([_middle(each) for each in minima]).reshape(-1, 3)
    normals = np.array([each.normal for each in minima]).reshape(-1, 3)
    mine: list[list[Place]] = [[each] for each in minima]
    for row in found.minima:
        other = pair.place(row, senses)
        away = np.linalg.norm(spots - _middle(other), axis=1)
        away[normals @ other.normal < ONE_PATCH] = np.inf
        k = int(np.argmin(away))
        if away[k] == np.inf:
            continue
        more = other.distance - minima[k].distance
        if -found.tolerance <= more <= wider:
            mine[k].append(other)
    return [_spanning(each, SAME_NEAREST * pair.size, found.tolerance) for each in mine]


def _middle(place: Place) -> Array:
    return np.asarray(0.5 * (place.point_a + place.point_b))


def _spanning(places: Sequence[Place], least: float, tie: float) -> tuple[PointPair, ...]:
    """Up to four, each farthest outside of those taken before."""
    n = places[0].normal
    e1 = np.cross(n, np.eye(3)[int(np.argmin(np.abs(n)))])
    e1 = e1 / np.linalg.norm(e1)
    spots = np.array([_middle(each) for each in places])
    flat = (spots - spots[0]) @ np.array([e1, np.cross(n, e1)]).T
    away = np.linalg.norm(flat, axis=1)
    away[[each.distance > places[0].distance + tie for each in places]] = 0.0
    first = int(np.argmax(away))
    taken = [first if away[first] > least else 0]
    for _ in range(3):
        outside = _outside(flat[taken], flat)
        k = int(np.argmax(outside))
        if outside[k] <= least:
            break
        taken = _around(flat, [*taken, k])
    return tuple((places[k].point_a, places[k].point_b) for k in taken)


def _around(flat: Array, taken: list[int]) -> list[int]:
    """In their order around their middle, counterclockwise."""
    if len(taken) < 3:
        return taken
    away = flat[taken] - flat[taken].mean(axis=0)
    return [taken[k] for k in np.argsort(np.arctan2(away[:, 1], away[:, 0]))]


def _outside(corners: Array, spots: Array) -> NDArray[np.float64]:
    """How far points are from a point, from a line, or outside of a convex polygon."""
    if len(corners) == 1:
        return np.asarray(np.linalg.norm(spots - corners[0], axis=1))
    sides = np.roll(corners, -1, axis=0) - corners
    sides = sides / np.linalg.norm(sides, axis=1)[:, None]
    away = spots[:, None] - corners[None]
    across = away[..., 1] * sides[:, 0] - away[..., 0] * sides[:, 1]
    if len(corners) == 2:
        along = np.maximum(-away[:, 0] @ sides[0], -away[:, 1] @ sides[1])
        return np.asarray(np.maximum(np.abs(across[:, 0]), along))
    return np.asarray((-across).max(axis=1))
