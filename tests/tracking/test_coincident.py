"""Bodies on top of each other: the same body at the same pose, concentric and crossing cores.

The least depth of a body in itself is its width; of a ball in the middle of a body of central
symmetry it is the ball's radius more than the inscribed ball's.
"""

import numpy as np
import pytest

import standoff as so
from oracles.exact_pairs import random_rotation
from standoff.geometry import ConicArc, RationalBezier, ellipsoid_patches

HOME = np.eye(4)
CUBE = [[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]

WIDTHS = {
    "sphere": (so.shapes.sphere(0.7), 1.4),
    "ball of patches": (so.shapes.ellipsoid(0.7, 0.7, 0.7), 1.4),
    "ellipsoid": (so.shapes.ellipsoid(1.0, 0.3, 0.6), 0.6),
    "plate": (so.shapes.ellipsoid(1.0, 1.0, 1e-4), 2e-4),
    "needle": (so.shapes.ellipsoid(1.0, 1e-4, 1e-4), 2e-4),
    "NURBS ellipsoid": (so.Body.from_patches(ellipsoid_patches(1.0, 0.3, 0.6)), 0.6),
    "box": (so.shapes.box(1.0, 2.0, 0.5), 0.5),
    "cube": (so.shapes.box(1.0, 1.0, 1.0), 1.0),
    "thin box": (so.shapes.box(1.0, 1.0, 1e-4), 1e-4),
    "rounded box": (so.shapes.box(1.0, 2.0, 0.5, 0.1), 0.5),
    "polytope": (so.shapes.polytope(np.array(CUBE) * [1.0, 0.8, 0.3]), 0.6),
    "cylinder": (so.shapes.cylinder(0.4, 1.0), 0.8),
    "disc": (so.shapes.cylinder(0.4, 0.1), 0.1),
    "capsule": (so.shapes.capsule(0.2, 1.0), 0.4),
    "sharp cone": (so.shapes.cone(0.3, 2.0), 1.2 / np.hypot(0.3, 2.0)),
    "flat cone": (so.shapes.cone(1.0, 0.5), 0.5),
    "half a ball": (so.shapes.cap(1.0, 0.0), 1.0),
    "superellipsoid": (so.shapes.superellipsoid(1.0, 0.5, 0.8, 0.5, 0.7), 1.0),
    "spindle": (so.shapes.spindle(0.3, 2.0), 0.6),
    "gore": (so.shapes.gore(0.3, 2.0, 4), 0.6 * np.cos(np.pi / 4)),
    "solid of revolution": (
        so.shapes.hull_of_revolution(RationalBezier([(1, 0, 0), (0.5, 0, 0.7), (0, 0, 0.7)])),
        0.7,
    ),
    "micrometre": (so.shapes.ellipsoid(1e-6, 0.3e-6, 0.6e-6), 0.6e-6),
    "megametre": (so.shapes.box(1e6, 2e6, 0.5e6), 0.5e6),
}
INSCRIBED = {
    "ellipsoid": (so.shapes.ellipsoid(1.0, 0.3, 0.6), 0.3),
    "NURBS ellipsoid": (so.Body.from_patches(ellipsoid_patches(1.0, 0.3, 0.6)), 0.3),
    "box": (so.shapes.box(1.0, 2.0, 0.5), 0.25),
    "cylinder": (so.shapes.cylinder(0.4, 1.0), 0.4),
    "capsule": (so.shapes.capsule(0.2, 1.0), 0.2),
    "sphere": (so.shapes.sphere(0.7), 0.7),
    "superellipsoid": (so.shapes.superellipsoid(1.0, 0.5, 0.8, 0.5, 0.7), 0.5),
    "spindle": (so.shapes.spindle(0.3, 2.0), 0.3),
}
EXACT = 1e-9
"""Error of a depth, relative."""


def assert_deep(answer, depth):
    numbers = [answer.distance, answer.lower_bound, answer.upper_bound, *answer.normal]
    assert np.isfinite([*numbers, *answer.point_a, *answer.point_b]).all()
    assert np.linalg.norm(answer.normal) == pytest.approx(1.0, abs=1e-12)
    assert answer.lower_bound <= -depth * (1 - 1e-9)
    assert answer.upper_bound >= -depth * (1 + 1e-9)
    assert answer.distance == pytest.approx(-depth, rel=EXACT)
    parted = answer.point_b - answer.point_a
    np.testing.assert_allclose(parted, answer.distance * answer.normal, atol=1e-6 * depth)
    assert answer.counts.searches >= 0
    assert answer.counts.restarts >= 0


@pytest.mark.parametrize("name", WIDTHS)
@pytest.mark.parametrize("turned", [False, True])
def test_a_body_in_itself(name, turned, rng):
    body, width = WIDTHS[name]
    pose = (random_rotation(rng), rng.normal(size=3) * body.size) if turned else HOME
    assert_deep(so.distance(body, body, pose, pose), width)


@pytest.mark.parametrize("name", ["ellipsoid", "box", "cylinder", "sphere", "NURBS ellipsoid"])
def test_a_body_tracked_into_itself(name):
    """From apart to the same pose in one jump, and out again."""
    body, width = WIDTHS[name]
    away = (np.eye(3), np.array([3.0, 0.2, 0.1]))
    tracker = so.Tracker(body, body)
    state = tracker.start(HOME, away)
    apart = state.proximity.distance
    state, answer = tracker.step(state, HOME, HOME)
    assert_deep(answer, width)
    state, answer = tracker.step(state, HOME, away)
    assert answer.certified
    assert answer.distance == pytest.approx(apart, abs=1e-12)


@pytest.mark.parametrize("name", INSCRIBED)
@pytest.mark.parametrize("radius", [1e-6, 0.1, 3.0])
def test_a_ball_in_the_middle(name, radius):
    body, inner = INSCRIBED[name]
    ball = so.shapes.sphere(radius)
    assert_deep(so.distance(body, ball, HOME, HOME), inner + radius)
    assert_deep(so.distance(ball, body, HOME, HOME), inner + radius)


@pytest.mark.parametrize("name", INSCRIBED)
def test_a_point_in_the_middle(name):
    body, inner = INSCRIBED[name]
    assert_deep(so.distance(body, so.shapes.point(), HOME, HOME), inner)


@pytest.mark.parametrize("offset", [0.0, 1e-300, 1e-30, 1e-16, 1e-12, 1e-8, 1e-3])
def test_concentric_spheres(offset):
    """flexible-collision-library/fcl #346: such a pair took for ever."""
    a, b = so.shapes.sphere(1.0), so.shapes.sphere(0.5)
    answer = so.distance(a, b, HOME, (np.eye(3), np.array([0.0, offset, 0.0])))
    assert_deep(answer, 1.5 - offset)
    if offset >= 1e-8:
        np.testing.assert_allclose(answer.normal, [0, 1, 0], atol=1e-6)


def test_coincident_points_are_zero_apart():
    answer = so.distance(so.shapes.point(), so.shapes.point(), HOME, HOME)
    assert answer.distance == 0.0
    assert np.linalg.norm(answer.normal) == pytest.approx(1.0)
    assert np.isfinite(answer.lower_bound)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-3, 0.7, np.pi / 2])
