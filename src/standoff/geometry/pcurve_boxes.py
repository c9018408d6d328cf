"""Boxes in (u, v) around trimming curves."""

from __future__ import annotations

import numpy as np

from standoff.geometry.bernstein import equal_segments
from standoff.geometry.interval_vectors import stacked, wave
from standoff.geometry.intervals import Interval, interval
from standoff.geometry.tolerances import BOX_MARGIN
from standoff.kernels.body import layout as L
from standoff.typing import Array

# Parts of a conic with varying weight, each bounded separately.
CONIC_PARTS = 8
Boxes = tuple[Array, Array]


def pcurve_boxes(kind: int, matrix: Array, ends: Array) -> Boxes:
    """(low, high), each (n, 2), around the parts of a LINE or CONIC of ``Pcurve`` between n + 1
    ascending parameters, where its weight is positive."""
    if kind == L.LINE:
        spots = matrix[:, [0]] * ends + matrix[:, [2]]
        places = spots[:2] / spots[2]
        sides = np.stack([places[:, :-1], places[:, 1:]])
        margin = BOX_MARGIN * np.abs(sides).max(axis=0)
        return (sides.min(axis=0) - margin).T, (sides.max(axis=0) + margin).T
    steps = np.linspace(ends[:-1], ends[1:], CONIC_PARTS + 1, axis=-1)
    t = Interval(steps[:, :-1].ravel(), steps[:, 1:].ravel())
    a, b, c = (interval(column[:, None]) for column in matrix.T)
    h = wave(a, b, t) + c
    with np.errstate(all="ignore"):
        found = stacked([h[0] / h[2], h[1] / h[2]])
    seen = found.known.all(axis=0).reshape(-1, CONIC_PARTS)
    if not seen.any(axis=1).all():
        raise ValueError("a part of a trimming curve is nowhere before its chart")
    lows = np.where(seen, found.lo.reshape(2, *seen.shape), np.inf)
    highs = np.where(seen, found.hi.reshape(2, *seen.shape), -np.inf)
    return lows.min(axis=2).T, highs.max(axis=2).T


def equal_boxes(kind: int, matrix: Array, first: float, last: float, parts: int) -> Boxes:
    """The same of equal parts, also of a Bezier curve, whose points `matrix` then has, over all of
    its range."""
    if kind == L.BEZIER:
        return bezier_box(equal_segments(len(matrix) - 1, parts) @ matrix)
    return pcurve_boxes(kind, matrix, np.linspace(first, last, parts + 1))


def pcurve_bends(kind: int, matrix: Array, ends: Array) -> Array:
    """(n, 2) bounds of the second derivatives of u and v along the same parts; inf where the weight
    may be zero."""
    steps = np.linspace(ends[:-1], ends[1:], CONIC_PARTS + 1, axis=-1)
    t = Interval(steps[:, :-1].ravel(), steps[:, 1:].ravel())
    a, b, c = (interval(column[:, None]) for column in matrix.T)
    if kind == L.LINE:
        none = t * 0.0
        h, rate, bent = a * t + c, a + none, stacked([none, none, none])
    else:
        bent = -wave(a, b, t)
        h, rate = c - bent, wave(b, -a, t)
    found = []
    with np.errstate(all="ignore"):
        for k in range(2):
            # of the quotient's own derivatives: each from the one before
            place = h[k] / h[2]
            slope = (rate[k] - place * rate[2]) / h[2]
            bend = (bent[k] - slope * rate[2] * 2.0 - place * bent[2]) / h[2]
            greatest = np.where(bend.known, bend.magnitude, np.inf)
            found.append(greatest.reshape(-1, CONIC_PARTS).max(axis=1))
    return np.column_stack(found)


def bezier_box(points: Array) -> tuple[Array, Array]:
    """(low, high), each (..., 2), around rational Bezier curves' points (..., n, 3), homogeneous
    (w u, w v, w)."""
    places = points[..., :2] / points[..., 2:]
    margin = BOX_MARGIN * np.abs(places).max(axis=-2)
    return places.min(axis=-2) - margin, places.max(axis=-2) + margin


def bezier_bend(points: Array) -> Array:
    """(..., 2) bounds of |u''| and |v''| over the parameter in [0, 1], of rational Bezier curves'
    points (..., n, 3), homogeneous (w u, w v, w).

    With c = h / w moved so that its middle is 0, c' = (h' - c w') / w and
    c'' = (h'' - 2 c' w' - c w'') / w; nets bound each.
    """
    w = points[..., 2:]
    places = points[..., :2] / w
    middle = 0.5 * (places.min(axis=-2, keepdims=True) + places.max(axis=-2, keepdims=True))
    degree = points.shape[-2] - 1
    slopes = degree * np.diff(points[..., :2] - w * middle, axis=-2)
    w_slope = degree * np.diff(w, axis=-2)
    if degree > 1:
        bends, w_bend = (
            (degree - 1) * np.diff(slopes, axis=-2),
            (degree - 1) * np.diff(w_slope, axis=-2),
        )
    else:
        bends, w_bend = 0.0 * slopes, 0.0 * w_slope
    least, away = w.min(axis=-2), np.abs(places - middle).max(axis=-2)
    turn = np.abs(w_slope).max(axis=-2)
    first = (np.abs(slopes).max(axis=-2) + away * turn) / least
    second = np.abs(bends).max(axis=-2) + 2.0 * first * turn
    return np.asarray((second + away * np.abs(w_bend).max(axis=-2)) / least)
