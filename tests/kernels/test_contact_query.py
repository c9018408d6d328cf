"""A query in contact: what it concludes of depths made by hand, and where it ends from a start."""

import math

import numpy as np
import pytest
from hand_made import new_work
from hand_made_pairs import Placed, X, Y, Z, ball, box, ellipsoid, half_space, turn, unit, vector

from standoff.kernels.depth.descent import descend
from standoff.kernels.depth.penetration import begin_along
from standoff.kernels.frame.contact import (
    COLD,
    NEAR,
    WARM,
    Asked,
    bound_along,
    conclude,
    contact_query,
    farther_apart,
    some_direction,
)
from standoff.kernels.pair.certified import CERTIFIED, PENETRATING, UNCERTIFIED
from standoff.kernels.pair.events import EVALUATIONS, EVENTS, KEEPING, LIMIT, SEARCHES
from standoff.kernels.tolerances import DEPTH_PROOF
from standoff.kernels.values import Depth

TOLERANCE = 1e-10
TURN = turn((1, 2, 3), 0.9)
BOXES = Placed(box(1.0, 0.8, 0.6), box(0.3, 0.4, 0.5), (0.9, 0.5, -0.3))
"""0.4 deep along x, 0.7 along y, 0.8 along -z."""
EGGS = Placed(ellipsoid(1.0, 0.8, 0.6), ellipsoid(0.3, 0.7, 0.5), (0.3, 0.2, 0.9), TURN)
ROUND = Placed(box(1.0, 0.8, 0.6), ball(0.5), (0.9, 0.5, -0.3))
TURNED = Placed(box(1.0, 0.8, 0.6), box(0.5, 0.4, 0.3), (0.7, 0.2, 0.1), TURN)
DOWN = (0.0, 0.0, -1.0)
ROUNDOFF = 1e-13


def minimum(case, n):
    start = Depth(False, math.nan, n, begin_along(*case.both, n))
    found = descend(*case.both, start, TOLERANCE, new_work())
    assert found.found
    return found


def test_points_that_coincide_have_some_direction_all_the_same():
    assert some_direction(Y) == Y
    n = some_direction((0.0, 0.0, 0.0))
    assert np.linalg.norm(n) == 1.0


@pytest.mark.parametrize("n", [X, Y, Z, unit(1, 2, 3), unit(-1, 0.2, 0.1)])
def test_what_a_plane_parts_by(n):
    """Exact of boxes, wherever the witness points are; of ellipsoids at most that."""
    for x_a in ((1.0, 0.8, 0.6), (-1.0, 0.8, -0.6)):
        place = BOXES.place(x_a, (-0.3, 0.4, 0.5))
        assert bound_along(*BOXES.both, place, n) == pytest.approx(-BOXES.depth(n), abs=1e-12)
    place = EGGS.place((1.0, 0.0, 0.0), (-0.3, 0.0, 0.0))
    assert bound_along(*EGGS.both, place, n) <= -EGGS.depth(n)
    tight = begin_along(*TURNED.both, n)
    bound = bound_along(*TURNED.both, tight, n)
    assert bound == pytest.approx(-TURNED.depth(n), abs=1e-12)
    assert bound <= -TURNED.depth(n) + ROUNDOFF


def test_the_better_of_two_directions():
    place = begin_along(*BOXES.both, X)
    assert farther_apart(*BOXES.both, place, X, DOWN) == X
    assert farther_apart(*BOXES.both, place, DOWN, X) == X
    assert farther_apart(*BOXES.both, place, X, X) == X


def test_a_proven_minimum_is_a_penetration():
    at = minimum(BOXES, X)
    found = conclude(*BOXES.both, at, 0.4 - 1e-9, TOLERANCE, new_work())
    assert found.outcome == PENETRATING
    assert found.distance == pytest.approx(-0.4, abs=1e-12)
    assert found.distance - 1e-12 <= found.lower <= found.distance
    # no depth is less than `least`, so the signed distance is at most its negative
    assert found.upper == -(0.4 - 1e-9)
    assert (found.normal, found.place) == (at.normal, at.place)


def test_an_upper_bound_is_never_below_the_distance():
    at = minimum(BOXES, X)
    assert conclude(*BOXES.both, at, 0.5, TOLERANCE, new_work()).upper == at.distance
    unproven = conclude(*BOXES.both, at, -math.inf, TOLERANCE, new_work())
    # the points' own distance, which says nothing of a depth
    assert unproven.upper == pytest.approx(0.4, abs=1e-12)
    assert unproven.outcome == PENETRATING


def test_a_direction_that_was_not_found_is_not_certified():
    at = minimum(BOXES, X)._replace(found=False)
    found = conclude(*BOXES.both, at, 0.4 - 1e-9, TOLERANCE, new_work())
    assert found.outcome == UNCERTIFIED
    assert found.distance == pytest.approx(-0.4, abs=1e-12)


