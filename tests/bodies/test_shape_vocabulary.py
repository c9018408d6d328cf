"""How shapes are called: by position, by name, by the old names; rounding, and what it comes to."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import standoff as so
from draws import draws
from public_calls import SHAPES
from standoff import Body, shapes
from standoff.geometry import Line, Plane
from standoff.motion import ConstantTwist

HOME = np.eye(4)
TETRAHEDRON = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]]
TRIANGLE = [Line([0, 0], [1, 0]), Line([1, 0], [0, 1]), Line([0, 1], [0, 0])]

SPELLINGS: list[tuple[Callable[[], Body], Callable[[], Body]]] = [
    (lambda: shapes.box(1, 2, 3), lambda: shapes.box(size=(1, 2, 3))),
    (lambda: shapes.box(1, 2, 3, 0.1), lambda: shapes.box(size=[1, 2, 3], rounding=0.1)),
    (lambda: shapes.box(1, 2, 3, rounding=0.1), lambda: shapes.box((1, 2, 3), 0.1)),
    (lambda: shapes.ellipsoid(1, 2, 3), lambda: shapes.ellipsoid(semi_axes=np.array([1, 2, 3]))),
    (
        lambda: shapes.superellipsoid(1, 2, 3, 0.5, 1.5),
        lambda: shapes.superellipsoid(semi_axes=(1, 2, 3), exponents=(0.5, 1.5)),
    ),
    (
        lambda: shapes.superellipsoid((1, 2, 3), (0.5, 0.6)),
        lambda: shapes.superellipsoid(1, 2, 3, exponents=(0.5, 0.6)),
    ),
    (lambda: shapes.sphere(2), lambda: shapes.sphere(radius=2)),
    (lambda: shapes.capsule(2, 3), lambda: shapes.capsule(radius=2, length=3)),
    (lambda: shapes.cylinder(2, 3), lambda: shapes.cylinder(radius=2, height=3)),
    (lambda: shapes.cone(2, 3), lambda: shapes.cone(radius=2, height=3)),
    (
        lambda: shapes.planar_loop(TRIANGLE, 0.1),
        lambda: shapes.planar_loop(curves=TRIANGLE, rounding=0.1),
    ),
]
"""Two calls each that make the same body."""

GROWING = SHAPES.keys() - {"sphere_atlas", "box", "rounded_polytope", "planar_loop"}
"""Shapes that a rounding makes larger, but for the planar one."""


@pytest.mark.parametrize(("one", "other"), SPELLINGS)
def test_positions_and_names_make_the_same_body(
    one: Callable[[], Body], other: Callable[[], Body]
) -> None:
    assert one().digest == other().digest


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: shapes.box(rounding=0.1), r"needs size: give size=\(1\.0, 1\.0, 1\.0\)"),
        (lambda: shapes.box(1, 2, 3, size=(1, 2, 3)), "size by position and by name"),
        (lambda: shapes.ellipsoid(1, 2, 3, 4), "too many numbers"),
        (lambda: shapes.superellipsoid(1, 2, 3), "needs exponents"),
        (lambda: shapes.segment(), "takes length="),
        (lambda: shapes.segment(1.0, start=(0, 0, 0), end=(1, 0, 0)), "takes length="),
        (lambda: shapes.segment(start=(0, 0, 0)), "takes length="),
    ],
)
def test_arguments_missing_or_given_twice(make: Callable[[], Body], message: str) -> None:
    with pytest.raises(TypeError, match=message):
        make()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: shapes.ellipsoid(1, 2), r"semi_axes has shape \(2,\)"),
        (lambda: shapes.ellipsoid(1, -2, 3), r"semi_axes\[1\] = -2\.0: must be positive"),
        (lambda: shapes.box(size=(1, 2, 0)), r"size\[2\] = 0\.0: must be positive"),
        (lambda: shapes.superellipsoid(1, 2, 3, 0.5, 2), r"exponents\[1\] = 2\.0"),
        (lambda: shapes.halfspace((0, 0, 0)), "has no direction"),
        (lambda: shapes.cone(1, 1, rounding=-1), r"rounding = -1\.0"),
    ],
)
def test_numbers_at_fault_are_named(make: Callable[[], Body], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_every_shape_takes_a_rounding() -> None:
    for name in SHAPES.keys() - {"sphere_atlas"}:
        assert "rounding" in inspect.signature(getattr(shapes, name)).parameters, name


@pytest.mark.parametrize("name", sorted(GROWING))
def test_a_rounding_is_taken_off_every_distance(name: str, rng: np.random.Generator) -> None:
    """Points all round, outside the rounded body: its distance is the sharp one's less the ball."""
    make, arguments = getattr(shapes, name), {**SHAPES[name], "rounding": 0.0}
    sharp, rounded = make(**arguments), make(**{**arguments, "rounding": 0.25})
    assert rounded.radius == pytest.approx(sharp.radius + 0.25, abs=1e-15)
    for way in rng.normal(size=(6, 3)):
        pose = (np.eye(3), 6.0 * way / np.linalg.norm(way))
        one, other = (so.distance(b, shapes.point(), HOME, pose) for b in (sharp, rounded))
        if one.distance > 0.25:
            assert other.distance == pytest.approx(one.distance - 0.25, abs=1e-13)
            assert np.linalg.norm(other.point_a - one.point_a) == pytest.approx(0.25, abs=1e-13)


