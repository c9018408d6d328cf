"""Symmetries that an answer must have, and the state as a value, on random pairs."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_pairs import APART, pairs
from scipy.spatial.transform import Rotation

import standoff as so
from draws import draws

DISTANCE = 1e-13
"""Difference of two distances, over size plus distance. Worst of 2,000 pairs: 5e-15."""
WITNESS = 1e-11
"""Difference of two witness points, over the size. Worst of 2,000 pairs: 1e-14."""
NORMAL = 1e-13
"""Difference of two normals, over (size + distance)/distance. The same."""
EPS = float(np.finfo(float).eps)
FAR = 2.0**20
"""Sizes from the origin, about 1e6; a power of two, so that shifts by it can be exact."""

FRAMES = 10
STEP = 1e-2


def distance_of(pair, pose_a=None, pose_b=None):
    pose_a = pair.pose_a if pose_a is None else pose_a
    pose_b = pair.pose_b if pose_b is None else pose_b
    answer = so.distance(pair.a, pair.b, pose_a, pose_b)
    assert answer.certified
    return answer


def swapped(answer):
    """(point_a, point_b, normal, features) as the swapped pair would say it."""
    return answer.point_b, answer.point_a, -answer.normal, (answer.feature_b, answer.feature_a)


def moved(answer, pose):
    features = answer.feature_a, answer.feature_b
    ends = pose.apply(answer.point_a), pose.apply(answer.point_b)
    return *ends, pose.rotation @ answer.normal, features


def assert_same(answer, distance, expected, size, loss=0.0):
    """The answer equals an expected (point_a, point_b, normal, features); ``loss`` in sizes."""
    span = size + distance
    point_a, point_b, normal, features = expected
    assert abs(answer.distance - distance) <= DISTANCE * span + loss * size
    assert np.linalg.norm(answer.point_a - point_a) <= (WITNESS + loss) * size
    assert np.linalg.norm(answer.point_b - point_b) <= (WITNESS + loss) * size
    assert np.linalg.norm(answer.normal - normal) <= (NORMAL * span + 2 * loss * size) / distance
    assert (answer.feature_a, answer.feature_b) == features


@given(pairs())
def test_swapping_the_bodies(pair):
    first = distance_of(pair)
    second = so.distance(pair.b, pair.a, pair.pose_b, pair.pose_a)
    assert second.certified
    assert_same(second, first.distance, swapped(first), pair.size)


@given(pairs(unbounded=False), st.sampled_from([0.0, 1.0, 30.0]))
def test_rigid_motion(pair, shift):
    pose = pair.rigid_motion(shift)
    first = distance_of(pair)
    second = distance_of(pair, pose @ pair.pose_a, pose @ pair.pose_b)
    # the moved positions are rounded
    assert_same(second, first.distance, moved(first, pose), pair.size, loss=4 * EPS * shift)


@given(pairs(unbounded=False))
def test_a_million_sizes_away_nothing_but_the_rounding_of_positions_is_lost(pair):
    """Positions that are shifted exactly give the same distance and normal to 1e-13.

    The witness points are rounded once to the spacing of numbers there, 1e-10 of the size.
    """
    rng = pair.rng()
    unit = 2.0 ** np.ceil(np.log2(pair.size))
    grid = 2.0**-30 * unit
    shift = FAR * unit * np.where(rng.random(3) < 0.5, -1.0, 1.0) * rng.integers(0, 2, 3)
    if pair.planar:
        shift[2] = 0.0
    near = [
        so.Pose(pose.rotation, grid * np.round(pose.translation / grid))
        for pose in (pair.pose_a, pair.pose_b)
    ]
    far = [so.Pose(pose.rotation, pose.translation + shift) for pose in near]
    for one, two in zip(near, far, strict=True):
        assert (two.translation - shift == one.translation).all()
    first, second = distance_of(pair, *near), distance_of(pair, *far)
    span = pair.size + first.distance
    assert abs(second.distance - first.distance) <= DISTANCE * span
    assert np.linalg.norm(second.normal - first.normal) <= NORMAL * span / first.distance
    rounding = EPS * float(np.abs(shift).max())
    for one, two in ((first.point_a, second.point_a), (first.point_b, second.point_b)):
        assert np.abs(two - (one + shift)).max() <= rounding + WITNESS * pair.size


@given(pairs((1e-2, 2.0), unbounded=False))
def test_a_million_sizes_away_in_general(pair):
    """Any rigid motion: positions are rounded by eps |p|, 2e-10 of the size, which is the loss."""
    pose = pair.rigid_motion(1e6)
    first = distance_of(pair)
    second = distance_of(pair, pose @ pair.pose_a, pose @ pair.pose_b)
    loss = 4 * EPS * 1e6
    span = pair.size + first.distance
    assert abs(second.distance - first.distance) <= loss * pair.size
    assert second.distance - second.lower_bound <= 1e-10 * span
    # the normal turns by the loss over the distance, and more where curved faces are flat
    assert np.linalg.norm(second.normal - pose.rotation @ first.normal) <= 1e3 * loss


@given(pairs(), st.sampled_from([1e-3, 1e3]))
def test_scaling(pair, scale):
    first = distance_of(pair)
    bodies = [body.transformed(scale * np.eye(3)) for body in (pair.a, pair.b)]
    poses = [
        so.Pose(pose.rotation, scale * pose.translation) for pose in (pair.pose_a, pair.pose_b)
    ]
    second = so.distance(*bodies, *poses)
    assert second.certified
    features = first.feature_a, first.feature_b
    assert second.distance / scale == pytest.approx(
        first.distance, abs=DISTANCE * (pair.size + first.distance)
    )
    assert np.linalg.norm(second.point_a / scale - first.point_a) <= WITNESS * pair.size
    assert np.linalg.norm(second.point_b / scale - first.point_b) <= WITNESS * pair.size
    assert (second.feature_a, second.feature_b) == features


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_shapes_of_scaled_lengths_are_scaled_shapes(scale):
    s, k = so.shapes, scale
    for made, expected in (
        (s.ellipsoid(0.3 * k, 0.2 * k, 0.5 * k), s.ellipsoid(0.3, 0.2, 0.5)),
        (s.lens(0.8 * k, 0.3 * k), s.lens(0.8, 0.3)),
        (s.box(0.8 * k, 0.3 * k, 0.5 * k, 0.1 * k), s.box(0.8, 0.3, 0.5, 0.1)),
        (s.cylinder(0.8 * k, 0.3 * k), s.cylinder(0.8, 0.3)),
        (s.cone(0.8 * k, 0.3 * k), s.cone(0.8, 0.3)),
        (s.capsule(0.8 * k, 0.3 * k), s.capsule(0.8, 0.3)),
        (s.cap(0.8 * k, 0.3 * k), s.cap(0.8, 0.3)),
    ):
        pose = so.Pose.exp([0.4, -0.3, 0.8], [1.5, 0.7, -0.9])
        far = so.Pose(pose.rotation, k * pose.translation)
        one = so.distance(s.lens(k, 0.45 * k), made, so.Pose.identity(), far)
        two = so.distance(s.lens(1, 0.45), expected, so.Pose.identity(), pose)
        assert one.distance / k == pytest.approx(two.distance, abs=1e-14)
        np.testing.assert_allclose(one.point_b / k, two.point_b, atol=1e-12)


def scaled_bodies(k):
    """Bodies of a size of about k."""
    s, points = so.shapes, np.random.default_rng(7).normal(size=(9, 3)) * 0.4
    return (
        s.box(k, 0.7 * k, 0.5 * k),
        s.sphere(0.4 * k),
        s.ellipsoid(0.3 * k, 0.5 * k, 0.4 * k),
        s.capsule(0.2 * k, 0.6 * k),
        s.polytope(points * k),
        s.polytope(points * k, rounding=0.1 * k),
        s.lens(0.8 * k, 0.3 * k),
    )


@pytest.mark.parametrize("power", [-30, -26, -13, 13, 30])
def test_a_power_of_two_changes_no_status(power, rng):
    """Apart and in penetration; beyond, the tolerances of trimming are no longer small lengths."""
    turns = Rotation.random(30, random_state=rng).as_matrix()
    shifts = rng.normal(size=(30, 3)) * 0.7
    k = 2.0**power
    one, other = scaled_bodies(1.0), scaled_bodies(k)
    for i, a in enumerate(one):
        for b, its, own in zip(one[i:], other[i:], [other[i]] * len(one), strict=False):
            first = so.distances(a, b, np.eye(4), (turns, shifts))
            second = so.distances(own, its, np.eye(4), (turns, k * shifts))
            assert list(first.status) == list(second.status)
            np.testing.assert_allclose(second.distance / k, first.distance, rtol=0.0, atol=1e-13)


def seen_from(frame, path, t):
    """Pose and twist of a body on ``path`` in a world that itself moves on ``frame``."""
    carrier, pose = frame.pose(t), path.pose(t)
    twist, own = frame.twist(t), path.twist(t)
    arm = carrier.rotation @ pose.translation
    v = twist.v + np.cross(twist.omega, arm) + carrier.rotation @ own.v
    return carrier @ pose, so.Twist(v, twist.omega + carrier.rotation @ own.omega)


def track(a, b, motion, law):
    """Answers of a few frames; ``motion(t)`` is ((pose_a, twist_a), (pose_b, twist_b))."""
    tracker = so.Tracker(a, b, dt=STEP, law=law)
    state, answers = None, []
    for k in range(FRAMES + 1):
        (pose_a, twist_a), (pose_b, twist_b) = motion(k * STEP)
        if state is None:
            state = tracker.start(pose_a, pose_b, twist_a, twist_b)
            answers.append(state.proximity)
        else:
            state, answer = tracker.step(state, pose_a, pose_b, twist_a, twist_b)
            answers.append(answer)
    return answers


LAWS = {
    "PC2": so.PredictorCorrector(),
    "secant": so.PredictorCorrector(predictor="secant"),
    "paper, Heun": so.PaperLaw(),
    "paper, RK4": so.PaperLaw(integrator="rk4"),
}
TRACKED = 1e-9
"""Difference of tracked witness points, over the size: corrections end at slopes of 1e-10."""


def assert_tracked_alike(one, two, expected, size):
    """Answers of two trackers; ``expected`` is what the first answer is for the second."""
    point_a, point_b, _, features = expected
    assert two.status is one.status
    for name, first, second in zip(one.counts._fields, one.counts, two.counts, strict=True):
        # where a slope stands at its goal, roundoff decides on one correction more
        more = 1 if name in ("evaluations", "corrections") else 0
        assert abs(first - second) <= more, name
    assert (two.feature_a, two.feature_b) == features
    assert abs(two.distance - one.distance) <= 1e-12 * (size + one.distance)
    assert np.linalg.norm(two.point_a - point_a) <= TRACKED * size
    assert np.linalg.norm(two.point_b - point_b) <= TRACKED * size
    assert abs(two.rate - one.rate) <= TRACKED * size


@settings(max_examples=draws(25))
@given(pairs(APART, unbounded=False), st.sampled_from(sorted(LAWS)))
def test_tracking_does_not_depend_on_the_frame_of_reference(pair, law):
    """The same motion in a world that turns and shifts by itself."""
    path_a, path_b, frame = pair.paths()

    def plain(t):
        return (path_a.pose(t), path_a.twist(t)), (path_b.pose(t), path_b.twist(t))

    def carried(t):
        return seen_from(frame, path_a, t), seen_from(frame, path_b, t)

    answers = [track(pair.a, pair.b, motion, LAWS[law]) for motion in (plain, carried)]
    for k, (one, two) in enumerate(zip(*answers, strict=True)):
        assert_tracked_alike(one, two, moved(one, frame.pose(k * STEP)), pair.size)


@settings(max_examples=draws(25))
@given(pairs(APART, unbounded=False), st.sampled_from(["PC2", "secant"]))
def test_tracking_swapped_bodies(pair, law):
    path_a, path_b, _ = pair.paths()

    def plain(t):
        return (path_a.pose(t), path_a.twist(t)), (path_b.pose(t), path_b.twist(t))

    first = track(pair.a, pair.b, plain, LAWS[law])
    second = track(pair.b, pair.a, lambda t: plain(t)[::-1], LAWS[law])
    for one, two in zip(first, second, strict=True):
        point_a, point_b, _, features = swapped(one)
        assert two.certified
        assert one.certified
        assert (two.feature_a, two.feature_b) == features
        assert abs(two.distance - one.distance) <= 1e-12 * (pair.size + one.distance)
        assert np.linalg.norm(two.point_a - point_a) <= TRACKED * pair.size
        assert np.linalg.norm(two.point_b - point_b) <= TRACKED * pair.size
        assert abs(two.rate - one.rate) <= TRACKED * pair.size
        np.testing.assert_allclose(two.velocity_a, one.velocity_b, atol=1e-6 * pair.size)
