"""Arrays of numbers that a user gives: their kind, shape and size, and whether they are finite."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from standoff.checks.numbers import GREATEST
from standoff.checks.real_numbers import check_readable, real_array, shown
from standoff.errors import StandoffError, UnreadableNumbers
from standoff.typing import Array

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


def finite(value: Any, name: str, shape: tuple[int, ...] | None) -> Array:
    """Copy `value` to a read-only float64 array of the given shape (-1 matches any length; None:
    of any).

    Raises StandoffError: not numeric (strings and truth values are not), masked, of another shape,
    with a NaN, an infinite number, or one beyond `GREATEST`.
    """
    copied = numbers(value, name, shape)
    if not np.isfinite(copied).all():
        raise StandoffError(
            f"{name} has a NaN or infinite number: {text(copied)}; give finite ones.", name, value
        )
    if copied.size and np.abs(copied).max() > GREATEST:
        raise StandoffError(
            f"{name} has a number beyond {GREATEST:g}: {text(copied)}; choose a larger unit.",
            name,
            value,
        )
    copied.setflags(write=False)
    return copied


def finite_rows(value: Any, name: str, columns: int) -> Array:
    """`finite` of many rows of numbers, such as points: the message names the first wrong row."""
    copied = numbers(value, name, (-1, columns))
    wrong = ~(np.abs(copied) <= GREATEST).all(axis=1)
    if wrong.any():
        row = int(wrong.argmax())
        if np.isfinite(copied[row]).all():
            problem, fix = f"a number beyond {GREATEST:g}", "choose a larger unit"
        else:
            problem, fix = "a NaN or infinite number", "give finite ones"
        raise StandoffError(f"{name}[{row}] has {problem}: {copied[row]}; {fix}.", name, value)
    copied.setflags(write=False)
    return copied


def numbers(value: Any, name: str, shape: tuple[int, ...] | None) -> Array:
    """Copy `value` to a float64 array of the given shape (None: of any), whose numbers may be of
    any size."""
    try:
        copied = real_array(value)
    except UnreadableNumbers as error:
        raise StandoffError(f"{name} {error}: {shown(value)}", name, value) from error
    except (TypeError, ValueError) as error:
        raise StandoffError(
            f"{name} is not numeric: {shown(value)}; give {_asked(shape)}, all of them real.",
            name,
            value,
        ) from error
    if shape is not None and not _fits(copied.shape, shape):
        raise StandoffError(f"{name} has shape {copied.shape}: give {_asked(shape)}.", name, value)
    return copied


def unmasked(value: object, name: str) -> None:
    """Refuse masked numbers, before one of NumPy's conversions reads what lies beneath as data."""
    try:
        check_readable(value)
    except UnreadableNumbers as error:
        raise StandoffError(f"{name} {error}: {shown(value)}", name, value) from error


def direction(value: Any, name: str) -> Array:
    """Read a vector of any length but zero; the unit vector along it is returned, read-only."""
    vector = numbers(value, name, (3,))
    # Scaled first: the square of a very short or long vector would underflow or overflow.
    largest = np.abs(vector).max()
    if not 0.0 < largest < np.inf:
        raise StandoffError(
            f"{name} is {text(vector)}: a direction needs a finite length above zero", name, value
        )
    unit: Array = vector / largest
    unit /= np.linalg.norm(unit)
    unit.setflags(write=False)
    return unit


def _fits(have: tuple[int, ...], want: tuple[int, ...]) -> bool:
    return len(have) == len(want) and all(
        asked in (-1, found) for asked, found in zip(want, have, strict=True)
    )


def _asked(shape: tuple[int, ...] | None) -> str:
    if shape is None:
        return "an array of numbers"
    sides = ["n" if length == -1 else str(length) for length in shape]
    if len(shape) == 1:
        return f"{sides[0]} numbers"
    return f"an array of {' by '.join(sides)} numbers" if shape else "one number"
