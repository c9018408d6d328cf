"""What other libraries answered wrongly of bodies that overlap, each made anew from its report.

Issue numbers tell where a case was reported. Truth is a closed form, a construction from support
points in extended precision, or arithmetic of 40 digits.
"""

import mpmath
import numpy as np
import pytest

import standoff as so
from oracles.exact_pairs import exact_pair, random_rotation
from standoff.geometry import ellipsoid_patches
from standoff_studies import oracles as oracle
from tracking.world_cases import HOME, about, assert_consistent, at, sink


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
def test_witnesses_of_overlapping_ellipsoids(depth, rng):
    """Points and normal are those of the construction, at any depth below the focal one."""
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


# Ellipsoids that barely overlap are missed: BerkeleyAutomation/python-fcl #36. For strictly convex
# bodies the constructed normal is the least depth's as long as the depth is small.
@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9, 1e-12])
def test_ellipsoids_that_barely_overlap(depth, rng):
    for _ in range(6):
        first, second = rng.uniform(0.3, 1.5, 3), rng.uniform(0.3, 1.5, 3)
        pair = exact_pair(oracle.Ellipsoid(*first), oracle.Ellipsoid(*second), 0.1, rng)
        a, b = so.shapes.ellipsoid(*first), so.shapes.ellipsoid(*second)
        for sign in (1.0, -1.0):
            answer = so.distance(a, b, pair.pose_a, sink(pair, sign * depth))
            assert answer.distance == pytest.approx(-sign * depth, abs=1e-14)
            assert answer.distance < 0.0 if sign > 0 else answer.distance > 0.0


# A normal that flips near the surface: mikedh/trimesh #75.
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
def test_the_normal_does_not_flip_on_the_way_in(name, tracked, rng):
    """Down to contact by 1e-3 to 1e-9 of the size and through it: one sign change, no turn."""
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
def test_a_depth_of_1e_8_between_flat_ellipsoids(flat, rng):
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
