"""From a ``[bodies.NAME]`` table to a body: one small reader for each shape."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from standoff.bodies import shapes
from standoff.bodies.body import Body
from standoff.geometry import ConicArc, Curve, FormulaCurve, Line, NurbsCurve, RationalBezier
from standoff.scene.patches import read_patches
from standoff.scene.reader import SceneTable
from standoff.typing import Array

UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""Turns the plane of scene curves, x and y, to that of profiles, x and z."""


class ShapeKind(NamedTuple):
    """One shape: its keys beside `rounding`, and what reads them."""

    keys: tuple[str, ...]
    read: Callable[[SceneTable], Body]


def _rounding(table: SceneTable) -> float:
    return table.not_negative("rounding", 0.0)


def _point(table: SceneTable) -> Body:
    return shapes.point(rounding=_rounding(table))


def _segment(table: SceneTable) -> Body:
    rounding = _rounding(table)
    if "length" in table:
        table.only_one(("length", "start"))
        return shapes.segment(table.not_negative("length"), rounding=rounding)
    if "start" not in table and "end" not in table:
        table.required("length", "length = 1.0 (or start = [...] and end = [...])")
    start, end = table.vector("start", 3), table.vector("end", 3)
    return shapes.segment(start=start, end=end, rounding=rounding)


def _sphere(table: SceneTable) -> Body:
    return shapes.sphere(table.not_negative("radius"), rounding=_rounding(table))


def _ellipsoid(table: SceneTable) -> Body:
    semi_axes = table.positive_vector("semi_axes", 3)
    return shapes.ellipsoid(semi_axes=semi_axes, rounding=_rounding(table))


def _capsule(table: SceneTable) -> Body:
    radius, length = table.not_negative("radius"), table.not_negative("length")
    return shapes.capsule(radius, length, rounding=_rounding(table))


def _cylinder(table: SceneTable) -> Body:
    radius, height = table.positive("radius"), table.positive("height")
    return shapes.cylinder(radius, height, rounding=_rounding(table))


def _cone(table: SceneTable) -> Body:
    radius, height = table.positive("radius"), table.positive("height")
    return shapes.cone(radius, height, rounding=_rounding(table))


def _box(table: SceneTable) -> Body:
    return shapes.box(size=table.positive_vector("size", 3), rounding=_rounding(table))


def _polygon(table: SceneTable) -> Body:
    vertices = table.points("vertices", 3, at_least=3)
    return shapes.polygon(vertices, rounding=_rounding(table))


def _polytope(table: SceneTable) -> Body:
    vertices = table.points("vertices", 3, at_least=4)
    return shapes.polytope(vertices, rounding=_rounding(table))


def _lens(table: SceneTable) -> Body:
    radius, offset = table.positive("radius"), table.positive("offset")
    return shapes.lens(radius, offset, rounding=_rounding(table))


def _cap(table: SceneTable) -> Body:
    radius, offset = table.positive("radius"), table.number("offset")
    return shapes.cap(radius, offset, rounding=_rounding(table))


def _halfspace(table: SceneTable) -> Body:
    normal = table.vector("normal", 3) if "normal" in table else (0.0, 0.0, 1.0)
    return shapes.halfspace(normal, table.number("offset", 0.0), rounding=_rounding(table))


def _planar_loop(table: SceneTable) -> Body:
    curves = [read_curve(entry) for entry in table.tables("curves")]
    return shapes.planar_loop(curves, _rounding(table))


def _rounded_polytope(table: SceneTable) -> Body:
    vertices = table.points("vertices", 3, at_least=4)
    return shapes.rounded_polytope(vertices, table.not_negative("rounding"))


def _spindle(table: SceneTable) -> Body:
    radius, length = table.positive("radius"), table.positive("length")
    return shapes.spindle(radius, length, table.count("patches", 3), rounding=_rounding(table))


def _gore(table: SceneTable) -> Body:
    radius, height = table.positive("radius"), table.positive("height")
    return shapes.gore(radius, height, table.count("patches", 4), rounding=_rounding(table))


def _egg(table: SceneTable) -> Body:
    radius, length = table.positive("radius"), table.positive("length")
    return shapes.egg(radius, length, table.number("taper", 0.4), rounding=_rounding(table))


def _hull_of_revolution(table: SceneTable) -> Body:
    profile = read_curve(table.table("curve")).transformed(UPRIGHT, np.zeros(3))
    return shapes.hull_of_revolution(profile, rounding=_rounding(table))


def _superellipsoid(table: SceneTable) -> Body:
    return shapes.superellipsoid(
        semi_axes=table.positive_vector("semi_axes", 3),
        exponents=table.positive_vector("exponents", 2),
        rounding=_rounding(table),
    )


def _patches(table: SceneTable) -> Body:
    patches = read_patches(table)
    tolerance = table.positive("tolerance") if "tolerance" in table else None
    dent = "convexity_tolerance"
    return Body.from_patches(
        patches,
        tolerance=tolerance,
        convexity_tolerance=table.not_negative(dent) if dent in table else None,
        rounding=_rounding(table),
        name="patches",
    )


