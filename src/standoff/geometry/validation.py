"""Checks of vectors, maps, weights and domains of shapes."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.checks.arrays import finite
from standoff.checks.real_numbers import real_array, shape_of, shown
from standoff.errors import StandoffError
from standoff.typing import Array

Domain = tuple[float, float, float, float]
"""Of a surface: the ranges (u0, u1, v0, v1) of its parameters."""

UNBOUNDED: Domain = (-np.inf, np.inf, -np.inf, np.inf)

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


def checked_domain(domain: Any, name: str) -> Domain:
    """(u0, u1, v0, v1) as floats; raises ValueError if it is empty or not numeric."""
    if shape_of(domain) != (4,):
        raise StandoffError(
            f"{name}.domain = {shown(domain)}: give (u0, u1, v0, v1).", "domain", domain
        )
    try:
        u0, u1, v0, v1 = (float(x) for x in real_array(domain))
    except (TypeError, ValueError) as error:
        raise StandoffError(
            f"{name}.domain = {shown(domain)} is not numeric: {error}.", "domain", domain
        ) from error
    if not (u0 < u1 and v0 < v1):
        raise StandoffError(
            f"{name}.domain = {(u0, u1, v0, v1)} is empty: give u0 < u1, v0 < v1.",
            "domain",
            domain,
        )
    return u0, u1, v0, v1


def inside(values: Array, low: float, high: float) -> Array:
    """The values strictly between two ends."""
    return values[(low < values) & (values < high)]
