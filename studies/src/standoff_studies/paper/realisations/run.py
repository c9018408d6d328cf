"""Runs of the two realisations, side by side, on a pair of faces in motion."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from standoff.bodies import Body
from standoff.kernels.state import arrays as K
from standoff.motion import Pose, Screw, Twist
from standoff.tracking import Feature, Tracker, TrackerState, distance, pair_system
from standoff.tracking.laws import PaperLaw
from standoff.tracking.rows import poses_of, twists_of
from standoff.typing import Array
from standoff_studies.paper.many_starts import motion_along, stepped
from standoff_studies.paper.simulation_a.setting import vault

FACE = Feature("face", 0)
"""The curved patch of each body, on which the runs stay."""

PATH_A = Screw(Pose.identity(), axis=(0.0, 0.0, 1.0), angular_rate=-0.5)
"""The lower vault turns about its upright axis, -0.5 rad/s."""

PATH_B = Screw(
    Pose.exp((2.9, 0.25, 0.3), (0.3, 0.1, 2.6)),
    axis=(0.1, 0.0, 1.0),
    angular_rate=1.5,
)
"""The upper vault hangs upside down, tilted, and turns at 1.5 rad/s about an axis beside it."""

MISS = (0.08, -0.06, 0.05, 0.07)
"""Error of the parameters at the start of a run that begins wrong."""

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
        The errors on which the law acts [length²]: the integrated ones, or nan if they are
        evaluated.
    tracker : Tracker
    """

    time: Array
    points: Array
    q: Array
    believed: Array
    tracker: Tracker


def body() -> Body:
    """Both bodies: the vault of simulation A."""
    return vault()


@cache
def closest() -> tuple[float, ...]:
    """Parameters of the closest points at the start."""
    answer = distance(body(), body(), PATH_A.pose(0.0), PATH_B.pose(0.0))
    return (*answer.parameters_a, *answer.parameters_b)


@cache
def motion(step: float, frames: int) -> Array:
    """Poses and twists of both bodies at the frames after the start, as the kernels read them."""
    return motion_along(PATH_A, PATH_B, np.asarray(step * np.arange(frames + 1)))


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
        Added to the velocity of B given to the tracker, along A's x axis [length/s], as a sensor
        on A would do.

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
    told = motion(step, frames).copy()
    twists_of(told)[1][:, :3] += bias * poses_of(told)[0][:, [0, 3, 6]]  # along A's x axis
    q = np.array(closest()) + miss
    poses, true = (PATH_A.pose(0.0), PATH_B.pose(0.0)), PATH_B.twist(0.0)
    start = Twist(true.v + bias * poses[0].rotation[:, 0], true.omega)
    twists = PATH_A.twist(0.0), start
    state = tracker.start_from(*poses, (FACE, q[:2]), (FACE, q[2:]), *twists, settle=False)
    rows, believed = _follow(tracker, state, told)
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
    state = tracker.start(PATH_A.pose(0.0), PATH_B.pose(0.0), PATH_A.twist(0.0), PATH_B.twist(0.0))
    rows, _ = _follow(tracker, state, motion(step, frames))
    if (rows[:, K.STATUS] != K.CONVERGED).any():
        raise RuntimeError("a reference answer is not certified")
    return _points(rows)


def _follow(tracker: Tracker, state: TrackerState, moved: Array) -> tuple[Array, Array]:
    """Answers of all frames as ``kernels.state.arrays`` lays them out, and the state's errors."""
    rows = np.empty((len(moved) + 1, K.N_OUT))
    believed = np.empty((len(rows), 4))
    rows[0], believed[0] = state.proximity.row, state.data[K.ERRORS : K.ERRORS + 4]
    for k, buffer in enumerate(stepped(tracker, state, moved), start=1):
        rows[k], believed[k] = buffer.out, buffer.state[K.ERRORS : K.ERRORS + 4]
    return rows, believed


def _points(rows: Array) -> Array:
    points = np.hstack([rows[:, at : at + 3] for at in (K.POINT_A, K.POINT_B)])
    return np.asarray(points)


def true_errors(made: Trace, every: int = 1) -> Array:
    """Psi of Eqs. (1)-(4) at regularly spaced frames of a run [length²], shape (m, 4)."""
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
