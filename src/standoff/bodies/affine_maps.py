"""Affine maps of bodies: read, checked, and what they do to a swept radius."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from standoff.bodies.tolerances import SIMILARITY_TOLERANCE, SINGULAR_MAP
from standoff.checks.arrays import finite
from standoff.checks.real_numbers import shape_of
from standoff.errors import StandoffError
from standoff.geometry.validation import matrix3, vector3
from standoff.typing import Array


class AffineMap(NamedTuple):
    """x -> linear x + shift.

    Attributes
    ----------
    linear : (3, 3) array
    shift : (3,) array
    stretch : float
        The greatest factor by which it makes a length longer.
    flip : int
        -1 for a mirror, else 1.
    """

    linear: Array
    shift: Array
    stretch: float
    flip: int


def affine_map(given: Any, radius: float, dimension: int) -> AffineMap:
    """An affine map for a body with a swept radius (length) and a dimension.

    Raises StandoffError: no map, a singular one, one that is no similarity for a radius, or that
    takes a planar body out of its plane.
    """
    try:
        linear, shift = _read(given)
    except StandoffError as error:
        raise StandoffError(str(error), "affine", given) from error
    stretch = np.linalg.svd(linear, compute_uv=False)
    if stretch[2] <= SINGULAR_MAP * stretch[0]:
        raise StandoffError(
            f"The affine map is singular (singular values {stretch}).", "affine", given
        )
    if radius > 0.0 and stretch[0] - stretch[2] > SIMILARITY_TOLERANCE * stretch[0]:
        raise StandoffError(
            f"A body with radius {radius} would not keep a round skin under this map "
            f"(singular values {stretch}): use so.shapes.ellipsoid or a body of patches.",
            "affine",
            given,
        )
    if dimension == 2 and (np.abs(linear[2, :2]).max() > 0.0 or shift[2] != 0.0):
        raise StandoffError("The map takes a planar body out of z = 0.", "affine", given)
    return AffineMap(linear, shift, float(stretch[0]), 1 if np.linalg.det(linear) > 0.0 else -1)


def _read(value: Any) -> tuple[Array, Array]:
    if isinstance(value, tuple) and len(value) == 2:
        return matrix3(value[0], "affine map"), vector3(value[1], "affine shift")
    if shape_of(value) == (4, 4):
        array = finite(value, "affine map", (4, 4))
        if not np.array_equal(array[3], [0.0, 0.0, 0.0, 1.0]):
            raise StandoffError(
                f"The affine map's last row is {array[3]}; it must be 0 0 0 1.", "affine", value
            )
        return array[:3, :3], array[:3, 3]
    return matrix3(value, "affine map"), np.zeros(3)
