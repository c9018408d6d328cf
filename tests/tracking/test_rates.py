"""Rates of the answer against differences of cold answers: distance and witness points."""

import numpy as np
import pytest
from hypothesis import given, settings
from random_pairs import APART, pairs

import standoff as so
from draws import draws
from standoff.motion import ConstantTwist

STEP = 1e-3
"""Step, s, of the differences of fourth order: at speeds of about 1 their error is near 1e-12."""
SPIN_A, SPIN_B = np.array([0.4, -0.9, 0.6]), np.array([-0.7, 0.5, 1.1])
SHIFT_A, SHIFT_B = np.array([0.3, -0.2, 0.5]), np.array([-0.6, 0.4, 0.1])

# Pairs whose witness points are unique and stay inside one feature for a while, by the kinds of
# features that meet, with and without swept radii: (a, b, place of b, features).
S = so.shapes
ROUNDED = S.box(0.8, 0.6, 0.5, rounding=0.1)
CASES = {
    "ellipsoid, ellipsoid": (
        S.ellipsoid(0.5, 0.3, 0.4),
        S.ellipsoid(0.2, 0.4, 0.3),
        so.Pose.exp([0.3, 0.2, -0.4], [1.1, 0.5, 0.3]),
        ("face", "face"),
    ),
    "lens edge, ellipsoid": (
        S.lens(1.0, 0.45),
        S.ellipsoid(0.2, 0.4, 0.3),
        so.Pose.exp([0.3, 0.2, -0.4], [0.8, 1.2, 0.3]),
        ("edge", "face"),
    ),
    "lens vertex, ellipsoid": (
        S.lens(1.0, 0.45),
        S.ellipsoid(0.2, 0.4, 0.3),
        so.Pose.exp([0.3, 0.2, -0.4], [0.1, 0.05, 1.6]),
        ("vertex", "face"),
    ),
    "lens face, sphere": (
        S.lens(1.0, 0.45),
        S.sphere(0.3),
        so.Pose.exp([0.3, 0.2, -0.4], [1.4, 0.3, 0.4]),
        ("face", "vertex"),
    ),
    "ellipsoid, capsule": (
        S.ellipsoid(0.5, 0.3, 0.4),
        S.capsule(0.15, 0.8),
        so.Pose.exp([0.3, 0.2, -0.4], [1.1, 0.2, 0.1]),
        ("face", "edge"),
    ),
    "capsule, capsule": (
        S.capsule(0.2, 1.0),
        S.capsule(0.15, 0.8),
        so.Pose.exp([1.2, 0.3, -0.4], [0.9, 0.1, 0.05]),
        ("edge", "edge"),
    ),
    "rounded box face, ellipsoid": (
        ROUNDED,
        S.ellipsoid(0.2, 0.4, 0.3),
        so.Pose.exp([0.3, 0.2, -0.4], [1.0, 0.05, -0.05]),
        ("face", "face"),
    ),
    "rounded box vertex, rounded box edge": (
        ROUNDED,
        S.box(0.5, 0.6, 0.7, rounding=0.05),
        so.Pose.exp([0.6, 0.5, -0.3], [0.9, 0.85, 0.05]),
        ("vertex", "edge"),
    ),
    "cylinder, cone": (
        S.cylinder(0.4, 1.0),
        S.cone(0.5, 0.8),
        so.Pose.exp([0.9, 0.6, -0.4], [1.2, 0.4, 0.3]),
        ("face", "edge"),
    ),
}


def moving(name):
    """Both bodies and their paths."""
    a, b, place, _ = CASES[name]
    path_a = ConstantTwist(so.Pose.exp([0.1, -0.2, 0.05]), so.Twist(SHIFT_A, SPIN_A))
    path_b = ConstantTwist(so.Pose.exp([0.1, -0.2, 0.05]) @ place, so.Twist(SHIFT_B, SPIN_B))
    return a, b, path_a, path_b


def answer_at(a, b, path_a, path_b, t):
    """The answer at time t, with its rates, from a start there."""
    tracker = so.Tracker(a, b, law=so.PredictorCorrector(tolerance=1e-13))
    return tracker.start(path_a.pose(t), path_b.pose(t), path_a.twist(t), path_b.twist(t)).proximity


