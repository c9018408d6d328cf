"""A proof that two cores overlap, from their own support points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from standoff.bodies import shapes
from standoff.bodies.body import Body
from standoff.kernels import frame as K
from standoff.kernels import tracker as kernels
from standoff.motion import Pose
from standoff.tracking.inputs import NO_TWIST, flat_pose
from standoff.tracking.overlap import hulls_meet, sample_points

Array = NDArray[np.float64]
# Turns a segment of the z axis into one of the y axis.
UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])


def cores_overlap(a: Body, b: Body, flat_a: Array, flat_b: Array) -> bool:
    """Is it proven that two cores share a point: do the hulls of some of their points?

    flat_a and flat_b are world poses, 12 numbers each (R row-major, p).
    """
    turn_a, turn_b = flat_a[:9].reshape(3, 3), flat_b[:9].reshape(3, 3)
    shift = flat_b[9:] - flat_a[9:]
    if not a.bounded:
        return reaches_into(b, turn_a.T @ turn_b, turn_a.T @ shift)
    if not b.bounded:
        return reaches_into(a, turn_b.T @ turn_a, -(turn_b.T @ shift))
    points_a = sample_points(a) @ turn_a.T
    points_b = sample_points(b) @ turn_b.T + shift
    return hulls_meet(
        points_a,
        points_b,
        lambda w: turn_a @ support_point(a, turn_a.T @ w),
        lambda w: turn_b @ support_point(b, turn_b.T @ w) + shift,
    )


def support_point(body: Body, direction: Array) -> Array:
    """The farthest point, (3,), of a body's core along a direction, in the body's frame.

    The witness point against a half-space (in the plane, a long segment) that stands off along
    the direction, square to it.
    """
    from standoff.tracking.tracker import ColdQuery  # it asks for this proof itself

    n = direction / np.linalg.norm(direction)
    gap = body.size if body.size > 0.0 else 1.0
    position = float((sample_points(body) @ n).max() + gap) * n
    if body.dimension == 2:
        wall = shapes.segment(4.0 * gap).transformed(UPRIGHT)
        facing = np.array([[n[0], -n[1], 0.0], [n[1], n[0], 0.0], [0.0, 0.0, 1.0]])
    else:
        wall = shapes.halfspace()
        x = np.cross(np.eye(3)[int(np.abs(n).argmin())], n)
        x /= np.linalg.norm(x)
        facing = np.column_stack([x, np.cross(-n, x), -n])
    tracker = ColdQuery(body, wall)
    home, there = flat_pose(Pose.identity()), flat_pose(Pose(facing, position))
    data, out = np.zeros(K.N_STATE), np.empty(K.N_OUT)
    # The kernel itself: a tracker would ask for this proof again where it cannot certify the wall.
    kernels.start_anywhere(
        tracker.packed, home, there, NO_TWIST, NO_TWIST, False, tracker.options, data, 0, out
    )
    point, normal = out[K.POINT_A : K.POINT_A + 3], out[K.NORMAL : K.NORMAL + 3]
    return np.asarray(point - body.radius * normal)


def reaches_into(body: Body, rotation: Array, position: Array) -> bool:
    """Does a body come to z <= 0, a half-space's inside, when posed in the half-space's frame?

    Its lowest point below, or within the swept radius of, the plane proves it.
    """
    lowest = support_point(body, -rotation[2])
    return bool(rotation[2] @ lowest + position[2] <= body.radius)