def test_points_off_the_normal_show_what_the_direction_achieves():
    """The corners farthest along a leaning direction are not in line with it."""
    n = unit(1.0, 0.2, 0.0)
    at = Depth(True, -0.1, n, begin_along(*BOXES.both, n))
    found = conclude(*BOXES.both, at, 0.39, TOLERANCE, new_work())
    assert found.outcome == PENETRATING
    assert found.distance == found.lower
    assert found.distance == pytest.approx(-BOXES.depth(n), abs=1e-12)


def test_a_pair_that_turns_out_to_be_apart_is_certified():
    gap = 1e-7
    case = BOXES.at(1.3 + gap, 0.5, -0.3)
    at = minimum(case, X)
    found = conclude(*case.both, at, -math.inf, TOLERANCE, new_work())
    assert found.outcome == CERTIFIED
    assert found.distance == pytest.approx(gap, abs=1e-15)
    assert 0.0 < found.lower <= found.distance <= found.upper
    # points that are not the nearest bound what they are apart by
    off = at._replace(place=case.place((1.0, 0.8, 0.6), (-0.3, -0.4, 0.5)))
    wrong = conclude(*case.both, off, -math.inf, TOLERANCE, new_work())
    assert wrong.outcome == UNCERTIFIED
    assert wrong.lower <= gap <= wrong.distance
    assert wrong.distance == pytest.approx(float(np.linalg.norm(case.gap(off.place))))


def test_cut_off_it_bounds_by_the_boxes_and_certifies_no_overlap_that_was_not_shown():
    work = new_work()
    work.counts[LIMIT] = 0
    n = unit(1.0, 0.2, 0.0)
    at = Depth(True, -0.1, n, BOXES.place((-1.0, 0.8, 0.6), (-0.3, 0.4, 0.5)))
    shown = conclude(*BOXES.both, at, 0.39, TOLERANCE, work)
    assert shown.outcome == UNCERTIFIED
    assert shown.lower == pytest.approx(-BOXES.depth(n), abs=1e-12)
    assert shown.upper == -0.39
    true = minimum(BOXES, X)
    assert conclude(*BOXES.both, true, -math.inf, TOLERANCE, work).outcome == UNCERTIFIED
    assert conclude(*BOXES.both, true, 0.39, TOLERANCE, work).outcome == PENETRATING


def query(case, place, normal, begin, everywhere=True, work=None, stays=False):
    asked, work = Asked(everywhere, stays), work or new_work()
    return contact_query(*case.both, place, normal, begin, asked, TOLERANCE, work)


@pytest.mark.parametrize("case", [BOXES, EGGS, ROUND, TURNED])
@pytest.mark.parametrize("begin", [COLD, WARM, NEAR])
@pytest.mark.parametrize("n", [X, Z, DOWN, unit(-1, 2, 1)])
def test_the_least_depth_is_found_from_everywhere(case, begin, n):
    found = query(case, begin_along(*case.both, n), n, begin)
    least = case.least_depth()
    assert found.outcome == PENETRATING
    assert least - 1e-12 <= -found.distance <= least * (1.0 + DEPTH_PROOF)
    assert found.lower <= found.distance <= found.upper
    assert -found.upper <= least + 1e-12
    assert found.distance == pytest.approx(-case.depth(found.normal), abs=1e-9)
    gap = found.distance * np.array(found.normal)
    np.testing.assert_allclose(case.gap(found.place), gap, atol=1e-9)


def test_followed_alone_a_minimum_stays_and_tells_how_little_it_may_be():
    at = minimum(BOXES, DOWN)
    for begin in (WARM, NEAR):
        found = query(BOXES, at.place, at.normal, begin, everywhere=False)
        assert found.outcome == PENETRATING
        assert found.normal == pytest.approx(DOWN, abs=1e-12)
        assert found.distance == pytest.approx(-0.8, abs=1e-12)
        assert -0.4 - 1e-12 <= found.upper <= 0.0
    # a search of them all leaves it
    assert query(BOXES, at.place, at.normal, NEAR).normal == pytest.approx(X, abs=1e-12)


def test_a_minimum_that_stays_is_told_of_a_lesser_one():
    at, work = minimum(BOXES, DOWN), new_work()
    for begin in (WARM, NEAR):
        found = query(BOXES, at.place, at.normal, begin, stays=True, work=work)
        assert found.outcome == PENETRATING
        assert found.normal == pytest.approx(DOWN, abs=1e-12)
        assert (found.distance, found.upper) == pytest.approx((-0.8, -0.4), rel=DEPTH_PROOF)
    assert work.counts[SEARCHES] == 2


