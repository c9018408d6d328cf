"""The paper's law treats both bodies alike, and starts its integrals anew where it must."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.spatial.transform import Rotation

import standoff as so
from standoff_studies.paper.bodies import lens_of_patches

LENS = so.shapes.lens(1.0, 0.45)
PATCHED = lens_of_patches()
ELLIPSOID = so.shapes.ellipsoid(0.5, 0.4, 0.3)
POINT = so.shapes.point()
AT_POINT = (("vertex", 0), ())
REST = np.eye(4)
STILL = so.Twist(np.zeros(3), np.zeros(3))
H = 1e-3
SPIN = np.array([0.9, -1.4, 2.1])
GAINS_A, GAINS_B = (
    np.array([[300.0, 80.0], [-60.0, 500.0]]),
    np.array([[600.0, -90.0], [40.0, 200.0]]),
)


def orbit(k: int) -> tuple[so.Pose, so.Twist]:
    """A body that turns while it circles the lens."""
    angle = 3.0 * k * H
    x = 1.9 * np.array([np.cos(angle), np.sin(angle), 0.2])
    turn = Rotation.from_rotvec(SPIN * k * H).as_matrix()
    return so.Pose(turn, x), so.Twist(3.0 * np.array([-x[1], x[0], 0.0]), SPIN)


def both_ways(
    steps: int, other: so.Body, there: dict[str, Any], back: dict[str, Any]
) -> tuple[so.TrackerState, so.TrackerState]:
    """The states of (lens, other) and of (other, lens), from the same wrong start."""
    forth = so.Tracker(LENS, other, dt=H, law=so.PaperLaw(**there))
    turned = so.Tracker(other, LENS, dt=H, law=so.PaperLaw(**back))
    pose, twist = orbit(0)
    wrong = so.distance(LENS, other, REST, so.Pose(pose.rotation, [1.9, 0.25, 0.2]))
    places = (
        (wrong.feature_a, wrong.parameters_a),
        (wrong.feature_b, wrong.parameters_b),
    )
    one = forth.start_from(REST, pose, *places, STILL, twist, settle=False)
    two = turned.start_from(pose, REST, places[1], places[0], twist, STILL, settle=False)
    for k in range(1, steps + 1):
        pose, twist = orbit(k)
        one, _ = forth.step(one, REST, pose, STILL, twist)
        two, _ = turned.step(two, pose, REST, twist, STILL)
    return one, two


VARIANTS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    name: (options, options)
    for name, options in {
        "integrated": {"realisation": "integrated", "gain": 300.0},
        "PI": {"feedback": so.feedback.PI(300.0, 3e4)},
        "finite time": {"feedback": so.feedback.FiniteTime(80.0, 0.5, 0.05)},
        "motion": {"feedback": so.feedback.MotionGain(5e-3), "feedforward": False},
        "voronoi": {"switching": "voronoi", "gain": 300.0},
        "none": {"switching": "none", "gain": 300.0},
        "plain": {"solve": "plain", "gain": 300.0},
    }.items()
} | {
    "matrix": (
        {"feedback": so.feedback.GainMatrix(block_diag(GAINS_A, GAINS_B))},
        {"feedback": so.feedback.GainMatrix(block_diag(GAINS_B, GAINS_A))},
    )
}


@pytest.mark.parametrize("steps", [4, 700])
@pytest.mark.parametrize("other", [ELLIPSOID, PATCHED], ids=["ellipsoid", "patches"])
@pytest.mark.parametrize("name", VARIANTS)
def test_the_bodies_may_change_places(name: str, other: so.Body, steps: int) -> None:
    """dR changes its sign, and nothing else: no body is the first."""
    one, two = both_ways(steps, other, *VARIANTS[name])
    found, turned = one.proximity, two.proximity
    assert (found.feature_a, found.feature_b) == (turned.feature_b, turned.feature_a)
    np.testing.assert_allclose(found.point_a, turned.point_b, atol=1e-9)
    np.testing.assert_allclose(found.point_b, turned.point_a, atol=1e-9)
    for left, right in ((one.errors, two.errors), (one.integral, two.integral)):
        np.testing.assert_allclose(left, -right[[2, 3, 0, 1]], atol=1e-9)
    assert np.abs(one.errors).max() > 0.0


def test_a_matrix_acts_on_the_errors_of_b() -> None:
    """Each error of the second body decays by its own gain, the first body a point."""
    gains = [1.0, 1.0, 300.0, 900.0]
    tracker = so.Tracker(
        POINT,
        LENS,
        dt=H,
        law=so.PaperLaw(feedback=so.feedback.GainMatrix(gains), integrator="heun"),
    )
    at = so.Pose(np.eye(3), [1.2, 0.3, 0.4])
    best = so.distance(POINT, LENS, at, REST)
    place = (best.parameters_b[0] + 1e-4, best.parameters_b[1] - 6e-5)
    state = tracker.start_from(at, REST, AT_POINT, (best.feature_b, place), settle=False)
    first = state.errors[2:]
    state, _ = tracker.step(state, at, REST, STILL, STILL)
    z = H * np.array(gains[2:])
    np.testing.assert_allclose(state.errors[2:] / first, 1 - z + z**2 / 2, rtol=2e-3)


def psi(body: so.Body, pose: so.Pose, answer: so.Proximity) -> np.ndarray:
    place = answer.feature_a, answer.parameters_a
    return so.tracking.pair_system(body, POINT, REST, pose, place, AT_POINT).Psi


def circle(k: int, radius: float) -> tuple[so.Pose, so.Twist]:
    angle = 4.0 * k * H
    x = radius * np.array([np.cos(angle), np.sin(angle), 0.25])
    return so.Pose(np.eye(3), x), so.Twist(4.0 * np.array([-x[1], x[0], 0.0]), np.zeros(3))


def test_errors_start_anew_in_another_chart() -> None:
    """Their units are a chart's own."""
    tracker = so.Tracker(
        ELLIPSOID, POINT, dt=H, law=so.PaperLaw(realisation="integrated", gain=300.0)
    )
    pose, twist = circle(0, 1.0)
    state, changes = tracker.start(REST, pose, STILL, twist), 0
    for k in range(1, 1600):
        pose, twist = circle(k, 1.0)
        state, answer = tracker.step(state, REST, pose, STILL, twist)
        if answer.counts.chart_changes:
            changes += 1
            np.testing.assert_allclose(
                state.errors[:2], psi(ELLIPSOID, pose, answer), atol=1e-14, err_msg=str(k)
            )
    assert changes >= 3


