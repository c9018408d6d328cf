"""Bodies given by NumPy formulas of their support points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff_studies.oracles import Placed, Point, Shape

from .bounds import cut

Array = NDArray[Any]


class FormulaShape(Shape):
    """A strictly convex body whose support points are ``formula(normals)``, (k, 3) -> (k, 3)."""

    def __init__(self, formula: Callable[[Array], Array], bounding_radius: float) -> None:
        self.formula = formula
        self.bounding_radius = float(bounding_radius)

    def points(self, normals: Array) -> Array:
        return self.formula(normals)

    def outside(self, points: Array) -> Array:
        """How far points lie outside; 0 inside, and within the bracket of cutting planes."""
        return np.array([self._outside(point) for point in points])

    def _outside(self, p: Array) -> float:
        found = cut(Placed(self, np.eye(3), np.zeros(3)), Placed(Point(), np.eye(3), p), p)
        return 0.0 if found is None else max(found.value, 0.0)


def sum_of_ellipsoids(matrices: Sequence[ArrayLike]) -> FormulaShape:
    """The Minkowski sum of ellipsoids ``A_i`` (unit ball): ``s(n) = sum |A_i^T n|``."""
    maps = [np.asarray(a, dtype=float) for a in matrices]

    def formula(normals: Array) -> Array:
        found = np.zeros_like(normals)
        for a in maps:
            ball = normals @ a
            found = found + (ball / np.sqrt((ball * ball).sum(axis=1))[:, None]) @ a.T
        return found

    return FormulaShape(formula, sum(float(np.linalg.norm(a, 2)) for a in maps))
