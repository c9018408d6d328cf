"""Patches of local minima: pairs of points that span where the gap is hardly wider."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from families.solid_shapes import bolt, bracket, egg, peg, prism, ring, tube
from standoff.geometry import Line
from standoff.kernels.solids.patch import outside
from standoff.solids.of_pieces import turned as turned_round
from standoff.solids.spatial.models import as_model
from standoff.solids.spatial.points import distance_to_boundary

Array = np.ndarray
STILL = np.eye(4)
SLAB = so.shapes.box((4.0, 4.0, 1.0))
FEET = prism([(0, 0), (3, 0), (3, 1), (2, 1), (2, 0.5), (1, 0.5), (1, 1), (0, 1)], 1.0)
"""A bridge upside down: two feet at y = 1, each 1 by 1."""


def placed(turn: Array, shift: Array) -> Array:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, shift
    return matrix


def turned(axis: str, angle: float) -> Array:
    return Rotation.from_euler(axis, angle).as_matrix()


def corners(patch: tuple) -> Array:
    """Points of A, sorted."""
    points = np.array([x for x, _ in patch])
    return points[np.lexsort(np.round(points, 6).T[::-1] + 0.0)]


def asked(a, b, pose: Array, minima: float = 0.5, patch: float = 1e-3):
    solids = so.Solid(a) if isinstance(a, so.Body) else a, b
    return so.solids.distance(*solids, STILL, pose, minima=minima, patch=patch)


def test_a_box_on_a_slab_and_over_its_rim() -> None:
    box = so.shapes.box((1.0, 1.0, 1.0))
    level = asked(SLAB, box, placed(turned("z", 0.3), [0.2, 0.1, 1.1])).minima
    assert len(level) == 1
    expected = np.array([[x, y, 0.0] for x in (-0.5, 0.5) for y in (-0.5, 0.5)])
    expected = expected @ turned("z", 0.3).T + [0.2, 0.1, 0.5]
    assert corners(level[0].patch) == pytest.approx(corners([(x, x) for x in expected]), abs=1e-9)
    over = asked(SLAB, box, placed(np.eye(3), [1.8, 0.0, 1.1])).minima
    rim = np.array([[1.3, -0.5, 0.5], [1.3, 0.5, 0.5], [2.0, -0.5, 0.5], [2.0, 0.5, 0.5]])
    assert corners(over[0].patch) == pytest.approx(rim, abs=1e-9)


@pytest.mark.parametrize(("tilt", "count"), [(0.0, 4), (5e-4, 4), (5e-3, 2)])
def test_a_tilt_leaves_an_edge(tilt: float, count: int) -> None:
    """While the far edge is no higher than what is asked, the patch is the face."""
    box = so.shapes.box((1.0, 1.0, 1.0))
    pair = asked(SLAB, box, placed(turned("x", tilt), [0.2, 0.1, 1.1])).minima[0]
    assert len(pair.patch) == count
    assert np.ptp([y[0] for _, y in pair.patch]) == pytest.approx(1.0)
    # counterclockwise about the normal
    points = np.array([x for x, _ in pair.patch])
    turns = np.cross(np.roll(points, -1, 0) - points, np.roll(points, -2, 0) - points)
    assert count == 2 or (turns @ pair.normal > 0.0).all()


def test_a_lying_peg_has_two_ends_and_a_standing_one_a_rim() -> None:
    pin = peg(0.3, -1.0, 1.0)
    lying = asked(SLAB, pin, placed(turned("y", np.pi / 2), [0.1, 0.2, 0.9])).minima[0]
    ends = corners(lying.patch)
    assert ends[[0, -1]] == pytest.approx(np.array([[-0.9, 0.2, 0.5], [1.1, 0.2, 0.5]]), abs=1e-7)
    assert ends[:, 1] == pytest.approx(np.full(len(ends), 0.2), abs=1e-7)
    standing = asked(SLAB, pin, placed(np.eye(3), [0.1, 0.2, 1.6])).minima[0]
    points = corners(standing.patch) - np.array([0.1, 0.2, 0.5])
    assert len(points) in (3, 4)
    assert np.linalg.norm(points, axis=1).max() == pytest.approx(0.3, abs=1e-9)
    # the middle is over the patch
    assert np.abs(points.mean(axis=0)).max() < 0.15


def test_each_foot_has_its_own() -> None:
    slab = placed(turned("x", np.pi / 2), [1.5, 1.6, 0.5])
    answer = asked(FEET, SLAB, slab)
    assert len(answer.minima) == 2
    for each, left in zip(sorted(answer.minima, key=lambda m: m.point_a[0]), (0, 2), strict=True):
        expected = [[x, 1.0, z] for x in (left, left + 1.0) for z in (0.0, 1.0)]
        assert corners(each.patch) == pytest.approx(np.array(expected), abs=1e-9)


SHAPES = [
    bracket,
    bolt,
    partial(egg, 0.9, 0.6, 0.4),
    lambda: FEET,
    partial(peg, 0.4, -1.0, 1.0),
    partial(ring, 1.0, 0.25),
    partial(tube, 0.5, 0.8, 0.0, 0.6),
]


@pytest.mark.parametrize("seed", range(6))
def test_pairs_of_a_patch_are_on_both_and_hardly_farther_apart(seed: int) -> None:
    rng = np.random.default_rng(seed)
    several = 0
    for _ in range(12):
        a, b = (SHAPES[k]() for k in rng.integers(len(SHAPES), size=2))
        way = rng.normal(size=3)
        turn = turned("xyz", rng.choice([0.0, 1e-3, 1.0]) * rng.normal(size=3))
        pose = placed(turn, 0.5 * (a.size + b.size) * way / np.linalg.norm(way))
        least = so.solids.distance(a, b, STILL, pose).distance
        if least <= 0.0:
            continue
        wider = rng.choice([1e-4, 1e-2, 0.1])
        found = asked(a, b, pose, least + 0.2, wider)
        plain = so.solids.distance(a, b, STILL, pose, minima=least + 0.2)
        told = [m.distance for m in found.minima]
        assert told == pytest.approx([m.distance for m in plain.minima], abs=1e-9)
        for each in found.minima:
            assert 1 <= len(each.patch) <= 4
            several += len(each.patch) > 1
            for x, y in each.patch:
                assert each.distance - 1e-9 <= np.linalg.norm(y - x) <= each.distance + wider
                own = (y - pose[:3, 3]) @ pose[:3, :3]
                assert distance_to_boundary(as_model(a), x).upper < 1e-9
                assert distance_to_boundary(as_model(b), own).upper < 1e-9
    assert several > 0


def test_a_tracker_tells_them_and_a_swap_swaps_them() -> None:
    box, slab = so.Solid(so.shapes.box((1.0, 1.0, 1.0))), so.Solid(SLAB)
    tracker = so.Tracker(slab, box, minima=0.5, patch=1e-3)
    poses = np.array([placed(turned("y", 1e-5 * k), [0.01 * k, 0.1, 1.1]) for k in range(-9, 10)])
    _, answers = tracker.run(tracker.start(STILL, poses[0]), STILL, poses)
    assert not answers.restarts.any()
    for k, answer in enumerate(answers):
        points = corners(answer.minima[0].patch)
        at = 0.01 * (k - 9)
        expected = np.array([[at + x, y, 0.5] for x in (-0.5, 0.5) for y in (-0.4, 0.6)])
        assert points == pytest.approx(expected, abs=1e-3)
    other = so.solids.distance(box, slab, poses[0], STILL, minima=0.5, patch=1e-3).minima[0]
    swapped = corners([(y, x) for x, y in other.patch])
    assert swapped == pytest.approx(corners(answers[0].minima[0].patch), abs=1e-9)
    assert tracker.minima == 0.5
    assert tracker.patch == 1e-3


def test_a_patch_may_reach_beyond_the_minima() -> None:
    """A box whose far edge is higher than the length below which minima are told."""
    box, slab = so.Solid(so.shapes.box((1.0, 1.0, 1.0))), so.Solid(SLAB)
    pose = placed(turned("x", 8e-4), [0.2, 0.1, 1.1 + 4e-4])
    tracker = so.Tracker(slab, box, minima=0.1005, patch=1e-3)
    state = tracker.start(STILL, pose)
    for answer in (state.proximity, tracker.step(state, STILL, pose)[1]):
        assert [m.distance for m in answer.minima] == pytest.approx([0.1], abs=1e-6)
        gaps = [float(np.linalg.norm(y - x)) for x, y in answer.minima[0].patch]
        assert sorted(gaps) == pytest.approx([0.1, 0.1, 0.1008, 0.1008], abs=1e-6)


def test_what_is_told_of_minima_does_not_reach_so_far() -> None:
    ball = so.shapes.sphere(0.3)
    pose = placed(np.eye(3), [1.08, 1.5, 0.5])
    found = so.solids.distance(FEET, ball, STILL, pose, minima=0.65, patch=0.2)
    assert len(found.minima) == 1
    assert len(so.solids.distance(FEET, ball, STILL, pose, minima=0.75).minima) == 3


def test_what_is_outside_of_a_point_a_line_and_a_polygon() -> None:
    square = [0.0, 0.0, 7.0, 1.0, 0.0, 7.0, 1.0, 1.0, 7.0, 0.0, 1.0, 7.0]
    spots = [(-1.0, 0.0), (2.0, 0.0), (0.5, 0.2), (0.5, -0.3)]
    expected = {1: [1.0, 2.0, 0.29**0.5, 0.34**0.5], 2: [1.0, 1.0, 0.2, 0.3], 4: [1, 1, -0.2, 0.3]}
    for n, far in expected.items():
        assert [outside.py_func(square, n, x, y) for x, y in spots] == pytest.approx(far)


def test_an_answer_that_is_turned_turns_its_patches() -> None:
    box = so.shapes.box((1.0, 1.0, 1.0))
    found = asked(SLAB, box, placed(np.eye(3), [1.8, 0.0, 1.1]))
    for (x, y), (other_y, other_x) in zip(
        found.minima[0].patch, turned_round(found).minima[0].patch, strict=True
    ):
        assert np.array_equal(x, other_x)
        assert np.array_equal(y, other_y)


def test_what_is_asked_of_patches_is_checked() -> None:
    a, b = so.Solid(SLAB), bracket()
    with pytest.raises(so.StandoffError, match="minima"):
        so.solids.distance(a, b, STILL, STILL, patch=0.1)
    with pytest.raises(so.StandoffError, match="minima"):
        so.Tracker(a, b, patch=0.1)
    for wrong in (0.0, -1.0, np.inf):
        with pytest.raises(so.StandoffError, match="patch"):
            so.solids.distance(a, b, STILL, STILL, minima=1.0, patch=wrong)
    flat = so.shapes.planar_loop([Line((0, 0, 0), (1, 0, 0)), Line((1, 0, 0), (0, 1, 0)),
                                  Line((0, 1, 0), (0, 0, 0))])  # fmt: skip
    away = placed(np.eye(3), [3.0, 0.0, 0.0])
    with pytest.raises(so.StandoffError, match="space"):
        so.solids.distance(flat, flat, STILL, away, minima=1.0, patch=0.1)
