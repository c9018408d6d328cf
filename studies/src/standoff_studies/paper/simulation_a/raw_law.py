"""The paper's law without safeguards, from many starts at many gains, by ``so.Tracker``."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.pair import events as N
from standoff.kernels.state import arrays as K
from standoff.motion import Fixed
from standoff.tracking import Tracker
from standoff.typing import Array
from standoff_studies.paper.many_starts import begun, motion_along, stepped
from standoff_studies.paper.pair_simulation import REST
from standoff_studies.paper.simulation_a.run import (
    FLAT_HOME,
    SETTLED,
    raw_tracker,
    system_at,
    systems,
    times_of,
    track,
)
from standoff_studies.paper.simulation_a.setting import FACE, PATH, STEP, VERTEX


class Trials(NamedTuple):
    """The result of each start at each gain, arrays of shape (gains, starts).

    Attributes
    ----------
    steps : ndarray of int
        Steps until every error is below `SETTLED` times the initial errors' norm; -1 if that was
        not reached.
    monotone : ndarray of bool
        No error grew in a step until then.
    indefinite : ndarray of bool
        The start did not settle, and H had lost positive definiteness at a stage before.
    """

    steps: NDArray[np.int64]
    monotone: NDArray[np.bool_]
    indefinite: NDArray[np.bool_]


class Trial(NamedTuple):
    """One run: its parameters (n, 2) until it settled, left the patch or was stopped."""

    q: Array
    settled: bool
    monotone: bool


def try_all(starts: Array, gains: Array, frames: int) -> Trials:
    """Run the law with Heun's method from every start (n, 2) at every gain (m,) [1/s].

    A run ends when it has settled, and fails as soon as a step leads out of the patch, or after
    `frames`.
    """
    moving = motion_along(REST, PATH, times_of(frames))
    shape = len(gains), len(starts)
    trials = Trials(np.full(shape, -1), np.ones(shape, bool), np.zeros(shape, bool))
    for row, gain in enumerate(gains.tolist()):
        tracker = raw_tracker(gain)
        for column, start in enumerate(starts):
            trial = follow(tracker, start, moving)
            trials.monotone[row, column] = trial.monotone
            if trial.settled:
                trials.steps[row, column] = len(trial.q) - 1
            else:
                trials.indefinite[row, column] = indefinite(trial.q, gain)
    return trials


def follow(tracker: Tracker, start: Array, moving: Array) -> Trial:
    """Run the law from one start (2,)."""
    state = begun(tracker, (REST, PATH), (FACE, start), (VERTEX, ()))
    before = np.abs(system_at(start, 0.0).Psi)
    goal = SETTLED * np.linalg.norm(before)
    q, monotone = [start], True
    for buffer in stepped(tracker, state, moving):
        if buffer.out[K.OUT_COUNTS + N.SATURATIONS]:
            break
        q.append(buffer.out[K.OUT_Q : K.OUT_Q + 2].copy())
        errors = np.abs(systems().psi(q[-1], FLAT_HOME, buffer.pose_b))
        monotone = monotone and bool((errors <= before).all())
        if errors.max() < goal:
            return Trial(np.array(q), True, monotone)
        before = errors
    return Trial(np.array(q), False, monotone)


def indefinite(q: Array, gain: float) -> bool:
    """Is H not positive definite at a stage of a run (n, 2) by Heun's method?"""
    for k, at in enumerate(q):
        now = system_at(at, k * STEP)
        w = -np.linalg.solve(now.M, gain * now.Psi + now.b)
        trial = system_at(at + STEP * w, (k + 1) * STEP)
        if min(np.linalg.eigvalsh(stage.H)[0] for stage in (now, trial)) <= 0.0:
            return True
    return False


@cache
def growth_of_small_errors(gain: float, start: tuple[float, float], frames: int) -> float:
    """The factor by which a step multiplies a small error, measured with the point at rest."""
    made = track(raw_tracker(gain), frames, start, Fixed(PATH.pose(0.0)))
    first, last = (system_at(q, 0.0).Psi for q in made.parameters_a[[0, -1], :2])
    return float((np.linalg.norm(last) / np.linalg.norm(first)) ** (1.0 / frames))
