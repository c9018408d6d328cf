"""What is integrated over the boundary: by the divergence theorem, the moments of the interior.

For a function q homogeneous of degree k about a point, ∫ q dV = 1/(3 + k) ∮ q (x · n) dA. So all
moments have the same weight, x · n dA, which is positive on a convex body around the point: nothing
cancels. Added are ∮ n dA, which must be zero, and ∮ x nᵀ dA, which must be the volume times the
identity: otherwise the boundary is not closed, or not counted once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from standoff.typing import Array

FIRST = slice(0, 3)  # ∫ x dV
SECOND = slice(3, 9)  # ∫ x xᵀ dV: xx, yy, zz, xy, yz, zx
VECTOR_AREA = slice(9, 12)  # ∮ n dA
TENSOR = slice(12, 21)  # ∮ x nᵀ dA, by rows
VOLUME = 21
AREA = 22
COLUMNS = 23
ROWS, COLS = [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]


@dataclass(frozen=True, eq=False)
class IntegralFrame:
    """The frame and unit of the integrals: x -> (x - centre) / reach.

    Attributes
    ----------
    centre : (3,) array
        A point inside, body frame.
    reach : float
        No point of the body is farther from it, length.
    radius : float
        Of the ball swept over the core, length.
    """

    centre: Array
    reach: float
    radius: float


def flux(frame: IntegralFrame, points: Array, areas: Array) -> Array:
    """The integrand: points (..., 3) and outward area vectors (..., 3) there, body frame."""
    x, a = (points - frame.centre) / frame.reach, areas / frame.reach**2
    weight = (x * a).sum(axis=-1, keepdims=True)
    tensor = (x[..., :, None] * a[..., None, :]).reshape(*x.shape[:-1], 9)
    size = np.sqrt((a * a).sum(axis=-1, keepdims=True))
    second = x[..., ROWS] * x[..., COLS]
    return np.concatenate(
        [x * weight / 4.0, second * weight / 5.0, a, tensor, weight / 3.0, size], axis=-1
    )


def offset_areas(
    tangents: tuple[Array, Array], normal: Array, slopes: tuple[Array, Array], radius: float
) -> tuple[Array, Array]:
    """(unit normals, area vectors) of the surface moved out along its normals.

    Parameters
    ----------
    tangents : pair of (..., 3) arrays
        x_u and x_v.
    normal : (..., 3) array
        m, along the outward normal, of any length.
    slopes : pair of (..., 3) arrays
        m_u and m_v.
    radius : float
        How far out, length.

    Notes
    -----
    The area vector is (x + r n)_u × (x + r n)_v up to its sign, so (1 + r k1)(1 + r k2) n dA: the
    curvatures k1, k2 need not be known.
    """
    length = np.sqrt((normal * normal).sum(axis=-1, keepdims=True))
    n = normal / length
    moved = []
    for tangent, slope in zip(tangents, slopes, strict=True):
        along = (slope * n).sum(axis=-1, keepdims=True)
        moved.append(tangent + radius * (slope - along * n) / length)
    return n, np.cross(moved[0], moved[1])
