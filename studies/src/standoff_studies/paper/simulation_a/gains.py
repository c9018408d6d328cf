"""Which gains can be used: measured on simulation A, and by linear theory."""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np

from standoff.control import growth_factor
from standoff.tracking import Tracker, distance, max_gain
from standoff.tracking.laws import PaperLaw
from standoff.typing import Array
from standoff_studies.paper.pair_simulation import REST
from standoff_studies.paper.simulation_a.raw_law import Trials, growth_of_small_errors, try_all
from standoff_studies.paper.simulation_a.run import (
    SETTLED,
    Run,
    projection_errors,
    run,
    system_at,
    track,
)
from standoff_studies.paper.simulation_a.setting import FACE, PATH, START, STEP, point, vault

LIMIT = max_gain("heun", STEP)
"""Largest stable gain by linear theory [1/s]: 2000."""

STATED = (0.5, 1500.0)
"""The paper's stable range by experiment [1/s]."""

GAINS = (
    *(0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0),
    *(100.0, 200.0, 400.0, 600.0, 800.0, 1000.0, 1200.0, 1400.0),
    *(1500.0, 1600.0, 1700.0, 1800.0, 1900.0, 1950.0, 1980.0, 1990.0),
)
"""Gains at which the steps to settle are counted [1/s]: the paper's range, and beyond both ends."""

SLACK_OF_STEPS = 1.2
"""A run counts as not settled after this multiple of the steps of linear theory."""

TRIED_GAINS = (*range(1000, 1950, 50), 1950, 1980)
"""Gains that are tried from every start [1/s]."""

TRIED_FRAMES = 600
"""Steps of a trial: at K = 1980 linear theory takes 345."""

GRID = 15
"""Starts along u and along v, 0.02 to 0.98: 225 of them, at most half of the patch's width from the
closest point."""

NEAR = (1995.0, 1999.0)
"""Gains from whose growth factors the limit for small errors is extrapolated [1/s]; ``so.Tracker``
rejects any from 2000 on."""

SMALL = 1e-4
"""A small error of the parameters: its nonlinear part is below a thousandth of it."""

SMALL_FRAMES = 400
"""Steps in which a small error visibly decays, 1 1/s below the limit: by 1e-3 each, by a third in
total; the second order of `SMALL` stays far below that."""

TURN = 3142
"""Steps in which the point goes around once."""

STRIDE = 8
"""Every how many steps the steady error is evaluated: a 400th of the turn, over which it changes by
a relative 1e-4 where it is greatest."""

STEADY_GAINS = (
    *(0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0),
    *(200.0, 500.0, 1000.0, 1500.0, 1800.0, 1900.0, 1950.0, 1980.0),
)
"""Gains at which the steady errors are measured [1/s]."""


class Settling(NamedTuple):
    """Steps until all errors are below `SETTLED`, by gain; arrays of shape (m,)."""

    gain: Array
    steps: Array
    predicted: Array
    monotone: Array


class Steady(NamedTuple):
    """Greatest error in the second turn, by gain [length²]; arrays of shape (m,)."""

    gain: Array
    forward: Array
    without: Array


def growth(gain: Array | float) -> Array:
    """The factor by which a step of Heun's method multiplies the errors, in linear theory."""
    return np.asarray(growth_factor("heun", -STEP * np.asarray(gain, dtype=float)))


def predicted_steps(gain: Array | float) -> Array:
    """Steps until an error is below `SETTLED`, in linear theory."""
    return np.asarray(np.ceil(np.log(SETTLED) / np.log(growth(gain))))


@cache
def settling() -> Settling:
    """Count the steps from `START` at every gain of `GAINS`, by the tracker."""
    rows = []
    for gain in GAINS:
        predicted = int(predicted_steps(gain))
        made = run(gain, int(SLACK_OF_STEPS * predicted) + 5)
        steps = np.nan if made.steps is None else float(made.steps)
        rows.append((gain, steps, predicted, made.monotone))
    return Settling(*(np.array(column) for column in zip(*rows, strict=True)))


