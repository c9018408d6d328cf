"""Distances of solids in space with a closed form, proven; and statuses that say what was found."""

from __future__ import annotations

import numpy as np
import pytest

from families.solid_shapes import BRACKET, ball, bolt, bracket, peg, ring, socket, tube
from standoff.solids import Solid
from standoff.solids.asked import QueryOptions
from standoff.solids.spatial.distance import spatial_distance
from standoff.tracking.derivatives import Smoothness
from standoff.tracking.status import Status

STRAIGHT = np.eye(3)
HOLE, PEG = tube(0.05, 0.1, -0.5, 0.5), peg(0.04999, -0.6, 0.6)
CLEARANCE = 1e-5


def about_x(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def checked(answer, truth: float, exact: float = 1e-12) -> None:
    """The answer's points are at its distance, and the truth is in its interval."""
    apart = np.linalg.norm(answer.point_b - answer.point_a)
    assert abs(apart - answer.distance) < 1e-14
    assert answer.lower_bound - 1e-15 <= truth <= answer.upper_bound + exact
    assert abs(answer.distance - truth) < exact
    assert answer.certified


def test_a_peg_in_its_hole() -> None:
    answer = spatial_distance(HOLE, PEG)
    assert answer.status is Status.CONTINUUM
    checked(answer, CLEARANCE)
    assert answer.smoothness is Smoothness.PARTIAL


@pytest.mark.parametrize("offset", [1e-12, 3e-6, 9e-6])
def test_a_peg_beside_the_axis_of_its_hole_is_nearest_along_a_line(offset: float) -> None:
    answer = spatial_distance(HOLE, PEG, None, (STRAIGHT, (offset, 0, 0)))
    checked(answer, CLEARANCE - offset)
    if offset > 1e-9:
        assert answer.status is Status.CONTINUUM
        assert answer.continuum.kind == "line"
        ends = sorted(a[2] for a, _ in answer.continuum.ends)
        np.testing.assert_allclose(ends, [-0.5, 0.5], atol=1e-9)


@pytest.mark.parametrize("tilt", [1e-6, 1.9e-5])
def test_a_tilted_peg_is_nearest_at_two_places(tilt: float) -> None:
    answer = spatial_distance(HOLE, PEG, None, (about_x(tilt), (0, 0, 0)))
    # the rim of the hole at z = 1/2, in the peg's frame
    truth = 0.04999 * -1.0 + 0.05 * np.cos(tilt) - 0.5 * np.sin(tilt)
    checked(answer, truth)
    assert answer.status is Status.CONVERGED
    assert len(answer.minima) == 2
    heights = sorted(m.point_a[2] for m in answer.minima)
    np.testing.assert_allclose(heights, [-0.5, 0.5], atol=1e-6)
    assert answer.smoothness is Smoothness.ONE_SIDED


def test_a_ball_in_a_socket() -> None:
    shell, inner = socket(1.01, 1.5), ball(1.0)
    within = spatial_distance(shell, inner)
    checked(within, 0.01)
    assert (within.status, within.inside) == (Status.CONTINUUM, "")
    moved = spatial_distance(shell, inner, None, (STRAIGHT, (0, 0, 0.004)))
    checked(moved, 0.006)
    np.testing.assert_allclose(moved.normal, [0, 0, -1], atol=1e-6)


def test_a_ball_in_the_material_has_the_least_wall() -> None:
    answer = spatial_distance(ball(1.0), ball(0.2), None, (STRAIGHT, (0.3, 0, 0)))
    checked(answer, 0.5)
    assert (answer.status, answer.inside) == (Status.CONTAINED, "B")
    other = spatial_distance(ball(0.2), ball(1.0), (STRAIGHT, (0.3, 0, 0)), None)
    checked(other, 0.5)
    assert other.inside == "A"


@pytest.mark.soak
def test_a_torus_in_a_torus_and_a_ball_in_the_hole_of_one() -> None:
    torus = ring(2.0, 0.5)
    checked(spatial_distance(torus, ring(2.0, 0.4)), 0.1)
    answer = spatial_distance(torus, ball(1.2))
    checked(answer, 0.3)
    assert (answer.status, answer.continuum.kind) == (Status.CONTINUUM, "arc")
    beside = spatial_distance(torus, ball(0.3), None, (STRAIGHT, (1.0, 0, 0)))
    checked(beside, 0.2)


def test_plane_on_plane_and_nearly() -> None:
    block, disc = bolt(), peg(0.2, -0.2, 0.2)
    for gap, tilt in ((1e-6, 0.0), (1e-3, 0.0), (1e-3, 1e-12), (1e-3, 1e-3)):
        answer = spatial_distance(block, disc, None, (about_x(tilt), (0.1, 0, 4.2 + gap)))
        truth = gap + 0.2 - 0.2 * np.cos(tilt) - 0.2 * np.sin(tilt)
        checked(answer, truth, 1e-11)
        flat = tilt < 1e-9
        assert answer.status is (Status.CONTINUUM if flat else Status.CONVERGED)


def test_a_ball_in_the_corner_of_a_bracket() -> None:
    # the inner corner is reflex: the nearest points are on its two sides, and tie
    answer = spatial_distance(bracket(), ball(0.2), None, (STRAIGHT, (0.7, 0.7, 0.35)))
    checked(answer, 0.1)
    assert len(answer.minima) == 2
    edge = spatial_distance(bracket(), ball(0.2), None, (STRAIGHT, (2.3, 0.8, 0.35)))
    checked(edge, 0.5 - 0.2)
    assert edge.feature_a.kind == "edge"
    assert edge.status is Status.CONVERGED


def test_solids_that_overlap_have_a_ball_inside_both() -> None:
    answer = spatial_distance(ball(1.0), ball(1.0), None, (STRAIGHT, (1.5, 0, 0)))
    assert answer.status is Status.OVERLAPPING
    assert answer.overlap.radius == pytest.approx(0.25, abs=1e-3)
    assert answer.overlap.radius <= 0.25 + 1e-9
    assert answer.distance == -2.0 * answer.overlap.radius
    for centre in ((0.0, 0, 0), (1.5, 0, 0)):
        away = np.linalg.norm(answer.overlap.common_point - centre)
        assert away + answer.overlap.radius <= 1.0 + 1e-9


def test_solids_that_touch() -> None:
    answer = spatial_distance(ball(1.0), ball(0.5), None, (STRAIGHT, (1.5, 0, 0)))
    assert answer.status is Status.TOUCHING
    assert abs(answer.distance) < 1e-9


def test_swapped_and_moved_together_the_answer_is_the_same() -> None:
    a, b = bolt(), bracket()
    turn = about_x(0.7)
    one = spatial_distance(a, b, None, (turn, (2.6, 0.3, 2.0)))
    other = spatial_distance(b, a, (turn, (2.6, 0.3, 2.0)), None)
    pose = about_x(-1.1), np.array([3.0, -2.0, 5.0])
    moved = (pose[0] @ turn, pose[0] @ [2.6, 0.3, 2.0] + pose[1])
    third = spatial_distance(a, b, pose, moved)
    for answer in (other, third):
        assert answer.status is one.status is Status.CONVERGED
        assert answer.distance == pytest.approx(one.distance, abs=1e-13)
    np.testing.assert_allclose(other.normal, -one.normal, atol=1e-9)
    np.testing.assert_allclose(third.normal, pose[0] @ one.normal, atol=1e-9)


def test_the_gradient_is_that_of_differences() -> None:
    a, b, centre = bracket(), ball(0.2), np.array([2.3, 0.8, 0.35])
    answer = spatial_distance(a, b, None, (STRAIGHT, centre))
    for k in range(3):
        step = 1e-6 * np.eye(3)[k]
        ends = [spatial_distance(a, b, None, (STRAIGHT, centre + s * step)) for s in (1, -1)]
        slope = (ends[0].distance - ends[1].distance) / 2e-6
        assert answer.gradient[6 + k] == pytest.approx(slope, abs=1e-6)


def test_few_evaluations_leave_a_true_interval() -> None:
    answer = spatial_distance(
        HOLE, PEG, None, (about_x(1e-5), (1e-6, 0, 0)), QueryOptions(deadline=5)
    )
    whole = spatial_distance(HOLE, PEG, None, (about_x(1e-5), (1e-6, 0, 0)))
    assert answer.status is Status.DEADLINE
    assert not answer.certified
    assert answer.lower_bound <= whole.distance <= answer.upper_bound + 1e-15


def test_a_volume_that_differs_is_refused() -> None:
    made = bracket().boundary
    corners = np.array(BRACKET)
    following = np.roll(corners, -1, axis=0)
    area = 0.5 * np.sum(corners[:, 0] * following[:, 1] - corners[:, 1] * following[:, 0])
    assert Solid(made, volume=0.7 * area).check().volume == pytest.approx(0.7 * area)
    with pytest.raises(ValueError, match="has the volume"):
        Solid(made, volume=1.0)


@pytest.mark.parametrize("share", [0.5, 0.9, 0.99, 0.999])
def test_what_is_a_little_farther_than_asked_takes_no_more_than_its_distance(share: float) -> None:
    """Potentials through the nearest place are tried, though it is beyond the horizon."""
    bore, pin = tube(2.25, 5.0, -4.0, 4.0), peg(2.14, -4.0, 8.0)
    whole = spatial_distance(bore, pin)
    checked(whole, 0.11)
    far = spatial_distance(bore, pin, asked=QueryOptions(within=share * 0.11))
    assert far.status is Status.FAR
    assert share * 0.11 <= far.lower_bound <= 0.11
    assert far.counts.evaluations <= 1.2 * whole.counts.evaluations
