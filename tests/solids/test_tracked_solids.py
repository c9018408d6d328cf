"""Two solids that move: in each frame the answer of a query from nothing, from the bounds kept."""

from __future__ import annotations

import copy
import pickle
from collections import Counter

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from families.solid_shapes import ball, bolt, bracket, egg, peg, prism, ring, socket, tube
from on_first_use import OnFirstUse
from standoff.solids import Solid, SolidAnswers, SolidState, SolidTracker
from standoff.solids.spatial.pair import PlacedPair
from standoff.solids.tracked import front

Array = np.ndarray
STILL = np.eye(4)
PAIRS = OnFirstUse(
    {
        "bracket, bracket": lambda: (bracket(), bracket()),
        "bolt, tube": lambda: (bolt(), tube(1.2, 2.0, 0.0, 1.0)),
        "ring, peg": lambda: (ring(1.0, 0.25), peg(0.3, -1.0, 1.0)),
        "egg, bracket": lambda: (egg(0.9, 0.6, 0.4), bracket()),
        "tube, tube": lambda: (tube(0.5, 0.8, 0.0, 0.6), tube(0.5, 0.8, 0.0, 0.6)),
    }
)


LITTLE, ONE_LOOK = 30, 100
"""Evaluations of a frame, and those by which the last look at a pair of pieces may exceed them."""


def placed(turn: Array, shift: Array) -> Array:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, shift
    return matrix


def wandering(
    a: Solid, b: Solid, frames: int, speed: float, rng: np.random.Generator, gap: float
) -> Array:
    """Poses of B (n, 4, 4) that slide along A at about a gap, in steps of `speed` sizes."""
    tracker = so.Tracker(a, b)
    size = a.size + b.size
    way = rng.normal(size=3)
    turn = Rotation.random(random_state=rng).as_matrix()
    state = tracker.start(STILL, placed(turn, size * way / np.linalg.norm(way)))
    found, spin, drift = state.proximity, rng.normal(size=3), rng.normal(size=3)
    poses = [placed(turn, size * way / np.linalg.norm(way))]
    for _ in range(frames):
        n = found.normal
        spin, drift = spin + 0.3 * rng.normal(size=3), drift + 0.3 * rng.normal(size=3)
        along = drift - n * (drift @ n)
        near = np.clip(gap - found.distance, -3.0 * speed * size, speed * size) * n
        move = speed * size * along / np.linalg.norm(along) + near
        by = Rotation.from_rotvec(speed * spin / np.linalg.norm(spin)).as_matrix()
        last = poses[-1]
        turned = Rotation.from_matrix(by @ last[:3, :3]).as_matrix()
        shift = found.point_b + by @ (last[:3, 3] - found.point_b) + move
        poses.append(placed(turned, shift))
        state, found = tracker.step(state, STILL, poses[-1])
    return np.array(poses)


def is_as_cold(answer: so.solids.SolidProximity, cold: so.solids.SolidProximity) -> None:
    assert answer.status is cold.status
    assert answer.inside == cold.inside
    if cold.penetrating:
        return
    close = 1e-10 * (np.abs(cold.point_a).max() + abs(cold.distance) + 10.0)
    assert answer.distance == pytest.approx(cold.distance, abs=close)
    assert answer.lower_bound <= cold.upper_bound
    assert cold.lower_bound <= answer.upper_bound
    assert answer.upper_bound - answer.lower_bound <= cold.upper_bound - cold.lower_bound + close


@pytest.mark.parametrize("gap", [0.2, 3e-3])
@pytest.mark.parametrize("name", PAIRS)
def test_frames_tell_what_a_query_from_nothing_tells(name: str, gap: float) -> None:
    a, b = PAIRS[name]
    rng = np.random.default_rng(sum(map(ord, name)))
    poses = wandering(a, b, 120, 4e-3, rng, gap)
    tracker = SolidTracker(a, b)
    _, answers = tracker.run(tracker.start(STILL, poses[0]), STILL, poses[1:])
    assert answers.certified.all()
    # the gap is less than a frame's motion at the end, so that both kinds of frames are met
    assert answers.distance.min() < 2.0 * gap
    for k in range(0, len(answers), 5):
        is_as_cold(answers[k], so.solids.distance(a, b, STILL, poses[k + 1]))


