"""What the steps of a law do to the errors of a pair at rest (docs/laws.md)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from standoff.checks.real_numbers import shown
from standoff.control.basin import AtRest
from standoff.control.lyapunov import LyapunovLevels, RestSystem
from standoff.control.tolerances import FOUND_MINIMUM
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion import PoseLike
from standoff.tracking import Tracker, distance
from standoff.tracking.inputs import flat_pose
from standoff.tracking.rows import AnswerRows
from standoff.typing import Array

SIZES = 0.999 * np.logspace(-3, 0, 49)  # of the level's sqrt(2 V): errors tried on each curve
STEPS = 2  # Euler's turns an error round: what is of second order cancels over two


class StepGrowth(NamedTuple):
    """By what two steps multiply the errors of a pair at rest.

    Attributes
    ----------
    slopes : (m,) array
        Errors before, sqrt(2 V), length.
    growth : (m,) array
        The greatest factor there: R(-K h)² near 0, inf where a step leaves the features.
    start_error : float
        Both witness points nearer than this to the optimum's: all that were tried fall; length.
    """

    slopes: Array
    growth: Array
    start_error: float


def step_growth(
    tracker: Tracker, pose_a: PoseLike, pose_b: PoseLike, levels: LyapunovLevels
) -> StepGrowth:
    """Before a run: from which starts do errors fall with a tracker's gain, integrator and step?

    Where V falls over two steps from every start within a level, all of them converge. Tried on the
    curves of `levels` at 49 errors each: between them it is not proven.

    Raises TypeError: no tracker or levels. Raises ValueError: levels of another pair or pose.

    Parameters
    ----------
    tracker : Tracker
        With the paper's law; with ``solve="plain"`` it is the raw law.
    pose_a, pose_b : Pose or what ``Pose.of`` reads
    levels : LyapunovLevels
        Of the same pair at these poses.

    Returns
    -------
    StepGrowth
    """
    for given, kind in ((tracker, Tracker), (levels, LyapunovLevels)):
        if not isinstance(given, kind):
            raise StandoffTypeError(f"{shown(given)} is not a {kind.__name__}.")
    system = RestSystem(tracker.a, tracker.b, pose_a, pose_b)
    best = distance(tracker.a, tracker.b, pose_a, pose_b)
    q0 = system.place(best.place_a, best.place_b)
    n, i = len(q0), int((system.kept < 2).sum())

    def offset(q: Array) -> float:
        return float(np.linalg.norm(system.points(q) - system.points(q0), axis=1).max())

    def slope(q: Array) -> float:
        return float(np.linalg.norm(np.linalg.solve(L, system.at(q)[0])))

    if len(levels.optimum) != n or offset(levels.optimum) > FOUND_MINIMUM * system.size:
        raise StandoffError("The levels are those of another pair or pose.", "levels", levels)
    L, sizes = np.linalg.cholesky(levels.metric), np.sqrt(2.0 * levels.level) * SIZES
    curves = zip(levels.slopes, levels.curves, strict=True)
    tried = np.array([[np.interp(sizes, s, x) for x in q.T] for s, q in curves]).swapaxes(1, 2)
    frames = AtRest(tracker, flat_pose(pose_a), flat_pose(pose_b), STEPS)
    flat, (on_a, a), (on_b, b) = tried.reshape(-1, n), best.place_a, best.place_b
    split = [((*q[:i], *a[i:]), (*q[i:], *b[n - i :])) for q in flat]  # an atlas's chart is last
    ended = AnswerRows(np.array([frames.after((on_a, p), (on_b, q)) for p, q in split]))
    stayed = zip(ended.q[:, system.kept], (ended.mode == system.mode).all(axis=1), strict=True)
    factors = [slope(q) if on else np.inf for q, on in stayed] / np.array([slope(q) for q in flat])
    growth = factors.reshape(-1, len(sizes)).max(axis=0)
    fall = int(np.argmax(np.append(growth >= 1.0, True)))  # of the errors, from the least on
    return StepGrowth(sizes, growth, min(map(offset, tried[:, fall - 1])) if fall else 0.0)
