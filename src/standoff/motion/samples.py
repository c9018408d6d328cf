"""Poses sampled in time, joined by screws."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from standoff.motion import inputs
from standoff.motion.bounds import MotionBounds, cross, length, turning
from standoff.motion.inputs import FloatArray
from standoff.motion.pose import Pose, PoseLike
from standoff.motion.tolerances import HALF_TURN
from standoff.motion.twist import Twist
from standoff.read_only import KeepsReadOnly
from standoff.real_numbers import shown


class PoseSamples(KeepsReadOnly):
    """A body whose pose is known at certain times, and moves on a screw between two of them.

    Between samples the pose is the geodesic of SE(3), ``P_i exp(s log(P_i⁻¹ P_{i+1}))`` with s
    from 0 to 1, so that the twist is constant in the body's axes. At a sample it jumps: `twist`
    gives there the one of the interval that begins, and at the end that of the last.

    Parameters
    ----------
    times : array_like, shape (n,)
        Times of the samples [s], strictly increasing, at least two; uneven steps are welcome.
    poses : sequence of n poses
        Each a Pose or what `Pose.of` reads.

    Attributes
    ----------
    times : ndarray, shape (n,)
        Read-only, float64.
    poses : tuple of Pose
    normalised : int
        How many poses came from a quaternion that was not of unit norm and was normalised.

    Raises
    ------
    TypeError
        If the poses are no sequence.
    ValueError
        If there are fewer than two samples, as many times as poses are not given, times do not
        increase strictly or are not finite, a pose is none, or two samples differ by a half turn,
        which has two shortest screws.
    """

    def __init__(self, times: ArrayLike, poses: Sequence[PoseLike]) -> None:
        if not isinstance(poses, Sequence):
            raise TypeError(f"poses is {shown(poses)}: give a list of poses")
        self.poses = tuple(_read(index, pose) for index, pose in enumerate(poses))
        self.times = inputs.array(times, "times", (len(self.poses),))
        self.normalised = sum(pose.normalised for pose in self.poses)
        _check_times(self.times)
        self._twists = tuple(self._between(index) for index in range(len(self.poses) - 1))

    def _between(self, index: int) -> Twist:
        first, second = float(self.times[index]), float(self.times[index + 1])
        twist = Twist.between(self.poses[index], self.poses[index + 1], second - first)
        turn = float(np.linalg.norm(twist.omega)) * (second - first)
        if turn > np.pi - HALF_TURN:
            raise ValueError(
                f"poses {index} and {index + 1} (t = {first!r} and {second!r}) differ by a half "
                "turn, so that the way from one to the other is open: add a sample between them"
            )
        return twist

    @property
    def start(self) -> float:
        """Time of the first sample [s]."""
        return float(self.times[0])

    @property
    def end(self) -> float:
        """Time of the last sample [s]."""
        return float(self.times[-1])

    def starting_at(self, start: float) -> PoseSamples:
        """Return the same motion with its times shifted so that it starts at `start` [s].

        Recorded files often count from a far epoch, where double precision resolves a time to
        little better than a microsecond.
        """
        first = inputs.number(start, "start")
        return PoseSamples((self.times - self.times[0]) + first, self.poses)

    def _interval(self, t: float) -> tuple[int, float]:
        seconds = inputs.number(t, "t")
        if not self.start <= seconds <= self.end:
            raise ValueError(
                f"t is {seconds!r}, outside the samples: they reach from {self.start!r} to "
                f"{self.end!r}"
            )
        index = int(np.searchsorted(self.times, seconds, side="right")) - 1
        return min(index, len(self._twists) - 1), seconds

    def pose(self, t: float) -> Pose:
        """Return where the body is at time `t` [s].

        Raises
        ------
        ValueError
            If `t` is outside the samples.
        """
        index, seconds = self._interval(t)
        if seconds == self.end:
            # Not by the last screw, so that every sample is met without rounding.
            return self.poses[-1]
        elapsed = seconds - float(self.times[index])
        return self._twists[index].carry(self.poses[index], elapsed)

    def twist(self, t: float) -> Twist:
        """Return how the body moves at time `t` [s], in world axes.

        Raises
        ------
        ValueError
            If `t` is outside the samples.
        """
        index, seconds = self._interval(t)
        return self._twists[index].in_world(self.pose(seconds))

    def bounds(self, first: float, last: float, point: FloatArray) -> MotionBounds:
        """Return bounds from time `first` to `last` [s], within one interval of the samples.

        Raises
        ------
        ValueError
            If a sample lies between the two, or they are outside the samples.
        """
        index, _ = self._interval(first)
        if not first <= last <= float(self.times[index + 1]):
            raise ValueError(
                f"{first!r} to {last!r} is no time within one interval of the samples: "
                f"the next one is at {float(self.times[index + 1])!r}"
            )
        twist = self._twists[index]
        velocity = twist.v + cross(twist.omega, point)
        lengths = self._lengths(index, first, last)
        return turning(twist.omega, velocity, self.poses[index].rotation, lengths)

    def _lengths(self, index: int, first: float, last: float) -> float:
        """Return what `MotionBounds` calls lengths; at a sample alone the pose is the given one."""
        begin = float(self.times[index])
        if first == last and first in (begin, self.end):
            return 0.0
        ends = (length(self.poses[k].translation) for k in (index, index + 1))
        return sum(ends) + length(self._twists[index].v) * (last - begin)

    def breaks(self, first: float, last: float) -> Sequence[float]:
        """Return the times of the samples strictly between `first` and `last` [s]."""
        begin = int(np.searchsorted(self.times, first, side="right"))
        stop = int(np.searchsorted(self.times, last, side="left"))
        return [float(t) for t in self.times[begin:stop]]


def _read(index: int, pose: PoseLike) -> Pose:
    try:
        return Pose.of(pose)
    except ValueError as error:
        raise ValueError(f"pose {index}: {error}") from error


def _check_times(times: FloatArray) -> None:
    if len(times) < 2:
        raise ValueError(f"{len(times)} samples make no motion: give at least two, or use Fixed")
    steps = np.diff(times)
    if (steps <= 0.0).any():
        index = int(np.argmax(steps <= 0.0)) + 1
        raise ValueError(
            f"times must increase strictly: times[{index}] = {times[index].item()!r} follows "
            f"times[{index - 1}] = {times[index - 1].item()!r}; sort the samples, and keep one of "
            "each time"
        )
