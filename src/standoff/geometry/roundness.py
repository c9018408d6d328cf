"""Which maps and arcs are round, up to a tolerance."""

from __future__ import annotations

import numpy as np

from standoff.geometry.curves import ConicArc
from standoff.typing import Array


def alike(a: float, b: float, tolerance: float) -> bool:
    """Do two lengths differ by no more than a part of the greater one?"""
    return bool(abs(a - b) <= tolerance * max(abs(a), abs(b)))


def square(linear: Array, tolerance: float) -> bool:
    """Are the columns of a (3, 3) perpendicular to each other, up to a cosine?"""
    lengths = np.linalg.norm(linear, axis=0)
    off = np.abs(linear.T @ linear) / np.outer(lengths, lengths)
    return bool(max(off[0, 1], off[0, 2], off[1, 2]) <= tolerance)


def round_arc(curve: ConicArc, tolerance: float) -> bool:
    """Is an arc a part of a circle?"""
    a, b, _ = curve.basis().T
    one, other = float(np.linalg.norm(a)), float(np.linalg.norm(b))
    upright = abs(float(a @ b)) <= tolerance * one * other
    return upright and alike(one, other, tolerance)
