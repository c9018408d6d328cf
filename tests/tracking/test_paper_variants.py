"""The paper's law as printed: its two block diagrams, its saturation, its Voronoi switching."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from standoff_studies.paper.bodies import lens_of_patches, planar_body

LENS = so.shapes.lens(1.0, 0.45)
PATCHED = lens_of_patches()
LOOP = planar_body()
BOX = so.shapes.box(0.5, 0.6, 0.7)
POINT = so.shapes.point()
AT_POINT = (("vertex", 0), ())
REST = np.eye(4)
STILL = so.Twist(np.zeros(3), np.zeros(3))
H = 1e-3
SPEED = 4.0


def circling(k: int, h: float = H, height: float = 0.4) -> tuple[so.Pose, so.Twist]:
    """A point on a circle of radius 1.6 about the lens, 4 rad/s."""
    angle = SPEED * k * h
    x = np.array([1.6 * np.cos(angle), 1.6 * np.sin(angle), height])
    return so.Pose(np.eye(3), x), so.Twist(SPEED * np.array([-x[1], x[0], 0.0]), np.zeros(3))


def walk(
    body: so.Body, steps: int, start: tuple[Any, Any], h: float = H, **options: Any
) -> tuple[list[so.TrackerState], so.Tracker]:
    tracker = so.Tracker(body, POINT, dt=h, law=so.PaperLaw(**options))
    pose, twist = circling(0, h)
    state = tracker.start_from(REST, pose, start, AT_POINT, STILL, twist, settle=False)
    states = [state]
    for k in range(1, steps + 1):
        pose, twist = circling(k, h)
        state, _ = tracker.step(state, REST, pose, STILL, twist)
        states.append(state)
    return states, tracker


def switches(states: list[so.TrackerState]) -> list[tuple[float, str, str]]:
    return [
        (round(e.time, 9), str(e.source), str(e.target))
        for state in states
        for e in state.proximity.events
    ]


WRONG = ("face", 0), (0.35, 0.2)
PATCH_WRONG = ("face", 0), (0.9, 0.2)


def true_errors(state: so.TrackerState, k: int) -> np.ndarray:
    answer = state.proximity
    place = answer.feature_a, answer.parameters_a
    return so.tracking.pair_system(LENS, POINT, REST, circling(k)[0], place, AT_POINT).Psi


def test_integrated_errors_decay_by_themselves() -> None:
    """In Fig. 3 the controller sees its own integral of Psi' = M w + b = -K Psi: it falls as the
    integrator says, whatever the parameters do."""
    gain = 300.0
    states, _ = walk(LENS, 30, WRONG, gain=gain, realisation="integrated")
    assert not switches(states)
    factor = 1 - gain * H + (gain * H) ** 2 / 2
    expected = states[0].errors[:2] * factor ** np.arange(31)[:, None]
    np.testing.assert_allclose([s.errors[:2] for s in states], expected, rtol=1e-10)


def test_both_realisations_agree_as_the_step_shrinks() -> None:
    apart = []
    for n in (2, 4, 8):
        h = H / n
        ends = [
            walk(LENS, 40 * n, WRONG, h=h, gain=100.0, realisation=name)[0][-1].proximity.point_a
            for name in ("integrated", "evaluated")
        ]
        apart.append(float(np.linalg.norm(ends[0] - ends[1])))
    assert 0.0 < apart[2] < apart[1] < apart[0] < 1e-3
    np.testing.assert_allclose(np.log2(apart[:-1]) - np.log2(apart[1:]), 2.0, atol=0.4)


def test_integrated_errors_start_anew_at_a_switch() -> None:
    states, _ = walk(LENS, 1600, WRONG, realisation="integrated")
    found = switches(states)
    assert len(found) >= 3
    for k, state in enumerate(states):
        if state.proximity.events:
            np.testing.assert_allclose(
                state.errors[: len(state.proximity.parameters_a)], true_errors(state, k), atol=1e-13
            )


def test_integrated_errors_know_the_motion_that_the_law_leaves_out() -> None:
    """Without feedforward both realisations lag by the same |b|/K; the integral has the whole b."""
    right = so.distance(LENS, POINT, REST, circling(0)[0])
    start = right.feature_a, right.parameters_a
    ends = [
        walk(LENS, 150, start, gain=300.0, feedforward=False, realisation=name)[0][-1].proximity
        for name in ("integrated", "evaluated")
    ]
    exact = so.distance(LENS, POINT, REST, circling(150)[0])
    lags = [end.point_a - exact.point_a for end in ends]
    assert np.linalg.norm(lags[1]) > 1e-3
    np.testing.assert_allclose(lags[0], lags[1], atol=0.05 * np.linalg.norm(lags[1]))


@pytest.mark.parametrize("saturation", ["hold", "zero"])
def test_a_step_that_a_boundary_cuts_is_read_anew(saturation: str) -> None:
    """On a box Psi is linear, so its integral is exact, but for a step that a boundary has cut:
    then it is read from Eqs. (1)-(4) again, even where the frame ends on the face it began on."""
    rng = np.random.default_rng(0)
    switching = "multipliers" if saturation == "hold" else "voronoi"
    options = {"gain": 1800.0, "integrator": "euler", "realisation": "integrated"}
    tracker = so.Tracker(BOX, POINT, dt=H, law=so.PaperLaw(switching=switching, **options))
    for _ in range(40):
        # the minimum is near a side, and a step of K h = 1.8 from within overshoots that side
        x = [0.25 - rng.uniform(0.0, 0.02), rng.uniform(-0.2, 0.2), 0.35 + rng.uniform(0.5, 1.5)]
        pose = so.Pose(np.eye(3), x)
        best = so.distance(BOX, POINT, REST, pose)
        within = so.distance(BOX, POINT, REST, so.Pose(np.eye(3), [x[0] - 0.03, x[1], x[2]]))
        assert best.feature_a == within.feature_a
        start = within.feature_a, within.parameters_a
        state = tracker.start_from(REST, pose, start, AT_POINT, STILL, STILL)
        for _ in range(100):
            state, answer = tracker.step(state, REST, pose, STILL, STILL)
        assert np.linalg.norm(answer.point_a - best.point_a) < 1e-9


def test_voronoi_switches_do_not_depend_on_the_witness_point() -> None:
    """Issue 4: for a body and a point the switching times do not depend on the continuous state."""
    starts = [WRONG, (("face", 0), (-0.3, -0.2)), (("face", 0), (0.1, 0.4))]
    runs = [
        switches(walk(LENS, 1600, start, gain=20.0, switching="voronoi")[0]) for start in starts
    ]
    assert len(runs[0]) == 6
    assert runs[0] == runs[1] == runs[2]
    by_multipliers = [switches(walk(LENS, 1600, start, gain=20.0)[0]) for start in starts]
    assert by_multipliers[0] != by_multipliers[1] or by_multipliers[1] != by_multipliers[2]


@pytest.mark.parametrize(("body", "start"), [(LENS, WRONG), (PATCHED, PATCH_WRONG)])
def test_voronoi_switching_visits_the_true_features(body: so.Body, start: Any) -> None:
    states, tracker = walk(body, 1600, start, switching="voronoi")
    assert tracker.resolved_law.saturation == "zero"
    for k, state in enumerate(states[20:], start=20):
        truth = so.distance(body, POINT, REST, circling(k)[0])
        assert state.proximity.feature_a == truth.feature_a, k
        # in the frame of a switch the point has moved on by one step: 6e-3 of the length
        assert np.linalg.norm(state.proximity.point_a - truth.point_a) < 7e-3


def test_voronoi_switching_between_two_bodies() -> None:
    """Every frame's features are those of a cold query, but for the frames beside a switch."""
    tracker = so.Tracker(LENS, BOX, dt=H, law=so.PaperLaw(switching="voronoi"))

    def motion(k: int) -> tuple[so.Pose, so.Twist]:
        spin = np.array([0.9, -1.4, 2.1])
        centre = np.array([1.9 * np.cos(k * H), 1.9 * np.sin(k * H), 0.3])
        rate = np.array([-centre[1], centre[0], 0.0])
        turn = Rotation.from_rotvec(spin * k * H).as_matrix()
        return so.Pose(turn, centre), so.Twist(rate, spin)

    pose, twist = motion(0)
    state = tracker.start(REST, pose, STILL, twist)
    different, visited = 0, set()
    for k in range(1, 3001):
        pose, twist = motion(k)
        state, answer = tracker.step(state, REST, pose, STILL, twist)
        truth = so.distance(LENS, BOX, REST, pose)
        modes = [(x.feature_a, x.feature_b) for x in (answer, truth)]
        visited.add(modes[0])
        different += modes[0] != modes[1]
        assert answer.distance - truth.distance < 1e-4
    assert len(visited) >= 8
    assert different <= 40


