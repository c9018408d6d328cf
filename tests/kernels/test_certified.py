"""Descent with its certificate: outcomes by bounds, points on and off their faces, polish."""

import math

import numpy as np
import pytest
from hand_made import new_work
from hand_made_frames import motion_of
from hand_made_pairs import (
    Placed,
    X,
    Z,
    across,
    ball,
    box,
    edge_side,
    half_space,
    pair_of,
    point,
    turn,
    unit,
    vector,
    wedge,
)
from pointed import pointed

import standoff as so
from standoff.kernels.body import layout as L
from standoff.kernels.pair.certified import (
    CERTIFIED,
    TOUCHING_OR_OVERLAPPING,
    UNCERTIFIED,
    on_feature,
    outcome_of,
    settle_and_weigh,
    weigh,
)
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.events import CORRECTIONS, EVALUATIONS, LIMIT
from standoff.kernels.tolerances import BLUR, TOUCHING
from standoff.kernels.values import ORIGIN, Pair, Pose, resting, together

TOLERANCE = 1e-10
CUBE = Placed(box(1.0, 1.0, 1.0), ball(0.5), (0.2, 0.1, 2.0))
"""0.5 apart along z."""


def test_outcomes_by_bounds():
    """Of a pair with a span near 5 and no slack."""
    d = 0.5
    span = CUBE.size + d
    allowed = TOLERANCE * span
    told = {
        # distance, lower bound, blur
        (d, d - 0.9 * allowed, 0.0): CERTIFIED,
        (d, d - 1.1 * allowed, 0.0): UNCERTIFIED,
        (d, d - 1.1 * allowed, 0.2 * allowed): CERTIFIED,
        # blur counts up to BLUR spans
        (d, d - 0.9 * BLUR * span, 1.0): CERTIFIED,
        (d, d - 1.1 * BLUR * span, 1.0): UNCERTIFIED,
        (d, -1.0, 0.0): UNCERTIFIED,
        (0.9 * TOUCHING * CUBE.size, -1.0, 0.0): TOUCHING_OR_OVERLAPPING,
        (1.1 * TOUCHING * CUBE.size, -1.0, 0.0): UNCERTIFIED,
        (0.9 * TOUCHING * CUBE.size, 1e-16, 0.0): CERTIFIED,
        (0.0, 0.0, 0.0): TOUCHING_OR_OVERLAPPING,
    }
    for (distance, lower, blur), expected in told.items():
        found = outcome_of(CUBE.pair, CUBE.pose, distance, lower, blur, TOLERANCE)
        assert found == expected, (distance, lower, blur)


def test_a_body_s_own_slack_is_no_fault_of_the_answer():
    """Points 1e-4 apart on bodies that are known to 1e-3: certified, the bound below 0."""
    body = so.shapes.box(2.0, 2.0, 2.0)
    reals = body.reals.copy()
    reals[L.SLACK] = 1e-3
    pair = Pair(pointed(body.ints), pointed(reals), *CUBE.pair[2:])
    assert outcome_of(pair, CUBE.pose, 1e-4, 1e-4 - 1e-3, 0.0, TOLERANCE) == CERTIFIED
    assert outcome_of(pair, CUBE.pose, 1e-4, 1e-4 - 1.001e-3, 0.0, TOLERANCE) == UNCERTIFIED
    exact = CUBE.pair
    assert outcome_of(exact, CUBE.pose, 1e-4, 1e-4 - 1e-3, 0.0, TOLERANCE) == UNCERTIFIED


def test_points_on_their_features():
    """A face's parameters may leave it; an edge's and a vertex's do not count."""
    place = CUBE.place((0.2, 0.1, 1.0), (0.0, 0.0, -0.5))
    assert on_feature(CUBE.pair, place)
    assert not on_feature(CUBE.pair, place._replace(u=1.001))
    corner = CUBE.place((1.0, 1.0, 1.0), (0.0, 0.0, -0.5))
    assert on_feature(CUBE.pair, corner._replace(u=9.0))
    swapped = Placed(CUBE.b, CUBE.a, (0.0, 0.0, 2.0))
    bottom = swapped.place((0.0, 0.0, 0.5), (0.2, 0.1, -1.0))
    assert on_feature(swapped.pair, bottom)
    assert not on_feature(swapped.pair, bottom._replace(s=1.001))


