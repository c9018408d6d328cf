"""What may be asked of solids in space: a tolerance, all local minima, a deadline; and what is told
of all places of contact and of what stays open."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

import standoff as so
from families.solid_shapes import ball, bolt, bracket, peg, prism, samples, tube
from standoff.solids import Solid, SolidProximity, distance
from standoff.solids.spatial import distance as spatial_distance_module
from standoff.tracking.derivatives import Smoothness
from standoff.tracking.status import Status

STILL = so.Pose.identity()
STRAIGHT = np.eye(3)


def comb(depths: tuple[float, ...]):
    """Teeth of half the pitch, whose tips are at the heights `depths`."""
    outline = []
    for k, depth in enumerate(depths):
        outline += [(k, depth), (k + 0.4, depth)]
        if k < len(depths) - 1:
            outline += [(k + 0.4, 0.7), (k + 1.0, 0.7)]
    n = len(depths) - 1
    return prism([*outline, (n + 0.4, 1.0), (0.0, 1.0)], 0.5)


@cache
def slab() -> Solid:
    return prism([(-2.0, -1.0), (5.0, -1.0), (5.0, -0.1), (-2.0, -0.1)], 3.0)


@cache
def slot() -> Solid:
    return prism([(-1, -1), (3, -1), (3, 2), (2, 2), (2, 0), (0, 0), (0, 2), (-1, 2)], 3.0)


@cache
def groove() -> Solid:
    return prism([(-2, -1), (2, -1), (2, 1), (1, 1), (0, 0), (-1, 1), (-2, 1)], 3.0)


@cache
def wedge() -> Solid:
    return prism([(0, 0), (0.8, 0.8), (0.8, 1.8), (-0.8, 1.8), (-0.8, 0.8)], 1.0)


def well_made(answer: SolidProximity, tolerance: float) -> None:
    """Each minimum is what its fields say, and proven to the tolerance."""
    told = [each.distance for each in answer.minima]
    assert told == sorted(told)
    assert answer.minima[0].distance == answer.distance
    for each in answer.minima:
        away = each.point_b - each.point_a
        assert np.linalg.norm(away) == pytest.approx(each.distance, abs=1e-13)
        np.testing.assert_allclose(away, each.distance * each.normal, atol=1e-9)
        proven = each.distance - each.lower_bound
        assert 0.5 * tolerance <= proven <= 1.01 * tolerance


def test_a_comb_over_a_plane_has_a_minimum_for_each_tooth() -> None:
    teeth = comb((0.0, 0.05, 0.02))
    answer = distance(slab(), teeth, STILL, so.Pose(STRAIGHT, (0, 0, 1.2)), minima=0.3)
    found = [each.distance for each in answer.minima]
    np.testing.assert_allclose(found, [0.1, 0.12, 0.15], atol=1e-12)
    well_made(answer, 1e-10 * (slab().size + teeth.size))
    for each in answer.minima:
        np.testing.assert_allclose(each.normal, [0, 1, 0], atol=1e-9)
    tooth = np.floor([m.point_b[0] for m in answer.minima])
    np.testing.assert_array_equal(tooth, [0, 2, 1])
    fewer = distance(slab(), teeth, STILL, so.Pose(STRAIGHT, (0, 0, 1.2)), minima=0.13)
    assert [m.distance for m in fewer.minima] == pytest.approx([0.1, 0.12], abs=1e-12)


def test_a_ball_in_a_slot_has_a_minimum_at_each_wall() -> None:
    pose = so.Pose(STRAIGHT, (0.9, 0.8, 1.5))
    answer = distance(slot(), ball(0.4), STILL, pose, minima=0.9)
    well_made(answer, 1e-10 * (slot().size + ball(0.4).size))
    assert [m.distance for m in answer.minima] == pytest.approx([0.4, 0.5, 0.7], abs=1e-12)
    assert {m.feature_a.kind for m in answer.minima} == {"face"}
    feet = [m.point_a for m in answer.minima]
    np.testing.assert_allclose(feet, [[0.9, 0, 1.5], [0, 0.8, 1.5], [2, 0.8, 1.5]], atol=1e-7)
    assert answer.status is Status.CONVERGED
    assert answer.smoothness is Smoothness.SMOOTH


def settled(at: tuple[int, int], sides, reach: float) -> tuple[int, int]:
    """From a pair of samples to one that no pair of their neighbours is nearer than."""
    (a, tree_a), (b, tree_b) = sides
    i, j = at
    while True:
        near_a = np.array(tree_a.query_ball_point(a[i], reach))
        near_b = np.array(tree_b.query_ball_point(b[j], reach))
        away = np.linalg.norm(a[near_a][:, None] - b[near_b][None], axis=2)
        k, m = np.unravel_index(away.argmin(), away.shape)
        if (near_a[k], near_b[m]) == (i, j):
            return i, j
        i, j = int(near_a[k]), int(near_b[m])


@pytest.mark.parametrize("seed", range(2))
def test_local_minima_are_those_of_dense_samples(seed: int) -> None:
    """Descents over samples from many starts end where the library has a minimum, and those from
    its minima stay there."""
    rng = np.random.default_rng(seed)
    a, b = bracket(), comb((0.0, 0.3))
    turn = Rotation.from_quat(rng.normal(size=4)).as_matrix()
    way = rng.normal(size=3)
    move = np.array([0.7, 0.7, 0.35]) + 2.2 * way / np.linalg.norm(way)
    above = 1.8
    answer = distance(a, b, STILL, so.Pose(turn, move), minima=above)
    well_made(answer, 1e-10 * (a.size + b.size))
    spots = samples(a, 36), samples(b, 36) @ turn.T + move
    sides = [(each, cKDTree(each)) for each in spots]
    reach = 0.15
    starts = [tuple(rng.integers([len(s) for s in spots])) for _ in range(60)]
    ends = {settled(start, sides, reach) for start in starts}
    known = [(m.point_a, m.point_b) for m in answer.minima]
    for i, j in ends:
        x, y = spots[0][i], spots[1][j]
        if np.linalg.norm(y - x) < above - 0.05:
            away = [max(np.linalg.norm(x - p), np.linalg.norm(y - q)) for p, q in known]
            assert min(away) < 2.0 * reach
    for p, q in known:
        start = int(sides[0][1].query(p)[1]), int(sides[1][1].query(q)[1])
        i, j = settled(start, sides, reach)
        assert np.linalg.norm(spots[0][i] - p) < reach
        assert np.linalg.norm(spots[1][j] - q) < reach


def test_local_minima_of_turned_parts_are_proven() -> None:
    """Faces that trimming curves cut, with minima at their rims and within them."""
    turn = Rotation.from_euler("xyz", [0.4, -0.3, 0.8]).as_matrix()
    a, b, at = bolt(), tube(0.5, 0.8, -0.6, 0.6), so.Pose(turn, (3.2, 0.4, 2.6))
    answer = distance(a, b, STILL, at, minima=1.5)
    assert answer.status is Status.CONVERGED
    well_made(answer, 1e-10 * (a.size + b.size))
    assert len(answer.minima) > 1


@pytest.mark.parametrize("tolerance", [1e-2, 1e-6, 1e-12])
def test_a_tolerance_is_what_the_distance_is_proven_to(tolerance: float) -> None:
    a, b = slot(), ball(0.4)
    pose = so.Pose(STRAIGHT, (0.9, 0.8, 1.5))
    usual = distance(a, b, STILL, pose)
    answer = distance(a, b, STILL, pose, tolerance=tolerance)
    assert answer.status is Status.CONVERGED
    width = answer.upper_bound - answer.lower_bound
    assert 0.5 * tolerance < width <= 1.01 * tolerance
    assert answer.lower_bound <= usual.upper_bound
    assert usual.lower_bound <= answer.upper_bound
    if tolerance > 1e-5:
        assert answer.counts.evaluations < usual.counts.evaluations


def inside_box(corners: np.ndarray, point: np.ndarray) -> bool:
    """Is a point in a box, given by its corners?"""
    middle = corners.mean(axis=0)
    ways = corners[[4, 2, 1]] - corners[0]
    along = np.einsum("ij,ij->i", ways, ways)
    held = np.abs(ways @ (point - middle)) <= 0.5 * along + 1e-9 * np.sqrt(along)
    return bool(held.all())


@pytest.mark.parametrize("deadline", [1, 3000])
def test_a_deadline_leaves_open_what_holds_the_nearest_pair(deadline: int) -> None:
    hole = so.Pose(Rotation.from_euler("x", 1e-5).as_matrix(), (1e-6, 0, 0))
    a, b = tube(0.05, 0.1, -0.5, 0.5), peg(0.04999, -0.6, 0.6)
    whole = distance(a, b, STILL, hole)
    assert whole.open == ()
    assert whole.counts.open == 0
    answer = distance(a, b, STILL, hole, deadline=deadline)
    assert answer.status is Status.DEADLINE
    assert answer.lower_bound <= whole.distance <= answer.upper_bound + 1e-15
    assert answer.counts.evaluations <= 2.0 * deadline + 20_000
    assert 0 < len(answer.open) <= 64
    assert answer.counts.open >= len(answer.open)
    bounds = [each.lower_bound for each in answer.open]
    assert bounds == sorted(bounds)


def test_what_is_open_says_what_is_proven() -> None:
    at = so.Pose(STRAIGHT, (0.9, 0.8, 1.5))
    answer = distance(slot(), ball(0.4), STILL, at, deadline=100)
    assert answer.status is Status.DEADLINE
    assert answer.counts.open == len(answer.open) > 0
    assert all(each.corners_a.shape == each.corners_b.shape == (8, 3) for each in answer.open)
    if np.isfinite(answer.lower_bound):
        assert answer.open[0].lower_bound == answer.lower_bound
    for each in answer.open:
        spread = np.linalg.norm(each.corners_b - [0.9, 0.8, 1.5], axis=1)
        assert spread.max() >= 0.4 - 1e-9  # a box round a part of a sphere reaches beyond it


def test_the_deadline_is_the_same_in_the_plane() -> None:
    disc = so.PlanarSolid.from_loops([so.geometry.ConicArc((0, 0), (1, 0), (0, 1))])
    curve = so.geometry.RationalBezier([[0, 2, 0], [1, 0.4, 0], [2, 2, 0]])
    lens = so.PlanarSolid.from_loops([curve, so.geometry.Line((2, 2, 0), (0, 2, 0))])
    whole = distance(lens, disc, STILL, STILL)
    answer = distance(lens, disc, STILL, STILL, deadline=1)
    assert answer.status is Status.DEADLINE
    assert answer.counts.evaluations < whole.counts.evaluations
    assert answer.counts.open == len(answer.open) > 0
    assert all(each.corners_a.shape == (4, 3) for each in answer.open)
    assert whole.status is Status.CONVERGED
    assert whole.open == ()


def test_a_wedge_in_a_groove_touches_both_flanks() -> None:
    answer = distance(groove(), wedge(), STILL, so.Pose(STRAIGHT, (0, 0, 1)))
    assert answer.status is Status.TOUCHING
    assert answer.lower_bound > -1e-8
    assert abs(answer.distance) < 1e-12
    flanks = {tuple(np.round(m.normal, 6)) for m in answer.minima if m.feature_a.kind == "face"}
    h = round(np.sqrt(0.5), 6)
    assert {(h, h, 0.0), (-h, h, 0.0)} <= flanks
    lifted = distance(groove(), wedge(), STILL, so.Pose(STRAIGHT, (0, 1e-3, 1)))
    assert lifted.status is Status.CONTINUUM
    assert lifted.distance == pytest.approx(1e-3 * np.sqrt(0.5), abs=1e-12)
    sunk = distance(groove(), wedge(), STILL, so.Pose(STRAIGHT, (0, -1e-2, 1)))
    assert sunk.status is Status.OVERLAPPING


def test_a_ball_in_a_groove_touches_at_two_points() -> None:
    turn = Rotation.from_euler("xyz", [0.3, -0.8, 1.1]).as_matrix()
    centre = turn @ [0.0, 0.5 * np.sqrt(2.0), 1.0]
    answer = distance(groove(), ball(0.5), so.Pose(turn, (0, 0, 0)), so.Pose(STRAIGHT, centre))
    assert answer.status is Status.TOUCHING
    assert len(answer.minima) == 2
    assert answer.smoothness is Smoothness.ONE_SIDED
    normals = np.array([m.normal for m in answer.minima]) @ turn
    np.testing.assert_allclose(normals[:, 1], np.sqrt(0.5), atol=1e-6)
    assert abs(normals[:, 0].sum()) < 1e-6


def test_what_touches_all_round_is_not_parted(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is open where nothing else proves that it touches."""
    monkeypatch.setattr(spatial_distance_module, "depth_bound", lambda pair, tolerance: np.inf)
    answer = distance(tube(0.5, 0.8, -0.6, 0.6), peg(0.5, -0.7, 0.7), STILL, STILL)
    assert answer.status is Status.WITHIN
    assert answer.lower_bound == -np.inf
    assert answer.open
