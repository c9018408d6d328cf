"""Signed distances of points from solids, against profiles and boxes in closed form."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from families.solid_shapes import BRACKET, ball, bolt, bracket, ring

PROFILE = np.array([[0, 0], [1, 0], [1, 3], [2, 3], [2, 4], [0, 4]], dtype=float)


def from_chain(points: np.ndarray, chain: np.ndarray) -> np.ndarray:
    """Distances in the plane from the links of a chain."""
    least = np.full(len(points), np.inf)
    for a, b in pairwise(chain):
        s = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
        least = np.minimum(least, np.linalg.norm(points - a - s[:, None] * (b - a), axis=1))
    return least


def bolt_truth(points: np.ndarray) -> np.ndarray:
    flat = np.column_stack([np.hypot(points[:, 0], points[:, 1]), points[:, 2]])
    rho, z = flat.T
    inside = ((z >= 0) & (z <= 3) & (rho <= 1)) | ((z >= 3) & (z <= 4) & (rho <= 2))
    return np.where(inside, -1.0, 1.0) * from_chain(flat, PROFILE)


def bracket_truth(points: np.ndarray) -> np.ndarray:
    x, y, z = points.T
    inside = (x > 0) & (y > 0) & (((x < 2) & (y < 0.4)) | ((x < 0.4) & (y < 1.5)))
    chain = np.array([*BRACKET, BRACKET[0]])
    flat = np.where(inside, -1.0, 1.0) * from_chain(points[:, :2], chain)
    up = np.maximum(-z, z - 0.7)
    outside = np.hypot(np.maximum(flat, 0.0), np.maximum(up, 0.0))
    return np.where((flat < 0) & (up < 0), np.maximum(flat, up), outside)


CASES = {
    "bolt": (bolt, bolt_truth, (-3, -3, -1), (3, 3, 5)),
    "bracket": (bracket, bracket_truth, (-0.5, -0.5, -0.5), (2.5, 2, 1.2)),
    "ball": (lambda: ball(1.0), lambda p: np.linalg.norm(p, axis=1) - 1.0, (-2,) * 3, (2,) * 3),
    "ring": (
        lambda: ring(1.2, 0.3),
        lambda p: np.hypot(np.hypot(p[:, 0], p[:, 1]) - 1.2, p[:, 2]) - 0.3,
        (-2, -2, -1),
        (2, 2, 1),
    ),
}


NAMES = [pytest.param(n, marks=pytest.mark.soak) if n == "ring" else n for n in CASES]


@pytest.mark.parametrize("name", NAMES)
def test_signed_distances_are_proven_and_right(name, rng) -> None:
    make, truth, low, high = CASES[name]
    solid = make()
    points = rng.uniform(low, high, (60, 3))
    told = solid.signed_distance(points)
    exact = truth(points)
    np.testing.assert_allclose(told.distance, exact, atol=1e-12)
    assert told.converged.all()
    assert (told.lower_bound - 1e-14 <= exact).all()
    assert (exact <= told.upper_bound + 1e-14).all()
    np.testing.assert_array_equal(solid.contains(points), exact <= 0.0)
    step = points + 1e-6 * told.gradient
    slope = (truth(step) - exact) / 1e-6
    np.testing.assert_allclose(slope[told.smooth], 1.0, atol=1e-5)


def test_points_on_the_boundary_and_at_a_vertex() -> None:
    told = bracket().signed_distance([[1.0, 0.0, 0.3], [2.0, 0.4, 0.7], [2.1, 0.5, 0.8]])
    np.testing.assert_allclose(told.distance, [0.0, 0.0, 0.1 * np.sqrt(3)], atol=1e-12)
    assert not told.smooth[:2].any()


def test_what_is_no_point_is_refused() -> None:
    with pytest.raises(ValueError, match="points"):
        bracket().signed_distance([[0.0, 0.0, np.nan]])
    with pytest.raises(ValueError, match="points"):
        bracket().contains([[0.0, 0.0]])
