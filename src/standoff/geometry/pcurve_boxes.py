"""Boxes in (u, v) around trimming curves."""

from __future__ import annotations

import numpy as np

from standoff.geometry.interval_vectors import stacked, wave
from standoff.geometry.intervals import Interval, interval
from standoff.geometry.tolerances import BOX_MARGIN
from standoff.geometry.validation import Array
from standoff.kernels.body import layout as L

# Parts of a conic with varying weight, each bounded separately.
CONIC_PARTS = 8


def pcurve_box(kind: int, matrix: Array, first: float, last: float) -> tuple[Array, Array]:
    """(low, high), each (2,), around a LINE or CONIC of ``Pcurve`` where its weight is positive."""
    steps = np.linspace(first, last, 2 if kind == L.LINE else CONIC_PARTS + 1)
    t = Interval(steps[:-1], steps[1:])
    if kind == L.LINE:
        ends = matrix[:, [0]] * steps + matrix[:, [2]]
        return bezier_box(ends.T)
    a, b, c = (interval(column[:, None]) for column in matrix.T)
    h = wave(a, b, t) + c
    with np.errstate(all="ignore"):
        places = stacked([h[0] / h[2], h[1] / h[2]])
    seen = places.known.all(axis=0)
    return places.lo[:, seen].min(axis=1), places.hi[:, seen].max(axis=1)


def bezier_box(points: Array) -> tuple[Array, Array]:
    """The same for a rational Bezier curve's points (n, 3), homogeneous (w u, w v, w)."""
    places = points[:, :2] / points[:, 2:]
    margin = BOX_MARGIN * np.abs(places).max(axis=0)
    return places.min(axis=0) - margin, places.max(axis=0) + margin


def bezier_bend(points: Array) -> Array:
    """(2,) bounds of |u''| and |v''| over the parameter in [0, 1], of a rational Bezier curve's
    points (n, 3), homogeneous (w u, w v, w).

    With c = h / w moved so that its middle is 0, c' = (h' - c w') / w and
    c'' = (h'' - 2 c' w' - c w'') / w; nets bound each.
    """
    w = points[:, 2]
    places = points[:, :2] / w[:, None]
    middle = 0.5 * (places.min(axis=0) + places.max(axis=0))
    degree = len(points) - 1
    moved = points[:, :2] - w[:, None] * middle
    slopes, bends = degree * np.diff(moved, axis=0), np.zeros((1, 2))
    w_slope, w_bend = degree * np.diff(w), np.zeros(1)
    if degree > 1:
        bends = (degree - 1) * np.diff(slopes, axis=0)
        w_bend = (degree - 1) * np.diff(w_slope)
    least = float(w.min())
    away = np.abs(places - middle).max(axis=0)
    first = (np.abs(slopes).max(axis=0) + away * np.abs(w_slope).max()) / least
    second = np.abs(bends).max(axis=0) + 2.0 * first * np.abs(w_slope).max()
    return np.asarray((second + away * np.abs(w_bend).max()) / least)
