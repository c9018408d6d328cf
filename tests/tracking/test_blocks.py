"""Steps from Python: what is given goes to the kernel as it is, or is brought into form first."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.kernels.pair import events as N
from standoff.kernels.state import arrays as K

TOOL = so.shapes.ellipsoid(0.15, 0.30, 0.20)
LENS = so.shapes.lens(1.0, 0.45)
REST, STILL = np.eye(4), np.zeros(6)
LAWS = [so.PredictorCorrector(), so.PaperLaw(gain=500.0)]


def placed(k: int) -> np.ndarray:
    """The tool's pose (4, 4) at a frame: round the lens, over its edge."""
    pose = np.eye(4)
    turn = Rotation.from_euler("zy", [0.002 * k, 0.001 * k])
    pose[:3, :3], pose[:3, 3] = turn.as_matrix(), 1.6 * turn.apply([1.0, 0.1, 0.05])
    return pose


def read_only(array: np.ndarray) -> np.ndarray:
    copy = array.copy()
    copy.flags.writeable = False
    return copy


FORMS: dict[str, Any] = {
    "as it is": np.array,
    "read-only": read_only,
    "columns first": np.asfortranarray,
    "a part of more": lambda m: np.pad(m, 1)[1:-1, 1:-1],
    "single words": lambda m: m.tolist(),
    "Pose": so.Pose.of,
    "pair": lambda m: (m[:3, :3], m[:3, 3]),
}
TWISTS: dict[str, Any] = {
    "as it is": np.array,
    "read-only": read_only,
    "part": lambda x: np.repeat(x, 2)[::2],
    "list": lambda x: x.tolist(),
    "Twist": lambda x: so.Twist(x[:3], x[3:]),
    "pair": lambda x: (x[:3], x[3:]),
}


@pytest.mark.parametrize("law", LAWS, ids=["predictor", "paper"])
@pytest.mark.parametrize("form", FORMS)
def test_poses_in_every_form_are_the_same_step(form: str, law: Any) -> None:
    tracker = so.Tracker(LENS, TOOL, law=law)
    state = tracker.start(REST, placed(0))
    _, expected = tracker.step(state, REST, placed(1))
    _, found = tracker.step(state, FORMS[form](REST), FORMS[form](placed(1)))
    np.testing.assert_array_equal(found.row, expected.row)
    np.testing.assert_array_equal(found.poses, expected.poses)


@pytest.mark.parametrize("form", TWISTS)
def test_twists_in_every_form_are_the_same_step(form: str) -> None:
    tracker, twist = so.Tracker(LENS, TOOL), np.array([0.1, 0.2, -0.3, 1.0, 2.0, 0.5])
    state = tracker.start(REST, placed(0), STILL, twist)
    _, expected = tracker.step(state, REST, placed(1), STILL, twist)
    _, found = tracker.step(state, REST, placed(1), TWISTS[form](STILL), TWISTS[form](twist))
    np.testing.assert_array_equal(found.row, expected.row)
    assert np.isfinite(found.rate)


def test_one_twist_given_leaves_the_other_body_at_rest() -> None:
    tracker, twist = so.Tracker(LENS, TOOL), np.array([0.1, 0.2, -0.3, 1.0, 2.0, 0.5])
    state = tracker.start(REST, placed(0))
    for given, both in (((twist, None), (twist, STILL)), ((None, twist), (STILL, twist))):
        _, one = tracker.step(state, REST, placed(1), *given)
        _, two = tracker.step(state, REST, placed(1), *both)
        np.testing.assert_array_equal(one.row, two.row)
    assert np.isnan(tracker.step(state, REST, placed(1))[1].rate)


@pytest.mark.parametrize(
    "twist", [np.zeros(0), np.array([np.nan]), np.zeros(5), np.zeros((2, 3, 1))]
)
def test_a_twist_of_another_length_is_none(twist: Any) -> None:
    tracker = so.Tracker(LENS, TOOL)
    state = tracker.start(REST, placed(0))
    with pytest.raises(ValueError, match="not a twist"):
        tracker.step(state, REST, placed(1), np.array(twist), STILL)


@pytest.mark.parametrize("at", [(3, 0), (3, 3)])
def test_the_last_row_of_a_matrix_is_looked_at(at: tuple[int, int]) -> None:
    tracker, wrong = so.Tracker(LENS, TOOL), placed(1)
    state = tracker.start(REST, placed(0))
    wrong[at] += 0.5
    for poses in ((REST, wrong), (wrong, REST)):
        with pytest.raises(ValueError, match="last row"):
            tracker.step(state, *poses)


def test_states_and_answers_are_values() -> None:
    tracker = so.Tracker(LENS, TOOL)
    state = tracker.start(REST, placed(0))
    before, pose = state.data.copy(), placed(1)
    after, answer = tracker.step(state, REST, pose)
    row = answer.row.copy()
    pose[:3, 3] = 7.0  # the caller's own array
    tracker.step(after, REST, placed(2))
    np.testing.assert_array_equal(state.data, before)
    np.testing.assert_array_equal(answer.row, row)
    for array in (after.data, answer.row, answer.point_a, *answer.poses):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    with pytest.raises(AttributeError):
        state.data = before


