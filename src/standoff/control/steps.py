"""What the steps of a law do to the errors of a pair at rest, from small ones to the level of V.

In continuous time V = |g|²/2, in the metric of the optimum, falls wherever H is regular. A step of
length h changes H along its way. Where K h is small, or the error, it multiplies |g| by the growth
factor R(-K h); else by more. Near the greatest stable gain |R| is nearly 1, so little more is
enough: the errors that still fall shrink with it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from standoff.checks.numbers import whole_number
from standoff.checks.real_numbers import shown
from standoff.control.basin import AtRest
from standoff.control.lyapunov import PART, LyapunovLevels, System, on_curve
from standoff.control.tolerances import FOUND_MINIMUM
from standoff.errors import StandoffError, StandoffTypeError
from standoff.geometry.validation import Array
from standoff.motion import PoseLike
from standoff.tracking import Tracker, distance
from standoff.tracking.inputs import flat_pose
from standoff.tracking.places import PlaceLike
from standoff.tracking.rows import AnswerRows

SIZES = PART * np.geomspace(1e-3, 1.0, 49)
"""Errors that are tried on each curve, in parts of the level's sqrt(2 V)."""


class StepGrowth(NamedTuple):
    """By what some steps multiply the errors of a pair at rest.

    Attributes
    ----------
    slopes : (m,) array
        Errors before, sqrt(2 V), length.
    growth : (m,) array
        The greatest factor among the starts with that error; near 0 it is |R(-K h)| to the power of
        the steps. inf where a step leaves the features.
    start_error : float
        Where both witness points are nearer than this to those of the optimum, every start that was
        tried falls; 0 if none does. Length.
    """

    slopes: Array
    growth: Array
    start_error: float


def step_growth(
    tracker: Tracker,
    pose_a: PoseLike,
    pose_b: PoseLike,
    levels: LyapunovLevels,
    steps: int = 2,
) -> StepGrowth:
    """Before a run: from which starts do the errors fall, with this gain, integrator and step?

    If V falls over `steps` steps from every start within a level, then all these starts converge.
    It is tried on the curves of `levels`, at 49 sizes each: between them it is not proven.

    Parameters
    ----------
    tracker : Tracker
        With the paper's law; with ``solve="plain"`` it is the raw law.
    pose_a, pose_b : Pose or what ``Pose.of`` reads
        World poses; the bodies stay there.
    levels : LyapunovLevels
        Of the same pair at these poses.
    steps : int
        Steps of ``tracker.dt`` between which V is compared. Near its limit Euler's method turns an
        error round with each step, and what is of second order cancels over two.

    Returns
    -------
    StepGrowth

    Raises
    ------
    TypeError
        No tracker, no levels.
    ValueError
        No steps; levels of another pair or pose.
    """
    for given, kind in ((tracker, Tracker), (levels, LyapunovLevels)):
        if not isinstance(given, kind):
            raise StandoffTypeError(f"{shown(given)} is not a {kind.__name__}.")
    at_rest = AtRest(tracker, flat_pose(pose_a), flat_pose(pose_b), whole_number(steps, "steps"))
    system = System(tracker.a, tracker.b, pose_a, pose_b)
    best = distance(tracker.a, tracker.b, pose_a, pose_b)
    q0 = system.place(best.place_a, best.place_b)
    if (
        q0.shape != levels.optimum.shape
        or system.offset(q0, levels.optimum) > FOUND_MINIMUM * system.size
    ):
        raise StandoffError("The levels are those of another pair or pose.", "levels", levels)
    mode, of_a = system.mode.copy(), int((system.kept < 2).sum())
    L = np.array(np.linalg.cholesky(levels.metric), dtype=np.float64)
    sizes = np.sqrt(2.0 * levels.level) * SIZES
    pairs = zip(levels.slopes, levels.curves, strict=True)
    starts = np.concatenate([on_curve(*curve, sizes) for curve in pairs])

    def place(given: PlaceLike, q: Array) -> PlaceLike:
        return given[0], (*q, *given[1][len(q) :])  # an atlas's chart comes behind

    places = [(place(best.place_a, q[:of_a]), place(best.place_b, q[of_a:])) for q in starts]
    ended = AnswerRows(np.array([at_rest.after(*each) for each in places]))
    stayed = (ended.mode == mode).all(axis=1)
    ends = zip(ended.q[:, system.kept], stayed, strict=True)
    after = np.array([system.slope(q, L) if on else np.inf for q, on in ends])
    before = np.array([system.slope(q, L) for q in starts])
    growth = (after / before).reshape(-1, len(sizes)).max(axis=0)
    fall = int(np.argmax(np.append(growth >= 1.0, True)))  # of the sizes, from the least on
    near = [system.offset(q, q0) for q in starts.reshape(-1, len(sizes), len(q0))[:, fall - 1]]
    return StepGrowth(sizes, growth, float(min(near)) if fall else 0.0)
