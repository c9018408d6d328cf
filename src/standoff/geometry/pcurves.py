"""Trimming curves in (u, v), found exactly from a curve and the surface that carries it.

A pcurve has its edge's parameter. Homogeneous (u, v) is P (t, 0, 1) or P (cos t, sin t, 1): in a
plane an affine image of the curve, in a gnomonic chart its central projection (every section of a
sphere is a conic there), on a cylinder or cone the angle or the generator.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.surfaces import Cone, Cylinder, Plane, Sphere, Surface
from standoff.geometry.validation import Array
from standoff.kernels import layout as L
from standoff.kernels.entries import pcurve_jet
from standoff.read_only import KeepsReadOnly
from standoff.real_numbers import real_array, shown


@dataclass(frozen=True, eq=False)
class Pcurve(KeepsReadOnly):
    """A trimming curve: homogeneous (u, v) as an affine image of a line or a unit circle.

    Parameters
    ----------
    kind : int
        LINE or CONIC of `standoff.kernels.layout`; take those of `pcurve_of`, or a `NurbsPcurve`.
    matrix : (3, 3) array_like
        P of P (t, 0, 1) for a line, of P (cos t, sin t, 1) for a conic, t in radians.

    Raises
    ------
    ValueError
        Another kind, a wrong shape, or a number that is not finite.
    """

    kind: int
    matrix: Array

    def __post_init__(self) -> None:
        given: Any = self.kind
        if isinstance(given, bool) or not isinstance(given, int) or given not in (L.LINE, L.CONIC):
            raise ValueError(
                f"Pcurve of kind {shown(given)}: give {L.LINE} (line) or {L.CONIC} (conic)."
            )
        try:
            matrix = real_array(self.matrix)
        except (TypeError, ValueError) as error:
            raise ValueError(f"Pcurve.matrix is not numeric: {shown(self.matrix)}") from error
        if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
            raise ValueError(
                f"Pcurve.matrix = {shown(self.matrix)}: give a (3, 3) array of finite numbers."
            )
        object.__setattr__(self, "matrix", matrix)

    @property
    def data(self) -> Array:
        """What the kernels read."""
        return self.matrix.flatten()

    def homogeneous(self, t: float) -> tuple[Array, Array, Array]:
        """(h, h_t, h_tt), each (3,): homogeneous (u, v) and its derivatives."""
        h, ht, htt = pcurve_jet(self.data, self.kind, 0, t)
        return np.array(h), np.array(ht), np.array(htt)

    def point(self, t: float) -> tuple[float, float, float]:
        """(u, v, depth): depth > 0 where the chart sees the point, else u and v are nan."""
        h = self.homogeneous(t)[0]
        if h[2] <= 0.0:
            return np.nan, np.nan, float(h[2])
        return float(h[0] / h[2]), float(h[1] / h[2]), float(h[2])

    def pieces(self, first: float, last: float) -> list[tuple[Pcurve, float, float]]:
        """(pcurve, first, last) of the parts that a straight line meets at most twice."""
        return [(self, first, last)]


def pcurve_of(curve: Curve, surface: Surface) -> Pcurve:
    """The trimming curve of an edge on a surface, exact.

    A curve that was made on the surface brings its own (`Curve.pcurve_on`).

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

    Raises
    ------
    ValueError
        No curve, no surface, or the kinds do not meet in a line or conic of (u, v).
    """
    if not isinstance(curve, Curve):
        raise ValueError(f"curve is {shown(curve)}: give a Curve.")
    if not isinstance(surface, Surface):
        raise ValueError(f"surface is {shown(surface)}: give a Surface.")
    own = curve.pcurve_on(surface)
    if own is not None:
        return own
    if not isinstance(curve, Line | ConicArc):
        raise ValueError(
            f"{type(curve).__name__} has no exact pcurve on this "
            f"{type(surface).__name__}: give it in Face.pcurves, or use Line or ConicArc."
        )
    offset = np.outer(surface.shift, [0.0, 0.0, 1.0])
    basis = np.asarray(np.linalg.inv(surface.linear) @ (curve.basis() - offset), dtype=np.float64)
    if isinstance(surface, Plane):
        return Pcurve(curve.kind, np.vstack([basis[:2], [0.0, 0.0, 1.0]]))
    if isinstance(surface, Sphere):
        return Pcurve(curve.kind, basis)
    if isinstance(surface, Cylinder | Cone):
        return _round_pcurve(curve, surface, basis)
    raise ValueError(f"No pcurve rule for {type(surface).__name__}.")


def _round_pcurve(curve: Curve, surface: Surface, basis: Array) -> Pcurve:
    if isinstance(curve, Line):
        middle = basis @ np.array([0.5 * (curve.first + curve.last), 0.0, 1.0])
        angle = float(np.arctan2(middle[1], middle[0]))
        matrix = np.array([[0.0, 0.0, angle], [basis[2, 0], 0.0, basis[2, 2]], [0.0, 0.0, 1.0]])
        return Pcurve(L.LINE, matrix)
    a, b = basis[:2, 0], basis[:2, 1]
    radius = np.linalg.norm(a)
    height = basis[2, 2]
    level = np.abs(basis[2, :2]).max() <= 1e-12 * max(1.0, abs(height))
    round_ = abs(a @ b) <= 1e-12 * radius**2 and abs(np.linalg.norm(b) - radius) <= 1e-12 * radius
    centred = np.linalg.norm(basis[:2, 2]) <= 1e-12 * radius
    if not (level and round_ and centred):
        raise ValueError(
            f"On a {type(surface).__name__} only sections square to its axis and generators have "
            "a line as pcurve; this conic arc is neither."
        )
    turn = 1.0 if a[0] * b[1] - a[1] * b[0] > 0.0 else -1.0
    phase = float(np.arctan2(a[1], a[0]))
    return Pcurve(L.LINE, np.array([[turn, 0.0, phase], [0.0, 0.0, height], [0.0, 0.0, 1.0]]))
