"""Other directions in which an overlap is as thin: a ball in the middle of a slab has two."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.kernels.body import layout as L
from standoff.motion import Pose
from standoff.tracking.calls import Frame, Pair, packed, start, step
from standoff.tracking.inputs import flat_pose
from standoff.tracking.laws import PredictorCorrector
from standoff.tracking.options import pack_options
from standoff.tracking.rows import StateRow
from standoff.tracking.status import Status
from standoff.tracking.tolerances import AROUND, SAME_WIDTH

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
        SAME_WIDTH of the size; they are apart by more than AROUND.
    """
    found = [normal]
    if not (a.bounded and b.bounded):
        return np.array(found)
    law = PredictorCorrector(predictor="none", depth="local")
    pair, options = packed(a, b), pack_options(law)
    size = float(a.reals[L.SIZE] + b.reals[L.SIZE]) + a.radius + b.radius
    starts = np.vstack([-normal[None], CUBE @ pose_a.rotation.T, CUBE @ pose_b.rotation.T])
    if a.dimension == 2 or b.dimension == 2:
        starts[:, 2] = 0.0
    for way in starts:
        length = float(np.linalg.norm(way))
        if length < AROUND:
            continue
        depth, n = _descent(pair, options, (pose_a, pose_b), way / length, size)
        near = min(float(np.linalg.norm(n - m)) for m in found) <= AROUND
        if abs(depth - distance) <= SAME_WIDTH * size and not near:
            found.append(n)
    return np.array(found)


def _descent(
    pair: Pair, options: Array, poses: tuple[Pose, Pose], n: Array, size: float
) -> tuple[float, Array]:
    """(signed distance, normal) of the local minimum of the depth below a direction; inf: none."""
    pose_a, pose_b = poses
    # apart along n the bodies' closest points are about the farthest along it
    far = size + float(np.linalg.norm(pose_b.translation - pose_a.translation))
    home, there = flat_pose(pose_a), flat_pose(pose_b)
    away = there.copy()
    away[9:] += 2.0 * far * n
    state = StateRow()
    start(pair, Frame(home, away), options, state)
    state.descend_from(pose_a.rotation.T @ n)
    found, _ = step(pair, Frame(home, there), 1.0, options, state)
    if found.status not in DEPTHS:
        return np.inf, n
    return float(found.distance), np.array(found.normal)