@pytest.mark.parametrize("name", PAIRS)
def test_jumps_through_each_other_and_out_again(name: str) -> None:
    """Any pose after any other: overlapping, apart, far."""
    a, b = PAIRS[name]
    rng = np.random.default_rng(5)
    poses = np.array(
        [
            placed(
                Rotation.random(random_state=rng).as_matrix(),
                rng.normal(size=3) * rng.choice([0.2, 0.6, 1.5]) * a.size,
            )
            for _ in range(12)
        ]
    )
    tracker = so.Tracker(a, b)
    _, answers = tracker.run(tracker.start(STILL, poses[0]), STILL, poses)
    seen = Counter()
    for k, pose in enumerate(poses):
        cold = so.solids.distance(a, b, STILL, pose)
        is_as_cold(answers[k], cold)
        assert answers.status[k] is cold.status
        assert answers.restarts[k] == (answers[k].counts.restarts > 0)
        seen[cold.status] += 1
    assert len(seen) > 1


def test_a_ball_that_leaps_into_the_material_is_inside() -> None:
    """Boundaries that are farther apart than the motion says: whether one is inside is asked."""
    hollow, inner = socket(1.0, 3.0), ball(0.2)
    tracker = so.Tracker(hollow, inner)
    path = [0.0, 0.1, 2.0, 2.1, 0.0, 6.0, 6.1]
    poses = np.array([placed(np.eye(3), [x, 0.0, 0.0]) for x in path])
    _, answers = tracker.run(tracker.start(STILL, poses[0]), STILL, poses)
    assert [answer.inside for answer in answers] == ["", "", "B", "B", "", "", ""]
    for x, answer in zip(path, answers, strict=True):
        is_as_cold(answer, so.distance(hollow, inner, STILL, placed(np.eye(3), [x, 0.0, 0.0])))
    assert answers.distance[1] == pytest.approx(0.7, abs=1e-9)
    assert answers.distance[3] == pytest.approx(0.7, abs=1e-9)
    assert answers.status[3] is so.Status.CONTAINED


def test_a_peg_in_its_hole_is_a_continuum_in_each_frame() -> None:
    pin, hole = peg(0.4, -1.0, 1.0), tube(0.5, 0.8, -0.5, 0.5)
    tracker = so.Tracker(hole, pin)
    poses = np.array([placed(np.eye(3), [0.0, 0.0, z]) for z in np.linspace(-0.2, 0.2, 9)])
    _, answers = tracker.run(tracker.start(STILL, poses[0]), STILL, poses)
    assert set(answers.status) == {so.Status.CONTINUUM}
    assert answers.distance == pytest.approx(np.full(9, 0.1), abs=1e-9)
    assert answers[4].continuum is not None
    # off the axis it is nearest along a line, and then at its ends
    side = np.array([placed(np.eye(3), [x, 0.0, 0.0]) for x in np.linspace(0.0, 0.09, 10)])
    _, answers = tracker.run(tracker.start(STILL, side[0]), STILL, side)
    assert answers.distance == pytest.approx(0.1 - side[:, 0, 3], abs=1e-9)
    for k, pose in enumerate(side):
        is_as_cold(answers[k], so.distance(hole, pin, STILL, pose))


TABLE = prism([(0, 0), (3, 0), (3, 1), (2, 1), (2, 0.5), (1, 0.5), (1, 1), (0, 1)], 1.0)
"""A bridge upside down: two feet at y = 1."""


