"""The tracker's options: names, checks, and the numbers the kernels read."""

from __future__ import annotations

import difflib
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.kernels import frame as K
from standoff.kernels import integrators as I

LAWS = {"predictor-corrector": K.LAW_PC, "paper": K.LAW_PAPER}
PREDICTORS = {
    "none": K.PREDICT_NONE,
    "secant": K.PREDICT_SECANT,
    "feedforward": K.PREDICT_FEEDFORWARD,
    "feedforward-2": K.PREDICT_FEEDFORWARD_2,
}
INTEGRATORS = {name: k for k, name in enumerate(I.NAMES)}


def choice(value: Any, name: str, table: dict[str, int]) -> int:
    """The number of a named option; the error lists the names and the nearest one."""
    if value in table:
        return table[value]
    near = difflib.get_close_matches(str(value), list(table), 1)
    hint = f" Did you mean {near[0]!r}?" if near else ""
    raise ValueError(f"Unknown {name} {value!r}: choose one of {sorted(table)}.{hint}")


def positive_number(value: Any, name: str, allow_infinite: bool = False) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} = {value!r} is not a number.") from error
    if not number > 0.0 or (math.isinf(number) and not allow_infinite):
        raise ValueError(f"{name} = {number}: must be positive and finite.")
    return number


def max_gain(integrator: str, dt: float) -> float:
    """The largest stable gain of the paper's law, 1/s, for an integrator and a step in s.

    The errors obey dPsi/dt = -K Psi, so the limit is that of the integrator on the negative real
    axis: K dt < 2 for Euler, Heun and midpoint, 2.785 for RK4 (docs/laws.md).
    """
    number = choice(integrator, "integrator", INTEGRATORS)
    return I.STABILITY_LIMITS[number] / positive_number(dt, "dt")


def check_stable(integrator: str, gain: float, dt: float) -> None:
    """Raise ValueError where the paper's law would not be stable."""
    if gain >= max_gain(integrator, dt):
        raise ValueError(
            f"gain = {gain} is not stable for {integrator} at dt = {dt}: stay below "
            f"{max_gain(integrator, dt):.6g} (so.max_gain)."
        )


def pack_options(
    law: str, predictor: str, integrator: str, gain: float | None, dt: float, tolerance: float
) -> NDArray[np.float64]:
    """The array of options the kernels read. Default gain: K dt = 1, Euler's deadbeat."""
    dt = positive_number(dt, "dt")
    gain = 1.0 / dt if gain is None else positive_number(gain, "gain")
    options = np.zeros(K.N_OPTIONS)
    options[K.O_LAW] = choice(law, "law", LAWS)
    options[K.O_PREDICTOR] = choice(predictor, "predictor", PREDICTORS)
    options[K.O_INTEGRATOR] = choice(integrator, "integrator", INTEGRATORS)
    options[K.O_GAIN] = gain
    options[K.O_TOLERANCE] = positive_number(tolerance, "tolerance", allow_infinite=True)
    if law == "paper":
        check_stable(integrator, gain, dt)
    options.flags.writeable = False
    return options
