"""Poses sampled in time, joined by screws."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff.checks.arrays import finite
from standoff.checks.numbers import GREATEST, number
from standoff.errors import StandoffError
from standoff.motion.bounds import MotionBounds, turning
from standoff.motion.pose import HasMatrix, Pose, PoseLike
from standoff.motion.poses import Poses
from standoff.motion.tolerances import HALF_TURN_ANGLE, NEAR_HALF_TURN
from standoff.motion.twist import Twist, screws
from standoff.motion.vectors import cross, length
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array

FASTER = 10.0
"""A screw is at most this much faster than the distances of its ends from the origin over its
time."""


class PoseSamples(KeepsReadOnly):
    """A body whose pose is known at certain times, and moves on a screw between two of them.

    Between samples the pose is the geodesic of SE(3), ``P_i exp(s log(P_i⁻¹ P_{i+1}))`` with s from
    0 to 1, so that the twist is constant in the body's axes. It jumps at a sample: there `twist`
    returns that of the interval that begins, and at the end that of the last interval.

    Raises TypeError if the poses are neither a sequence nor an array. Raises ValueError if there
    are fewer than two samples, as many times as poses are not given, times do not increase strictly
    or are not finite, a pose is invalid (the first such is named), or two samples differ by a half
    turn, which has two shortest screws.

    Parameters
    ----------
    times : array_like, shape (n,)
        Times of the samples [s], strictly increasing, at least two; the steps may be uneven.
    poses : Poses, sequence of n poses, array (n, 4, 4), or SciPy's ``RigidTransform`` of n
        Of a sequence each is a Pose or what `Pose.of` reads; an array holds homogeneous matrices,
        and is read some hundred times as fast. Rounded rotations are repaired as by `Pose.of`.

    Attributes
    ----------
    times : ndarray, shape (n,)
        Read-only, float64.
    repaired : int
        How many poses had a rounded rotation, and were replaced by the nearest one: their
        `Pose.repaired`.
    """

    def __init__(
        self, times: ArrayLike, poses: Poses | Sequence[PoseLike] | NDArray[Any] | HasMatrix
    ) -> None:
        self._set(times, Poses.of(poses))

    def _set(self, times: ArrayLike, stack: Poses) -> None:
        self._stack = stack
        self.times = finite(times, "times", (len(stack.rotations),))
        self.repaired = int(np.count_nonzero(stack.repaired))
        _check_times(self.times)
        self._check_ways()

    def _check_ways(self) -> None:
        """Refuse half turns and velocities beyond float64, looking closely only where needed."""
        rotations, translations = self._stack.rotations, self._stack.translations
        # 1 + 2 cos of the angle between two samples.
        traces = np.einsum("nij,nij->n", rotations[:-1], rotations[1:])
        lengths = np.abs(translations).max(axis=1) + 1.0
        with np.errstate(over="ignore"):
            speeds = (lengths[:-1] + lengths[1:]) / np.diff(self.times)
        if traces.min() < NEAR_HALF_TURN or speeds.max() > GREATEST / FASTER:
            _ = self._screws

    @cached_property
    def _screws(self) -> tuple[Array, Array]:
        """The twists (v, ω) from each sample to the next, (n − 1, 3), in body axes."""
        steps = np.diff(self.times)
        v, omega = screws(self._stack.rotations, self._stack.translations, steps)
        fast = ~((np.abs(v) <= GREATEST) & (np.abs(omega) <= GREATEST)).all(axis=1)
        if fast.any():
            raise StandoffError(
                f"{self._between(fast)} are too far apart for the time between them: no velocity "
                f"may be beyond {GREATEST:g}",
                "poses",
            )
        turns = np.linalg.norm(omega, axis=1) * steps
        half = turns > np.pi - HALF_TURN_ANGLE
        if half.any():
            raise StandoffError(
                f"{self._between(half)} differ by a half turn, so the way from one to the other "
                "is ambiguous: add a sample between them",
                "poses",
            )
        v.setflags(write=False)
        omega.setflags(write=False)
        return v, omega

    def _between(self, marked: ArrayLike) -> str:
        """Name the two samples around the first marked interval."""
        index = int(np.argmax(marked))
        first, second = self.times[index : index + 2].tolist()
        return f"poses {index} and {index + 1} (t = {first!r} and {second!r})"

    def _twist(self, index: int) -> Twist:
        """Return the twist from a sample to the next, in body axes."""
        v, omega = self._screws
        return Twist.from_checked(v[index], omega[index], "body")

    @cached_property
    def poses(self) -> tuple[Pose, ...]:
        """The poses of the samples, n of them."""
        return tuple(self._stack)

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

        Recorded files often count from a distant epoch, where double precision resolves a time to
        little better than a microsecond.
        """
        first = number(start, "start")
        shifted = PoseSamples.__new__(PoseSamples)
        shifted._set((self.times - self.times[0]) + first, self._stack)
        return shifted

    def _interval(self, t: float) -> tuple[int, float]:
        seconds = number(t, "t")
        if not self.start <= seconds <= self.end:
            raise StandoffError(
                f"t is {seconds!r}, outside the samples: they reach from {self.start!r} to "
                f"{self.end!r}",
                "t",
                t,
            )
        index = int(np.searchsorted(self.times, seconds, side="right")) - 1
        return min(index, len(self.times) - 2), seconds

    def pose(self, t: float) -> Pose:
        """Return where the body is at time `t` [s].

        Raises ValueError if `t` is outside the samples.
        """
        index, seconds = self._interval(t)
        if seconds == self.end:
            # Not by the last screw, so that every sample is met without rounding.
            return self._stack[-1]
        elapsed = seconds - float(self.times[index])
        return self._twist(index).carry(self._stack[index], elapsed)

    def twist(self, t: float) -> Twist:
        """Return how the body moves at time `t` [s], in world axes.

        Raises ValueError if `t` is outside the samples.
        """
        index, seconds = self._interval(t)
        return self._twist(index).in_world(self.pose(seconds))

    def bounds(self, first: float, last: float, point: Array) -> MotionBounds:
        """Return bounds from time `first` to `last` [s], within one interval of the samples.

        Raises ValueError if a sample lies between the two, or they are outside the samples.
        """
        index, _ = self._interval(first)
        if not first <= last <= float(self.times[index + 1]):
            raise StandoffError(
                f"{first!r} to {last!r} is not a time within one interval of the samples: "
                f"the next one is at {float(self.times[index + 1])!r}",
                "last",
                last,
            )
        twist = self._twist(index)
        velocity = twist.v + cross(twist.omega, point)
        lengths = self._lengths(index, first, last)
        return turning(twist.omega, velocity, self._stack.rotations[index], lengths)

    def _lengths(self, index: int, first: float, last: float) -> float:
        """Return what `MotionBounds` calls lengths; at a sample alone the pose is the given one."""
        begin = float(self.times[index])
        if first == last and first in (begin, self.end):
            return 0.0
        ends = (length(self._stack.translations[k]) for k in (index, index + 1))
        return sum(ends) + length(self._twist(index).v) * (last - begin)

    def breaks(self, first: float, last: float) -> Sequence[float]:
        """Return the times of the samples strictly between `first` and `last` [s]."""
        begin = int(np.searchsorted(self.times, first, side="right"))
        stop = int(np.searchsorted(self.times, last, side="left"))
        return [float(t) for t in self.times[begin:stop]]


def _check_times(times: Array) -> None:
    if len(times) < 2:
        raise StandoffError(
            f"{len(times)} samples do not make a motion: give at least two, or use Fixed",
            "times",
            times,
        )
    steps = np.diff(times)
    if (steps <= 0.0).any():
        index = int(np.argmax(steps <= 0.0)) + 1
        raise StandoffError(
            f"times must increase strictly: times[{index}] = {times[index].item()!r} follows "
            f"times[{index - 1}] = {times[index - 1].item()!r}; sort the samples, and keep one of "
            "each time",
            "times",
            times,
        )
