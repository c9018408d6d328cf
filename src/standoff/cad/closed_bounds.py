"""How far the image of a trimming curve may be from its edge, in closed form.

Where both are lines, the difference is affine and greatest at an end. Where both turn once with the
same parameter, it is a cos t + b sin t + c, found from three values and bounded over the arc by its
values at Chebyshev points. In a plane, it is that of the control points.
"""

from __future__ import annotations

import numpy as np

from standoff.cad.polynomial_bounds import chebyshev_points
from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.geometry.nurbs_pcurves import NurbsPcurve
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.surfaces import Surface
from standoff.kernels.body import layout as L
from standoff.typing import Array

AFFINE = np.array([0.0, 0.0, 1.0])
ROUND_KINDS = {L.CYLINDER: (0,), L.CONE: (0,), L.TORUS: (0, 1), L.REVOLUTION: (0,)}
"""Parameters that are angles on which points depend by a sine and a cosine."""
DEGREE, POINTS = 32, 256
"""Degree of a polynomial that is a sine or cosine of t or of 2 t over a turn but for 1e-19, and
Chebyshev points."""
BETWEEN = 1.0 / np.cos(0.5 * np.pi * DEGREE / POINTS)
"""The bound over the greatest value there (see ``polynomial_bounds``)."""
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
        at, quarter, half = (_away(pcurve, curve, surface, k * 0.5 * np.pi) for k in range(3))
        c = 0.5 * (at + half)
        return _turning(np.stack([at - c, quarter - c, c], axis=1), curve)
    return None


def sphere_bound(curve: Curve, surface: Surface) -> float:
    """How far a line or an arc is at most from its image on a sphere, from the centre, length.

    |C - c|² - R² has degree 2 in t, or in its sine and cosine: its values at Chebyshev points bound
    it over the edge.
    """
    radius = float(np.linalg.norm(surface.linear[:, 0]))
    away = curve.points(_along(curve)) - surface.shift
    off = BETWEEN * np.abs(np.sum(away**2, axis=1) - radius**2).max()
    return float(off / (radius + np.sqrt(max(radius**2 - off, 0.0))))


def _along(curve: Curve) -> Array:
    """Chebyshev points of a line's or an arc's parameter."""
    return np.asarray(curve.first + (curve.last - curve.first) * chebyshev_points(POINTS))


def _away(pcurve: Pcurve, curve: Curve, surface: Surface, t: float) -> Array:
    u, v, _ = pcurve.point(t)
    return surface.jet(u, v)[0] - curve.point(t)


def _turning(parts: Array, curve: Curve) -> float:
    """A bound over an arc of |a cos t + b sin t + c|, of the columns a, b and c of (3, 3)."""
    ts = _along(curve)
    values = np.stack([np.cos(ts), np.sin(ts), np.ones_like(ts)], axis=1) @ parts.T
    return float(BETWEEN * np.linalg.norm(values, axis=1).max())


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
    return _turning(away, curve)
