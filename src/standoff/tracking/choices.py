"""Names and numbers that a user gives as options, checked."""

from __future__ import annotations

import difflib
import math
from typing import Any

import numpy as np

from standoff.errors import StandoffError
from standoff.kernels.paper import integrators as I
from standoff.real_numbers import shown

INTEGRATORS = {name: k for k, name in enumerate(I.NAMES)}


def choice(value: Any, name: str, table: dict[str, int]) -> int:
    """The number of a named option; the error lists the names and the nearest one."""
    if isinstance(value, str) and value in table:
        return table[value]
    near = difflib.get_close_matches(value, list(table), 1) if isinstance(value, str) else ()
    hint = f" Did you mean {near[0]!r}?" if near else ""
    raise StandoffError(
        f"Unknown {name} {shown(value)}: choose one of {sorted(table)}.{hint}", name, value
    )


def positive_number(value: Any, name: str, allow_infinite: bool = False) -> float:
    try:
        # float() reads "5" and True, but neither was meant as a number, and a masked one as NaN
        if isinstance(value, (str, bytes, bool, np.bool_, np.ma.MaskedArray)):
            raise TypeError("no number")
        number = float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise StandoffError(f"{name} = {shown(value)} is not a number.", name, value) from error
    if not number > 0.0 or (math.isinf(number) and not allow_infinite):
        raise StandoffError(f"{name} = {number}: must be positive and finite.", name, value)
    return number


def whole_number(value: Any, name: str) -> int:
    """A positive whole number; text, True and fractions are none."""
    whole = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not whole or value < 1:
        raise StandoffError(
            f"{name} = {shown(value)}: must be a whole number of at least 1.", name, value
        )
    return int(value)


def yes_or_no(value: Any, name: str) -> bool:
    """True or False; 0, 1 and text are neither."""
    if not isinstance(value, (bool, np.bool_)):
        raise StandoffError(f"{name} = {shown(value)}: must be True or False.", name, value)
    return bool(value)
