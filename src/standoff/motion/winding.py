"""Winding paths: the helix in space and the spiral in the plane."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike

from standoff.checks.arrays import direction, finite
from standoff.checks.names import choice
from standoff.checks.numbers import not_negative, number, positive
from standoff.motion.bounds import MotionBounds
from standoff.motion.pose import Pose
from standoff.motion.twist import Twist
from standoff.motion.vectors import length
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array

Orientation: TypeAlias = Literal["fixed", "turning"]
"""Whether a winding body keeps the world's axes, or turns once with each winding."""


class Helix(KeepsReadOnly):
    """A body whose origin winds about an axis at a constant distance.

    Raises ValueError if the radius is not positive, the axis is zero, a number is not finite, a
    shape is wrong, or the orientation is unknown.

    Parameters
    ----------
    radius : float
        Distance of the origin from the axis [length], above zero.
    pitch : float
        Advance along the axis in one whole turn [length]; zero gives a circle.
    rate : float
        Turn about the axis, right-handed [rad/s].
    centre : array_like, shape (3,)
        The point of the axis that the body is level with at t = 0, world [length].
    axis : array_like, shape (3,)
        Direction of the axis, world; any length but zero.
    phase : float
        Angle at t = 0 [rad]. For the axis z it counts from the world's x to its y; for another
        axis, from these two turned with the z axis by the least turn (from −z: see `_across`).
    orientation : {"fixed", "turning"}
        Fixed: the body keeps the world's axes. Turning: its x axis points away from the axis of
        the helix, its z axis along it. `Offset` with a pure rotation turns the body in either.
    """

    start = 0.0
    end = math.inf

    def __init__(
        self,
        radius: float,
        pitch: float,
        rate: float,
        centre: ArrayLike = (0.0, 0.0, 0.0),
        axis: ArrayLike = (0.0, 0.0, 1.0),
        phase: float = 0.0,
        orientation: Orientation = "fixed",
    ) -> None:
        self._radius = positive(radius, "radius")
        self._rate = number(rate, "rate")
        self._climb = number(pitch, "pitch") / math.tau * self._rate
        self._centre = finite(centre, "centre", (3,))
        self._axis = direction(axis, "axis")
        self._first, self._second = _across(self._axis)
        self._phase = number(phase, "phase")
        self._turning = _turns(orientation)

    def _radial_and_tangential(self, seconds: float) -> tuple[Array, Array]:
        angle = self._phase + self._rate * seconds
        cosine, sine = math.cos(angle), math.sin(angle)
        return (
            cosine * self._first + sine * self._second,
            cosine * self._second - sine * self._first,
        )

    def pose(self, t: float) -> Pose:
        """Return where the body is at time `t` [s]."""
        seconds = number(t, "t")
        radial, tangential = self._radial_and_tangential(seconds)
        origin = self._centre + self._radius * radial + self._climb * seconds * self._axis
        if not self._turning:
            return Pose.from_checked(np.eye(3), origin)
        return Pose.from_checked(np.column_stack((radial, tangential, self._axis)), origin)

    def twist(self, t: float) -> Twist:
        """Return how the body moves at time `t` [s], in world axes."""
        _, tangential = self._radial_and_tangential(number(t, "t"))
        v = self._radius * self._rate * tangential + self._climb * self._axis
        return Twist(v, self._rate * self._axis if self._turning else np.zeros(3))

    def bounds(self, first: float, last: float, point: Array) -> MotionBounds:
        """Return bounds from time `first` to `last` [s] for a point of the body, (3,)."""
        lengths = length(self._centre) + self._radius
        lengths += abs(self._climb) * max(abs(first), abs(last))
        away, turn = self._radius, 0.0
        if self._turning:
            x, y, _ = point.tolist()
            away, turn = math.hypot(self._radius + x, y), abs(self._rate)
        speed = math.hypot(self._rate * away, self._climb)
        return MotionBounds(speed, self._rate**2 * away, turn, 0.0, self._axis, lengths)

    def breaks(self, first: float, last: float) -> Sequence[float]:
        """Return no times: the twist never jumps."""
        del first, last
        return ()


