"""Which faces are round kinds with a potential of their own."""

from __future__ import annotations

import numpy as np

from standoff.bodies.face_leaves import FaceChart
from standoff.geometry.curves import ConicArc
from standoff.geometry.validation import Array
from standoff.kernels.body import layout as L
from standoff.kernels.solids.torus_potential import (
    AXIS_OF,
    CENTRE_OF,
    CIRCLE_OF,
    CONE_OF,
    TORUS_THROUGH,
)
from standoff.solids.spatial.tolerances import ROUND_KIND


def natural_of(chart: FaceChart) -> tuple[int, Array]:
    """(kind, (sign, k1, k2, point, axis)) of a face's own potential, growing outward; -1: none."""
    surface = chart.surface
    a, sign = surface.linear, chart.outward * float(np.sign(np.linalg.det(surface.linear)))
    lengths = np.linalg.norm(a, axis=0)
    if surface.kind == L.PLANE:
        normal = np.cross(a[:, 0], a[:, 1])
        normal = normal / np.linalg.norm(normal)
        return TORUS_THROUGH, np.array([chart.outward, 0.0, 0.0, *surface.shift, *normal])
    axis = a[:, 2] / lengths[2]
    gram = a.T @ a
    flat = _equal(lengths[0], lengths[1]) and _square(gram, lengths)
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
    return -1, np.zeros(9)


def round_arc(curve: ConicArc) -> bool:
    """Is an arc a part of a circle?"""
    a = curve.basis()[:, :2]
    lengths = np.linalg.norm(a, axis=0)
    square = abs(float(a[:, 0] @ a[:, 1])) <= ROUND_KIND * lengths[0] * lengths[1]
    return square and _equal(lengths[0], lengths[1])


def _equal(a: float, b: float) -> bool:
    return bool(abs(a - b) <= ROUND_KIND * max(abs(a), abs(b)))


def _square(gram: Array, lengths: Array) -> bool:
    off = np.abs(gram) / np.outer(lengths, lengths)
    return bool(max(off[0, 1], off[0, 2], off[1, 2]) <= ROUND_KIND)
