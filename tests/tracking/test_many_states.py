"""Many states of one tracker that step together: each as `step` makes it alone, to the last bit, or
to 1e-13 between patches of ellipsoids, which are in lanes (`test_ellipsoid_lanes`)."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.errors import StandoffError
from standoff.kernels.pair.events import GENERAL_FRAMES
from standoff.kernels.state.arrays import OUT_COUNTS
from standoff.tracking.many_states import TrackerStates

REST = np.eye(4)
TOOL = so.shapes.ellipsoid(0.4, 0.3, 0.2)
PARTS = {
    "lens": so.shapes.lens(radius=1.0, offset=0.45),
    "box": so.shapes.box(1.0, 0.8, 0.6),
    "superellipsoid": so.shapes.superellipsoid([0.5, 0.8, 0.6], [0.6, 0.9]),
}
N = 60


def some_poses(rng: np.random.Generator, near: float = 0.3) -> np.ndarray:
    """From deep inside each other to far apart."""
    poses = np.tile(np.eye(4), (N, 1, 1))
    poses[:, :3, :3] = Rotation.random(N, random_state=rng).as_matrix()
    way = rng.normal(size=(N, 3))
    way *= rng.uniform(near, 2.0, size=(N, 1)) / np.linalg.norm(way, axis=1)[:, None]
    poses[:, :3, 3] = way
    return poses


def moved(poses: np.ndarray, rng: np.random.Generator, way: float = 0.02) -> np.ndarray:
    found = poses.copy()
    found[:, :3, 3] += rng.normal(size=(N, 3)) * way
    turn = Rotation.from_rotvec(rng.normal(size=(N, 3)) * way).as_matrix()
    found[:, :3, :3] = turn @ poses[:, :3, :3]
    return found


@pytest.mark.parametrize("name", PARTS)
@pytest.mark.parametrize("twists", [False, True])
def test_each_row_is_as_step_makes_it(name: str, twists: bool, rng: np.random.Generator) -> None:
    tracker, poses = so.Tracker(PARTS[name], TOOL), some_poses(rng)
    states, seen, kept = tracker.start_many(REST, poses), set(), 0
    alone = [tracker.start(REST, pose).warm_start for pose in poses]
    assert all(np.array_equal(states[k].warm_start, alone[k]) for k in range(N))
    for k in range(8):
        poses, before = moved(poses, rng), states
        given = (None, rng.normal(size=(N, 6))) if twists else (None, None)
        dt = rng.uniform(1e-3, 3e-3, size=N)
        states, answers = tracker.step_many(before, REST, poses, *given, dt=dt, workers=1 + k % 2)
        for row in range(N):
            own = given[1][row] if twists else None
            state, one = tracker.step(before[row], REST, poses[row], None, own, dt=dt[row])
            pairs = ((answers.rows[row], one._out[:40]), (states[row].warm_start, state.warm_start))
            if name == "lens" and not one._out[OUT_COUNTS + GENERAL_FRAMES]:
                # rates are what a solve of the pair system says: good to its condition
                for ours, theirs in pairs:
                    np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-11)
                assert abs(answers.distance[row] - one.distance) <= 1e-13
            else:
                assert all(np.array_equal(*pair, equal_nan=True) for pair in pairs)
            kept += len(state.warm_start) > 100  # a proof that is kept
        seen |= {status.name for status in answers.status}
        assert len(answers) == len(states) == N
    assert "CONVERGED" in seen
    assert len(seen) > 1
    assert kept


def test_one_pose_for_all_and_one_state(rng: np.random.Generator) -> None:
    tracker = so.Tracker(PARTS["box"], TOOL)
    states = tracker.start_many(REST, some_poses(rng, 1.5))
    there = so.Pose(np.eye(3), [0.0, 0.0, 1.3])
    _, answers = tracker.step_many(states, REST, there)
    assert answers.distance.shape == (N,)
    assert np.ptp(answers.distance) < 1e-14
    one = tracker.start_many(REST, there)
    _, answers = tracker.step_many(one, REST, there)
    assert answers.distance.shape == (1,)


def test_states_are_values(rng: np.random.Generator) -> None:
    tracker, poses = so.Tracker(PARTS["lens"], TOOL), some_poses(rng)
    states = tracker.start_many(REST, poses)
    for _ in range(3):  # so that rows in penetration keep a proof
        poses = moved(poses, rng)
        states, _ = tracker.step_many(states, REST, poses)
    _, first = tracker.step_many(states, REST, moved(poses, np.random.default_rng(1)))
    _, again = tracker.step_many(states, REST, moved(poses, np.random.default_rng(1)))
    assert np.array_equal(first.blocks[:, :40], again.blocks[:, :40], equal_nan=True)
    with pytest.raises(ValueError, match="read-only"):
        states.blocks[0] = 0.0
    stored = pickle.loads(pickle.dumps(states))
    _, again = tracker.step_many(stored, REST, moved(poses, np.random.default_rng(1)))
    assert np.array_equal(first.blocks[:, :40], again.blocks[:, :40], equal_nan=True)
    together = TrackerStates.of([states[k] for k in range(N)])
    assert np.array_equal(together.polytopes[:, 0], states.polytopes[:, 0])
    assert (together.polytopes[:, 0] > 0.0).any()
    _, again = tracker.step_many(together, REST, moved(poses, np.random.default_rng(1)))
    assert np.array_equal(first.blocks[:, :40], again.blocks[:, :40], equal_nan=True)
    assert (states.answers.distance == [state.proximity.distance for state in together]).all()
    assert repr(states) == f"<TrackerStates of {N} rows>"


def test_rounded_poses_are_repaired_and_counted(rng: np.random.Generator) -> None:
    tracker, poses = so.Tracker(PARTS["box"], TOOL), some_poses(rng, 1.5)
    states = tracker.start_many(REST, poses)
    rounded = poses.astype(np.float32).astype(float)
    _, answers = tracker.step_many(states, REST, rounded, workers=2)
    assert (answers.repaired == 1).all()
    for k in range(0, N, 7):
        _, one = tracker.step(states[k], REST, rounded[k])
        assert answers.distance[k] == one.distance
    few = poses.copy()
    few[5] = rounded[5]
    _, answers = tracker.step_many(states, REST, few)
    assert answers.repaired.tolist() == [int(k == 5) for k in range(N)]


def test_what_is_refused(rng: np.random.Generator) -> None:
    tracker, poses = so.Tracker(PARTS["box"], TOOL), some_poses(rng, 1.5)
    states = tracker.start_many(REST, poses)
    bad = poses.copy()
    bad[7, 0, 3] = np.nan
    with pytest.raises(ValueError, match="Row 7: "):
        tracker.step_many(states, REST, bad)
    bad = poses.copy()
    bad[3, :3, :3] *= 1.5
    with pytest.raises(ValueError, match="Row 3: "):
        tracker.step_many(states, REST, bad, workers=2)
    with pytest.raises(ValueError, match=f"given for {N - 1} rows, and there are {N} states"):
        tracker.step_many(states, REST, poses[1:])
    with pytest.raises(ValueError, match="workers"):
        tracker.step_many(states, REST, poses, workers=0)
    with pytest.raises(ValueError, match="dt"):
        tracker.step_many(states, REST, poses, dt=-1.0)
    with pytest.raises(TypeError, match=r"tracker\.start_many"):
        tracker.step_many(states[0], REST, poses)
    other = so.Tracker(PARTS["lens"], TOOL)
    with pytest.raises(ValueError, match="belongs to another pair"):
        other.step_many(states, REST, poses)
    with pytest.raises(ValueError, match="states is empty"):
        TrackerStates.of([])
    with pytest.raises(TypeError, match=r"states\[1\] = 3 is not a TrackerState"):
        TrackerStates.of([states[0], 3])
    with pytest.raises(StandoffError, match="is of other bodies than"):
        TrackerStates.of([states[0], other.start(REST, poses[0])])


def test_the_paper_s_law_too(rng: np.random.Generator) -> None:
    tracker = so.Tracker(PARTS["lens"], TOOL, 1e-3, so.PaperLaw())
    poses = some_poses(rng, 1.8)
    states = tracker.start_many(REST, poses)
    alone = [tracker.start(REST, pose) for pose in poses]
    for _ in range(3):
        poses = moved(poses, rng, 1e-3)
        states, answers = tracker.step_many(states, REST, poses)
        for row in range(N):
            alone[row], one = tracker.step(alone[row], REST, poses[row])
            assert np.array_equal(answers.rows[row], one._out[:40], equal_nan=True)
