"""Runs of the two realisations, side by side, on a pair of faces in motion."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np

from standoff.bodies import Body
from standoff.geometry.validation import Array
from standoff.kernels.state import arrays as K
from standoff.motion import Pose, Screw, Twist
from standoff.tracking import Feature, Tracker, TrackerState, distance, pair_system
from standoff.tracking.inputs import flat_pose, flat_twist
from standoff.tracking.laws import PaperLaw
from standoff_studies.paper.simulation_a.setting import vault

FACE = Feature("face", 0)
"""The curved patch of either body: the runs stay on it."""

PATH_A = Screw(Pose.identity(), axis=(0.0, 0.0, 1.0), angular_rate=-0.5)
"""The lower vault turns about its upright axis, -0.5 rad/s."""

PATH_B = Screw(
    Pose.exp((2.9, 0.25, 0.3), (0.3, 0.1, 2.6)),
    axis=(0.1, 0.0, 1.0),
    angular_rate=1.5,
)
"""The upper vault hangs upside down, tilted, and turns at 1.5 rad/s about an axis beside it."""

MISS = (0.08, -0.06, 0.05, 0.07)
"""How far the parameters are off at the start, where a run begins wrong."""

HOME = Pose.identity()
"""Twists are given in the world: no attitude is needed to read them."""

RIGHT = (0.0, 0.0, 0.0, 0.0)
"""The start at the closest points."""


@dataclass(frozen=True, eq=False)
class Trace:
    """One run of one realisation, by frame.

    Attributes
    ----------
    time : ndarray, shape (n,)
        s.
    points : ndarray, shape (n, 6)
        Witness points of A and of B [length], world.
    q : ndarray, shape (n, 4)
        Parameters (u, v, r, s).
    believed : ndarray, shape (n, 4)
        The errors that the law acts on [length²]: the integrated ones, or nan where they are
        evaluated.
    tracker : Tracker
    """

    time: Array
    points: Array
    q: Array
    believed: Array
    tracker: Tracker


class Motion(NamedTuple):
    """Poses (n, 12) and twists (n, 6) of A and of B by frame, flat as the kernels read them."""

    pose_a: Array
    pose_b: Array
    twist_a: Array
    twist_b: Array


def body() -> Body:
    """Both bodies: the vault of simulation A."""
    return vault()


@cache
def closest() -> tuple[float, ...]:
    """Parameters of the closest points at the start."""
    answer = distance(body(), body(), PATH_A.pose(0.0), PATH_B.pose(0.0))
    return (*answer.parameters_a, *answer.parameters_b)


@cache
def motion(step: float, frames: int) -> Motion:
    """Poses and twists of both bodies at the frames."""
    times = (step * np.arange(frames + 1)).tolist()
    return Motion(
        np.array([flat_pose(PATH_A.pose(t)) for t in times]),
        np.array([flat_pose(PATH_B.pose(t)) for t in times]),
        np.array([flat_twist(PATH_A.twist(t), HOME) for t in times]),
        np.array([flat_twist(PATH_B.twist(t), HOME) for t in times]),
    )


@cache
def trace(
    realisation: str,
    integrator: str,
    gain: float,
    step: float,
    frames: int,
    miss: tuple[float, float, float, float] = RIGHT,
    bias: float = 0.0,
) -> Trace:
    """Run the paper's law in one realisation.

    Parameters
    ----------
    realisation : "integrated" or "evaluated"
        Fig. 3 or Fig. 4.
    integrator : str
    gain : float
        K [1/s].
    step : float
        s.
    frames : int
    miss : 4 floats
        Added to the parameters of the closest points at the start.
    bias : float
        Added to B's velocity as the tracker is told it, along A's x axis [length/s]: what a
        sensor on A would do.

    Raises
    ------
    RuntimeError
        If a witness point leaves its patch.
    """
    tracker = Tracker(
        body(),
        body(),
        step,
        law=PaperLaw(integrator=integrator, gain=gain, realisation=realisation),
    )
    moved = motion(step, frames)
    told = moved.twist_b.copy()
    told[:, :3] += bias * moved.pose_a[:, [0, 3, 6]]  # the first column of A's rotation
    q = np.array(closest()) + miss
    start = Twist(told[0, :3], told[0, 3:])
    poses, twists = (PATH_A.pose(0.0), PATH_B.pose(0.0)), (PATH_A.twist(0.0), start)
    state = tracker.start_from(*poses, (FACE, q[:2]), (FACE, q[2:]), *twists, settle=False)
    rows, believed = _follow(tracker, state, moved, told)
    left = (rows[:, [K.OUT_MODE, K.OUT_MODE + 2]] != FACE.index).any(axis=1)
    if left.any():
        raise RuntimeError(
            f"{realisation}, {integrator}, K = {gain:g} 1/s, h = {step:g} s: a witness point left "
            f"its patch at step {int(np.argmax(left))}."
        )
    if realisation == "evaluated":
        believed[:] = np.nan
    time = np.asarray(step * np.arange(frames + 1))
    return Trace(time, _points(rows), rows[:, K.OUT_Q : K.OUT_Q + 4], believed, tracker)


@cache
def exact(step: float, frames: int) -> Array:
    """Both witness points of the certified answer at the frames, shape (n, 6)."""
    tracker = Tracker(body(), body(), step)
    moved = motion(step, frames)
    state = tracker.start(PATH_A.pose(0.0), PATH_B.pose(0.0), PATH_A.twist(0.0), PATH_B.twist(0.0))
    rows, _ = _follow(tracker, state, moved, moved.twist_b)
    if (rows[:, K.STATUS] != K.CONVERGED).any():
        raise RuntimeError("a reference answer is not certified")
    return _points(rows)


def _follow(
    tracker: Tracker, state: TrackerState, moved: Motion, twist_b: Array
) -> tuple[Array, Array]:
    """Answers of all frames as ``kernels.state.arrays`` lays them out, and the state's errors."""
    buffer = tracker.buffer(state)
    rows = np.empty((len(moved.pose_a), K.N_OUT))
    believed = np.empty((len(rows), 4))
    rows[0], believed[0] = state.proximity.row, state.data[K.ERRORS : K.ERRORS + 4]
    for k in range(1, len(rows)):
        buffer.pose_a[:], buffer.pose_b[:] = moved.pose_a[k], moved.pose_b[k]
        buffer.twist_a[:], buffer.twist_b[:] = moved.twist_a[k], twist_b[k]
        tracker.step_into(buffer)
        rows[k], believed[k] = buffer.out, buffer.state[K.ERRORS : K.ERRORS + 4]
    return rows, believed


def _points(rows: Array) -> Array:
    points = np.hstack([rows[:, at : at + 3] for at in (K.POINT_A, K.POINT_B)])
    return np.asarray(points)


def true_errors(made: Trace, every: int = 1) -> Array:
    """Psi of Eqs. (1)-(4) at every so manieth frame of a run [length²], shape (m, 4)."""
    return np.array(
        [
            pair_system(
                body(),
                body(),
                PATH_A.pose(float(t)),
                PATH_B.pose(float(t)),
                (FACE, q[:2]),
                (FACE, q[2:]),
            ).Psi
            for t, q in zip(made.time[::every], made.q[::every], strict=True)
        ]
    )
