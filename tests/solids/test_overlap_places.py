"""Places of overlap: the depth of each, against convex bodies' certified depth and closed forms,
from nothing and from frame to frame."""

from __future__ import annotations

from functools import cache, partial

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from draws import draws
from families.solid_shapes import peg, prism, tube
from on_first_use import OnFirstUse
from standoff.solids import Solid, SolidProximity
from standoff.solids.spatial.overlap import Ascent
from standoff.tracking.status import Status

Array = np.ndarray
STILL = so.Pose.identity()


@cache
def feet() -> Solid:
    """A bridge upside down: two feet at y = 1."""
    return prism([(0, 0), (3, 0), (3, 1), (2, 1), (2, 0.5), (1, 0.5), (1, 1), (0, 1)], 1.0)


@cache
def lid() -> Solid:
    """Over both feet: its lower face at y = -0.5."""
    return Solid(so.shapes.box((6.0, 1.0, 4.0)))


def hull(seed: int) -> so.Body:
    points = np.random.default_rng(seed).normal(size=(9, 3))
    return so.shapes.polytope(0.5 * points / np.linalg.norm(points, axis=1)[:, None])


CONVEX = {
    "box": so.shapes.box((1.0, 0.8, 0.6)),
    "egg": so.shapes.ellipsoid(0.5, 0.4, 0.3),
    "cylinder": so.shapes.cylinder(0.3, 0.8),
    "capsule": so.shapes.capsule(0.2, 0.6),
    "polytope": hull(2),
}
SOLIDS = OnFirstUse({name: partial(Solid, body) for name, body in CONVEX.items()})


def pushed_in(a: so.Body, b: so.Body, depth: float, rng: np.random.Generator) -> so.Pose:
    """A pose of B, A at rest, from where they touch a way of this length farther in."""
    way = rng.normal(size=3)
    pose = so.Pose.exp(rng.normal(size=3), 2.0 * way / np.linalg.norm(way))
    apart = so.distance(a, b, STILL, pose)
    return so.Pose(pose.rotation, pose.translation - apart.normal * (apart.distance + depth))


def depths(answer: SolidProximity) -> list[float]:
    return [m.distance for m in answer.minima if m.distance < 0.0]


def check_claims(answer: SolidProximity) -> None:
    """What an answer in overlap says of itself."""
    assert answer.overlap is not None
    assert answer.upper_bound == -answer.overlap.depth <= -2.0 * answer.overlap.radius
    assert answer.lower_bound <= answer.distance <= answer.upper_bound
    assert answer.distance == min(answer.upper_bound, answer.minima[0].distance)
    for each in answer.minima:
        gap = each.point_b - each.point_a
        assert gap == pytest.approx(each.distance * each.normal, abs=1e-9)
        assert each.lower_bound <= each.distance


@pytest.mark.parametrize("name", CONVEX)
@pytest.mark.parametrize("other", CONVEX)
def test_the_depth_of_convex_bodies_is_their_certified_one(
    name: str, other: str, rng: np.random.Generator
) -> None:
    a, b = CONVEX[name], CONVEX[other]
    for _ in range(draws(6)):
        depth = 10.0 ** rng.uniform(-5.0, -1.7)
        pose = pushed_in(a, b, depth, rng)
        certified = so.distance(a, b, STILL, pose)
        told = so.solids.distance(SOLIDS[name], SOLIDS[other], STILL, pose, minima=3.0 * depth)
        assert told.status is Status.OVERLAPPING
        check_claims(told)
        assert max(depths(told)) == pytest.approx(certified.distance, abs=1e-9)
        # what no translation is less than is no more than the least depth
        assert told.overlap.depth <= -certified.distance + 1e-9
        if told.overlap.parting is not None:
            assert -told.lower_bound == pytest.approx(np.linalg.norm(told.overlap.parting))
            assert -told.lower_bound >= -certified.distance - 1e-9
            moved = so.Pose(pose.rotation, pose.translation + told.overlap.parting)
            assert so.distance(a, b, STILL, moved).distance > 0.0


