"""Trimming curves in (u, v), found exactly from a curve and the surface that carries it.

A pcurve has its edge's parameter. Homogeneous (u, v) is P (t, 0, 1) or P (cos t, sin t, 1): in a
plane an affine image of the curve, in a gnomonic chart its central projection (every section of a
sphere is a conic there), on a cylinder or cone the angle or the generator.
"""

from __future__ import annotations

import numpy as np

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError
from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.surfaces import Surface
from standoff.geometry.tolerances import ROUND_SECTION
from standoff.kernels.body import layout as L
from standoff.typing import Array


def pcurve_of(curve: Curve, surface: Surface) -> Pcurve:
    """The trimming curve of an edge on a surface, exact.

    A curve that was made on the surface has its own (`Curve.pcurve_on`).

    Raises ValueError: not a curve, not a surface, or kinds for which the pcurve is not a line or
    conic in (u, v).

    Parameters
    ----------
    curve : Curve
        A `Line` or `ConicArc` in the surface, or a curve that was made on it.
    surface : Surface
        A `Plane`, `Sphere`, `Cylinder` or `Cone` for lines and conic arcs.

    Returns
    -------
    Pcurve
        With the curve's own parameter.
    """
    if not isinstance(curve, Curve):
        raise StandoffError(f"curve is {shown(curve)}: give a Curve.", "curve", curve)
    if not isinstance(surface, Surface):
        raise StandoffError(f"surface is {shown(surface)}: give a Surface.", "surface", surface)
    own = curve.pcurve_on(surface)
    if own is not None:
        return own
    if not isinstance(curve, Line | ConicArc):
        raise StandoffError(
            f"{type(curve).__name__} has no exact pcurve on this "
            f"{type(surface).__name__}: give it in Face.pcurves, or use Line or ConicArc.",
            "curve",
            curve,
        )
    offset = np.outer(surface.shift, [0.0, 0.0, 1.0])
    basis = np.asarray(np.linalg.inv(surface.linear) @ (curve.basis() - offset), dtype=np.float64)
    if surface.projection == "parallel":
        return Pcurve(curve.kind, np.vstack([basis[:2], [0.0, 0.0, 1.0]]))
    if surface.projection == "central":
        return Pcurve(curve.kind, basis)
    if surface.projection == "axial":
        return _round_pcurve(curve, surface, basis)
    raise StandoffError(f"No pcurve rule for {type(surface).__name__}.", "surface", surface)


def _round_pcurve(curve: Curve, surface: Surface, basis: Array) -> Pcurve:
    if isinstance(curve, Line):
        middle = basis @ np.array([0.5 * (curve.first + curve.last), 0.0, 1.0])
        angle = float(np.arctan2(middle[1], middle[0]))
        matrix = np.array([[0.0, 0.0, angle], [basis[2, 0], 0.0, basis[2, 2]], [0.0, 0.0, 1.0]])
        return Pcurve(L.LINE, matrix)
    a, b = basis[:2, 0], basis[:2, 1]
    radius = np.linalg.norm(a)
    height = basis[2, 2]
    level = np.abs(basis[2, :2]).max() <= ROUND_SECTION * max(1.0, abs(height))
    alike = abs(np.linalg.norm(b) - radius) <= ROUND_SECTION * radius
    round_ = abs(a @ b) <= ROUND_SECTION * radius**2 and alike
    centred = np.linalg.norm(basis[:2, 2]) <= ROUND_SECTION * radius
    if not (level and round_ and centred):
        raise StandoffError(
            f"On a {type(surface).__name__} only generators and sections perpendicular to its axis "
            "have a line as pcurve; this curve is neither.",
            "curve",
            curve,
        )
    turn = 1.0 if a[0] * b[1] - a[1] * b[0] > 0.0 else -1.0
    phase = float(np.arctan2(a[1], a[0]))
    return Pcurve(L.LINE, np.array([[turn, 0.0, phase], [0.0, 0.0, height], [0.0, 0.0, 1.0]]))
