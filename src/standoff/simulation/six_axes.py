"""The arithmetic of a tick: pure functions of numbers and tuples, without arrays or objects.

A vector is a tuple of three floats, a rotation one of nine, row by row. They are written so that
Numba can compile them as they stand.
"""

from __future__ import annotations

from typing import Any

from standoff.kernels.algebra import rigid, vectors
from standoff.kernels.dynamics import coupler, coupler_arrival

Vector = tuple[float, ...]

# The kernels' own, uncompiled: a loop in Python need not wait for the compiler.
_log: Any = getattr(rigid.log_rotation, "py_func", rigid.log_rotation)
_exp: Any = getattr(rigid.exp_rotation, "py_func", rigid.exp_rotation)
_compose: Any = getattr(vectors.compose, "py_func", vectors.compose)
_turned: Any = getattr(coupler_arrival.turned, "py_func", coupler_arrival.turned)
limited: Any = getattr(coupler.limited, "py_func", coupler.limited)


def rotation_error(R: Vector, S: Vector) -> Vector:
    """The rotation vector [rad], along the world's axes, that brings S to R by the shorter way.

    Half its square is a potential whose gradient over turns of R is the vector itself, at every
    angle below π. At π both ways are as short and either may be returned.
    """
    found: Vector = _log(_turned(R, S))
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
