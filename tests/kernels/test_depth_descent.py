"""The descent of s(n): each of its decisions by hand, and where it ends on balls and boxes."""

import math

import numpy as np
import pytest
from hand_made import new_work
from hand_made_pairs import Placed, X, Y, Z, ball, box, ellipsoid, half_space, turn, unit, vector

from standoff.kernels.depth.descent import (
    AGAIN,
    STUCK,
    TAKEN,
    Way,
    descend,
    fallen,
    least_of,
    minimum_near,
    newton_start,
    next_start,
    onward,
    retried,
    with_guess,
)
from standoff.kernels.depth.penetration import MINIMUM, NOTHING, begin_along, box_depth
from standoff.kernels.pair.events import EVALUATIONS, LIMIT, RESTARTS
from standoff.kernels.tolerances import (
    CONTACT_RESIDUAL,
    LEAST_GAP,
    LESS_REACH,
    MAX_LEAP,
    NEWTON_TURN,
    SHIFTED_GAP,
)
from standoff.kernels.values import Depth

TOLERANCE = 1e-10
P = (0.4, 0.3, 1.2)
BALLS = Placed(ball(1.0), ball(0.7), P)
WAY, SIDEWAYS = unit(*P), unit(3, -4, 0)
BOXES = Placed(box(1.0, 0.8, 0.6), box(0.3, 0.4, 0.5), (0.9, 0.5, -0.3))
FACES = [X, Y, Z, *(vector(-np.array(n)) for n in (X, Y, Z))]


def leaning(angle):
    """A direction of BALLS at an angle from their only minimum, and its points."""
    n = vector(np.cos(angle) * np.array(WAY) + np.sin(angle) * np.array(SIDEWAYS))
    return Depth(False, -BALLS.depth(n), n, BALLS.place(np.array(n), -0.7 * np.array(n)))


def chord(a, b):
    return float(np.linalg.norm(np.subtract(a, b)))


def begun(case, n, distance=math.nan):
    return Depth(False, distance, n, begin_along(*case.both, n))


@pytest.mark.parametrize("angle", [0.05, 0.3, 1.0])
def test_newton_s_step_for_two_balls_leads_to_their_minimum(angle):
    """s = R - n.p: slope |p| sin, curvature |p| cos, so the step is the tangent of the angle."""
    defined, start = newton_start(*BALLS.both, leaning(angle), 10.0)
    assert defined
    assert start == pytest.approx(WAY, abs=1e-9)


@pytest.mark.parametrize("angle", [1.0, 2.0])
def test_far_off_and_where_s_is_concave_it_goes_downhill_by_its_reach(angle):
    """Beyond a right angle Newton's own step would lead to the maximum. The reach is that along
    either principal way, and balls have any two."""
    at = leaning(angle)
    defined, start = newton_start(*BALLS.both, at, 0.2)
    assert defined
    assert BALLS.depth(start) < BALLS.depth(at.normal)
    # a step of x along the tangent is a tangent of the angle turned by
    turned = math.tan(2.0 * math.asin(0.5 * chord(start, at.normal)))
    assert 0.2 - 1e-9 <= turned <= 0.2 * math.sqrt(2.0) + 1e-9


def test_both_principal_ways_are_limited_each_by_itself():
    """Over an ellipsoid's pole: the slopes are those of the offset, in x and y apart."""
    case = Placed(ellipsoid(1.0, 0.8, 0.5), ball(0.4), (0.02, 0.3, 0.6))
    at = Depth(False, -case.depth(Z), Z, case.place((0.0, 0.0, 0.5), (0.0, 0.0, -0.4)))
    _, start = newton_start(*case.both, at, 0.1)
    s = case.depth(Z)
    step_x = 0.02 / (1.0 / 0.5 + 0.4 - s)
    assert 0.3 / (0.64 / 0.5 + 0.4 - s) > 0.1
    assert start == pytest.approx(unit(step_x, 0.1, 1.0), abs=1e-9)


def test_at_corners_and_flat_sides_there_is_no_newton_step():
    case = Placed(box(1.0, 1.0, 1.0), box(1.0, 1.0, 1.0), (1.5, 1.4, 1.3))
    corner = Depth(False, 0.0, unit(1, 1, 1), case.place((1.0, 1.0, 1.0), (-1.0, -1.0, -1.0)))
    assert newton_start(*case.both, corner, 0.3) == (False, corner.normal)


