"""Feedbacks of the paper's law: their sampled error loops, and what each is for."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.geometry import BezierPatch
from standoff.tracking.feedback import growth_factor

DOME = so.shapes.cap(1.0, 0.2)
POINT = so.shapes.point()
AT_POINT = (("vertex", 0), ())
FACE = ("face", 0)
REST = np.eye(4)
ABOVE = so.Pose(np.eye(3), [0.1, 0.05, 2.0])
NO_TWIST = (np.zeros(3), np.zeros(3))
H = 1e-3

POLYNOMIALS = {
    "euler": lambda z: 1 + z,
    "heun": lambda z: 1 + z + z**2 / 2,
    "midpoint": lambda z: 1 + z + z**2 / 2,
    "rk4": lambda z: 1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24,
}


@pytest.mark.parametrize("integrator", POLYNOMIALS)
def test_growth_factors_are_the_known_polynomials(integrator: str) -> None:
    z = np.random.default_rng(3).normal(size=(50, 2)) @ [2.0, 2.0j]
    found = growth_factor(integrator, z)
    np.testing.assert_allclose(found, POLYNOMIALS[integrator](z), rtol=1e-13)


def errors_at_rest(
    steps: int, start: float = 1e-4, body: so.Body = DOME, **options: object
) -> np.ndarray:
    """Psi (u, v) of the dome against a point at rest, (steps + 1, 2), begun beside the optimum."""
    tracker = so.Tracker(body, POINT, dt=H, law=so.PaperLaw(**options))
    best = so.distance(body, POINT, REST, ABOVE)
    u, v, *chart = best.parameters_a
    place = (u + start, v - 0.6 * start, *chart)
    state = tracker.start_from(REST, ABOVE, (best.feature_a, place), AT_POINT, settle=False)
    rows = [psi_of(body, state.proximity)]
    for _ in range(steps):
        state, answer = tracker.step(state, REST, ABOVE, NO_TWIST, NO_TWIST)
        rows.append(psi_of(body, answer))
    return np.array(rows)


def psi_of(body: so.Body, answer: so.Proximity) -> np.ndarray:
    place = answer.feature_a, answer.parameters_a
    return so.tracking.pair_system(body, POINT, REST, ABOVE, place, AT_POINT).Psi


@pytest.mark.parametrize("integrator", POLYNOMIALS)
def test_linear_errors_shrink_by_the_growth_factor(integrator: str) -> None:
    psi = errors_at_rest(5, integrator=integrator, feedback=so.feedback.Linear(600.0))
    factor = growth_factor(integrator, -600.0 * H)
    np.testing.assert_allclose(psi[1:] / psi[:-1], factor, rtol=2e-3)


def test_a_linear_feedback_is_the_gain() -> None:
    by_gain = errors_at_rest(3, gain=600.0)
    np.testing.assert_array_equal(by_gain, errors_at_rest(3, feedback=so.feedback.Linear(600.0)))


def test_every_error_has_its_own_gain() -> None:
    psi = errors_at_rest(4, feedback=so.feedback.GainMatrix([300.0, 900.0, 1.0, 1.0]))
    for k, gain in enumerate((300.0, 900.0)):
        factor = growth_factor("heun", -gain * H)
        np.testing.assert_allclose(psi[1:, k] / psi[:-1, k], factor, rtol=2e-3)


def test_a_full_gain_matrix_couples_the_errors() -> None:
    gains = 500.0 * np.eye(4)
    gains[0, 1], gains[1, 0] = 200.0, -300.0
    psi = errors_at_rest(6, integrator="rk4", feedback=so.feedback.GainMatrix(gains))
    expected = [expm(-gains[:2, :2] * H * k) @ psi[0] for k in range(7)]
    np.testing.assert_allclose(psi, expected, atol=2e-3 * np.abs(psi[0]).max())


def test_pi_errors_follow_the_linear_system() -> None:
    gain, integral = 400.0, 8e4
    feedback = so.feedback.PI(gain, integral)
    psi = errors_at_rest(40, integrator="rk4", feedback=feedback)
    loop = np.array([[-gain, -integral], [1.0, 0.0]])
    for k in range(2):
        expected = [(expm(loop * H * n) @ [psi[0, k], 0.0])[0] for n in range(41)]
        np.testing.assert_allclose(psi[:, k], expected, atol=3e-3 * abs(psi[0, k]))
    assert psi[:, 0].min() < -0.01 * psi[0, 0]  # the integral makes it overshoot


def test_sign_power_errors_vanish_in_finite_time() -> None:
    """|Psi| falls as (1 - t/T)^(1/(1 - power)), T = |Psi_0/ref|^(1 - power) / (K (1 - power))."""
    psi_0 = errors_at_rest(0, start=0.02)[0]
    gain, power = 50.0, 0.5
    feedback = so.feedback.FiniteTime(gain, power, abs(psi_0[0]))
    psi = errors_at_rest(60, start=0.02, integrator="rk4", feedback=feedback)
    time = H * np.arange(len(psi))
    end = 1.0 / (gain * (1.0 - power))
    ahead = time < 0.8 * end
    expected = psi_0[0] * (1.0 - time[ahead] / end) ** (1.0 / (1.0 - power))
    np.testing.assert_allclose(psi[ahead, 0], expected, rtol=0.03)
    linear = errors_at_rest(60, start=0.02, integrator="rk4", gain=gain)
    assert abs(psi[-1, 0]) < 1e-9 * abs(psi_0[0]) < 1e-7 * abs(linear[-1, 0])


def lag(motion_seen: float, **options: object) -> float:
    """Witness error [length] after 0.4 s beside a point that passes at 1 length/s, of whose
    velocity the tracker sees a part."""
    tracker = so.Tracker(DOME, POINT, dt=H, law=so.PaperLaw(**options))
    velocity = np.array([1.0, 0.0, 0.0])

    def pose(k: int) -> so.Pose:
        return so.Pose(np.eye(3), [-0.2 + k * H, 0.05, 2.0])

    seen = so.Twist(motion_seen * velocity, np.zeros(3))
    state = tracker.start(REST, pose(0), NO_TWIST, seen)
    for k in range(1, 401):
        state, answer = tracker.step(state, REST, pose(k), NO_TWIST, seen)
    return float(np.linalg.norm(answer.point_a - so.distance(DOME, POINT, REST, pose(400)).point_a))


def test_pi_takes_up_what_wrong_twists_leave() -> None:
    linear = lag(0.7, feedback=so.feedback.Linear(200.0))
    both = lag(0.7, feedback=so.feedback.PI(200.0, 1e4))
    assert linear == pytest.approx(0.3 * 1.0 / 2.0 / 200.0, rel=0.5)
    assert both < 0.05 * linear


@pytest.mark.parametrize("error", [3e-3, 1e-2])
def test_the_gain_of_the_motion_keeps_the_wanted_error(error: float) -> None:
    """Without feedforward the projection error settles at |b|/K = error; the witness error is
    that over 1 + d/R = 2, for a point at twice a unit sphere's radius."""
    found = lag(1.0, feedforward=False, feedback=so.feedback.MotionGain(error))
    assert found == pytest.approx(0.5 * error, rel=0.1)


