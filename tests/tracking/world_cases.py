"""Poses and judgements that the cases of other libraries share."""

import numpy as np
import pytest

HOME = np.eye(4)


def at(x, y=0.0, z=0.0, rotation=None):
    turn = np.eye(3) if rotation is None else np.asarray(rotation, dtype=float)
    return turn, np.array([x, y, z], dtype=float)


def sink(pair, depth):
    """The pose of B moved along the normal of an exact pair until it is ``depth`` deep."""
    rotation, place = pair.pose_b
    n = pair.normal.astype(np.longdouble)
    return rotation, (place - (pair.distance + depth) * n).astype(float)


def about(axis, angle):
    c, s = np.cos(angle), np.sin(angle)
    i, j = [k for k in range(3) if k != axis]
    matrix = np.eye(3)
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -s, s, c
    return matrix


def assert_consistent(answer):
    """What holds for apart and overlapping bodies alike."""
    numbers = [answer.distance, answer.lower_bound, *answer.normal]
    assert np.isfinite([*numbers, *answer.point_a, *answer.point_b]).all()
    assert np.linalg.norm(answer.normal) == pytest.approx(1.0, abs=1e-14)
    assert answer.lower_bound <= answer.distance + 1e-14
    between = answer.point_b - answer.point_a
    np.testing.assert_allclose(between, answer.distance * answer.normal, atol=1e-8)
