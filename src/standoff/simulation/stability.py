"""Which contact a fixed step can still follow: the largest stable stiffness, the least slip
speed."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

import numpy as np

from standoff.kernels.dynamics.operator import METHODS
from standoff.kernels.paper.integrators import NODES, STAGES, WEIGHTS
from standoff.simulation.contact import HuntCrossley
from standoff.simulation.tolerances import LEAST_STABLE, STABLE_ROUNDING, STIFFNESS_FOUND
from standoff.typing import Array

GROWTH: Final = 0.01
"""The part of its energy that a contact may gain over a half period by the method alone: Euler's,
Heun's and the midpoint rule let every undamped spring grow, more slowly the shorter the step."""


def propagation(method: str, stiffness: float, damping: float, dt: float) -> Array:
    """(2, 2): what a step makes of (x, v) of ``x'' = -stiffness x - damping x'`` [1/s², 1/s]."""
    rate = np.array([[0.0, 1.0], [-stiffness, -damping]])
    if method not in METHODS[:-1]:
        v = np.array([[-dt * stiffness, 1.0 - dt * damping]])
        return np.vstack([np.array([[1.0, 0.0]]) + dt * v, v])
    number = METHODS.index(method)
    total, last = np.zeros((2, 2)), np.zeros((2, 2))
    for stage in range(STAGES[number]):
        last = rate @ (np.eye(2) + NODES[number, stage] * dt * last)
        total += WEIGHTS[number, stage] * last
    return np.asarray(np.eye(2) + dt * total)


def is_stable(method: str, stiffness: float, damping: float, dt: float) -> bool:
    """Does a spring of this stiffness and damping by mass [1/s², 1/s] keep its energy, but for
    GROWTH over a half period?
    """
    radius = float(np.abs(np.linalg.eigvals(propagation(method, stiffness, damping, dt))).max())
    return _keeps(radius, stiffness, dt)


def _keeps(radius: float, stiffness: float, dt: float) -> bool:
    if radius <= 1.0 + STABLE_ROUNDING:
        return True
    if stiffness == 0.0:
        return False
    steps = math.pi / (math.sqrt(stiffness) * dt)
    return 2.0 * steps * math.log(radius) <= math.log1p(GROWTH)


def largest_stable_stiffness(
    contact: HuntCrossley, method: str, dt: float, give: float, depth: float
) -> float:
    """The largest k [force/length^1.5] that a step can follow at a depth.

    Parameters
    ----------
    give : float
        The inverse of the mass that the contact moves [1/mass].
    """

    def stable(k: float) -> bool:
        slope, drag = HuntCrossley(stiffness=k, damping=contact.damping).tangent(depth)
        return is_stable(method, give * slope, give * drag, dt)

    # far beyond the limit of any method: a spring whose period is a tenth of the step
    return _largest(stable, (20.0 * math.pi / dt) ** 2 / (1.5 * give * math.sqrt(depth)))


def largest_coupled_stiffness(damping: float, method: str, dt: float, give: float) -> float:
    """The largest stiffness [force/length, or torque/rad] with which a coupler that is held over a
    step lets its tool be followed; 0 where its damping alone is too much.

    Parameters
    ----------
    damping : float
        [force time/length], or of a rotation.
    give : float
        The inverse of the mass or inertia that it moves.
    """

    def stable(k: float) -> bool:
        return is_stable_held(method, give * k, give * damping, dt)

    found = _largest(stable, (20.0 * math.pi / dt) ** 2 / give)
    return found if stable(found) else 0.0


def is_stable_held(method: str, stiffness: float, damping: float, dt: float) -> bool:
    """Does a spring and damper by mass [1/s², 1/s] keep its energy, but for GROWTH over a half
    period, whose force is that of a step's start, held over it?
    """
    if stiffness == 0.0 and damping == 0.0:
        return True
    push = np.array([[-stiffness, -damping]])
    v = np.array([[0.0, 1.0]]) + dt * push
    way = {"semi-implicit": v, "euler": np.array([[0.0, 1.0]])}
    mean = way.get(method, v - 0.5 * dt * push)
    made = np.vstack([np.array([[1.0, 0.0]]) + dt * mean, v])
    return _keeps(float(np.abs(np.linalg.eigvals(made)).max()), stiffness, dt)


def _largest(stable: Callable[[float], bool], high: float) -> float:
    """The largest stable stiffness below one that is not."""
    low = high
    while not stable(low) and low > LEAST_STABLE * high:
        low *= 0.1
    high = min(high, 10.0 * low)
    while high > (1.0 + STIFFNESS_FOUND) * low:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low


def least_slip_speed(friction: float, weight: float, give: float, dt: float) -> float:
    """The least slip speed at which friction under a body's own weight does not overshoot rest.

    Below it friction slows a body by ``friction weight give / slip_speed`` times its speed a
    second, and all methods need that to be at most 2/dt.
    """
    return 0.5 * friction * weight * give * dt
