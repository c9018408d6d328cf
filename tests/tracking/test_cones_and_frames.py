"""Normal cones of vertices with many faces, and bodies far from their own origins."""

import numpy as np
import pytest
from numba import njit
from scipy.optimize import nnls

import standoff as so
from standoff.kernels.compiler.decorators import pointer
from standoff.kernels.pair.certificate import vertex_cone

AT_REST = so.Pose(np.eye(3))


@njit
def nearest_normal(ints, reals, feature, n):
    # kernels are compiled for pointers
    return vertex_cone(pointer(ints, 0), pointer(reals, 0), feature, n)


def pyramid(sides, rng):
    """A pyramid whose facets come in no order, its apex and the normals of its sides."""
    angles = 2 * np.pi * (np.arange(sides) + rng.uniform(-0.3, 0.3, sides)) / sides
    base = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(sides)])
    apex = np.array([0.1, -0.05, 1.2])
    normals = []
    for p, q in zip(base, np.roll(base, -1, axis=0), strict=True):
        n = np.cross(q - p, apex - p)
        normals.append(n / np.linalg.norm(n))
    return so.shapes.polytope(rng.permutation(np.vstack([base, apex]))), apex, np.array(normals)


@pytest.mark.parametrize("sides", [4, 5, 7, 12])
def test_a_vertex_of_many_faces_certifies_its_whole_cone(sides, rng):
    body, apex, normals = pyramid(sides, rng)
    for _ in range(60):
        n = rng.dirichlet(np.ones(sides)) @ normals
        n /= np.linalg.norm(n)
        point = apex + rng.uniform(0.01, 3) * n
        answer = so.distance(body, so.shapes.point(), AT_REST, so.Pose(np.eye(3), point))
        assert answer.status is so.Status.CONVERGED
        assert answer.feature_a.kind == "vertex"
        np.testing.assert_allclose(answer.point_a, apex, atol=1e-15)


@pytest.mark.parametrize("sides", [4, 5, 7, 12])
def test_outside_a_cone_the_nearest_normal_is_found(sides, rng):
    body, apex, normals = pyramid(sides, rng)
    k = int(np.abs(body.vertex_points - apex).sum(axis=1).argmin())
    feature = body.n_faces + body.n_edges + k
    for _ in range(60):
        i = rng.integers(sides)
        s = rng.uniform()
        rim = (1 - s) * normals[i] + s * normals[(i + 1) % sides]
        n = rim + rng.uniform(0, 0.05) * (rim - normals.mean(axis=0))
        n /= np.linalg.norm(n)
        weights, _ = nnls(normals.T, n)
        nearest = weights @ normals / np.linalg.norm(weights @ normals)
        found = np.array(nearest_normal(body.ints, body.reals, feature, tuple(n)))
        assert abs(np.linalg.norm(found) - 1) <= 1e-14
        assert found @ n >= nearest @ n - 1e-12


FAR = np.array([3e5, -2e5, 4e5])
"""A hundred thousand sizes from the origin: five digits of float64 are lost there."""


@pytest.mark.parametrize(
    "body",
    [so.shapes.ellipsoid(1, 0.5, 0.3), so.shapes.lens(1, 0.4), so.shapes.box(1, 2, 0.5)],
    ids=lambda body: body.name,
)
def test_a_body_far_from_its_origin_answers_as_near_it(body, rng):
    other = so.shapes.ellipsoid(0.4, 0.9, 0.6)
    moved = body.transformed((np.eye(3), FAR))
    for _ in range(40):
        at = so.Pose(np.eye(3), rng.normal(size=3) + 3 * rng.choice([-1, 1], 3))
        near = so.distance(body, other, AT_REST, at)
        far = so.distance(moved, other, so.Pose(np.eye(3), -FAR), at)
        assert near.status is far.status is so.Status.CONVERGED
        noise = 64 * np.finfo(float).eps * np.linalg.norm(FAR)
        assert abs(far.distance - near.distance) <= noise
        assert far.lower_bound <= near.distance + 1e-14
