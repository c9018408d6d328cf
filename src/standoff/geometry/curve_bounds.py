"""How far curves extend: bounds for boxes around curves and around what they sweep."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from standoff.errors import StandoffError
from standoff.geometry.bernstein import segment
from standoff.geometry.curves import ConicArc, Curve, Line, RationalBezier
from standoff.geometry.hulls import tight_box
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.typing import Array


def curve_reach(curve: Curve, direction: Array, first: float, last: float) -> float:
    """An upper bound of direction @ x on a curve from parameter first to last.

    It is exact for lines and conic arcs, from the subdivided control points of the piece for
    rational curves, and from the whole curve's box for formulas.

    Raises ValueError: a kind of curve without bounds.
    """
    if isinstance(curve, Line | ConicArc):
        ends = [float(direction @ curve.point(t)) for t in (first, last)]
        if isinstance(curve, ConicArc):
            a, b, _ = direction @ curve.basis()
            top = first + (float(np.arctan2(b, a)) - first) % (2.0 * np.pi)
            if top <= last:
                ends.append(float(direction @ curve.point(top)))
        return max(ends)
    if isinstance(curve, RationalBezier | NurbsCurve):
        return max(
            float(tight_box((part @ _reading(direction)).T[None, ..., None])[1][0])
            for part in rational_parts(curve, first, last)
        )
    box = curve.box()
    if box is not None:
        return float(np.where(direction > 0.0, box[1], box[0]) @ direction)
    raise StandoffError(
        f"{type(curve).__name__} has no bounds: it cannot be a profile.", "profile", curve
    )


def _reading(direction: Array) -> Array:
    """The matrix (4, 2) from homogeneous points to homogeneous heights along a direction."""
    matrix = np.zeros((4, 2))
    matrix[:3, 0], matrix[3, 1] = direction, 1.0
    return matrix


def rational_parts(curve: RationalBezier | NurbsCurve, first: float, last: float) -> list[Array]:
    """Homogeneous Bezier points (p + 1, 4) of the pieces of a rational curve from first to last."""
    if isinstance(curve, RationalBezier):
        breaks, blocks = np.array([0.0, 1.0]), curve.data[1:].reshape(1, -1, 4)
    else:
        breaks, blocks = curve.essential.breaks, curve.blocks
    found = []
    for a, b, block in zip(breaks[:-1], breaks[1:], blocks, strict=True):
        low, high = max(float(a), first), min(float(b), last)
        if low <= high:
            part: Array = segment(len(block) - 1, (low - a) / (b - a), (high - a) / (b - a)) @ block
            found.append(part)
    return found


def curve_breaks(curve: Curve, first: float, last: float) -> tuple[float, ...]:
    """Parameters inside a range where a curve is not C²."""
    if not isinstance(curve, NurbsCurve):
        return ()
    return tuple(t for t in curve.breaks() if first < t < last)


def box_of(reach: Callable[[Array], float]) -> tuple[Array, Array]:
    """(low, high), each (3,), from a bound of direction @ x for any direction."""
    axes = np.eye(3)
    return np.array([-reach(-axis) for axis in axes]), np.array([reach(axis) for axis in axes])
