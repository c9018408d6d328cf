"""What other libraries answered wrongly of bodies apart, swapped, sliding or touching; made anew.

Issue numbers tell where a case was reported. Truth is a closed form, a construction from support
points in extended precision, or arithmetic of 40 digits.
"""

import numpy as np
import pytest

import standoff as so
from families.shapes import SOLIDS, point
from oracles.bounds import maximise_separation
from oracles.exact_pairs import exact_pair, random_normal, random_rotation
from standoff_studies import oracles as oracle
from standoff_studies.oracles import Placed
from tracking.world_cases import HOME, about, assert_consistent, at, sink

EPS = float(np.finfo(float).eps)
SLIDE = 1e-13
"""Roundoff of kissing bodies, over the size: 969 of 972 were right to 1e-15, the rest to 1.4e-14;
below a gap of 1e-13 points that are apart may also slide that far to the side."""
REST = (np.zeros(3), np.zeros(3))


# Nearest points that differ when the pair is swapped: dimforge/parry #431 (two boxes), fcl #504.
def test_swapped_boxes_of_the_report():
    a, b = so.shapes.box(2.0, 2.0, 2.0), so.shapes.box(2.0, 4.0, 2.0)
    one, two = so.distance(a, b, HOME, at(-5.573167)), so.distance(b, a, at(-5.573167), HOME)
    assert one.distance == two.distance == pytest.approx(3.573167, abs=1e-15)


def swapped_alike(a, b, pose_a, pose_b, size):
    one, two = so.distance(a, b, pose_a, pose_b), so.distance(b, a, pose_b, pose_a)
    assert two.status is one.status
    assert two.distance == pytest.approx(one.distance, abs=1e-12 * size)
    np.testing.assert_allclose(two.normal, -one.normal, atol=1e-8)
    np.testing.assert_allclose(two.point_a, one.point_b, atol=1e-8 * size)
    np.testing.assert_allclose(two.point_b, one.point_a, atol=1e-8 * size)


@pytest.mark.parametrize("number", range(len(SOLIDS)))
def test_swapped_solids(number, rng):
    """Random normals meet one point each, so the nearest points are unique."""
    for _ in range(3):
        first = SOLIDS[number](rng)
        second = SOLIDS[rng.integers(len(SOLIDS))](rng)
        size = max(first.body.size, second.body.size, 1.0)
        pair = exact_pair(first.shape, second.shape, 0.3 * size, rng)
        swapped_alike(first.body, second.body, pair.pose_a, pair.pose_b, size)


@pytest.mark.parametrize("number", range(len(SOLIDS)))
def test_swapped_solids_that_overlap(number, rng):
    for _ in range(3):
        first, second = SOLIDS[number](rng), SOLIDS[rng.integers(len(SOLIDS))](rng)
        while first.body.size == 0.0 == second.body.size or second is point:
            second = SOLIDS[rng.integers(len(SOLIDS))](rng)
        size = max(first.body.size, second.body.size)
        pair = exact_pair(first.shape, second.shape, 0.3 * size, rng)
        pose_b = sink(pair, 1e-4 * size)
        one = so.distance(first.body, second.body, pair.pose_a, pose_b)
        two = so.distance(second.body, first.body, pose_b, pair.pose_a)
        assert two.distance == pytest.approx(one.distance, abs=1e-9 * size)


# A nearest point that jumps along a face while a body slides: bulletphysics/bullet3 #2157, and the
# single point of a square contact, coal #144.
@pytest.mark.parametrize("gap", [0.1, 1e-4])
@pytest.mark.parametrize("slider", ["box", "cylinder", "ball"])
def test_points_follow_a_body_that_slides_along_a_face(slider, gap):
    bodies = {
        "box": so.shapes.box(0.4, 0.3, 0.2),
        "cylinder": so.shapes.cylinder(0.2, 0.2),
        "ball": so.shapes.ellipsoid(0.1, 0.1, 0.1),
    }
    table, step = so.shapes.box(4.0, 4.0, 1.0), 1e-2
    tracker = so.Tracker(table, bodies[slider], dt=1e-2)
    twist = (np.array([1.0, 0.3, 0.0]), np.zeros(3))
    state = tracker.start(HOME, at(-1.5, -0.4, 0.6 + gap), REST, twist)
    last = state.proximity
    for frame in range(1, 300):
        pose = at(-1.5 + step * frame, -0.4 + 0.3 * step * frame, 0.6 + gap)
        state, answer = tracker.step(state, HOME, pose, REST, twist)
        assert answer.certified
        assert answer.distance == pytest.approx(gap, abs=1e-14)
        assert np.linalg.norm(answer.point_a - last.point_a) <= 2.0 * step
        assert np.linalg.norm(answer.point_b - last.point_b) <= 2.0 * step
        last = answer


