"""Growth factors of the integrators: what one step does to an error, read off their tableaux."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from standoff.checks.names import choice
from standoff.checks.numbers import not_negative, positive
from standoff.checks.real_numbers import shown
from standoff.control.tolerances import REAL_LIMIT
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.paper import integrators as I
from standoff.tracking.feedback import Feedback, growth_factor

Complex = NDArray[np.complex128]


def growth_polynomial(integrator: str) -> Polynomial:
    """R(x) as a polynomial: a step of length h multiplies an error with e' = rate e by R(rate h).

    Raises ValueError: unknown integrator.

    Parameters
    ----------
    integrator : "euler", "heun", "midpoint" or "rk4"

    Returns
    -------
    numpy.polynomial.Polynomial
        In x = rate h, real or complex; the paper's law has rate = -K. Worked out from the tableau
        that the kernels step with: stage i has k_i = rate (1 + c_i h k_(i-1)).
    """
    number = I.NAMES.index(choice(integrator, "integrator", I.NAMES))
    x = Polynomial([0.0, 1.0])
    factor, stage = Polynomial([1.0]), Polynomial([0.0])
    for i in range(int(I.STAGES[number])):
        stage = x * (1.0 + float(I.NODES[number, i]) * stage)
        factor = factor + float(I.WEIGHTS[number, i]) * stage
    return factor


def stability_limit(integrator: str) -> float:
    """The least z = K h > 0 at which |R(-z)| reaches 1: beyond it the errors grow.

    Raises ValueError: unknown integrator.

    Parameters
    ----------
    integrator : "euler", "heun", "midpoint" or "rk4"

    Returns
    -------
    float
        Gain times step, dimensionless.
    """
    factor = growth_polynomial(integrator)
    crossings = np.concatenate([(factor - 1.0).roots(), (factor + 1.0).roots()])
    real = -crossings.real[np.abs(crossings.imag) <= REAL_LIMIT]
    return float(real[real > REAL_LIMIT].min())


def sampled_roots(integrator: str, feedback: Feedback, dt: float) -> Complex:
    """The roots of the sampled error loop: R(rate dt) for each rate of a feedback.

    Raises TypeError: not a feedback. Raises ValueError: unknown integrator; a step that is not
    positive; a feedback that does not go with them.

    Parameters
    ----------
    integrator : str
    feedback : of so.feedback
    dt : float
        s.

    Returns
    -------
    (n,) complex array
        Inside the unit circle the loop is stable. As the gain grows they draw the root locus.
    """
    step = positive(dt, "dt")
    choice(integrator, "integrator", I.NAMES)
    given: Any = feedback
    if isinstance(given, type) or not isinstance(given, Feedback):
        raise StandoffTypeError(
            f"feedback is {shown(feedback)}: give one of so.feedback.", "feedback", feedback
        )
    rates = np.asarray(feedback.resolved(integrator, step).rates(), dtype=np.complex128)
    return np.atleast_1d(np.asarray(growth_factor(integrator, rates * step), dtype=np.complex128))


def steady_error(integrator: str, gain: float, dt: float, acceleration: float) -> float:
    """The steady error with the feedforward while the minimum moves with an acceleration.

    With q*(t) = a t²/2 the law integrates q' = -K (q - q*) + q*'. A step from q = q* = 0 ends at
    an error c a h² and multiplies an error before it by R: the two balance at c a h² / (1 - R).

    Raises ValueError: unknown integrator; a gain that is not stable; numbers that are not positive.

    Parameters
    ----------
    integrator : str
    gain : float
        K, 1/s; below ``so.max_gain(integrator, dt)``.
    dt : float
        s.
    acceleration : float
        |q*''|, length/s² (or parameter/s²; the error has the same unit times s²).

    Returns
    -------
    float
        h a / (2 K) for Euler, h² a / (4 (1 - K h/2)) for Heun.
    """
    gain, dt = positive(gain, "gain"), positive(dt, "dt")
    z, number = gain * dt, I.NAMES.index(choice(integrator, "integrator", I.NAMES))
    if z >= stability_limit(integrator):
        raise StandoffError(
            f"gain = {gain} is not stable for {integrator} at dt = {dt}: there is no steady error.",
            "gain",
            gain,
        )
    rate, moved = 0.0, 0.0
    for i in range(int(I.STAGES[number])):
        c = float(I.NODES[number, i])
        # in units of a h: the rate -K (q - q*) + q*' at the stage c h, where q is c h k
        rate = -z * (c * rate - 0.5 * c * c) + c
        moved += float(I.WEIGHTS[number, i]) * rate
    left = moved - 0.5
    settled = 1.0 - float(growth_factor(integrator, -z))
    return abs(left / settled) * dt * dt * not_negative(acceleration, "acceleration")


def euler_min_gain(error: float, acceleration: float, dt: float) -> float:
    """The least gain of Euler with the feedforward that keeps the steady error: h a / (2 error).

    The other integrators' steady error of h² a / 4 or less cannot be reduced with gain: take a
    shorter step.

    Raises ValueError: an error or a step that is not positive, a negative acceleration.

    Parameters
    ----------
    error : float
        Length.
    acceleration : float
        Greatest acceleration of the witness point on its body, length/s².
    dt : float
        s.

    Returns
    -------
    float
        K, 1/s; inf where Euler would not be stable with it (2/dt and above).
    """
    dt = positive(dt, "dt")
    gain = dt * not_negative(acceleration, "acceleration") / (2.0 * positive(error, "error"))
    return gain if gain * dt < stability_limit("euler") else math.inf
