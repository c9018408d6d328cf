"""The tracker's state is a value: steps do not change it, and it can be stored and sent."""

import copy
import pickle
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_pairs import APART, pairs

import standoff as so
from draws import draws
from standoff.kernels.state import arrays as K

STEP = 1e-2
LAWS = (
    *(so.PredictorCorrector(predictor=x) for x in ("feedforward-2", "feedforward", "secant")),
    so.PredictorCorrector(predictor="none"),
    so.PaperLaw(),
)
FIELDS = (
    "distance",
    "lower_bound",
    "point_a",
    "point_b",
    "normal",
    "feature_a",
    "feature_b",
    "parameters_a",
    "parameters_b",
    "rate",
    "velocity_a",
    "velocity_b",
    "residual",
    "status",
    "counts",
    "events",
    "time",
    "certified",
)


def assert_identical(one, two):
    """Equal to the last bit."""
    for name in FIELDS:
        first, second = getattr(one, name), getattr(two, name)
        if isinstance(first, np.ndarray | float):
            assert np.array_equal(first, second, equal_nan=True), name
        elif name == "events":
            assert len(first) == len(second)
            assert [repr(e) for e in first] == [repr(e) for e in second]
        else:
            assert first == second, name


class Run:
    """A tracker on a pair's motion, some frames on its way."""

    def __init__(self, pair, law, frames=3):
        self.paths = pair.paths()[:2]
        self.blind = getattr(law, "predictor", "") == "secant"
        self.tracker = so.Tracker(pair.a, pair.b, dt=STEP, law=law)
        self.state = self.tracker.start(*self.inputs(0))
        for k in range(1, frames + 1):
            self.state, _ = self.tracker.step(self.state, *self.inputs(k))
        self.next = frames + 1

    def inputs(self, k):
        a, b = self.paths
        poses = a.pose(k * STEP), b.pose(k * STEP)
        twists = (None, None) if self.blind else (a.twist(k * STEP), b.twist(k * STEP))
        return *poses, *twists

    def step(self, state, tracker=None):
        return (tracker or self.tracker).step(state, *self.inputs(self.next))


@settings(max_examples=draws(30))
@given(pairs(APART), st.sampled_from(LAWS))
def test_a_state_stepped_twice_answers_twice_the_same(pair, law):
    run = Run(pair, law)
    before = run.state.data.tobytes()
    shown = copy.deepcopy(run.state.proximity)
    first_state, first = run.step(run.state)
    # another step elsewhere in between: nothing is hidden in the tracker
    run.tracker.step(first_state, *run.inputs(run.next + 5))
    second_state, second = run.step(run.state)
    assert_identical(first, second)
    assert first_state.data.tobytes() == second_state.data.tobytes()
    assert run.state.data.tobytes() == before
    assert_identical(run.state.proximity, shown)


@settings(max_examples=draws(20))
@given(pairs(APART), st.sampled_from(LAWS))
def test_a_state_survives_storage(pair, law):
    """By pickle and by copy, also into the hands of another tracker."""
    run = Run(pair, law)
    expected_state, expected = run.step(run.state)
    other = so.Tracker(pair.a, pair.b, dt=STEP, law=law)
    for stored in (pickle.loads(pickle.dumps(run.state)), copy.deepcopy(run.state)):
        assert stored.data.tobytes() == run.state.data.tobytes()
        assert stored.time == run.state.time
        assert_identical(stored.proximity, run.state.proximity)
        state, answer = run.step(stored, other)
        assert_identical(answer, expected)
        assert state.data.tobytes() == expected_state.data.tobytes()


def lens_and_point():
    tracker = so.Tracker(so.shapes.lens(1.0, 0.45), so.shapes.point())
    return tracker, tracker.start(np.eye(4), so.Pose(np.eye(3), [1.2, 0.3, 0.4]))


def test_a_state_cannot_be_written():
    _, state = lens_and_point()
    with pytest.raises(ValueError, match="read-only"):
        state.data[0] = 1.0
    with pytest.raises(AttributeError):
        state.data = np.zeros(3)
    for array in (state.proximity.point_a, state.proximity.normal, state.proximity.velocity_a):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


def test_a_stored_state_cannot_be_written_either():
    _, state = lens_and_point()
    for stored in (pickle.loads(pickle.dumps(state)), copy.deepcopy(state)):
        with pytest.raises(ValueError, match="read-only"):
            stored.data[0] = 1.0
        with pytest.raises(ValueError, match="read-only"):
            stored.proximity.point_a[0] = 1.0


def test_inputs_are_not_changed():
    tracker, state = lens_and_point()
    pose_a, pose_b = np.eye(4), np.eye(4)
    pose_b[:3, 3] = 1.2, 0.31, 0.4
    twist = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    kept = [x.copy() for x in (pose_a, pose_b, twist)]
    tracker.step(state, pose_a, pose_b, None, twist)
    for one, two in zip((pose_a, pose_b, twist), kept, strict=True):
        assert (one == two).all()


@settings(max_examples=draws(20))
@given(pairs(APART), st.sampled_from(LAWS))
def test_steps_in_place_answer_the_same(pair, law):
    """``step_into`` writes over its buffer what ``step`` returns as values."""
    run = Run(pair, law)
    state, expected = run.step(run.state)
    buffer = run.tracker.buffer(run.state)
    pose_a, pose_b, twist_a, twist_b = run.inputs(run.next)
    for flat, pose in ((buffer.pose_a, pose_a), (buffer.pose_b, pose_b)):
        flat[:9], flat[9:] = pose.rotation.ravel(), pose.translation
    buffer.has_twist = not run.blind
    if not run.blind:
        buffer.twist_a[:] = [*twist_a.v, *twist_a.omega]
        buffer.twist_b[:] = [*twist_b.v, *twist_b.omega]
    assert run.tracker.step_into(buffer) == expected.distance
    assert buffer.state.tobytes() == state.data.tobytes()
    assert_identical(buffer.proximity(), expected)


def test_time_adds_up():
    tracker, state = lens_and_point()
    assert state.time == 0.0
    for dt in (1e-3, 2e-2, 5e-3):
        state, answer = tracker.step(state, np.eye(4), so.Pose(np.eye(3), [1.2, 0.3, 0.4]), dt=dt)
    assert state.time == pytest.approx(2.6e-2)
    assert answer.time == state.time


def test_the_documented_length_of_a_state_is_the_kernels():
    (documented,) = re.findall(r"data : \((\d+),\) array", so.TrackerState.__doc__)
    assert int(documented) == K.N_STATE
    assert lens_and_point()[1].data.shape == (K.N_STATE,)
