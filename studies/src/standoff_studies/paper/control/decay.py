"""What one step of the real tracker does to small projection errors, against linear theory."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np

import standoff as so
from standoff.bodies import Body
from standoff.control import growth_factor, sampled_roots, stability_limit
from standoff.control.growth import Complex
from standoff.kernels.paper.integrators import NAMES
from standoff.motion import Pose, Twist
from standoff.tracking import feedback
from standoff.typing import Array

STEP = 1e-3
"""Frame time [s]."""
OFFSET = 1e-5
"""Error of the parameters at the start. Each start is mirrored and both results are combined, so
that the law's curvature only contributes the third power of this, 1e-15."""
DIRECTION = np.array([1.0, -0.7, 0.5, 0.8])
"""Direction of the error at the start, in parameters (u, v) of A and (r, s) of B."""
POINTS = 12
"""Gains measured per integrator, evenly spaced over the stable range."""
PROPORTIONAL = 0.2
"""K h of the PI law that is measured: stable for each integrator at each damping below."""
DAMPINGS = (1.4, 0.7, 0.5, 0.25)
"""Damping ratios zeta of the PI loop: K_i = (K / (2 zeta))². Above 1 both roots are real; at 1
they coincide, and no measurement can distinguish them."""

REST = Pose.identity(), Pose.exp([0.4, -0.1, 0.2], [2.5, 0.3, 0.2])
"""Where the two ellipsoids are, at rest."""
STILL = Twist.zero()


class Decay(NamedTuple):
    """Growth factors of one integrator.

    Attributes
    ----------
    z : (n,) array
        K h.
    measured, predicted : (n,) arrays
        Signed: the ratio of Psi after and before a step, and R(-K h).
    trackers : tuple of so.Tracker
    """

    z: Array
    measured: Array
    predicted: Array
    trackers: tuple[so.Tracker, ...]


@cache
def bodies() -> tuple[Body, Body]:
    """The two ellipsoids."""
    return so.shapes.ellipsoid(1.0, 0.7, 0.5), so.shapes.ellipsoid(0.4, 0.9, 0.6)


@cache
def optimum() -> so.Proximity:
    """Their witness points at rest."""
    return so.distance(*bodies(), *REST)


@cache
def tracker(**options: Any) -> so.Tracker:
    """The paper's law with some options, on the two ellipsoids."""
    return so.Tracker(*bodies(), dt=STEP, law=so.PaperLaw(**options))


def errors_after(steps: int, offset: Array, **options: Any) -> Array:
    """Psi (steps + 1, 4) of the paper's law at rest, from parameters `offset` from the minimum.

    It is the odd part in the offset: (result for offset - result for -offset) / 2.
    """
    return 0.5 * (_errors(steps, offset, options) - _errors(steps, -offset, options))


def _errors(steps: int, offset: Array, options: dict[str, Any]) -> Array:
    best = optimum()
    (u, v, chart_a), (r, s, chart_b) = best.parameters_a, best.parameters_b
    places = (
        (best.feature_a, (u + offset[0], v + offset[1], chart_a)),
        (best.feature_b, (r + offset[2], s + offset[3], chart_b)),
    )
    law = tracker(**options)
    state = law.start_from(*REST, *places, settle=False)
    rows = [so.tracking.pair_system(*bodies(), *REST, *places).Psi]
    for _ in range(steps):
        state, answer = law.step(state, *REST, STILL, STILL)
        now = (
            answer.place_a,
            answer.place_b,
        )
        rows.append(so.tracking.pair_system(*bodies(), *REST, *now).Psi)
    return np.array(rows)


@cache
def decays() -> dict[str, Decay]:
    """Growth factors measured over the stable range, by integrator."""
    found = {}
    for name in NAMES:
        z = stability_limit(name) * (np.arange(POINTS) + 0.5) / POINTS
        measured, ran = [], []
        for k in z.tolist():
            before, after = errors_after(1, OFFSET * DIRECTION, integrator=name, gain=k / STEP)
            measured.append(float(after @ before / (before @ before)))
            ran.append(tracker(integrator=name, gain=k / STEP))
        predicted = np.asarray(growth_factor(name, -z))
        found[name] = Decay(z, np.array(measured), predicted, tuple(ran))
    return found


class Loop(NamedTuple):
    """Roots of the sampled PI loop.

    Attributes
    ----------
    integrator : str
    gain, integral : float
        K [1/s] and K_i [1/s²].
    measured, predicted : (2,) complex arrays
    tracker : so.Tracker
    """

    integrator: str
    gain: float
    integral: float
    measured: Complex
    predicted: Complex
    tracker: so.Tracker


@cache
def loops() -> tuple[Loop, ...]:
    """Roots of the PI loop, from four successive errors of the tracker."""
    found = []
    for name in NAMES:
        for damping in DAMPINGS:
            gain = PROPORTIONAL / STEP
            law = feedback.PI(gain, (0.5 * gain / damping) ** 2)
            psi = errors_after(3, OFFSET * DIRECTION, integrator=name, feedback=law)
            e = psi @ psi[0] / (psi[0] @ psi[0])
            # two modes: e_(k+2) = t e_(k+1) - d e_k
            t, d = np.linalg.solve([[e[1], -e[0]], [e[2], -e[1]]], e[2:])
            measured = np.sort_complex(np.roots([1.0, -t, d]).astype(complex))
            predicted = np.sort_complex(sampled_roots(name, law, STEP))
            ran = tracker(integrator=name, feedback=law)
            found.append(Loop(name, law.gain, law.integral, measured, predicted, ran))
    return tuple(found)


class Arrival(NamedTuple):
    """The finite-time law's errors by step, measured and according to its equation.

    Attributes
    ----------
    measured, predicted : (n, 4) arrays
        Psi divided by its reference.
    """

    measured: Array
    predicted: Array


@cache
def arrival() -> Arrival:
    """If dPsi/dt = -K |Psi / r|^(p - 1) Psi, |Psi / r|^(1 - p) falls at the rate K (1 - p).

    Measured with RK4 until the law becomes linear.
    """
    law = feedback.FiniteTime(40.0, 0.5, OFFSET)
    psi = errors_after(12, OFFSET * DIRECTION, integrator="rk4", feedback=law) / law.reference
    left = np.sqrt(np.abs(psi[0])) - 0.5 * law.gain * STEP * np.arange(len(psi))[:, None]
    return Arrival(psi, np.sign(psi[0]) * np.maximum(left, 0.0) ** 2)
