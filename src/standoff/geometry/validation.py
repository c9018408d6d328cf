"""Checks of numbers that come from outside: shape, finiteness, sign."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def finite(value: Any, name: str, shape: tuple[int, ...]) -> Array:
    """`value` as a read-only float64 array of the given shape (-1 matches any length).

    Raises
    ------
    ValueError
        Not numeric, of another shape, or with a NaN or an infinite number.
    """
    try:
        if value is None:
            raise TypeError
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} is not numeric: {value!r}") from error
    fits = array.ndim == len(shape) and all(
        want in (-1, have) for want, have in zip(shape, array.shape, strict=True)
    )
    if not fits:
        wanted = tuple("n" if want == -1 else want for want in shape)
        raise ValueError(f"{name} has shape {array.shape}; give shape {wanted}.")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} has a NaN or infinite number: {value!r}")
    array.flags.writeable = False
    return array


def vector3(value: Any, name: str) -> Array:
    return finite(value, name, (3,))


def matrix3(value: Any, name: str) -> Array:
    return finite(value, name, (3, 3))


def positive(value: Any, name: str) -> float:
    """A finite number above zero."""
    number = float(finite(value, name, ()))
    if number <= 0.0:
        raise ValueError(f"{name} = {number}: must be positive.")
    return number


def not_negative(value: Any, name: str) -> float:
    """A finite number, zero or above."""
    number = float(finite(value, name, ()))
    if number < 0.0:
        raise ValueError(f"{name} = {number}: must be zero or positive.")
    return number
