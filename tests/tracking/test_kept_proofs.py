"""What a frame in penetration keeps of its proof: the same answers by any way, and rarely a search.

That the kept polytope proves what it says is tested in kernels/test_kept_polytope.py.
"""

import copy
import pickle

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from draws import draws
from standoff.kernels.pair import events as N
from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.kernels.state import arrays as K
from standoff.tracking import Status

ELLIPSOIDS = so.shapes.ellipsoid(1.0, 0.7, 0.5), so.shapes.ellipsoid(0.8, 0.6, 0.9)
BOXES = so.shapes.box(1.0, 0.8, 0.6), so.shapes.box(0.9, 0.7, 1.1)
MIXED = so.shapes.cylinder(0.5, 1.0), so.shapes.ellipsoid(0.8, 0.6, 0.9)
PAIRS = {"ellipsoids": (ELLIPSOIDS, 1.2), "boxes": (BOXES, 0.75), "cylinder": (MIXED, 0.9)}
PROOF = 1e-3
"""The part of a depth that another may be less by, as docs/penetration.md says."""
STILL = np.array([[0.1, -0.2, 0.1, 0.0, 0.3, 0.1]])


def poses(rng, frames, distance, swing=0.05):
    """Poses (n, 4, 4) of both bodies, which turn by 2 mrad a frame and move to and fro."""
    placed = np.tile(np.eye(4), (2, frames, 1, 1))
    for body in placed:
        axis = rng.normal(size=3)
        turns = 2e-3 * np.arange(frames)[:, None] * axis / np.linalg.norm(axis)
        first = Rotation.random(random_state=rng)
        body[:, :3, :3] = (Rotation.from_rotvec(turns) * first).as_matrix()
    way = rng.normal(size=3)
    way /= np.linalg.norm(way)
    along = distance * (1.0 + swing * np.sin(0.05 * np.arange(frames)))
    placed[1, :, :3, 3] = along[:, None] * np.array([1.0, 0.1, 0.2]) + 0.02 * way
    return placed


def inside_run(kind, rng, frames=120, shrink=0.7, swing=0.05):
    (a, b), distance = PAIRS[kind]
    poses_a, poses_b = poses(rng, frames, shrink * distance, swing)
    tracker = so.Tracker(a, b)
    return tracker, tracker.start(poses_a[0], poses_b[0]), poses_a[1:], poses_b[1:]


def kept(state):
    return len(state.warm_start) > K.N_STATE


@pytest.mark.parametrize("kind", PAIRS)
def test_a_proof_is_kept_and_searches_are_rare(kind, rng):
    tracker, state, poses_a, poses_b = inside_run(kind, rng)
    end, answers = tracker.run(state, poses_a, poses_b)
    assert np.all(answers.status == Status.GLOBAL)
    assert answers.blocks[:, K.OUT_COUNTS + N.SEARCHES].sum() <= len(poses_a) / 5
    assert kept(end)
    assert len(end.warm_start) == K.N_STATE + N_POLYTOPE
    assert end.data.shape == (K.N_STATE,)


@pytest.mark.parametrize("kind", PAIRS)
@pytest.mark.parametrize("number", range(draws(3)))
def test_depths_are_those_of_cold_queries(kind, number, rng):
    tracker, state, poses_a, poses_b = inside_run(kind, rng)
    _, answers = tracker.run(state, poses_a, poses_b)
    for k in range(0, len(poses_a), 7):
        cold = so.distance(tracker.a, tracker.b, poses_a[k], poses_b[k])
        answer = answers[k]
        assert cold.distance < 0.0
        assert answer.status == cold.status == Status.GLOBAL
        assert answer.distance == pytest.approx(cold.distance, rel=PROOF)
        assert answer.lower_bound <= cold.upper_bound
        assert cold.lower_bound <= answer.upper_bound
        assert answer.upper_bound - answer.distance <= PROOF * -answer.distance + 1e-12