def test_a_near_start_takes_fewer_evaluations_than_a_cold_one():
    at = minimum(EGGS.at(0.33, 0.17, 0.9), Z)
    spent = {}
    for begin in (COLD, WARM, NEAR):
        work = new_work()
        query(EGGS, at.place, at.normal, begin, everywhere=False, work=work)
        spent[begin] = int(work.counts[EVALUATIONS])
        assert work.counts[SEARCHES] == 1
    assert spent[NEAR] < spent[WARM] < spent[COLD]


@pytest.mark.parametrize("begin", [COLD, WARM, NEAR])
@pytest.mark.parametrize("height", [0.6, 0.8 + 1e-7, 1.5])
def test_over_a_half_space_it_is_the_height_of_the_lowest_point(begin, height):
    """The plane stands at 0.3, the ball's lowest point at height - 0.5."""
    case = Placed(half_space(Z, 0.3), ball(0.5), (0.1, -0.2, height))
    start = case.over_plane(0.5 * np.array(unit(0.3, 0.1, -1)))
    work = new_work()
    found = query(case, start, unit(0.1, 0, 1), begin, work=work)
    assert found.outcome == (PENETRATING if height < 0.8 else CERTIFIED)
    assert found.normal == Z
    assert found.distance == pytest.approx(height - 0.8, abs=1e-12)
    assert found.upper == pytest.approx(found.distance, abs=1e-12)
    assert work.counts[SEARCHES] == 0


def test_a_half_space_as_b_turns_the_direction_round():
    case = Placed(ball(0.5), half_space(Z, 0.3), (0.1, -0.2, -0.6))
    found = query(case, begin_along(*case.both, DOWN), X, COLD)
    assert found.outcome == PENETRATING
    assert found.normal == DOWN
    assert found.distance == pytest.approx(-0.2, abs=1e-12)


def test_what_a_search_tries_is_no_event_of_the_frame():
    """Its descents pass edges; of the frame's own log what stood there before is all."""
    work = new_work()
    work.counts[EVENTS] = 2
    found = query(TURNED, begin_along(*TURNED.both, Z), Z, COLD, work=work)
    assert found.outcome == PENETRATING
    assert work.counts[SEARCHES] == 1
    assert work.counts[EVENTS] == 2


@pytest.mark.parametrize("limit", [0, 1, 2, 5])
@pytest.mark.parametrize("begin", [COLD, WARM, NEAR])
def test_cut_off_its_bounds_hold(limit, begin):
    for case in (EGGS, TURNED, BOXES):
        work = new_work()
        work.counts[LIMIT] = limit
        n = unit(-1, 2, 1)
        found = query(case, begin_along(*case.both, n), n, begin, work=work)
        true = -case.least_depth()
        assert found.lower <= true + 1e-12
        assert found.upper >= true - 1e-12
        assert found.lower <= found.distance + ROUNDOFF
        assert work.counts[EVALUATIONS] <= limit + 1
        if found.outcome == PENETRATING:
            assert found.distance <= true + 1e-12


def test_cut_off_the_last_direction_stays_where_it_is_better():
    """From x, along which the boxes' sides part them by -0.4, a descent cut off keeps x."""
    work = new_work()
    work.counts[LIMIT] = 0
    found = query(BOXES, begin_along(*BOXES.both, X), X, WARM, work=work)
    assert found.normal == X
    assert found.lower == pytest.approx(-0.4, abs=1e-12)


def test_cut_off_a_direction_that_parts_less_is_not_taken():
    """Of balls, along z, with one evaluation: Newton's method ends nowhere better."""
    case = Placed(ball(1.0), ball(0.7), (0.4, 0.3, 1.2))
    work = new_work()
    work.counts[LIMIT] = 1
    place = begin_along(*case.both, Z)
    found = query(case, place, Z, NEAR, work=work)
    assert found.normal == Z
    assert found.lower >= bound_along(*case.both, place, Z)
    assert found.lower <= -case.depth(Z)


def test_points_that_coincide_are_queried_all_the_same():
    case = Placed(ball(1.0), ball(0.7), (1.7, 0.0, 0.0))
    place = case.place(X, (-0.7, 0.0, 0.0))
    found = query(case, place, (0.0, 0.0, 0.0), WARM)
    assert found.outcome in (PENETRATING, CERTIFIED)
    assert found.distance == pytest.approx(0.0, abs=1e-12)
    assert found.normal == pytest.approx(X, abs=1e-9)
    assert vector(found.normal) != (0.0, 0.0, 0.0)


def test_a_frame_that_may_keep_its_polytope_keeps_it():
    work = new_work()
    work.counts[KEEPING] = 1
    query(EGGS, begin_along(*EGGS.both, Z), Z, WARM, work=work)
    assert work.polytope.any()
