"""Bodies of planes and quadrics of revolution, and ellipsoids."""

from __future__ import annotations

from typing import Any, overload

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.shapes.arguments import by_position, positive_numbers
from standoff.bodies.topology import Apex, Edge, Face
from standoff.checks.numbers import magnitude, magnitude_or_zero, number
from standoff.errors import StandoffError
from standoff.geometry.curves import ConicArc
from standoff.geometry.quadrics import Cone, Cylinder, Plane, Sphere, sphere_atlas
from standoff.geometry.validation import vector3
from standoff.typing import Array

# Cosine up to which an axis is perpendicular enough to a normal for a plane's first direction.
SQUARE_ENOUGH = 0.8
# A single gnomonic chart is enough for a face up to this tangent of the angle from its centre.
SINGLE_CHART_REACH = 3.0


@overload
def ellipsoid(a: float, b: float, c: float, /, *, rounding: float = ...) -> Body: ...


@overload
def ellipsoid(semi_axes: Any, *, rounding: float = ...) -> Body: ...


def ellipsoid(*axes: Any, semi_axes: Any = None, rounding: float = 0.0) -> Body:
    """An ellipsoid about the origin: one smooth face with an atlas of six charts.

    Raises TypeError: Semi-axes that are missing, or given twice. Raises ValueError: a number that
    is not finite, a semi-axis that is not positive, a rounding that is negative; a length beyond
    1e50 or below 1e-50.

    Parameters
    ----------
    *axes : float
        The semi-axes, one by one: ``ellipsoid(a, b, c)``.
    semi_axes : (3,) array_like
        Along x, y, z, length, positive.
    rounding : float
        Radius of a ball swept over it, length, zero or above: the body grows by it all round.

    Returns
    -------
    Body
    """
    given = by_position("ellipsoid", axes, {"semi_axes": 3}, {"semi_axes": semi_axes})
    linear = np.diag(positive_numbers(given["semi_axes"], "semi_axes", 3))
    return Body.from_brep(
        faces=[Face(sphere_atlas(linear, np.zeros(3)))],
        rounding=magnitude_or_zero(rounding, "rounding"),
        name="ellipsoid",
    )


def cylinder(radius: float, height: float, *, rounding: float = 0.0) -> Body:
    """A cylinder about the axis z, centred.

    It has two discs and a side without a seam; the rims are closed edges.

    Raises ValueError: a number that is not finite, a length that is not positive, a rounding that
    is negative; a length beyond 1e50 or below 1e-50.

    Parameters
    ----------
    radius : float
        Length, positive.
    height : float
        From disc to disc, length, positive.
    rounding : float
        Radius of a ball swept over it, length, zero or above: the body grows by it all round.

    Returns
    -------
    Body
    """
    r, half = magnitude(radius, "radius"), 0.5 * magnitude(height, "height")
    rounding = magnitude_or_zero(rounding, "rounding")
    x, y = np.array([r, 0.0, 0.0]), np.array([0.0, r, 0.0])
    low, high = np.array([0.0, 0.0, -half]), np.array([0.0, 0.0, half])
    edges = [Edge(ConicArc(low, x, y)), Edge(ConicArc(high, x, y))]
    faces = [
        Face((Cylinder(np.diag([r, r, 1.0]), np.zeros(3)),), ((0, 1), (1, -1))),
        Face((Plane.through(low, y / r, x / r),), ((0, -1),)),
        Face((Plane.through(high, x / r, y / r),), ((1, 1),)),
    ]
    return Body.from_brep(edges=edges, faces=faces, rounding=rounding, name="cylinder")


