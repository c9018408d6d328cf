"""A local minimum of the distance from a point to one curve of a planar body."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from standoff.points.planar_boundary import PlanarBoundary
from standoff.points.state import Leg
from standoff.points.tolerances import PARAMETER_AT_REST
from standoff.tracking.state import TrackerState
from standoff.typing import Array

MINIMUM_STEPS = 60
"""Most Newton steps to a minimum: more than any start between two samples was seen to need."""

STEP_HALVINGS = 40
"""Most halvings of one step: then it is below roundoff."""


class OnCurve(NamedTuple):
    """Where a minimum stands.

    Attributes
    ----------
    edge : int
        Its curve.
    t : float
        Its parameter.
    distance : float
        Without sign [length].
    residual : float
        As in `Minimum` [length].
    law : TrackerState or None
        Of the paper's law that keeps it; None where it is descended to.
    """

    edge: int
    t: float
    distance: float
    residual: float
    law: TrackerState | None


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


def standing(
    boundary: PlanarBoundary, edge: int, t: float, x: Array, law: TrackerState | None = None
) -> OnCurve:
    """Return what there is at a parameter of a curve, seen from a point, (2,)."""
    curve = boundary.curves[edge]
    c, c1, _ = curve.jet(t)
    away = c[:2] - x
    slope = float(c1[:2] @ away) / math.hypot(*c1[:2])
    held = not curve.closed and (
        (t <= curve.first and slope >= 0.0) or (t >= curve.last and slope <= 0.0)
    )
    return OnCurve(edge, float(t), math.hypot(*away), 0.0 if held else abs(slope), law)


def apart(boundary: PlanarBoundary, edge: int, t: float, s: float) -> float:
    """Return the part of a curve's range between two parameters; on a closed one the lesser."""
    curve = boundary.curves[edge]
    away = abs(t - s) / (curve.last - curve.first)
    return min(away, 1.0 - away) if curve.closed else away


def slope_into(
    boundary: PlanarBoundary, leg: Leg
) -> Callable[[Array, Array | None], tuple[float, float]] | None:
    """Return the switching function of a leg between a curve and the vertex at its end; else None.

    It is the slope of the distance at the vertex along the curve into it [-], and its rate [1/s],
    of a place and a velocity, (3,); negative in the curve's region.
    """
    vertex = next((f.index for f in leg[:2] if f.kind == "vertex"), None)
    edge = next((f.index for f in leg[:2] if f.kind == "edge"), None)
    if vertex is None or edge is None:
        return None
    part, corner = boundary.body.edge_parts[edge], boundary.body.vertex_points[vertex]
    first = part.first == vertex
    tangent = part.curve.jet(part.curve.first if first else part.curve.last)[1]
    into = tangent / (math.hypot(*tangent) * (1.0 if first else -1.0))

    def slope(x: Array, v: Array | None) -> tuple[float, float]:
        away = x - corner
        d = math.hypot(*away)
        if d == 0.0:
            return math.nan, math.nan
        n = away / d
        rate = math.nan if v is None else float(-into @ (v - n * (n @ v)) / d)
        return float(-into @ n), rate

    return slope
