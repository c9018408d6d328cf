"""Points and segments, and the bodies that a ball swept over them makes."""

from __future__ import annotations

from typing import Any, overload

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.topology import Edge
from standoff.checks.numbers import magnitude_or_zero
from standoff.errors import StandoffTypeError
from standoff.geometry.curves import Line
from standoff.geometry.validation import vector3
from standoff.typing import Array


def point(*, rounding: float = 0.0) -> Body:
    """The origin, as a body of one vertex.

    Raises ValueError: a rounding that is negative or not finite.

    Parameters
    ----------
    rounding : float
        Radius of a ball swept over it, length, zero or above: a sphere.

    Returns
    -------
    Body
    """
    radius = magnitude_or_zero(rounding, "rounding")
    return Body.from_brep([np.zeros(3)], rounding=radius, name="sphere" if radius else "point")


@overload
def segment(length: float, *, rounding: float = ...) -> Body: ...


@overload
def segment(start: Any, /, end: Any, *, rounding: float = ...) -> Body: ...


@overload
def segment(*, start: Any, end: Any, rounding: float = ...) -> Body: ...


def segment(
    length: Any = None, end: Any = None, *, start: Any = None, rounding: float = 0.0
) -> Body:
    """A segment of the z axis, centred; or the one from `start` to `end`.

    Raises TypeError: neither a length nor both ends, or all of them. Raises ValueError: a number
    that is not finite, a length or rounding that is negative, or beyond 1e50, or between 0 and
    1e-50.

    Parameters
    ----------
    length : float
        From end to end, length, zero or above; 0 is a point.
    start, end : (3,) array_like
        Its ends, body frame, length; given together, by name or as ``segment(start, end)``, instead
        of `length`.
    rounding : float
        Radius of a ball swept over it, length, zero or above: a capsule.

    Returns
    -------
    Body
    """
    if start is None and end is not None:
        start, length = length, None
    if (length is None) == (start is None) or (start is None) != (end is None):
        raise StandoffTypeError(
            "so.shapes.segment takes length=..., or start=(x, y, z) and end=(x, y, z)."
        )
    radius = magnitude_or_zero(rounding, "rounding")
    if length is not None:
        ends = _upright(magnitude_or_zero(length, "length"))
    else:
        ends = np.array([vector3(start, "start"), vector3(end, "end")])
    return _swept(ends, radius, "capsule" if radius else "segment")


def sphere(radius: float, *, rounding: float = 0.0) -> Body:
    """A ball about the origin: a point with a swept radius.

    Raises ValueError: a number that is not finite, negative, beyond 1e50, or between 0 and 1e-50.

    Parameters
    ----------
    radius : float
        Length, zero or above; 0 is a point.
    rounding : float
        Radius of a ball swept over it, length, zero or above: it adds to the radius.

    Returns
    -------
    Body
    """
    return point(
        rounding=magnitude_or_zero(radius, "radius") + magnitude_or_zero(rounding, "rounding")
    )


def capsule(radius: float, length: float, *, rounding: float = 0.0) -> Body:
    """A segment of the z axis with a swept radius, centred.

    Raises ValueError: a number that is not finite, negative, beyond 1e50, or between 0 and 1e-50.

    Parameters
    ----------
    radius : float
        Length, zero or above; 0 is a segment.
    length : float
        Of the segment, and so of the cylindrical part, length, zero or above; 0 is a sphere.
    rounding : float
        Radius of a ball swept over it, length, zero or above: it adds to the radius.

    Returns
    -------
    Body
    """
    swept = magnitude_or_zero(radius, "radius") + magnitude_or_zero(rounding, "rounding")
    return segment(length, rounding=swept)


def _upright(length: float) -> Array:
    return np.array([[0.0, 0.0, -0.5 * length], [0.0, 0.0, 0.5 * length]])


def _swept(ends: Array, radius: float, name: str) -> Body:
    """The segment between two ends, or a point if they are equal."""
    if np.array_equal(ends[0], ends[1]):
        name = "sphere" if radius else "point"
        # removes the sign of zeros, so that the digest is that of a point
        return Body.from_brep(ends[:1] + 0.0, rounding=radius, name=name)
    edge = Edge(Line(ends[0], ends[1]), 0, 1)
    return Body.from_brep(ends, [edge], rounding=radius, name=name)