N, NEW = X, unit(1.0, 0.1, 0.0)
STEP_TURN = chord(NEW, N)


def test_steps_at_corners_start_ahead_of_the_last_one_s_end():
    """First by one step, then by twice as many each time, up to MAX_LEAP; the turn is limited."""
    turned = STEP_TURN
    start, ahead = next_start(N, N, NEW, turned, 0.0)
    assert ahead == 1.0
    step = np.subtract(NEW, N)
    assert start == pytest.approx(unit(*(np.array(NEW) + step)), abs=1e-15)
    for before, after in ((1.0, 2.0), (2.0, 4.0), (MAX_LEAP, MAX_LEAP)):
        start, ahead = next_start(N, N, NEW, turned, before)
        assert ahead == after
        leap = min(after, NEWTON_TURN / turned)
        assert start == pytest.approx(unit(*(np.array(NEW) + leap * step)), abs=1e-15)


def test_after_no_step_and_after_a_long_step_back_nothing_is_ahead():
    assert next_start(N, N, N, 0.0, 4.0) == (N, 0.0)
    beyond = unit(1.0, 0.6, 0.0)
    back = chord(NEW, beyond)
    assert back > NEWTON_TURN
    assert next_start(N, beyond, NEW, back, 4.0) == (NEW, 0.0)
    short = unit(1.0, 0.15, 0.0)
    assert next_start(N, short, NEW, chord(NEW, short), 4.0)[1] == 8.0


def test_a_step_that_parts_the_bodies_is_taken():
    last, new = leaning(0.3), leaning(0.2)
    way = Way(last.normal, last.distance, last.place, 0.0, NEWTON_TURN, SHIFTED_GAP)
    assert retried(*BALLS.both, last, True, new, way) == (TAKEN, way)
    ahead = way._replace(ahead=2.0)
    assert retried(*BALLS.both, last, True, new, ahead) == (TAKEN, ahead)


@pytest.mark.parametrize("apart", [True, False])
def test_a_leap_too_far_starts_from_the_last_direction_with_less_reach(apart):
    last, new = leaning(0.3), leaning(0.6)
    assert new.distance < last.distance
    way = Way(new.normal, last.distance, last.place, 2.0, NEWTON_TURN, SHIFTED_GAP)
    came_to, shorter = retried(*BALLS.both, last, apart, new, way)
    assert came_to == AGAIN
    expected = Way(
        last.normal, last.distance, new.place, 0.0, NEWTON_TURN / LESS_REACH, SHIFTED_GAP
    )
    assert shorter == expected


def test_a_guess_too_near_is_replaced_by_the_boxes_own_once():
    last = leaning(0.3)
    way = Way(last.normal, 1.0, last.place, 0.0, NEWTON_TURN, SHIFTED_GAP)
    bound = -box_depth(*BALLS.both, last.normal)
    assert bound <= last.distance
    came_to, farther = retried(*BALLS.both, last, False, last, way)
    assert (came_to, farther) == (AGAIN, way._replace(guess=bound))
    assert retried(*BALLS.both, last, False, last, farther) == (STUCK, farther)


def test_where_to_go_on_from_a_step():
    """Balls: Newton's step; boxes: ahead of the step, as they have no curvature there."""
    last, new = leaning(0.3), leaning(0.2)
    way = Way(last.normal, last.distance, last.place, 0.0, 0.05, SHIFTED_GAP)
    on = onward(*BALLS.both, last, new, way, False)
    start = newton_start(*BALLS.both, new, 0.05)[1]
    assert on == Way(start, new.distance, new.place, 1.0, 0.05, SHIFTED_GAP)
    farther = onward(*BALLS.both, last, new, way._replace(ahead=1.0), False)
    assert farther.reach == 0.1
    assert onward(*BALLS.both, last, new, way._replace(ahead=1.0, reach=0.2), False).reach == 0.3

    corner = begun(BOXES, NEW, -BOXES.depth(NEW))
    way = Way(N, -BOXES.depth(N), corner.place, 2.0, 0.05, SHIFTED_GAP)
    on = onward(*BOXES.both, begun(BOXES, N), corner, way, False)
    assert (on.start, on.ahead) == next_start(N, N, NEW, STEP_TURN, 2.0)