# Signed distance 0 with cylinders: fcl #570; an exception from a box beside a cylinder, fcl #319.
def test_cylinder_beside_a_box():
    box, cylinder = so.shapes.box(0.05, 0.39, 1.47), so.shapes.cylinder(0.18, 0.18)
    pose_a = at(0.8, -0.385, 0.735, about(2, np.pi / 2))
    pose_b = at(0.4, -0.4, 0.93, about(2, -np.pi / 12))
    for a, b, first, second in ((box, cylinder, pose_a, pose_b), (cylinder, box, pose_b, pose_a)):
        answer = so.distance(a, b, first, second)
        assert answer.certified
        assert answer.distance == pytest.approx(0.8 - 0.195 - 0.4 - 0.18, abs=1e-15)


# A cylinder upside down in a half-space: 0.001 in place of 0.051, RobotLocomotion/drake #8049.
@pytest.mark.parametrize("angle", [0.0, np.pi])
def test_cylinder_in_a_half_space(angle):
    answer = so.distance(
        so.shapes.halfspace(), so.shapes.cylinder(0.05, 0.2), HOME, at(0, 0, 0.049, about(0, angle))
    )
    assert answer.distance == pytest.approx(-0.051, abs=1e-15)
    np.testing.assert_allclose(answer.normal, [0, 0, 1], atol=1e-15)


# A ball that grazes a cylinder's side by 0.06 mm, coal #351: the overlap is true.
def test_ball_that_grazes_a_cylinder():
    rotation = [[0, 1, 0], [0, 0, -1], [-1, 0, 0]]
    ball, cylinder = so.shapes.sphere(55.0), so.shapes.cylinder(136.0, 100.0)
    place = at(140.834, -45.449, 905.432)
    answer = so.distance(ball, cylinder, place, at(0, 0, 776.5, rotation))
    truth = np.hypot(140.834, 905.432 - 776.5) - 136.0 - 55.0
    assert truth < 0
    assert answer.distance == pytest.approx(truth, abs=1e-12)


# A disc of radius 9 and height 0.0025 and a ball of radius 0.0015, sunk by 0.00075: fcl #321.
@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("where", [0.0, 1e-6, 4.5, 8.9])
@pytest.mark.parametrize("height", [0.00075, -0.00075, 1e-9])
def test_thin_disc_and_small_ball(where, side, height):
    disc, ball = so.shapes.cylinder(9.0, 0.0025), so.shapes.sphere(0.0015)
    pose = at(0.6 * where, 0.8 * where, side * (0.00125 + 0.0015 + height))
    for a, b, first, second, up in (
        (disc, ball, HOME, pose, side),
        (ball, disc, pose, HOME, -side),
    ):
        answer = so.distance(a, b, first, second)
        assert answer.distance == pytest.approx(height, abs=1e-15)
        np.testing.assert_allclose(answer.normal, [0, 0, up], atol=1e-9)
        of_disc = answer.point_a if a is disc else answer.point_b
        np.testing.assert_allclose(of_disc, [*pose[1][:2], side * 0.00125], atol=1e-9)


# Kissing boxes of unlike sizes, tilted: fcl #493, #495, RobotLocomotion/drake #21673. The rounding
# of the poses decides on the sign; the answer must be within that rounding, and be an answer.
@pytest.mark.parametrize("gap", [1e-15, -1e-15, 0.0])
@pytest.mark.parametrize("size_a", [0.01, 1.0, 1000.0])
@pytest.mark.parametrize("size_b", [0.01, 1.0, 1000.0])
def test_kissing_boxes(size_a, size_b, gap, rng):
    lengths_a, lengths_b = (
        (size_a, 0.7 * size_a, 0.9 * size_a),
        (size_b, 0.8 * size_b, 0.6 * size_b),
    )
    first, second = oracle.Box(*lengths_a), oracle.Box(*lengths_b)
    a, b = so.shapes.box(*lengths_a), so.shapes.box(*lengths_b)
    for kind in ("vertex on face", "edge on edge", "face on face"):
        turn_a, turn_b = random_rotation(rng), random_rotation(rng)
        turn_b = turn_a if kind == "face on face" else turn_b
        normal = np.cross(turn_a[:, 0], turn_b[:, 1]) if kind == "edge on edge" else turn_a[:, 2]
        normal = normal / np.linalg.norm(normal)
        pair = exact_pair(
            first, second, gap, rng, normal=normal, rotation_a=turn_a, rotation_b=turn_b
        )
        answer = so.distance(a, b, pair.pose_a, pair.pose_b)
        size = size_a + size_b
        assert_consistent(answer)
        assert answer.distance == pytest.approx(pair.distance, abs=SLIDE * size)
        assert answer.lower_bound <= pair.distance + 32.0 * EPS * size
        assert answer.upper_bound >= pair.distance - 32.0 * EPS * size