def cone(radius: float, height: float, *, rounding: float = 0.0) -> Body:
    """A cone about the axis z: its base at -height/2, its apex at +height/2.

    Raises ValueError: a number that is not finite, a length that is not positive, a rounding that
    is negative; a length beyond 1e50 or below 1e-50.

    Parameters
    ----------
    radius : float
        Of the base, length, positive.
    height : float
        From base to apex, length, positive.
    rounding : float
        Radius of a ball swept over it, length, zero or above: the body grows by it all round.

    Returns
    -------
    Body
    """
    r, height = magnitude(radius, "radius"), magnitude(height, "height")
    rounding = magnitude_or_zero(rounding, "rounding")
    x, y = np.array([r, 0.0, 0.0]), np.array([0.0, r, 0.0])
    base, apex = np.array([0.0, 0.0, -0.5 * height]), np.array([0.0, 0.0, 0.5 * height])
    side = Cone(np.diag([r, r, -height]), apex)
    return Body.from_brep(
        [apex],
        [Edge(ConicArc(base, x, y))],
        [
            Face((side,), ((0, 1),), (Apex(0, 0.0, 0.0, 2.0 * np.pi),)),
            Face((Plane.through(base, y / r, x / r),), ((0, -1),)),
        ],
        rounding=rounding,
        name="cone",
    )


def cap(radius: float, offset: float, *, rounding: float = 0.0) -> Body:
    """The part z >= offset of a ball about the origin: a disc and a spherical face.

    Raises ValueError: a number that is not finite, a radius that is not positive, an offset that
    leaves nothing or the whole ball; a rounding that is negative.

    Parameters
    ----------
    radius : float
        Of the ball, length, positive.
    offset : float
        Height z of the disc, length; above -radius and below radius.
    rounding : float
        Radius of a ball swept over it, length, zero or above: the body grows by it all round.

    Returns
    -------
    Body
    """
    r = magnitude(radius, "radius")
    rounding = magnitude_or_zero(rounding, "rounding")
    h = number(offset, "offset")
    if not -r < h < r:
        raise StandoffError(
            f"Cap with offset = {h} outside (-{r}, {r}): it is empty, or a ball.", "offset", h
        )
    rim = float(np.sqrt((r - h) * (r + h)))
    x, y = np.array([rim, 0.0, 0.0]), np.array([0.0, rim, 0.0])
    base = np.array([0.0, 0.0, h])
    frame = r * np.eye(3)
    charts: tuple[Sphere, ...] = (Sphere(frame, np.zeros(3)),)
    if h <= 0.0 or rim / h > SINGLE_CHART_REACH:
        charts = sphere_atlas(frame, np.zeros(3))
    return Body.from_brep(
        edges=[Edge(ConicArc(base, x, y))],
        faces=[
            Face(charts, ((0, 1),)),
            Face((Plane.through(base, y / rim, x / rim),), ((0, -1),)),
        ],
        rounding=rounding,
        name="cap",
    )


def halfspace(normal: Any = (0.0, 0.0, 1.0), offset: float = 0.0, *, rounding: float = 0.0) -> Body:
    """The half-space normal · x <= offset, by default z <= 0: one plane without a boundary.

    Raises ValueError: a normal of length zero; a number that is not finite; a rounding that is
    negative.

    Parameters
    ----------
    normal : (3,) array_like
        Outward, of any length except zero: only its direction counts.
    offset : float
        Of the plane from the origin along the unit normal, length; may be negative.
    rounding : float
        Radius of a ball swept over it, length, zero or above: the plane moves out by it.

    Returns
    -------
    Body
        Unbounded: its partner must be bounded.
    """
    axes, shift = _plane_of(vector3(normal, "normal"), number(offset, "offset"))
    plane = Plane.through(shift, axes[0], axes[1])
    return Body.from_brep(
        faces=[Face((plane,))],
        rounding=magnitude_or_zero(rounding, "rounding"),
        name="halfspace",
    )


def _plane_of(normal: Array, offset: float) -> tuple[Array, Array]:
    """Two unit vectors perpendicular to a normal, right-handed with it, and the plane's point
    nearest to the origin."""
    largest = float(np.abs(normal).max())
    if largest == 0.0:
        raise StandoffError(
            f"normal = {normal} has no direction: give the plane's outward normal.",
            "normal",
            normal,
        )
    n = normal / largest
    n = n / np.linalg.norm(n)
    x = np.cross(np.eye(3)[1 if abs(n[1]) < SQUARE_ENOUGH else 2], n)
    x = x / np.linalg.norm(x)
    return np.array([x, np.cross(n, x)]), offset * n
