"""Other directions in which an overlap is as thin: slabs, cubes and balls in their middle."""

import math

import numpy as np
import pytest
from depth_cases import keeping_work
from hand_made import new_work
from hand_made_pairs import (
    Placed,
    X,
    Y,
    Z,
    ball,
    box,
    half_space,
    pair_of,
    segment,
    turn,
    unit,
    vector,
)

import standoff as so
from standoff.kernels.depth.descent import descend
from standoff.kernels.depth.penetration import begin_along
from standoff.kernels.depth.rivals import (
    ALONE,
    CUBE,
    N_STARTS,
    NOT_ALONE,
    NOT_KNOWN,
    alone,
    equally_deep,
    is_new,
    least_below,
    start_direction,
)
from standoff.kernels.depth.search import search
from standoff.kernels.pair.events import EVALUATIONS, LIMIT
from standoff.kernels.pair.polytope_layout import N_POLYTOPE, N_VERTICES
from standoff.kernels.tolerances import AROUND, DEPTH_PROOF, MAX_RIVALS, SAME_WIDTH
from standoff.kernels.values import Depth, Pose

TURN = turn((1, 2, 3), 0.9)
SLAB = Placed(box(1.0, 0.8, 0.6), ball(0.3), (0.0, 0.0, 0.0))
"""Along z and -z 0.9, along y 1.1, along x 1.3."""
CUBES = Placed(box(1.0, 1.0, 1.0), ball(0.3), (0.0, 0.0, 0.0))


def minimum(case, n):
    start = Depth(False, math.nan, n, begin_along(*case.both, n))
    found = descend(*case.both, start, 1e-10, new_work())
    assert found.found
    return found


def test_starts_are_against_the_normal_and_all_round_in_both_frames():
    case = Placed(SLAB.a, SLAB.b, (0.0, 0.0, 0.0), TURN)
    n = unit(1, -2, 3)
    ways = np.array([start_direction(*case.both, n, k) for k in range(N_STARTS)])
    np.testing.assert_allclose(ways[0], -np.array(n), atol=1e-15)
    own, other = ways[1 : 1 + CUBE], ways[1 + CUBE :]
    grid = {(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)}
    assert {tuple(way) for way in own.astype(int).tolist()} == grid
    np.testing.assert_allclose(other, own @ np.array(TURN).reshape(3, 3).T, atol=1e-15)


def test_planar_starts_stay_in_their_plane():
    loop = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (1, 0), (0, 1), 0, 2 * np.pi)])
    dot = so.shapes.point()
    for a, b in ((loop, dot), (dot, loop)):
        pair = pair_of(a, b)
        ways = [start_direction(pair, Pose(TURN, X), X, k) for k in range(1, N_STARTS)]
        assert not np.array(ways)[:, 2].any()
        assert len({tuple(np.round(way, 9)) for way in ways}) > 8


def test_a_normal_is_new_where_it_is_near_none_that_was_found():
    found = np.array([*X, *Y, *Z])
    for k, n in enumerate((X, Y, Z)):
        near = unit(*(np.array(n) + 0.9 * AROUND * np.array(unit(1, 1, 1))))
        far = unit(*(np.array(n) + 3.0 * AROUND * np.array(unit(1, 1, 1))))
        assert not is_new(near, found, 3)
        assert is_new(far, found, 3)
        assert is_new(n, found, k)


def test_the_minimum_below_a_direction():
    for n, distance in ((X, -1.3), (Y, -1.1), (Z, -0.9)):
        found = least_below(*SLAB.both, n, new_work())
        assert found.found
        assert found.normal == pytest.approx(n, abs=1e-12)
        assert found.distance == pytest.approx(distance, abs=1e-12)
    work = new_work()
    work.counts[LIMIT] = 0
    assert not least_below(*SLAB.both, unit(1, 2, 3), work).found


def normals(case, n, d):
    """Those that `equally_deep` counts, rounded."""
    found = np.full(3 * N_STARTS, np.nan)
    count = equally_deep(*case.both, n, d, found, new_work())
    rows = found.reshape(-1, 3)
    assert np.isnan(rows[count:]).all()
    assert tuple(rows[0]) == n
    return {tuple(row) for row in np.round(rows[:count], 9).tolist()}


BOTH = {Z, (0.0, 0.0, -1.0)}


def test_a_ball_in_the_middle_of_a_slab_has_two_least_depths():
    assert normals(SLAB, Z, -0.9) == BOTH
    assert normals(SLAB.at(0.05, -0.1, 0.0), Z, -0.9) == BOTH
    # off the middle, be it by little
    low = SLAB.at(0.0, 0.0, 1e-9)
    assert SAME_WIDTH * low.size < 2e-9
    assert normals(low, Z, -0.9 + 1e-9) == {Z}
    assert len(normals(SLAB.at(0.0, 0.0, 1e-12), Z, -0.9 + 1e-12)) == 2


