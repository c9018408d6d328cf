"""Which Python values are real numbers: for `standoff.geometry` and `standoff.motion` alike."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.errors import MaskedNumbers, StandoffError, StandoffTypeError

SHOWN_CHARACTERS = 200
"""Longest piece of an offending value that a message repeats, in characters."""


DEEPEST = 8
"""Most dimensions of an array that is read. NumPy itself stops walking at 32 and at 64."""


def shown(value: Any, characters: int = SHOWN_CHARACTERS) -> str:
    """Return `value` as a message repeats it: its repr, cut short."""
    try:
        text = repr(value)
    except RecursionError:
        return f"a {type(value).__name__} nested too deeply to be shown"
    except ValueError:
        # Python writes no whole number of more than some thousand decimal digits.
        if not isinstance(value, int):
            return f"a {type(value).__name__} with a number too long to be shown"
        text = hex(value)
    return text if len(text) <= characters else text[: characters - 1] + "…"


def check_unmasked(value: Any) -> None:
    """Refuse masked numbers, in an array or in lists of arrays: NumPy's own conversions drop the
    mask and take what lies beneath for data.

    Raises
    ------
    MaskedNumbers
    """
    waiting, seen = [value], set[int]()
    while waiting:
        given = waiting.pop()
        if isinstance(given, np.ma.MaskedArray) and np.ma.is_masked(given):
            raise MaskedNumbers("has masked numbers; fill them, or leave them out")
        if isinstance(given, np.ndarray) and given.dtype.kind == "O":
            given = given.ravel().tolist()
        if isinstance(given, list | tuple) and id(given) not in seen:
            seen.add(id(given))  # a list may hold itself
            waiting += [item for item in given if isinstance(item, list | tuple | np.ndarray)]


def shape_of(value: Any) -> tuple[int, ...] | None:
    """Return the shape of what may be an array; None where its rows differ in length."""
    if isinstance(value, np.ndarray):
        return tuple(value.shape)
    try:
        # As objects, so that no element is read as a number, which a masked one would warn of.
        objects = np.array(value, dtype=object)
    except (ValueError, RecursionError):
        return None
    if objects.ndim > DEEPEST:
        return None
    ragged = any(isinstance(item, list | tuple | np.ndarray) for item in objects.flat)
    return None if ragged else tuple(objects.shape)


def real_array(value: Any) -> NDArray[np.float64]:
    """Return a new float64 array of real numbers.

    NumPy itself would read text and truth values as numbers, None as NaN, and drop an imaginary
    part with no more than a warning.

    Raises
    ------
    MaskedNumbers
        Some of them are masked.
    TypeError
        Something in it is not a real number.
    ValueError
        Its rows differ in length, or it is nested too deeply.
    """
    check_unmasked(value)
    given = value if isinstance(value, np.ndarray) else np.array(value, dtype=object)
    if given.dtype.kind not in "iufO":
        raise StandoffTypeError(f"numbers of the kind {given.dtype}")
    if given.ndim > DEEPEST:
        raise StandoffError(f"lists in lists, more than {DEEPEST} deep")
    if given.dtype.kind == "O":
        for item in given.flat:
            if isinstance(item, bool | np.bool_ | str | bytes) or item is None:
                raise StandoffTypeError(f"{shown(item)} is not a number")
    try:
        return np.array(given, dtype=np.float64)
    except OverflowError as error:
        raise StandoffError(f"a number beyond float64: {error}") from error
