"""From a ``[[bodies.NAME.curves]]`` table to a planar curve."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from standoff.geometry import ConicArc, Curve, FormulaCurve, Line, NurbsCurve, RationalBezier
from standoff.scene.reader import Table


class CurveKind(NamedTuple):
    """One kind of curve: its keys, and what reads them."""

    keys: tuple[str, ...]
    read: Callable[[Table], Curve]


def _line(table: Table) -> Curve:
    start, end = table.vector("start", 2), table.vector("end", 2)
    return table.build(lambda: Line(start, end))


def _bezier(table: Table) -> Curve:
    points = table.points("control_points", 2, at_least=2)
    weights = table.numbers("weights") if "weights" in table else None
    return table.build(lambda: RationalBezier(points, weights))


def _ellipse(table: Table) -> Curve:
    centre = table.vector("centre", 2)
    a, b = table.positive_vector("semi_axes", 2)
    tilt = table.number("tilt", 0.0)
    first, last = table.number("start_angle", 0.0), table.number("end_angle", math.tau)
    along = np.array([math.cos(tilt), math.sin(tilt)])
    across = np.array([-along[1], along[0]])
    return table.build(lambda: ConicArc(centre, a * along, b * across, first, last))


def _nurbs(table: Table) -> Curve:
    points = table.points("control_points", 2, at_least=2)
    knots = table.numbers("knots")
    weights = table.numbers("weights") if "weights" in table else None
    return table.build(lambda: NurbsCurve(points, knots, weights))


def _formula(table: Table) -> Curve:
    x, y = table.formula("x"), table.formula("y")
    first, last = table.number("start"), table.number("end")
    parameters = table.named_numbers("parameters")
    return table.build(lambda: FormulaCurve(x, y, "0", first, last, parameters))


CURVES: Mapping[str, CurveKind] = {
    "line": CurveKind(("start", "end"), _line),
    "bezier": CurveKind(("control_points", "weights"), _bezier),
    "nurbs": CurveKind(("control_points", "knots", "weights"), _nurbs),
    "formula": CurveKind(("x", "y", "start", "end", "parameters"), _formula),
    "ellipse": CurveKind(("centre", "semi_axes", "tilt", "start_angle", "end_angle"), _ellipse),
}
"""Every curve that a planar loop may be made of."""


def read_curve(table: Table) -> Curve:
    """Return the planar curve that one table of ``curves`` describes.

    Raises SceneError: at an unknown kind or key, or a value that the curve refuses.
    """
    kind = CURVES[table.choice("kind", list(CURVES))]
    table.expect("kind", *kind.keys)
    return kind.read(table)
