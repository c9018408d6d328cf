"""Patches of convex bodies: pairs of points that span where the gap is hardly wider."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

import standoff as so
from tracking.contact_cases import BOX, CAPSULE, CASES, CYLINDER, LYING, ROUNDED
from tracking.made_answers import made_answer, random_pose, same_points

Array = NDArray[np.float64]

s = so.shapes
HOME = so.Pose.identity()
SLAB = s.box(4, 4, 1)
ANGLES = np.arange(6) * np.pi / 3
NUT = s.polytope([(0.6 * np.cos(t), 0.6 * np.sin(t), z) for t in ANGLES for z in (-0.3, 0.3)])
GROUND = s.halfspace((0, 0, 1))

LEVEL = {
    "face over a rim": (SLAB, BOX, so.Pose(np.eye(3), [1.8, 0.0, 1.1])),
    "face on face": (BOX, BOX, so.Pose.exp([0, 0, 0.5], [0.1, 0.05, 1.1])),
    "octagon": (BOX, BOX, so.Pose.exp([0, 0, np.pi / 4], [0, 0, 1.1])),
    "nut": (SLAB, NUT, so.Pose(np.eye(3), [0, 0, 0.9])),
    "nut on nut": (NUT, NUT, so.Pose.exp([0, 0, 0.3], [0.1, 0.2, 0.7])),
    "can": (SLAB, CYLINDER, so.Pose(np.eye(3), [0, 0, 1.6])),
    "can over a rim": (SLAB, CYLINDER, so.Pose(np.eye(3), [1.8, 0, 1.6])),
    "can on can": (CYLINDER, CYLINDER, so.Pose(np.eye(3), [0.3, 0, 2.1])),
    "lying can": (SLAB, CYLINDER, so.Pose.exp(LYING, [0, 0, 1.1])),
    "lying can over a rim": (SLAB, CYLINDER, so.Pose.exp(LYING, [0, 1.5, 1.1])),
    "cans side by side": (CYLINDER, CYLINDER, so.Pose(np.eye(3), [1.1, 0, 0.3])),
    "capsules": (CAPSULE, CAPSULE, so.Pose(np.eye(3), [0.5, 0, 0.3])),
    "rounded": (ROUNDED, ROUNDED, so.Pose.exp([0, 0, 0.3], [0.2, 0.1, 1.1])),
    "ground": (GROUND, BOX, so.Pose.exp([0, 0, 0.3], [0.2, 0.1, 0.6])),
    "in each other": (SLAB, BOX, so.Pose(np.eye(3), [1.8, 0.0, 0.99])),
}
LINES = ("lying can", "lying can over a rim", "cans side by side", "capsules")


def rocking(pose: so.Pose, tilt: float, count: int = 1000) -> list[so.Pose]:
    """B tilts to all sides by about `tilt` and slides by half of it times a length of 1."""
    k = 2.0 * np.pi * np.arange(count) / count
    turns = tilt * np.column_stack([np.sin(7 * k), np.sin(5 * k + 1), np.sin(3 * k + 2)])
    shifts = 0.5 * tilt * np.column_stack([np.sin(4 * k), np.sin(6 * k + 1), 0.0 * k])
    rocked = [so.Pose.exp(turn).rotation for turn in turns]
    return [
        so.Pose(pose.rotation @ turn, pose.translation + shift)
        for turn, shift in zip(rocked, shifts, strict=True)
    ]


def ran(a: so.Body, b: so.Body, poses: list[so.Pose]) -> so.tracking.Answers:
    tracker = so.Tracker(a, b)
    return tracker.run(tracker.start(HOME, poses[0]), HOME, poses)[1]


def area(points: Array, normal: Array) -> float:
    """Of a polygon whose corners run counterclockwise about the normal."""
    turned = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    return 0.5 * float(turned @ normal)


# Where these meet or overlap another normal is nearer than that of the case.
THIN = ("box: sliver", "box: corner on corner", "disc on disc: sliver", "disc beside disc")
MEETINGS = [
    pytest.param(case, gap, id=f"{case}, {gap:g}")
    for case in CASES
    for gap in (0.01, 0.0, -0.01)
    if (gap > 0.0 or gap in case.gaps) and (gap > 0.0 or str(case) not in THIN)
]


@pytest.mark.parametrize(("case", "gap"), MEETINGS)
def test_level_pairs_as_their_witness_sets(case, gap, rng):
    """All corners of the set, or four of them that span at least half of it."""
    world = random_pose(rng, 2.0, case.a.dimension == 2)
    pose = world @ so.Pose.exp(case.turn, np.array(case.position) + gap * np.array(case.normal))
    answer = so.distance(case.a, case.b, world, pose)
    found, patch = answer.witness_set(), answer.patch(1e-6)
    size = min(body.size for body in (case.a, case.b) if body.bounded and body.size > 0.0)
    off = patch.points_b - patch.points_a - answer.distance * answer.normal
    assert np.abs(off).max() <= 2e-6
    if found.dimension == 0:
        assert len(patch) == 1 or "beside" in str(case)
        assert np.linalg.norm(patch.points_a - answer.point_a, axis=1).max() <= 1e-2 * size
        return
    if len(found.points_a) <= 4:
        assert same_points(patch.points_a, found.points_a, 1e-9 * size)
        assert same_points(patch.points_b, found.points_b, 1e-9 * size)
        return
    assert len(patch) == 4
    share = area(patch.points_a, answer.normal) / area(found.points_a, answer.normal)
    assert 0.5 <= share <= 1.001 or "sliver" in str(case)


@pytest.mark.parametrize("name", LEVEL)
def test_a_tilted_pair_moves_its_corners_no_faster_than_itself(name):
    """All of it stays within the gap that is asked: no point comes or goes, or leaps."""
    a, b, pose = LEVEL[name]
    poses = rocking(pose, 2e-3)
    answers = ran(a, b, poses)
    patches = answers.patches(2e-2)
    assert (patches.count == (2 if name in LINES else 4)).all()
    moves = [
        np.linalg.norm(q.translation - p.translation) + np.linalg.norm(q.rotation - p.rotation)
        for p, q in pairwise(poses)
    ]
    for p, q in pairwise(patches):
        # one by one: they keep their numbers too
        assert np.linalg.norm(p.points_a - q.points_a, axis=1).max() <= 6.0 * max(moves)
        assert np.linalg.norm(p.points_b - q.points_b, axis=1).max() <= 6.0 * max(moves)


@pytest.mark.parametrize("name", ["face over a rim", "ground", "lying can", "capsules", "can"])
def test_a_corner_is_lost_only_where_it_leaves_the_region(name):
    """Of some the far side rises beyond the gap that is asked; or another makes it far larger."""
    a, b, pose = LEVEL[name]
    gap, poses = 1e-3, rocking(pose, 2e-3, 4000)
    answers = ran(a, b, poses)
    patches = answers.patches(gap)
    assert len(set(patches.count)) > 1 or name == "can"
    step = 0.5 * max(
        np.linalg.norm(q.translation - p.translation) + np.linalg.norm(q.rotation - p.rotation)
        for p, q in pairwise(poses)
    )
    lost = 0
    for k, (p, q) in enumerate(pairwise(patches)):
        away = np.linalg.norm(p.points_a[:, None] - q.points_a[None], axis=2).min(axis=1)
        for i in np.flatnonzero(away > 20.0 * step):
            y = poses[k + 1].apply(poses[k].inverse().apply(p.points_b[i]))
            wider = float((y - p.points_a[i]) @ answers.normal[k + 1]) - answers.distance[k + 1]
            if wider < gap - 4.0 * step:
                assert name == "can"
                assert area(q.points_a, answers.normal[k + 1]) > 1.2 * area(
                    np.delete(p.points_a, i, axis=0), answers.normal[k + 1]
                )
            lost += 1
    assert lost > 0


@pytest.mark.parametrize("name", LEVEL)
def test_pairs_are_on_both_boundaries_and_no_farther_apart(name, rng):
    a, b, pose = LEVEL[name]
    for tilt in (0.0, 1e-3, 0.05):
        at = pose @ so.Pose.exp(tilt * rng.normal(size=3))
        answer = so.distance(a, b, HOME, at)
        for gap in (1e-3, 0.05):
            patch = answer.patch(gap)
            assert 1 <= len(patch) <= 4
            for x, y in patch:
                wide = float((y - x) @ answer.normal) - answer.distance
                # rounded edges are apart along a line that leans
                leans = 0.06 * (a.radius + b.radius)
                assert -1e-12 - leans <= wide <= gap * (1 + 1e-9) + leans
                for body, point, place in ((a, x, HOME), (b, y, at)):
                    off = so.distance(body, s.sphere(1e-3), place, so.Pose(np.eye(3), point))
                    assert off.distance == pytest.approx(-1e-3, abs=1e-8)


@pytest.mark.parametrize("turn", [1e-4, 1e-3, 5e-3, -2e-3])
def test_capsules_that_cross_by_a_hair_have_their_ends(turn):
    """Their witness points, where they cross, run along them as they turn: no corner."""
    pose = so.Pose.exp([turn, 0, 0], [0.5, 0, 0.3])
    answer = so.distance(CAPSULE, CAPSULE, HOME, pose)
    assert str(answer.feature_a) == str(answer.feature_b) == "edge 0"
    patch = answer.patch(1e-2)
    assert sorted(patch.points_a[:, 2]) == pytest.approx([-0.2, 0.5], abs=1e-4)


def test_a_rounded_box_that_leans_over_a_corner():
    """The normal is none of the far corners': they move out along their nearest one."""
    pose = so.Pose.exp([0.03, 0.02, 0.0], [0, 0, 0.7])
    patch = so.distance(GROUND, ROUNDED, HOME, pose).patch(0.1)
    assert len(patch) == 4
    for y in patch.points_b:
        off = so.distance(ROUNDED, s.sphere(1e-3), pose, so.Pose(np.eye(3), y))
        assert off.distance == pytest.approx(-1e-3, abs=1e-9)


