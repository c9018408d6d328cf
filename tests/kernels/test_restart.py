"""Global starts, polish near contact and frames cut off: statuses and counts of known pairs."""

import math

import numpy as np
import pytest
from hand_made import new_work
from hand_made_pairs import Placed, X, Y, Z, ball, box, half_space, turn, unit, vector

from standoff.kernels.depth.penetration import begin_along, contact_scale
from standoff.kernels.depth.search import overlap_shown
from standoff.kernels.frame.restart import (
    anywhere,
    anywhere_apart,
    anywhere_from,
    cut_off,
    cut_off_above,
    height_along,
    in_need_of_polish,
    polish_along,
    polished,
    restart,
    start_due,
)
from standoff.kernels.pair.certified import CERTIFIED, NOT_APART, PENETRATING, UNCERTIFIED
from standoff.kernels.pair.cold_start import FIRST
from standoff.kernels.pair.events import EVALUATIONS, KEEPING, LIMIT, RESTARTS
from standoff.kernels.state.state import Integrated, fresh_state
from standoff.kernels.tolerances import PATIENCE, POLISHED
from standoff.kernels.values import NO_RATES, Found

TOLERANCE = 1e-10
NOT_INTEGRATED = Integrated(NO_RATES, NO_RATES, 0.0)
P = (0.4, 0.3, 1.2)
WAY = unit(*P)
TURN = turn((1, 2, 3), 0.9)
BALLS = Placed(ball(1.0), ball(0.7), P)
BOXES = Placed(box(1.0, 0.8, 0.6), box(0.3, 0.4, 0.5), (0.9, 0.5, -0.3))
DOWN = (0.0, 0.0, -1.0)


def apart(gap):
    """The balls so far from each other."""
    return BALLS.at(*((1.7 + gap) * np.array(WAY)))


def poles(case, n=WAY):
    return case.place(np.array(n), -0.7 * np.array(n))


def seen(case, gap, n=WAY):
    """What is known of two balls at their nearest points."""
    return Found(CERTIFIED, poles(case), gap, gap - 1e-15, gap, n)


def spent():
    work = new_work()
    work.counts[LIMIT] = 0
    return work


def test_a_pair_needs_polish_below_a_part_of_its_scale():
    scale = contact_scale(BALLS.pair)
    for part, needed in ((0.9, True), (1.1, False)):
        found = seen(BALLS, part * POLISHED * scale)
        assert in_need_of_polish(BALLS.pair, found, new_work()) == needed
        assert not in_need_of_polish(BALLS.pair, found, spent())


def test_polish_gives_a_small_gap_its_digits():
    """The direction between points 1e-9 apart has lost half its digits; 1e-8 is put on it here."""
    case = apart(1e-9)
    n = unit(*(np.array(WAY) + 1e-8 * np.array(unit(3, -4, 0))))
    found = polish_along(*case.both, seen(case, 1e-9, n), TOLERANCE, new_work())
    assert found.outcome == CERTIFIED
    assert found.normal == pytest.approx(WAY, abs=1e-13)
    assert found.distance == pytest.approx(1e-9, abs=1e-15)
    assert found.upper == found.distance
    assert 1e-9 - 1e-13 < found.lower <= found.distance


def test_what_polish_does_not_solve_stays():
    case = apart(1e-9)
    same = seen(case, 1e-9, unit(*(np.array(WAY) + 1e-4 * np.array(unit(3, -4, 0)))))
    assert polish_along(*case.both, same, TOLERANCE, spent()) == same


def test_polish_is_for_pairs_within_its_reach():
    far = apart(1.0)
    same = seen(far, 1.0)
    work = new_work()
    assert polished(*far.both, same, TOLERANCE, work) == same
    assert work.counts[EVALUATIONS] == 0
    near = apart(1e-9)
    found = polished(*near.both, seen(near, 1e-9), TOLERANCE, work)
    assert found.distance == pytest.approx(1e-9, abs=1e-15)
    assert work.counts[EVALUATIONS] > 0


@pytest.mark.parametrize("gap", [1.0, 1e-3, 1e-9])
def test_bodies_apart_are_found_from_nothing(gap):
    case = apart(gap)
    for found, inside in (
        anywhere_apart(*case.both, TOLERANCE, new_work()),
        anywhere(*case.both, TOLERANCE, new_work()),
        anywhere_from(*case.both, 1, TOLERANCE, new_work()),
    ):
        assert not inside
        assert found.outcome == CERTIFIED
        assert found.distance == pytest.approx(gap, abs=1e-12)
        assert found.lower <= gap + 1e-13
        assert found.normal == pytest.approx(WAY, abs=1e-9 if gap > 1e-3 else 1e-8)


