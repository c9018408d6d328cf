"""All local minima below a distance in each frame: those that a query from nothing finds."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from benchmarks.solids import drawn, posed
from scipy.spatial.transform import Rotation

import standoff as so
from families.solid_shapes import bracket, egg, peg, prism, ring, tube
from on_first_use import OnFirstUse
from standoff.solids import Solid, SolidProximity

Array = np.ndarray
STILL = np.eye(4)


@cache
def table() -> Solid:
    """A bridge upside down: two feet at y = 1."""
    return prism([(0, 0), (3, 0), (3, 1), (2, 1), (2, 0.5), (1, 0.5), (1, 1), (0, 1)], 1.0)


CASES = OnFirstUse(
    {
        "bracket, bracket": lambda: (bracket(), bracket(), 1.2, [0.79, -1.17, 1.05]),
        "feet, egg": lambda: (table(), egg(0.9, 0.6, 0.4), 1.2, [1.17, 1.63, 1.68]),
        "tube, peg": lambda: (tube(1.2, 2.0, 0.0, 1.0), peg(0.3, -1.0, 1.0), 1.1, [0.3, 0.1, 0.5]),
        "feet, tube": lambda: (table(), tube(0.5, 0.8, 0.0, 0.6), 0.8, [1.99, 0.85, -1.28]),
    }
)


def placed(turn: Array, shift: Array) -> Array:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, shift
    return matrix


def path(start: list[float], frames: int, rng: np.random.Generator) -> Array:
    """Poses (n, 4, 4) about a place, in steps of some 1e-2."""
    poses, turn, at = [], Rotation.from_rotvec([0.3, 0.4, -0.2]), np.array(start)
    spin, drift = rng.normal(size=(2, 3))
    for _ in range(frames):
        spin, drift = spin + 0.3 * rng.normal(size=3), drift + 0.3 * rng.normal(size=3)
        turn = Rotation.from_rotvec(6e-3 * spin / np.linalg.norm(spin)) * turn
        at = at + 6e-3 * drift / np.linalg.norm(drift) - 0.02 * (at - start)
        poses.append(placed(turn.as_matrix(), at))
    return np.array(poses)


def are_same(answer: SolidProximity, cold: SolidProximity) -> None:
    assert answer.status is cold.status
    assert [m.distance for m in answer.minima] == pytest.approx(
        [m.distance for m in cold.minima], abs=1e-9
    )
    for each, other in zip(answer.minima, cold.minima, strict=True):
        # what is proven of a minimum that is not the nearest is less in a frame
        assert answer.lower_bound - 1e-12 <= each.lower_bound <= each.distance
        assert each.lower_bound <= other.distance + 1e-9


@pytest.mark.parametrize("name", CASES)
def test_the_minima_of_a_frame_are_those_of_a_query(name: str) -> None:
    a, b, below, start = CASES[name]
    poses = path(start, 90, np.random.default_rng(len(name)))
    tracker = so.Tracker(a, b, minima=below)
    state = tracker.start(STILL, poses[0])
    are_same(state.proximity, so.solids.distance(a, b, STILL, poses[0], minima=below))
    state, answers = tracker.run(state, STILL, poses[1:])
    assert answers.certified.all()
    several = 0
    for k in range(0, len(answers), 4):
        cold = so.solids.distance(a, b, STILL, poses[k + 1], minima=below)
        are_same(answers[k], cold)
        several += len(cold.minima) > 1
    assert several > 5
    assert not answers.restarts.any()


def test_two_places_of_a_ring_are_followed_through_their_tie() -> None:
    """Which of two is nearer changes; both are told all the time, and a step is a run."""
    link = ring(1.0, 0.25)
    angles = np.linspace(-0.1, 0.1, 41)
    poses = np.array(
        [
            placed(Rotation.from_euler("xy", [np.pi / 2, t]).as_matrix(), [0.97, t, 0])
            for t in angles
        ]
    )
    tracker = so.Tracker(link, link, minima=0.5)
    state = tracker.start(STILL, poses[0])
    last = None
    for pose in poses:
        state, found = tracker.step(state, STILL, pose)
        assert len(found.minima) == 2
        points = np.array(sorted(m.point_a.tolist() for m in found.minima))
        if last is not None:  # none of the two hops
            assert np.abs(points - last).max() < 0.2
        last = points


def test_minima_come_and_go() -> None:
    """A ball over two feet: one, two, one."""
    ball = so.shapes.sphere(0.3)
    xs = np.linspace(0.2, 2.8, 54)
    poses = np.array([placed(np.eye(3), [x, 1.5, 0.5]) for x in xs])
    tracker = so.Tracker(table(), ball, minima=0.75)
    _, answers = tracker.run(tracker.start(STILL, poses[0]), STILL, poses)
    for x, answer in zip(xs, answers, strict=True):
        # over a foot, or beside its edge; and the floor between both, 1 below the middle
        expected = [max(0.0, x - 1.0), max(0.0, 2.0 - x)]
        distances = sorted(np.hypot(each, 0.5) - 0.3 for each in expected)
        if 1.0 < x < 2.0:
            distances.append(1.0 - 0.3)
        told = sorted(d for d in distances if d < 0.75 - 1e-9)
        assert [m.distance for m in answer.minima] == pytest.approx(told, abs=1e-9)


def test_a_frame_without_time_for_all_minima_says_so() -> None:
    """Those that come up are found late, and until then it is said; those of before are kept."""
    ball = so.shapes.sphere(0.3)
    xs = np.linspace(0.4, 1.4, 24)
    poses = np.array([placed(np.eye(3), [x, 1.5, 0.5]) for x in xs])
    tracker = so.Tracker(table(), ball, minima=0.75)
    state = tracker.start(STILL, poses[0])
    assert len(state.proximity.minima) == 1
    hasty = so.Tracker(table(), ball, minima=0.75, deadline=12)
    _, answers = hasty.run(state, STILL, poses)
    few = [answer for x, answer in zip(xs, answers, strict=True) if x > 1.1]
    assert {answer.status for answer in few if len(answer.minima) < 3} == {so.Status.DEADLINE}
    state, _ = hasty.run(state, STILL, poses)
    _, found = tracker.step(state, STILL, poses[-1])
    assert found.certified
    assert len(found.minima) == 3
    # no time at all: what was followed before is followed on
    none = so.Tracker(table(), ball, minima=0.75, deadline=1)
    state, found = none.step(state, STILL, poses[-1])
    assert found.status is so.Status.DEADLINE
    assert len(found.minima) == len(state.proximity.minima)


def test_what_is_asked_of_minima_is_checked() -> None:
    for wrong in (0.0, -1.0, np.nan):
        with pytest.raises(so.StandoffError, match="minima"):
            so.Tracker(table(), peg(0.4, -1.0, 1.0), minima=wrong)


def test_vertices_are_minima_where_all_ways_lead_off() -> None:
    """A ball beside the gap of two feet, in front of them: a corner of each, and none else."""
    ball = so.shapes.sphere(0.1)
    pose = placed(np.eye(3), [1.52, 1.3, 1.4])
    found = so.solids.distance(table(), ball, STILL, pose, minima=0.7)
    expected = [np.hypot(x, 0.5) - 0.1 for x in (0.48, 0.52)]
    assert [m.distance for m in found.minima] == pytest.approx(expected, abs=1e-9)
    assert {m.feature_a.kind for m in found.minima} == {"vertex"}


@cache
def stepped() -> Solid:
    """A turned part, each of whose steps has a minimum to a foot of the table."""
    return drawn(15, np.random.default_rng(1))


def stepping() -> Array:
    """Poses of `stepped` at which its minima pass from leaf to leaf."""
    turn = Rotation.from_rotvec([-1.47119, 0.70328, -0.65758]).as_matrix()
    by = Rotation.from_rotvec([3.99e-4, -1.285e-3, 2.356e-3]).as_matrix()
    poses = [placed(turn, [0.22098, 0.19456, -3.17058])]
    for _ in range(20):
        shift = poses[-1][:3, 3] + [-6.65e-4, 1.292e-3, 1.032e-3]
        poses.append(placed(by @ poses[-1][:3, :3], shift))
    return np.array(poses)


def test_no_plane_shuts_out_a_minimum_that_is_asked() -> None:
    """What a plane's face leaves out is farther than the minima, not than the nearest points; and
    of a state of a tracker that asked less, nothing of that is taken over."""
    poses, below = stepping(), 3.4
    all_of_them, few = (so.Tracker(table(), stepped(), minima=each) for each in (below, 2.906))
    _, answers = all_of_them.run(all_of_them.start(STILL, poses[0]), STILL, poses)
    assert {len(answer.minima) for answer in answers} == {6}
    state, answers = few.run(few.start(STILL, poses[0]), STILL, poses[:15])
    assert {len(answer.minima) for answer in answers} <= {1, 2}
    _, answers = all_of_them.run(state, STILL, poses[15:])
    assert {len(answer.minima) for answer in answers} == {6}
    assert not answers.restarts.any()


@pytest.mark.parametrize(
    "seed", [*range(2), *(pytest.param(k, marks=pytest.mark.soak) for k in range(2, 40))]
)
def test_no_minimum_is_lost_in_drawn_motions(seed: int) -> None:
    """Of turned parts with many edges, whose leaves their minima pass through."""
    rng = np.random.default_rng(seed)
    shapes = [table(), bracket(), drawn(15, rng), drawn(9, rng), tube(1.2, 2.0, 0.0, 1.0)]
    several = 0
    for _ in range(8):
        a, b = (shapes[k] for k in rng.choice([[0, 2], [1, 2], [2, 3], [4, 3], [0, 4]]))
        way = rng.normal(size=3)
        at = way / np.linalg.norm(way) * rng.uniform(0.3, 0.7) * (a.size + b.size)
        pose = placed(Rotation.random(random_state=rng).as_matrix(), at)
        least = so.solids.distance(a, b, STILL, pose).distance
        if least < 0.05:
            continue
        spin, drift = rng.normal(size=(2, 3)) * rng.choice([1e-3, 5e-3])
        poses = [pose]
        for _ in range(20):
            step = Rotation.from_rotvec(spin).as_matrix()
            poses.append(placed(step @ poses[-1][:3, :3], poses[-1][:3, 3] + drift))
        below = least + rng.uniform(0.1, 0.6)
        tracker = so.Tracker(a, b, minima=below)
        _, answers = tracker.run(tracker.start(STILL, pose), STILL, np.array(poses))
        for k in (8, 14, 20):
            cold = so.solids.distance(a, b, STILL, poses[k], minima=below)
            told = np.array([m.distance for m in answers[k].minima])
            for each in cold.minima:
                if each.distance < below - 1e-7:
                    assert np.abs(told - each.distance).min(initial=np.inf) < 1e-8
            several += len(cold.minima) > 1
    assert several > 0


def test_a_line_that_is_farther_than_the_nearest_is_one_minimum() -> None:
    """A rod in the corner of a bracket: its end is at the wall, x = 0.4, nearer than its side, all
    of which is as far from the floor, y = 0.4."""
    rod = so.shapes.capsule(0.1, 0.6)
    turn = Rotation.from_euler("y", np.pi / 2).as_matrix()
    gaps = np.linspace(0.05, 0.15, 21)
    poses = np.array([placed(turn, [0.4 + gap + 0.4, 0.7, 0.35]) for gap in gaps])
    tracker = so.Tracker(bracket(), rod, minima=0.3)
    _, answers = tracker.run(tracker.start(STILL, poses[0]), STILL, poses)
    for gap, answer in zip(gaps, answers, strict=True):
        assert [m.distance for m in answer.minima] == pytest.approx([gap, 0.2], abs=1e-9)
    assert set(answers.minima.key) == {0, 1}


def test_a_peg_in_its_hole_stays_in_the_compiled_loop() -> None:
    """A play of a thousandth bends the gap so little that it may seem a continuum; and all of the
    wall is within what is asked, which a query from nothing would take seconds for."""
    bush, pin = tube(1.0, 2.0, 0.0, 3.0), peg(0.999, -1.0, 2.0)
    poses = []
    for k in range(1, 13):
        tilt = Rotation.from_rotvec([2e-4 * np.cos(0.014 * k), 2e-4 * np.sin(0.02 * k), 0.0])
        poses.append(placed(tilt.as_matrix(), [1e-4 * np.sin(0.026 * k), 1e-4, 1.5 - 1e-4 * k]))
    tracker = so.Tracker(bush, pin, minima=2e-3)
    state = tracker.start(STILL, poses[0])
    assert state.proximity.certified
    _, answers = tracker.run(state, STILL, np.array(poses))
    assert answers.certified.all()
    assert {len(answer.minima) for answer in answers} == {2}
    assert len(answers._special) < 6  # frames that Python had to look at
    cold = so.solids.distance(bush, pin, STILL, poses[-1])
    assert answers.distance[-1] == pytest.approx(cold.distance, abs=1e-9)


def test_many_minima_are_all_told_from_the_start_on() -> None:
    """Two parts of 59 faces, of whose pieces thousands of pairs may hold a minimum."""
    rng = np.random.default_rng(100)
    a, b = drawn(60, rng), drawn(60, rng)
    turn, shift = posed(a, b, 0.1, rng)
    pose = placed(turn, shift)
    below = so.solids.distance(a, b, STILL, pose).distance + 0.4
    cold = so.solids.distance(a, b, STILL, pose, minima=below)
    tracker = so.Tracker(a, b, minima=below)
    state = tracker.start(STILL, pose)
    _, found = tracker.step(state, STILL, pose)
    for answer in (state.proximity, found):
        assert answer.status is so.Status.CONVERGED
        told = [m.distance for m in answer.minima]
        assert told == pytest.approx([m.distance for m in cold.minima], abs=1e-9)
    assert len(cold.minima) > 20
