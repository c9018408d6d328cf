"""Branches: local minima keep their keys from frame to frame, and tell when they come and go."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks.solids import drawn
from scipy.spatial.transform import Rotation

import standoff as so
from families.solid_shapes import bracket, prism, ring, tube
from standoff.solids import MinimumEvent, SolidAnswers
from standoff.tracking.branches import Birth, End
from standoff.tracking.status import Status

Array = np.ndarray
STILL = np.eye(4)
FEET = prism([(0, 0), (3, 0), (3, 1), (2, 1), (2, 0.5), (1, 0.5), (1, 1), (0, 1)], 1.0)
"""A bridge upside down: two feet at y = 1, and a floor between them at y = 0.5."""
BALL = so.shapes.sphere(0.3)
XS = np.linspace(0.2, 2.8, 261)


def placed(turn: Array, shift: Array) -> Array:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, shift
    return matrix


ACROSS = np.array([placed(np.eye(3), [x, 1.5, 0.5]) for x in XS])


def run(tracker, poses: Array) -> SolidAnswers:
    return tracker.run(tracker.start(STILL, poses[0]), STILL, poses)[1]


def kinds(events: tuple[MinimumEvent, ...], kind: str) -> list[tuple[int, float]]:
    return [(each.key, round(float(XS[each.frame]), 2)) for each in events if each.kind == kind]


def test_a_ball_over_two_feet() -> None:
    """By hand: the floor is nearest between x = 1 and 2; the edges of the feet are within reach,
    0.75, up to sqrt(1.05² - 0.5²) from them; half way the second foot becomes the nearer one."""
    answers = run(so.Tracker(FEET, BALL, minima=0.75), ACROSS)
    reach = np.sqrt(1.05**2 - 0.5**2)
    births, ends = kinds(answers.events, "birth"), kinds(answers.events, "end")
    assert [x for _, x in births] == pytest.approx([1.0, 2.0 - reach], abs=0.011)
    assert [x for _, x in ends] == pytest.approx([1.0 + reach, 2.0], abs=0.011)
    assert [key for key, _ in births] == [1, 2]
    assert [key for key, _ in ends] == [0, 1]
    assert {each.reason for each in answers.events if each.kind == "birth"} == {Birth.SEARCH}
    ended = {each.key: each.reason for each in answers.events if each.kind == "end"}
    assert ended == {0: End.FAR, 1: End.LEFT}
    passed = [each for each in answers.events if each.kind == "handover"]
    assert [(each.key, each.other) for each in passed] == [(2, 0)]
    assert XS[passed[0].frame] == pytest.approx(1.5, abs=0.011)
    # a ball at the edge of a foot leaves its face, and comes on to the other's
    for branch, x in ((0, 1.0), (2, 2.0)):
        at = [v for b, v in kinds(answers.events, "switch") if b == branch]
        assert len(at) == 1
        assert at[0] == pytest.approx(x, abs=0.011)
    assert {each.features[0].kind for each in answers.events} == {"face", "edge"}


def test_the_table_is_that_of_the_answers() -> None:
    tracker = so.Tracker(FEET, BALL, minima=0.75)
    # the ball meets the first foot, and comes up again
    down = [placed(np.eye(3), [0.5, y, 0.5]) for y in (1.4, 1.32, 1.25, 1.32, 1.4)]
    answers = run(tracker, np.concatenate([ACROSS[:120], down]))
    told = answers.minima
    assert Status.OVERLAPPING in answers.status
    rows = [(k, m) for k, answer in enumerate(answers) for m in answer.minima]
    assert told.frame.tolist() == [k for k, _ in rows]
    assert told.key.tolist() == [m.key for _, m in rows]
    assert told.distance.tolist() == [m.distance for _, m in rows]
    assert told.lower_bound.tolist() == [m.lower_bound for _, m in rows]
    assert told.point_a == pytest.approx(np.array([m.point_a for _, m in rows]), abs=1e-14)
    assert told.point_b == pytest.approx(np.array([m.point_b for _, m in rows]), abs=1e-14)
    assert list(told.feature_a) == [m.feature_a for _, m in rows]
    assert list(told.feature_b) == [m.feature_b for _, m in rows]
    # it is followed through contact
    nearest = [told.key[told.frame == k][0] for k in (121, 122, 123)]
    assert len(set(nearest)) == 1
    assert told.distance[told.frame == 122][0] < 0.0


def test_no_minimum_is_followed_through_an_overlap_that_is_too_deep_for_places() -> None:
    tracker = so.Tracker(FEET, BALL, minima=0.25)
    ways = [(0.5, 1.4), (0.5, 1.35), (1.5, 0.25), (0.5, 1.35), (0.5, 1.4)]
    answers = run(tracker, np.array([placed(np.eye(3), [x, y, 0.5]) for x, y in ways]))
    told = answers.minima
    assert answers.status[2] is Status.OVERLAPPING
    assert answers.restarts.tolist() == [False, False, True, True, False]
    assert told.key[told.frame == 2].tolist() == [-1]
    last, first = (set(told.key[told.frame == k]) for k in (1, 3))
    assert first
    assert not first & set(told.key[told.frame < 3])
    events = [each for each in answers.events if each.frame in (2, 3)]
    ended = {each.key: each.reason for each in events if each.kind == "end"}
    assert ended == dict.fromkeys(last, End.MET)
    born = {each.key: each.reason for each in events if each.kind == "birth"}
    assert born == dict.fromkeys(first, Birth.START)


def test_a_place_is_followed_deeper_than_others_are_looked_for() -> None:
    tracker = so.Tracker(FEET, BALL, minima=0.25)
    down = np.array([placed(np.eye(3), [0.5, y, 0.5]) for y in (1.4, 1.35, 0.7, 1.35, 1.4)])
    answers = run(tracker, down)
    assert not answers.restarts.any()
    assert answers.distance == pytest.approx([0.1, 0.05, -0.6, 0.05, 0.1])
    assert answers.minima.key.tolist() == [0] * 5


def test_steps_and_runs_in_pieces_go_on_with_the_numbers() -> None:
    tracker = so.Tracker(FEET, BALL, minima=0.75)
    whole = run(tracker, ACROSS)
    state = tracker.start(STILL, ACROSS[0])
    told, events = [], []
    for first in range(0, len(ACROSS), 40):
        state, answers = tracker.run(state, STILL, ACROSS[first : first + 40])
        told += [[m.key for m in answer.minima] for answer in answers]
        events += [each._replace(frame=each.frame + first) for each in answers.events]
    assert told == [[m.key for m in answer.minima] for answer in whole]
    assert tuple(events) == whole.events
    assert state.born == 3
    state = tracker.start(STILL, ACROSS[100])
    for pose in ACROSS[100:160]:
        state, found = tracker.step(state, STILL, pose)
        assert [m.key for m in found.minima] == [m.key for m in state.proximity.minima]
        assert {m.key for m in found.minima} <= {0, 1, 2}


def test_two_places_of_a_ring_keep_their_numbers_through_their_tie() -> None:
    link = ring(1.0, 0.25)
    turns = [
        Rotation.from_euler("xy", [np.pi / 2, t]).as_matrix() for t in np.linspace(-0.1, 0.1, 41)
    ]
    poses = np.array(
        [placed(r, [0.97, t, 0]) for r, t in zip(turns, np.linspace(-0.1, 0.1, 41), strict=True)]
    )
    answers = run(so.Tracker(link, link, minima=0.5), poses)
    told = answers.minima
    assert set(told.key) == {0, 1}
    for branch in (0, 1):
        mine = told.key == branch
        assert mine.sum() == len(poses)
        assert np.abs(np.diff(told.point_a[mine], axis=0)).max() < 0.2
    assert {each.kind for each in answers.events} <= {"switch", "handover"}


def test_a_minimum_is_handed_on_from_leaf_to_leaf_past_another_one() -> None:
    """A pair of leaves' parts in which Newton's method has come to another place than the minimum
    that goes into it from the leaves beside."""
    rng = np.random.default_rng(7)
    part = (drawn(15, rng), drawn(31, rng))[1]
    bush = tube(1.2, 2.0, 0.0, 1.0)
    turn = Rotation.from_rotvec([0.82595379642, -0.7842925249, 0.09328590514]).as_matrix()
    by = Rotation.from_rotvec([-4.174979e-05, 0.0011210823479, 0.0006802114684]).as_matrix()
    poses = [placed(turn, [0.21215068295, -0.00155517507, -0.85912246521])]
    for _ in range(20):
        shift = poses[-1][:3, 3] + [-0.00304710443, 0.00030625465, -0.00662857767]
        poses.append(placed(by @ poses[-1][:3, :3], shift))
    below = 1.04214352
    answers = run(so.Tracker(bush, part, minima=below), np.array(poses))
    for k in (3, 8, 14):
        cold = so.solids.distance(bush, part, STILL, poses[k], minima=below)
        told = np.array([m.distance for m in answers[k].minima])
        for each in cold.minima:
            assert np.abs(told - each.distance).min() < 1e-8
    counts = [len(answer.minima) for answer in answers]
    born = [each for each in answers.events if each.kind == "birth"]
    ended = [each for each in answers.events if each.kind == "end"]
    assert counts[-1] == counts[0] + len(born) - len(ended)
    # 20 frames of a slow motion: each minimum comes or goes once, at most
    assert len({each.key for each in born}) == len(born) <= 3


@pytest.mark.parametrize(
    "seed", [*range(3), *(pytest.param(k, marks=pytest.mark.soak) for k in range(3, 40))]
)
def test_numbers_are_of_places_that_move_little(seed: int) -> None:
    """A branch does not leap: its points move by little more than the bodies and what they bend."""
    rng = np.random.default_rng(seed)
    shapes = [FEET, bracket(), tube(0.5, 0.8, 0.0, 0.6), so.Solid(so.shapes.box((1.0, 0.7, 0.4)))]
    leaps = frames = 0
    for _ in range(10):
        a, b = shapes[rng.integers(3)], shapes[rng.integers(4)]
        way = rng.normal(size=3)
        at = way / np.linalg.norm(way) * 0.6 * (a.size + b.size)
        pose = placed(Rotation.random(random_state=rng).as_matrix(), at)
        least = so.solids.distance(a, b, STILL, pose).distance
        if least < 0.05:
            continue
        spin, drift = rng.normal(size=(2, 3)) * 1e-3
        poses = [pose]
        for _ in range(40):
            step = Rotation.from_rotvec(spin).as_matrix()
            poses.append(placed(step @ poses[-1][:3, :3], poses[-1][:3, 3] + drift))
        answers = run(so.Tracker(a, b, minima=least + 0.5), np.array(poses))
        told = answers.minima
        for k in range(1, len(poses)):
            now, last = told.frame == k, told.frame == k - 1
            assert len(set(told.key[now])) == now.sum()
            for i in np.flatnonzero(now):
                for j in np.flatnonzero(last & (told.key == told.key[i])):
                    frames += 1
                    leaps += np.linalg.norm(told.point_a[i] - told.point_a[j]) > 0.1 * a.size
    assert frames > 100
    assert leaps == 0


def test_without_minima_there_are_none() -> None:
    answers = run(so.Tracker(FEET, BALL), ACROSS[:3])
    for each in ("minima", "events"):
        with pytest.raises(so.StandoffError, match="minima="):
            getattr(answers, each)
    assert answers[0].minima[0].key == -1
    assert so.solids.distance(FEET, BALL, STILL, ACROSS[0], minima=0.75).minima[0].key == -1


@pytest.mark.parametrize(("tilt", "reason"), [(0.02, End.LEFT), (0.0, End.MERGED)])
def test_two_minima_become_one(tilt: float, reason: End) -> None:
    """A rod across a ring rolls outwards. A little tilted, the farther of its two places vanishes
    away from the other; level, both come together at the top, which was a saddle between them."""
    link, rod = ring(1.0, 0.2), so.shapes.capsule(0.1, 3.0)
    turn = Rotation.from_euler("y", np.pi / 2 - tilt).as_matrix()
    poses = np.array([placed(turn, [0, y, 0.45]) for y in np.linspace(0.9, 1.3, 81)])
    answers = run(so.Tracker(link, rod, minima=0.75), poses)
    counts = [len(answer.minima) for answer in answers]
    assert (counts[0], counts[-1]) == (2, 1)
    ended = [each for each in answers.events if each.kind == "end"]
    assert ended[0].reason is reason
    assert ended[0].other == (answers[-1].minima[0].key if reason is End.MERGED else -1)
