"""Reading a caller's numbers: right shape, finite, or an error that names value and fix."""

from __future__ import annotations

import math
from typing import SupportsFloat

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]


def text(value: ArrayLike) -> str:
    """Write an array on one line, short enough for an error message."""
    shown = np.array2string(np.asarray(value), precision=6, threshold=20, edgeitems=3)
    return " ".join(shown.split())


def array(value: ArrayLike, name: str, shape: tuple[int, ...]) -> FloatArray:
    """Copy `value` to a read-only float64 array of the given shape with finite components."""
    try:
        given = np.asarray(value)
        # NumPy would drop an imaginary part with no more than a warning.
        if np.iscomplexobj(given):
            raise TypeError("complex numbers")
        copied = given.astype(np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(
            f"{name} is {value!r}: give {_numbers(shape)}, all of them real"
        ) from error
    if copied.shape != shape:
        raise ValueError(
            f"{name} has shape {copied.shape}, value {text(copied)}: give {_numbers(shape)}"
        )
    if not np.isfinite(copied).all():
        raise ValueError(f"{name} is {text(copied)}: every component must be finite")
    copied.setflags(write=False)
    return copied


def number(value: SupportsFloat, name: str) -> float:
    """Read one finite number."""
    try:
        read = float(value)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} is {value!r}: give one real number") from error
    if not math.isfinite(read):
        raise ValueError(f"{name} is {read}: give a finite number")
    return read


def direction(value: ArrayLike, name: str) -> FloatArray:
    """Read a vector of any length but zero; the unit vector along it is returned, read-only."""
    vector = array(value, name, (3,))
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