def test_the_gain_of_the_motion_stays_in_its_bounds() -> None:
    bounded = so.feedback.MotionGain(1e-9, least=10.0, most=300.0)
    fixed = so.feedback.Linear(300.0)
    assert lag(1.0, feedforward=False, feedback=bounded) == lag(
        1.0, feedforward=False, feedback=fixed
    )
    slow = so.feedback.MotionGain(1e9, least=250.0, most=300.0)
    fixed = so.feedback.Linear(250.0)
    assert lag(1.0, feedforward=False, feedback=slow) == lag(1.0, feedforward=False, feedback=fixed)


@pytest.mark.parametrize(("most", "feedforward"), [(100.0, False), (300.0, False), (100.0, True)])
def test_stages_whose_gain_is_cut_are_counted(most: float, feedforward: bool) -> None:
    """|b| = 1 length/s beside a point; with the feedforward the gain has nothing to keep."""
    feedback = so.feedback.MotionGain(5e-3, most=most, least=1.0)
    law = so.PaperLaw(feedback=feedback, feedforward=feedforward)
    tracker, twist = so.Tracker(DOME, POINT, dt=H, law=law), so.Twist([1.0, 0.0, 0.0], np.zeros(3))
    poses = [so.Pose(np.eye(3), [-0.1 + k * H, 0.05, 2.0]) for k in range(11)]
    state, cut = tracker.start(REST, poses[0], NO_TWIST, twist), 0
    for pose in poses[1:]:
        state, answer = tracker.step(state, REST, pose, NO_TWIST, twist)
        cut += answer.counts.saturations
    # Heun's two stages, and the rates at the answer, of each frame
    assert cut in ((20, 30) if most < 200.0 and not feedforward else (0,))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: so.feedback.Linear(-1.0), "gain = -1.0: must be positive"),
        (lambda: so.feedback.Linear(float("nan")), "gain = nan"),
        (lambda: so.feedback.PI(1.0, 0.0), "integral = 0.0"),
        (lambda: so.feedback.PI("5", "6"), "gain = '5' is not a number"),
        (lambda: so.feedback.GainMatrix([1.0, 2.0]), "four finite gains"),
        (lambda: so.feedback.GainMatrix(-np.eye(4)), "do not decay"),
        (lambda: so.feedback.FiniteTime(1.0, 1.5, 1.0), "power = 1.5: must be above 0"),
        (lambda: so.feedback.FiniteTime(10.0, 0.5, 1.0, most=1.0), "less than gain"),
        (lambda: so.feedback.MotionGain(0.0), "error = 0.0"),
    ],
)
def test_what_is_no_feedback_is_refused(make: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_a_matrix_must_be_stable_on_edges_and_vertices_too() -> None:
    """Stable as a whole, but not with the second parameter deleted."""
    gains = np.diag([-1.0, 5.0, 3.0, 3.0])
    gains[0, 1], gains[1, 0] = 4.0, -4.0
    assert (np.linalg.eigvals(gains).real > 0.0).all()
    with pytest.raises(ValueError, match="edge's or a vertex's rows"):
        so.feedback.GainMatrix(gains)


@pytest.mark.parametrize(
    "feedback",
    [
        so.feedback.Linear(2000.0),
        so.feedback.GainMatrix([2100.0, 1.0, 1.0, 1.0]),
        so.feedback.PI(100.0, 5e7),
        so.feedback.FiniteTime(1.0, 0.5, 1.0, most=2500.0),
        so.feedback.MotionGain(1e-3, most=2500.0),
    ],
    ids=str,
)
def test_an_unstable_feedback_is_refused(feedback: so.feedback.Feedback) -> None:
    with pytest.raises(ValueError, match=r"not stable for heun at dt = 0\.001"):
        so.Tracker(DOME, POINT, dt=H, law=so.PaperLaw(feedback=feedback))


def test_a_feedback_is_for_the_papers_law() -> None:
    with pytest.raises(TypeError, match="has no option"):
        so.PredictorCorrector(feedback=so.feedback.Linear(1.0))
    with pytest.raises(ValueError, match="both name the gain"):
        so.PaperLaw(gain=1.0, feedback=so.feedback.Linear(1.0))
    with pytest.raises(TypeError, match=r"give one of so\.feedback"):
        so.PaperLaw(feedback=3.0)
    with pytest.raises(ValueError, match="least gain"):
        so.Tracker(DOME, POINT, law=so.PaperLaw(feedback=so.feedback.MotionGain(1.0, least=1e9)))


def frustum(top: float) -> so.Body:
    """A pyramid cut off near its tip, sewn from six bilinear patches."""
    ring = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    low = np.column_stack([ring, np.zeros(4)])
    high = np.column_stack([top * ring, np.ones(4)])
    corners = [(low[i], high[i], low[i - 3], high[i - 3]) for i in range(4)]
    corners += [(high[0], high[3], high[1], high[2]), (low[0], low[1], low[3], low[2])]
    return so.Body.from_patches([BezierPatch(np.reshape(four, (2, 2, 3))) for four in corners])


def test_an_integral_that_winds_up_is_saturated_and_counted() -> None:
    # in frame 33 it had reached 3e20, and LAPACK's refusal of infinite numbers left the step
    body = frustum(0.01)
    tracker = so.Tracker(
        body, body, H, law=so.PaperLaw(integrator="rk4", feedback=so.feedback.PI(300.0, 1e4))
    )
    turn, velocity = np.array([215.25, -90.62, 522.04]), np.array([-1.3063, 0.5681, -1.4545])
    first = so.Pose.from_wxyz(
        [-1.45861645e-02, -1.09736594e-04, -3.95872320e-02, 9.99109645e-01],
        [-2.36573473, 0.26016529, 1.82636612],
    )
    state = tracker.start(REST, first)
    saturations = 0
    for k in range(1, 200):
        turned = Rotation.from_rotvec(turn * k * H).as_matrix() @ first.rotation
        pose = so.Pose(turned, first.translation + velocity * k * H)
        state, answer = tracker.step(state, REST, pose, twist_b=so.Twist(velocity, turn))
        saturations += answer.counts.saturations
        assert np.isfinite(answer.distance)
        assert answer.lower_bound <= so.distance(body, body, REST, pose).upper_bound + 1e-12
        # ten spans of a tangent's length at most, over K_i / K_p
        assert np.abs(state.integral).max() <= 10.0 * 12.0 * 3.0 / (1e4 / 300.0)
    assert saturations > 0