def test_a_box_keeps_its_size_when_it_is_rounded() -> None:
    for rounding in (0.0, 0.2):
        box = shapes.box(1, 2, 3, rounding)
        apart = so.distance(box, shapes.point(), HOME, (np.eye(3), [2.0, 0.0, 0.0]))
        assert apart.distance == pytest.approx(1.5, abs=1e-15)


def test_what_shapes_degenerate_to() -> None:
    assert shapes.sphere(0).digest == shapes.point().digest
    assert shapes.capsule(0.5, 0).digest == shapes.sphere(0.5).digest
    assert shapes.capsule(0, 2).digest == shapes.segment(2).digest
    assert shapes.capsule(0, 0).digest == shapes.segment(0).digest == shapes.point().digest
    assert shapes.segment(2, rounding=0.5).digest == shapes.capsule(0.5, 2).digest
    assert shapes.point(rounding=0.5).digest == shapes.sphere(0.5).digest
    there = shapes.segment(start=(1, 2, 3), end=(1, 2, 3))
    assert (there.n_vertices, there.n_edges) == (1, 0)
    np.testing.assert_array_equal(there.vertex_points, [[1, 2, 3]])


COORDINATES = st.floats(-2.0, 2.0).map(lambda x: round(x, 3))
POINTS = st.tuples(COORDINATES, COORDINATES, COORDINATES).map(np.array)


@settings(max_examples=draws(15), deadline=None)
@given(start=POINTS, end=POINTS, at=POINTS)
def test_a_segment_between_two_points(start: Any, end: Any, at: Any) -> None:
    """The distance of a point from it, in closed form."""
    body = shapes.segment(start=start, end=end)
    assert shapes.segment(start, end).digest == body.digest
    way = end - start
    share = np.clip((at - start) @ way / max(way @ way, 1e-300), 0.0, 1.0)
    exact = np.linalg.norm(at - start - share * way)
    answer = so.distance(body, shapes.point(), HOME, (np.eye(3), at))
    assert answer.distance == pytest.approx(exact, abs=1e-13)
    assert answer.lower_bound <= exact + 1e-15
    assert so.distance(shapes.point(), body, (np.eye(3), at), HOME).distance == pytest.approx(
        exact, abs=1e-13
    )


def test_the_half_space_that_was() -> None:
    plane = Plane.through(np.zeros(3), np.array([1.0, 0, 0]), np.array([0, 1.0, 0]))
    old = Body.from_brep(faces=[so.bodies.Face((plane,))], name="halfspace")
    assert shapes.halfspace().digest == old.digest == shapes.halfspace((0, 0, 5)).digest


@settings(max_examples=draws(15), deadline=None)
@given(
    normal=POINTS.filter(lambda n: np.linalg.norm(n) > 1e-2),
    offset=COORDINATES,
    at=POINTS,
    radius=st.sampled_from([0.0, 0.5]),
    rounding=st.sampled_from([0.0, 0.25]),
)
def test_a_half_space_of_any_normal(
    normal: Any, offset: float, at: Any, radius: float, rounding: float
) -> None:
    """Its signed distance from a ball in closed form, deep inside it too."""
    n = normal / np.linalg.norm(normal)
    exact = n @ at - offset - radius - rounding
    wall, ball = shapes.halfspace(normal, offset, rounding=rounding), shapes.sphere(radius)
    there = (np.eye(3), at)
    for answer, sense in (
        (so.distance(wall, ball, HOME, there), 1.0),
        (so.distance(ball, wall, there, HOME), -1.0),
    ):
        assert answer.distance == pytest.approx(exact, abs=1e-13)
        assert answer.lower_bound <= exact + 1e-15
        assert answer.certified
        np.testing.assert_allclose(answer.normal, sense * n, atol=1e-12)


def test_a_box_sinks_into_a_tilted_half_space(rng: np.random.Generator) -> None:
    """By its support point, from whatever side."""
    box, half = shapes.box(1, 2, 3), np.array([0.5, 1.0, 1.5])
    for _ in range(20):
        turn = so.Pose.from_wxyz(*_random_turn(rng)).rotation
        n = rng.normal(size=3)
        n /= np.linalg.norm(n)
        depth, offset = rng.uniform(-1.5, 1.5), rng.normal()
        away = n * (offset - depth + np.abs(turn.T @ n) @ half) + np.cross(n, rng.normal(size=3))
        wall = shapes.halfspace(n, offset)
        for answer in (
            so.distance(wall, box, HOME, (turn, away)),
            so.distance(box, wall, (turn, away), HOME),
        ):
            assert answer.distance == pytest.approx(-depth, abs=1e-12)
            assert answer.certified


def _random_turn(rng: np.random.Generator) -> tuple[Any, Any]:
    q = rng.normal(size=4)
    return q / np.linalg.norm(q), np.zeros(3)


def test_a_ball_falls_on_a_tilted_half_space() -> None:
    """The time of impact in closed form."""
    normal, offset, speed = np.array([0.6, 0.0, 0.8]), 0.5, 2.0
    wall, ball = shapes.halfspace(normal, offset), shapes.sphere(0.25)
    path = ConstantTwist((np.eye(3), 3.0 * normal), (-speed * normal, np.zeros(3)))
    for impact in (
        so.time_of_impact(wall, ball, so.Pose.identity(), path, 2.0),
        so.time_of_impact(ball, wall, path, so.Pose.identity(), 2.0),
    ):
        assert impact.time == pytest.approx((3.0 - offset - 0.25) / speed, abs=1e-9)
