"""Vectors and matrices of intervals; the first axis holds the components."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from standoff.geometry.intervals import Interval, cos, interval, sin, sqrt
from standoff.typing import Array


def mapped(linear: Array | Interval, x: Interval) -> Interval:
    """(m, ...) bounds of linear @ x; linear is (m, k) or (m, k, n), x (k, ..., n)."""
    matrix = interval(linear)
    rows = []
    for low, high in zip(matrix.lo, matrix.hi, strict=True):
        total = interval(0.0)
        for a, b, c, d in zip(low, high, x.lo, x.hi, strict=True):
            total = total + Interval(a, b) * Interval(c, d)
        rows.append(total)
    return stacked(rows)


def stacked(rows: Sequence[Interval]) -> Interval:
    """Intervals of the same shape as the components of one interval."""
    return Interval(np.stack([r.lo for r in rows]), np.stack([r.hi for r in rows]))


def by_generator(vectors: Sequence[Interval]) -> Interval:
    """(3, k, n) from k of (3, n)."""
    return Interval(np.stack([v.lo for v in vectors], 1), np.stack([v.hi for v in vectors], 1))


def dot(a: Interval, b: Interval) -> Interval:
    """(...) bounds of a . b, both (3, ...); of a . a if both are the same object."""
    if a is b:
        return a[0] ** 2 + a[1] ** 2 + a[2] ** 2
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def length(*parts: Interval) -> Interval:
    """Bounds of the square root of a sum of squares."""
    total = interval(0.0)
    for part in parts:
        total = total + part**2
    # rounded outward, a sum of zeros is below zero
    return sqrt(Interval(np.maximum(total.lo, 0.0), total.hi))


def cross(a: Interval, b: Interval) -> Interval:
    """(3, ...) bounds of a x b, both (3, ...)."""
    return stacked([a[i] * b[j] - a[j] * b[i] for i, j in ((1, 2), (2, 0), (0, 1))])


def cofactors(linear: Array) -> Interval:
    """(3, 3) bounds of the matrix that maps normals where `linear` maps tangents."""
    a, b, c = (interval(column) for column in linear.T)
    columns = stacked([cross(b, c), cross(c, a), cross(a, b)])
    return Interval(columns.lo.T, columns.hi.T)


def determinant(linear: Array) -> Interval:
    """Bounds of the determinant of a (3, 3)."""
    return dot(interval(linear.T[0]), cofactors(linear)[:, 0])


def wave(a: Interval, b: Interval, t: Interval) -> Interval:
    """Bounds of a cos t + b sin t, exact up to rounding; t may contain crests."""
    crest = np.arctan2(b.lo + b.hi, a.lo + a.hi)
    c, s = cos(interval(crest)), sin(interval(crest))
    # for any angle, near to the crest or not, and nearly nothing of the second part near to it
    along, across = a * c + b * s, b * c - a * s
    away = t - interval(crest)
    return along * cos(away) + across * sin(away)
