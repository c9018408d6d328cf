"""Points and segments, and the bodies that a ball sweeps over them."""

from __future__ import annotations

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.topology import Edge
from standoff.geometry.curves import Line
from standoff.geometry.validation import positive


def point() -> Body:
    """The origin."""
    return Body.from_brep([np.zeros(3)], name="point")


def segment(length: float) -> Body:
    """A segment of the z axis."""
    half = 0.5 * positive(length, "length")
    ends = np.array([[0.0, 0.0, -half], [0.0, 0.0, half]])
    return Body.from_brep(ends, [Edge(Line(ends[0], ends[1]), 0, 1)], name="segment")


def sphere(r: float) -> Body:
    """A point with a swept radius."""
    return Body.from_brep([np.zeros(3)], radius=positive(r, "r"), name="sphere")


def capsule(r: float, length: float) -> Body:
    """A segment with a swept radius; `length` is that of the segment."""
    r, half = positive(r, "r"), 0.5 * positive(length, "length")
    ends = np.array([[0.0, 0.0, -half], [0.0, 0.0, half]])
    return Body.from_brep(ends, [Edge(Line(ends[0], ends[1]), 0, 1)], radius=r, name="capsule")