class Spiral(KeepsReadOnly):
    """A body whose origin follows an Archimedean spiral in the plane z = 0.

    With the angle turned since t = 0, α = rate · t, the origin is at the distance
    ``radius + growth · α`` from the centre, in the direction ``phase + α``.

    Raises ValueError if the radius is negative, a number is not finite, a shape is wrong, or the
    orientation is unknown.

    Parameters
    ----------
    radius : float
        Distance from the centre at t = 0 [length], not negative.
    growth : float
        Change of the distance with the angle turned [length/rad].
    rate : float
        Turn about the centre, from x to y [rad/s].
    centre : array_like, shape (2,)
        World x and y [length].
    phase : float
        Direction at t = 0, from x to y [rad].
    orientation : {"fixed", "turning"}
        Fixed: the body keeps the world's axes. Turning: its x axis points away from the centre.
    """

    start = 0.0
    end = math.inf

    def __init__(
        self,
        radius: float,
        growth: float,
        rate: float,
        centre: ArrayLike = (0.0, 0.0),
        phase: float = 0.0,
        orientation: Orientation = "fixed",
    ) -> None:
        self._radius = not_negative(radius, "radius")
        self._growth = number(growth, "growth")
        self._rate = number(rate, "rate")
        self._centre = np.append(finite(centre, "centre", (2,)), 0.0)
        self._phase = number(phase, "phase")
        self._turning = _turns(orientation)

    def _polar(self, seconds: float) -> tuple[float, Array, Array]:
        turned = self._rate * seconds
        cosine, sine = math.cos(self._phase + turned), math.sin(self._phase + turned)
        radial, tangential = np.array([cosine, sine, 0.0]), np.array([-sine, cosine, 0.0])
        return self._radius + self._growth * turned, radial, tangential

    def pose(self, t: float) -> Pose:
        """Return where the body is at time `t` [s]."""
        distance, radial, tangential = self._polar(number(t, "t"))
        origin = self._centre + distance * radial
        if not self._turning:
            return Pose.from_checked(np.eye(3), origin)
        rotation = np.column_stack((radial, tangential, (0.0, 0.0, 1.0)))
        return Pose.from_checked(rotation, origin)

    def twist(self, t: float) -> Twist:
        """Return how the body moves at time `t` [s], in world axes."""
        distance, radial, tangential = self._polar(number(t, "t"))
        v = self._rate * (self._growth * radial + distance * tangential)
        return Twist(v, (0.0, 0.0, self._rate if self._turning else 0.0))

    def bounds(self, first: float, last: float, point: Array) -> MotionBounds:
        """Return bounds from time `first` to `last` [s] for a point of the body, (3,)."""
        # In polar axes the point stays at (distance + x, y); its velocity is rate times
        # (growth - y, distance + x), its acceleration rate² times (-distance - x, 2 growth - y).
        x, y, _ = point.tolist() if self._turning else (0.0, 0.0, 0.0)
        ends = [self._radius + self._growth * self._rate * t for t in (first, last)]
        away, rate = max(abs(end + x) for end in ends), abs(self._rate)
        # The distance is a sum too, of the radius and the growth.
        lengths = length(self._centre) + 2.0 * self._radius + max(map(abs, ends))
        return MotionBounds(
            rate * math.hypot(self._growth - y, away),
            rate**2 * math.hypot(away, 2.0 * self._growth - y),
            rate if self._turning else 0.0,
            0.0,
            np.array([0.0, 0.0, 1.0]),
            lengths,
        )

    def breaks(self, first: float, last: float) -> Sequence[float]:
        """Return no times: the twist never jumps."""
        del first, last
        return ()


def _turns(orientation: Orientation) -> bool:
    choice(orientation, "orientation", get_args(Orientation))
    return orientation == "turning"


def _across(axis: Array) -> tuple[Array, Array]:
    """Return two unit vectors that make a right-handed frame with the unit vector `axis`.

    They are x and y turned with z by the least turn to an axis above the plane z = 0; for one
    below, x and −y turned with −z. Without a case distinction near any axis (Duff et al.,
    "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017).
    """
    x, y, z = axis
    side = math.copysign(1.0, z)
    scale = -1.0 / (side + z)
    mixed = x * y * scale
    first = np.array([1.0 + side * x * x * scale, side * mixed, -side * x])
    second = np.array([mixed, side + y * y * scale, -y])
    return first, second
