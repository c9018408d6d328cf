"""A pose as a function of time, and what reads one as a path."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import scipy

from standoff.checks.numbers import number, positive
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion.pose import Pose, PoseLike
from standoff.motion.twist import Twist, TwistLike
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array

STEP = 2.0**-10
"""Between the poses of a difference [s]: fourth order leaves (ω step)⁴/30 of a speed that swings at
ω, 3e-10 at 10 rad/s, and rounding 1e-12 of the distance a second. A power of two, so that most
times are exact."""

NODES = 5
"""Poses of a difference, the one at its own time among them: exact for quartics of the time."""


class PoseFunction(KeepsReadOnly):
    """A body whose pose is a function of time.

    Raises TypeError if `pose` or `twist` cannot be called. Raises ValueError if the step is not
    positive, or the end not after the start.

    Parameters
    ----------
    pose : callable
        From a time [s] to the pose, a Pose or what `Pose.of` reads.
    twist : callable, optional
        From a time [s] to the twist, a Twist or what `Twist.of` reads: the derivative of `pose`.
        Without it the twist is a difference of fourth order: the derivative of the quartic through
        five poses `step` apart, the middle one at the time asked for, where that stays within
        `start` and `end`; else all five are moved inside. It is off by ``step⁴/30`` times the fifth
        derivative of the pose (``step⁴/5`` at an end), and by the roundings of the pose over
        `step`: a function in single precision needs a longer step. A function with a kink should
        come with its own twist.
    step : float
        Time between the poses of a difference [s]. In four steps the body may turn less than half
        a turn.
    start, end : float
        The times [s] between which the motion is to be used. `pose` also answers outside them, but
        no difference within them uses times beyond them.
    """

    def __init__(
        self,
        pose: Callable[[float], PoseLike],
        twist: Callable[[float], TwistLike] | None = None,
        *,
        step: float = STEP,
        start: float = 0.0,
        end: float = math.inf,
    ) -> None:
        for name, given in (("pose", pose), ("twist", twist)):
            if not callable(given) and not (name == "twist" and given is None):
                raise StandoffTypeError(
                    f"{name} is {shown(given)}: give a function of the time", name, given
                )
        self._pose, self._twist = pose, twist
        self._step = positive(step, "step")
        self.start, self.end = _time(start, "start"), _time(end, "end")
        if not self.start < self.end:
            raise StandoffError(
                f"start is {self.start!r} and end {self.end!r}: the end must come after the start",
                "end",
                end,
            )

    def __repr__(self) -> str:
        return f"PoseFunction({shown(self._pose)})"

    def pose(self, t: float) -> Pose:
        """Return where the body is at time `t` [s].

        Raises ValueError if the function does not return a pose.
        """
        seconds = number(t, "t")
        given = self._pose(seconds)
        try:
            return Pose.of(given)
        except ValueError as error:
            raise StandoffError(
                f"{shown(self._pose)} at t = {seconds!r}: {error}", "pose", given
            ) from error

    def twist(self, t: float) -> Twist:
        """Return how the body moves at time `t` [s], in world axes.

        Raises ValueError if `twist` does not return a twist, or `pose` a pose.
        """
        seconds = number(t, "t")
        if self._twist is None:
            return self._difference(seconds)
        given = self._twist(seconds)
        try:
            twist = Twist.of(given)
        except ValueError as error:
            raise StandoffError(
                f"{shown(self._twist)} at t = {seconds!r}: {error}", "twist", given
            ) from error
        return twist if twist.frame == "world" else twist.in_world(self.pose(seconds))

    def _difference(self, t: float) -> Twist:
        here, times = self.pose(t), self._times_beside(t)
        if len({t, *times}) < NODES:
            raise StandoffError(
                f"times {self._step!r} s apart around t = {t!r} are not distinct in floating "
                "point: give the function a clock nearer to zero, or a twist of its own",
                "t",
                t,
            )
        beside = [self.pose(time) for time in times]
        # Turns are at 0 here, where a rotation vector's derivative is the angular velocity.
        rotations = np.array([pose.rotation for pose in beside]) @ here.rotation.T
        turns = scipy.spatial.transform.Rotation.from_matrix(rotations).as_rotvec()
        ways = np.array([pose.translation for pose in beside]) - here.translation
        weights = _weights([time - t for time in times])
        return Twist(weights @ ways, weights @ turns)

    def _times_beside(self, t: float) -> list[float]:
        """Return the times [s] of the other poses of the difference at `t`."""
        step, first = self._step, -(NODES // 2)
        if self.start <= t <= self.end:
            step = min(step, (self.end - self.start) / (2 * NODES))
            first = max(first, -math.floor(min((t - self.start) / step, NODES)))
            first = min(first, math.floor(min((self.end - t) / step, NODES)) - (NODES - 1))
            # Rounding alone could lead beyond.
            return [
                min(max(t + k * step, self.start), self.end)
                for k in range(first, first + NODES)
                if k
            ]
        return [t + k * step for k in range(first, first + NODES) if k]


def path_of(given: Any, start: float = 0.0, end: float = math.inf) -> Any:
    """Return a path: what has ``pose(t)`` and ``twist(t)`` as it is, a function as `PoseFunction`.

    Raises TypeError if it is neither.
    """
    known = not isinstance(given, type)  # a class is not one, only its instances
    if known and all(callable(getattr(given, name, None)) for name in ("pose", "twist")):
        return given
    if known and callable(given):
        return PoseFunction(given, start=start, end=end)
    raise StandoffTypeError(
        f"{shown(given)} is not a path: it needs pose(t) and twist(t), or to be a function of the "
        "time that returns a pose",
        "path",
        given,
    )


def _time(value: Any, name: str) -> float:
    """Read a time that may be infinite."""
    endless = isinstance(value, float) and math.isinf(value)
    return float(value) if endless else number(value, name)


def _weights(offsets: list[float]) -> Array:
    """Return the weights of values that are 0 at 0, for the slope there of their polynomial."""
    return np.array(
        [
            math.prod([o / (o - here) for k, o in enumerate(offsets) if k != own]) / here
            for own, here in enumerate(offsets)
        ]
    )
