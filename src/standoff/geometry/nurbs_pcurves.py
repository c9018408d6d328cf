"""NURBS trimming curves, kept as Bezier pieces that a straight line meets at most twice."""

from __future__ import annotations

from itertools import pairwise
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
import scipy

from standoff.checks.arrays import finite
from standoff.errors import StandoffError
from standoff.geometry.knots import bezier_spans, knot_vector
from standoff.geometry.nurbs import checked_weights
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.tolerances import INFLECTION, INFLECTION_ROUNDOFF, STRAIGHT_PCURVE
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import pcurve_jet, pcurve_jets
from standoff.typing import Array

# A piece of a NURBS pcurve turns by less than this (radians): 180 degrees with a margin.
MOST_TURN = 0.9 * np.pi
TURN_POINTS = 65
# Greatest number of halvings until a piece turns little; one with a cusp never would.
PIECE_HALVINGS = 20


class BezierPcurve(Pcurve):
    """A rational Bezier curve in (u, v) over [first, last]: points (n + 1, 3), (w u, w v, w)."""

    first: float
    last: float

    def __init__(self, points: Array, first: float, last: float) -> None:
        object.__setattr__(self, "kind", L.BEZIER)
        object.__setattr__(self, "matrix", np.asarray(points, dtype=np.float64))
        object.__setattr__(self, "first", float(first))
        object.__setattr__(self, "last", float(last))

    @property
    def data(self) -> Array:
        return np.concatenate([[len(self.matrix) - 1.0], self.matrix.ravel()])

    def turned(self, angle: float, k: int = 0) -> BezierPcurve:
        shift = np.outer(self.matrix[:, 2], angle * np.eye(3)[k])
        return BezierPcurve(self.matrix + shift, self.first, self.last)

    def pieces(self, first: float, last: float) -> list[tuple[Pcurve, float, float]]:
        return [(_part(self, first, last), first, last)]

    def _block(self) -> Array:
        return np.concatenate([[self.first, self.last], self.data])

    def homogeneous(self, t: float) -> tuple[Array, Array, Array]:
        h, ht, htt = pcurve_jet(self._block(), self.kind, 2, t)
        return np.array(h), np.array(ht), np.array(htt)

    def homogeneous_at(self, ts: Array) -> Array:
        found = np.empty((len(ts), 9))
        pcurve_jets(self._block(), self.kind, 2, np.ascontiguousarray(ts), found)
        return found.reshape(-1, 3, 3)


class NurbsPcurve(Pcurve):
    """A NURBS curve in (u, v) with its edge's parameter.

    Raises ValueError as for `NurbsSurface`.

    Parameters
    ----------
    control_points : (n, 2) array, surface parameters
    knots : (n + degree + 1,) array, edge parameter; clamped or not, uniform or not
    weights : (n,) array, positive; ones by default
    """

    spans: list[BezierPcurve]
    knots: Array

    def __init__(self, control_points: Any, knots: Any, weights: Any = None) -> None:
        points = finite(control_points, "control_points", (-1, 2))
        vector = knot_vector(knots, len(points), "knots", "control points")
        w = checked_weights(weights, points)
        rows = np.column_stack([points * w[:, None], w])
        spans = [
            BezierPcurve(matrix @ rows[start : start + vector.degree + 1], a, b)
            for (start, matrix), (a, b) in zip(
                bezier_spans(vector), pairwise(vector.breaks), strict=True
            )
        ]
        object.__setattr__(self, "kind", L.BEZIER)
        object.__setattr__(self, "matrix", rows)
        object.__setattr__(self, "spans", spans)
        object.__setattr__(self, "knots", vector.knots)

    def homogeneous(self, t: float) -> tuple[Array, Array, Array]:
        return next((s for s in self.spans if t <= s.last), self.spans[-1]).homogeneous(t)

    def homogeneous_at(self, ts: Array) -> Array:
        found = np.empty((len(ts), 3, 3))
        ends = [s.last for s in self.spans[:-1]]
        owners = np.searchsorted(ends, ts, side="left")
        for k in np.unique(owners):
            found[owners == k] = self.spans[k].homogeneous_at(ts[owners == k])
        return found

    def pieces(self, first: float, last: float) -> list[tuple[Pcurve, float, float]]:
        known = KNOWN_PIECES.setdefault(self, {})
        if (first, last) not in known:
            within = [(s, max(first, s.first), min(last, s.last)) for s in self.spans]
            parts = [_part(span, a, b) for span, a, b in within if a < b]
            known[first, last] = [(p, p.first, p.last) for p in _turning_pieces(parts)]
        return known[first, last]


