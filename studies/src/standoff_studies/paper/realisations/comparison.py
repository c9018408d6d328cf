"""How much the two realisations differ: by step, by gain, in time, and with wrong twists."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from standoff.tracking import Tracker
from standoff.typing import Array
from standoff_studies.paper.realisations.run import MISS, RIGHT, Trace, exact, trace, true_errors

REALISATIONS = ("integrated", "evaluated")
"""Fig. 3 and Fig. 4, as `so.Tracker` names them."""

SPAN = 0.4
"""Time [s] after which witness points are compared."""

FRAMES = (50, 100, 200, 400, 800)
"""Steps in that time: 8 ms down to 0.5 ms."""

GAINS = (25.0, 50.0, 100.0, 200.0)
"""Gains at which they are compared, by Heun's method [1/s]."""

GAIN = 50.0
"""The gain of all other comparisons [1/s]."""

ORDERS = {"euler": 1, "heun": 2, "rk4": 4}
"""Integrators that are compared, and their orders."""

LONG_STEP, LONG_FRAMES = 1e-2, 2000
"""Step [s] and frames of the long runs: 20 s, five turns of B."""

BIASES = (0.0, 0.01, 0.02)
"""Bias that a sensor on A adds to B's velocity along its x axis [length/s]."""

SHORT_STEP, SHORT_FRAMES = 5e-3, 240
"""Step [s] and frames of the run of Fig. 3: 1.2 s."""


class Difference(NamedTuple):
    """Greatest distance of the realisations' witness points after `SPAN`, by step.

    Attributes
    ----------
    step : ndarray, shape (n,)
        s.
    apart : ndarray, shape (n,)
        [length].
    """

    step: Array
    apart: Array

    @property
    def orders(self) -> Array:
        """Order in the step between neighbours, shape (n - 1,)."""
        return np.asarray(np.log2(self.apart[:-1] / self.apart[1:]))


class Decay(NamedTuple):
    """Norms of the errors after a wrong start [length²], by frame of `SHORT_STEP`; shape (n,).

    Attributes
    ----------
    believed : ndarray
        The integrated errors, on which the law of Fig. 3 acts.
    integrated, evaluated : ndarray
        The true errors, Eqs. (1)-(4), of the two realisations.
    """

    believed: Array
    integrated: Array
    evaluated: Array


def difference(integrator: str, gain: float) -> Difference:
    """Compare the realisations, both started at the same wrong parameters."""
    apart = []
    for frames in FRAMES:
        runs = [trace(name, integrator, gain, SPAN / frames, frames, MISS) for name in REALISATIONS]
        apart.append(_farthest(runs[0].points - runs[1].points)[-1])
    return Difference(SPAN / np.array(FRAMES, dtype=float), np.array(apart))


def trackers() -> tuple[Tracker, ...]:
    """Return the comparisons: both realisations, in time, by each integrator and at each gain."""
    step = SPAN / FRAMES[0]
    made = [
        one
        for name in REALISATIONS
        for one in (
            trace(name, "heun", GAIN, SHORT_STEP, SHORT_FRAMES, MISS),
            trace(name, "heun", GAIN, LONG_STEP, LONG_FRAMES, RIGHT, 0.0),
            *(trace(name, integrator, GAIN, step, FRAMES[0], MISS) for integrator in ORDERS),
            *(trace(name, "heun", gain, step, FRAMES[0], MISS) for gain in GAINS),
        )
    ]
    return tuple(one.tracker for one in made)


@cache
def by_gain() -> dict[float, Difference]:
    """By gain, Heun's method."""
    return {gain: difference("heun", gain) for gain in GAINS}


@cache
def by_integrator() -> dict[str, Difference]:
    """By integrator, K = `GAIN`."""
    return {name: difference(name, GAIN) for name in ORDERS}


@cache
def decay() -> Decay:
    """Follow the errors of both realisations from the wrong start, by Heun's method."""
    runs: dict[str, Trace] = {
        name: trace(name, "heun", GAIN, SHORT_STEP, SHORT_FRAMES, MISS) for name in REALISATIONS
    }
    true = {name: np.linalg.norm(true_errors(made), axis=1) for name, made in runs.items()}
    believed = np.linalg.norm(runs["integrated"].believed, axis=1)
    return Decay(
        np.asarray(believed), np.asarray(true["integrated"]), np.asarray(true["evaluated"])
    )


@cache
def drift(realisation: str, integrator: str = "heun", bias: float = 0.0) -> Array:
    """Witness errors of a long run from the right start [length], by frame."""
    made = trace(realisation, integrator, GAIN, LONG_STEP, LONG_FRAMES, RIGHT, bias)
    return _farthest(made.points - exact(LONG_STEP, LONG_FRAMES))


def long_time() -> Array:
    """Times of a long run [s]."""
    return np.asarray(LONG_STEP * np.arange(LONG_FRAMES + 1))


def rate_of(errors: Array) -> tuple[float, float]:
    """Slope [length/s] of the straight line through 0 that fits a long run, and its misfit.

    The misfit is the greatest distance from the line divided by the greatest error.
    """
    time = long_time()
    slope = float(time @ errors / (time @ time))
    return slope, float(np.abs(errors - slope * time).max() / errors.max())


def level_of(errors: Array) -> tuple[float, float]:
    """Greatest error [length] in the first and in the second half of a long run."""
    half = len(errors) // 2
    return float(errors[:half].max()), float(errors[half:].max())


def _farthest(points: Array) -> Array:
    """The greater length of the two points' differences, (n, 6) to (n,)."""
    return np.asarray(np.linalg.norm(points.reshape(-1, 2, 3), axis=2).max(axis=1))
