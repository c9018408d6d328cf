"""How many normals a pair that touches or overlaps has: one, a curve of them, or a region."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy

from standoff.bodies.body import Body
from standoff.kernels.body import layout as L
from standoff.kernels.tolerances import AROUND, SAME_WIDTH
from standoff.motion import Pose
from standoff.tracking.support import support_point
from standoff.tracking.tolerances import LEAST_WIDTH_ANGLE
from standoff.typing import Array

DIRECTIONS = 24
"""Directions around the normal that are tried first."""

WORTH_A_SEARCH = 0.2
"""A least width among the directions is searched between them if it is below this part of the
greatest: between two of 24 a width that grows linearly from zero is at most 0.13 of it."""


def normal_dimension(a: Body, b: Body, pose_a: Pose, pose_b: Pose, normal: Array) -> int:
    """The dimension of the set of normals, near one, along which the overlap is as thin.

    Parameters
    ----------
    normal : (3,) array
        Unit vector from A to B, world, along which the overlap has a least width.

    Returns
    -------
    int
        0: this normal only; 1: a curve of normals, such as a circle; 2: a region of the sphere.
    """
    if not (a.bounded and b.bounded):
        return 0
    size = float(a.reals[L.SIZE] + b.reals[L.SIZE]) + a.radius + b.radius
    excess = _excess(a, b, pose_a, pose_b, normal)
    if a.dimension == 2 or b.dimension == 2:
        return int(min(excess(1.0, 0.0), excess(-1.0, 0.0)) <= SAME_WIDTH * size)

    def around(angle: float) -> float:
        return excess(float(np.cos(angle)), float(np.sin(angle)))

    angles = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    found = np.array([around(t) for t in angles])
    low = found <= SAME_WIDTH * size
    if (low & np.roll(low, 1)).any():
        return 2
    if low.any():
        return 1
    step = angles[1]
    for k in np.flatnonzero((found <= np.roll(found, 1)) & (found <= np.roll(found, -1))):
        if found[k] < WORTH_A_SEARCH * found.max():
            bounds = (angles[k] - step, angles[k] + step)
            least = scipy.optimize.minimize_scalar(
                around, bounds=bounds, method="bounded", options={"xatol": LEAST_WIDTH_ANGLE}
            )
            if least.fun <= SAME_WIDTH * size:
                return 1
    return 0


def _excess(
    a: Body, b: Body, pose_a: Pose, pose_b: Pose, normal: Array
) -> Callable[[float, float], float]:
    """How much wider the overlap is along a normal turned by AROUND, by the turn's direction."""
    first = np.cross(normal, np.eye(3)[int(np.abs(normal).argmin())])
    if a.dimension == 2 or b.dimension == 2:
        first = np.cross([0.0, 0.0, 1.0], normal)
    first = first / np.linalg.norm(first)
    second = np.cross(normal, first)
    shift = pose_b.translation - pose_a.translation

    def width(n: Array) -> float:
        x = pose_a.rotation @ _highest(a, pose_a.rotation.T @ n)
        y = pose_b.rotation @ _highest(b, -(pose_b.rotation.T @ n))
        return float((x - y - shift) @ n)

    own = width(normal)

    def excess(cosine: float, sine: float) -> float:
        aside = cosine * first + (sine * second if sine else 0.0)
        return width(np.cos(AROUND) * normal + np.sin(AROUND) * aside) - own

    return excess


def _highest(body: Body, direction: Array) -> Array:
    """The farthest point of a core along a direction, body frame."""
    if not (body.face_parts or body.edge_parts):
        return np.asarray(body.vertex_points[0])
    return support_point(body, direction)