@pytest.mark.parametrize("name", ["box", "feet"])
def test_what_ties_after_a_tilt_is_told(name: str) -> None:
    """A face, or two feet, on a plane: at rest, and from one vertex to it and back again."""
    ground = prism([(-9, 2), (9, 2), (9, 3), (-9, 3)], 9.0)
    other = TABLE if name == "feet" else prism([(0, 0), (2, 0), (2, 1), (0, 1)], 1.0)
    tilts = [0.0, 0.0, 2e-3, 1e-3, 0.0, 0.0, 1e-12, 1e-6, 1e-3, 0.0]
    poses = np.array(
        [
            placed(Rotation.from_rotvec(tilt * np.array([1.0, 0.0, 2.0])).as_matrix(), [0, 0, 3])
            for tilt in tilts
        ]
    )
    tracker = so.Tracker(ground, other)
    _, answers = tracker.run(tracker.start(STILL, poses[0]), STILL, poses)
    for k, pose in enumerate(poses):
        cold = so.distance(ground, other, STILL, pose)
        is_as_cold(answers[k], cold)
        assert answers[k].smoothness is cold.smoothness
    flat = so.Status.CONTINUUM
    assert [answers.status[k] is flat for k in (0, 1, 3, 4, 5)] == [True, True, False, True, True]


def test_a_tracker_s_own_tolerance_counts() -> None:
    a, b = PAIRS["egg, bracket"]
    pose = placed(np.eye(3), [3.0, 0.2, 0.1])
    rough, fine = SolidTracker(a, b, tolerance=1e-3), SolidTracker(a, b)
    state = rough.start(STILL, pose)
    _, answer = fine.step(state, STILL, placed(np.eye(3), [3.001, 0.2, 0.1]))
    assert answer.upper_bound - answer.lower_bound < 1e-8
    _, answer = rough.step(fine.start(STILL, pose), STILL, pose)
    assert 5e-4 < answer.upper_bound - answer.lower_bound <= 1e-3
    # far away roundings are greater, and the tolerance with them
    far = placed(np.eye(3), [3.0e6, 0.2, 0.1])
    _, answers = fine.run(fine.start(STILL, pose), STILL, np.array([pose, far, pose]))
    for k, at in enumerate((pose, far, pose)):
        is_as_cold(answers[k], so.distance(a, b, STILL, at))


def test_states_are_values_and_runs_are_steps() -> None:
    a, b = PAIRS["bolt, tube"]
    poses = wandering(a, b, 30, 4e-3, np.random.default_rng(2), 0.1)
    tracker = so.Tracker(a, b)
    start = tracker.start(STILL, poses[0])
    first, run = tracker.run(start, STILL, poses[1:])
    again, _ = tracker.run(start, STILL, poses[1:])
    state = start
    for k, pose in enumerate(poses[1:]):
        state, answer = tracker.step(state, STILL, pose)
        assert answer.distance == run.distance[k]
        assert np.abs(answer.point_b - run[k].point_b).max() < 1e-14
        assert np.abs(answer.point_a - run.point_a[k]).max() < 1e-14
        assert answer.counts == run[k].counts
    assert state.proximity.as_dict().keys() == first.proximity.as_dict().keys()
    assert first.front.contact is None
    for one, other, third in zip(first.front[:-1], again.front[:-1], state.front[:-1], strict=True):
        assert (one == other).all()
        assert (one == third).all()
        assert not one.flags.writeable
    stored = pickle.loads(pickle.dumps(state))
    assert stored.proximity.distance == state.proximity.distance
    assert copy.deepcopy(tracker).deadline == tracker.deadline


def test_both_move_and_the_order_does_not_matter() -> None:
    a, b = PAIRS["egg, bracket"]
    poses = wandering(a, b, 40, 4e-3, np.random.default_rng(3), 0.05)
    rng = np.random.default_rng(4)
    world = placed(Rotation.random(random_state=rng).as_matrix(), rng.normal(size=3))
    one = so.Tracker(a, b)
    _, answers = one.run(one.start(STILL, poses[0]), STILL, poses)
    _, moved = one.run(one.start(world, world @ poses[0]), world, world @ poses)
    other = so.Tracker(b, a)
    _, turned = other.run(other.start(poses[0], STILL), poses, STILL)
    assert moved.distance == pytest.approx(answers.distance, abs=1e-9)
    assert turned.distance == pytest.approx(answers.distance, abs=1e-9)
    assert np.abs(moved.normal - answers.normal @ world[:3, :3].T).max() < 1e-6
    assert turned.certified.all()


