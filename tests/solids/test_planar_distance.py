"""The distance of two planar solids: against dense samples, closed forms, and itself."""

from __future__ import annotations

import numpy as np
import pytest
from planar_drawn import between_samples, moved, planar_pose, samples, star

import standoff as so
from standoff.geometry import ConicArc, Curve, Line
from standoff.solids import distance
from standoff.tracking.derivatives import Smoothness

HOME = planar_pose(0.0, 0.0)


def polygon(*points: tuple[float, float]) -> list[Curve]:
    return [Line(p, q) for p, q in zip(points, (*points[1:], points[0]), strict=True)]


def circle(x: float, y: float, r: float) -> list[Curve]:
    return [ConicArc((x, y), (r, 0.0), (0.0, r))]


def slot(width: float, length: float) -> list[Curve]:
    """A stadium round the origin, along x."""
    r, x = 0.5 * width, 0.5 * (length - width)
    axes = (r, 0.0), (0.0, r)
    return [
        Line((-x, -r), (x, -r)),
        ConicArc((x, 0.0), *axes, -0.5 * np.pi, 0.5 * np.pi),
        Line((x, r), (-x, r)),
        ConicArc((-x, 0.0), *axes, 0.5 * np.pi, 1.5 * np.pi),
    ]


def plate(*holes: list[Curve]) -> so.PlanarSolid:
    square = polygon((-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-3.0, 3.0))
    return so.PlanarSolid.from_loops(square, holes)


NOTCHED = so.PlanarSolid.from_loops(polygon((0, 0), (4, 0), (4, 3), (2, 1), (0, 3)))
DISC = so.PlanarSolid.from_loops(circle(0.0, 0.0, 1.0))


@pytest.mark.parametrize(
    ("at", "expected", "ties"),
    [
        ((6.0, 1.0), 1.0, 1),
        ((2.0, 4.0), 1.5 * np.sqrt(2.0) - 1.0, 2),
        ((-3.0, 4.0), np.sqrt(10.0) - 1.0, 1),
        ((2.0, 1.0 + np.sqrt(2.0) + 1e-6), 1e-6 / np.sqrt(2.0), 2),
    ],
)
def test_a_disc_before_a_notch(at: tuple[float, float], expected: float, ties: int) -> None:
    answer = distance(NOTCHED, DISC, HOME, planar_pose(*at))
    assert answer.status is so.Status.CONVERGED
    assert answer.distance == pytest.approx(expected, abs=1e-13)
    assert expected - 1e-9 <= answer.lower_bound <= expected
    assert len(answer.minima) == ties
    assert answer.smoothness is (Smoothness.SMOOTH if ties == 1 else Smoothness.ONE_SIDED)


def test_one_call_for_all_kinds_of_bodies() -> None:
    body = so.shapes.planar_loop(polygon((0, 0), (1, 0), (1, 1), (0, 1)))
    answer = so.distance(body, DISC, planar_pose(3.0, -0.5), HOME)
    assert answer.distance == pytest.approx(2.0, abs=1e-14)
    assert str(answer.feature_b) == "edge 0"
    far = so.distance(NOTCHED, DISC, HOME, planar_pose(20.0, 0.0), within=1.0)
    assert far.status is so.Status.FAR
    assert 1.0 < far.lower_bound <= 15.0


def drawn(rng: np.random.Generator, most: int = 40) -> so.PlanarSolid:
    return so.PlanarSolid.from_loops(star(rng, int(rng.integers(5, most)), "labn"))


def far_and_near(rng: np.random.Generator) -> tuple[so.Pose, so.Pose]:
    r, angle = rng.uniform(0.2, 2.6), rng.uniform(0.0, 7.0)
    b = planar_pose(r * np.cos(angle), r * np.sin(angle), rng.uniform(0.0, 7.0))
    return planar_pose(0.0, 0.0, rng.uniform(0.0, 7.0)), b


