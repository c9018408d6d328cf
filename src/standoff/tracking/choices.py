"""Names and numbers that a user gives as options, checked."""

from __future__ import annotations

import difflib
import math
from typing import Any

import numpy as np

from standoff.kernels import frame as K
from standoff.kernels import integrators as I
from standoff.real_numbers import shown

LAWS = {"predictor-corrector": K.LAW_PC, "paper": K.LAW_PAPER}
PREDICTORS = {
    "none": K.PREDICT_NONE,
    "secant": K.PREDICT_SECANT,
    "feedforward": K.PREDICT_FEEDFORWARD,
    "feedforward-2": K.PREDICT_FEEDFORWARD_2,
}
INTEGRATORS = {name: k for k, name in enumerate(I.NAMES)}
REALISATIONS = {"evaluated": K.EVALUATED, "integrated": K.INTEGRATED}
SATURATIONS = {"hold": K.SATURATE_HOLD, "zero": K.SATURATE_ZERO}
SWITCHINGS = {
    "multipliers": K.SWITCH_MULTIPLIERS,
    "voronoi": K.SWITCH_VORONOI,
    "none": K.SWITCH_NONE,
}
DEPTHS = {"global": K.DEPTH_GLOBAL, "local": K.DEPTH_LOCAL}
SOLVES = {"ranked": K.SOLVE_RANKED, "plain": K.SOLVE_PLAIN}


def choice(value: Any, name: str, table: dict[str, int]) -> int:
    """The number of a named option; the error lists the names and the nearest one."""
    if isinstance(value, str) and value in table:
        return table[value]
    near = difflib.get_close_matches(value, list(table), 1) if isinstance(value, str) else ()
    hint = f" Did you mean {near[0]!r}?" if near else ""
    raise ValueError(f"Unknown {name} {shown(value)}: choose one of {sorted(table)}.{hint}")


def positive_number(value: Any, name: str, allow_infinite: bool = False) -> float:
    try:
        # float() reads "5" and True, but neither was meant as a number, and a masked one as NaN
        if isinstance(value, (str, bytes, bool, np.bool_, np.ma.MaskedArray)):
            raise TypeError("no number")
        number = float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"{name} = {shown(value)} is not a number.") from error
    if not number > 0.0 or (math.isinf(number) and not allow_infinite):
        raise ValueError(f"{name} = {number}: must be positive and finite.")
    return number


def whole_number(value: Any, name: str) -> int:
    """A positive whole number; text, True and fractions are none."""
    whole = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not whole or value < 1:
        raise ValueError(f"{name} = {shown(value)}: must be a whole number of at least 1.")
    return int(value)
