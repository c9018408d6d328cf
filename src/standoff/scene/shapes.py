"""From a ``[bodies.NAME]`` table to a body: one small reader for each shape."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from standoff.bodies import shapes
from standoff.bodies.body import Body
from standoff.scene.curves import read_curve
from standoff.scene.patches import read_patches
from standoff.scene.reader import Array, Table

UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""Turns the plane of scene curves, x and y, to that of profiles, x and z."""


class ShapeKind(NamedTuple):
    """One shape: its keys, and what reads them."""

    keys: tuple[str, ...]
    read: Callable[[Table], Body]


def _point(table: Table) -> Body:
    return shapes.point()


def _segment(table: Table) -> Body:
    return shapes.segment(table.positive("length"))


def _sphere(table: Table) -> Body:
    return shapes.sphere(table.positive("radius"))


def _ellipsoid(table: Table) -> Body:
    a, b, c = table.positive_vector("semi_axes", 3)
    return shapes.ellipsoid(a, b, c)


def _capsule(table: Table) -> Body:
    return shapes.capsule(table.positive("radius"), table.positive("length"))


def _cylinder(table: Table) -> Body:
    return shapes.cylinder(table.positive("radius"), table.positive("length"))


def _cone(table: Table) -> Body:
    return shapes.cone(table.positive("radius"), table.positive("height"))


def _box(table: Table) -> Body:
    x, y, z = table.positive_vector("size", 3)
    return shapes.box(x, y, z, rounding=table.not_negative("rounding", 0.0))


def _polytope(table: Table) -> Body:
    return shapes.polytope(table.points("vertices", 3, at_least=4))


def _lens(table: Table) -> Body:
    return shapes.lens(table.positive("radius"), table.positive("offset"))


def _cap(table: Table) -> Body:
    return shapes.cap(table.positive("radius"), table.number("offset"))


def _halfspace(table: Table) -> Body:
    return shapes.halfspace()


def _planar_loop(table: Table) -> Body:
    radius = table.not_negative("radius", 0.0)
    return shapes.planar_loop([read_curve(entry) for entry in table.tables("curves")], radius)


def _rounded_polytope(table: Table) -> Body:
    vertices = table.points("vertices", 3, at_least=4)
    return shapes.rounded_polytope(vertices, table.not_negative("rounding"))


def _spindle(table: Table) -> Body:
    radius, length = table.positive("radius"), table.positive("length")
    return shapes.spindle(radius, length, table.count("patches", 3))


def _gore(table: Table) -> Body:
    radius, height = table.positive("radius"), table.positive("height")
    return shapes.gore(radius, height, table.count("patches", 4))


def _egg(table: Table) -> Body:
    radius, length = table.positive("radius"), table.positive("length")
    return shapes.egg(radius, length, table.number("taper", 0.4))


def _hull_of_revolution(table: Table) -> Body:
    profile = read_curve(table.table("curve"))
    return shapes.hull_of_revolution(profile.transformed(UPRIGHT, np.zeros(3)))


def _superellipsoid(table: Table) -> Body:
    a, b, c = table.positive_vector("semi_axes", 3)
    e1, e2 = table.positive_vector("exponents", 2)
    return shapes.superellipsoid(a, b, c, e1, e2)


def _patches(table: Table) -> Body:
    patches = read_patches(table)
    tolerance = table.positive("tolerance") if "tolerance" in table else None
    dent = "convexity_tolerance"
    return Body.from_patches(
        patches,
        tolerance=tolerance,
        convexity_tolerance=table.not_negative(dent) if dent in table else None,
        radius=table.not_negative("radius", 0.0),
        name="patches",
    )


SHAPES: Mapping[str, ShapeKind] = {
    "point": ShapeKind((), _point),
    "segment": ShapeKind(("length",), _segment),
    "sphere": ShapeKind(("radius",), _sphere),
    "ellipsoid": ShapeKind(("semi_axes",), _ellipsoid),
    "capsule": ShapeKind(("radius", "length"), _capsule),
    "cylinder": ShapeKind(("radius", "length"), _cylinder),
    "cone": ShapeKind(("radius", "height"), _cone),
    "box": ShapeKind(("size", "rounding"), _box),
    "polytope": ShapeKind(("vertices",), _polytope),
    "lens": ShapeKind(("radius", "offset"), _lens),
    "cap": ShapeKind(("radius", "offset"), _cap),
    "halfspace": ShapeKind((), _halfspace),
    "planar_loop": ShapeKind(("curves", "radius"), _planar_loop),
    "rounded_polytope": ShapeKind(("vertices", "rounding"), _rounded_polytope),
    "spindle": ShapeKind(("radius", "length", "patches"), _spindle),
    "gore": ShapeKind(("radius", "height", "patches"), _gore),
    "egg": ShapeKind(("radius", "length", "taper"), _egg),
    "hull_of_revolution": ShapeKind(("curve",), _hull_of_revolution),
    "superellipsoid": ShapeKind(("semi_axes", "exponents"), _superellipsoid),
    "patches": ShapeKind(
        ("patches", "file", "tolerance", "convexity_tolerance", "radius"), _patches
    ),
}
"""Every shape that a scene may name."""


def read_body(table: Table) -> Body:
    """Return the body that a ``[bodies.NAME]`` table describes.

    Parameters
    ----------
    table : Table
        With ``shape``, the shape's own keys, and optionally ``scale`` or ``affine``.

    Returns
    -------
    Body
        In its own frame, as `standoff.shapes` gives it, then scaled.

    Raises
    ------
    SceneError
        At an unknown shape or key, or a value that the shape refuses.
    """
    kind = SHAPES[table.choice("shape", list(SHAPES))]
    table.expect("shape", "affine", "scale", *kind.keys)
    affine = _affine(table)
    body = table.build(lambda: kind.read(table))
    if affine is None:
        return body
    return table.build(lambda: body.transformed(affine), table.only_one(("affine", "scale")))


def _affine(table: Table) -> Array | None:
    given = table.only_one(("affine", "scale"))
    if given == "affine":
        return table.matrix("affine", ((3, 3), (4, 4)))
    if given == "scale":
        return np.diag(table.positive_vector("scale", 3, or_one=True))
    return None
