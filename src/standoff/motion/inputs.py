"""Reading a caller's numbers: right shape, finite, or an error that names value and fix."""

from __future__ import annotations

import math
from typing import SupportsFloat

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff.real_numbers import MaskedNumbers, check_unmasked, real_array, shown

FloatArray = NDArray[np.float64]

GREATEST = 1e100
"""Greatest component of a vector or matrix, in any unit: its square stays in float64."""


LONGEST = 400
"""Longest array that a message repeats, in characters: a matrix of 4 by 4 with all its digits."""


def text(value: ArrayLike) -> str:
    """Write an array on one line, short enough for an error message."""
    try:
        given = np.asarray(value)
        written = " ".join(np.array2string(given, precision=6, threshold=20, edgeitems=3).split())
    except (ValueError, RecursionError):  # too deep a list, or too long a whole number
        return shown(value)
    return written if len(written) <= LONGEST else written[: LONGEST - 1] + "…"


def array(
    value: ArrayLike, name: str, shape: tuple[int, ...], most: float = GREATEST
) -> FloatArray:
    """Copy `value` to a read-only float64 array of the given shape, no component beyond `most`."""
    try:
        copied = real_array(value)
    except MaskedNumbers as error:
        raise ValueError(f"{name} {error}: {shown(value)}") from error
    except (TypeError, ValueError) as error:
        raise ValueError(
            f"{name} is {shown(value)}: give {_numbers(shape)}, all of them real"
        ) from error
    if copied.shape != shape:
        raise ValueError(
            f"{name} has shape {copied.shape}, value {text(copied)}: give {_numbers(shape)}"
        )
    if not np.isfinite(copied).all():
        raise ValueError(f"{name} is {text(copied)}: every component must be finite")
    if copied.size and np.abs(copied).max() > most:
        raise ValueError(f"{name} is {text(copied)}: no component may be beyond {most:g}")
    copied.setflags(write=False)
    return copied


def unmasked(value: object, name: str) -> None:
    """Refuse masked numbers, before a conversion of NumPy's takes what lies beneath for data."""
    try:
        check_unmasked(value)
    except MaskedNumbers as error:
        raise ValueError(f"{name} {error}: {shown(value)}") from error


def number(value: SupportsFloat, name: str) -> float:
    """Read one finite number."""
    try:
        if isinstance(value, bool | np.bool_ | str | bytes | np.ma.MaskedArray):
            raise TypeError("no number")
        read = float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"{name} is {shown(value)}: give one real number") from error
    if not math.isfinite(read):
        raise ValueError(f"{name} is {read}: give a finite number")
    return read


def word(value: object, name: str, known: tuple[str, ...]) -> None:
    """Refuse everything but the words of `known`; an array would only be compared by element."""
    if not isinstance(value, str) or value not in known:
        choices = " or ".join(f'"{choice}"' for choice in known)
        raise ValueError(f"{name} is {shown(value)}: give {choices}")


def direction(value: ArrayLike, name: str) -> FloatArray:
    """Read a vector of any length but zero; the unit vector along it is returned, read-only."""
    vector = array(value, name, (3,), most=math.inf)
    # Scaled first: the square of a very short or long vector would underflow or overflow.
    largest = np.abs(vector).max()
    if largest == 0.0:
        raise ValueError(f"{name} is {text(vector)}: a direction needs a length above zero")
    unit: FloatArray = vector / largest
    unit /= np.linalg.norm(unit)
    unit.setflags(write=False)
    return unit


def _numbers(shape: tuple[int, ...]) -> str:
    if len(shape) == 1:
        return f"{shape[0]} numbers"
    return f"an array of {' by '.join(map(str, shape))} numbers"
