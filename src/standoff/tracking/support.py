"""Support points: the farthest point of a body's core along a direction."""

from __future__ import annotations

import numpy as np

from standoff.bodies import shapes
from standoff.bodies.body import Body
from standoff.kernels.body import layout as L
from standoff.motion import Pose
from standoff.tracking.calls import FrameInput, start
from standoff.tracking.inputs import flat_pose
from standoff.tracking.laws import DEFAULT_LAW
from standoff.tracking.options import pack_options
from standoff.tracking.reached import table_of
from standoff.tracking.rows import StateRow
from standoff.typing import Array

# Turns a segment of the z axis into one of the y axis.
UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])


def sample_points(body: Body) -> Array:
    """The body's boundary samples, (n, 3), body frame."""
    n = int(body.ints[L.N_SAMPLES])
    start = int(body.ints[L.SAMPLE_REALS])
    rows = body.reals[start : start + L.SAMPLE_STRIDE * n].reshape(n, L.SAMPLE_STRIDE)
    return np.asarray(rows[:, :3])


def support_point(body: Body, direction: Array) -> Array:
    """The farthest point, (3,), of a body's core along a direction, in the body's frame.

    It is the witness point against a half-space (in the plane, a long segment) that lies off along
    the direction and perpendicular to it, from the kernels' cold query.
    """
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
    frame = FrameInput(flat_pose(Pose.identity()), flat_pose(Pose(facing, position)))
    found, _ = start(table_of(body, wall, pack_options(DEFAULT_LAW)), frame, StateRow())
    return np.asarray(found.point_a - body.radius * found.normal)