def test_errors_start_anew_at_a_saturation() -> None:
    """A zeroed component has not done what the integral says."""
    tracker = so.Tracker(
        PATCHED,
        POINT,
        dt=H,
        law=so.PaperLaw(realisation="integrated", switching="none", gain=300.0),
    )
    pose, twist = circle(0, 1.6)
    state = tracker.start_from(
        REST, pose, (("face", 0), (0.9, 0.2)), AT_POINT, STILL, twist, settle=False
    )
    saturated = 0
    for k in range(1, 400):
        pose, twist = circle(k, 1.6)
        state, answer = tracker.step(state, REST, pose, STILL, twist)
        if answer.counts.saturations:
            saturated += 1
            np.testing.assert_allclose(state.errors[:2], psi(PATCHED, pose, answer), atol=1e-14)
    assert saturated > 100


def test_the_integral_starts_anew_at_a_switch() -> None:
    tracker = so.Tracker(LENS, POINT, dt=H, law=so.PaperLaw(feedback=so.feedback.PI(300.0, 3e4)))
    pose, twist = circle(0, 1.6)
    half = so.Twist(0.5 * twist.v, twist.omega)  # wrong, so that there is an integral
    state, switched = tracker.start(REST, pose, STILL, half), 0
    for k in range(1, 1600):
        pose, twist = circle(k, 1.6)
        before = np.abs(state.integral).max()
        half = so.Twist(0.5 * twist.v, twist.omega)
        state, answer = tracker.step(state, REST, pose, STILL, half)
        if answer.events:
            switched += 1
            assert before > 0.0
            np.testing.assert_array_equal(state.integral, 0.0)
    assert switched >= 3


