"""Closed planar loops of Bezier curves and elliptic arcs, as convex shapes in z = 0."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from math import comb
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff_studies.oracles import Shape

Array = NDArray[Any]

SAMPLES = 256
"""Samples of a curve before refinement: resolves every maximum of a low-degree curve."""
REFINEMENTS = 80
"""Safeguarded Newton steps; bisection alone reaches 2**-80 of a sample's width."""
JOIN = 1e-9
"""Greatest gap between consecutive curves, over the loop's size."""


@cache
def _terms(degree: int) -> tuple[Array, Array, Array]:
    rising = np.arange(degree + 1.0)
    return np.array([float(comb(degree, i)) for i in range(degree + 1)]), rising, rising[::-1]


def bernstein(degree: int, t: Array) -> Array:
    """Return the Bernstein polynomials of a degree at parameters (k,): (k, degree + 1)."""
    binomials, rising, falling = _terms(degree)
    return binomials * t[:, None] ** rising * (1 - t)[:, None] ** falling


def elevated(rows: Array, count: int) -> Array:
    """Return the ``count`` Bezier coefficients of the same curve in a higher degree."""
    while len(rows) < count:
        share = np.arange(1, len(rows))[:, None] / len(rows)
        inner = share * rows[:-1] + (1 - share) * rows[1:]
        rows = np.vstack([rows[:1], inner, rows[-1:]])
    return rows


class Curve(Protocol):
    """A planar curve on a parameter interval ``span``."""

    span: tuple[float, float]

    def jet(self, parameters: Array) -> tuple[Array, Array, Array]:
        """Return points, first and second derivatives, each (k, 2)."""
        ...


class BezierCurve:
    """A polynomial (``weights`` None) or rational Bezier curve on [0, 1]."""

    span = (0.0, 1.0)

    def __init__(self, points: ArrayLike, weights: ArrayLike | None = None) -> None:
        self.control: Array = np.asarray(points, dtype=float)
        count = len(self.control)
        self.weights: Array = np.ones(count) if weights is None else np.asarray(weights, float)
        rows = np.column_stack([self.control * self.weights[:, None], self.weights])
        first = (count - 1) * np.diff(rows, axis=0)
        second = (count - 2) * np.diff(first, axis=0) if count > 2 else np.zeros((1, 3))
        # of one degree, so that all are evaluated at once
        self._levels = np.hstack([rows, elevated(first, count), elevated(second, count)])

    def jet(self, parameters: Array) -> tuple[Array, Array, Array]:
        levels = bernstein(len(self._levels) - 1, np.asarray(parameters)) @ self._levels
        top, first, second = levels[:, :3], levels[:, 3:6], levels[:, 6:]
        weight = top[:, 2:]
        point = top[:, :2] / weight
        velocity = (first[:, :2] - point * first[:, 2:]) / weight
        bend = second[:, :2] - 2 * velocity * first[:, 2:] - point * second[:, 2:]
        return point, velocity, bend / weight


class ConicArc:
    """The elliptic arc ``centre + u cos t + v sin t`` for t from ``start`` to ``end``."""

    def __init__(
        self, centre: ArrayLike, u: ArrayLike, v: ArrayLike, start: float, end: float
    ) -> None:
        self.centre: Array = np.asarray(centre, dtype=float)
        self.u: Array = np.asarray(u, dtype=float)
        self.v: Array = np.asarray(v, dtype=float)
        self.span = (float(start), float(end))

    def jet(self, parameters: Array) -> tuple[Array, Array, Array]:
        cos, sin = np.cos(parameters)[:, None], np.sin(parameters)[:, None]
        arm = self.u * cos + self.v * sin
        return self.centre + arm, self.v * cos - self.u * sin, -arm


def line(start: ArrayLike, end: ArrayLike) -> BezierCurve:
    """Return the straight curve between two planar points."""
    return BezierCurve(np.array([start, end], dtype=float))


def curve_maximum(curve: Curve, normals: Array) -> tuple[Array, Array]:
    """Return parameters (k,) and points (k, 2) of greatest ``n.c(t)`` for directions (k, 2)."""
    grid = np.linspace(*curve.span, SAMPLES + 1)
    best = (curve.jet(grid)[0] @ normals.T).argmax(axis=0)
    low, high = grid[np.maximum(best - 1, 0)], grid[np.minimum(best + 1, SAMPLES)]
    t = grid[best].copy()
    for _ in range(REFINEMENTS):
        _, velocity, bend = curve.jet(t)
        slope, curvature = (velocity * normals).sum(axis=1), (bend * normals).sum(axis=1)
        low, high = np.where(slope >= 0, t, low), np.where(slope <= 0, t, high)
        newton = t - slope / np.where(curvature < 0, curvature, -np.inf)
        inside = (newton >= low) & (newton <= high) & (curvature < 0)
        following = np.where(inside, newton, (low + high) / 2)
        if (following == t).all():
            break
        t = following
    ends = np.tile(curve.span, (len(normals), 1))
    options = np.column_stack([t, ends])
    points = np.stack([curve.jet(column)[0] for column in options.T], axis=1)
    chosen = (points * normals[:, None]).sum(axis=2).argmax(axis=1)
    rows = np.arange(len(normals))
    return options[rows, chosen], points[rows, chosen]


class PlanarLoop(Shape):
    """The convex region of z = 0 inside a counter-clockwise loop of ``curves``."""

    dimension = 2

    def __init__(self, curves: Sequence[Curve]) -> None:
        self.curves = list(curves)
        samples = [c.jet(np.linspace(*c.span, SAMPLES + 1))[0] for c in self.curves]
        self.bounding_radius = float(np.linalg.norm(np.vstack(samples), axis=1).max())
        self.corners: Array = np.stack([rows[0] for rows in samples])
        ends = np.stack([rows[-1] for rows in samples])
        miss = np.linalg.norm(ends - np.roll(self.corners, -1, axis=0), axis=1)
        if miss.max() > JOIN * self.bounding_radius:
            raise ValueError(f"curve {miss.argmax()} misses the next one by {miss.max():.3g}")

    def points(self, normals: Array) -> Array:
        flat = normals[:, :2].astype(float)
        found = np.stack([curve_maximum(curve, flat)[1] for curve in self.curves])
        chosen = (found * flat).sum(axis=2).argmax(axis=0)
        best = found[chosen, np.arange(len(flat))]
        return np.column_stack([best, np.zeros(len(best))]).astype(normals.dtype)
