"""Polytopes whose vertices lie far from their own origin: accepted, told, distances kept."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import standoff as so
from standoff import shapes

Array = NDArray[np.float64]
EPS = float(np.finfo(float).eps)
TOWARDS = np.array([0.6, -0.48, 0.64])
CUBE = np.array([[i, j, k] for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)])
AWAY = [1.0, 1e4, 1e8, 1e10]


def cloud(rng: np.random.Generator, n: int = 20) -> Array:
    points = rng.normal(size=(n, 3))
    return points / np.linalg.norm(points, axis=1)[:, None]


def back(body_centre: Array, rng: np.random.Generator, near: float) -> tuple[so.Pose, so.Pose]:
    """A pose of the far body, and that of its image about its origin, at the same place."""
    R = Rotation.random(random_state=rng).as_matrix()
    place = near * rng.normal(size=3)
    return so.Pose(R, place - R @ body_centre), so.Pose(R, place)


@pytest.mark.parametrize("away", AWAY)
@pytest.mark.parametrize("kind", ["sharp", "rounded", "grown", "turned box"])
def test_as_far_as_the_same_polytope_at_its_origin(
    kind: str, away: float, rng: np.random.Generator
) -> None:
    centre = away * TOWARDS
    turned = CUBE @ Rotation.random(random_state=rng).as_matrix().T
    far_points = (turned if kind == "turned box" else cloud(rng)) + centre

    def make(points: Array) -> so.Body:
        if kind == "rounded":
            return shapes.rounded_polytope(points, 0.1)
        return shapes.polytope(points, rounding=0.1 if kind == "grown" else 0.0)

    far, near, other = make(far_points), make(far_points - centre), shapes.box(1.0, 0.7, 0.5)
    home = so.Pose(Rotation.random(random_state=rng).as_matrix(), (0.0, 0.0, 0.0))
    # the vertices, the pose and the product of the two are each rounded
    rounded = 1e-13 + 4.0 * EPS * away
    for k in range(6):
        pose, image = back(centre, rng, 3.0 if k % 3 else 0.3)
        answer, expected = (
            so.distance(far, other, pose, home),
            so.distance(near, other, image, home),
        )
        assert answer.certified
        assert answer.distance == pytest.approx(expected.distance, abs=rounded)
        assert answer.lower_bound <= expected.distance + 1e-13
        unproven = answer.distance - answer.lower_bound - far.check().slack
        assert unproven <= 1e-11 + 100.0 * EPS * away


@pytest.mark.parametrize("away", AWAY)
def test_two_boxes_in_closed_form(away: float, rng: np.random.Generator) -> None:
    """Boxes with parallel sides: the gaps along the axes are the legs of the distance."""
    one, two = away * TOWARDS, -away * TOWARDS[::-1]
    a, b = shapes.polytope(CUBE + one), shapes.polytope(2.0 * CUBE + two)
    for _ in range(6):
        between = rng.uniform(-4.0, 4.0, size=3)
        gaps = np.abs(between) - 1.5
        exact = gaps.max() if gaps.max() < 0.0 else np.linalg.norm(np.maximum(gaps, 0.0))
        answer = so.distance(a, b, so.Pose(np.eye(3), -one), so.Pose(np.eye(3), between - two))
        assert answer.certified
        assert answer.distance == pytest.approx(exact, abs=1e-13 + 4.0 * EPS * away)
        assert answer.lower_bound <= exact + 1e-13


def test_recentring_and_its_roundoff_are_told() -> None:
    near, far = shapes.polytope(CUBE), shapes.polytope(CUBE + 1e8 * TOWARDS)
    assert near.check().notes == ()
    assert near.check().coordinate_roundoff == 8.0 * EPS
    recentred, loose = far.check().notes
    assert recentred.startswith("recentred: the hull is computed about [ 60000000. -48000000.")
    assert loose.startswith("far from the origin: parts may miss each other by 2.27e-07")
    assert far.check().coordinate_roundoff == pytest.approx(16.0 * EPS * 0.64e8)
    assert far.check().sewing_tolerance == far.check().coordinate_roundoff
    assert far.check().slack == 0.0  # the certificate's own allowance covers it


def test_other_shapes_move_far_off_as_well() -> None:
    far = 1e8 * TOWARDS
    aside = np.array([3.0, 0.0, 0.0]) - far
    triangle = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]]) + far
    for body in (
        shapes.polygon(triangle),
        shapes.cylinder(0.5, 1.0).transformed((np.eye(3), far)),
        shapes.segment(start=far, end=far + np.array([0.0, 0.0, 1.0])),
    ):
        assert body.check().sewing_tolerance > 1e-7
        answer = so.distance(body, shapes.sphere(0.25), so.Pose(np.eye(3), aside), np.eye(4))
        assert answer.certified
        assert 1.7 < answer.distance < 2.8


def test_what_is_wrong_is_still_refused_far_off() -> None:
    """A vertex off its edge by a thousand times the roundoff of its coordinates."""
    a = 1e8 * TOWARDS
    b, missed = a + np.array([1.0, 0.0, 0.0]), a + np.array([1.0, 1e-3, 0.0])
    edge = so.bodies.Edge(so.geometry.Line(a, b), 0, 1)
    with pytest.raises(so.BodyError, match="Edge 0 misses its vertex 1"):
        so.Body.from_brep([a, missed], [edge])
