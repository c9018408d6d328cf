"""Flat polygons in space: distances and depths by brute force, both ways round, and tracked."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import standoff as so
from draws import draws
from oracles.flat_shapes import signed_distance
from standoff import BodyError, shapes

Array = NDArray[np.float64]
HOME = np.eye(4)
TRIANGLE = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
CORNERS = np.array([[i, j, k] for i in (-0.5, 0.5) for j in (-1.0, 1.0) for k in (-1.5, 1.5)])


def random_triangle(rng: np.random.Generator) -> Array:
    """Not too narrow."""
    while True:
        points = rng.normal(size=(3, 3))
        area = np.linalg.norm(np.cross(points[1] - points[0], points[2] - points[0]))
        if area > 0.3:
            return points


def check(a: so.Body, b: so.Body, exact: float, size: float = 1.0) -> None:
    """Distance, bound and swap symmetry."""
    answer, swapped = so.distance(a, b, HOME, HOME), so.distance(b, a, HOME, HOME)
    for one in (answer, swapped):
        assert one.distance == pytest.approx(exact, abs=1e-12 * size), one
        assert one.lower_bound <= exact + 1e-13 * size
        assert one.certified, one
    gap = answer.point_b - answer.point_a
    np.testing.assert_allclose(gap, answer.distance * answer.normal, atol=1e-11 * size)


@pytest.mark.parametrize(
    ("at", "exact"),
    [
        ([0.2, 0.2, 1.0], 1.0),
        ([0.2, 0.2, -1.0], 1.0),
        ([2.0, 0.0, 0.0], 1.0),
        ([-1.0, -1.0, 0.0], np.sqrt(2.0)),
        ([-1.0, 0.3, 0.2], np.hypot(1.0, 0.2)),
        ([0.8, 0.8, 0.3], np.hypot(0.6 / np.sqrt(2.0), 0.3)),
        ([0.3, 0.3, 0.0], 0.0),
    ],
)
def test_points_round_a_triangle(at: list[float], exact: float) -> None:
    there = shapes.point().transformed((np.eye(3), np.array(at)))
    check(shapes.polygon(TRIANGLE), there, exact)


def test_triangles_apart_and_through_one_another(rng: np.random.Generator) -> None:
    inside = 0
    for k in range(60):
        p, q = random_triangle(rng), random_triangle(rng) + (k % 3) * rng.normal(size=3)
        exact = signed_distance(p, q)
        inside += exact < 0.0
        check(shapes.polygon(p), shapes.polygon(q), exact)
    assert 5 < inside < 55


def test_a_triangle_and_a_box(rng: np.random.Generator) -> None:
    box = shapes.box(1.0, 2.0, 3.0)
    for k in range(20):
        p = random_triangle(rng) + (k % 3) * rng.normal(size=3)
        check(shapes.polygon(p), box, signed_distance(p, CORNERS))


COORDINATES = st.integers(-8, 8).map(lambda x: 0.25 * x)
TRIANGLES = st.lists(st.tuples(*3 * [COORDINATES]), min_size=3, max_size=3).map(np.array)


def wide(points: Array) -> bool:
    return bool(np.linalg.norm(np.cross(points[1] - points[0], points[2] - points[0])) > 0.1)


@settings(max_examples=draws(25), deadline=None)
@given(p=TRIANGLES.filter(wide), q=TRIANGLES.filter(wide))
def test_triangles_of_round_numbers(p: Array, q: Array) -> None:
    """Coplanar, parallel, touching, with sides in common."""
    exact = signed_distance(p, q)
    for one in (
        so.distance(shapes.polygon(p), shapes.polygon(q), HOME, HOME),
        so.distance(shapes.polygon(q), shapes.polygon(p), HOME, HOME),
    ):
        assert one.distance == pytest.approx(exact, abs=1e-9)
        assert one.lower_bound <= exact + 1e-12


def test_a_quadrilateral_by_any_order_and_pose(rng: np.random.Generator) -> None:
    """Points inside the hull are left out; a map of the body is the body of the mapped points."""
    flat = np.array([[0, 0], [2, 0], [2, 1], [0, 1], [1, 0.5], [1, 0]], dtype=float)
    frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    points = flat @ frame[:, :2].T + rng.normal(size=3)
    body = shapes.polygon(points)
    assert body.n_vertices == 4
    np.testing.assert_allclose(body.vertex_points, points[:4], atol=1e-15)
    ways = rng.normal(size=(5, 3)) * 2.0
    moved = body.transformed((2.0 * np.eye(3), np.array([1.0, 2.0, 3.0])))
    for x in ways:
        exact = signed_distance(points[:4], x[None])
        check(body, shapes.point().transformed((np.eye(3), x)), exact)
        twice = 2.0 * x + [1.0, 2.0, 3.0]
        check(moved, shapes.point().transformed((np.eye(3), twice)), 2.0 * exact, 10.0)


def test_a_rounded_triangle_is_a_plate() -> None:
    plate = shapes.polygon(TRIANGLE, rounding=0.25)
    for at, exact in (([0.2, 0.2, 1.0], 0.75), ([-1.0, 0.3, 0.0], 0.75), ([0.2, 0.2, 0.1], -0.15)):
        answer = so.distance(plate, shapes.point(), HOME, (np.eye(3), at))
        assert answer.distance == pytest.approx(exact, abs=1e-14)


def test_a_triangle_is_tracked_through_a_box() -> None:
    """Frame by frame as a cold query would answer."""
    a, b = shapes.polygon(TRIANGLE), shapes.box(1.0, 2.0, 3.0)
    tracker = so.Tracker(a, b, 1e-2)
    poses = [so.Pose.exp([0.1 + t, 0.5 * t, 1.3 * t], [2.0 - 2.0 * t, 0.3, 0.1]) for t in TIMES]
    state = tracker.start(poses[0], HOME)
    for pose in poses[1:]:
        state, answer = tracker.step(state, pose, HOME)
        corners = TRIANGLE @ pose.rotation.T + pose.translation
        assert answer.distance == pytest.approx(signed_distance(corners, CORNERS), abs=1e-9)


TIMES = np.linspace(0.0, 1.0, 60)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([[0, 0, 0], [1, 0, 0]], "2 vertices: give at least three"),
        ([[0, 0, 0], [1, 1, 1], [2, 2, 2]], "on one line"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1e-3]], "not in one plane: "),
    ],
)
def test_what_is_no_polygon(points: Any, message: str) -> None:
    with pytest.raises(BodyError, match=message) as caught:
        shapes.polygon(points)
    assert caught.value.argument == "vertices"


def test_points_moved_into_their_plane_are_told() -> None:
    flat = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    assert shapes.polygon(flat).check().notes == ()
    flat[2, 2] = 4e-10
    (note,) = shapes.polygon(flat).check().notes
    assert note == "4 vertices off their common plane by up to 1e-10: moved into it"
