"""Cases that other libraries are known to have answered wrongly, each made anew from its report.

Issue numbers tell where a case was reported. Truth is a closed form, a construction from support
points in extended precision, or arithmetic of 40 digits.
"""

import mpmath
import numpy as np
import pytest

import standoff as so
from families.shapes import SOLIDS, point
from oracles import support as oracle
from oracles.bounds import maximise_separation
from oracles.exact_pairs import exact_pair, random_normal, random_rotation
from oracles.support import Placed
from standoff.geometry import ellipsoid_patches

HOME = np.eye(4)
EPS = float(np.finfo(float).eps)
SLIDE = 1e-13
"""Roundoff of kissing bodies, over the size: 969 of 972 were right to 1e-15, the rest to 1.4e-14;
below a gap of 1e-13 points that are apart may also slide that far to the side."""
REST = (np.zeros(3), np.zeros(3))


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


# Witness points once bodies overlap: coal-library/coal #307 (a ball whose centre lies on a box's
# face, given as sphere and as ellipsoid), #823, flexible-collision-library/fcl #275.
@pytest.mark.parametrize("ball", [so.shapes.sphere(0.5), so.shapes.ellipsoid(0.5, 0.5, 0.5)])
def test_witnesses_of_a_ball_half_inside_a_box(ball):
    answer = so.distance(ball, so.shapes.box(1.0, 1.0, 1.0), at(0.1, 0.05, 0.5), HOME)
    assert answer.distance == pytest.approx(-0.5, abs=1e-14)
    np.testing.assert_allclose(answer.normal, [0, 0, -1], atol=1e-12)
    np.testing.assert_allclose(answer.point_a, [0.1, 0.05, 0.0], atol=1e-10)
    np.testing.assert_allclose(answer.point_b, [0.1, 0.05, 0.5], atol=1e-10)


@pytest.mark.parametrize("depth", [1e-9, 1e-6, 1e-3, 0.05])
def test_witnesses_of_overlapping_ellipsoids(depth):
    """Points and normal are those of the construction, at any depth below the focal one."""
    rng = np.random.default_rng()
    first, second = (1.0, 0.7, 0.5), (0.6, 0.9, 0.8)
    for _ in range(5):
        pair = exact_pair(oracle.Ellipsoid(*first), oracle.Ellipsoid(*second), 0.1, rng)
        pose_b = sink(pair, depth)
        answer = so.distance(
            so.shapes.ellipsoid(*first), so.shapes.ellipsoid(*second), pair.pose_a, pose_b
        )
        assert_consistent(answer)
        assert answer.distance == pytest.approx(-depth, abs=1e-13)
        np.testing.assert_allclose(answer.point_a, pair.point_a, atol=1e-9)
        np.testing.assert_allclose(answer.normal, pair.normal, atol=1e-9)


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
def test_swapped_solids(number):
    """Random normals meet one point each, so the nearest points are unique."""
    rng = np.random.default_rng()
    for _ in range(3):
        first = SOLIDS[number](rng)
        second = SOLIDS[rng.integers(len(SOLIDS))](rng)
        size = max(first.body.size, second.body.size, 1.0)
        pair = exact_pair(first.shape, second.shape, 0.3 * size, rng)
        swapped_alike(first.body, second.body, pair.pose_a, pair.pose_b, size)


@pytest.mark.parametrize("number", range(len(SOLIDS)))
def test_swapped_solids_that_overlap(number):
    rng = np.random.default_rng()
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
def test_kissing_boxes(size_a, size_b, gap):
    rng = np.random.default_rng()
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
def test_separated_hulls_are_never_zero_apart():
    rng = np.random.default_rng()
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


# Ellipsoids that barely overlap are missed: BerkeleyAutomation/python-fcl #36. For strictly convex
# bodies the constructed normal is the least depth's as long as the depth is small.
@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9, 1e-12])
def test_ellipsoids_that_barely_overlap(depth):
    rng = np.random.default_rng()
    for _ in range(6):
        first, second = rng.uniform(0.3, 1.5, 3), rng.uniform(0.3, 1.5, 3)
        pair = exact_pair(oracle.Ellipsoid(*first), oracle.Ellipsoid(*second), 0.1, rng)
        a, b = so.shapes.ellipsoid(*first), so.shapes.ellipsoid(*second)
        for sign in (1.0, -1.0):
            answer = so.distance(a, b, pair.pose_a, sink(pair, sign * depth))
            assert answer.distance == pytest.approx(-sign * depth, abs=1e-14)
            assert answer.distance < 0.0 if sign > 0 else answer.distance > 0.0


