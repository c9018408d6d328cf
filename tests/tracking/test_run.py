"""`Tracker.run`: many frames in one call are the steps, one after the other."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so

REST = np.eye(4)
POINT = so.shapes.point()
TOOL = so.shapes.ellipsoid(0.15, 0.30, 0.20)
PAIRS = {
    "lens, ellipsoid": (so.shapes.lens(1.0, 0.45), TOOL, 1.4),
    "boxes": (so.shapes.box(1.0, 0.7, 0.5), so.shapes.box(0.3, 0.4, 0.5), 1.0),
    "ellipsoids that meet": (so.shapes.ellipsoid(0.5, 0.8, 0.9), TOOL, 0.75),
}
LAWS = {
    "predictor": so.PredictorCorrector(),
    "paper": so.PaperLaw(gain=300.0),
    "deadline": so.PredictorCorrector(deadline=1),
}


def motion(far: float, n: int) -> tuple[np.ndarray, np.ndarray]:
    """B's poses (n, 4, 4) and twists (n, 6): round A and turning."""
    poses, twists = np.tile(np.eye(4), (n, 1, 1)), np.zeros((n, 6))
    for k in range(n):
        turn = Rotation.from_euler("zy", [0.02 * k, 0.01 * k])
        poses[k, :3, :3], poses[k, :3, 3] = turn.as_matrix(), far * turn.apply([1.0, 0.1, 0.05])
        twists[k] = [0.1, 0.2, 0.0, 0.0, 0.0, 20.0]
    return poses, twists


def same_as_steps(
    tracker: so.Tracker, state: so.TrackerState, frames: list[Any], found: Any
) -> None:
    after, answers = found
    assert len(answers) == len(frames)
    for k, frame in enumerate(frames):
        state, expected = tracker.step(state, *frame)
        one = answers[k]
        np.testing.assert_array_equal(one.row, expected.row)
        np.testing.assert_array_equal(one.poses, expected.poses)
        # a slope that a restart has cut away is nan
        assert repr(one.events) == repr(expected.events)
        assert (one.time, one.repaired) == (expected.time, expected.repaired)
        assert answers.distance[k] == expected.distance
        assert answers.status[k] is expected.status
        np.testing.assert_array_equal(answers.point_b[k], expected.point_b)
    np.testing.assert_array_equal(after.data, state.data)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("with_twists", [True, False])
def test_a_run_is_its_steps(pair: str, law: str, with_twists: bool) -> None:
    a, b, far = PAIRS[pair]
    poses, twists = motion(far, 120)
    tracker = so.Tracker(a, b, law=LAWS[law])
    state = tracker.start(REST, poses[0])
    given = (None, twists[1:]) if with_twists else (None, None)
    frames = [
        (REST, p, None, t if with_twists else None) for p, t in zip(poses, twists, strict=True)
    ]
    same_as_steps(tracker, state, frames[1:], tracker.run(state, REST, poses[1:], *given))


def test_a_run_that_overlaps_without_depth_and_parts() -> None:
    """Frames that Python has to look at lie between others."""
    tracker = so.Tracker(so.shapes.box(1, 1, 1), so.shapes.box(0.5, 0.5, 0.5))
    x = 1.0 - 0.9 * np.sin(np.linspace(0.0, np.pi, 60))
    poses = np.tile(np.eye(4), (60, 1, 1))
    poses[:, 0, 3], poses[:, 1, 3] = x, 0.01
    state = tracker.start(REST, poses[0])
    frames = [(REST, p) for p in poses[1:]]
    same_as_steps(tracker, state, frames, tracker.run(state, REST, poses[1:]))


def test_rounded_poses_and_many_switches_are_as_in_steps() -> None:
    turns = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
    rims = [[np.cos(t), np.sin(t), z] for z in (-0.5, 0.5) for t in turns]
    tracker = so.Tracker(so.shapes.polytope(rims), POINT)
    poses = np.tile(np.eye(4), (9, 1, 1))
    for k, pose in enumerate(poses):
        pose[:3, 3] = 2.0 * np.cos(0.9 * k), 2.0 * np.sin(0.9 * k), 0.0
        pose[:3, :3] = Rotation.from_euler("z", 0.3 * k).as_matrix()
    poses[3] = np.round(poses[3], 6)
    state = tracker.start(REST, poses[0])
    found = tracker.run(state, REST, poses[1:])
    same_as_steps(tracker, state, [(REST, p) for p in poses[1:]], found)
    assert found[1].repaired.tolist() == [0, 0, 1, 0, 0, 0, 0, 0]
    assert max(answer.counts.switches for answer in found[1]) > 4
    assert len(found[1].events) == sum(answer.counts.switches for answer in found[1])


