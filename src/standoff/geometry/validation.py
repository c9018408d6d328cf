"""Checks of numbers that come from outside: kind, shape, finiteness, range, sign."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.errors import MaskedNumbers, StandoffError
from standoff.real_numbers import real_array, shown

Array = NDArray[np.float64]

GREATEST = 1e50
LEAST = 1e-50
"""Range of lengths, in whatever unit. Sixth powers of both, a squared volume, stay in float64."""
WEIGHT_RATIO = 1e12
"""Greatest ratio of weights. A tangent at the lightest end is so many times the curve's size, and
products of two such still have digits."""


def finite(value: Any, name: str, shape: tuple[int, ...]) -> Array:
    """`value` as a read-only float64 array of the given shape (-1 matches any length).

    Raises
    ------
    ValueError
        Not numeric (text and truth values are not), masked, of another shape, with a NaN, an
        infinite number, or one beyond `GREATEST`.
    """
    try:
        array = real_array(value)
    except MaskedNumbers as error:
        raise StandoffError(f"{name} {error}: {shown(value)}", name, value) from error
    except (TypeError, ValueError) as error:
        raise StandoffError(f"{name} is not numeric: {shown(value)}", name, value) from error
    fits = array.ndim == len(shape) and all(
        want in (-1, have) for want, have in zip(shape, array.shape, strict=True)
    )
    if not fits:
        wanted = tuple("n" if want == -1 else want for want in shape)
        raise StandoffError(f"{name} has shape {array.shape}; give shape {wanted}.", name, value)
    if not np.isfinite(array).all():
        raise StandoffError(f"{name} has a NaN or infinite number: {shown(value)}", name, value)
    if array.size and np.abs(array).max() > GREATEST:
        raise StandoffError(
            f"{name} has a number beyond {GREATEST:g}: {shown(value)}; choose a larger unit.",
            name,
            value,
        )
    array.flags.writeable = False
    return array


def vector3(value: Any, name: str) -> Array:
    return finite(value, name, (3,))


def matrix3(value: Any, name: str) -> Array:
    return finite(value, name, (3, 3))


def affine_map(linear: Any, shift: Any) -> tuple[Array, Array]:
    """(linear, shift) of x -> linear x + shift, checked."""
    return matrix3(linear, "linear"), vector3(shift, "shift")


def positive(value: Any, name: str) -> float:
    """A finite number above zero, not below `LEAST`."""
    number = float(finite(value, name, ()))
    if number <= 0.0:
        raise StandoffError(f"{name} = {number}: must be positive.", name, value)
    if number < LEAST:
        raise StandoffError(
            f"{name} = {number}: below {LEAST:g}; choose a smaller unit.", name, value
        )
    return number


def not_negative(value: Any, name: str) -> float:
    """A finite number, zero or above, not between zero and `LEAST`."""
    number = float(finite(value, name, ()))
    if number < 0.0:
        raise StandoffError(f"{name} = {number}: must be zero or positive.", name, value)
    if 0.0 < number < LEAST:
        raise StandoffError(
            f"{name} = {number}: below {LEAST:g}; choose a smaller unit, or give 0.", name, value
        )
    return number


def check_alike(weights: Array) -> None:
    """Raise ValueError where positive weights differ by more than `WEIGHT_RATIO`."""
    least, most = float(weights.min()), float(weights.max())
    if most > WEIGHT_RATIO * least:
        raise StandoffError(
            f"weights from {least:g} to {most:g}: the lighter points are lost in roundoff; give "
            f"weights within a factor of {WEIGHT_RATIO:g}.",
            "weights",
            weights,
        )