def check_against_samples(rng: np.random.Generator, pairs: int, poses: int) -> None:
    for _ in range(pairs):
        a, b = drawn(rng), drawn(rng)
        (points_a, reach_a), (points_b, reach_b) = samples(a), samples(b)
        for _ in range(poses):
            at = far_and_near(rng)
            answer = distance(a, b, *at)
            seen = between_samples(moved(points_a, at[0]), moved(points_b, at[1]))
            reach = reach_a + reach_b
            assert answer.status in (so.Status.CONVERGED, so.Status.OVERLAPPING)
            if answer.status is so.Status.CONVERGED:
                assert answer.distance - 1e-12 <= seen
                assert answer.lower_bound >= seen - reach
                apart = np.linalg.norm(answer.point_b - answer.point_a)
                assert apart == pytest.approx(answer.distance, abs=1e-9)
            else:
                ball = answer.overlap
                assert ball is not None
                assert seen <= reach
                for points in (moved(points_a, at[0]), moved(points_b, at[1])):
                    off = np.linalg.norm(points - ball.common_point[:2], axis=1)
                    assert off.min() >= ball.radius - 1e-12


def test_drawn_pairs_against_dense_samples(rng: np.random.Generator) -> None:
    check_against_samples(rng, 4, 8)


@pytest.mark.soak
def test_many_drawn_pairs_against_dense_samples(rng: np.random.Generator) -> None:
    check_against_samples(rng, 60, 40)


def test_swapped_and_moved_together(rng: np.random.Generator) -> None:
    a, b = drawn(rng), drawn(rng)
    pose_a, pose_b = planar_pose(0.0, 0.0, 0.4), planar_pose(2.6, 0.3, 1.0)
    answer, swapped = distance(a, b, pose_a, pose_b), distance(b, a, pose_b, pose_a)
    assert answer.distance == pytest.approx(swapped.distance, abs=1e-14)
    assert answer.point_a == pytest.approx(swapped.point_b, abs=1e-7)
    assert answer.gradient[:6] == pytest.approx(swapped.gradient[6:], abs=1e-7)
    move = planar_pose(5.0, -2.0, 2.2)
    there = distance(a, b, move @ pose_a, move @ pose_b)
    assert there.distance == pytest.approx(answer.distance, abs=1e-13)
    assert there.point_a == pytest.approx(move.apply(answer.point_a), abs=1e-7)


def test_gradient_by_differences() -> None:
    a = plate()
    pose_b = planar_pose(4.9, 1.1, 0.3)
    answer = distance(a, NOTCHED, HOME, pose_b)
    h = 1e-6
    for k, step in enumerate((planar_pose(h, 0), planar_pose(0, h))):
        moved_b = step @ pose_b
        change = distance(a, NOTCHED, HOME, moved_b).distance - answer.distance
        assert answer.gradient[6 + k] == pytest.approx(change / h, abs=1e-5)
    turned = planar_pose(4.9, 1.1, 0.3 + h)
    change = distance(a, NOTCHED, HOME, turned).distance - answer.distance
    assert answer.gradient[11] == pytest.approx(change / h, abs=1e-5)
    assert answer.gradient[[2, 3, 4, 8, 9, 10]] == pytest.approx(np.zeros(6))


def test_a_pin_in_a_slot() -> None:
    solid = plate(slot(1.0, 3.0))
    pin = so.PlanarSolid.from_loops(circle(0.0, 0.0, 0.49))
    answer = distance(solid, pin, HOME, planar_pose(0.2, 0.0))
    assert answer.status is so.Status.CONVERGED
    assert answer.distance == pytest.approx(0.01, abs=1e-14)
    assert len(answer.minima) == 2
    answer = distance(solid, pin, HOME, planar_pose(1.0, 0.0))
    assert answer.status is so.Status.CONTINUUM  # the pin in the round end
    assert answer.distance == pytest.approx(0.01, abs=1e-14)
    assert answer.continuum is not None
    assert answer.continuum.kind == "arc"
    ends = sorted(float(p[1]) for p, _ in answer.continuum.ends)
    assert ends == pytest.approx([-0.5, 0.5], abs=1e-8)
    assert answer.smoothness is Smoothness.PARTIAL
    with pytest.raises(so.StandoffError, match="no gradient"):
        _ = answer.gradient


