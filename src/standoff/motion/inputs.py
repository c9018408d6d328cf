"""Reading a caller's numbers: right shape, finite, or an error that names value and fix."""

from __future__ import annotations

import math
from typing import SupportsFloat

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff.errors import MaskedNumbers, StandoffError, StandoffTypeError
from standoff.motion.tolerances import SHOWN_DIGITS
from standoff.real_numbers import check_unmasked, real_array, shown

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
    copied = numbers(value, name, shape)
    if not np.isfinite(copied).all():
        raise StandoffError(
            f"{name} is {text(copied)}: every component must be finite", name, value
        )
    if copied.size and np.abs(copied).max() > most:
        raise StandoffError(
            f"{name} is {text(copied)}: no component may be beyond {most:g}", name, value
        )
    copied.setflags(write=False)
    return copied


def numbers(value: ArrayLike, name: str, shape: tuple[int, ...] | None) -> FloatArray:
    """Copy `value` to a float64 array of the given shape (None: of any), whose components may be of
    any size."""
    try:
        copied = real_array(value)
    except MaskedNumbers as error:
        raise StandoffError(f"{name} {error}: {shown(value)}", name, value) from error
    except (TypeError, ValueError) as error:
        raise StandoffError(
            f"{name} is {shown(value)}: give {_numbers(shape)}, all of them real", name, value
        ) from error
    if shape is not None and copied.shape != shape:
        raise StandoffError(
            f"{name} has shape {copied.shape}, value {text(copied)}: give {_numbers(shape)}",
            name,
            value,
        )
    return copied


def unmasked(value: object, name: str) -> None:
    """Refuse masked numbers, before a conversion of NumPy's takes what lies beneath for data."""
    try:
        check_unmasked(value)
    except MaskedNumbers as error:
        raise StandoffError(f"{name} {error}: {shown(value)}", name, value) from error


def number(value: SupportsFloat, name: str) -> float:
    """Read one finite number."""
    try:
        if isinstance(value, bool | np.bool_ | str | bytes | np.ma.MaskedArray):
            raise StandoffTypeError("no number")
        read = float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise StandoffError(
            f"{name} is {shown(value)}: give one real number", name, value
        ) from error
    if not math.isfinite(read):
        raise StandoffError(f"{name} is {read}: give a finite number", name, value)
    return read


def word(value: object, name: str, known: tuple[str, ...]) -> None:
    """Refuse everything but the words of `known`; an array would only be compared by element."""
    if not isinstance(value, str) or value not in known:
        choices = " or ".join(f'"{choice}"' for choice in known)
        raise StandoffError(f"{name} is {shown(value)}: give {choices}", name, value)


def direction(value: ArrayLike, name: str) -> FloatArray:
    """Read a vector of any length but zero; the unit vector along it is returned, read-only."""
    vector = array(value, name, (3,), most=math.inf)
    # Scaled first: the square of a very short or long vector would underflow or overflow.
    largest = np.abs(vector).max()
    if largest == 0.0:
        raise StandoffError(
            f"{name} is {text(vector)}: a direction needs a length above zero", name, value
        )
    unit: FloatArray = vector / largest
    unit /= np.linalg.norm(unit)
    unit.setflags(write=False)
    return unit


def _numbers(shape: tuple[int, ...] | None) -> str:
    if shape is None:
        return "an array of numbers"
    if len(shape) == 1:
        return f"{shape[0]} numbers"
    return f"an array of {' by '.join(map(str, shape))} numbers"


def written(values: FloatArray, scale: float = 0.0) -> str:
    """Return numbers as a list with six digits each; what is roundoff beside the greatest of them,
    or beside `scale` in their unit, as 0."""
    size = max(scale, float(np.abs(values).max(initial=0.0)))
    return f"[{', '.join(f'{x:.6g}' if abs(x) > SHOWN_DIGITS * size else '0' for x in values)}]"
