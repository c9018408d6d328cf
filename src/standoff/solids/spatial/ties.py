"""Several nearest pairs: single ones that tie, or a continuum of them, with its ends."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.entries.minima import one_place
from standoff.solids.answer import Continuum
from standoff.solids.spatial.minimum import LeastFound
from standoff.solids.spatial.pair import NearestPlace, PlacedPair
from standoff.solids.spatial.points import signed_distances
from standoff.solids.spatial.tolerances import (
    BENDS_LESS,
    CONTINUUM_LENGTH,
)
from standoff.typing import Array

# How many of the nearest pairs are tried.
TRIED = 6
MOST_CORNERS = 8
# A surface's pieces are at least this part as wide as long; an arc's bend is less.
WIDE = 0.3
# Turns between neighbours on a closed arc, radians, at most.
OPEN_TURN = 1.6


def distinct(pair: PlacedPair, places: Sequence[NearestPlace]) -> list[NearestPlace]:
    """Without those that were found twice."""
    ordered = sorted(places, key=lambda each: each.distance)
    kept: list[NearestPlace] = []
    again = np.zeros(len(ordered), dtype=bool)
    spots = spots_of(ordered)
    for k, place in enumerate(ordered):
        if not again[k]:
            kept.append(place)
            again |= same_as(spots, k, pair.size)
    return kept


def spots_of(places: Sequence[NearestPlace]) -> Array:
    """Both points and the distance of each (n, 7)."""
    return np.array([place.spot for place in places]).reshape(-1, 7)


def same_as(spots: Array, k: int, size: float) -> NDArray[np.bool_]:
    """Which pairs are the k-th one again, or cut off its valley by the side of a leaf?"""
    out = np.empty(len(spots))
    one_place(spots, k, size, out)
    return out > 0.0


def continuum_of(
    pair: PlacedPair, places: Sequence[NearestPlace], found: LeastFound
) -> Continuum | None:
    """The continuum that the nearest place belongs to; None if it is a single one.

    It is one if Newton's method finds other pairs at the same distance from other starts in the
    same pieces. Of a surface that ends beside strips and corners, such as a rounded box's, the
    nearest places may all be at its rim: it is one if there are pairs between them too.
    """
    told: Continuum | None = None
    every = [(place.point_a, place.point_b) for place in places]
    for place in _likeliest(pair, places)[:TRIED]:
        others = _others(pair, place, found)
        every += others
        if others:
            told = _described(place, others, places)
            if told.kind == "surface":
                return told
    if told is not None and told.kind == "arc" and _is_filled(pair, every, found.tolerance):
        return Continuum("surface", _corners(every, _spots(every)))
    return told


def _is_filled(pair: PlacedPair, every: Sequence[tuple[Array, Array]], tolerance: float) -> bool:
    """Are there nearest pairs in a triangle of others: in its middle, and halfway along its sides?

    Where two points are on the boundaries halfway between those of two nearest pairs, they are no
    farther apart than these.
    """
    spots = _spots(every)
    first, last = _farthest(spots)
    along = spots[last] - spots[first]
    off = np.linalg.norm(np.cross(spots - spots[first], along), axis=1)
    corners = [first, last, int(off.argmax())]
    weights = (np.ones((4, 3)) - [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) / [
        [3],
        [2],
        [2],
        [2],
    ]
    poses = (pair.ra, pair.pa), (pair.rb, pair.pb)
    for side, (solid, (turn, shift)) in enumerate(zip((pair.a, pair.b), poses, strict=True)):
        points = weights @ np.array([every[k][side] for k in corners])
        told = signed_distances(solid, (points - shift) @ turn)
        if float(np.abs(told.distance).max()) > tolerance:
            return False
    return True


def _likeliest(pair: PlacedPair, places: Sequence[NearestPlace]) -> list[NearestPlace]:
    """Places of pairs of leaves with the most parameters first; among them those of planes, then
    those within both leaves, as two may have but a corner in common, and then those of features
    that have the most places in common. Each pair of features comes before any comes again."""
    rows = np.array([place.row[:7] for place in places]).reshape(-1, 7)
    sides, ranks = [], np.zeros((4, len(rows)), dtype=int)
    for side, table in enumerate((pair.a.leaf_table, pair.b.leaf_table)):
        leaves = rows[:, 1 + side].astype(int)
        low, high = table.ends[leaves, ::2], table.ends[leaves, 1::2]
        at = rows[:, 3 + 2 * side : 5 + 2 * side]
        sides.append(table.feature[leaves].tolist())
        ranks[0] -= table.dim[leaves]
        ranks[1] -= table.plane[leaves]
        ranks[2] += (((at <= low) | (at >= high)) & (low < high)).sum(axis=1)
    features = list(zip(*sides, strict=True))
    often = Counter(features)
    ranks[3] = [-often[both] for both in features]
    order = np.lexsort(ranks[::-1]).tolist()
    seen: Counter[tuple[int, int]] = Counter()
    turn = {}
    for k in order:
        turn[k] = seen[features[k]]
        seen[features[k]] += 1
    return [places[k] for k in sorted(order, key=lambda k: turn[k])]


def _others(pair: PlacedPair, place: NearestPlace, found: LeastFound) -> list[tuple[Array, Array]]:
    """Pairs (x, y) in the leaves of a place at the least distance, more than a little away.

    Where that is not proven Newton's method may come to nearer ones: they are no ties.
    """
    most, least = found.upper + found.tolerance, found.upper - found.tolerance
    x, y = pair.points_of(pair.found_from(place.row, starts(pair, place.row), most))
    off_a, off_b = (
        np.linalg.norm(x - place.point_a, axis=1),
        np.linalg.norm(y - place.point_b, axis=1),
    )
    far = np.maximum(off_a, off_b) > CONTINUUM_LENGTH * pair.size
    far &= np.linalg.norm(x - y, axis=1) >= least
    return list(zip(x[far], y[far], strict=True))


def starts(pair: PlacedPair, row: Array) -> Array:
    """Parameters (18, 4) at the corners of one leaf and the middles of its sides, those of the
    other held, and the other way round."""
    found = np.tile(row[3:7], (18, 1))
    for side, solid in enumerate((pair.a, pair.b)):
        u0, u1, v0, v1 = solid.leaves[int(row[1 + side])].reals[:4]
        at = product((u0, 0.5 * (u0 + u1), u1), (v0, 0.5 * (v0 + v1), v1))
        found[9 * side : 9 * side + 9, 2 * side : 2 * side + 2] = list(at)
    return found


def _described(
    place: NearestPlace, others: list[tuple[Array, Array]], places: Sequence[NearestPlace]
) -> Continuum:
    near = np.array([x for x, _ in others]) - place.point_a
    if float(np.ptp(near, axis=0).max()) == 0.0 or not near.any():
        near = np.array([y for _, y in others]) - place.point_b
    sizes = np.linalg.svd(near, compute_uv=False)
    every = [(p.point_a, p.point_b) for p in places] + others
    spots = _spots(every)
    if len(sizes) > 1 and sizes[1] > WIDE * sizes[0]:
        return Continuum("surface", _corners(every, spots))
    straight = np.linalg.svd(spots - spots.mean(axis=0), compute_uv=False)
    if len(straight) < 2 or straight[1] <= BENDS_LESS * straight[0]:
        return Continuum("line", _ends(every, spots))
    return Continuum("arc", () if _closed(spots) else _ends(every, spots))


def _spots(every: Sequence[tuple[Array, Array]]) -> Array:
    """The points of pairs on the body on which they are farther from each other."""
    on_a, on_b = np.array([x for x, _ in every]), np.array([y for _, y in every])
    wider = float(np.ptp(on_a, axis=0).max()) > float(np.ptp(on_b, axis=0).max())
    return on_a if wider else on_b


def _farthest(spots: Array) -> tuple[int, int]:
    """Two that are far from each other: the one farthest from the middle, and from that one."""
    first = int(np.linalg.norm(spots - spots.mean(axis=0), axis=1).argmax())
    return first, int(np.linalg.norm(spots - spots[first], axis=1).argmax())


def _ends(every: Sequence[tuple[Array, Array]], spots: Array) -> tuple[tuple[Array, Array], ...]:
    return tuple(every[k] for k in _farthest(spots))


def _corners(every: Sequence[tuple[Array, Array]], spots: Array) -> tuple[tuple[Array, Array], ...]:
    """Those that are farthest from each other, one after the other."""
    chosen = [int(np.linalg.norm(spots - spots.mean(axis=0), axis=1).argmax())]
    away = np.linalg.norm(spots - spots[chosen[0]], axis=1)
    while len(chosen) < min(MOST_CORNERS, len(spots)):
        k = int(away.argmax())
        if away[k] <= CONTINUUM_LENGTH * float(np.ptp(spots)):
            break
        chosen.append(k)
        away = np.minimum(away, np.linalg.norm(spots - spots[k], axis=1))
    return tuple(every[k] for k in chosen)


def _closed(spots: Array) -> bool:
    """Do the points go all around their middle?"""
    middle = spots.mean(axis=0)
    _, _, axes = np.linalg.svd(spots - middle)
    flat = (spots - middle) @ axes[:2].T
    angles = np.sort(np.arctan2(flat[:, 1], flat[:, 0]))
    gaps = np.diff(np.concatenate([angles, angles[:1] + 2.0 * np.pi]))
    return bool(gaps.max() < OPEN_TURN)