@pytest.mark.parametrize(
    "name", ["face over a rim", "face on face", "nut", "lying can over a rim", "cans side by side"]
)
def test_as_of_solids(name, rng):
    """Corners that solids have too, from another search; where there are at most four, all."""
    a, b, pose = LEVEL[name]
    world = random_pose(rng, 2.0)
    patch = so.distance(a, b, world, world @ pose).patch(1e-3)
    told = so.solids.distance(
        so.Solid(a), so.Solid(b), world, world @ pose, minima=0.5, patch=1e-3
    ).minima[0]
    expected = np.array([x for x, _ in told.patch])
    ends = {"lying can over a rim", "cans side by side"}
    if name == "face over a rim":
        assert same_points(patch.points_a, expected, 1e-8)
    elif name in ends:
        reach = np.linalg.norm(expected - patch.points_a[0], axis=1).max()
        assert reach == pytest.approx(np.linalg.norm(np.diff(patch.points_a, axis=0)), abs=1e-6)
    else:
        normal = told.normal
        assert area(patch.points_a, normal) >= 0.9 * area(expected, normal)


@pytest.mark.parametrize("name", LEVEL)
def test_swapped_and_moved(name, rng):
    a, b, pose = LEVEL[name]
    at = pose @ so.Pose.exp(1e-3 * rng.normal(size=3))
    patch = so.distance(a, b, HOME, at).patch(1e-2)
    other = so.distance(b, a, at, HOME).patch(1e-2)
    if name not in ("octagon", "can", "can over a rim", "can on can"):  # others do as well there
        assert same_points(patch.points_a, other.points_b, 1e-8)
        assert same_points(patch.points_b, other.points_a, 1e-8)
    assert len(patch) == len(other)
    world = random_pose(rng, 3.0)
    moved = so.distance(a, b, world, world @ at).patch(1e-2)
    assert same_points(moved.points_a, world.apply(patch.points_a), 1e-8)


