"""Paths: where a body is, and how it moves, at every time."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Protocol, runtime_checkable

import numpy as np
import scipy
from numpy.typing import ArrayLike

from standoff.checks.arrays import direction, finite
from standoff.checks.numbers import number
from standoff.motion.bounds import (
    MotionBounds,
    bounds_of,
    breaks_of,
    turning,
)
from standoff.motion.pose import Pose, PoseLike
from standoff.motion.pose_function import path_of
from standoff.motion.twist import Twist, TwistLike
from standoff.motion.vectors import cross, length
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array


@runtime_checkable
class Path(Protocol):
    """A motion in time.

    Attributes
    ----------
    start, end : float
        The times [s] between which the motion is to be used; `end` may be infinite. A path given
        by a formula also answers outside them; one given by samples refuses.
    """

    @property
    def start(self) -> float: ...

    @property
    def end(self) -> float: ...

    def pose(self, t: float) -> Pose:
        """Return where the body is at time `t` [s]."""
        ...

    def twist(self, t: float) -> Twist:
        """Return how the body moves at time `t` [s], in world axes.

        It is the derivative of `pose`; where that jumps, the one after the jump.
        """
        ...


class Fixed(KeepsReadOnly):
    """A body at rest, for all times.

    Raises ValueError if that is not a pose.

    Parameters
    ----------
    pose : Pose or what `Pose.of` reads
    """

    start = 0.0
    end = math.inf

    def __init__(self, pose: PoseLike) -> None:
        self._pose = Pose.of(pose)

    def pose(self, t: float) -> Pose:
        """Return the one pose."""
        number(t, "t")
        return self._pose

    def twist(self, t: float) -> Twist:
        """Return zero."""
        number(t, "t")
        return Twist.zero()

    def bounds(self, first: float, last: float, point: Array) -> MotionBounds:
        """Return bounds from time `first` to `last` [s] for a point of the body, (3,)."""
        del first, last, point
        return MotionBounds(0.0, 0.0, 0.0, 0.0)

    def breaks(self, first: float, last: float) -> Sequence[float]:
        """Return no times: the twist never jumps."""
        del first, last
        return ()


class ConstantTwist(KeepsReadOnly):
    """A body whose twist is constant in the axes that the twist names.

    With a body-frame twist the motion is a screw, ``pose @ exp(twist · t)``. With a world-frame
    twist the origin moves straight on while the body turns about it.

    Raises ValueError if that is not a pose or a twist.

    Parameters
    ----------
    pose : Pose or what `Pose.of` reads
        Where the body is at t = 0.
    twist : Twist or what `Twist.of` reads
    """

    start = 0.0
    end = math.inf

    def __init__(self, pose: PoseLike, twist: TwistLike) -> None:
        self._initial = Pose.of(pose)
        self._twist = Twist.of(twist)

    def pose(self, t: float) -> Pose:
        """Return where the body is at time `t` [s]."""
        return self._twist.carry(self._initial, number(t, "t"))

    def twist(self, t: float) -> Twist:
        """Return how the body moves at time `t` [s], in world axes."""
        return self._twist.in_world(self.pose(t))

    def bounds(self, first: float, last: float, point: Array) -> MotionBounds:
        """Return bounds from time `first` to `last` [s] for a point of the body, (3,)."""
        v, omega = self._twist.v, self._twist.omega
        longest = max(abs(first), abs(last))
        if self._twist.frame == "body":
            # v and ω × point may cancel, but not the roundings of the way and of the turn.
            ways = longest * (length(v) + length(omega) * length(point))
            return turning(omega, v + cross(omega, point), self._initial.rotation, ways)
        # The origin goes straight, and the point turns about it.
        about = turning(omega, cross(omega, self._initial.rotation @ point))
        return replace(about, speed=about.speed + length(v), lengths=longest * length(v))

    def breaks(self, first: float, last: float) -> Sequence[float]:
        """Return no times: the twist never jumps."""
        del first, last
        return ()


class Screw(KeepsReadOnly):
    """A body that turns about a fixed axis in the world and advances along it.

    Raises ValueError if that is not a pose, the axis is zero, a number is not finite, or a shape is
    wrong.

    Parameters
    ----------
    pose : Pose or what `Pose.of` reads
        Where the body is at t = 0.
    axis : array_like, shape (3,)
        Direction of the axis, world; any length but zero.
    point : array_like, shape (3,)
        A point of the axis, world [length].
    angular_rate : float
        Turn about the axis, right-handed [rad/s].
    pitch : float
        Advance along the axis in one whole turn [length].
    """

    start = 0.0
    end = math.inf

    def __init__(
        self,
        pose: PoseLike,
        axis: ArrayLike,
        point: ArrayLike = (0.0, 0.0, 0.0),
        angular_rate: float = 1.0,
        pitch: float = 0.0,
    ) -> None:
        self._initial = Pose.of(pose)
        self._point = finite(point, "point", (3,))
        unit = direction(axis, "axis")
        rate = number(angular_rate, "angular_rate")
        self._omega = unit * rate
        self._advance = self._omega * (number(pitch, "pitch") / math.tau)

    def pose(self, t: float) -> Pose:
        """Return where the body is at time `t` [s]."""
        seconds = number(t, "t")
        turn = scipy.spatial.transform.Rotation.from_rotvec(self._omega * seconds).as_matrix()
        arm = self._initial.translation - self._point
        origin = self._point + turn @ arm + self._advance * seconds
        return Pose.from_checked(turn @ self._initial.rotation, origin)

    def twist(self, t: float) -> Twist:
        """Return how the body moves at time `t` [s], in world axes."""
        arm = self.pose(t).translation - self._point
        return Twist(np.cross(self._omega, arm) + self._advance, self._omega)

    def bounds(self, first: float, last: float, point: Array) -> MotionBounds:
        """Return bounds from time `first` to `last` [s] for a point of the body, (3,)."""
        arm = self._initial.apply(point) - self._point
        lengths = length(self._point) + length(self._initial.translation - self._point)
        lengths += length(self._advance) * max(abs(first), abs(last))
        return turning(self._omega, cross(self._omega, arm) + self._advance, None, lengths)

    def breaks(self, first: float, last: float) -> Sequence[float]:
        """Return no times: the twist never jumps."""
        del first, last
        return ()


class Offset(KeepsReadOnly):
    """A body fixed to another that follows a path.

    Raises TypeError if the path has no ``pose`` and ``twist``, and is not a function. Raises
    ValueError if that is not a pose.

    Parameters
    ----------
    path : Path or function of the time
        Of the body that carries.
    pose : Pose or what `Pose.of` reads
        Of the carried body in the axes of the carrying one.
    """

    def __init__(self, path: Path | Callable[[float], PoseLike], pose: PoseLike) -> None:
        self._path: Path = path_of(path)
        self._offset = Pose.of(pose)

    @property
    def start(self) -> float:
        """The carrying path's start [s]."""
        return self._path.start

    @property
    def end(self) -> float:
        """The carrying path's end [s]."""
        return self._path.end

    def pose(self, t: float) -> Pose:
        """Return where the carried body is at time `t` [s]."""
        return self._path.pose(t) @ self._offset

    def twist(self, t: float) -> Twist:
        """Return how the carried body moves at time `t` [s], in world axes."""
        carrier = self._path.pose(t)
        # Another path may answer in its body's axes; the arm below is in the world's.
        twist = self._path.twist(t).in_world(carrier)
        arm = carrier.rotation @ self._offset.translation
        return Twist(twist.v + np.cross(twist.omega, arm), twist.omega)

    def bounds(self, first: float, last: float, point: Array) -> MotionBounds:
        """Return bounds from time `first` to `last` [s] for a point of the body, (3,)."""
        carrier = bounds_of(self._path, first, last, self._offset.apply(point))
        # The carrier's distance is no more than that of the body and of the two together.
        return replace(carrier, lengths=carrier.lengths + length(self._offset.translation))

    def breaks(self, first: float, last: float) -> Sequence[float]:
        """Return the times strictly between two [s] at which the carrying path's twist jumps."""
        return breaks_of(self._path, first, last)