def test_moving_in_lessens_the_gap_down_to_the_least():
    last, new = leaning(0.3), leaning(0.2)
    for gap, less in ((SHIFTED_GAP, SHIFTED_GAP / MAX_LEAP), (2.0 * LEAST_GAP, LEAST_GAP)):
        way = Way(last.normal, last.distance, last.place, 0.0, NEWTON_TURN, gap)
        assert onward(*BALLS.both, last, new, way, True).gap == less
        assert onward(*BALLS.both, last, new, way, False).gap == gap


def test_steps_below_a_saddle_are_counted_until_one_has_fallen():
    at = leaning(0.0)
    none = at._replace(found=False, distance=-math.inf)
    assert fallen(none, 0, -0.4, 2.0) == (none, 0)
    saddle = at._replace(found=True, distance=-0.4)
    roundoff = CONTACT_RESIDUAL * 2.0
    assert fallen(saddle, 3, -0.4 + 0.5 * roundoff, 2.0) == (saddle, 4)
    assert fallen(saddle, 3, -0.4 + 2.0 * roundoff, 2.0) == (none, 0)


def test_a_descent_without_a_minimum_ends_at_its_saddle_or_its_last_step():
    last = leaning(0.1)
    saddle = leaning(0.0)._replace(found=True)
    lost = saddle._replace(found=False)
    assert least_of(*BALLS.both, saddle, saddle.distance, last) == saddle
    higher = saddle.distance + 1e-6
    expected = last._replace(found=False, distance=higher)
    assert least_of(*BALLS.both, saddle, higher, last) == expected
    assert least_of(*BALLS.both, lost, -7.0, last) == last._replace(found=False, distance=-7.0)


def test_a_depth_without_a_distance_gets_the_boxes_own():
    known = leaning(0.1)
    assert with_guess(*BALLS.both, known) == known
    guessed = with_guess(*BALLS.both, known._replace(distance=math.nan))
    assert guessed == known._replace(distance=-box_depth(*BALLS.both, known.normal))


def test_newton_s_method_is_tried_after_short_turns_alone():
    at = leaning(0.1)
    kind, ended, _ = minimum_near(*BALLS.both, at, 0.9 * NEWTON_TURN, TOLERANCE, new_work())
    assert kind == MINIMUM
    assert ended.normal == pytest.approx(WAY, abs=1e-12)
    work = new_work()
    kind, ended, way = minimum_near(*BALLS.both, at, 1.1 * NEWTON_TURN, TOLERANCE, work)
    assert (kind, ended, way) == (NOTHING, at, at.normal)
    assert work.counts[EVALUATIONS] == 0


def assert_minimum(case, found):
    """It says of itself what holds of s(n): it is least around, and the points show it."""
    assert found.found
    assert np.linalg.norm(found.normal) == pytest.approx(1.0, abs=1e-14)
    assert found.distance == pytest.approx(-case.depth(found.normal), abs=1e-12)
    gap = case.gap(found.place)
    np.testing.assert_allclose(gap, found.distance * np.array(found.normal), atol=1e-9)
    assert case.rises_around(found.normal)


STARTS = [*FACES, unit(1, 2, 3), unit(-1, 1, -1), unit(0.2, -1, 0.1), unit(-1, 0, 1e-6)]


@pytest.mark.parametrize("n", STARTS)
def test_balls_have_one_minimum_from_everywhere(n):
    found = descend(*BALLS.both, begun(BALLS, n), TOLERANCE, new_work())
    assert_minimum(BALLS, found)
    assert found.normal == pytest.approx(WAY, abs=1e-12)
    assert found.distance == pytest.approx(-0.4, abs=1e-12)


@pytest.mark.parametrize("n", STARTS)
def test_aligned_boxes_come_to_a_face_no_deeper_than_the_start(n):
    """Their difference is a box: the six minima are its faces, each the deeper the farther."""
    found = descend(*BOXES.both, begun(BOXES, n), TOLERANCE, new_work())
    assert_minimum(BOXES, found)
    assert min(chord(found.normal, face) for face in FACES) < 1e-12
    assert found.distance >= -BOXES.depth(n) - 1e-12