def test_counterclockwise_about_the_normal(rng):
    for name in ("face on face", "octagon", "nut on nut", "can"):
        a, b, pose = LEVEL[name]
        world = random_pose(rng, 1.0)
        answer = so.distance(a, b, world, world @ pose)
        points = answer.patch(1e-2).points_a
        turns = np.cross(np.roll(points, -1, 0) - points, np.roll(points, -2, 0) - points)
        assert (turns @ answer.normal > 0.0).all()


def test_a_ball_and_a_corner_have_one_pair():
    for b, pose in (
        (s.sphere(0.3), so.Pose(np.eye(3), [0.1, 0.2, 1.0])),
        (BOX, so.Pose.exp([0.5, 0.3, 0.1], [0.1, 0.2, 2.0])),
        (s.ellipsoid(1, 0.7, 0.5), so.Pose.exp([0.5, 0.3, 0.1], [0.1, 0.2, 2.0])),
    ):
        answer = so.distance(SLAB, b, HOME, pose)
        patch = answer.patch(1e-4)
        assert len(patch) == 1
        assert patch.points_a[0] == pytest.approx(answer.point_a, abs=1e-9)
        assert patch.points_b[0] == pytest.approx(answer.point_b, abs=1e-9)


def test_a_run_is_its_steps():
    """The compiled loop, and one frame after the other with ``after``: to the last bit."""
    for name in ("octagon", "can", "capsules"):
        a, b, pose = LEVEL[name]
        answers = ran(a, b, rocking(pose, 2e-3, 60))
        patches, last = answers.patches(1e-3), None
        assert len(patches) == 60
        for answer, patch in zip(answers, patches, strict=True):
            last = answer.patch(1e-3, after=last)
            assert len(last) == len(patch)
            assert last.points_a == pytest.approx(patch.points_a, abs=1e-12)
            assert last.points_b == pytest.approx(patch.points_b, abs=1e-12)
        some = answers.patches(1e-3, after=patches[-1])
        assert len(some[0]) > 0


