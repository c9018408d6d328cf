"""Accuracy and cost of the laws for two ellipsoids in smooth motion, compared with cold queries."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from time import perf_counter
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.tracking.calls import run
from standoff.tracking.inputs import flat_pose
from standoff.typing import Array

Placement = tuple[so.Pose, so.Twist]
Motion = Callable[[float], tuple[Placement, Placement]]

A = so.shapes.ellipsoid(0.52, 1.04, 0.89)
B = so.shapes.ellipsoid(0.76, 0.52, 0.95)
SPIN_A = np.array([0.2, 0.3, 1.5])
"""Angular velocity of A, rad/s."""
SPIN_B = np.array([-0.8, -0.3, 0.6])
"""Angular velocity of B, rad/s."""
ORBIT = 2.3
"""Radius of the circle on which B's centre moves, at 1 rad/s; it also rises and falls."""

SETTLED = 0.3
"""Time, s, after which errors count: the paper's law then has its steady lag."""
DURATION = 1.3
"""End of the motion, s. Until then no witness point changes its chart."""
LONG = 2 * np.pi
"""End of the long motion, s: whole turns, with changes of chart."""
CHECKS = 40
"""About how many frames are compared with cold queries."""

STEPS = (1e-3, 1e-2, 33e-3)
"""Frame times of the table, s."""


class Followed(NamedTuple):
    """A law, and how many steps per frame it makes, all at the same poses.

    Attributes
    ----------
    law : PredictorCorrector or PaperLaw
    passes : int
    """

    law: so.PredictorCorrector | so.PaperLaw
    passes: int = 1

    @property
    def blind(self) -> bool:
        """Does it predict by the secant, without twists?"""
        return isinstance(self.law, so.PredictorCorrector) and self.law.predictor == "secant"

    def of_gain(self, gain: float) -> Followed:
        """The same with another gain [1/s]."""
        if not isinstance(self.law, so.PaperLaw):
            raise TypeError(f"{self.law} has no gain.")
        return self._replace(law=replace(self.law, gain=gain))


def _once(predictor: str) -> so.PredictorCorrector:
    """One correction per frame, whatever the gap."""
    return so.PredictorCorrector(predictor=predictor, tolerance=np.inf)


LAWS: dict[str, Followed] = {
    "Heun, K h = 1 (paper)": Followed(so.PaperLaw()),
    "Heun, no feedforward": Followed(so.PaperLaw(feedforward=False)),
    "Euler, K h = 1": Followed(so.PaperLaw(integrator="euler")),
    "Euler, no feedforward": Followed(so.PaperLaw(integrator="euler", feedforward=False)),
    "RK4, K h = 1": Followed(so.PaperLaw(integrator="rk4")),
    "RK4, no feedforward": Followed(so.PaperLaw(integrator="rk4", feedforward=False)),
    "one warm Newton step": Followed(_once("none")),
    "two warm Newton steps": Followed(_once("none"), passes=2),
    "secant, no twists": Followed(_once("secant")),
    "PC": Followed(_once("feedforward")),
    "PC2": Followed(_once("feedforward-2")),
}


@dataclass(frozen=True)
class Accuracy:
    """A run's greatest witness error (length), second-order evaluations per frame, and tracker."""

    error: float
    evaluations: float
    chart_changes: int
    tracker: so.Tracker


@cache
def two_ellipsoids(t: float) -> tuple[Placement, Placement]:
    """Return pose and twist of A, which spins, and of B, which spins and circles A."""
    centre = ORBIT * np.array([np.cos(t), np.sin(t), 0.2 * np.sin(2 * t)])
    velocity = ORBIT * np.array([-np.sin(t), np.cos(t), 0.4 * np.cos(2 * t)])
    turn_a = Rotation.from_rotvec(SPIN_A * t).as_matrix()
    turn_b = Rotation.from_rotvec(SPIN_B * t).as_matrix()
    return (
        (so.Pose(turn_a), so.Twist(np.zeros(3), SPIN_A)),
        (so.Pose(turn_b, centre), so.Twist(velocity, SPIN_B)),
    )


def witness_error(answer: so.Proximity, truth: so.Proximity) -> float:
    """Return the greater error of the two witness points (length)."""
    return max(
        float(np.linalg.norm(answer.point_a - truth.point_a)),
        float(np.linalg.norm(answer.point_b - truth.point_b)),
    )


def measure(
    times: Array,
    followed: Followed,
    motion: Motion = two_ellipsoids,
    twist_error: float = 0.0,
    settled: float = SETTLED,
    checks: int = CHECKS,
) -> Accuracy:
    """Track the two ellipsoids in frames at ``times`` and compare with cold queries.

    Parameters
    ----------
    times
        Times (n,) of the frames, s; the first one is the start.
    followed
        The law; ``dt`` is that of each frame.
    twist_error
        Relative error of the twists given to the tracker: they are multiplied by 1 plus this.
    """
    steps = np.diff(times)
    tracker = so.Tracker(A, B, dt=float(steps.max()), law=followed.law)

    def seen(twist: so.Twist) -> so.Twist | None:
        factor = 1.0 + twist_error
        return None if followed.blind else so.Twist(factor * twist.v, factor * twist.omega)

    (pose_a, twist_a), (pose_b, twist_b) = motion(float(times[0]))
    state = tracker.start(pose_a, pose_b, seen(twist_a), seen(twist_b))
    every = max(1, int((times > settled).sum()) // checks)
    worst, evaluations, changes = 0.0, 0, 0
    for k, (t, h) in enumerate(zip(times[1:], steps, strict=True), start=1):
        (pose_a, twist_a), (pose_b, twist_b) = motion(float(t))
        twists = seen(twist_a), seen(twist_b)
        for _ in range(followed.passes):
            state, answer = tracker.step(state, pose_a, pose_b, *twists, float(h))
            evaluations += answer.counts.evaluations
            changes += answer.counts.chart_changes
        if t > settled and k % every == 0:
            worst = max(worst, witness_error(answer, so.distance(A, B, pose_a, pose_b)))
    return Accuracy(worst, evaluations / len(steps), changes, tracker)


def even(step: float, duration: float = DURATION) -> Array:
    """Return the times of frames ``step`` apart, from 0."""
    return np.asarray(step * np.arange(round(duration / step) + 1))


def frame_time(followed: Followed, step: float, repeats: int = 7) -> float:
    """Return the least time [s] per frame of a law in the compiled loop, over several runs.

    Whatever the law, each frame's answer is certified and has its rates.
    """
    times = even(step)
    tracker = so.Tracker(A, B, dt=step, law=followed.law)
    passes = followed.passes
    placements = [two_ellipsoids(float(t)) for t in times]
    poses = [
        np.array([flat_pose(p[k][0]) for p in placements for _ in range(passes)]) for k in (0, 1)
    ]
    twists = [
        np.array([[*p[k][1].v, *p[k][1].omega] for p in placements for _ in range(passes)])
        for k in (0, 1)
    ]
    (pose_a, twist_a), (pose_b, twist_b) = placements[0]
    state = tracker.start(pose_a, pose_b, twist_a, twist_b)
    h = np.full(len(poses[0]), step)
    motions = np.hstack([*poses, *twists])
    seen = not followed.blind
    found = []
    for _ in range(repeats):
        data = state.data.copy()
        began = perf_counter()
        followed_rows = run(tracker.table, motions, seen, h, data)
        found.append(perf_counter() - began)
        if followed_rows.refused >= 0:
            raise RuntimeError(f"Frame {followed_rows.refused} of {followed.law} was refused.")
    return min(found) / len(times)
