"""Vectors: products and lengths of single ones, and how a repr writes them; a pose as a row."""

from __future__ import annotations

import math

import numpy as np

from standoff.motion.tolerances import SHOWN_DIGITS
from standoff.typing import Array


def cross(a: Array, b: Array) -> Array:
    """Return a × b; for single vectors several times as fast as NumPy's."""
    a0, a1, a2 = a.tolist()
    b0, b1, b2 = b.tolist()
    return np.array([a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0])


def pose_row(rotation: Array, translation: Array) -> Array:
    """(12,): R by rows, p."""
    return np.concatenate([rotation.ravel(), translation])


def length(vector: Array) -> float:
    """Return |vector|."""
    return math.hypot(*vector.tolist())


def written(values: Array, scale: float = 0.0) -> str:
    """Return numbers as a list with six digits each; what is roundoff compared with the greatest of
    them, or with `scale` in their unit, as 0."""
    size = max(scale, float(np.abs(values).max(initial=0.0)))
    return f"[{', '.join(f'{x:.6g}' if abs(x) > SHOWN_DIGITS * size else '0' for x in values)}]"