def test_bodies_that_overlap_are_found_by_the_query_in_contact():
    found, inside = anywhere_apart(*BALLS.both, TOLERANCE, new_work())
    assert (found.outcome, inside) == (NOT_APART, False)
    for first in (FIRST, FIRST + 1):
        found, inside = anywhere_from(*BALLS.both, first, TOLERANCE, new_work())
        assert inside
        assert found.outcome == PENETRATING
        assert found.distance == pytest.approx(-0.4, abs=1e-12)
    found, inside = anywhere(*BOXES.both, TOLERANCE, new_work())
    assert (found.outcome, inside) == (PENETRATING, True)
    assert found.distance == pytest.approx(-0.4, abs=1e-12)
    assert found.normal == pytest.approx(X, abs=1e-12)


def test_without_evaluations_a_query_tells_only_what_it_has():
    for case in (BALLS, apart(0.3)):
        found, inside = anywhere_from(*case.both, FIRST, TOLERANCE, spent())
        assert not inside
        assert found.outcome == UNCERTIFIED
        assert found.lower <= -case.least_depth()


def test_a_start_is_due_each_time_the_patience_is_spent():
    """With 10 evaluations a frame: after 5, 10, 15 ... frames; the start is another each time."""
    work = new_work()
    work.counts[LIMIT] = 10
    state = fresh_state(poles(BALLS), NOT_INTEGRATED)
    due = [start_due(state._replace(cut=k), work) for k in range(21)]
    assert [k for k in range(21) if due[k][0]] == [5, 10, 15, 20]
    assert PATIENCE == 48.0
    assert [due[k][1] for k in (5, 10, 15, 20)] == [0, 1, 0, 1]
    work.counts[LIMIT] = 48
    assert [start_due(state._replace(cut=k), work)[0] for k in range(4)] == [
        False,
        True,
        True,
        True,
    ]
    work.counts[LIMIT] = 0
    assert not start_due(state._replace(cut=1000), work)[0]


def test_how_far_one_witness_point_is_beyond_the_other():
    place = BOXES.place((1.0, 0.8, 0.6), (-0.3, -0.4, -0.5))
    assert height_along(*BOXES.both, place, X) == pytest.approx(0.6 - 1.0)
    assert height_along(*BOXES.both, place, DOWN) == pytest.approx(0.8 + 0.6)


GROUND = Placed(half_space(Z, 0.3), ball(0.5), (0.1, -0.2, 0.6))
TOP = 0.5 * np.array(unit(0, 0.1, 1))


def above(height, x_b):
    """The ball's centre at a height, its witness point at x_b, and what a frame knew of them."""
    case = GROUND.at(0.1, -0.2, height)
    found = Found(UNCERTIFIED, case.over_plane(x_b), 9.0, -math.inf, 9.0, DOWN)
    return case, found


def test_over_a_half_space_a_point_below_shows_an_overlap():
    """The last point stands 0.2 + 1e-4 deep; the samples miss the lowest by more."""
    low = 0.5 * np.array(unit(0.01, 0.0, -1.0))
    depth = 0.3 - (0.6 + low[2])
    case, found = above(0.6, low)
    for answer, inside in (cut_off_above(*case.both, found, Z), cut_off(*case.both, found)):
        assert inside
        assert answer.upper == pytest.approx(-depth, abs=1e-12)
        assert answer.distance >= -0.2 - 1e-12
        assert answer.distance == answer.lower <= -0.2 + 1e-12
        assert answer.normal == Z
        assert answer.place == found.place
    # a last point on top of the ball shows less than the samples do
    case, found = above(0.6, TOP)
    answer, inside = cut_off_above(*case.both, found, Z)
    assert inside
    assert -0.2 <= answer.upper < -0.1
    assert answer.place != found.place


def test_over_a_half_space_nothing_below_shows_nothing():
    case, found = above(0.81, TOP)
    answer, inside = cut_off_above(*case.both, found, Z)
    assert not inside
    assert answer == found
    lost = found._replace(normal=(0.0, 0.0, 0.0))
    answer, _ = cut_off_above(*case.both, lost, Z)
    assert np.linalg.norm(answer.normal) == 1.0


def cut(case, place, normal=Y, distance=9.0, lower=-9.0):
    return cut_off(*case.both, Found(UNCERTIFIED, place, distance, lower, 9.0, normal))