SHAPES: Mapping[str, ShapeKind] = {
    "point": ShapeKind((), _point),
    "segment": ShapeKind(("length", "start", "end"), _segment),
    "sphere": ShapeKind(("radius",), _sphere),
    "ellipsoid": ShapeKind(("semi_axes",), _ellipsoid),
    "capsule": ShapeKind(("radius", "length"), _capsule),
    "cylinder": ShapeKind(("radius", "height"), _cylinder),
    "cone": ShapeKind(("radius", "height"), _cone),
    "box": ShapeKind(("size",), _box),
    "polygon": ShapeKind(("vertices",), _polygon),
    "polytope": ShapeKind(("vertices",), _polytope),
    "lens": ShapeKind(("radius", "offset"), _lens),
    "cap": ShapeKind(("radius", "offset"), _cap),
    "halfspace": ShapeKind(("normal", "offset"), _halfspace),
    "planar_loop": ShapeKind(("curves",), _planar_loop),
    "rounded_polytope": ShapeKind(("vertices",), _rounded_polytope),
    "spindle": ShapeKind(("radius", "length", "patches"), _spindle),
    "gore": ShapeKind(("radius", "height", "patches"), _gore),
    "egg": ShapeKind(("radius", "length", "taper"), _egg),
    "hull_of_revolution": ShapeKind(("curve",), _hull_of_revolution),
    "superellipsoid": ShapeKind(("semi_axes", "exponents"), _superellipsoid),
    "patches": ShapeKind(
        ("patches", "file", "tolerance", "convexity_tolerance"),
        _patches,
    ),
}
"""Every shape that a scene may name."""

NUMBERS: Mapping[str, int] = {
    **dict.fromkeys(("radius", "length", "height", "offset", "taper", "rounding", "scale"), 1),
    "semi_axes": 3,
    "size": 3,
    "exponents": 2,
}
"""Keys whose value is a number, or a list of so many: those that can change from row to row."""

NO_LENGTHS = ("taper", "scale", "exponents")
"""Which of them have no unit; the others are lengths."""

SAME_SIZE = ("box", "rounded_polytope")
"""Shapes that do not grow with their `rounding`."""


def swept_keys(shape: str) -> tuple[str, ...]:
    """Return the keys whose numbers add up to the radius of the ball that is swept over a shape's
    core, and that change nothing else of it."""
    if shape in SAME_SIZE:
        return ()
    return ("radius", "rounding") if shape in ("sphere", "capsule") else ("rounding",)


def read_body(table: SceneTable, beside: Sequence[str] = ()) -> Body:
    """Return the convex body that a ``[bodies.NAME]`` table describes.

    Raises SceneError: at an unknown shape or key, or a value that the shape refuses.

    Parameters
    ----------
    table : SceneTable
        With ``shape``, the shape's own keys, and optionally ``scale`` or ``affine``.
    beside : sequence of str
        Keys of the table that are not the shape's.

    Returns
    -------
    Body
        In its own frame, as `standoff.shapes` gives it, then scaled.
    """
    kind = SHAPES[table.choice("shape", list(SHAPES))]
    table.expect("shape", "affine", "scale", "rounding", *kind.keys, *beside)
    affine = _affine(table)
    body = table.build(lambda: kind.read(table))
    if affine is None:
        return body
    return table.build(lambda: body.transformed(affine), table.only_one(("affine", "scale")))


def _affine(table: SceneTable) -> Array | None:
    given = table.only_one(("affine", "scale"))
    if given == "affine":
        return table.matrix("affine", ((3, 3), (4, 4)))
    if given == "scale":
        return np.diag(table.positive_vector("scale", 3, or_one=True))
    return None


# From a ``[[bodies.NAME.curves]]`` table to a planar curve.


class CurveKind(NamedTuple):
    """One kind of curve: its keys, and what reads them."""

    keys: tuple[str, ...]
    read: Callable[[SceneTable], Curve]


def _line(table: SceneTable) -> Curve:
    start, end = table.vector("start", 2), table.vector("end", 2)
    return table.build(lambda: Line(start, end))


def _bezier(table: SceneTable) -> Curve:
    points = table.points("control_points", 2, at_least=2)
    weights = table.numbers("weights") if "weights" in table else None
    return table.build(lambda: RationalBezier(points, weights))


def _ellipse(table: SceneTable) -> Curve:
    centre = table.vector("centre", 2)
    a, b = table.positive_vector("semi_axes", 2)
    tilt = table.number("tilt", 0.0)
    first, last = table.number("start_angle", 0.0), table.number("end_angle", math.tau)
    along = np.array([math.cos(tilt), math.sin(tilt)])
    across = np.array([-along[1], along[0]])
    return table.build(lambda: ConicArc(centre, a * along, b * across, first, last))


def _nurbs(table: SceneTable) -> Curve:
    points = table.points("control_points", 2, at_least=2)
    knots = table.numbers("knots")
    weights = table.numbers("weights") if "weights" in table else None
    return table.build(lambda: NurbsCurve(points, knots, weights))


def _formula(table: SceneTable) -> Curve:
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


def read_curve(table: SceneTable) -> Curve:
    """Return the planar curve that one table of ``curves`` describes.

    Raises SceneError: at an unknown kind or key, or a value that the curve refuses.
    """
    kind = CURVES[table.choice("kind", list(CURVES))]
    table.expect("kind", *kind.keys)
    return kind.read(table)
