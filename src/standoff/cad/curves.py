"""Curves of OpenCASCADE as the library's own, and how their parameters are related."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from standoff.cad.opencascade import coordinates, frame_of
from standoff.cad.tolerances import FITTED_TRIM, SAME_KNOT
from standoff.errors import StandoffError
from standoff.geometry.bernstein import basis as bernstein
from standoff.geometry.curves import FULL_TURN, ConicArc, Curve, Line
from standoff.geometry.knots import GREATEST_DEGREE
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.geometry.tolerances import WHOLE_CONIC
from standoff.typing import Array

# Degree of a fitted curve, how often a span is halved at most, and values compared within each.
FIT_DEGREE = 7
MOST_HALVINGS = 5
BETWEEN = 12


class NoExactForm(StandoffError):
    """A curve or surface that the library has no exact form of."""


@dataclass(frozen=True)
class Converted:
    """A curve, and its parameter as a function of OpenCASCADE's: t = scale * t_file + shift.

    `affine` is False where the two are not related so; then only the points agree.
    """

    curve: Curve
    scale: float = 1.0
    shift: float = 0.0
    affine: bool = True

    def own(self, t: Array) -> Array:
        """The file's parameters of own ones."""
        return (t - self.shift) / self.scale


def basis_of(curve: Any) -> Any:
    """A curve without its trims; in the class of its kind."""
    while curve.DynamicType().Name() in ("Geom_TrimmedCurve", "Geom2d_TrimmedCurve"):
        curve = curve.BasisCurve()
    return curve


def converted(geometry: Any, first: float, last: float) -> Converted:
    """A Geom_Curve from first to last.

    Raises NoExactForm: an offset curve, or a spline of too high a degree. Raises StandoffError: a
    curve without length.
    """
    curve = basis_of(geometry)
    kind = curve.DynamicType().Name()
    if kind == "Geom_Line":
        scale = 1.0 / (last - first)
        ends = (coordinates(curve.Value(t)) for t in (first, last))
        return Converted(Line(*ends), scale, -first * scale)
    if kind in ("Geom_Circle", "Geom_Ellipse"):
        axes, centre = frame_of(curve.Position())
        a, b = radii(curve, kind)
        if abs(last - first - FULL_TURN) <= 4.0 * WHOLE_CONIC * max(1.0, abs(last)) * FULL_TURN:
            last = first + FULL_TURN
        return Converted(ConicArc(centre, a * axes[:, 0], b * axes[:, 1], first, last))
    if kind in ("Geom_BSplineCurve", "Geom_BezierCurve"):
        if curve.Degree() > GREATEST_DEGREE:
            return Converted(fitted_curve(curve, first, last))
        return Converted(NurbsCurve(*spline_of(curve, first, last)))
    if kind in ("Geom_Hyperbola", "Geom_Parabola"):
        from OCP.Geom import Geom_TrimmedCurve
        from OCP.GeomConvert import GeomConvert

        arc = GeomConvert.CurveToBSplineCurve_s(Geom_TrimmedCurve(curve, first, last))
        own = NurbsCurve(*spline_of(arc, arc.FirstParameter(), arc.LastParameter()))
        return Converted(own, affine=False)
    raise NoExactForm(f"a curve of the kind {kind.removeprefix('Geom_')} has no exact form here")


def fitted_curve(curve: Any, first: float, last: float) -> NurbsCurve:
    """A spline of lower degree near one of a degree that is too high. How far it is from its two
    faces is bounded with its trimming curves."""

    def places(ts: Array) -> Array:
        return np.array([coordinates(curve.Value(t)) for t in ts.tolist()])

    return NurbsCurve(*approximated(places, breaks_of(curve, first, last)))


def breaks_of(curve: Any, first: float, last: float) -> Array:
    """The ends of a range, and the knots of a curve between them."""
    knots: list[float] = []
    if curve.DynamicType().Name().endswith("BSplineCurve"):
        knots = [curve.Knot(k) for k in range(1, curve.NbKnots() + 1)]
    near = SAME_KNOT * (last - first)
    return np.array([first, *(t for t in knots if first + near < t < last - near), last])


