"""Other directions in which an overlap is as thin: a ball in the middle of a slab has two."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.kernels import events as N
from standoff.kernels import frame as K
from standoff.kernels import layout as L
from standoff.kernels import tracker as kernels
from standoff.motion import Pose
from standoff.tracking.inputs import NO_TWIST, flat_pose
from standoff.tracking.normal_sets import AROUND, SAME
from standoff.tracking.status import Status

if TYPE_CHECKING:
    from standoff.tracking.tracker import Tracker

Array = NDArray[np.float64]

CUBE = np.array([w for w in product((-1.0, 0.0, 1.0), repeat=3) if any(w)])
"""A descent starts along each of a cube's faces, edges and corners, in both bodies' frames."""

DEPTHS = (float(Status.LOCAL.value), float(Status.GLOBAL.value))


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
        SAME of the size; they are apart by more than AROUND.
    """
    from standoff.tracking.tracker import Tracker  # its answers ask for this

    found = [normal]
    if not (a.bounded and b.bounded):
        return np.array(found)
    tracker = Tracker(a, b, predictor="none", depth="local")
    size = float(a.reals[L.SIZE] + b.reals[L.SIZE]) + a.radius + b.radius
    starts = np.vstack([-normal[None], CUBE @ pose_a.rotation.T, CUBE @ pose_b.rotation.T])
    if tracker.planar:
        starts[:, 2] = 0.0
    for start in starts:
        length = float(np.linalg.norm(start))
        if length < AROUND:
            continue
        depth, n = _descent(tracker, pose_a, pose_b, start / length, size)
        near = min(float(np.linalg.norm(n - m)) for m in found) <= AROUND
        if abs(depth - distance) <= SAME * size and not near:
            found.append(n)
    return np.array(found)


def _descent(
    tracker: Tracker, pose_a: Pose, pose_b: Pose, n: Array, size: float
) -> tuple[float, Array]:
    """(signed distance, normal) of the local minimum of the depth below a direction; inf: none."""
    # apart along n the bodies' closest points are about the farthest along it
    far = size + float(np.linalg.norm(pose_b.translation - pose_a.translation))
    home, there = flat_pose(pose_a), flat_pose(pose_b)
    away = there.copy()
    away[9:] += 2.0 * far * n
    data, out = np.zeros(K.N_STATE), np.empty(K.N_OUT)
    events = np.empty(N.MAX_EVENTS * N.EVENT_COLUMNS)
    still = (NO_TWIST, NO_TWIST, False)
    kernels.start(tracker.packed, home, away, *still, tracker.options, data, 0, out)
    data[K.INSIDE], data[K.LAST_NORMAL : K.LAST_NORMAL + 3] = 1.0, pose_a.rotation.T @ n
    kernels.step(tracker.packed, home, there, *still, 1.0, tracker.options, data, out, events)
    if out[K.STATUS] not in DEPTHS:
        return np.inf, n
    return float(out[K.DISTANCE]), out[K.NORMAL : K.NORMAL + 3].copy()