def test_a_frame_without_time_is_an_interval_and_the_next_goes_on() -> None:
    a, b = PAIRS["bolt, tube"]
    poses = wandering(a, b, 40, 4e-3, np.random.default_rng(6), 0.3)
    short, full = SolidTracker(a, b, deadline=40), SolidTracker(a, b)
    state = full.start(STILL, poses[0])
    _, answers = short.run(state, STILL, poses[1:])
    _, right = full.run(state, STILL, poses[1:])
    assert so.Status.DEADLINE in set(answers.status)
    assert (answers.lower_bound <= right.upper_bound).all()
    assert (right.lower_bound <= answers.upper_bound).all()
    late = next(k for k, s in enumerate(answers.status) if s is so.Status.DEADLINE)
    assert answers[late].counts.open > 0
    assert answers[late].open
    assert not answers.certified[late]
    # at rest it comes to the end
    state, _ = short.run(state, STILL, poses[1:])
    for _ in range(40):
        state, found = short.step(state, STILL, poses[-1])
    assert found.certified


def test_a_long_way_is_counted_from_nothing_again() -> None:
    """B goes round A again and again, by some thirty sizes: what was kept stands."""
    a, b = PAIRS["bracket, bracket"]
    angles = np.linspace(0.0, 18.0 * np.pi, 901)
    turns = [Rotation.from_rotvec([0.3, 0.2 * np.sin(t), 0.1]).as_matrix() for t in angles]
    round_it = [[3.4 * np.cos(t) + 1.0, 3.4 * np.sin(t) + 0.7, 0.3] for t in angles]
    poses = np.array([placed(*each) for each in zip(turns, round_it, strict=True)])
    tracker = so.Tracker(a, b)
    _, answers = tracker.run(tracker.start(STILL, poses[0]), STILL, poses)
    assert answers.motion.sum() > 2.0 * 16.0 * (a.size + b.size)
    assert answers.certified.all()
    assert not answers.restarts.any()
    for k in range(0, len(answers), 40):
        is_as_cold(answers[k], so.solids.distance(a, b, STILL, poses[k]))


def test_with_little_time_frames_go_on_all_the_same() -> None:
    """Few evaluations a frame: intervals are true, nothing is asked anew, and most are proven."""
    a, b = PAIRS["bracket, bracket"]
    poses = wandering(a, b, 300, 4e-3, np.random.default_rng(2), 0.1)
    hasty = SolidTracker(a, b, deadline=90)
    state = hasty.start(STILL, poses[0])
    assert state.proximity.certified
    _, answers = hasty.run(state, STILL, poses)
    assert not answers.restarts.any()
    assert set(answers.status) == {so.Status.CONVERGED, so.Status.DEADLINE}
    assert answers.certified.mean() > 0.5
    assert answers.evaluations.max() < 400
    for k in range(0, len(answers), 10):
        cold = so.solids.distance(a, b, STILL, poses[k])
        assert answers.lower_bound[k] <= cold.upper_bound
        assert answers.upper_bound[k] >= cold.lower_bound


@pytest.mark.parametrize("name", PAIRS)
def test_no_frame_takes_much_longer_than_it_may_and_all_are_true(name: str) -> None:
    """Near each other, with time for a part of each frame: rows are left open again and again."""
    a, b = PAIRS[name]
    poses = wandering(a, b, 100, 4e-3, np.random.default_rng(11), 2e-3)
    hasty, full = SolidTracker(a, b, deadline=LITTLE), SolidTracker(a, b)
    state = full.start(STILL, poses[0])
    _, answers = hasty.run(state, STILL, poses[1:])
    _, right = full.run(state, STILL, poses[1:])
    assert right.certified.all()
    apart = answers.status != so.Status.OVERLAPPING
    going_on = apart & ~answers.restarts
    assert answers.evaluations[going_on].max() < LITTLE + ONE_LOOK
    assert (answers.lower_bound <= right.upper_bound + 1e-12).all()
    assert (right.lower_bound <= answers.upper_bound + 1e-12).all()
    late = answers.status == so.Status.DEADLINE
    assert (answers.evaluations[late] > LITTLE).all()
    assert not answers.certified[late].any()