# A normal that flips near the surface: mikedh/trimesh #75; a coplanar point 0 from a box, #73.
def test_point_in_the_plane_of_a_face():
    cube = so.shapes.box(2.0, 2.0, 2.0)
    answer = so.distance(cube, so.shapes.point(), at(1.0, 1.0, 1.0), at(3.0, 2.0, 2.0))
    assert answer.distance == pytest.approx(1.0, abs=1e-15)
    np.testing.assert_allclose(answer.normal, [1.0, 0.0, 0.0], atol=1e-15)


CROSSINGS = {
    "balls": (oracle.Sphere(0.5), so.shapes.sphere(0.5), oracle.Sphere(0.5), so.shapes.sphere(0.5)),
    "ellipsoids": (
        oracle.Ellipsoid(0.4, 0.3, 0.5),
        so.shapes.ellipsoid(0.4, 0.3, 0.5),
        oracle.Ellipsoid(0.6, 0.4, 0.5),
        so.shapes.ellipsoid(0.6, 0.4, 0.5),
    ),
    "corner and box": (
        oracle.Box(1, 1, 1),
        so.shapes.box(1, 1, 1),
        oracle.Box(1, 1, 1),
        so.shapes.box(1, 1, 1),
    ),
    "box and point": (
        oracle.Box(1, 1, 1),
        so.shapes.box(1, 1, 1),
        oracle.Point(),
        so.shapes.point(),
    ),
    "lens and capsule": (
        oracle.Lens(1.0, 0.45),
        so.shapes.lens(1.0, 0.45),
        oracle.Capsule(0.2, 1.0),
        so.shapes.capsule(0.2, 1.0),
    ),
}


@pytest.mark.parametrize("tracked", [True, False])
@pytest.mark.parametrize("name", CROSSINGS)
def test_the_normal_does_not_flip_on_the_way_in(name, tracked):
    """Down to contact by 1e-3 to 1e-9 of the size and through it: one sign change, no turn."""
    rng = np.random.default_rng()
    shape_a, a, shape_b, b = CROSSINGS[name]
    turn = random_rotation(rng)
    normal = turn[:, 2] if "box" in name else None  # else the answer is a vertex's, or an edge's
    pair = exact_pair(shape_a, shape_b, 0.01, rng, normal=normal, rotation_a=turn)
    heights = np.concatenate([k * np.array([3.0, 2.0, 1.0, 0.1]) for k in (1e-3, 1e-6, 1e-9)])
    tracker = so.Tracker(a, b)
    state = tracker.start(pair.pose_a, pair.pose_b)
    for height in [*heights, 0.0, *-heights[::-1]]:
        pose = sink(pair, -height)
        if tracked:
            state, answer = tracker.step(state, pair.pose_a, pose)
        else:
            answer = so.distance(a, b, pair.pose_a, pose)
        assert_consistent(answer)
        np.testing.assert_allclose(answer.normal, pair.normal, atol=1e-5)
        assert answer.distance == pytest.approx(height, abs=1e-12)


# A few centimetres of penetration reported as metres: google-deepmind/mujoco #3476 (a second
# contact as deep as the whole box), jrouwe/JoltPhysics #2103 (7 m for touching bodies).
@pytest.mark.parametrize("depth", [0.06, 5.6e-5])
@pytest.mark.parametrize("size", [0.071, 1.0, 50.0])
def test_a_shallow_overlap_is_shallow(size, depth):
    """Boxes face to face, turned a little about the normal: the depth is what they sank."""
    if depth > 0.5 * size:
        depth = 0.1 * size
    a, b = so.shapes.box(size, size, size), so.shapes.box(size, size, size)
    for angle in (0.0, 1e-9, 1e-4, 0.3):
        for shift in (0.0, 0.3):
            pose = at(shift * size, 0.0, size - depth, about(2, angle))
            answer = so.distance(a, b, HOME, pose)
            assert answer.distance == pytest.approx(-depth, abs=1e-14 * size)
            np.testing.assert_allclose(answer.normal, [0, 0, 1], atol=1e-12)


# A ball deep in a box: the depth went wrong once it was all inside, google-deepmind/mujoco #2206.
@pytest.mark.parametrize("z", [-0.001, -0.005, -0.006, -0.1, -0.2499])
def test_a_ball_all_inside_a_box(z):
    box, ball = so.shapes.box(1.0, 1.0, 0.5), so.shapes.sphere(0.005)
    answer = so.distance(box, ball, at(0, 0, -0.25), at(0, 0, z))
    assert answer.distance == pytest.approx(z - 0.005, abs=1e-15)
    np.testing.assert_allclose(answer.normal, [0, 0, 1], atol=1e-12)


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