def test_zeroed_components_keep_the_patch() -> None:
    """Saturated, a point stays on its face with parameters at a bound, and every zeroing counts."""
    states, _ = walk(PATCHED, 400, PATCH_WRONG, switching="none")
    parameters = np.array([s.proximity.parameters_a for s in states])
    assert all(str(s.proximity.feature_a) == "face 0" for s in states)
    assert not switches(states)
    assert (parameters >= 0.0).all()
    assert (parameters <= 1.0).all()
    at_bound = (parameters[:, 0] == 0.0) | (parameters[:, 0] == 1.0)
    assert at_bound[-100:].all()
    counted = np.array([s.proximity.counts.saturations for s in states])
    assert (counted[-100:] >= 1).all()
    assert counted[2:10].sum() == 0  # before, the gain of a wrong start is lowered


def test_the_integral_waits_at_a_bound() -> None:
    """PI feedback held at a patch's bound would wind its integral up and leave the bound late."""
    states, _ = walk(
        PATCHED, 400, PATCH_WRONG, switching="none", feedback=so.feedback.PI(400.0, 2e4)
    )
    held = [k for k, s in enumerate(states) if k and s.proximity.counts.saturations]
    assert len(held) > 50
    for k in held:
        np.testing.assert_array_equal(states[k].integral, states[k - 1].integral)
    free = next(k for k in range(1, 400) if k not in held)
    assert (states[free].integral != states[free - 1].integral).any()


