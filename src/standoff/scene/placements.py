"""From a table with a position and an orientation to a pose."""

from __future__ import annotations

import numpy as np

from standoff.motion import Pose
from standoff.scene.reader import SceneTable
from standoff.typing import Array

ORIENTATIONS = (
    *("quaternion_wxyz", "quaternion_xyzw", "rotation_vector", "rotation_vector_degrees"),
    *("angle", "angle_degrees", "matrix"),
)
"""The ways to write an orientation; a pose uses at most one of them."""

POSE_KEYS = ("position", *ORIENTATIONS)
"""Every key of a pose."""


def read_pose(table: SceneTable) -> Pose:
    """Return the pose that a table describes, the identity where nothing is said.

    Raises SceneError: at an unknown key, two orientations, or one that is not a rotation.

    Parameters
    ----------
    table : SceneTable
        With optionally ``position`` and one of `ORIENTATIONS`.
    """
    table.expect(*POSE_KEYS)
    position = in_space(table, "position") if "position" in table else np.zeros(3)
    given = table.only_one(ORIENTATIONS)
    if given is None:
        return table.build(lambda: Pose(np.eye(3), position), "position")
    return table.build(lambda: _oriented(table, given, position), given)


def in_space(table: SceneTable, key: str) -> Array:
    """Return a vector of three numbers; two lie in the plane z = 0."""
    vector = table.vector(key, (2, 3))
    return np.append(vector, 0.0) if len(vector) == 2 else vector


def _oriented(table: SceneTable, given: str, position: Array) -> Pose:
    if given == "quaternion_wxyz":
        return Pose.from_wxyz(table.vector(given, 4), position)
    if given == "quaternion_xyzw":
        return Pose.from_xyzw(table.vector(given, 4), position)
    if given == "rotation_vector":
        return Pose.exp(table.vector(given, 3), position)
    if given == "rotation_vector_degrees":
        return Pose.exp(np.radians(table.vector(given, 3)), position)
    if given == "angle":
        return Pose.exp((0.0, 0.0, table.number(given)), position)
    if given == "angle_degrees":
        return Pose.exp((0.0, 0.0, np.radians(table.number(given))), position)
    return _from_matrix(table, position)


def _from_matrix(table: SceneTable, position: Array) -> Pose:
    matrix = table.matrix("matrix", ((3, 3), (4, 4)))
    if matrix.shape == (3, 3):
        return Pose(matrix, position)
    if "position" in table:
        raise table.error("a 4×4 matrix holds the position already: remove 'position'", "matrix")
    return Pose.of(matrix)
