"""Homogeneous matrices of frames, and the Jacobians of many."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.motion import Pose
from standoff.robots.kinematics import GeometryMotion
from standoff.typing import Array


def frame(rotation: Any, translation: Any) -> Array:
    """(4, 4), of a rotation and a translation."""
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = rotation, translation
    return found


def frames(rotations: Array, translations: Array) -> Array:
    """(n, 4, 4), of (n, 3, 3) and (n, 3)."""
    found = np.zeros((len(rotations), 4, 4))
    found[:, :3, :3], found[:, :3, 3], found[:, 3, 3] = rotations, translations, 1.0
    return found


def from_wxyz(quaternion: Any) -> Array:
    """(3, 3), of a quaternion with the scalar first."""
    return np.asarray(Pose.from_wxyz(quaternion).rotation)


def jacobians_of(motion: GeometryMotion, support: Array, fold: Array | None) -> Array:
    """(n, 6, nv): (v, omega) of the origins of n frames by the velocity."""
    origins, omega = motion.poses[:, :3, 3], motion.screws[3:].T
    v = motion.screws[:3].T + np.cross(omega[None], origins[:, None])
    found = np.concatenate([v, np.broadcast_to(omega, v.shape)], axis=2) * support[:, :, None]
    found = found.transpose(0, 2, 1)
    return np.ascontiguousarray(found if fold is None else found @ fold)
