"""A tracked pair whose bodies are moved by hand: the tracker follows in steps of its own frame
time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from standoff.bodies.body import Body
from standoff.motion import ConstantTwist, Pose, Twist
from standoff.tracking import Event, Proximity, Tracker
from standoff.tracking.law_options import Law

MOST_FRAMES = 60
"""Frames that one move is cut into at most: what a page shows at once takes at most a few
milliseconds."""


class LivePair:
    """Two bodies, where they are, and the tracker's answer there.

    Raises ValueError: what `Tracker` and its `start` refuse.

    Parameters
    ----------
    a, b : Body
    poses : (Pose, Pose)
        Where they begin.
    law : Law
    dt : float
        Frame time of the tracker [s].

    Attributes
    ----------
    tracker : Tracker
    poses : (Pose, Pose)
    answer : Proximity
        At these poses.
    """

    def __init__(
        self, a: Body, b: Body, poses: tuple[Pose, Pose], law: Law, dt: float = 1e-3
    ) -> None:
        self.tracker = Tracker(a, b, dt, law)
        self.poses = poses
        self._state = self.tracker.start(*poses, Twist.zero(), Twist.zero())
        self.answer: Proximity = self._state.proximity

    @property
    def bodies(self) -> tuple[Body, Body]:
        """A and B."""
        return self.tracker.a, self.tracker.b

    def follow(self, law: Law) -> None:
        """Continue with another law, from a new start here.

        Raises ValueError: what the tracker refuses; the pair is as it was then.
        """
        changed = LivePair(*self.bodies, self.poses, law, self.tracker.dt)
        self.tracker, self._state, self.answer = changed.tracker, changed._state, changed.answer

    def restart(self, poses: tuple[Pose, Pose]) -> None:
        """Start again at poses, as after a leap.

        Raises ValueError as of `Tracker.start`; the pair is as it was then.
        """
        self._state = self.tracker.start(*poses, Twist.zero(), Twist.zero())
        self.poses, self.answer = poses, self._state.proximity

    def move(self, poses: tuple[Pose, Pose], elapsed: float) -> Sequence[Event]:
        """Carry the bodies to poses by screws, and return the switches on the way.

        A law that lags behind gets no more time than has passed: what it shows is its own lag.

        Raises ValueError as of `Tracker.step`; the pair is as it was then.

        Parameters
        ----------
        poses : (Pose, Pose)
        elapsed : float
            Time that this takes [s].
        """
        dt = self.tracker.dt
        count = int(np.clip(round(elapsed / dt), 1, MOST_FRAMES))
        paths = [
            ConstantTwist(first, Twist.between(first, last, count * dt))
            for first, last in zip(self.poses, poses, strict=True)
        ]
        state, answer, events = self._state, self.answer, list[Event]()
        for k in range(1, count + 1):
            placed = [path.pose(k * dt) for path in paths] if k < count else poses
            twists = [path.twist(k * dt) for path in paths]
            state, answer = self.tracker.step(state, *placed, *twists)
            events += answer.events
        self._state, self.answer, self.poses = state, answer, poses
        return events
