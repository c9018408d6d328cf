"""How far the image of a trimming curve on a spline surface, or a swept spline, may be from its
edge, where that is a polynomial between known parameters.

With S = A / a, p polynomial and C = B / b, the difference times a b is N = A b - B a, a polynomial
of known degree n. At m > n Chebyshev points, |N| <= its greatest value there / cos(pi n / 2 m)
(Ehlich and Zeller 1964), for each component in any direction, and so for its length.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from standoff.geometry.nurbs import NurbsSurface
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.surfaces import Surface
from standoff.geometry.validation import Array
from standoff.kernels.body import layout as L

# Chebyshev points for each degree: the bound is above the greatest value there by 8 % at most.
POINTS = 4


def polynomial_bound(pcurve: Pcurve, curve: NurbsCurve, surface: Surface) -> float | None:
    """A bound over the whole edge, length; None where the trimming curve may cross knots at unknown
    parameters, or is rational, or the surface is no spline along it."""
    line = _along_side(pcurve)
    us, vs = surface.analytic_breaks()
    if line is None and (len(us) or len(vs) or not _polynomial(pcurve)):
        return None
    spline = _spline(surface, None if line is None else line[0])
    if spline is None:
        return None
    own, weights = spline
    breaks = [float(t) for t in curve.spans()]
    if line is not None:
        along, slope, start = line
        levels = (us, vs)[along]
        breaks += [float(t) for t in (levels - start) / slope if curve.first < t < curve.last]
    else:
        spans = getattr(pcurve, "spans", None)
        if spans is not None:
            breaks += [t for s in spans for t in (s.first, s.last) if curve.first < t < curve.last]
            own *= len(spans[0].matrix) - 1
    rational = np.ptp(weights) > 0.0 or np.ptp(curve.weights) > 0.0
    count = own + curve.degree if rational else max(own, curve.degree)
    ends = np.unique(breaks)
    most = float(weights.max() * curve.weights.max())
    least = float(weights.min() * curve.weights.min())
    worst = max(_greatest(pcurve, curve, surface, (a, b), count) for a, b in pairwise(ends))
    return worst * most / least


def _spline(surface: Surface, along: int | None) -> tuple[int, Array] | None:
    """(degree, weights) of a spline surface along u (0) or v (1), or of both degrees together; of a
    plane; of a swept one, those of its profile, along that."""
    if surface.kind == L.PLANE:
        return 1, np.ones(1)
    if isinstance(surface, NurbsSurface):
        both = sum(surface.degrees) if along is None else surface.degrees[along]
        return both, surface.weights
    profile_along = {L.EXTRUSION: 0, L.REVOLUTION: 1}.get(surface.kind)
    profile = getattr(surface, "profile", None)
    if along is None or along != profile_along or not isinstance(profile, NurbsCurve):
        return None
    return profile.degree, profile.weights


def _greatest(
    pcurve: Pcurve, curve: NurbsCurve, surface: Surface, over: tuple[float, float], degree: int
) -> float:
    """A bound of |S - C| over a piece where a and b are 1, else of a b |S - C| over their greatest
    values."""
    count = POINTS * max(degree, 1)
    nodes = np.cos(np.pi * (np.arange(count) + 0.5) / count)
    between = 1.0 / np.cos(0.5 * np.pi * degree / count)
    ts = 0.5 * (sum(over) + nodes * (over[1] - over[0]))
    away = surface.points(pcurve.places(ts)) - curve.points(ts)
    return float(between * np.linalg.norm(away, axis=1).max())


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