@cache
def starts() -> Array:
    """Return the tried starts, (u, v), shape (GRID², 2)."""
    line = np.linspace(0.02, 0.98, GRID)
    return np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1).reshape(-1, 2)


@cache
def trials() -> Trials:
    """Try every start at every gain of `TRIED_GAINS`, by the law without safeguards."""
    return try_all(starts(), np.array(TRIED_GAINS, dtype=float), TRIED_FRAMES)


def settled_share(gain: float) -> float:
    """The fraction of all starts that settles at one of `TRIED_GAINS` [1/s]."""
    return float((trials().steps[TRIED_GAINS.index(int(gain))] >= 0).mean())


def greatest_for_all() -> float:
    """The greatest tried gain [1/s] up to which every start settles."""
    fails = np.flatnonzero((trials().steps < 0).any(axis=1))
    return float(TRIED_GAINS[int(fails[0]) - 1] if len(fails) else TRIED_GAINS[-1])


@cache
def rescued() -> tuple[int, int]:
    """In how many of the failed trials `so.Tracker` succeeds at the same gain, and of how many.

    It holds the rims, and for an indefinite H it uses the magnitudes of its eigenvalues.
    """
    failed = np.argwhere(trials().steps < 0)
    home = 0
    for at, start in failed.tolist():
        begin = (float(starts()[start, 0]), float(starts()[start, 1]))
        safe = Tracker(vault(), point(), STEP, law=PaperLaw(gain=float(TRIED_GAINS[at])))
        made = Run(TRIED_GAINS[at], track(safe, TRIED_FRAMES, begin))
        psi = projection_errors(made.q[[0, -1]], made.target[[0, -1]])
        first, last = np.linalg.norm(psi, axis=1).tolist()
        home += made.recording.feature_a[-1] == FACE and last < SETTLED * first
    return home, len(failed)


@cache
def small_error_limit() -> float:
    """The gain [1/s] at which a small error would begin to grow, the point at rest.

    The straight line through the growth factors at the gains `NEAR` is extrapolated to 1; nan if it
    does not rise, which cannot happen with a law that runs at those gains.
    """
    u, v = closest_start()
    measured = [growth_of_small_errors(k, (u + SMALL, v + SMALL), SMALL_FRAMES) for k in NEAR]
    slope = (measured[1] - measured[0]) / (NEAR[1] - NEAR[0])
    if slope <= 0.0:
        return math.nan
    return float(NEAR[1] + (1.0 - measured[1]) / slope)


@cache
def closest_start() -> tuple[float, float]:
    """Parameters (u, v) of the closest point at the start."""
    u, v = distance(vault(), point(), REST.pose(0.0), PATH.pose(0.0)).parameters_a
    return float(u), float(v)


@cache
def held(gain: float, feedforward: bool) -> Run | None:
    """Two turns from the closest point; None if the witness point leaves the patch."""
    try:
        return run(gain, 2 * TURN, closest_start(), feedforward)
    except RuntimeError:
        return None


@cache
def steady() -> Steady:
    """Measure the steady errors with and without the feedforward."""
    rows = []
    for gain in STEADY_GAINS:
        errors = [_greatest_error(held(gain, fed)) for fed in (True, False)]
        rows.append((gain, *errors))
    return Steady(*(np.array(column) for column in zip(*rows, strict=True)))


@cache
def greatest_feedforward() -> float:
    """Greatest component of b = -F'v along the turn [length²/s], at the closest points."""
    made = held(1000.0, True)
    if made is None:
        raise RuntimeError("K = 1000 1/s: the witness point left the patch.")
    found = zip(made.q, made.recording.time.tolist(), strict=True)
    return float(max(np.abs(system_at(q, time).b).max() for q, time in found))


def first_errors() -> Array:
    """Errors at `START` [length²], shape (2,)."""
    return np.asarray(system_at(np.array(START), 0.0).Psi)


def _greatest_error(made: Run | None) -> float:
    if made is None:
        return np.nan
    seen = slice(TURN, None, STRIDE)
    return float(np.abs(projection_errors(made.q[seen], made.target[seen])).max())
