"""How far the image of a trimming curve may be from its edge, in closed form.

Where both are lines, the difference is affine and greatest at an end. Where both turn once with the
same parameter, it is a cos t + b sin t + c, found from three values. In a plane, it is that of the
control points.
"""

from __future__ import annotations

import numpy as np

from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.geometry.nurbs_pcurves import NurbsPcurve
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.surfaces import Surface
from standoff.geometry.validation import Array
from standoff.kernels.body import layout as L

AFFINE = np.array([0.0, 0.0, 1.0])
ROUND_KINDS = {L.CYLINDER: (0,), L.CONE: (0,), L.TORUS: (0, 1), L.REVOLUTION: (0,)}
"""Parameters that are angles on which points depend by a sine and a cosine."""
SPHERE_POINTS = 16
RULED_KINDS = {L.CYLINDER: (1,), L.CONE: (1,), L.EXTRUSION: (1,), L.PLANE: (0, 1)}
"""Parameters on which points depend affinely."""


def closed_bound(pcurve: Pcurve, curve: Curve, surface: Surface) -> float | None:
    """A bound over the whole edge, length, up to rounding; None where there is no closed form."""
    if surface.kind == L.PLANE:
        return _in_plane(pcurve, curve, surface)
    if pcurve.kind != L.LINE or not np.array_equal(pcurve.matrix[2], AFFINE):
        return None
    slopes = np.abs(pcurve.matrix[:2, 0])
    axis = int(slopes[1] > slopes[0])
    if slopes[1 - axis] != 0.0:
        return None
    if isinstance(curve, Line) and axis in RULED_KINDS.get(surface.kind, ()):
        ends = (_away(pcurve, curve, surface, t) for t in (curve.first, curve.last))
        return float(max(np.linalg.norm(x) for x in ends))
    if isinstance(curve, ConicArc) and axis in ROUND_KINDS.get(surface.kind, ()):
        if slopes[axis] != 1.0:
            return None
        at, quarter, half = (
            _away(pcurve, curve, surface, curve.first + k * 0.5 * np.pi) for k in range(3)
        )
        c = 0.5 * (at + half)
        reach = 0.5 * (curve.last - curve.first)
        return _turning(0.5 * (at - half), quarter - c, c, reach, reach)
    return None


def sphere_bound(curve: Curve, surface: Surface) -> float:
    """How far a line or an arc is at most from its image on a sphere, from the centre, length.

    |C - c|² - R² is a polynomial of degree 2 in t, or in its sine and cosine: it is bounded by its
    values at Chebyshev points, or at as many of a whole turn (see ``polynomial_bounds``).
    """
    radius = float(np.linalg.norm(surface.linear[:, 0]))
    steps = np.pi * (np.arange(SPHERE_POINTS) + 0.5) / SPHERE_POINTS
    if isinstance(curve, Line):
        rows = np.stack([0.5 + 0.5 * np.cos(steps), 0.0 * steps, np.ones_like(steps)])
    else:
        rows = np.stack([np.cos(2.0 * steps), np.sin(2.0 * steps), np.ones_like(steps)])
    away = (curve.basis() @ rows).T - surface.shift
    off = np.abs(np.sum(away**2, axis=1) - radius**2).max() / np.cos(2.0 * np.pi / SPHERE_POINTS)
    return float(off / (radius + np.sqrt(max(radius**2 - off, 0.0))))


def _away(pcurve: Pcurve, curve: Curve, surface: Surface, t: float) -> Array:
    u, v, _ = pcurve.point(t)
    return surface.jet(u, v)[0] - curve.point(t)


def _turning(a: Array, b: Array, c: Array, half: float, middle: float) -> float:
    """A bound of |a cos t + b sin t + c| within `half` of the middle, radians."""
    whole = sum(float(np.linalg.norm(x)) for x in (a, b, c))
    cosine, sine = np.cos(middle), np.sin(middle)
    a, b = a * cosine + b * sine, b * cosine - a * sine
    fall, rise = 1.0 - np.cos(min(half, np.pi)), np.sin(min(half, 0.5 * np.pi))
    there, one, other = (float(np.linalg.norm(x)) for x in (a + c, a, b))
    return min(there + fall * one + rise * other, whole)


def _in_plane(pcurve: Pcurve, curve: Curve, surface: Surface) -> float | None:
    """Points of a plane are an affine map of (u, v)."""
    frame = np.column_stack([surface.linear[:, :2], surface.shift])
    if isinstance(pcurve, NurbsPcurve) and isinstance(curve, NurbsCurve):
        w = pcurve.matrix[:, 2:]
        alike = (pcurve.knots, curve.knots), (w[:, 0], curve.weights)
        if not all(np.array_equal(one, other) for one, other in alike):
            return None
        flat = np.column_stack([pcurve.matrix[:, :2] / w, np.ones(len(w))])
        off = np.linalg.norm(flat @ frame.T - curve.control_points, axis=1)
        return float(off.max())
    kinds = (L.LINE, Line), (L.CONIC, ConicArc)
    if not any(pcurve.kind == kind and isinstance(curve, own) for kind, own in kinds):
        return None
    if not np.array_equal(pcurve.matrix[2], AFFINE):
        return None
    away = frame @ pcurve.matrix - curve.basis()
    if isinstance(curve, Line):
        return float(max(np.linalg.norm(away @ [t, 0.0, 1.0]) for t in (curve.first, curve.last)))
    a, b, c = away.T
    return _turning(a, b, c, 0.5 * (curve.last - curve.first), 0.5 * (curve.first + curve.last))