KNOWN_PIECES: WeakKeyDictionary[
    NurbsPcurve, dict[tuple[float, float], list[tuple[Pcurve, float, float]]]
] = WeakKeyDictionary()
"""Pieces of curves, which who makes one and who packs it both ask for."""


def _part(span: BezierPcurve, a: float, b: float) -> BezierPcurve:
    """The part of a Bezier span over [a, b], by de Casteljau."""
    first, last = span.first, span.last
    points = span.matrix
    if b < last:
        points = _split(points, (b - first) / (last - first))[0]
    if a > first:
        points = _split(points, (a - first) / (b - first))[1]
    return BezierPcurve(points, a, b)


def _split(points: Array, s: float) -> tuple[Array, Array]:
    left, right = [points[0]], [points[-1]]
    while len(points) > 1:
        points = (1.0 - s) * points[:-1] + s * points[1:]
        left.append(points[0])
        right.append(points[-1])
    return np.array(left), np.array(right[::-1])


def _turning_pieces(parts: list[BezierPcurve]) -> list[BezierPcurve]:
    """Parts of one degree cut at inflections, then until each turns by less than 180 degrees."""
    if not parts:
        return []
    ends = np.array([(part.first, part.last) for part in parts])
    ts, rows = _sampled(parts, ends, 16 * len(parts[0].matrix))
    bends = np.linalg.det(rows)
    bends[np.abs(bends) <= _bend_roundoff(parts, ends, rows)] = 0.0
    greatest = np.abs(bends).max(axis=1, keepdims=True)
    bends[np.abs(bends) <= STRAIGHT_PCURVE * greatest] = 0.0
    inflected = bends[:, :-1] * bends[:, 1:] < 0.0
    found = []
    for part, (first, last), times, where in zip(parts, ends.tolist(), ts, inflected, strict=True):
        if not where.any():
            found.append(part)
            continue
        cuts = [_inflection(part, *times[k : k + 2]) for k in np.flatnonzero(where)]
        found += [_part(part, a, b) for a, b in pairwise([first, *cuts, last]) if a < b]
    return _halved(found)


def _sampled(parts: list[BezierPcurve], ends: Array, count: int) -> tuple[Array, Array]:
    """(m, count) parameters along m parts, and the homogeneous jets (m, count, 3, 3) there."""
    ts = np.linspace(ends[:, 0], ends[:, 1], count, axis=1)
    return ts, np.array([part.homogeneous_at(t) for part, t in zip(parts, ts, strict=True)])


def _inflection(part: BezierPcurve, before: float, after: float) -> float:
    block = part._block()

    def bend(t: float) -> float:
        (a, b, c), (d, e, f), (g, h, k) = pcurve_jet(block, L.BEZIER, 2, t)
        return float(a * (e * k - f * h) + b * (f * g - d * k) + c * (d * h - e * g))

    return float(scipy.optimize.brentq(bend, before, after, xtol=INFLECTION))


def _bend_roundoff(parts: list[BezierPcurve], ends: Array, rows: Array) -> Array:
    """(m, n) roundoff of the determinants of homogeneous jets (m, n, 3, 3): that of the derivatives
    is a share of what control points of this size may have, however straight the curve is."""
    rate = (len(parts[0].matrix) - 1) / (ends[:, 1] - ends[:, 0])
    first = rate * np.abs([part.matrix for part in parts]).max(axis=(1, 2))
    first, second = first[:, None], (rate * first)[:, None]
    h, ht, htt = np.moveaxis(np.linalg.norm(rows, axis=3), 2, 0)
    return np.asarray(INFLECTION_ROUNDOFF * h * (ht * second + first * htt))


def _halved(parts: list[BezierPcurve], halvings: int = 0) -> list[BezierPcurve]:
    """Parts halved until each turns by less than `MOST_TURN`."""
    ends = np.array([(part.first, part.last) for part in parts])
    h, ht, _ = np.moveaxis(_sampled(parts, ends, TURN_POINTS)[1], 2, 0)
    ways = (ht[..., :2] - ht[..., 2:] * h[..., :2] / h[..., 2:]) / h[..., 2:]
    turns = np.diff(np.arctan2(ways[..., 1], ways[..., 0]), axis=1)
    total = np.abs((turns + np.pi) % (2.0 * np.pi) - np.pi).sum(axis=1)
    found = []
    for part, turn in zip(parts, total, strict=True):
        if turn < MOST_TURN:
            found.append(part)
            continue
        middle = 0.5 * (part.first + part.last)
        if halvings == PIECE_HALVINGS:
            raise StandoffError(
                f"The trimming curve turns back on itself at its parameter {middle:.9g}: give one "
                "without a cusp."
            )
        halves = [_part(part, part.first, middle), _part(part, middle, part.last)]
        found += _halved(halves, halvings + 1)
    return found
