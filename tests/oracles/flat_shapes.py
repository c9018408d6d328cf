"""Signed distances of convex hulls of a few points, by trying every pair of features."""

from __future__ import annotations

from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def signed_distance(a: Array, b: Array) -> float:
    """Signed distance of the hulls of two sets of points, each flat or with all of its corners.

    Apart: the least over corners and triangles, and over edges of one and edges of the other, of
    all pairs and triples of points: those inside a hull do no harm. In overlap: less the least
    depth over the normals of all facets that the difference of the hulls can have.
    """
    depth = _depth(a, b)
    if depth >= 0.0:
        return -depth
    spots = [_to_triangle(x, b[list(t)]) for x in a for t in combinations(range(len(b)), 3)]
    spots += [_to_triangle(y, a[list(t)]) for y in b for t in combinations(range(len(a)), 3)]
    for p, q in product(combinations(range(len(a)), 2), combinations(range(len(b)), 2)):
        spots.append(_of_segments(a[list(p)], b[list(q)]))
    return min(spots)


def _depth(a: Array, b: Array) -> float:
    """The least shift that parts the hulls, less than 0 where they are apart."""
    ways = [np.cross(t[1] - t[0], t[2] - t[0]) for s in (a, b) for t in _triples(s)]
    ways += [
        np.cross(a[p[1]] - a[p[0]], b[q[1]] - b[q[0]])
        for p, q in product(combinations(range(len(a)), 2), combinations(range(len(b)), 2))
    ]
    least = np.inf
    for way in ways:
        length = np.linalg.norm(way)
        if length < 1e-9:
            continue
        n = way / length
        least = min(least, (a @ n).max() - (b @ n).min(), (b @ n).max() - (a @ n).min())
    return float(least)


def _triples(points: Array) -> list[Array]:
    return [points[list(t)] for t in combinations(range(len(points)), 3)]


def _to_triangle(x: Array, corners: Array) -> float:
    """Distance of a point from a triangle, by barycentric coordinates, else from its sides."""
    u, v, w = corners[1] - corners[0], corners[2] - corners[0], x - corners[0]
    shares = np.linalg.lstsq(np.column_stack([u, v]), w, rcond=None)[0]
    best = np.inf
    if shares.min() >= 0.0 and shares.sum() <= 1.0:
        best = float(np.linalg.norm(w - shares[0] * u - shares[1] * v))
    for k in range(3):
        best = min(best, _to_segment(x, corners[k], corners[(k + 1) % 3]))
    return best


def _to_segment(x: Array, start: Array, end: Array) -> float:
    way = end - start
    share = np.clip((x - start) @ way / max(way @ way, 1e-300), 0.0, 1.0)
    return float(np.linalg.norm(x - start - share * way))


def _of_segments(p: Array, q: Array) -> float:
    u, v, w = p[1] - p[0], q[1] - q[0], q[0] - p[0]
    shares = np.linalg.lstsq(np.column_stack([u, -v]), w, rcond=None)[0]
    best = np.inf
    if (shares >= 0.0).all() and (shares <= 1.0).all():
        best = float(np.linalg.norm(p[0] + shares[0] * u - q[0] - shares[1] * v))
    ends = [_to_segment(x, *q) for x in p] + [_to_segment(y, *p) for y in q]
    return min(best, *ends)