def test_more_switches_than_a_block_holds_are_all_told() -> None:
    """A point jumps over many facets in one frame: each switch is an event, as in a long block."""
    turns = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
    rims = [[np.cos(t), np.sin(t), z] for z in (-0.5, 0.5) for t in turns]
    tracker = so.Tracker(so.shapes.polytope(rims), so.shapes.point())
    most = 0
    for angle in np.linspace(0.2, 1.5, 14):
        state = tracker.start(REST, so.Pose(np.eye(3), [2.0, 0.1, 0.0]))
        there = np.eye(4)
        there[:3, 3] = 2.0 * np.cos(angle), 2.0 * np.sin(angle), 0.0
        _, answer = tracker.step(state, REST, there)
        buffer = tracker.buffer(state)
        buffer.pose_b[9:] = there[:3, 3]
        buffer.has_twist = False
        tracker.step_into(buffer)
        assert answer.events == buffer.proximity().events
        assert len(answer.events) == answer.counts.switches
        most = max(most, answer.counts.switches)
    assert K.KEPT_EVENTS < most <= N.MAX_EVENTS


def test_one_tracker_in_several_threads() -> None:
    tracker = so.Tracker(LENS, TOOL)
    frames = [placed(k) for k in range(400)]
    told: list[list[float]] = [[] for _ in range(4)]

    def follow(distances: list[float]) -> None:
        state = tracker.start(REST, frames[0])
        for pose in frames[1:]:
            state, answer = tracker.step(state, REST, pose)
            distances.append(answer.distance)

    threads = [threading.Thread(target=follow, args=(each,)) for each in told]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(told[0]) == 399
    assert all(each == told[0] for each in told)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("twisted", [True, False])
def test_a_buffer_takes_poses_in_any_form_as_a_step_does(form: str, twisted: bool) -> None:
    tracker = so.Tracker(LENS, TOOL)
    state = tracker.start(REST, placed(0))
    buffer = tracker.buffer(state)
    for k in range(1, 6):
        pose = FORMS[form](placed(k))
        twists = (STILL, np.array([0.1, 0.2, -0.3, 1.0, 2.0, 0.5])) if twisted else ()
        state, answer = tracker.step(state, REST, pose, *twists)
        assert tracker.step_into(buffer, REST, pose, *twists) == answer.distance
        np.testing.assert_array_equal(buffer.out, answer.row)
        np.testing.assert_array_equal(buffer.state, state.data)
        assert buffer.repaired == 0


def test_planar_poses_given_to_a_buffer_are_looked_at() -> None:
    disc = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (1, 0), (0, 1))])
    tracker = so.Tracker(disc, so.shapes.point())
    away = np.eye(4)
    away[0, 3] = 2.0
    buffer = tracker.buffer(tracker.start(np.eye(4), away))
    assert tracker.step_into(buffer, np.eye(4), away) == pytest.approx(1.0, abs=1e-15)
    away[2, 3] = 0.5
    with pytest.raises(ValueError, match="planar body out of z = 0"):
        tracker.step_into(buffer, np.eye(4), away)


def test_what_a_buffer_refuses_leaves_its_state() -> None:
    tracker = so.Tracker(LENS, TOOL)
    buffer = tracker.buffer(tracker.start(REST, placed(0)))
    tracker.step_into(buffer, REST, placed(1))
    before, out = buffer.state.copy(), buffer.out.copy()
    mirrored, last_row, short = placed(2), placed(2), placed(2)[:3]
    mirrored[:3, 0] *= -1.0
    last_row[3, 0] = 1.0
    twist = np.full(6, np.nan)
    refused = {
        "mirrored": (REST, mirrored),
        "last row": (REST, last_row),
        "pose": (short, REST),
        "finite": (REST, placed(2), twist),
    }
    for why, given in refused.items():
        with pytest.raises(ValueError, match=why):
            tracker.step_into(buffer, *given)
        np.testing.assert_array_equal(buffer.state, before)
        np.testing.assert_array_equal(buffer.out, out)
    with pytest.raises((TypeError, ValueError)):
        tracker.step_into(buffer, REST)  # one pose alone


@pytest.mark.parametrize("form", ["as it is", "read-only", "Pose"])
def test_a_rounded_pose_given_to_a_buffer_is_repaired_and_counted(form: str) -> None:
    tracker, rounded = so.Tracker(LENS, TOOL), placed(1)
    turned = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
    rounded[:3, :3] = turned + 1e-8
    state = tracker.start(REST, placed(0))
    buffer = tracker.buffer(state)
    _, answer = tracker.step(state, REST, FORMS[form](rounded))
    assert tracker.step_into(buffer, REST, FORMS[form](rounded)) == answer.distance
    assert buffer.repaired == answer.repaired == 1
    tracker.step_into(buffer, REST, placed(2))
    assert buffer.repaired == 0


def test_a_rounded_planar_pose_given_to_a_buffer_is_counted_too() -> None:
    disc = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (1, 0), (0, 1))])
    tracker = so.Tracker(disc, so.shapes.point())
    rounded = np.eye(4)
    rounded[:2, :2] = np.array([[0.8, -0.6], [0.6, 0.8]]) + 1e-8
    rounded[0, 3] = 2.0
    buffer = tracker.buffer(tracker.start(np.eye(4), rounded))
    # a Pose has been repaired when it was made, an array is repaired by the frame
    for form in (so.Pose(rounded[:3, :3], rounded[:3, 3]), rounded):
        assert tracker.step_into(buffer, np.eye(4), form) == pytest.approx(1.0, abs=1e-15)
        assert buffer.repaired == 1
