"""Domains of surfaces: the ranges of their parameters."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.checks.real_numbers import real_array, shape_of, shown
from standoff.errors import StandoffError
from standoff.geometry.validation import Array

Domain = tuple[float, float, float, float]
UNBOUNDED: Domain = (-np.inf, np.inf, -np.inf, np.inf)


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