def test_a_bearing_is_one_closed_continuum() -> None:
    ring, pin = plate(circle(0.0, 0.0, 1.0)), so.PlanarSolid.from_loops(circle(0.0, 0.0, 0.9))
    for off in (0.0, 1e-12):
        answer = distance(ring, pin, HOME, planar_pose(off, 0.0))
        assert answer.status is so.Status.CONTINUUM
        assert answer.continuum is not None
        assert answer.continuum.ends == ()
        assert answer.distance == pytest.approx(0.1 - off, abs=1e-14)
    for off in (1e-9, 1e-6, 1e-3):
        answer = distance(ring, pin, HOME, planar_pose(off, 0.0))
        assert answer.status in (so.Status.CONVERGED, so.Status.CONTINUUM)
        assert answer.distance == pytest.approx(0.1 - off, abs=1e-13)


def test_parallel_sides_are_a_line() -> None:
    a, b = plate(), so.PlanarSolid.from_loops(polygon((0, 0), (1, 0), (1, 1), (0, 1)))
    answer = distance(a, b, HOME, planar_pose(3.5, 2.5))
    assert answer.status is so.Status.CONTINUUM
    assert answer.distance == pytest.approx(0.5, abs=1e-15)
    assert answer.continuum is not None
    ends = sorted(float(p[1]) for p, _ in answer.continuum.ends)
    assert ends == pytest.approx([2.5, 3.0])
    tilted = distance(a, b, HOME, planar_pose(3.5, 2.5, -1e-3))
    assert tilted.status is so.Status.CONVERGED


def test_one_inside_the_other() -> None:
    answer = distance(plate(), DISC, HOME, planar_pose(0.5, 0.0))
    assert answer.status is so.Status.CONTAINED
    assert answer.inside == "B"
    assert answer.distance == pytest.approx(1.5, abs=1e-14)
    assert answer.lower_bound == pytest.approx(1.5, abs=1e-9)
    swapped = distance(DISC, plate(), planar_pose(0.5, 0.0), HOME)
    assert swapped.inside == "A"
    hidden = distance(plate(circle(0.0, 0.0, 0.5)), DISC, HOME, HOME)
    assert hidden.status is so.Status.OVERLAPPING  # the disc covers the hole
    assert hidden.overlap is not None
    assert hidden.overlap.radius == pytest.approx(0.25, rel=0.03)


def test_touching_at_two_places() -> None:
    answer = distance(NOTCHED, DISC, HOME, planar_pose(2.0, 1.0 + np.sqrt(2.0)))
    assert answer.status is so.Status.TOUCHING
    assert answer.distance <= 1e-14
    assert len(answer.minima) == 2


@pytest.mark.parametrize("depth", [1e-1, 1e-3, 1e-6, 1e-8])
def test_shallow_overlap_of_two_discs(depth: float) -> None:
    answer = distance(DISC, DISC, HOME, planar_pose(2.0 - depth, 0.0))
    assert answer.status is so.Status.OVERLAPPING
    assert 0.8 * depth <= answer.depth <= depth


def test_all_local_minima(rng: np.random.Generator) -> None:
    comb = so.PlanarSolid.from_loops(
        polygon((0, 0), (5, 0), (5, 2), (4, 2), (4, 1), (3, 1), (3, 2.1), (2, 2.1), (2, 1), (0, 1))
    )
    pin = so.PlanarSolid.from_loops(circle(0.0, 0.0, 0.2))
    answer = distance(comb, pin, HOME, planar_pose(3.45, 1.5), minima=0.5)
    found = sorted(round(m.distance, 12) for m in answer.minima)
    assert found == pytest.approx([0.25, 0.3, 0.35])
    assert all(m.distance - 1e-9 <= m.lower_bound <= m.distance for m in answer.minima)


def test_a_budget_ends_with_a_proven_interval() -> None:
    rng = np.random.default_rng(5)
    a, b = drawn(rng), drawn(rng)
    full = distance(a, b, HOME, planar_pose(2.3, 0.0))
    short = distance(a, b, HOME, planar_pose(2.3, 0.0), deadline=1)
    assert short.status is so.Status.DEADLINE
    assert short.lower_bound <= full.distance <= short.upper_bound
    # boundaries that may still meet: no bound is claimed that an overlap would break
    deep = distance(a, b, HOME, planar_pose(1.6, 0.0), deadline=200)
    assert deep.status in (so.Status.DEADLINE, so.Status.OVERLAPPING)
    if deep.status is so.Status.DEADLINE:
        assert deep.lower_bound <= distance(a, b, HOME, planar_pose(1.6, 0.0)).distance
