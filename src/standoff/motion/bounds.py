"""How fast a moving body can be, and how fast its velocity can change, within a time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol, cast

import numpy as np
from numpy.typing import ArrayLike

from standoff.checks.arrays import finite
from standoff.checks.numbers import not_negative
from standoff.checks.real_numbers import shape_of, shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion.pose import Pose, PoseLike
from standoff.motion.pose_function import path_of
from standoff.motion.twist import TwistLike
from standoff.motion.vectors import cross, length
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array


@dataclass(frozen=True)
class MotionBounds:
    """Bounds on a motion that hold at every instant of an interval.

    Attributes
    ----------
    speed : float
        Speed of one point fixed in the body, relative to the world [length/s].
    acceleration : float
        Of the same point [length/s²].
    angular_speed : float
        Of the body [rad/s].
    angular_acceleration : float
        Of the body [rad/s²].
    axis : (3,) array or None
        A unit vector of the world to which the accelerations of all points of the body are
        perpendicular all the time, if there is one: that of a screw.
    lengths : float
        Sum of the greatest lengths that are turned or added to make the pose [length]: arms,
        offsets, and ways as rate times time, even if they cancel. Each leaves its roundings in the
        pose, which `time_of_impact` allows for. The distance of the body itself need not be
        counted; zero says that the pose is one that was given.
    """

    speed: float
    acceleration: float
    angular_speed: float
    angular_acceleration: float
    axis: Array | None = None
    lengths: float = 0.0


class BoundedPath(Protocol):
    """A path that knows how fast it can be: every path of ``standoff.motion``."""

    def pose(self, t: float) -> PoseLike:
        """Return where the body is at time `t` [s]."""
        ...

    def twist(self, t: float) -> TwistLike:
        """Return how the body moves at time `t` [s]."""
        ...

    def bounds(self, first: float, last: float, point: Array) -> MotionBounds:
        """Return bounds that hold from time `first` to `last` [s], between two breaks.

        `point` (3,) is fixed in the body, in its coordinates. The two times may be one.
        """
        ...

    def breaks(self, first: float, last: float) -> Sequence[float]:
        """Return the times strictly between `first` and `last` [s] at which the twist jumps."""
        ...


class Bounded(KeepsReadOnly):
    """A path of your own, with what you know of its accelerations.

    Raises TypeError if the path has no ``pose`` and ``twist``, and is not a function. Raises
    ValueError if a bound is negative or not finite, or the breaks are not a sequence of finite
    numbers.

    Parameters
    ----------
    path
        Anything with ``pose(t)`` and ``twist(t)``, t in s, or a function of time that returns a
        pose, which is read as by `PoseFunction`.
    speed : float
        No less than the speed of the body's origin at any time [length/s].
    acceleration : float
        No less than the acceleration of the body's origin [length/s²].
    angular_speed : float
        No less than the body's angular speed [rad/s].
    angular_acceleration : float
        No less than the body's angular acceleration [rad/s²].
    breaks : array_like, shape (n,)
        Times at which the velocities jump, if there are any [s].
    lengths : float, optional
        No less than the sum of the lengths that your ``pose`` turns or adds up [length], see
        `MotionBounds`. Without it, the sum is taken to be no greater than the distance of the
        body's origin from the world's: give it if long arms or offsets cancel.
    """

    def __init__(
        self,
        path: object,
        *,
        speed: float,
        acceleration: float,
        angular_speed: float,
        angular_acceleration: float,
        breaks: ArrayLike = (),
        lengths: float | None = None,
    ) -> None:
        given = path_of(path)
        self._pose, self._twist = given.pose, given.twist
        self.start = float(getattr(given, "start", -math.inf))
        self.end = float(getattr(given, "end", math.inf))
        self._origin = MotionBounds(
            not_negative(speed, "speed"),
            not_negative(acceleration, "acceleration"),
            not_negative(angular_speed, "angular_speed"),
            not_negative(angular_acceleration, "angular_acceleration"),
        )
        self._lengths = None if lengths is None else not_negative(lengths, "lengths")
        self._breaks = np.sort(_times(breaks, "breaks"))

    def pose(self, t: float) -> PoseLike:
        """Return where the body is at time `t` [s]."""
        where: PoseLike = self._pose(t)
        return where

    def twist(self, t: float) -> TwistLike:
        """Return how the body moves at time `t` [s]."""
        how: TwistLike = self._twist(t)
        return how

    def bounds(self, first: float, last: float, point: Array) -> MotionBounds:
        """Return bounds that hold from time `first` to `last` [s] for a point of the body."""
        lengths = self._lengths
        if lengths is None:
            away = length(Pose.of(self.pose(first)).translation)
            lengths = away + self._origin.speed * (last - first)
        return replace(of_point(self._origin, point), lengths=lengths)

    def breaks(self, first: float, last: float) -> Sequence[float]:
        """Return the times strictly between `first` and `last` [s] at which the twist jumps."""
        within = self._breaks[(self._breaks > first) & (self._breaks < last)]
        return [float(t) for t in within]


def _times(value: ArrayLike, name: str) -> Array:
    """Read a sequence of times of any length."""
    shape = shape_of(value)
    if shape is None or len(shape) != 1:
        raise StandoffError(
            f"{name} is {shown(value)}: give a sequence of times, such as [1.0, 2.5]", name, value
        )
    return finite(value, name, (shape[0],))


def of_point(origin: MotionBounds, point: Array) -> MotionBounds:
    """Return the bounds for a point of a body whose origin's are known."""
    reach = length(point)
    turn = origin.angular_acceleration + origin.angular_speed**2
    return MotionBounds(
        origin.speed + origin.angular_speed * reach,
        origin.acceleration + turn * reach,
        origin.angular_speed,
        origin.angular_acceleration,
        origin.axis,
        origin.lengths,
    )


def turning(
    omega: Array,
    velocity: Array,
    rotation: Array | None = None,
    lengths: float = 0.0,
) -> MotionBounds:
    """Return the bounds for a point whose velocity turns with the body at a constant rate.

    Both vectors in world axes, or in those of a body with that rotation at some instant.
    """
    rate = length(omega)
    axis = None
    if rate > 0.0:
        axis = omega / rate if rotation is None else rotation @ (omega / rate)
    bend = length(cross(omega, velocity))
    return MotionBounds(length(velocity), bend, rate, 0.0, axis, lengths)


def bounds_of(path: object, first: float, last: float, point: Array) -> MotionBounds:
    """Return a path's bounds between two times [s] for a point fixed in its body.

    Raises TypeError if the path knows no bounds.
    """
    return known(path).bounds(first, last, point)


def breaks_of(path: object, first: float, last: float) -> Sequence[float]:
    """Return the times strictly between two [s] at which a path's twist jumps.

    Raises TypeError if the path knows no bounds.
    """
    return known(path).breaks(first, last)


def known(path: object) -> BoundedPath:
    """Return the path, if it knows its bounds.

    Raises TypeError if it does not.
    """
    if not callable(getattr(path, "bounds", None)) or not callable(getattr(path, "breaks", None)):
        raise StandoffTypeError(
            f"it is not known how fast {shown(path)} moves between two times: wrap it in "
            "standoff.motion.Bounded(path, speed=..., acceleration=..., angular_speed=..., "
            "angular_acceleration=...)",
            "path",
            path,
        )
    return cast(BoundedPath, path)