def test_a_ball_in_the_middle_of_a_cube_has_six():
    axes = {vector(sign * np.array(n) + 0.0) for n in (X, Y, Z) for sign in (1.0, -1.0)}
    assert normals(CUBES, X, -1.3) == axes


def test_over_a_half_space_there_is_one():
    case = Placed(half_space(Z, 0.3), ball(0.5), (0.1, -0.2, 0.6))
    assert normals(case, Z, -0.2) == {Z}
    other = Placed(ball(0.5), half_space(Z, 0.3), (0.1, -0.2, -0.6))
    assert normals(other, (0.0, 0.0, -1.0), -0.2) == {(0.0, 0.0, -1.0)}


def told(case, n):
    return alone(*case.both, minimum(case, n), new_work())


def test_the_least_depth_is_alone_off_the_middle():
    assert told(SLAB.at(0.05, -0.1, 0.1), Z) == ALONE
    assert told(SLAB.at(0.05, -0.1, 1e-6), Z) == ALONE
    turned = Placed(box(1.0, 0.8, 0.6), box(0.5, 0.4, 0.3), (0.7, 0.2, 0.1), TURN)
    assert told(turned, X) == ALONE


def test_in_the_middle_it_is_not_alone():
    assert told(SLAB, Z) == NOT_ALONE
    assert told(SLAB.at(0.05, -0.1, 0.0), Z) == NOT_ALONE
    assert told(CUBES, X) == NOT_ALONE
    boxes = Placed(box(1.0, 0.8, 0.6), box(0.3, 0.4, 0.5), (0.1, 0.1, 0.0))
    assert told(boxes, Z) == NOT_ALONE
    # a corner that is as far from two sides
    assert told(Placed(box(1.0, 1.0, 1.0), box(0.3, 0.3, 0.3), (0.9, 0.9, 0.0)), X) == NOT_ALONE


def kept_of(case, n):
    """The polytope that a frame keeps whose minimum is below n."""
    work = keeping_work(np.zeros(N_POLYTOPE))
    search(*case.both, minimum(case, n), 1e-10, DEPTH_PROOF, MAX_RIVALS, work)
    assert work.polytope[N_VERTICES] > 0.0
    return np.array(work.polytope)


@pytest.mark.parametrize(("shift", "rivals"), [(1e-6, ALONE), (1e-12, NOT_ALONE), (0.0, NOT_ALONE)])
@pytest.mark.parametrize("case", [SLAB, CUBES], ids=["slab", "cube"])
def test_a_kept_polytope_tells_the_same(case, shift, rivals):
    n = Z if case is SLAB else X
    case = case.at(*(shift * np.array(n)))
    work = keeping_work(kept_of(case, n))
    at = minimum(case, n)
    assert alone(*case.both, at, work) == alone(*case.both, at, new_work()) == rivals


def test_a_kept_polytope_that_leaves_nothing_open_costs_no_evaluation():
    """It has a facet each way where the frame has looked."""
    case = SLAB.at(0.05, -0.1, 0.1)
    kept = kept_of(case, Z)
    moved = SLAB.at(0.051, -0.1, 0.1)
    at = minimum(moved, Z)
    work = keeping_work(kept)
    assert alone(*moved.both, at, work) == ALONE
    assert work.counts[EVALUATIONS] == 0
    anew = new_work()
    assert alone(*moved.both, at, anew) == ALONE
    assert anew.counts[EVALUATIONS] > 0


def test_a_kept_polytope_that_proves_nothing_is_made_anew():
    case = SLAB.at(0.05, -0.1, 0.1)
    away = SLAB.at(0.05, -0.1, -0.4)  # on the other side: the origin is outside the polytope
    kept = kept_of(case, Z)
    at = minimum(away, (0.0, 0.0, -1.0))
    for last in (-kept, np.full_like(kept, np.nan), kept):
        assert alone(*away.both, at, keeping_work(last)) == ALONE


def test_a_rival_that_no_descent_finds_is_not_taken_for_none():
    """Level faces of two slabs in one place: descents of their depth end uncertified at times."""
    slab, rng = box(1.0, 1.0, 0.2), np.random.default_rng(7)
    told_of = set()
    for _ in range(200):
        way = tuple(1e-16 * rng.integers(-9, 10, size=3))
        case = Placed(slab, slab, way, turn(tuple(rng.normal(size=3)), 1e-15 * rng.random()))
        n = (0.0, 0.0, rng.choice([-1.0, 1.0]))
        at = Depth(True, -0.4, n, begin_along(*case.both, n))
        told_of.add(alone(*case.both, at, new_work()))
    assert ALONE not in told_of


def test_of_what_has_no_inside_it_is_not_known():
    case = Placed(segment((-1, 0, 0), (1, 0, 0)), segment((0, -1, 0), (0, 1, 0)), (0.1, 0.2, 0.0))
    at = Depth(True, 0.0, Z, begin_along(*case.both, Z))
    assert alone(*case.both, at, new_work()) == NOT_KNOWN
