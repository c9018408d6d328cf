"""How far the image of a trimming curve on a spline surface may be from its edge, where that is a
polynomial between known parameters.

With S = A / a, p polynomial and C = B / b, the difference times a b is N = A b - B a, a polynomial
of known degree n. By the Lebesgue constant of its Chebyshev points, |N| <= (1 +
2/pi ln(n + 1)) times its greatest value there (Rivlin 1974): a bound from n + 1 values.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from standoff.geometry.nurbs import NurbsSurface
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.validation import Array
from standoff.kernels.body import layout as L


def polynomial_bound(pcurve: Pcurve, curve: NurbsCurve, surface: NurbsSurface) -> float | None:
    """A bound over the whole edge, length; None where the trimming curve may cross knots at unknown
    parameters, or is rational."""
    line = _along_side(pcurve)
    us, vs = surface.analytic_breaks()
    if line is None and (len(us) or len(vs) or not _polynomial(pcurve)):
        return None
    breaks = [float(t) for t in curve.spans()]
    degree = 1
    if line is not None:
        along, slope, start = line
        levels = (us, vs)[along]
        breaks += [float(t) for t in (levels - start) / slope if curve.first < t < curve.last]
        own = surface.degrees[along]
    else:
        spans = getattr(pcurve, "spans", None)
        if spans is not None:
            breaks += [t for s in spans for t in (s.first, s.last) if curve.first < t < curve.last]
            degree = len(spans[0].matrix) - 1
        own = degree * sum(surface.degrees)
    rational = np.ptp(surface.weights) > 0.0 or np.ptp(curve.weights) > 0.0
    count = own + curve.degree if rational else max(own, curve.degree)
    ends = np.unique(breaks)
    least = float(surface.weights.min() * curve.weights.min())
    worst = max(
        _greatest(pcurve, curve, surface, (a, b), count) for a, b in pairwise(ends) if a < b
    )
    return worst / least


def _greatest(
    pcurve: Pcurve, curve: NurbsCurve, surface: NurbsSurface, over: tuple[float, float], degree: int
) -> float:
    """A bound of |a b (S - C)| over a piece."""
    nodes = np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    lebesgue = 1.0 + 2.0 / np.pi * np.log(degree + 1.0)
    most = float(surface.weights.max() * curve.weights.max())
    ts = 0.5 * (sum(over) + nodes * (over[1] - over[0]))
    away = surface.points(pcurve.places(ts)) - curve.points(ts)
    return float(lebesgue * most * np.linalg.norm(away, axis=1).max())


def _polynomial(pcurve: Pcurve) -> bool:
    """Is it a polynomial in each span?"""
    weights: Array = pcurve.matrix[:, 2] if pcurve.kind == L.BEZIER else np.zeros(1)
    return pcurve.kind == L.LINE or bool(np.ptp(weights) == 0.0 and pcurve.kind == L.BEZIER)


def _along_side(pcurve: Pcurve) -> tuple[int, float, float] | None:
    """(axis, slope, start) of a line along u or v."""
    if pcurve.kind != L.LINE or pcurve.matrix[2].tolist() != [0.0, 0.0, 1.0]:
        return None
    slopes = pcurve.matrix[:2, 0]
    along = int(abs(slopes[1]) > abs(slopes[0]))
    if slopes[1 - along] != 0.0 or slopes[along] == 0.0:
        return None
    return along, float(slopes[along]), float(pcurve.matrix[along, 2])
