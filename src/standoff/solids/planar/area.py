"""The area inside loops, by Green's theorem, with a proven error."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.intervals import Interval
from standoff.solids.planar.loops import Loop, ends_of, size_of
from standoff.solids.planar.tolerances import PADDED

# Parts of a smooth piece of a curve, for the error: by its part of the solid's size.
FEWEST_PARTS, MOST_PARTS = 24, 512
GAUSS_PARTS = 12  # for the value
GAUSS = np.polynomial.legendre.leggauss(5)
SAMPLES = 17  # of a curve, for the rough value


def area_of(loops: tuple[Loop, ...]) -> tuple[float, float]:
    """(area, bound of its error) of what lies on the left of the loops."""
    total, error = 0.0, 0.0
    size = max(size_of(loop.curves) for loop in loops)
    for loop in loops:
        for curve, backward in zip(loop.curves, loop.backward, strict=True):
            share = float(np.abs(np.subtract(*ends_of(curve))).max()) / size
            # a closed curve has no chord
            parts = MOST_PARTS if curve.closed else max(FEWEST_PARTS, int(MOST_PARTS * share))
            value, off = swept(curve, parts)
            total += -value if backward else value
            error += off
        total_ends = _joints(loop)
        error += total_ends
    return total, error


def _joints(loop: Loop) -> float:
    """What the gaps between ends may sweep."""
    reach = max(float(np.abs(np.concatenate(ends_of(c))).max()) for c in loop.curves)
    return len(loop.curves) * loop.gap * reach


def swept(curve: Curve, parts: int) -> tuple[float, float]:
    """(half the integral of x dy - y dx along a curve, bound of its error)."""
    (x0, y0), (x1, y1) = ends_of(curve)
    size = float(np.abs([x0, y0, x1, y1]).max())
    if isinstance(curve, Line):
        return 0.5 * float(x0 * y1 - x1 * y0), PADDED * size**2
    if isinstance(curve, ConicArc):
        a, b, c = curve.basis()[:2].T
        turn = curve.last - curve.first
        sector = 0.5 * turn * float(a[0] * b[1] - a[1] * b[0])
        chord = 0.5 * float(c[0] * (y1 - y0) - c[1] * (x1 - x0))
        reach = size + float(np.abs(curve.basis()).sum())
        return sector + chord, PADDED * reach**2 * (1.0 + turn)
    return _integrated(curve, size, parts)


def _integrated(curve: Curve, size: float, parts: int) -> tuple[float, float]:
    """The value by Gauss, the error from bounds.

    Over a part of length h round c, with T = x_t(c) and P, Q in the range of x_tt,
    (x - x(c)) x x_t = t² (T x Q + P x T / 2) + t³ P x Q / 2: its integral is known up to the width
    of that range, times h³.
    """
    low, high, value = 0.0, 0.0, 0.0
    for first, last in pairwise(curve.spans()):
        cuts = np.linspace(first, last, parts + 1)
        start, end = cuts[:-1], cuts[1:]
        middle, h = 0.5 * (start + end), end - start
        over = curve.jets_over(Interval(start, end))
        # knots as the starts and as the ends of parts, so that none lies between two spans
        places = np.concatenate([middle, start, end])
        at, starts, ends = _thirds(curve.jets_over(Interval(places, places)), parts)
        chord = ends[:, 0] - starts[:, 0]
        bend = _crossed(at[:, 1], over[:, 2])
        rest = _crossed(over[:, 2], over[:, 2]).magnitude * h**4 / 64.0
        part = _crossed(at[:, 0], chord) + (bend - bend * 0.5) * (h**3 / 12.0)
        part = (part + Interval(-rest, rest)) * 0.5
        low, high = low + float(part.lo.sum()), high + float(part.hi.sum())
        value += _by_gauss(curve, float(first), float(last))
    rounding = PADDED * parts * (size**2 + abs(value))
    return value, max(high - value, value - low) + rounding


def _thirds(jets: Interval, n: int) -> tuple[Interval, Interval, Interval]:
    return jets[..., :n], jets[..., n : 2 * n], jets[..., 2 * n :]


def _crossed(a: Interval, b: Interval) -> Interval:
    return a[0] * b[1] - a[1] * b[0]


def _by_gauss(curve: Curve, first: float, last: float) -> float:
    """Half the integral of x dy - y dx over a smooth piece."""
    step, value = (last - first) / GAUSS_PARTS, 0.0
    for k in range(GAUSS_PARTS):
        for node, weight in zip(*GAUSS, strict=True):
            x, xt, _ = curve.jet(first + step * (k + 0.5 + 0.5 * float(node)))
            value += 0.25 * step * float(weight) * float(x[0] * xt[1] - x[1] * xt[0])
    return value


def rough_area(loop: Loop) -> float:
    """The area of a polygon through points of a loop: enough to see which way it turns."""
    points = []
    for curve, backward in zip(loop.curves, loop.backward, strict=True):
        ts = np.linspace(curve.first, curve.last, SAMPLES)[:-1]
        if backward:
            ts = curve.first + curve.last - ts
        points += [curve.point(float(t))[:2] for t in ts]
    x, y = np.array(points).T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