def weighed(case, place, hint=ORIGIN):
    return weigh(*case.both, place, pair_jets(*case.both, place), hint, TOLERANCE)


def test_the_nearest_points_are_certified_and_others_are_not():
    place = CUBE.place((0.2, 0.1, 1.0), (0.0, 0.0, -0.5))
    found = weighed(CUBE, place)
    assert found.outcome == CERTIFIED
    assert found.distance == pytest.approx(0.5, abs=1e-15)
    assert 0.5 - 1e-13 < found.lower < found.distance
    assert found.normal == pytest.approx(Z, abs=1e-15)
    off = weighed(CUBE, CUBE.place((0.7, 0.1, 1.0), (0.0, 0.0, -0.5)))
    assert off.outcome == UNCERTIFIED
    assert off.distance == pytest.approx(math.sqrt(0.5))
    assert off.lower <= 0.5


def test_a_surface_continued_past_its_face_bounds_nothing():
    """Beside the cube: the top's plane would bound the ball's distance by 0.5."""
    case = CUBE.at(1.2, 0.0, 2.0)
    place = CUBE.place((0.9, 0.0, 1.0), (0.0, 0.0, -0.5))
    beyond = place._replace(v=1.2)
    found = weighed(case, beyond)
    assert found.distance == pytest.approx(0.5, abs=1e-15)
    assert (found.outcome, found.lower) == (UNCERTIFIED, -math.inf)


def test_points_that_coincide_touch_or_overlap():
    touching = CUBE.at(0.2, 0.1, 1.5)
    place = CUBE.place((0.2, 0.1, 1.0), (0.0, 0.0, -0.5))
    assert weighed(touching, place).outcome == TOUCHING_OR_OVERLAPPING
    # 1e-9 apart: the face's own normal gives the bound, with or without a hint
    near = CUBE.at(0.2, 0.1, 1.5 + 1e-9)
    for hint in (ORIGIN, Z):
        found = weighed(near, place, hint)
        assert found.outcome == CERTIFIED
        assert found.lower == pytest.approx(1e-9, abs=1e-13)


def settled(case, place, tolerance=TOLERANCE, work=None, least=0.0, goal=0.0):
    work = work or new_work()
    return settle_and_weigh(*case_motion(case), place, least, goal, tolerance, work), work


def case_motion(case):
    return case.pair, resting(case.pose)


def test_it_descends_to_the_nearest_points_and_certifies_them():
    case = Placed(box(1.0, 1.0, 1.0), ball(0.5), (1.4, 0.3, 2.0))
    start = case.place((-0.7, -0.2, 1.0), (0.0, 0.0, -0.5))
    done, work = settled(case, start)
    gap = math.hypot(0.4, 1.0) - 0.5
    assert done.found.outcome == CERTIFIED
    assert done.found.distance == pytest.approx(gap, abs=1e-12)
    assert done.found.upper == done.found.distance
    assert done.found.normal == pytest.approx(unit(0.4, 0, 1), abs=1e-9)
    x_a, _ = case.points(done.found.place)
    np.testing.assert_allclose(x_a, (1.0, 0.3, 1.0), atol=1e-9)
    np.testing.assert_allclose(done.jets[0][0], x_a, atol=1e-15)
    assert work.counts[EVALUATIONS] > 0


def test_a_goal_ends_it_early():
    """A slope of E below the goal's part of |dR| is enough, after `least` corrections."""
    start = CUBE.place((0.21, 0.1, 1.0), (0.0, 0.0, -0.5))
    loose, work = settled(CUBE, start, 1.0, goal=1.0)
    assert loose.found.place == start
    assert work.counts[CORRECTIONS] == 0
    _, work = settled(CUBE, start, 1.0, goal=1.0, least=1.0)
    assert work.counts[CORRECTIONS] == 1
    sharp, _ = settled(CUBE, start)
    assert sharp.found.distance == pytest.approx(0.5, abs=1e-15)


