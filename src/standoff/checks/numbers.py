"""One number that a user gives: its kind, size and sign."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from standoff.checks.real_numbers import NOT_REAL, check_readable, shown
from standoff.errors import StandoffError, UnreadableNumbers

GREATEST = 1e50
"""Greatest size of a number that is read, in whatever unit: sixth powers of lengths (a squared
volume) and squares of squared distances stay in float64."""

LEAST = 1e-50
"""Least of a magnitude that is not zero, in whatever unit: sixth powers do not underflow."""


def number(value: Any, name: str) -> float:
    """Read one real number, not beyond `GREATEST`.

    Raises StandoffError: strings, truth values, complex numbers, arrays, masked numbers, NaN and
    infinity.
    """
    read = _real(value, name)
    if not math.isfinite(read):
        raise StandoffError(f"{name} = {read}: must be finite.", name, value)
    if abs(read) > GREATEST:
        raise StandoffError(
            f"{name} = {read}: beyond {GREATEST:g}; choose a larger unit.", name, value
        )
    return read


def positive(value: Any, name: str, *, infinite: bool = False) -> float:
    """Read a number above zero; infinity too where that means something."""
    read = math.inf if infinite and _endless(value) else number(value, name)
    if read <= 0.0:
        raise StandoffError(f"{name} = {read}: must be positive.", name, value)
    return read


def not_negative(value: Any, name: str) -> float:
    """Read a number that is zero or above."""
    read = number(value, name)
    if read < 0.0:
        raise StandoffError(f"{name} = {read}: must be zero or positive.", name, value)
    return read


def magnitude(value: Any, name: str) -> float:
    """Read a number above zero whose powers are taken, such as a length, not below `LEAST`."""
    read = positive(value, name)
    if read < LEAST:
        raise StandoffError(
            f"{name} = {read}: below {LEAST:g}; choose a smaller unit.", name, value
        )
    return read


def magnitude_or_zero(value: Any, name: str) -> float:
    """Read a number that is zero, or a `magnitude`."""
    read = not_negative(value, name)
    if 0.0 < read < LEAST:
        raise StandoffError(
            f"{name} = {read}: below {LEAST:g}; choose a smaller unit, or give 0.", name, value
        )
    return read


def whole_number(value: Any, name: str, least: int = 1, most: int | None = None) -> int:
    """Read a whole number from `least` to `most`; strings, True and 2.0 are not."""
    if not is_whole(value) or value < least or (most is not None and value > most):
        asked = f"of at least {least}" if most is None else f"from {least} to {most}"
        raise StandoffError(
            f"{name} = {shown(value)}: must be a whole number {asked}.", name, value
        )
    return int(value)


def is_whole(value: Any) -> bool:
    """Is it a whole number? NumPy counts a duration as one, Python a truth value."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool | np.timedelta64)


def yes_or_no(value: Any, name: str) -> bool:
    """Read True or False; 0, 1 and text are neither."""
    if not isinstance(value, bool | np.bool_):
        raise StandoffError(f"{name} = {shown(value)}: must be True or False.", name, value)
    return bool(value)


def _endless(value: Any) -> bool:
    return isinstance(value, float) and value == math.inf


def _real(value: Any, name: str) -> float:
    if type(value) is float:
        return value
    try:
        check_readable(value)
        array = isinstance(value, np.ndarray) and (value.ndim or value.dtype.kind not in "iufO")
        if array or isinstance(value, NOT_REAL):
            raise TypeError("no number")
        return float(value)
    except UnreadableNumbers as error:
        raise StandoffError(f"{name} {error}: {shown(value)}", name, value) from error
    except (TypeError, ValueError, OverflowError) as error:
        raise StandoffError(f"{name} = {shown(value)} is not a number.", name, value) from error
