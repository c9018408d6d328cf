"""Matrices that should be rotations: how far off they are, and the nearest rotations.

All functions take stacks of matrices, shape (..., 3, 3), as well as one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from standoff.checks.arrays import text
from standoff.errors import StandoffError
from standoff.motion.tolerances import FLAT, ORTHONORMALITY, ROUNDED
from standoff.typing import Array

_STEPS = 2
"""Each squares the defect and multiplies it by three eighths: 1e-5, 4e-11, below rounding."""


def _entries(matrices: Array) -> Sequence[Any]:
    """The nine entries, row by row: numbers of one matrix, arrays of a stack.

    NumPy multiplies small matrices one by one; sums of products of their entries take a tenth of
    the time, in stacks and in plain numbers.
    """
    nine = matrices.reshape(-1, 9)
    return nine[0].tolist() if matrices.ndim == 2 else list(nine.T.copy())


def _excess(entries: Sequence[Any]) -> tuple[Any, ...]:
    """The components of ``RᵀR − I``: 00, 11, 22, 01, 02, 12."""
    a, b, c, d, e, f, g, h, i = entries
    return (
        a * a + d * d + g * g - 1.0,
        b * b + e * e + h * h - 1.0,
        c * c + f * f + i * i - 1.0,
        a * b + d * e + g * h,
        a * c + d * f + g * i,
        b * c + e * f + h * i,
    )


def defect(matrices: Array) -> Array:
    """Return the greatest component of ``RᵀR − I`` of each matrix, shape (...)."""
    greatest: Array = np.abs(_excess(_entries(matrices))).max(axis=0)
    return greatest.reshape(matrices.shape[:-2])


def mirrored(matrices: Array) -> Any:
    """Tell of each matrix whether its determinant is below 0, shape (...)."""
    a, b, c, d, e, f, g, h, i = _entries(matrices)
    return a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g) < 0.0


def without_rounding(matrices: Array) -> Array:
    """Return the rotations nearest to matrices with a defect of `ROUNDED` or less.

    By steps of Newton and Schulz, X ← X − X (XᵀX − 1)/2, which end at the same orthogonal factor
    as the singular value decomposition of `nearest_rotation`, in a tenth of its time.
    """
    entries = _entries(matrices)
    for _ in range(_STEPS):
        xx, yy, zz, xy, xz, yz = (0.5 * component for component in _excess(entries))
        rows = (entries[0:3], entries[3:6], entries[6:9])
        entries = [
            entry
            for x, y, z in rows
            for entry in (
                x - (x * xx + y * xy + z * xz),
                y - (x * xy + y * yy + z * yz),
                z - (x * xz + y * yz + z * zz),
            )
        ]
    return np.array(entries).T.reshape(matrices.shape)


def as_rotation(matrix: Array) -> tuple[Array, bool]:
    """Return the rotation that a matrix is, or was before it was rounded, and whether it was
    rounded.

    One that is orthonormal to `ORTHONORMALITY` is returned as it is.

    Raises ValueError if it is off by more than `ROUNDED`, or mirrored.
    """
    off = float(defect(matrix))
    if off > ROUNDED:
        raise StandoffError(
            f"rotation {text(matrix)} is not orthonormal: RᵀR differs from the identity by "
            f"{off:.3g}, and only what rounding leaves, {ROUNDED:g}, is repaired; a scale or shear "
            "belongs to the body (Body.transformed), and Pose.nearest makes a pose of the nearest "
            "rotation",
            "rotation",
            matrix,
        )
    if mirrored(matrix):
        raise StandoffError(
            f"rotation {text(matrix)} is mirrored: its determinant is −1; "
            "mirror the body instead (Body.transformed), or flip one axis",
            "rotation",
            matrix,
        )
    return (without_rounding(matrix), True) if off > ORTHONORMALITY else (matrix, False)


def nearest_rotation(matrix: Array) -> tuple[Array, bool]:
    """Return the rotation nearest to any one matrix, in the sum of squares, and whether it differs.

    Raises ValueError if the matrix is flat or mirrored.
    """
    if defect(matrix) <= ORTHONORMALITY:
        return as_rotation(matrix)
    left, stretches, right = np.linalg.svd(matrix)
    if stretches[2] <= FLAT * stretches[0]:
        raise StandoffError(
            f"rotation {text(matrix)} is flat: it stretches by {text(stretches)} along its "
            "principal axes, so that a rotation and its mirror image are about as near; give a "
            "matrix with three independent columns",
            "rotation",
            matrix,
        )
    nearest: Array = left @ right
    if mirrored(nearest):
        raise StandoffError(
            f"rotation {text(matrix)} is mirrored: its determinant is below 0, and no rotation is "
            "close to it; mirror the body instead (Body.transformed), or flip one axis",
            "rotation",
            matrix,
        )
    return nearest, True
