"""Local minima of the distance from a point to the curves of a planar body, one by one."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from standoff.points.planar_boundary import PlanarBoundary
from standoff.points.tolerances import PARAMETER_AT_REST

Array = NDArray[np.float64]

MINIMUM_STEPS = 60
"""Most Newton steps to a minimum: more than any start between two samples was seen to need."""

STEP_HALVINGS = 40
"""Most halvings of one step: then it is below roundoff."""


def descend(boundary: PlanarBoundary, edge: int, t: float, x: Array) -> float:
    """Return the parameter of the local minimum that a start leads to, by safeguarded Newton.

    Parameters
    ----------
    boundary : PlanarBoundary
    edge : int
    t : float
        Start.
    x : ndarray, shape (2,)
        The point, in the body's frame.
    """
    curve = boundary.curves[edge]
    span = curve.last - curve.first
    for _ in range(MINIMUM_STEPS):
        c, c1, c2 = curve.jet(t)
        away = c[:2] - x
        slope = float(c1[:2] @ away)
        bend = abs(float(c1[:2] @ c1[:2] + c2[:2] @ away))
        step = -slope / bend if bend > 0.0 else -math.copysign(span, slope)
        energy = float(away @ away)
        for _ in range(STEP_HALVINGS):
            new = within(boundary, edge, t + step)
            rest = boundary.point(edge, new) - x
            if float(rest @ rest) <= energy:
                break
            step *= 0.5
        else:
            return t
        moved, t = abs(step) if new != t else 0.0, new
        if moved <= PARAMETER_AT_REST * span:
            break
    return t


def within(boundary: PlanarBoundary, edge: int, t: float) -> float:
    """Return a parameter within its curve's range; on a closed curve by whole turns."""
    curve = boundary.curves[edge]
    if curve.closed:
        return curve.first + (t - curve.first) % (curve.last - curve.first)
    return min(max(t, curve.first), curve.last)


def measured(boundary: PlanarBoundary, edge: int, t: float, x: Array) -> tuple[float, float]:
    """Return distance and residual [length] of a parameter."""
    curve = boundary.curves[edge]
    c, c1, _ = curve.jet(t)
    away = c[:2] - x
    slope = float(c1[:2] @ away) / math.hypot(*c1[:2])
    held = not curve.closed and (
        (t <= curve.first and slope >= 0.0) or (t >= curve.last and slope <= 0.0)
    )
    return math.hypot(*away), 0.0 if held else abs(slope)


def parameter_rate(boundary: PlanarBoundary, edge: int, t: float, x: Array, v: Array) -> float:
    """Return the feedforward of a minimum's parameter, −H⁻¹ g_t, for a point's velocity (2,).

    Zero where the distance has no minimum: there is nothing to keep.
    """
    c, c1, c2 = boundary.curves[edge].jet(t)
    bend = float(c1[:2] @ c1[:2] + c2[:2] @ (c[:2] - x))
    return float(c1[:2] @ v) / bend if bend > 0.0 else 0.0
