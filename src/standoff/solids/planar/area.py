"""The area inside loops, by Green's theorem, with a proven error."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from standoff.geometry.curves import Curve
from standoff.geometry.intervals import Interval
from standoff.kernels.solids import planar_layout as P
from standoff.solids.planar.leaves import form_of
from standoff.solids.planar.loops import Loop, ends_of
from standoff.solids.planar.tolerances import PADDED

Array = NDArray[np.float64]
PARTS = 512  # of each smooth piece of a curve
GAUSS = np.polynomial.legendre.leggauss(4)


def area_of(loops: tuple[Loop, ...]) -> tuple[float, float]:
    """(area, bound of its error) of what lies on the left of the loops."""
    total, error = 0.0, 0.0
    for loop in loops:
        for curve, backward in zip(loop.curves, loop.backward, strict=True):
            value, off = swept(curve)
            total += -value if backward else value
            error += off
        total_ends = _joints(loop)
        error += total_ends
    return total, error


def _joints(loop: Loop) -> float:
    """What the gaps between ends may sweep."""
    reach = max(float(np.abs(np.concatenate(ends_of(c))).max()) for c in loop.curves)
    return len(loop.curves) * loop.gap * reach


def swept(curve: Curve) -> tuple[float, float]:
    """(half the integral of x dy - y dx along a curve, bound of its error)."""
    (x0, y0), (x1, y1) = ends_of(curve)
    size = float(np.abs([x0, y0, x1, y1]).max())
    form = form_of(curve)
    if form == P.LINE:
        return 0.5 * float(x0 * y1 - x1 * y0), PADDED * size**2
    if form == P.ARC:
        a, b, c = curve.basis()[:2].T
        turn = curve.last - curve.first
        sector = 0.5 * turn * float(a[0] * b[1] - a[1] * b[0])
        chord = 0.5 * float(c[0] * (y1 - y0) - c[1] * (x1 - x0))
        reach = size + float(np.abs(curve.basis()).sum())
        return sector + chord, PADDED * reach**2 * (1.0 + turn)
    return _integrated(curve, size)


def _integrated(curve: Curve, size: float) -> tuple[float, float]:
    """By the midpoint rule, whose error over a part of length h is at most h² / 8 times the width
    of the range of the integrand's derivative x y_tt - y x_tt."""
    total = Interval(np.zeros(1), np.zeros(1))
    value = 0.0
    spans = curve.spans()
    for first, last in pairwise(spans):
        cuts = np.linspace(first, last, PARTS + 1)
        low, high = cuts[:-1], cuts[1:]
        middle, h = 0.5 * (low + high), high - low
        over, at = curve.jets_over(Interval(low, high)), curve.jets_over(Interval(middle, middle))
        rate = over[0, 0] * over[1, 2] - over[1, 0] * over[0, 2]
        density = at[0, 0] * at[1, 1] - at[1, 0] * at[0, 1]
        off = 0.125 * h**2 * (rate.hi - rate.lo)
        part = density * h + Interval(-off, off)
        total = total + Interval(part.lo.sum(keepdims=True), part.hi.sum(keepdims=True)) * 0.5
        for node, weight in zip(*GAUSS, strict=True):
            jets = [curve.jet(float(m + 0.5 * node * d)) for m, d in zip(middle, h, strict=True)]
            x, xt = np.array([j[0] for j in jets]), np.array([j[1] for j in jets])
            value += 0.25 * weight * float(h @ (x[:, 0] * xt[:, 1] - x[:, 1] * xt[:, 0]))
    rounding = PADDED * (size**2 + abs(value)) * len(spans)
    return value, float(max(total.hi[0] - value, value - total.lo[0])) + rounding