def test_the_frame_before_decides_between_corners_that_do_as_well():
    """Four of an octagon's eight corners: the same four stay, whichever they are."""
    a, b, pose = LEVEL["octagon"]
    answer = so.distance(a, b, HOME, pose)
    patch = answer.patch(1e-3)
    turned = so.Pose.exp([0, 0, np.pi / 4])
    others = so.tracking.Patch(
        turned.apply(patch.points_a), turned.apply(patch.points_b), patch.poses
    )
    again = answer.patch(1e-3, after=others)
    assert same_points(again.points_a, others.points_a, 1e-9)
    assert not same_points(again.points_a, patch.points_a, 0.1)


def test_what_is_refused_or_empty():
    answer = so.distance(BOX, BOX, HOME, so.Pose(np.eye(3), [0, 0, 1.5]))
    for gap in (0.0, -1e-3, np.nan):
        with pytest.raises(ValueError, match="gap"):
            answer.patch(gap)
    with pytest.raises(TypeError, match="after"):
        answer.patch(1e-3, after=answer)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="poses"):
        made_answer(BOX, BOX, [0, 0, 0.5], [0, 0, 1], 1.0).patch(1e-3)
    far = so.Pose(np.eye(3), [0, 0, 9.0])
    with pytest.raises(ValueError, match="horizon"):
        so.distance(BOX, BOX, HOME, far, within=1.0).patch(1e-3)
    tracker = so.Tracker(BOX, BOX, law=so.PredictorCorrector(within=1.0))
    near = so.Pose(np.eye(3), [0, 0, 1.5])
    _, answers = tracker.run(tracker.start(HOME, near), HOME, [near, far, near])
    patches = answers.patches(1e-3)
    assert patches.count.tolist() == [4, 0, 4]
    assert np.isnan(patches.points_a[1]).all()
    assert len(patches[1]) == 0
    assert patches.points_b[2] == pytest.approx(patches.points_b[0])


def test_many_more_corners_than_are_kept(rng):
    """A wide region of a finely faceted ball: thinned, not cut off."""
    points = rng.normal(size=(1500, 3))
    ball = s.polytope(points / np.linalg.norm(points, axis=1)[:, None])
    answer = so.distance(SLAB, ball, HOME, so.Pose(np.eye(3), [0, 0, 1.6]))
    patch = answer.patch(0.9)
    assert len(patch) == 4
    reach = np.linalg.norm(patch.points_a[:, :2], axis=1)
    assert reach.min() > 0.98
    assert area(patch.points_a, answer.normal) > 1.92