def test_crossing_capsules(angle):
    """Their cores meet: the depth is that of the radii, square to both axes."""
    a, b = so.shapes.capsule(0.2, 2.0), so.shapes.capsule(0.3, 1.0)
    c, s = np.cos(angle), np.sin(angle)
    turned = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    answer = so.distance(a, b, HOME, (turned, np.zeros(3)))
    assert_deep(answer, 0.5)
    assert abs(answer.normal[2]) <= 1e-6
    if angle > 1e-2:
        assert abs(answer.normal[1]) == pytest.approx(1.0, abs=1e-9)


def test_a_planar_body_in_itself():
    disc = so.shapes.planar_loop([ConicArc((0, 0), (0.7, 0), (0, 0.7))])
    answer = so.distance(disc, disc, HOME, HOME)
    assert_deep(answer, 1.4)
    assert answer.normal[2] == 0.0


@pytest.mark.parametrize("offset", [1e-6, 1e-4, 1e-2, 0.3])
def test_nearly_concentric_balls_of_patches(offset, rng):
    """The depth hardly varies with the direction: all but the exact way differ by the offset."""
    ball = so.shapes.ellipsoid(1, 1, 1)
    way = random_rotation(rng)[0]
    answer = so.distance(ball, ball, so.Pose.identity(), so.Pose.exp([0, 0, 0], offset * way))
    assert answer.distance == pytest.approx(offset - 2.0, abs=1e-13)
    assert np.linalg.norm(answer.normal - way) <= 4e-12 / offset + 1e-12