def test_most_overlaps_are_proven_to_be_parted_by_a_shift(rng: np.random.Generator) -> None:
    names, parted, n = list(CONVEX), 0, draws(30)
    for k in range(n):
        name, other = names[k % 5], names[(k // 5) % 5]
        pose = pushed_in(CONVEX[name], CONVEX[other], 1e-3, rng)
        told = so.solids.distance(SOLIDS[name], SOLIDS[other], STILL, pose, minima=3e-3)
        parted += told.overlap.parting is not None
    assert parted > 0.9 * n


@pytest.mark.parametrize("turn", [0.0, 1e-3, -0.02])
def test_two_feet_have_a_depth_each(turn: float) -> None:
    pose = so.Pose.exp((0.0, 0.0, turn), (1.5, 1.49, 0.5))
    told = so.solids.distance(feet(), lid(), STILL, pose, minima=0.1)
    check_claims(told)
    n = pose.rotation @ np.array([0.0, 1.0, 0.0])
    low = pose.translation - 0.5 * n
    deep = [
        min(n @ (np.array([x, 1.0, 0.0]) - low) * -1.0 for x in ends) for ends in ((0, 1), (2, 3))
    ]
    assert sorted(depths(told)) == pytest.approx(sorted(deep), abs=1e-10)
    assert [m.normal for m in told.minima] == [pytest.approx(n, abs=1e-9)] * 2
    for each in told.minima:
        assert each.lower_bound == pytest.approx(each.distance, abs=1e-7)


def test_a_foot_that_stands_on_a_face_has_one_place_and_four_corners() -> None:
    pose = so.Pose(np.eye(3), [1.5, 1.49, 0.5])
    told = so.solids.distance(feet(), lid(), STILL, pose, minima=0.1, patch=1e-3)
    assert depths(told) == pytest.approx([-0.01, -0.01])
    corners = {tuple(np.round(x, 9)[[0, 2]]) for each in told.minima for x, _ in each.patch}
    assert corners == {(float(x), float(z)) for x in (0, 1, 2, 3) for z in (0, 1)}


def test_a_peg_pressed_into_the_wall_of_its_hole() -> None:
    bush, pin = tube(0.5, 0.8, -0.5, 0.5), peg(0.49, -0.7, 0.7)
    pose = so.Pose(np.eye(3), [0.012, 0.0, 0.0])
    told = so.solids.distance(bush, pin, STILL, pose, minima=0.005, patch=1e-6)
    assert depths(told) == pytest.approx([-0.002])
    assert told.minima[0].normal == pytest.approx([-1.0, 0.0, 0.0], abs=1e-9)
    assert told.minima[0].lower_bound == pytest.approx(-0.002, abs=1e-7)
    # along the whole line of the wall
    heights = [x[2] for x, _ in told.minima[0].patch]
    assert (min(heights), max(heights)) == pytest.approx((-0.5, 0.5), abs=1e-6)


def test_faces_that_look_past_each_other_are_no_overlap() -> None:
    plate = Solid(so.shapes.box((1.0, 1.0, 0.02)))
    told = so.solids.distance(
        plate, plate, STILL, so.Pose(np.eye(3), [0.1, 0.2, 0.019]), minima=0.1
    )
    # the lower faces look at the upper ones through both plates, at a depth of 0.039
    assert depths(told) == pytest.approx([-0.001])
    apart = so.solids.distance(
        plate, plate, STILL, so.Pose(np.eye(3), [0.1, 0.2, 0.021]), minima=0.1
    )
    assert [m.distance for m in apart.minima] == pytest.approx([0.001])


@pytest.mark.parametrize("name", ["box", "cylinder", "egg"])
def test_neither_order_nor_place_changes_a_depth(name: str, rng: np.random.Generator) -> None:
    solid, other = SOLIDS[name], SOLIDS["polytope"]
    for _ in range(draws(5)):
        pose = pushed_in(CONVEX[name], CONVEX["polytope"], 4e-3, rng)
        one = so.solids.distance(solid, other, STILL, pose, minima=0.02)
        back = so.solids.distance(other, solid, pose, STILL, minima=0.02)
        moved = so.Pose.exp(rng.normal(size=3), rng.normal(size=3))
        there = so.solids.distance(solid, other, moved, moved @ pose, minima=0.02)
        # whether two places are found to be in one region may depend on the order
        assert max(depths(back)) == pytest.approx(max(depths(one)), abs=1e-10)
        assert max(depths(there)) == pytest.approx(max(depths(one)), abs=1e-10)
        for each in one.minima:
            same = [m for m in back.minima if abs(m.distance - each.distance) < 1e-10]
            for opposite in same:
                assert opposite.normal == pytest.approx(-each.normal, abs=1e-7)


def bounce(frames: int) -> list[so.Pose]:
    """The lid comes down on both feet, rocks, and leaves them again."""
    t = np.linspace(0.0, 1.0, frames)
    heights = 1.5 + 0.03 * np.cos(2.0 * np.pi * t)
    rocking = 0.006 + 0.004 * np.sin(6.0 * np.pi * t)
    turns = Rotation.from_rotvec(np.outer(rocking, [0.1, 0.0, 1.0]))
    return [
        so.Pose(r.as_matrix(), [1.5 + 0.02 * s, y, 0.5])
        for r, s, y in zip(turns, t, heights, strict=True)
    ]


def test_a_place_is_followed_through_contact() -> None:
    poses = bounce(241)
    tracker = so.Tracker(feet(), lid(), minima=0.1)
    state = tracker.start(STILL, poses[0])
    _, answers = tracker.run(state, STILL, poses)
    met = np.array([status is Status.OVERLAPPING for status in answers.status])
    assert 60 < met.sum() < 180
    assert not answers.restarts.any()
    told = answers.minima
    assert set(told.key.tolist()) == {0, 1}
    for key in (0, 1):
        mine = told.key == key
        assert mine.sum() == len(poses)
        # a depth is as continuous as the motion: it changes by no more than the points move
        steps = np.abs(np.diff(told.distance[mine]))
        assert (steps <= answers.motion[1:] * (1.0 + 1e-9)).all()
    assert {event.kind for event in answers.events} <= {"switch", "handover"}
    for k in range(0, len(poses), 8):
        answer = answers[k]
        cold = so.solids.distance(feet(), lid(), STILL, poses[k], minima=0.1)
        assert answer.status is cold.status
        assert [m.distance for m in answer.minima] == pytest.approx(
            [m.distance for m in cold.minima], abs=1e-9
        )
        if met[k]:
            check_claims(answer)


def test_frames_one_by_one_are_those_of_a_run() -> None:
    poses = bounce(61)
    tracker = so.Tracker(feet(), lid(), minima=0.1)
    state = start = tracker.start(STILL, poses[0])
    _, answers = tracker.run(start, STILL, poses)
    for k, pose in enumerate(poses):
        state, answer = tracker.step(state, STILL, pose)
        assert [(m.key, m.distance) for m in answer.minima] == [
            (m.key, m.distance) for m in answers[k].minima
        ]


def test_a_start_in_an_overlap_and_without_minima() -> None:
    poses = bounce(121)[60:]
    tracker = so.Tracker(feet(), lid())
    state = tracker.start(STILL, poses[0])
    assert state.proximity.status is Status.OVERLAPPING
    _, answers = tracker.run(state, STILL, poses)
    assert answers.status[0] is Status.OVERLAPPING
    assert answers.status[-1] is Status.CONVERGED
    assert answers[0].minima[0].distance < 0.0
    assert not answers.restarts.any()
    for k in range(0, len(poses), 6):
        cold = so.distance(feet(), lid(), STILL, poses[k])
        assert answers[k].status is cold.status
        assert answers[k].minima[0].distance == pytest.approx(cold.minima[0].distance, abs=1e-9)


def test_an_overlap_too_deep_for_places_is_still_told() -> None:
    told = so.distance(feet(), lid(), STILL, so.Pose(np.eye(3), [1.5, 0.3, 0.5]))
    assert told.status is Status.OVERLAPPING
    assert told.distance == -told.overlap.depth
    assert told.lower_bound == pytest.approx(-0.8, rel=2e-3)  # the lid leaves the feet upwards
    assert 0.39 < told.overlap.radius <= 0.4
    tracker = so.Tracker(feet(), lid())
    state = tracker.start(STILL, so.Pose(np.eye(3), [1.5, 0.3, 0.5]))
    _, answer = tracker.step(state, STILL, so.Pose(np.eye(3), [1.5, 0.31, 0.5]))
    assert answer.status is Status.OVERLAPPING
    assert answer.counts.restarts == 1


def test_a_deadline_ends_the_ascent_of_a_ball(monkeypatch: pytest.MonkeyPatch) -> None:
    looks: list[int] = []
    look = Ascent.look

    def counted(ascent: Ascent, point: Array, known: Array) -> Array:
        before = ascent.left
        told = look(ascent, point, known)
        looks.append(before - ascent.left)
        return told

    monkeypatch.setattr(Ascent, "look", counted)
    pose = so.Pose(np.eye(3), [1.5, 0.3, 0.5])
    whole = so.distance(feet(), lid(), STILL, pose)
    spent = sum(looks)
    assert len(looks) > 20
    looks.clear()
    short = so.solids.distance(feet(), lid(), STILL, pose, deadline=spent // 10)
    assert sum(looks[:-1]) < spent // 10
    assert short.status is Status.OVERLAPPING
    assert 0.0 < short.overlap.radius <= whole.overlap.radius
    for solid, at in (
        (feet(), short.overlap.common_point),
        (lid(), short.overlap.common_point - pose.translation),
    ):
        assert solid.signed_distance([at]).distance[0] <= -short.overlap.radius + 1e-9