TURNED = Placed(box(1.0, 0.8, 0.6), box(0.5, 0.4, 0.3), (0.7, 0.2, 0.1), turn((1, 2, 3), 0.9))
ROUND = Placed(box(1.0, 0.8, 0.6), ball(0.5), (0.9, 0.5, -0.3))
EGGS = Placed(ellipsoid(1.0, 0.8, 0.6), ellipsoid(0.3, 0.7, 0.5), P, turn((1, 2, 3), 0.9))


@pytest.mark.parametrize("case", [TURNED, ROUND, EGGS, EGGS.at(0.1, 0.0, 0.05)])
@pytest.mark.parametrize("n", STARTS)
def test_it_ends_at_a_local_minimum(case, n):
    found = descend(*case.both, begun(case, n), TOLERANCE, new_work())
    assert_minimum(case, found)
    assert found.distance >= -case.depth(n) - 1e-12


def test_it_leaves_a_saddle_for_the_least():
    """Concentric ellipsoids: stationary along every axis, least along the shortest."""
    case = Placed(ellipsoid(1.0, 0.8, 0.6), ellipsoid(0.5, 0.4, 0.3), (0.0, 0.0, 0.0))
    for n, a, b in ((Y, 0.8, 0.4), (X, 1.0, 0.5)):
        place = case.place(a * np.array(n), -b * np.array(n))
        start = Depth(False, -(a + b), n, place)
        found = descend(*case.both, start, TOLERANCE, new_work())
        assert_minimum(case, found)
        assert found.distance == pytest.approx(-0.9, abs=1e-12)


def test_bodies_apart_have_their_distance():
    """The greatest -s(n): here 0.3, from a guess far below."""
    case = Placed(ball(1.0), ball(0.7), vector(2.0 * np.array(WAY)))
    found = descend(*case.both, begun(case, X), TOLERANCE, new_work())
    assert_minimum(case, found)
    assert found.distance == pytest.approx(0.3, abs=1e-12)


def test_points_on_far_sides_are_left_by_one_restart():
    """Both witness points on the side away from the other ball, whose tangent planes fit."""
    far = BALLS.place(-np.array(WAY), 0.7 * np.array(WAY))
    work = new_work()
    found = descend(*BALLS.both, Depth(False, -0.4, WAY, far), TOLERANCE, work)
    assert_minimum(BALLS, found)
    assert work.counts[RESTARTS] >= 1


@pytest.mark.parametrize("case", [BALLS, BOXES])
def test_at_rest_and_not_certified_it_starts_once_more(case):
    """With a tolerance that nothing meets: the last of the descent is told, and not as found."""
    work = new_work()
    found = descend(*case.both, begun(case, X), -1.0, work)
    assert not found.found
    assert work.counts[RESTARTS] == 1
    assert case.rises_around(found.normal)
    assert found.distance == pytest.approx(-case.depth(found.normal), abs=1e-9)


@pytest.mark.parametrize("limit", [0, 1, 2])
def test_without_evaluations_left_it_has_found_nothing(limit):
    """What it ends with is a distance along its direction that is known, and goes on from there."""
    work = new_work()
    work.counts[LIMIT] = limit
    found = descend(*EGGS.both, begun(EGGS, unit(-1, 1, -1)), TOLERANCE, work)
    assert not found.found
    assert work.counts[EVALUATIONS] <= limit
    assert found.distance <= -EGGS.depth(found.normal) + 1e-12


def test_over_a_half_space_it_is_the_height_of_the_lowest_point():
    case = Placed(half_space(Z, 0.3), ball(0.5), (0.1, -0.2, 0.6))
    start = Depth(False, math.nan, Z, case.over_plane(0.5 * np.array(unit(0.3, 0.1, -1))))
    found = descend(*case.both, start, TOLERANCE, new_work())
    assert found.found
    assert found.normal == pytest.approx(Z, abs=1e-15)
    assert found.distance == pytest.approx(0.6 - 0.5 - 0.3, abs=1e-12)
