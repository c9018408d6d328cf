"""Spline surfaces of too high a degree, as near ones of a lower degree with a proven bound."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import scipy
from numpy.typing import NDArray

from standoff.cad.tolerances import FITTED_TRIM
from standoff.geometry.bernstein import basis as bernstein
from standoff.geometry.bernstein import segment
from standoff.geometry.knots import GREATEST_DEGREE, KnotVector, bezier_spans
from standoff.typing import Array

LOWER = 8
"""The degree in place of one that is too high."""
MOST_PARTS = 16
"""Parts of each span at most."""

Net = tuple[Array, Array | None, Array, Array, float]


def lowered(points: Array, weights: Array | None, knots_u: Array, knots_v: Array) -> Net:
    """(points, weights, knots_u, knots_v, moved) of a spline of degrees that the kernels have.

    Each span is cut into as many equal parts as it needs and interpolated at Chebyshev points,
    sides included, so that neighbours keep their common side. `moved` is a bound of how far it is
    from the given one, length: from the differences of the Bernstein coefficients, which enclose
    that of the surfaces.
    """
    w = np.ones(points.shape[:2]) if weights is None else weights
    h = np.concatenate([points * w[..., None], w[..., None]], axis=2)
    size = float(np.linalg.norm(np.ptp(points.reshape(-1, 3), axis=0)))
    moved = 0.0
    knots = [knots_u, knots_v]
    for axis in (0, 1):
        degree = len(knots[axis]) - h.shape[axis] - 1
        if degree <= GREATEST_DEGREE:
            continue
        net = np.moveaxis(h, axis, 0)
        vector = KnotVector(knots[axis], degree)
        parts = np.ones(len(vector.breaks) - 1, dtype=np.int64)
        while True:
            found, own, off = _lowered(net, vector, parts)
            far = np.array([_distance(away, found, points) for away in off])
            again = (far > FITTED_TRIM * size) & (parts < MOST_PARTS)
            if not again.any():
                break
            parts[again] *= 2
        h, knots[axis], moved = np.moveaxis(found, 0, axis), own, moved + float(far.max())
    polynomial = weights is None
    return h[..., :3] / h[..., 3:], None if polynomial else h[..., 3], knots[0], knots[1], moved


def _lowered(
    net: Array, vector: KnotVector, parts: NDArray[np.int64]
) -> tuple[Array, Array, Array]:
    """(net, knots, off) along the first axis, each span in so many parts; off: of each span, the
    greatest differences of the components of homogeneous coefficients, (spans, 4)."""
    nodes = 0.5 - 0.5 * np.cos(np.pi * np.arange(LOWER + 1) / LOWER)
    nodes[0], nodes[-1] = 0.0, 1.0
    solve = np.linalg.inv(bernstein(LOWER, nodes)) @ bernstein(vector.degree, nodes)
    solve[0], solve[-1] = np.eye(vector.degree + 1)[[0, -1]]
    raised = _elevation(LOWER, vector.degree)
    rows: list[Array] = []
    breaks, off = [], np.zeros((len(parts), 4))
    spans = zip(bezier_spans(vector), pairwise(vector.breaks), strict=True)
    for k, ((start, matrix), (a, b)) in enumerate(spans):
        whole = np.tensordot(matrix, net[start : start + vector.degree + 1], 1)
        for first, last in pairwise(np.linspace(0.0, 1.0, int(parts[k]) + 1)):
            part = np.tensordot(segment(vector.degree, float(first), float(last)), whole, 1)
            low = np.tensordot(solve, part, 1)
            away = np.abs(np.tensordot(raised, low, 1) - part)
            off[k] = np.maximum(off[k], away.reshape(-1, 4).max(axis=0))
            rows.append(low if not rows else low[1:])
            breaks.append(a + first * (b - a))
    breaks.append(float(vector.breaks[-1]))
    ends = np.array(breaks)
    knots = np.concatenate([ends[:1], np.repeat(ends, LOWER), ends[-1:]])
    return np.concatenate(rows), knots, off


def _elevation(low: int, high: int) -> Array:
    """(high + 1, low + 1): Bernstein coefficients of a higher degree from those of a lower one."""
    i, j = np.arange(high + 1)[:, None], np.arange(low + 1)
    comb = scipy.special.comb
    return np.asarray(comb(low, j) * comb(high - low, i - j) / comb(high, i))


def _distance(off: Array, net: Array, points: Array) -> float:
    """How far points may move if their homogeneous coordinates change by `off`, length."""
    reach = float(np.linalg.norm(points.reshape(-1, 3), axis=1).max())
    least = float(net[..., 3].min()) - float(off[3])
    return (float(np.linalg.norm(off[:3])) + reach * float(off[3])) / least