def test_samples_that_overlap_turn_a_frame_that_is_cut_off_inside():
    """Of aligned boxes they give the least direction itself, or the last one where that is as
    good."""
    found, inside = cut(BOXES, begin_along(*BOXES.both, Y))
    assert inside
    assert found.normal == pytest.approx(X, abs=1e-12)
    assert found.distance == found.lower == pytest.approx(-0.4, abs=1e-12)
    assert found.upper == pytest.approx(-0.4, abs=1e-12)
    leaning = unit(1.0, 1e-9, 0.0)
    sharp = Placed(box(1.0, 0.8, 0.6), ball(0.5), (1.2, 0.0, 0.0))
    found, inside = cut(sharp, begin_along(*sharp.both, X), leaning)
    assert inside
    assert found.distance <= -sharp.depth(found.normal) + 1e-12
    assert found.upper >= -0.3 - 1e-12


def test_the_last_direction_is_kept_where_it_parts_farther():
    """Of turned boxes the samples' facet is square to some other direction than B's face."""
    n = vector(np.array(TURN).reshape(3, 3)[:, 2])
    case = Placed(box(1.0, 0.8, 0.6), box(0.5, 0.4, 0.3), (0.7, 0.2, 0.1), TURN)
    _, way, least = overlap_shown(*case.both)
    assert case.depth(way) > case.depth(n) + 0.01
    found, inside = cut(case, begin_along(*case.both, n), n)
    assert inside
    assert found.normal == n
    other, inside = cut(case, begin_along(*case.both, n), vector(-np.array(n)))
    assert inside
    assert other.normal == way
    assert other.distance < found.distance
    for answer in (found, other):
        assert answer.distance == answer.lower <= -case.depth(answer.normal) + 1e-12
        assert answer.upper == -least


def test_bodies_that_do_not_show_an_overlap_stay_apart():
    case = apart(0.3)
    found, inside = cut(case, poles(case), WAY)
    assert not inside
    assert (found.distance, found.lower, found.normal) == (9.0, -9.0, WAY)
    # what is proven is not turned round by samples that overlap by roundoff
    found, inside = cut(BOXES, begin_along(*BOXES.both, Y), lower=1e-9)
    assert not inside


def test_points_that_lie_on_one_another_are_no_distance():
    case = apart(0.0)
    found, inside = cut(case, poles(case), WAY, distance=0.0)
    assert inside
    assert found.normal == WAY
    assert found.distance <= 1e-12
    assert found.upper == 0.0


def restarted(case, first=FIRST, work=None):
    work = work or new_work()
    work.counts[KEEPING] = 1
    tracked = restart(*case.both, first, TOLERANCE, NOT_INTEGRATED, work)
    assert work.counts[KEEPING] == 0
    assert tracked.integrated == NOT_INTEGRATED
    assert tracked.shown.rates == NO_RATES
    assert not tracked.shown.fresh
    x_a, x_b = case.points(tracked.shown.found.place)
    np.testing.assert_allclose(tracked.shown.jets[0][0], x_a, atol=1e-13)
    np.testing.assert_allclose(tracked.shown.jets[1][0], x_b, atol=1e-13)
    return tracked.shown, work


def test_a_restart_is_counted_once():
    for case, distance, inside in ((apart(0.3), 0.3, False), (BALLS, -0.4, True)):
        shown, work = restarted(case)
        assert shown.inside == inside
        assert shown.found.distance == pytest.approx(distance, abs=1e-12)
        if not inside:
            assert work.counts[RESTARTS] == 1
    _, work = restarted(apart(0.3), FIRST + 1)  # `nearest_facing` is a restart itself
    assert work.counts[RESTARTS] == 2


def test_a_restart_that_is_cut_off_still_shows_an_overlap():
    shown, _ = restarted(BOXES, work=spent())
    assert shown.inside
    assert shown.found.outcome == UNCERTIFIED
    assert shown.found.distance == pytest.approx(-0.4, abs=1e-12)
    case = apart(0.3)
    shown, _ = restarted(case, work=spent())
    assert not shown.inside
    assert shown.found.lower <= 0.3


def test_a_turned_pair_far_away_is_found_too():
    case = Placed(BOXES.a, BOXES.b, (5.0, 0.0, 0.0), turn(Z, math.pi / 4.0))
    found, _ = anywhere(*case.both, TOLERANCE, new_work())
    assert found.outcome == CERTIFIED
    assert found.distance == pytest.approx(4.0 - 0.7 / math.sqrt(2.0), abs=1e-12)