def test_planar_bodies_are_looked_at_frame_by_frame() -> None:
    corners = [[0.0, 0.0], [1.0, 0.0], [0.4, 0.9]]
    sides = [
        so.geometry.Line(p, q) for p, q in zip(corners, corners[1:] + corners[:1], strict=True)
    ]
    tracker = so.Tracker(so.shapes.planar_loop(sides), POINT)
    poses = np.tile(np.eye(4), (30, 1, 1))
    poses[:, 0, 3], poses[:, 1, 3] = 2.0, np.linspace(-1.0, 1.0, 30)
    state = tracker.start(REST, poses[0])
    same_as_steps(tracker, state, [(REST, p) for p in poses], tracker.run(state, REST, poses))
    poses[7, 2, 3] = 0.1
    with pytest.raises(so.StandoffError, match="Frame 7"):
        tracker.run(state, REST, poses)


def test_poses_and_twists_in_every_form() -> None:
    a, b, far = PAIRS["lens, ellipsoid"]
    poses, twists = motion(far, 20)
    tracker = so.Tracker(a, b)
    state = tracker.start(REST, poses[0])
    _, expected = tracker.run(state, REST, poses, np.zeros(6), twists, 1e-3)
    rows = np.hstack([poses[:, :3, :3].reshape(-1, 9), poses[:, :3, 3]])
    locked = poses.copy()
    locked.flags.writeable = False
    rests = [REST, so.Pose.identity(), (np.eye(3), np.zeros(3)), np.tile(REST, (20, 1, 1))]
    for rest in rests:
        for moving in (poses, rows, locked, poses.tolist(), np.asfortranarray(poses)):
            steps = np.full(20, 1e-3)
            _, found = tracker.run(state, rest, moving, so.Twist.zero(), twists, steps)
            np.testing.assert_array_equal(found.distance, expected.distance)
            np.testing.assert_array_equal(found.rate, expected.rate)
    assert np.isfinite(expected.rate).all()
    assert expected.certified.all()
    np.testing.assert_allclose(expected.time, 1e-3 * np.arange(1, 21))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"poses_b": np.zeros((3, 4))}, r"poses_b has the shape \(3, 4\): give an array"),
        ({"poses_b": np.zeros((0, 4, 4))}, r"poses_b has the shape \(0, 4, 4\)"),
        ({"poses_b": "there"}, "poses_b is 'there': give an array"),
        ({"poses_a": np.tile(REST, (4, 1, 1))}, "poses_b is given for 5 frames|poses_a is given"),
        ({"twists_b": np.zeros((5, 5))}, r"twists_b has the shape \(5, 5\)"),
        ({"twists_b": np.zeros((4, 6))}, "twists_b is given for 4 frames, another for 5"),
        ({"dt": np.zeros((2, 2))}, r"dt has the shape \(2, 2\)"),
        ({"dt": [1e-3, 1e-3, -1.0, 1e-3, 1e-3]}, "dt"),
        ({"dt": np.nan}, "dt"),
    ],
)
def test_what_is_no_run_is_refused(given: dict[str, Any], words: str) -> None:
    a, b, far = PAIRS["lens, ellipsoid"]
    tracker = so.Tracker(a, b)
    poses, _ = motion(far, 5)
    state = tracker.start(REST, poses[0])
    with pytest.raises(so.StandoffError, match=words):
        tracker.run(state, **{"poses_a": REST, "poses_b": poses} | given)


def test_a_bad_row_is_named_by_its_frame() -> None:
    a, b, far = PAIRS["lens, ellipsoid"]
    tracker = so.Tracker(a, b)
    poses, twists = motion(far, 5)
    state = tracker.start(REST, poses[0])
    broken = poses.copy()
    broken[3, 0, 3] = np.nan
    with pytest.raises(so.StandoffError, match="Frame 3: pose_b"):
        tracker.run(state, REST, broken)
    twists[2, 4] = np.inf
    with pytest.raises(so.StandoffError, match="Frame 2: twist_b"):
        tracker.run(state, REST, poses, None, twists)
    with pytest.raises(TypeError, match="not a TrackerState"):
        tracker.run(None, REST, poses)


def test_a_twist_in_body_axes_turns_with_its_body() -> None:
    a, b, far = PAIRS["lens, ellipsoid"]
    poses, _ = motion(far, 10)
    tracker, twist = so.Tracker(a, b), so.Twist([0.1, 0.2, 0.3], [1.0, -2.0, 3.0], "body")
    state = tracker.start(REST, poses[0])
    frames = [(REST, pose, None, twist) for pose in poses]
    same_as_steps(tracker, state, frames, tracker.run(state, REST, poses, None, twist))
