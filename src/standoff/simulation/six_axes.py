"""The arithmetic of a tick: pure functions of numbers and tuples, without arrays or objects.

A vector is a tuple of three floats, a rotation one of nine, row by row. They are written so that
Numba can compile them as they stand.
"""

from __future__ import annotations

from math import sqrt
from typing import Any

from standoff.kernels.algebra import rigid, vectors

Vector = tuple[float, ...]

# The kernels' own, uncompiled: a loop in Python need not wait for the compiler.
_log: Any = getattr(rigid.log_rotation, "py_func", rigid.log_rotation)
_exp: Any = getattr(rigid.exp_rotation, "py_func", rigid.exp_rotation)
_compose: Any = getattr(vectors.compose, "py_func", vectors.compose)


def turned(R: Vector, S: Vector) -> Vector:
    """``R Sᵀ``: the rotation, along the world's axes, that brings S to R."""
    return (
        R[0] * S[0] + R[1] * S[1] + R[2] * S[2],
        R[0] * S[3] + R[1] * S[4] + R[2] * S[5],
        R[0] * S[6] + R[1] * S[7] + R[2] * S[8],
        R[3] * S[0] + R[4] * S[1] + R[5] * S[2],
        R[3] * S[3] + R[4] * S[4] + R[5] * S[5],
        R[3] * S[6] + R[4] * S[7] + R[5] * S[8],
        R[6] * S[0] + R[7] * S[1] + R[8] * S[2],
        R[6] * S[3] + R[7] * S[4] + R[8] * S[5],
        R[6] * S[6] + R[7] * S[7] + R[8] * S[8],
    )


def rotation_error(R: Vector, S: Vector) -> Vector:
    """The rotation vector [rad], along the world's axes, that brings S to R by the shorter way.

    Half its square is a potential whose gradient over turns of R is the vector itself, at every
    angle below π. At π both ways are as short and either may be returned.
    """
    found: Vector = _log(turned(R, S))
    return found


def turned_on(R: Vector, turn: Vector) -> Vector:
    """R turned by a rotation vector [rad] along the world's axes."""
    found: Vector = _compose(_exp(turn), R)
    return found


def difference(a: Vector, b: Vector) -> Vector:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def combined(a: float, x: Vector, b: float, y: Vector) -> Vector:
    """``a x + b y``."""
    return (a * x[0] + b * y[0], a * x[1] + b * y[1], a * x[2] + b * y[2])


def limited(wanted: Vector, last: Vector, most: float, rise: float) -> tuple[Vector, bool, bool]:
    """Return the part of a vector that its limits allow; did its size, did its rise limit it?

    The answer is λ `wanted` with λ from 0 to 1: it never turns round, and never exceeds what was
    wanted. Of those not longer than `most` it is the longest within `rise` of `last`; where none
    is, the one nearest to `last`. So only rises are limited: to hold on to a force that the spring
    no longer has would push, and to approach one of the other sign slowly would push backwards.
    """
    squared = dot(wanted, wanted)
    length = sqrt(squared)
    if length == 0.0:
        return (0.0, 0.0, 0.0), False, False
    largest = most / length if length > most else 1.0
    along, before = dot(wanted, last), dot(last, last)
    reach = along * along - squared * (before - rise * rise)
    share = along / squared
    if reach > 0.0:
        share += sqrt(reach) / squared
    slewed = share < largest
    share = min(max(share, 0.0), largest)
    return (share * wanted[0], share * wanted[1], share * wanted[2]), largest < 1.0, slewed