# The very poses of fcl #493, which raised an exception: equal boxes side by side.
def test_kissing_boxes_of_the_report():
    rotation = np.array(
        [
            [0.96193976625564348026, 0.15401279915737359216, 0.22572537250328919556],
            [-0.19134171618254486313, 0.96936494951283913579, 0.15401279915737359216],
            [-0.19509032201612822033, -0.19134171618254486313, 0.96193976625564348026],
        ]
    )
    first = at(2.0770063995786869349, 0.48468247475641951239, 1.1543291419087275962, rotation)
    box = so.shapes.box(0.5, 0.5, 0.5)
    answer = so.distance(box, box, first, at(2.0, 0.0, 1.25, rotation))
    assert abs(answer.distance) <= 1e-15
    np.testing.assert_allclose(answer.normal, -rotation[:, 1], atol=1e-9)


# Exactly 0 between separated hulls: google-deepmind/mujoco #3383 (103 of 3,000 poses).
def test_separated_hulls_are_never_zero_apart(rng):
    for _ in range(40):
        sides = [rng.normal(size=(int(rng.integers(4, 30)), 3)) * 0.1 for _ in range(2)]
        shapes = [oracle.Polytope(side) for side in sides]
        a, b = (so.shapes.polytope(side) for side in sides)
        place = rng.uniform(0.25, 0.6) * random_normal(rng)
        poses = (random_rotation(rng), np.zeros(3)), (random_rotation(rng), place)
        truth = maximise_separation(*(Placed(s, *p) for s, p in zip(shapes, poses, strict=True)))
        if truth.value <= 1e-9:
            continue
        answer = so.distance(a, b, *poses)
        assert answer.certified
        assert answer.distance == pytest.approx(truth.value, abs=1e-12)


# A coplanar point 0 from a box: mikedh/trimesh #73.
def test_point_in_the_plane_of_a_face():
    cube = so.shapes.box(2.0, 2.0, 2.0)
    answer = so.distance(cube, so.shapes.point(), at(1.0, 1.0, 1.0), at(3.0, 2.0, 2.0))
    assert answer.distance == pytest.approx(1.0, abs=1e-15)
    np.testing.assert_allclose(answer.normal, [1.0, 0.0, 0.0], atol=1e-15)


# NaN in gradients where bodies touch: RobotLocomotion/drake #14789, #21192 (boxes).
TOUCHING = {
    "box on box": (so.shapes.box(1, 1, 1), so.shapes.box(1, 1, 1), 1.0),
    "box beside box, edge on face": (so.shapes.box(1, 1, 1), so.shapes.cylinder(0.5, 1.0), 1.0),
    "ball on box": (so.shapes.box(1, 1, 1), so.shapes.sphere(0.5), 1.0),
    "ball on ball": (so.shapes.sphere(0.5), so.shapes.ellipsoid(0.5, 0.5, 0.5), 1.0),
    "ellipsoid on ellipsoid": (
        so.shapes.ellipsoid(0.3, 0.4, 0.5),
        so.shapes.ellipsoid(0.7, 0.4, 0.5),
        1.0,
    ),
    "box on plane": (so.shapes.halfspace(), so.shapes.box(1, 1, 1), 0.5),
}


@pytest.mark.parametrize("name", TOUCHING)
def test_gradients_where_bodies_touch(name):
    """Normal, points and rate are numbers at distance 0 exactly, cold and tracked."""
    a, b, height = TOUCHING[name]
    tracker = so.Tracker(a, b, dt=1e-2)
    twist = (np.array([0.1, 0.0, -0.7]), np.zeros(3))
    state = tracker.start(HOME, at(0, 0, height + 7e-3), REST, twist)
    state, answer = tracker.step(state, HOME, at(1e-3, 0, height), REST, twist)
    for found in (answer, so.distance(a, b, HOME, at(0, 0, height))):
        assert_consistent(found)
        assert found.distance == pytest.approx(0.0, abs=1e-6)
        np.testing.assert_allclose(found.normal, [0, 0, 1], atol=1e-2)
    assert answer.rate == pytest.approx(-0.7, abs=1e-2)
