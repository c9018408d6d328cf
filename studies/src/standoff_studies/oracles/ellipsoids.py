"""Ellipsoids, and superellipsoids: balls of nested p-norms, whose supports are the dual norms."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff_studies.oracles.shape import TINY, Region, dot, unit

Array = NDArray[Any]


class Ellipsoid(Region):
    """An ellipsoid with semi-axes ``a, b, c``."""

    def __init__(self, a: float, b: float, c: float) -> None:
        self.axes: Array = np.array([a, b, c], dtype=float)
        self.bounding_radius = float(self.axes.max())

    def points(self, normals: Array) -> Array:
        return self.axes * unit(self.axes * normals)

    def outside(self, points: Array) -> Array:
        scaled = points / self.axes
        gauge = np.linalg.norm(scaled, axis=1)
        slope = np.linalg.norm(scaled / self.axes, axis=1) / np.maximum(gauge, TINY)
        return np.asarray((gauge - 1) / np.maximum(slope, TINY))


class Superellipsoid(Region):
    """``(|x/a|^(2/e2) + |y/b|^(2/e2))^(e2/e1) + |z/c|^(2/e1) <= 1``, 0 < e1, e2 < 2.

    Its gauge is a p-norm within a p-norm, so its support function is the same with the dual
    exponents 2/(2 - e), and the support point is its gradient.
    """

    def __init__(self, a: float, b: float, c: float, e1: float, e2: float) -> None:
        if not (0 < e1 < 2 and 0 < e2 < 2):
            raise ValueError(f"exponents e1 = {e1}, e2 = {e2} must lie between 0 and 2")
        self.axes: Array = np.array([a, b, c], dtype=float)
        self.inner, self.outer = 2 / e2, 2 / e1
        self.dual_inner, self.dual_outer = 2 / (2 - e2), 2 / (2 - e1)
        self.bounding_radius = float(np.linalg.norm(self.axes))

    def points(self, normals: Array) -> Array:
        gradient = nested_norm(normals * self.axes, self.dual_inner, self.dual_outer)[1]
        return np.asarray(gradient * self.axes)

    def outside(self, points: Array) -> Array:
        gauge, gradient = nested_norm(points / self.axes, self.inner, self.outer)
        steepness = np.sqrt(dot(gradient / self.axes, gradient / self.axes))
        return np.where(steepness > 0, (gauge - 1) / np.maximum(steepness, TINY), -self.axes.min())


def norm_and_slopes(x: Array, y: Array, p: float) -> tuple[Array, Array, Array]:
    """Return ``(|x|^p + |y|^p)^(1/p)`` and its derivatives by x and y, for rows; 0 at (0, 0)."""
    scale = np.maximum(np.abs(x), np.abs(y))
    safe = np.where(scale > 0, scale, 1)
    # the greater one is 1 now, so no power underflows
    a, b = np.abs(x) / safe, np.abs(y) / safe
    power_a, power_b = a ** (p - 1), b ** (p - 1)
    total = np.maximum(power_a * a + power_b * b, TINY)
    value = total ** (1 / np.asarray(p, dtype=x.dtype))
    slope = np.where(scale > 0, value / total, 0)
    return scale * value, np.sign(x) * power_a * slope, np.sign(y) * power_b * slope


def nested_norm(rows: Array, inner: float, outer: float) -> tuple[Array, Array]:
    """Return the outer norm of (inner norm of (x, y), z) and its gradient, for rows (k, 3)."""
    around, by_x, by_y = norm_and_slopes(rows[:, 0], rows[:, 1], inner)
    value, by_around, by_z = norm_and_slopes(around, rows[:, 2], outer)
    return value, np.stack([by_around * by_x, by_around * by_y, by_z], axis=1)
