"""Checks of vectors, maps and weights of shapes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.checks.arrays import finite
from standoff.errors import StandoffError

Array = NDArray[np.float64]

WEIGHT_RATIO = 1e12
"""Greatest ratio of weights. The tangent at an end of least weight is this many times the curve's
size, and products of two such tangents still have correct digits."""


def vector3(value: Any, name: str) -> Array:
    return finite(value, name, (3,))


def matrix3(value: Any, name: str) -> Array:
    return finite(value, name, (3, 3))


def affine_map(linear: Any, shift: Any) -> tuple[Array, Array]:
    """(linear, shift) of x -> linear x + shift, checked."""
    return matrix3(linear, "linear"), vector3(shift, "shift")


def check_alike(weights: Array) -> None:
    """Raise ValueError if positive weights differ by more than `WEIGHT_RATIO`."""
    least, most = float(weights.min()), float(weights.max())
    if most > WEIGHT_RATIO * least:
        raise StandoffError(
            f"weights from {least:g} to {most:g}: points of small weight are lost in roundoff; "
            f"give weights within a factor of {WEIGHT_RATIO:g}.",
            "weights",
            weights,
        )
