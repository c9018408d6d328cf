"""Points and segments, and the bodies that a ball sweeps over them."""

from __future__ import annotations

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.topology import Edge
from standoff.geometry.curves import Line
from standoff.geometry.validation import positive


def point() -> Body:
    """The origin, a body of one vertex.

    Returns
    -------
    Body
    """
    return Body.from_brep([np.zeros(3)], name="point")


def segment(length: float) -> Body:
    """A segment of the z axis, centred.

    Parameters
    ----------
    length : float
        From end to end, length, positive.

    Returns
    -------
    Body

    Raises
    ------
    ValueError
        A number that is not finite, not positive, beyond 1e50 or below 1e-50.
    """
    half = 0.5 * positive(length, "length")
    ends = np.array([[0.0, 0.0, -half], [0.0, 0.0, half]])
    return Body.from_brep(ends, [Edge(Line(ends[0], ends[1]), 0, 1)], name="segment")


def sphere(r: float) -> Body:
    """A ball about the origin: a point with a swept radius.

    Parameters
    ----------
    r : float
        Radius, length, positive.

    Returns
    -------
    Body

    Raises
    ------
    ValueError
        A number that is not finite, not positive, beyond 1e50 or below 1e-50.
    """
    return Body.from_brep([np.zeros(3)], radius=positive(r, "r"), name="sphere")


def capsule(r: float, length: float) -> Body:
    """A segment of the z axis with a swept radius, centred.

    Parameters
    ----------
    r : float
        Radius, length, positive.
    length : float
        Of the segment, so of the cylindrical part, length, positive.

    Returns
    -------
    Body

    Raises
    ------
    ValueError
        A number that is not finite, not positive, beyond 1e50 or below 1e-50.
    """
    r, half = positive(r, "r"), 0.5 * positive(length, "length")
    ends = np.array([[0.0, 0.0, -half], [0.0, 0.0, half]])
    return Body.from_brep(ends, [Edge(Line(ends[0], ends[1]), 0, 1)], radius=r, name="capsule")
