"""Edges that cross just beside their ends, barely in contact: the normal turns by their offset."""

import numpy as np
import pytest

import standoff as so
from oracles.exact_pairs import random_rotation

HALF_A, HALF_B = np.array([0.5, 0.45, 0.12]), np.array([0.19, 0.05, 0.27])
POSES = 200
DT = 1e-3


def box(half):
    return so.shapes.box(*(2.0 * half))


def sat(rotation, place):
    """-s(n) of two boxes, greatest over the 15 axes of their faces and pairs of edges.

    Exact for boxes: the difference's facets have these normals. Greatest is the signed distance in
    penetration.
    """
    axes = [*np.eye(3), *rotation.T]
    for i in range(3):
        for j in range(3):
            across = np.cross(np.eye(3)[i], rotation[:, j])
            if np.linalg.norm(across) > 1e-6:
                axes.append(across / np.linalg.norm(across))
    reach = [np.abs(n) @ HALF_A + np.abs(rotation.T @ n) @ HALF_B - abs(n @ place) for n in axes]
    return -min(reach)


def crossing_pose(rng, offset, depth):
    """B's edge along its z crosses A's edge along y, both within `offset` of a corner."""
    for _ in range(1000):
        rotation = random_rotation(rng)
        normal = np.cross([0.0, 1.0, 0.0], rotation[:, 2])
        normal /= np.linalg.norm(normal)
        corner_a = np.sign(normal) * HALF_A
        corner_b = -np.sign(rotation.T @ normal) * HALF_B
        corner_a[1] = HALF_A[1] - offset * rng.uniform()
        corner_b[2] = HALF_B[2] - offset * rng.uniform()
        place = corner_a - rotation @ corner_b - depth * normal
        if sat(rotation, place) < -1e-3 * depth:
            return rotation, place
    raise AssertionError("no pose overlaps")


@pytest.mark.parametrize("depth", [1e-6, 1e-5, 1e-4])
@pytest.mark.parametrize("offset", [1e-5, 1e-3])
def test_the_depth_is_that_of_the_least_axis(offset, depth, rng):
    a, b = box(HALF_A), box(HALF_B)
    for _ in range(POSES):
        rotation, place = crossing_pose(rng, offset, depth)
        answer = so.distance(a, b, so.Pose.identity(), so.Pose(rotation, place))
        assert answer.status is so.Status.GLOBAL
        # the least of several minima within a thousandth may be another one
        truth = sat(rotation, place)
        assert abs(answer.distance - truth) <= 1e-13 + 1e-3 * depth
        between = answer.point_b - answer.point_a
        np.testing.assert_allclose(between, answer.distance * answer.normal, atol=1e-12)


def test_most_are_exact(rng):
    a, b = box(HALF_A), box(HALF_B)
    errors = []
    for _ in range(POSES):
        rotation, place = crossing_pose(rng, 1e-3, 1e-5)
        answer = so.distance(a, b, so.Pose.identity(), so.Pose(rotation, place))
        errors.append(abs(answer.distance - sat(rotation, place)))
    assert np.quantile(errors, 0.99) <= 1e-13


# Rotation vector and place of B, in two frames between which the bodies part.
PARTING = (
    (
        [-1.2184121840605742, -1.5904966727225824, 0.09976884238307224],
        [2.1165863378491654, -1.3601650883228376, 0.9999280670297185],
    ),
    (
        [-1.2184119657328865, -1.5904965898978096, 0.09976913226421245],
        [2.116586928076737, -1.3601646247547885, 0.999927530335101],
    ),
)


def test_apart_the_distance_is_that_of_the_points():
    """Rims that part: a plane separates by less than the points found first are apart."""
    a = so.shapes.cone(0.05974478236616555, 0.2622379103351199)
    b = so.shapes.cone(0.8468340159621636, 5.410321733878376)
    before, after = (so.Pose.exp(*place) for place in PARTING)
    tracker = so.Tracker(a, b, dt=DT)
    state = tracker.start(so.Pose.identity(), before)
    assert state.proximity.distance < 0.0
    _, answer = tracker.step(state, so.Pose.identity(), after)
    assert answer.status is so.Status.CONVERGED
    apart = np.linalg.norm(answer.point_b - answer.point_a)
    assert abs(apart - answer.distance) <= 1e-15
    cold = so.distance(a, b, so.Pose.identity(), after)
    assert answer.lower_bound <= cold.distance <= answer.distance + 1e-15
