"""Which faces are round kinds with a potential of their own."""

from __future__ import annotations

import numpy as np

from standoff.bodies.face_leaves import FaceChart
from standoff.geometry.curves import Curve, Line
from standoff.geometry.roundness import alike, square
from standoff.geometry.surface_curves import SurfaceCurve
from standoff.geometry.swept import Revolution
from standoff.kernels.body import layout as L
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.torus_potential import (
    AXIS_OF,
    CENTRE_OF,
    CIRCLE_OF,
    CONE_OF,
    TORUS_THROUGH,
)
from standoff.solids.spatial.tolerances import ROUND_KIND
from standoff.typing import Array


def natural_of(chart: FaceChart) -> tuple[int, Array]:
    """(kind, (sign, k1, k2, point, axis)) of a face's own potential, growing outward; of a turned
    face, which has none, the axis."""
    surface = chart.surface
    a, sign = surface.linear, chart.outward * float(np.sign(np.linalg.det(surface.linear)))
    lengths = np.linalg.norm(a, axis=0)
    if surface.kind == L.PLANE:
        normal = np.cross(a[:, 0], a[:, 1])
        normal = normal / np.linalg.norm(normal)
        return TORUS_THROUGH, np.array([chart.outward, 0.0, 0.0, *surface.shift, *normal])
    axis = a[:, 2] / lengths[2]
    flat = _equal(lengths[0], lengths[1]) and square(a, ROUND_KIND)
    if surface.kind == L.CYLINDER and flat:
        return AXIS_OF, np.array([sign, lengths[0], 0.0, *surface.shift, *axis])
    if surface.kind == L.CONE and flat:
        slant = np.hypot(lengths[0], lengths[2])
        cosine, sine = lengths[2] / slant, lengths[0] / slant
        return CONE_OF, np.array([sign, cosine, sine, *surface.shift, *axis])
    whole = flat and _equal(lengths[0], lengths[2])
    if surface.kind == L.TORUS and whole:
        major, minor = lengths[0] * surface.data
        return CIRCLE_OF, np.array([sign, major, minor, *surface.shift, *axis])
    if surface.kind == L.SPHERE and whole:
        return CENTRE_OF, np.array([sign, lengths[0], 0.0, *surface.shift, *axis])
    if isinstance(surface, Revolution) and flat:
        line = _of_turned_line(chart, surface, axis) if isinstance(surface.profile, Line) else None
        return line or (S.TURNED, np.array([sign, 0.0, 0.0, *surface.shift, *axis]))
    return S.NO_KIND, np.zeros(9)


def _of_turned_line(chart: FaceChart, surface: Revolution, axis: Array) -> tuple[int, Array] | None:
    """The same of a turned straight line: a flat ring, a cylinder or a cone."""
    _, _, v0, v1 = chart.rectangle
    ends = np.array([surface.jet(chart.rectangle[0], v)[0] - surface.shift for v in (v0, v1)])
    heights = ends @ axis
    radii = np.linalg.norm(ends - heights[:, None] * axis, axis=1)
    rise, widening = heights[1] - heights[0], radii[1] - radii[0]
    long = float(np.hypot(rise, widening))
    x, xu, xv, *_ = surface.jet(chart.rectangle[0], 0.5 * (v0 + v1))
    normal = chart.outward * np.cross(xu, xv)
    out = x - surface.shift - axis * ((x - surface.shift) @ axis)
    if abs(rise) <= ROUND_KIND * long:
        up = float(np.sign(normal @ axis))
        return TORUS_THROUGH, np.array([up, 0.0, 0.0, *surface.shift + heights[0] * axis, *axis])
    if abs(widening) <= ROUND_KIND * long:
        return AXIS_OF, np.array([np.sign(normal @ out), radii[0], 0.0, *surface.shift, *axis])
    if (radii <= ROUND_KIND * long).any():  # the apex itself: its radius is a rounding
        return None
    apex = surface.shift + axis * (heights[0] - radii[0] * rise / widening)
    along = axis * float(np.sign(rise * widening))
    cosine, sine = abs(rise) / long, abs(widening) / long
    sign = np.sign(normal @ (cosine * out / np.linalg.norm(out) - sine * along))
    return CONE_OF, np.array([sign, cosine, sine, *apex, *along])


def turned_axis(curve: Curve) -> tuple[Array, Array] | None:
    """(point, axis) of an edge that is a circle of a turned surface; None where it is not."""
    if not isinstance(curve, SurfaceCurve) or curve.pcurve.kind != L.LINE:
        return None
    level = curve.pcurve.matrix[1:, 0]
    surface = curve.surface
    turns = surface.kind in (L.CYLINDER, L.CONE, L.TORUS, L.REVOLUTION)
    a = surface.linear
    lengths = np.linalg.norm(a, axis=0)
    if level.any() or not (turns and _equal(lengths[0], lengths[1]) and square(a, ROUND_KIND)):
        return None
    return surface.shift, a[:, 2] / lengths[2]


def _equal(a: float, b: float) -> bool:
    return alike(a, b, ROUND_KIND)