@pytest.mark.parametrize("kind", PAIRS)
def test_runs_steps_and_buffers_answer_bit_for_bit(kind, rng):
    # in and out of contact: the swing is as great as the distance at which the bodies touch
    tracker, state, poses_a, poses_b = inside_run(kind, rng, frames=150, shrink=1.4, swing=0.6)
    frames = len(poses_a)
    twists = np.tile(STILL, (frames, 1))
    end, answers = tracker.run(state, poses_a, poses_b, twists, twists)
    buffer = tracker.buffer(state)
    stepped = state
    inside = 0
    for k in range(frames):
        stepped, answer = tracker.step(stepped, poses_a[k], poses_b[k], twists[k], twists[k])
        for pose, into in ((poses_a[k], buffer.pose_a), (poses_b[k], buffer.pose_b)):
            into[:9], into[9:] = pose[:3, :3].ravel(), pose[:3, 3]
        buffer.twist_a[:] = buffer.twist_b[:] = twists[k]
        tracker.step_into(buffer)
        row = answers.blocks[k, : K.N_OUT]
        np.testing.assert_array_equal(answer.row, row)
        np.testing.assert_array_equal(buffer.out, row)
        np.testing.assert_array_equal(buffer.state, stepped.data)
        inside += kept(stepped)
    np.testing.assert_array_equal(stepped.warm_start, end.warm_start)
    assert 0 < inside < frames


def test_a_run_may_be_cut_anywhere(rng):
    tracker, state, poses_a, poses_b = inside_run("ellipsoids", rng)
    whole, answers = tracker.run(state, poses_a, poses_b)
    for cut in (1, 2, 57):
        half, first = tracker.run(state, poses_a[:cut], poses_b[:cut])
        end, second = tracker.run(half, poses_a[cut:], poses_b[cut:])
        both = np.vstack([first.blocks, second.blocks])[:, : K.N_OUT]
        np.testing.assert_array_equal(both, answers.blocks[:, : K.N_OUT])
        np.testing.assert_array_equal(end.warm_start, whole.warm_start)


def test_a_state_stays_a_value(rng):
    tracker, state, poses_a, poses_b = inside_run("ellipsoids", rng, frames=20)
    state, _ = tracker.run(state, poses_a[:10], poses_b[:10])
    before = state.warm_start
    assert kept(state)
    once = tracker.step(state, poses_a[10], poses_b[10])
    for same in (state, copy.deepcopy(state), pickle.loads(pickle.dumps(state))):
        np.testing.assert_array_equal(same.warm_start, before)
        again = tracker.step(same, poses_a[10], poses_b[10])
        np.testing.assert_array_equal(again[1].row, once[1].row)
        np.testing.assert_array_equal(again[0].warm_start, once[0].warm_start)


def test_none_is_kept_outside_contact_nor_by_its_first_frame(rng):
    tracker, state, poses_a, poses_b = inside_run("ellipsoids", rng, frames=5)
    apart = poses_b.copy()
    apart[:, 0, 3] += 5.0
    assert not kept(state)  # of a start
    state, _ = tracker.step(state, poses_a[0], poses_b[0])
    assert kept(state)
    state, answer = tracker.step(state, poses_a[1], apart[1])
    assert answer.distance > 0.0
    assert not kept(state)
    state, answer = tracker.step(state, poses_a[2], poses_b[2])
    assert answer.distance < 0.0
    assert not kept(state)
    state, _ = tracker.step(state, poses_a[3], poses_b[3])
    assert kept(state)


@pytest.mark.parametrize(
    "spoil",
    [
        lambda numbers: np.full_like(numbers, np.nan),
        lambda numbers: np.full_like(numbers, 63.0),
        lambda numbers: -numbers,
        lambda numbers: np.concatenate([numbers[:2], numbers[2:] + 10.0]),
        lambda numbers: np.concatenate([numbers[:386], np.full(124, 2.0**40)]),
    ],
)
def test_numbers_that_prove_nothing_are_searched_anew(spoil, rng):
    tracker, state, poses_a, poses_b = inside_run("ellipsoids", rng, frames=10)
    state, _ = tracker.run(state, poses_a[:5], poses_b[:5])
    buffer = tracker.buffer(state)
    at = K.FIRST_POLYTOPE
    buffer._block[at : at + N_POLYTOPE] = spoil(buffer._block[at : at + N_POLYTOPE])
    for pose, into in ((poses_a[5], buffer.pose_a), (poses_b[5], buffer.pose_b)):
        into[:9], into[9:] = pose[:3, :3].ravel(), pose[:3, 3]
    buffer.has_twist = False
    tracker.step_into(buffer)
    answer = buffer.proximity()
    cold = so.distance(tracker.a, tracker.b, poses_a[5], poses_b[5])
    assert answer.status == Status.GLOBAL
    assert answer.distance == pytest.approx(cold.distance, abs=1e-12)
    assert answer.counts.searches == 1
