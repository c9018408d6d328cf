"""An overlap that is proven without a depth has one status, and one answer, by every route.

A tolerance below roundoff certifies nothing, so that the proof of overlap has the last word.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import standoff as so
from standoff import simulation as sim
from standoff.kernels.state import arrays as K
from standoff.tracking import cold_query, many_distances, reached

STRICT = so.PredictorCorrector(tolerance=1e-16)
CAPSULE, BALL, WALL = (
    so.shapes.capsule(0.2, 0.6),
    so.shapes.sphere(0.4),
    so.shapes.halfspace(),
)
PAIRS = {"capsules": (CAPSULE, CAPSULE), "balls": (BALL, BALL), "ball, wall": (BALL, WALL)}
HOME = np.eye(4)
FRAMES = 6


def motion(name: str) -> np.ndarray:
    """Poses of B, deep in A, until it has left A (the wall is moved below the ball)."""
    poses = np.tile(np.eye(4), (FRAMES, 1, 1))
    poses[:, :3, :3] = so.Pose.exp([0.0, 0.0, 0.0], [0.3, -0.2, 0.5]).rotation
    if name == "ball, wall":
        poses[:, 2, 3] = np.linspace(-0.213, -0.317, FRAMES)
        poses[-1, 2, 3] = -0.613
    else:
        poses[:, :3, 3] = np.outer(np.linspace(0.2, 0.3, FRAMES), [0.61, 0.31, 0.43])
        poses[-1, :3, 3] *= 7.0
    return poses


@pytest.fixture(params=PAIRS)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def overlaps(answers: list[np.ndarray]) -> int:
    """How many rows are OVERLAPPING; in these the numbers are bounds of a signed distance."""
    found = 0
    for row in answers:
        if row[K.STATUS] == K.OVERLAPPING:
            found += 1
            assert row[K.LOWER_BOUND] <= row[K.DISTANCE] <= 0.0
            assert row[K.UPPER_BOUND] <= 0.0
        assert row[K.STATUS] in (K.OVERLAPPING, K.GLOBAL, K.NOT_CERTIFIED)
    return found


def by_steps(tracker: so.Tracker, poses: np.ndarray) -> list[np.ndarray]:
    state = tracker.start(HOME, poses[0])
    rows = [state.proximity.row]
    for pose in poses[1:]:
        state, answer = tracker.step(state, HOME, pose)
        rows.append(answer.row)
        lost = state.warm_start[K.LOST]
        assert lost == (answer.status in (so.Status.OVERLAPPING, so.Status.NOT_CERTIFIED))
    return rows


def test_tracker_routes_agree(name: str) -> None:
    """Single frames, frames in place, and runs."""
    tracker, poses = so.Tracker(*PAIRS[name], law=STRICT), motion(name)
    rows = by_steps(tracker, poses)
    assert 0 < overlaps(rows[1:]) < FRAMES - 1
    assert rows[-1][K.STATUS] == K.NOT_CERTIFIED
    assert rows[-1][K.LOWER_BOUND] > 0.0

    start = tracker.start(HOME, poses[0])
    buffer = tracker.buffer(start)
    for pose, row in zip(poses[1:], rows[1:], strict=True):
        assert tracker.step_into(buffer, HOME, pose) == row[K.DISTANCE]
        np.testing.assert_array_equal(buffer.out, row)
    _, answers = tracker.run(start, HOME, poses[1:])
    np.testing.assert_array_equal(answers.blocks[:, : K.N_OUT], rows[1:])


def test_cold_queries_agree(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Many and single ones, their default options replaced."""
    tracker, poses = so.Tracker(*PAIRS[name], law=STRICT), motion(name)
    starts = [tracker.start(HOME, pose).proximity.row for pose in poses]
    assert 0 < overlaps(starts) < FRAMES
    for module in (reached, cold_query):
        monkeypatch.setattr(module, "cold_table", lambda a, b, within: tracker.table)
    monkeypatch.setattr(many_distances, "Tracker", partial(so.Tracker, law=STRICT))
    found = so.distances(*PAIRS[name], HOME, poses)
    np.testing.assert_array_equal(found.rows, starts)
    warm = so.distances(*PAIRS[name], HOME, poses, warm=True)
    np.testing.assert_array_equal(warm.rows, by_steps(tracker, poses))
    for pose, row in zip(poses, starts, strict=True):
        np.testing.assert_array_equal(so.distance(*PAIRS[name], HOME, pose).row, row)


def test_a_recorded_run_agrees(name: str) -> None:
    """Where the pair stands still, every frame but the first is a frame of ``step``."""
    tracker, pose = so.Tracker(*PAIRS[name], law=STRICT), motion(name)[0]
    recording = so.track(tracker, so.Pose.identity(), so.Pose.of(pose), 5e-3)
    state, still = tracker.start(HOME, pose), np.zeros(6)
    for frame in range(1, len(recording)):
        state, answer = tracker.step(state, HOME, pose, still, still)
        assert recording.status[frame] is answer.status
        assert recording.distance[frame] == answer.distance
    assert answer.status is so.Status.OVERLAPPING


def test_a_simulated_system_counts_it_as_uncertified() -> None:
    """Contacts are pushed by a depth, and none was certified: each such tick is counted."""
    pose, at = so.Pose.of(motion("balls")[0]), so.Pose.identity()
    bodies = [
        sim.RigidBody.free(BALL, density=1000.0, pose=at),
        sim.RigidBody.free(BALL, density=1000.0, pose=pose),
    ]
    system = sim.System(bodies, sim.HuntCrossley(stiffness=1e4, depth=0.9))
    certain = sim.Operator(system, 1e-5)
    assert certain.run(certain.start(allow_overlap=True), 20).uncertified == 0
    operator = sim.Operator(system, 1e-5, law=replace(STRICT, depth="local"))
    run = operator.run(operator.start(allow_overlap=True), 20)
    assert run.uncertified == 20
    assert (run.answers(0).data[1:, K.STATUS] == K.OVERLAPPING).all()


def test_a_start_from_a_place_agrees(name: str) -> None:
    tracker, pose = so.Tracker(*PAIRS[name], law=STRICT), motion(name)[0]
    state = tracker.start(HOME, pose)
    answer = state.proximity
    assert answer.status is so.Status.OVERLAPPING
    again = tracker.start_from(HOME, pose, answer.place_a, answer.place_b)
    assert again.proximity.status is answer.status
    assert again.proximity.distance == answer.distance
    assert again.warm_start[K.LOST] == 1.0