def test_its_rates_are_the_feedforward_of_the_motion():
    """The ball slides along x at 0.3: the foot on the cube's top follows, (u, v) being (-y, x)."""
    motion = motion_of(CUBE.pose, (0.3, 0.0, 0.0))
    start = CUBE.place((0.2 + 1e-7, 0.1, 1.0), (0.0, 0.0, -0.5))
    done = settle_and_weigh(CUBE.pair, motion, start, 1.0, TOLERANCE, TOLERANCE, new_work())
    assert done.fresh
    assert done.rates[:2] == pytest.approx((0.0, 0.3), abs=1e-6)
    assert done.rates[2:] == pytest.approx((0.0, 0.0), abs=1e-6)


@pytest.mark.parametrize("gap", [1e-6, 1e-9, 1e-12])
def test_near_contact_it_is_polished(gap):
    """Turned, so that the gap's digits are lost in the difference of the points."""
    R = turn((1, 2, 3), 0.9)
    n = np.array(R).reshape(3, 3) @ np.array(X)
    case = Placed(ball(1.0), ball(0.7), tuple(float(x) for x in (1.7 + gap) * n), R)
    start = case.place(unit(*(n + 0.01)), -0.7 * np.array(X))
    done, _ = settled(case, start)
    assert done.found.outcome == CERTIFIED
    assert done.found.distance == pytest.approx(gap, abs=1e-14)
    assert done.found.lower <= gap + 1e-14


@pytest.mark.parametrize("spin", [0.0, math.pi])
@pytest.mark.parametrize(
    ("first", "second"), [(30.0, 30.0), (0.0, 30.0), (0.0, 0.0), (120.0, 60.0)]
)
@pytest.mark.parametrize("gap", [1e-5, 1e-8, 1e-10])
def test_near_contact_two_edges_are_polished_too(gap, first, second, spin):
    """All of it turned and off the origin, so that the direction of the gap has lost its digits."""
    (a, edge_a), (b, edge_b) = wedge(first), wedge(second)
    above = across(gap, spin)
    turned = np.array(turn((3, -1, 2), 0.7)).reshape(3, 3)
    R = turned @ np.array(above.R).reshape(3, 3)
    p = turned @ np.add(above.p, (0.31, 0.23, 0.0))
    pose = Pose(tuple(float(x) for x in R.ravel()), vector(p))
    pair = pair_of(a.transformed(turned), b)
    place = together(edge_side(edge_a, 0.45), edge_side(edge_b, 0.53))
    found = settle_and_weigh(pair, resting(pose), place, 0.0, 0.0, TOLERANCE, new_work()).found
    assert found.outcome == CERTIFIED
    assert found.distance == pytest.approx(gap, abs=1e-14)
    assert found.normal == pytest.approx(vector(turned @ np.array(Z)), abs=1e-9)


def test_near_contact_a_feature_is_still_released():
    """From a corner, with the ball's point 1e-7 above the middle of the top."""
    case = CUBE.at(0.2, 0.1, 1.5 + 1e-7)
    start = case.place((1.0, 1.0, 1.0), (0.0, 0.0, -0.5))
    done, _ = settled(case, start)
    assert done.found.outcome == CERTIFIED
    assert done.found.place.feature_a == CUBE.place((0.2, 0.1, 1.0), (0.0, 0.0, -0.5)).feature_a
    assert done.found.distance == pytest.approx(1e-7, abs=1e-14)


def test_without_evaluations_it_weighs_the_start():
    work = new_work()
    work.counts[LIMIT] = 0
    start = CUBE.place((0.7, 0.1, 1.0), (0.0, 0.0, -0.5))
    done, _ = settled(CUBE, start, work=work)
    assert done.found.outcome == UNCERTIFIED
    assert done.found.place == start
    assert not done.fresh


def test_a_half_space_and_a_sphere():
    """Cores: the plane at 0.3 and the sphere's centre."""
    case = Placed(half_space(Z, 0.3), point(0.5), (4.0, -2.0, 1.0))
    start = Placed(half_space(Z, 0.3), point(0.5), (0.0, 0.0, 1.0)).over_plane(ORIGIN)
    done, _ = settled(case, start)
    assert done.found.outcome == CERTIFIED
    assert done.found.distance == pytest.approx(0.7, abs=1e-12)
    assert done.found.normal == pytest.approx(Z, abs=1e-12)