def test_errors_and_integral_start_anew_after_an_overlap() -> None:
    tracker = so.Tracker(LENS, POINT, dt=H, law=so.PaperLaw(feedback=so.feedback.PI(300.0, 3e4)))
    away, inside = so.Pose(np.eye(3), [1.4, 0.2, 0.1]), so.Pose(np.eye(3), [0.05, 0.0, 0.0])
    best = so.distance(LENS, POINT, REST, away)
    wrong = (best.parameters_a[0] + 0.05, best.parameters_a[1])
    state = tracker.start_from(REST, away, (best.feature_a, wrong), AT_POINT, settle=False)
    for _ in range(3):
        state, _ = tracker.step(state, REST, away, STILL, STILL)
    assert np.abs(state.integral).max() > 1e-6
    state, answer = tracker.step(state, REST, inside, STILL, STILL)
    assert answer.status is so.Status.GLOBAL
    assert answer.distance < 0.0
    np.testing.assert_array_equal(state.integral, 0.0)
    state, answer = tracker.step(state, REST, away, STILL, STILL)
    assert answer.distance == pytest.approx(best.distance, rel=1e-12)
    np.testing.assert_array_equal(state.integral, 0.0)
    np.testing.assert_allclose(state.errors, 0.0, atol=1e-12)


def test_velocities_are_those_of_the_feedforward_alone() -> None:
    """The feedback is the law's own correction, no motion of the witness points."""
    pose, twist = circle(3, 1.6)
    found = []
    for gain in (1.0, 900.0):
        tracker = so.Tracker(LENS, POINT, dt=H, law=so.PaperLaw(gain=gain))
        state = tracker.start_from(
            REST, pose, (("face", 0), (0.35, 0.2)), AT_POINT, STILL, twist, settle=False
        )
        found.append(state.proximity.velocity_a)
    np.testing.assert_array_equal(*found)


def test_a_swept_partner_that_reaches_a_feature_is_tracked_on_it() -> None:
    """With switching="none" one feature is tracked; what its certificate shows is said."""
    ball = so.shapes.sphere(0.2)
    near = so.Pose(np.eye(3), [0.65, 0.0, 0.0])
    at = (("face", 0), (0.0, 0.0)), AT_POINT
    tracker = so.Tracker(LENS, ball, dt=H, law=so.PaperLaw(switching="none"))
    state = tracker.start_from(REST, near, *at, settle=False)
    _, answer = tracker.step(state, REST, near, STILL, STILL)
    for found in (state.proximity, answer):
        # the ball's centre is outside the lens, certified: so is the depth
        assert found.status is so.Status.GLOBAL
        assert found.feature_a == so.Feature("face", 0)
        assert found.distance == pytest.approx(-0.1, abs=1e-12)


def test_the_raw_law_makes_no_step_where_it_has_none() -> None:
    """Parallel faces: H is singular, and the ranked law's least step is none of the raw law's."""
    box = so.shapes.box(1.0, 1.0, 1.0)
    above = so.Pose(np.eye(3), [0.0, 0.0, 1.5])
    top, bottom = so.distance(box, box, REST, above), so.distance(box, box, above, REST)
    tracker = so.Tracker(box, box, dt=H, law=so.PaperLaw(solve="plain"))
    state = tracker.start_from(
        REST, above, (top.feature_a, (0.5, 0.5)), (bottom.feature_a, (0.4, 0.4)), settle=False
    )
    _, answer = tracker.step(state, REST, above, STILL, STILL)
    assert answer.counts.regularised >= 2
    assert (answer.parameters_a, answer.parameters_b) == ((0.5, 0.5), (0.4, 0.4))