# A positive distance for solids that intersect: FreeCAD/FreeCAD #25158, Open-Cascade-SAS/OCCT
# #1123 (four cylinders standing in a part, two of them said to be 6e-5 and 0.083 away).
def test_intersecting_solids_are_not_apart():
    plate = so.shapes.box(40.0, 20.0, 3.0)
    dome = so.Body.from_patches(ellipsoid_patches(15.0, 9.0, 4.0))
    for part, top in ((plate, 1.5), (dome, 3.0)):
        for x, y in ((-4.0, -3.0), (-4.0, 3.0), (4.0, -3.0), (4.0, 3.0)):
            for sunk in (1e-7, 6.1e-5, 0.083, 0.5):
                pin = so.shapes.cylinder(0.8, 5.0)
                answer = so.distance(part, pin, HOME, at(x, y, top + 2.5 - sunk))
                assert answer.distance < 0.0
                if part is plate:
                    assert answer.distance == pytest.approx(-sunk, abs=1e-13)


# MuJoCo's own test of its native collider: a ball and a slender ellipsoid at a keyframe.
KEYFRAME = ("0.000886189", "-0.0303047", "0.0951303"), ("0.98783", "0.155468", "0.00454524")


def keyframe_truth():
    """Signed distance of the ball of radius 0.1 at (0, 0, -0.1), in 40 digits."""
    with mpmath.workdps(40):
        quaternion = [mpmath.mpf(q) for q in (*KEYFRAME[1], "1.60038e-06")]
        length = mpmath.sqrt(sum(q * q for q in quaternion))
        w, x, y, z = (q / length for q in quaternion)
        rows = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
        axes = [mpmath.mpf(a) for a in ("0.01", "0.02", "0.1")]
        arm = [-mpmath.mpf(p) for p in KEYFRAME[0]]
        arm[2] -= mpmath.mpf("0.1")
        local = [sum(rows[i][k] * arm[i] for i in range(3)) for k in range(3)]

        def secular(t):
            return sum((a * p / (t + a * a)) ** 2 for a, p in zip(axes, local, strict=True)) - 1

        t = mpmath.findroot(secular, (0, 1), solver="anderson", tol=mpmath.mpf(10) ** -35)
        gap = mpmath.sqrt(sum((t * p / (t + a * a)) ** 2 for a, p in zip(axes, local, strict=True)))
        return float(gap - mpmath.mpf("0.1"))


def keyframe_pose():
    place = np.array([float(p) for p in KEYFRAME[0]])
    return so.Pose.from_wxyz([*(float(q) for q in KEYFRAME[1]), 1.60038e-06], place)


def test_the_keyframe_s_truth():
    assert keyframe_truth() == pytest.approx(-0.00022591335023150, abs=1e-17)


@pytest.mark.parametrize("ball", [so.shapes.sphere(0.1), so.shapes.ellipsoid(0.1, 0.1, 0.1)])
def test_mujoco_s_ellipsoid_keyframe(ball):
    slender = so.shapes.ellipsoid(0.01, 0.02, 0.1)
    answer = so.distance(ball, slender, at(0, 0, -0.1), keyframe_pose())
    assert answer.distance == pytest.approx(keyframe_truth(), abs=1e-15)


def test_mujoco_answers_its_keyframe_to_its_tolerance():
    """The published -0.00022591335 is what MuJoCo finds at a tight tolerance."""
    mujoco = pytest.importorskip("mujoco")
    numbers = " ".join([*KEYFRAME[0], *KEYFRAME[1], "1.60038e-06"])
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><option ccd_tolerance="1e-10" ccd_iterations="1000"/><worldbody>'
        '<geom type="ellipsoid" size="0.1 0.1 0.1" pos="0 0 -0.1"/>'
        '<body><freejoint/><geom type="ellipsoid" size="0.01 0.02 0.1"/></body></worldbody>'
        f'<keyframe><key qpos="{numbers}"/></keyframe></mujoco>'
    )
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    found = mujoco.mj_geomDistance(model, data, 0, 1, 1.0, None)
    assert found == pytest.approx(keyframe_truth(), abs=1e-9)


# MuJoCo's slow convergence at a depth of 1.15e-8: its model is not published with the number, so
# flat ellipsoids stand for it, on which the polytopes of GJK and EPA gain little in a step.
@pytest.mark.parametrize("flat", [0.3, 0.02])
def test_a_depth_of_1e_8_between_flat_ellipsoids(flat):
    rng = np.random.default_rng()
    axes = (1.0, 0.9, flat)
    body = so.shapes.ellipsoid(*axes)
    for _ in range(4):
        n = np.array([*(1e-3 * rng.normal(size=2)), 1.0])
        pair = exact_pair(
            oracle.Ellipsoid(*axes),
            oracle.Ellipsoid(*axes),
            0.1,
            rng,
            normal=n / np.linalg.norm(n),
            rotation_a=np.eye(3),
            rotation_b=about(2, rng.uniform(0, 6)),
        )
        answer = so.distance(body, body, pair.pose_a, sink(pair, 1.15e-8))
        assert answer.distance == pytest.approx(-1.15e-8, abs=1e-14)
        np.testing.assert_allclose(answer.normal, pair.normal, atol=1e-8)
