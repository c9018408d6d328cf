"""The patches of local minima, as ``kernels.solids.patch`` spans them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from standoff.kernels.entries.minima import span_patches
from standoff.kernels.solids import spatial_progress as C
from standoff.kernels.solids.minima_sets import (
    SET_BRANCH,
    SET_PAIRS,
    SET_POINTS,
    SET_REALS,
    SET_ROW,
)
from standoff.solids.answer import PointPair
from standoff.solids.spatial.minimum import LeastFound
from standoff.solids.spatial.pair import NearestPlace, PlacedPair
from standoff.typing import Array


def patches_of(
    pair: PlacedPair,
    minima: Sequence[NearestPlace],
    found: LeastFound,
    senses: tuple[int, int],
    wider: float,
) -> list[tuple[PointPair, ...]]:
    """Of each local minimum up to four pairs out of those that were found: those whose distance is
    from its own to `wider` more, along nearly the same normal, and nearer to it than to any other
    minimum. Its own is one of them, unless others are as near and span the rest."""
    rows, sets = rows_of(pair, minima, pair.places(found.minima, senses))
    best = np.zeros(C.BEST_REALS)
    best[C.N_MINIMA], best[C.SIZE], best[C.TOLERANCE] = len(rows), pair.size, found.tolerance
    span_patches(best, rows.ravel(), wider, sets.ravel(), len(minima))
    return [patch_told(pair, row) for row in sets]


def rows_of(
    pair: PlacedPair, minima: Sequence[NearestPlace], others: Sequence[NearestPlace] = ()
) -> tuple[Array, Array]:
    """Local minima as the kernels have them: rows (n, 17) of these and of other pairs, and of sets
    (m, 41)."""
    places = [*minima, *others]
    rows = np.zeros((len(places), C.MINIMUM_REALS))
    for row, place in zip(rows, places, strict=True):
        row[: C.POINTS] = place.row[: C.POINTS]
        row[C.POINTS :] = [
            *pair.in_a(place.point_a), *pair.in_a(place.point_b), *(pair.ra.T @ place.normal)
        ]  # fmt: skip
    sets = np.zeros((len(minima), SET_REALS))
    for k, place in enumerate(minima):
        sets[k, : C.POINTS], sets[k, SET_ROW], sets[k, SET_BRANCH] = place.row[: C.POINTS], k, -1.0
    return rows, sets


def patch_told(pair: PlacedPair, row: Array) -> tuple[PointPair, ...]:
    """Of a row of sets its patch, world points."""
    count = int(row[SET_PAIRS])
    points = row[SET_POINTS : SET_POINTS + 6 * count].reshape(-1, 3) @ pair.ra.T + pair.pa
    return tuple((points[2 * k], points[2 * k + 1]) for k in range(count))
