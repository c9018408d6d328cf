"""Other directions in which an overlap is as thin: a ball in the middle of a slab has two."""

from __future__ import annotations

import numpy as np

from standoff.bodies.body import Body
from standoff.kernels.entries import derivatives as kernels
from standoff.motion import Pose
from standoff.tracking.inputs import flat_pose
from standoff.tracking.reached import packed
from standoff.tracking.rows import motion_row
from standoff.typing import Array


def equal_normals(
    a: Body, b: Body, pose_a: Pose, pose_b: Pose, normal: Array, distance: float
) -> Array:
    """All normals found along which two overlapping bodies are as deep in each other.

    Parameters
    ----------
    normal, distance
        Of the answer: unit vector from A to B, world, and the signed distance, a length.

    Returns
    -------
    (k, 3) array
        Unit vectors, world, the answer's own first. Each is a local minimum of the depth within
        SAME_WIDTH of the size; they are apart by more than AROUND.
    """
    found = np.empty((kernels.N_NORMALS, 3))
    turn = pose_a.rotation
    own = tuple((turn.T @ normal).tolist())
    motion = motion_row(flat_pose(pose_a), flat_pose(pose_b))
    depth = distance + a.radius + b.radius
    count = kernels.equal_depths(packed(a, b), motion, own, depth, found)
    return np.vstack([normal, found[1:count] @ turn.T])