def test_a_query_cut_short_leaves_what_frames_go_on_from() -> None:
    """Nothing is known after it: each frame at rest proves some more, until all is."""
    a, b = PAIRS["bolt, tube"]
    apart = wandering(a, b, 120, 4e-3, np.random.default_rng(2), 5e-3)[-1]
    hasty = SolidTracker(a, b, deadline=300)
    pair = PlacedPair(a, b, so.Pose.identity(), so.Pose.of(apart))
    first, kept = hasty._asks.cold(pair)
    assert first.status is so.Status.DEADLINE
    assert first.lower_bound <= 0.0
    state = SolidState(first, (a, b), kept, 0)
    _, answers = hasty.run(state, STILL, np.repeat(apart[None], 40, axis=0))
    assert not answers.restarts.any()
    assert answers.certified[-1]
    cold = so.solids.distance(a, b, STILL, apart)
    assert (answers.lower_bound <= cold.upper_bound).all()
    assert (answers.upper_bound >= cold.lower_bound).all()


def test_afront_that_has_grown_is_made_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    a, b = PAIRS["bolt, tube"]
    rng = np.random.default_rng(7)
    poses = [placed(np.eye(3), [0.0, 0.0, 3.0 * a.size])]
    for _ in range(60):  # round about, so that all of both boundaries comes near
        by = Rotation.from_rotvec(0.4 * rng.normal(size=3)).as_matrix()
        turned = Rotation.from_matrix(by @ poses[-1][:3, :3]).as_matrix()
        poses.append(placed(turned, by @ poses[-1][:3, 3]))
    poses = np.array(poses)
    tracker = so.Tracker(a, b)
    state, answers = tracker.run(tracker.start(STILL, poses[0]), STILL, poses)
    assert answers.certified.all()
    assert answers.rebuilds.any()
    assert state.rows < front.MOST_ROWS
    k = int(answers.rebuilds.argmax())
    assert answers[k].counts.rebuilds == 1


def test_what_is_no_pair_of_solids() -> None:
    a, b = PAIRS["bolt, tube"]
    with pytest.raises(so.StandoffError, match="Body B is a half-space, which is not bounded"):
        so.Tracker(a, so.shapes.halfspace())
    with pytest.raises(so.StandoffError, match="Body A is a point: so"):
        so.Tracker(so.shapes.point(), b)
    with pytest.raises(TypeError, match="law"):
        so.Tracker(a, b, law=so.PaperLaw())
    tracker = so.Tracker(a, so.shapes.box((1.0, 1.0, 1.0)))
    assert isinstance(tracker, SolidTracker)
    state = tracker.start(STILL, placed(np.eye(3), [5.0, 0.0, 0.0]))
    assert isinstance(state, SolidState)
    with pytest.raises(so.StandoffError, match="belongs to another pair: its body B"):
        so.Tracker(a, b).step(state, STILL, STILL)
    with pytest.raises(TypeError, match="is no SolidState"):
        tracker.step(None, STILL, STILL)
    poses = np.array([placed(np.eye(3), [5.0, 0.0, 0.0])] * 3)
    poses[2, 0, 0] = np.nan
    with pytest.raises(so.StandoffError, match="poses_b, frame 2, is no pose"):
        tracker.run(state, STILL, poses)
    with pytest.raises(so.StandoffError, match="poses_a are of 2 frames, poses_b of 3"):
        tracker.run(state, poses[:2], poses[[0, 1, 1]])
    _, answers = tracker.run(state, STILL, poses[:2])
    assert isinstance(answers, SolidAnswers)
    assert len(answers) == 2
    assert "2 frames" in repr(answers)
    assert "rows" in repr(state)
    with pytest.raises(ValueError, match="read-only"):
        answers.distance[0] = 0.0
