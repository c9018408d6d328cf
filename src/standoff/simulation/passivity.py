r"""Which stiffness and damping a sampled spring and damper may have and stay passive.

A haptic device reads its position every T seconds and holds its force in between. A spring of
stiffness K that is rendered this way gives back more than it took, by up to K T/2 times v² dt,
because it acts late. The device's own friction must take that, or the device can hum against a hand
that is passive itself.

Colgate and Schenkel (J. Robotic Systems 14(1), 1997, Eq. (1)) prove: a device with the damping b,
rendering the law H(z) from sampled position to force held, is passive if and only if

    b > T/2 · 1/(1 − cos θ) · Re{(1 − e^{−jθ}) H(e^{jθ})}    for all θ = ωT in (0, π].

With H = z⁻ⁿ (K + B F(z) (1 − z⁻¹)/T), a spring, a damper on the velocity by backward differences,
its filter F and n ticks of delay, that is

    b > K T/2 · sin((n + ½)θ)/sin(θ/2) − B Re{e^{−j(n+1)θ} F(e^{jθ})}.

Without delay and filter the right side is K T/2 − B cos θ, at most K T/2 + |B|: the known bound of
the virtual wall. With a delay of n ticks the spring alone needs (2n + 1) K T/2.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any, Final

import numpy as np
import scipy

from standoff.checks.numbers import not_negative, number, positive, whole_number
from standoff.checks.real_numbers import shown
from standoff.errors import PassivityError, StandoffError, StandoffTypeError
from standoff.simulation.tolerances import (
    DAMPING_ROUNDING,
    FIRST_FREQUENCY,
    NO_DAMPING,
    PEAK_FOUND,
    STIFFNESS_ROUNDING,
)
from standoff.typing import Array

ANGLES: Final = 2048
"""Frequencies between 0 and Nyquist's at which a right side is looked at before its greatest value
is refined: 50 for each swing of the longest delay accepted."""

MOST_ANGLES: Final = 1_000_000
"""Frequencies that may be asked for: a tenth of a second, and some ten megabytes."""

LONGEST_DELAY: Final = 20
"""Ticks. Beyond it the largest passive stiffness is below a fortieth of that without delay."""


@dataclass(frozen=True, kw_only=True)
class Sampling:
    """What a coupler's passivity depends on in the device and in the loop that drives it.

    Raises StandoffError: a period that is not above zero, a damping or time constant below zero, or
    a delay that is not a whole number from 0 to 20.

    Parameters
    ----------
    period : float
        Time between two readings, during which the force is held [s].
    device_damping : float
        The device's own damping against translation, the least over all directions [N s/m].
    device_rotational_damping : float
        The same against rotation [N m s/rad].
    delay : int
        Whole periods from a reading to the force that answers it, 0 to 20.
    velocity_time_constant : float
        Of the first-order filter (backward Euler) behind the velocity's differences [s].
    """

    period: float
    device_damping: float
    device_rotational_damping: float = 0.0
    delay: int = 0
    velocity_time_constant: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            name, value = field.name, getattr(self, field.name)
            if name == "delay":
                read: float = whole_number(value, name, 0, LONGEST_DELAY)
            else:
                read = positive(value, name) if name == "period" else not_negative(value, name)
            object.__setattr__(self, name, read)


def required_damping(stiffness: float, damping: float, sampling: Sampling) -> float:
    """Return the device's damping that a sampled spring and damper needs to be passive.

    Raises StandoffError: a number that is not finite, a stiffness below zero, or not a `Sampling`.

    Parameters
    ----------
    stiffness : float
        K [N/m], or [N m/rad] for a rotation.
    damping : float
        B [N s/m], or [N m s/rad]; may be below zero.
    sampling : Sampling

    Returns
    -------
    float
        The least b [N s/m], or [N m s/rad]: the greatest right-hand side over all frequencies.
    """
    k = not_negative(stiffness, "stiffness")
    _check_sampling(sampling)
    b = number(damping, "damping")

    def right_side(angles: Array) -> Array:
        of_spring, of_damper = _shares(angles, sampling)
        both: Array = k * of_spring + b * of_damper
        return both

    return _greatest(right_side)


def largest_stiffness(damping: float, device_damping: float, sampling: Sampling) -> float:
    """Return the largest stiffness that stays passive with a damping.

    Raises StandoffError: a number that is not finite, a device's damping below zero, or not a
    `Sampling`.

    Parameters
    ----------
    damping : float
        B of the coupler [N s/m], or [N m s/rad].
    device_damping : float
        b of the device, in the same unit; that of `sampling` is ignored.
    sampling : Sampling
        Period, delay and filter.

    Returns
    -------
    float
        K [N/m], or [N m/rad]; -inf if no stiffness is passive with so much damping.
    """
    b = number(damping, "damping")
    own = not_negative(device_damping, "device_damping")
    _check_sampling(sampling)

    def excess(angles: Array) -> Array:
        of_spring, of_damper = _shares(angles, sampling)
        bounded = of_spring > 0.0
        over = np.full(angles.shape, -math.inf)
        over[bounded] = -(own - b * of_damper[bounded]) / of_spring[bounded]
        return over

    largest = -_greatest(excess)
    if (
        largest < 0.0
        or required_damping(largest, b, sampling) > own * (1.0 + STIFFNESS_ROUNDING) + NO_DAMPING
    ):
        return -math.inf
    return largest


def required_damping_of(
    position_to_force: Callable[[Any], Any], period: float, angles: int = ANGLES
) -> float:
    """Return the device's damping that any linear sampled law needs to be passive.

    For laws of your own, such as a coupler in series with a simulated tool.

    Raises StandoffError: a period that is not above zero, fewer than 8 angles or more than 10⁶, not
    a function, or one that answers with another shape or with numbers that are not finite.

    Parameters
    ----------
    position_to_force : callable
        H: from an array of complex z on the unit circle to the array of H(z) [N/m].
    period : float
        T [s]
    angles : int
        Frequencies looked at, evenly from about 0 to Nyquist's. The greatest value is refined
        between them; a resonance that is narrower than their spacing needs more.

    Returns
    -------
    float
        The least b [N s/m]
    """
    seconds = positive(period, "period")
    if not callable(position_to_force):
        raise StandoffTypeError(
            f"position_to_force is {shown(position_to_force)}: give a function of an array",
            "position_to_force",
            position_to_force,
        )
    angles = whole_number(angles, "angles", 8, MOST_ANGLES)

    def right_side(given: Array) -> Array:
        try:
            answered = np.asarray(position_to_force(np.exp(1j * given)), dtype=np.complex128)
        except (TypeError, ValueError) as error:
            raise StandoffError(
                f"position_to_force raises {error}: give a function of an array of complex z",
                "position_to_force",
                position_to_force,
            ) from error
        if answered.shape != given.shape or not np.isfinite(answered).all():
            raise StandoffError(
                f"position_to_force answers with shape {answered.shape} to {given.shape}, or with "
                "numbers that are not finite: give a function of an array of complex z",
                "position_to_force",
                position_to_force,
            )
        # (1 − e^{−jθ})/(1 − cos θ) = 1 + j cot(θ/2): no digits are lost at small angles.
        turned = (1.0 + 1j / np.tan(0.5 * given)) * answered
        found: Array = 0.5 * seconds * np.real(turned)
        return found

    return _greatest(right_side, first=FIRST_FREQUENCY * math.pi / angles, angles=int(angles))


def check_passive(stiffness: float, damping: float, sampling: Sampling, *, of: str) -> None:
    """Refuse a spring and damper that the device's own damping does not keep passive.

    Raises PassivityError: the message says by how much, and gives the largest stiffness.
    """
    kind, unit, spring = (
        ("rotational_", "N m s/rad", "N m/rad") if of == "rotation" else ("", "N s/m", "N/m")
    )
    own = float(getattr(sampling, f"device_{kind}damping"))
    needed = required_damping(stiffness, damping, sampling)
    if needed <= own * (1.0 + DAMPING_ROUNDING):
        return
    largest = largest_stiffness(damping, own, sampling)
    cure = (
        f"the largest passive {kind}stiffness with this damping is {largest:.6g} {spring}"
        if largest > 0.0
        else f"no {kind}stiffness is passive with so much damping; lower {kind}damping first"
    )
    raise PassivityError(
        f"{kind}stiffness {stiffness:g} {spring} with {kind}damping {damping:g} {unit} at a period "
        f"of {sampling.period:g} s needs a device_{kind}damping of {needed:.6g} {unit}, and there "
        f"is {own:g}: {needed - own:.6g} too little (Colgate and Schenkel, 1997); {cure}; or "
        "sample faster, or add friction to the device",
        f"{kind}stiffness",
        stiffness,
        required=needed,
        largest=max(largest, 0.0),
    )


def _check_sampling(sampling: Any) -> None:
    if not isinstance(sampling, Sampling):
        raise StandoffTypeError(
            f"sampling is {shown(sampling)}: give a Sampling", "sampling", sampling
        )


def _shares(angles: Array, sampling: Sampling) -> tuple[Array, Array]:
    """The right side per unit of stiffness and per unit of damping, at angles from 0 to π."""
    n, T = sampling.delay, sampling.period
    half = np.sin(0.5 * angles)
    safe = np.where(half > 0.0, half, 1.0)
    kernel = np.where(half > 0.0, np.sin((n + 0.5) * angles) / safe, 2.0 * n + 1.0)
    past = sampling.velocity_time_constant / (sampling.velocity_time_constant + T)
    low_pass = (1.0 - past) / (1.0 - past * np.exp(-1j * angles))
    return 0.5 * T * kernel, -np.real(np.exp(-1j * (n + 1.0) * angles) * low_pass)


def _greatest(
    function: Callable[[Array], Array], first: float = 0.0, angles: int = ANGLES
) -> float:
    """The greatest value over angles from `first` to π: on a grid, then refined around it."""
    grid = np.linspace(first, math.pi, angles + 1)
    values = function(grid)
    best = int(np.argmax(values))
    around = grid[max(best - 1, 0)], grid[min(best + 1, angles)]
    refined = scipy.optimize.minimize_scalar(
        lambda angle: -float(function(np.array([angle]))[0]),
        bounds=around,
        method="bounded",
        options={"xatol": PEAK_FOUND},
    )
    return max(float(values[best]), -float(refined.fun))
