"""Superellipsoids: nested p-norm balls, whose support functions are the dual nested norms."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .shape import Shape, dot

Array = NDArray[Any]


def norm_and_slopes(x: Array, y: Array, p: float) -> tuple[Array, Array, Array]:
    """Return ``(|x|^p + |y|^p)^(1/p)`` and its derivatives by x and y, for rows; 0 at (0, 0)."""
    scale = np.maximum(np.abs(x), np.abs(y))
    safe = np.where(scale > 0, scale, 1)
    a, b = np.abs(x) / safe, np.abs(y) / safe
    value = (a**p + b**p) ** (1 / np.asarray(p, dtype=x.dtype))
    length = np.where(value > 0, value, 1)
    slope_x = np.sign(x) * (a / length) ** (p - 1)
    slope_y = np.sign(y) * (b / length) ** (p - 1)
    return scale * value, np.where(scale > 0, slope_x, 0), np.where(scale > 0, slope_y, 0)


def nested_norm(rows: Array, inner: float, outer: float) -> tuple[Array, Array]:
    """Return the outer norm of (inner norm of (x, y), z) and its gradient, for rows (k, 3)."""
    around, by_x, by_y = norm_and_slopes(rows[:, 0], rows[:, 1], inner)
    value, by_around, by_z = norm_and_slopes(around, rows[:, 2], outer)
    return value, np.stack([by_around * by_x, by_around * by_y, by_z], axis=1)


class Superellipsoid(Shape):
    """``(|x/a|^(2/e2) + |y/b|^(2/e2))^(e2/e1) + |z/c|^(2/e1) <= 1``, 0 < e1, e2 < 2."""

    def __init__(self, a: float, b: float, c: float, e1: float, e2: float) -> None:
        if not (0 < e1 < 2 and 0 < e2 < 2):
            raise ValueError(f"exponents e1 = {e1}, e2 = {e2} must lie between 0 and 2")
        self.axes: Array = np.array([a, b, c], dtype=float)
        self.inner, self.outer = 2 / e2, 2 / e1
        self.dual_inner, self.dual_outer = 2 / (2 - e2), 2 / (2 - e1)
        self.bounding_radius = float(np.linalg.norm(self.axes))

    def points(self, normals: Array) -> Array:
        """The gradient of the support function, which is the dual norm of ``axes * n``."""
        gradient = nested_norm(normals * self.axes, self.dual_inner, self.dual_outer)[1]
        return gradient * self.axes

    def outside(self, point: ArrayLike) -> float:
        """How far a point lies outside: first-order, from the gauge."""
        row = np.asarray(point, dtype=float)[None] / self.axes
        gauge, gradient = nested_norm(row, self.inner, self.outer)
        steepness = float(np.sqrt(dot(gradient / self.axes, gradient / self.axes))[0])
        return (float(gauge[0]) - 1) / steepness if steepness > 0 else -float(self.axes.min())
