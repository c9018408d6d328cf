"""How far a point lies outside a shape: what makes a distance between two points an upper bound."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff_studies.oracles import (
    Affine,
    Box,
    Capsule,
    Cone,
    Egg,
    Gore,
    RoundedPolytope,
    Shape,
    Sphere,
    Spindle,
    Superellipsoid,
)

from .features import core_point
from .formulas import FormulaShape
from .patches import BezierBody
from .revolved import RevolvedHull
from .surfaces import quadrics

Curved = Superellipsoid | RoundedPolytope | Spindle | Gore | Egg | RevolvedHull
Curved = Curved | FormulaShape | BezierBody

Array = NDArray[Any]


def outside(shape: Shape, point: ArrayLike) -> float:
    """Return how far a body-frame point lies outside a shape: zero or less inside.

    The greatest signed distance to one of the shape's surfaces, of first order for curved ones:
    zero on the boundary, and positive exactly for points outside.

    Raises
    ------
    TypeError
        The shape is not a set of quadratic inequalities, no cone, not swept, nor one that knows.
    """
    p = np.asarray(point, dtype=float)
    if isinstance(shape, Curved):
        return float(shape.outside(p[None])[0])
    if isinstance(shape, Affine) and isinstance(shape.shape, Cone | Curved):
        back = np.linalg.solve(shape.matrix, p - shape.shift)
        return outside(shape.shape, back) * float(np.linalg.norm(shape.matrix, 2))
    if isinstance(shape, Sphere | Capsule | Box):
        return float(np.linalg.norm(p - core_point(shape, p))) - shape.sweep
    if isinstance(shape, Cone):
        slope = shape.radius / shape.height
        radial = float(np.hypot(p[0], p[1]))
        side = (radial - slope * (shape.height / 2 - p[2])) / float(np.hypot(1.0, slope))
        return max(side, -shape.height / 2 - p[2])
    system = quadrics(shape)
    heights = system.distances(p)
    return float(np.where(system.equality, np.abs(heights), heights).max())
