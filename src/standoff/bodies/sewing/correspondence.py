"""The parameter of one side as a function of that of another: pcurves of sewn edges.

An edge runs along its first stretch and has its parameter. On the second patch the trimming curve
is an isoline too. If the parameters are related by s = (a t + b)/(c t + d), like every affine or
linear rational reparametrisation, its pcurve is a straight line; otherwise it is a spline through
the nearest points.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from standoff.bodies.sewing.corners import Stretch
from standoff.bodies.sewing.sides import PatchSide, in_spans
from standoff.bodies.tolerances import (
    AFFINE_SIDE,
    SPLINE_MISS,
    SPLINE_SHARE,
    STRAIGHT_SHARE,
    STRAIGHT_SIDE,
)
from standoff.errors import BodyError
from standoff.geometry.nurbs_pcurves import NurbsPcurve
from standoff.geometry.pcurves import Pcurve
from standoff.kernels.body import layout as L
from standoff.typing import Array

# Fractions of an edge where the correspondence is computed, and (between them) checked.
NODES = 0.5 - 0.5 * np.cos(np.pi * np.arange(1, 12) / 12)
CHECKS = (np.arange(17) + 0.5) / 17
# Halvings of a span of a spline, after which it is accepted as it is.
MAX_CUTS = 7
# Highest degree that the kernels accept; Chebyshev points of [-1, 1] with its ends, descending.
DEGREE = 9
SPAN_NODES = np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE)
SPAN_CHECKS = np.array([0.02, 0.27, 0.46, 0.73, 0.93])


@dataclass(frozen=True, eq=False)
class Correspondence:
    """The pcurve of an edge on its second patch.

    sense : +1 if both free parameters increase together; residual : the greatest distance between
    points of the same parameter, length.
    """

    pcurve: Pcurve
    sense: int
    residual: float


def isoline(side: PatchSide) -> Pcurve:
    """The pcurve of an edge on its first side, which is exact."""
    return _straight(side, np.array([1.0, 0.0]), np.array([0.0, 1.0]))


def correspond(one: Stretch, other: Stretch, size: float) -> Correspondence:
    """The second stretch's parameter as a function of the first one's.

    Raises BodyError: the second stretch runs back and forth along the first.
    """
    sense = 1 if one.first == other.first else -1
    a, b = one.side.first, one.side.last
    ends = (other.side.first, other.side.last)[::sense]
    nodes = np.array([other.side.nearest(one.side.point(a + x * (b - a))) for x in NODES])
    near = float(nodes[:, 1].max())
    row, scale = _moebius(NODES, nodes[:, 0], *ends)
    # from fractions of [a, b] to the edge's own parameter
    width = b - a
    row = np.array([row[0] / width, row[1] - row[0] * a / width])
    scale = np.array([scale[0] / width, scale[1] - scale[0] * a / width])
    times = _times(one.side, other.side)
    points = [one.side.point(float(t)) for t in times]
    straight = (row[0] * times + row[1]) / (scale[0] * times + scale[1])
    residual = _farthest(other.side, straight, points)
    if residual <= near * (1.0 + STRAIGHT_SHARE) + STRAIGHT_SIDE * size:
        return Correspondence(_straight(other.side, row, scale), sense, residual)
    return _spline(one, other, sense, max(SPLINE_MISS * size, SPLINE_SHARE * near))


def _times(side: PatchSide, other: PatchSide) -> Array:
    """Parameters of a side where it is compared: at CHECKS and in every span of both sides."""
    times = side.first + CHECKS * (side.last - side.first)
    if len(side.breaks) > 2 or len(other.breaks) > 2:
        seen = [side.nearest(other.point(float(t)))[0] for t in other.breaks[1:-1]]
        times = np.concatenate([times, in_spans(np.union1d(side.breaks, seen))])
    return times


def _farthest(side: PatchSide, parameters: Array, points: list[Array]) -> float:
    return max(
        float(np.linalg.norm(side.point(float(s)) - x))
        for s, x in zip(parameters, points, strict=True)
    )


def _moebius(x: Array, s: Array, s0: float, s1: float) -> tuple[Array, Array]:
    """(numerator, denominator) of s(x), with s(0) = s0 and s(1) = s1, that fits the nodes best.

    s = (s0 (1 - x) + k s1 x)/(1 - x + k x) for one k > 0; k = 1 is affine.
    """
    left, right = (s - s0) * (1.0 - x), (s1 - s) * x
    k = float(left @ right / (right @ right)) if right.any() else 1.0
    if not k > 0.0 or abs(k - 1.0) < AFFINE_SIDE:
        k = 1.0
    return np.array([k * s1 - s0, s0]), np.array([k - 1.0, 1.0])


def _straight(side: PatchSide, row: Array, scale: Array) -> Pcurve:
    """The isoline at (row . (t, 1))/(scale . (t, 1)) of its free parameter."""
    moving = np.array([row[0], 0.0, row[1]])
    weight = np.array([scale[0], 0.0, scale[1]])
    level = side.level * weight
    rows = (moving, level) if side.name[0] == "v" else (level, moving)
    return Pcurve(L.LINE, np.array([*rows, weight]))


def _spline(one: Stretch, other: Stretch, sense: int, goal: float) -> Correspondence:
    """A piecewise polynomial through the nearest points, subdivided until it is within the goal."""
    a, b = one.side.first, one.side.last
    ends = (other.side.first, other.side.last)[::sense]
    waiting, done = [(a, b, 0)], []
    while waiting:
        low, high, depth = waiting.pop()
        times = 0.5 * (low + high) - 0.5 * (high - low) * SPAN_NODES
        values = np.array([other.side.nearest(one.side.point(float(t)))[0] for t in times])
        if low == a:
            values[0] = ends[0]
        if high == b:
            values[-1] = ends[1]
        if (np.diff(values) * sense <= 0.0).any():
            raise BodyError(
                f"{other.label} runs back and forth along {one.label}: their nearest points are "
                "not in the same order."
            )
        row = np.linalg.solve(_bernstein(0.5 - 0.5 * SPAN_NODES), values)
        if depth == MAX_CUTS or _misfit(one, other, row, low, high) <= goal:
            done.append((low, high, row))
        else:
            middle = 0.5 * (low + high)
            waiting += [(middle, high, depth + 1), (low, middle, depth + 1)]
    knots = np.repeat([d[0] for d in done] + [b], DEGREE)
    knots = np.concatenate([[a], knots, [b]])
    # neighbouring spans share the point where they meet: the same nearest point, to roundoff
    moving = np.concatenate([done[0][2][:1], *(d[2][1:] for d in done)])
    moving[0], moving[-1] = ends
    level = np.full(len(moving), other.side.level)
    columns = (moving, level) if other.side.name[0] == "v" else (level, moving)
    pcurve = NurbsPcurve(np.column_stack(columns), knots)
    index = 0 if other.side.name[0] == "v" else 1
    dense = np.union1d(np.linspace(a, b, 16 * len(done) + 1), _times(one.side, other.side))
    points = [one.side.point(float(t)) for t in dense]
    along = np.array([pcurve.point(float(t))[index] for t in dense])
    return Correspondence(pcurve, sense, _farthest(other.side, along, points))


def _bernstein(x: Array) -> Array:
    """Values of the Bernstein polynomials of DEGREE, (len(x), DEGREE + 1)."""
    k = np.arange(DEGREE + 1)
    values: Array = (
        scipy.special.comb(DEGREE, k) * x[:, None] ** k * (1.0 - x[:, None]) ** (DEGREE - k)
    )
    return values


def _misfit(one: Stretch, other: Stretch, row: Array, low: float, high: float) -> float:
    """How far a span is from the nearest points between its nodes, length in space."""
    fitted = _bernstein(SPAN_CHECKS) @ row
    worst = 0.0
    for x, s in zip(SPAN_CHECKS, fitted, strict=True):
        t, _ = other.side.nearest(one.side.point(float(low + x * (high - low))))
        worst = max(worst, float(np.linalg.norm(other.side.point(float(s)) - other.side.point(t))))
    return worst