def test_parallel_trackers_may_begin_anywhere() -> None:
    """A start inside finds no certified pair; a tracker that keeps its features goes on from it."""
    inside = so.Pose(np.eye(3), [0.1, 0.05, 0.0])
    tracker = so.Tracker(LOOP, POINT, dt=H, law=so.PaperLaw(switching="none"))
    state = tracker.start(REST, inside, STILL, STILL)
    feature = state.proximity.feature_a
    for _ in range(20):
        state, answer = tracker.step(state, REST, inside, STILL, STILL)
        assert answer.counts.restarts == 0
        assert answer.feature_a == feature


def test_zeroing_after_the_solve_is_biased_until_it_is_at_rest() -> None:
    """Solved with both parameters and then zeroed, v misses the edge's own minimum, because H
    couples them: the default, which solves on the edge, does not."""
    far = so.Pose(np.eye(3), circling(900)[0].translation + np.array([0.0, 0.0, 0.35]))

    def last(**options: Any) -> so.Proximity:
        tracker = so.Tracker(PATCHED, POINT, dt=H, law=so.PaperLaw(gain=500.0, **options))
        state = tracker.start_from(REST, far, PATCH_WRONG, AT_POINT, settle=False)
        for _ in range(400):
            state, answer = tracker.step(state, REST, far, STILL, STILL)
        return answer

    printed, truth = last(switching="none"), so.distance(PATCHED, POINT, REST, far)
    assert printed.distance > truth.distance + 1e-6
    assert last().distance == pytest.approx(truth.distance, abs=1e-12)


def test_parallel_trackers_stay_on_their_curves() -> None:
    """Each of the loop's three curves tracked from inside; the nearest gives the golden depth."""
    inside = so.Pose(np.eye(3), [0.1, 0.05, 0.0])
    depth = []
    for curve in range(3):
        tracker = so.Tracker(LOOP, POINT, dt=H, law=so.PaperLaw(gain=500.0, switching="none"))
        state = tracker.start_from(REST, inside, (("edge", curve), (0.5,)), AT_POINT, settle=False)
        for _ in range(100):
            state, answer = tracker.step(state, REST, inside, STILL, STILL)
            assert answer.feature_a == so.Feature("edge", curve)
            assert answer.status is not so.Status.OVERLAPPING
        depth.append((answer.distance, answer.parameters_a[0]))
    assert min(depth)[0] == pytest.approx(0.742667779143, abs=1e-10)
    assert depth[0] == min(depth)
    assert depth[0][1] == pytest.approx(0.40068024, abs=1e-7)


def test_the_raw_law_goes_to_the_far_side() -> None:
    """Without safeguards a start behind an ellipsoid's equator ends at another stationary point."""
    body = so.shapes.ellipsoid(1.0, 0.8, 0.6)
    far = so.Pose(np.eye(3), [0.0, 0.0, 3.0])
    ends = {}
    for solve in ("plain", "ranked"):
        tracker = so.Tracker(body, POINT, dt=H, law=so.PaperLaw(solve=solve, gain=500.0))
        behind = so.distance(body, POINT, REST, so.Pose(np.eye(3), [0.3, 0.2, -3.0]))
        state = tracker.start_from(
            REST, far, (behind.feature_a, behind.parameters_a), AT_POINT, settle=False
        )
        for _ in range(400):
            state, answer = tracker.step(state, REST, far, STILL, STILL)
        ends[solve] = answer
    assert ends["plain"].point_a[2] == pytest.approx(-0.6, abs=1e-6)
    assert not ends["plain"].certified
    assert ends["ranked"].point_a[2] > -0.5


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"realisation": "both"}, "realisation = 'both': give"),
        ({"saturation": "clip"}, "saturation = 'clip': give"),
        ({"switching": "vornoi"}, "Did you mean 'voronoi'"),
        ({"solve": "raw"}, "solve = 'raw': give"),
        ({"saturation": "zero"}, "never looks: take switching='voronoi'"),
        ({"saturation": "hold", "switching": "none"}, "never leaves: take saturation='zero'"),
        ({"reset": "nearest"}, "reset='nearest' belongs to the Voronoi tests"),
    ],
)
def test_what_does_not_go_together_is_refused(options: dict[str, str], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        so.PaperLaw(**options)


@pytest.mark.parametrize(
    "options", [{"realisation": "integrated"}, {"switching": "voronoi"}, {"solve": "plain"}]
)
def test_variants_are_of_the_papers_law(options: dict[str, str]) -> None:
    with pytest.raises(TypeError, match="has no option"):
        so.PredictorCorrector(**options)