def central(values):
    """Derivative from the values at t - 2h, t - h, t + h, t + 2h (fourth order)."""
    far_back, back, ahead, far_ahead = values
    return (8 * (ahead - back) - (far_ahead - far_back)) / (12 * STEP)


OFFSETS = STEP * np.array([-2.0, -1.0, 1.0, 2.0])


@pytest.mark.parametrize("name", CASES)
def test_rates_are_derivatives(name):
    a, b, path_a, path_b = moving(name)
    kinds = CASES[name][3]
    for t in (0.0, 0.02):
        answer = answer_at(a, b, path_a, path_b, t)
        assert (answer.feature_a.kind, answer.feature_b.kind) == kinds
        around = [answer_at(a, b, path_a, path_b, t + h) for h in OFFSETS]
        assert {(x.feature_a, x.feature_b) for x in around} == {
            (answer.feature_a, answer.feature_b)
        }
        assert answer.rate == pytest.approx(central([x.distance for x in around]), abs=1e-10)
        for mine, points in (
            (answer.velocity_a, [x.point_a for x in around]),
            (answer.velocity_b, [x.point_b for x in around]),
        ):
            np.testing.assert_allclose(mine, central(points), atol=1e-10)


@pytest.mark.parametrize("name", CASES)
def test_rate_is_the_normal_part_of_the_witness_velocities(name):
    a, b, path_a, path_b = moving(name)
    answer = answer_at(a, b, path_a, path_b, 0.0)
    apart = answer.velocity_b - answer.velocity_a
    assert answer.rate == pytest.approx(float(answer.normal @ apart), abs=1e-12)


TRACKED_RATES = {
    "PC": (so.PredictorCorrector(predictor="feedforward"), 1e-10, 1e-5, 1e-5),
    "PC2": (so.PredictorCorrector(), 1e-10, 1e-5, 5e-8),
    "paper": (so.PaperLaw(), 1e-5, 1e-5, 1e-5),
}
"""Errors allowed of the rate, of the velocities, and of these after three frames."""


@pytest.mark.parametrize("law", TRACKED_RATES)
@pytest.mark.parametrize("name", CASES)
def test_tracked_rates(name, law):
    """At 1 ms, against a start at the same instant.

    The velocities come from the frame's one evaluation, which is at the predicted point: they
    miss by the prediction's error, 1e-6. The rate does not, but the paper's law lags.
    """
    tracked, rate_error, first_error, later_error = TRACKED_RATES[law]
    a, b, path_a, path_b = moving(name)
    tracker = so.Tracker(a, b, dt=1e-3, law=tracked)
    state = tracker.start(path_a.pose(0), path_b.pose(0), path_a.twist(0), path_b.twist(0))
    for k in range(1, 21):
        t = 1e-3 * k
        poses = path_a.pose(t), path_b.pose(t)
        state, answer = tracker.step(state, *poses, path_a.twist(t), path_b.twist(t))
        known = answer_at(a, b, path_a, path_b, t)
        assert (answer.feature_a, answer.feature_b) == (known.feature_a, known.feature_b)
        assert answer.rate == pytest.approx(known.rate, abs=rate_error)
        allowed = first_error if k <= 3 else later_error
        np.testing.assert_allclose(answer.velocity_a, known.velocity_a, atol=allowed)
        np.testing.assert_allclose(answer.velocity_b, known.velocity_b, atol=allowed)


@settings(max_examples=draws(30))
@given(pairs(APART, unbounded=False))
def test_rate_of_any_pair(pair):
    """Also at a switch: the second derivative jumps there, the first does not."""
    path_a, path_b, _ = pair.paths()
    step = 1e-5
    answer, back, ahead = (answer_at(pair.a, pair.b, path_a, path_b, t) for t in (0.0, -step, step))
    assert back.certified
    assert ahead.certified
    slope = (ahead.distance - back.distance) / (2 * step)
    modes = {(x.feature_a, x.feature_b) for x in (answer, back, ahead)}
    allowed = 1e-7 if len(modes) == 1 else 1e-4
    assert answer.rate == pytest.approx(slope, abs=allowed * pair.size)