class Carried(KeepsReadOnly):
    """A body that follows its own path in the axes of a body that follows another path.

    Raises TypeError if a path has no ``pose`` and ``twist``, and is not a function.

    Parameters
    ----------
    carrier : Path or function of the time
        Of the body that carries, in the world.
    within : Path or function of the time
        Of the carried body in the axes of the carrying one.
    """

    def __init__(
        self,
        carrier: Path | Callable[[float], PoseLike],
        within: Path | Callable[[float], PoseLike],
    ) -> None:
        self._carrier: Path = path_of(carrier)
        self._within: Path = path_of(within)

    @property
    def start(self) -> float:
        """The later start of the two [s]."""
        return max(self._carrier.start, self._within.start)

    @property
    def end(self) -> float:
        """The earlier end of the two [s]."""
        return min(self._carrier.end, self._within.end)

    def pose(self, t: float) -> Pose:
        """Return where the carried body is at time `t` [s]."""
        return self._carrier.pose(t) @ self._within.pose(t)

    def twist(self, t: float) -> Twist:
        """Return how the carried body moves at time `t` [s], in world axes."""
        carrier, within = self._carrier.pose(t), self._within.pose(t)
        outer = self._carrier.twist(t).in_world(carrier)
        inner = self._within.twist(t).in_world(within)
        turn = carrier.rotation
        v = outer.v + np.cross(outer.omega, turn @ within.translation) + turn @ inner.v
        return Twist(v, outer.omega + turn @ inner.omega)

    def bounds(self, first: float, last: float, point: Array) -> MotionBounds:
        """Return bounds from time `first` to `last` [s] for a point of the body, (3,)."""
        inner = bounds_of(self._within, first, last, point)
        within = self._within.pose(first)
        outer = bounds_of(self._carrier, first, last, within.apply(point))
        farther = (inner.speed + inner.angular_speed * length(point)) * (last - first)
        # With u the way of the point in the carrier's axes since `first`, the place's own motion
        # and that of R u add: d²(R u)/dt² has the terms (α × u + ω × (ω × u)), 2 ω × u', u''.
        away = inner.speed * (last - first)
        turn = outer.angular_acceleration + outer.angular_speed**2
        return MotionBounds(
            outer.speed + outer.angular_speed * away + inner.speed,
            outer.acceleration
            + turn * away
            + 2.0 * outer.angular_speed * inner.speed
            + inner.acceleration,
            outer.angular_speed + inner.angular_speed,
            outer.angular_acceleration
            + inner.angular_acceleration
            + outer.angular_speed * inner.angular_speed,
            lengths=outer.lengths + inner.lengths + length(within.translation) + farther,
        )

    def breaks(self, first: float, last: float) -> Sequence[float]:
        """Return the times strictly between two [s] at which either path's twist jumps."""
        return sorted(
            {*breaks_of(self._carrier, first, last), *breaks_of(self._within, first, last)}
        )