def approximated(places: Callable[[Array], Array], breaks: Array) -> tuple[Array, Array]:
    """(points, knots) of a spline near a function that is smooth between breaks: each span is
    halved until values between those that it takes agree, or often enough."""
    middles = (np.arange(BETWEEN) + 0.5) / BETWEEN
    basis = bernstein(FIT_DEGREE, middles)
    halvings = np.zeros(len(breaks) - 1, dtype=np.int64)
    while True:
        points, knots = interpolated(places, breaks)
        nets = [points[k * FIT_DEGREE : (k + 1) * FIT_DEGREE + 1] for k in range(len(halvings))]
        at = np.concatenate([a + middles * (b - a) for a, b in pairwise(breaks)])
        off = np.abs(np.concatenate([basis @ net for net in nets]) - places(at)).max(axis=1)
        off = off.reshape(-1, BETWEEN).max(axis=1)
        due = (off > FITTED_TRIM * np.ptp(points, axis=0).max()) & (halvings < MOST_HALVINGS)
        if not due.any():
            return points, knots
        middle = 0.5 * (breaks[:-1] + breaks[1:])[due]
        halvings = np.repeat(halvings + due, due + 1)
        breaks = np.sort(np.concatenate([breaks, middle]))


def interpolated(places: Callable[[Array], Array], breaks: Array) -> tuple[Array, Array]:
    """(points, knots) of the continuous spline of degree FIT_DEGREE that has the values of a
    function at the Chebyshev points of each span, ends included."""
    nodes = 0.5 - 0.5 * np.cos(np.pi * np.arange(FIT_DEGREE + 1) / FIT_DEGREE)
    nodes[0], nodes[-1] = 0.0, 1.0
    ts = np.concatenate([a + nodes[:-1] * (b - a) for a, b in pairwise(breaks)] + [breaks[-1:]])
    values = places(ts)
    basis = bernstein(FIT_DEGREE, nodes)
    rows: list[Array] = [values[:1]]
    for span in range(len(breaks) - 1):
        part = values[span * FIT_DEGREE : (span + 1) * FIT_DEGREE + 1]
        net = np.linalg.solve(basis, part)
        net[-1] = part[-1]
        rows.append(np.asarray(net[1:], dtype=np.float64))
    knots = np.concatenate([breaks[:1], np.repeat(breaks, FIT_DEGREE), breaks[-1:]])
    return np.concatenate(rows), knots


def isoline(flat: Any, surface: Any) -> tuple[Any, float] | None:
    """The curve u = const or v = const of a surface along a line in (u, v), with the shift from the
    line's parameter to the curve's; None where the line is not along u or v."""
    if flat is None or basis_of(flat).DynamicType().Name() != "Geom2d_Line":
        return None
    line = basis_of(flat)
    at, way = coordinates(line.Location()), coordinates(line.Direction())
    along = int(abs(way[1]) > abs(way[0]))
    if way[1 - along] != 0.0:
        return None
    curve = surface.UIso(at[0]) if along else surface.VIso(at[1])
    if way[along] > 0.0:
        return curve, float(at[along])
    return curve.Reversed(), float(curve.ReversedParameter(at[along]))


def radii(curve: Any, kind: str) -> tuple[float, float]:
    """Semi-axes of a circle or an ellipse, in space or in the plane."""
    if kind.endswith("Circle"):
        return curve.Radius(), curve.Radius()
    return curve.MajorRadius(), curve.MinorRadius()


def spline_of(curve: Any, first: float, last: float) -> tuple[Array, Array, Array | None]:
    """(points, knots, weights or None) of a B-spline or Bezier curve from first to last, in space
    or in the plane."""
    if curve.DynamicType().Name().endswith("BezierCurve"):
        if curve.DynamicType().Name().startswith("Geom2d"):
            from OCP.Geom2dConvert import Geom2dConvert

            curve = Geom2dConvert.CurveToBSplineCurve_s(curve)
        else:
            from OCP.GeomConvert import GeomConvert

            curve = GeomConvert.CurveToBSplineCurve_s(curve)
    if curve.Degree() > GREATEST_DEGREE:
        raise NoExactForm(f"a spline of degree {curve.Degree()}; the greatest is {GREATEST_DEGREE}")
    curve = curve.Copy()
    whole = (curve.FirstParameter(), curve.LastParameter())
    if curve.IsPeriodic() or first > whole[0] or last < whole[1]:
        if not curve.IsPeriodic():
            first, last = max(first, whole[0]), min(last, whole[1])
        curve.Segment(first, last)
    if curve.IsPeriodic():
        curve.SetNotPeriodic()
    count = curve.NbPoles()
    points = np.array([coordinates(curve.Pole(k)) for k in range(1, count + 1)])
    weights = None
    if curve.IsRational():
        weights = np.array([curve.Weight(k) for k in range(1, count + 1)])
    knots = repeated(
        [curve.Knot(k) for k in range(1, curve.NbKnots() + 1)],
        [curve.Multiplicity(k) for k in range(1, curve.NbKnots() + 1)],
    )
    return points, knots, weights


def repeated(knots: list[float], times: list[int]) -> Array:
    """Knots as often as they occur."""
    return np.repeat(np.array(knots), np.array(times))