def test_one_twist_leaves_the_other_body_at_rest():
    a, b, path_a, path_b = moving("ellipsoid, ellipsoid")
    pose_a, pose_b = path_a.pose(0.0), path_b.pose(0.0)
    tracker = so.Tracker(a, b)
    for twist_a, twist_b in ((path_a.twist(0), None), (None, path_b.twist(0))):
        full = [x if x is not None else so.Twist.zero() for x in (twist_a, twist_b)]
        one = tracker.start(pose_a, pose_b, twist_a, twist_b).proximity
        two = tracker.start(pose_a, pose_b, *full).proximity
        assert one.rate == two.rate
        assert (one.velocity_a == two.velocity_a).all()
        assert (one.velocity_b == two.velocity_b).all()


def test_twists_in_body_axes():
    a, b, path_a, path_b = moving("ellipsoid, ellipsoid")
    pose_a, pose_b = path_a.pose(0.0), path_b.pose(0.0)
    tracker = so.Tracker(a, b)
    turned = [
        so.Twist(pose.rotation.T @ twist.v, pose.rotation.T @ twist.omega, frame="body")
        for pose, twist in ((pose_a, path_a.twist(0)), (pose_b, path_b.twist(0)))
    ]
    one = tracker.start(pose_a, pose_b, path_a.twist(0), path_b.twist(0)).proximity
    two = tracker.start(pose_a, pose_b, *turned).proximity
    assert one.rate == pytest.approx(two.rate, abs=1e-15)
    np.testing.assert_allclose(one.velocity_a, two.velocity_a, atol=1e-14)


@pytest.mark.parametrize("predictor", ["secant", "feedforward-2", "none"])
def test_without_twists_there_are_no_rates(predictor):
    a, b, path_a, path_b = moving("ellipsoid, ellipsoid")
    tracker = so.Tracker(a, b, law=so.PredictorCorrector(predictor=predictor))
    state = tracker.start(path_a.pose(0.0), path_b.pose(0.0))
    answers = [state.proximity]
    for k in range(1, 4):
        state, answer = tracker.step(state, path_a.pose(1e-3 * k), path_b.pose(1e-3 * k))
        answers.append(answer)
    for answer in answers:
        assert answer.certified
        assert np.isnan(answer.rate)
        assert np.isnan(answer.velocity_a).all()
        assert np.isnan(answer.velocity_b).all()


@pytest.mark.parametrize("spin", [0.5, 1.0, 3.0])
@pytest.mark.parametrize("gap", [0.3, 0.1, 1e-3])
def test_parallel_faces_that_slide_have_no_wild_rates(gap, spin, rng):
    """An edge over a face whose chart turns: a pivot of H that vanishes keeps roundings."""
    a, b = so.shapes.box(0.9, 0.8, 0.6), so.shapes.cylinder(0.4, 0.6)
    home = so.Pose.identity()
    v, w = np.array([-0.25, 0.3, 0.0]), np.array([0.0, 0.0, spin])
    for _ in range(5):
        start = np.array([*rng.uniform(0.2, 0.35, 2), 0.6 + gap])
        tracker = so.Tracker(a, b, dt=1e-3)
        state = tracker.start(home, so.Pose.exp([0, 0, 0], start), twist_b=(v, w))
        for k in range(1, 6):
            pose = so.Pose.exp(k * 1e-3 * w, start + k * 1e-3 * v)
            state, answer = tracker.step(state, home, pose, twist_b=(v, w))
            fastest = np.linalg.norm(v) + spin
            assert np.linalg.norm(answer.velocity_a) <= 10.0 * fastest
            assert np.linalg.norm(answer.velocity_b) <= 10.0 * fastest


def test_points_without_any_size_that_touch_have_rates():
    """Point, half-space and gap 0 together have no length: none is divided by."""
    point, plane = so.shapes.point(), so.shapes.halfspace()
    home, v, w = so.Pose.identity(), np.array([0.3, -0.2, 0.1]), np.zeros(3)
    for a, b, normal in ((point, plane, (0, 0, -1)), (plane, point, (0, 0, 1))):
        tracker = so.Tracker(a, b, dt=1e-3)
        state = tracker.start(home, home, twist_b=(v, w))
        state, answer = tracker.step(state, home, home, twist_b=(v, w))
        assert answer.distance == 0.0
        assert answer.rate == pytest.approx(np.dot(v, normal), abs=1e-12)
        assert np.all(np.isfinite([answer.velocity_a, answer.velocity_b]))
