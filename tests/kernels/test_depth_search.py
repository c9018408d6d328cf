"""The search of all depths: probes, proofs and the polytope it keeps, on boxes, balls and eggs."""

import math

import numpy as np
import pytest
from depth_cases import (
    BALLS,
    BOXES,
    CASES,
    DEEP,
    EGGS,
    INSIDE,
    NOTHING,
    TOLERANCE,
    TURNED,
    WAY,
    begun,
    drawn,
    keeping_work,
    minimum_below,
    planar,
    seeded_hull,
    vertices,
)
from hand_made import new_work
from hand_made_pairs import Placed, X, Y, Z, ball, box, point, segment, unit, vector

from draws import draws
from standoff.kernels.depth.difference_hull import nearest_facet
from standoff.kernels.depth.penetration import begin_along
from standoff.kernels.depth.search import (
    SEEDS,
    deepest_below,
    difference,
    less_deep,
    narrow,
    narrow_kept,
    search,
    search_flat,
    settles,
)
from standoff.kernels.pair.events import EVALUATIONS, KEPT, LIMIT, SEARCHES
from standoff.kernels.pair.polytope_layout import N_POLYTOPE, N_VERTICES
from standoff.kernels.tolerances import DEPTH_PROOF, MAX_RIVALS
from standoff.kernels.values import Depth

HOW = (TOLERANCE, DEPTH_PROOF, MAX_RIVALS)


def test_the_difference_of_witness_points():
    place = TURNED.place((1.0, -0.8, 0.6), (0.5, 0.4, -0.3))
    vertex = difference(*TURNED.both, place)
    np.testing.assert_allclose(vertex.x, -TURNED.gap(place), atol=1e-15)
    assert vertex.of_a == pytest.approx((1.0, -0.8, 0.6), abs=1e-15)
    assert vertex.of_b == pytest.approx((0.5, 0.4, -0.3), abs=1e-15)


def test_the_lesser_of_two_depths():
    less, more = (NOTHING._replace(found=True, distance=d) for d in (-0.2, -0.3))
    lost = less._replace(found=False)
    assert less_deep(less, more) == less_deep(more, less) == less
    assert less_deep(lost, more) == less_deep(more, lost) == more
    assert less_deep(lost, NOTHING) == NOTHING


def test_a_flat_difference_is_searched_on_both_of_its_sides():
    """Crossing segments: 0.5 apart, or touching, which bounds every depth by 0."""
    a, b = segment((-1, 0, 0), (1, 0, 0)), segment((0, -1, 0), (0, 1, 0))
    for height, toward in ((0.5, Z), (-0.5, (0.0, 0.0, -1.0))):
        case = Placed(a, b, (0.1, 0.2, height))
        found, least = search_flat(*case.both, Z, NOTHING, TOLERANCE, new_work())
        assert found.found
        assert found.normal == pytest.approx(toward, abs=1e-12)
        assert found.distance == pytest.approx(0.5, abs=1e-12)
        assert least == -math.inf
    case = Placed(a, b, (0.1, 0.2, 0.0))
    found, least = search_flat(*case.both, Z, NOTHING, TOLERANCE, new_work())
    assert found.found
    assert found.distance == pytest.approx(0.0, abs=1e-12)
    assert least == 0.0


def test_below_a_step_lies_a_minimum_or_what_the_step_is_known_to_part_by():
    n = unit(1, 0.2, 0.1)
    found = deepest_below(*BOXES.both, begun(BOXES, n), TOLERANCE, new_work())
    assert found.found
    assert found.normal == pytest.approx(X, abs=1e-12)
    assert found.distance == pytest.approx(-0.4, abs=1e-12)
    work = new_work()
    work.counts[LIMIT] = 0
    cut = deepest_below(*BOXES.both, begun(BOXES, n, -BOXES.depth(n)), TOLERANCE, work)
    assert cut.found
    assert cut.normal == n
    assert cut.distance == pytest.approx(-BOXES.depth(n), abs=1e-12)
    assert cut.distance <= -BOXES.depth(n)


@pytest.mark.parametrize("radius", [0.0, 0.5])
def test_a_depth_is_proven_by_a_bound_within_its_part(radius):
    """A swept radius makes each depth greater, and the part is one of the whole."""
    pair = Placed(box(1.0, 1.0, 1.0), point(radius), X).pair
    best = NOTHING._replace(found=True, distance=-0.4)
    enough = (1.0 - DEPTH_PROOF) * (0.4 + radius) - radius
    assert settles(pair, best, enough + 1e-10, DEPTH_PROOF)
    assert not settles(pair, best, enough - 1e-10, DEPTH_PROOF)
    assert not settles(pair, best._replace(found=False), 1.0, DEPTH_PROOF)
    # whether the bodies overlap at all
    assert settles(pair, best, -radius, 1.0)
    assert not settles(pair, best, -radius - 1e-10, 1.0)


def assert_least(case, found, least):
    """No depth is less than `least`, and the one found is no more than DEPTH_PROOF off it."""
    true = case.least_depth()
    assert least <= true + 1e-12
    assert found.found
    assert -found.distance <= true * (1.0 + DEPTH_PROOF) + 1e-12
    assert -found.distance >= true - 1e-12
    assert found.distance == pytest.approx(-case.depth(found.normal), abs=1e-12)
    assert settles(case.pair, found, least, DEPTH_PROOF)


@pytest.mark.parametrize("case", CASES)
def test_narrowing_proves_the_least_depth(case):
    hull, solid, _ = seeded_hull(case)
    assert solid
    found, least, _ = narrow(*case.both, hull, NOTHING, HOW, new_work())
    assert_least(case, found, least)


def test_narrowing_bounds_every_depth_of_drawn_pairs(rng):
    for _ in range(draws(25)):
        case, _ = drawn(rng, -float(rng.uniform(0.05, 0.8)))
        hull, _, _ = seeded_hull(case)
        found, least, _ = narrow(*case.both, hull, NOTHING, HOW, new_work())
        true = case.least_depth()
        if true > 1e-3:
            assert_least(case, found, least)
        elif true < -1e-12:  # apart all the same
            assert least < 0.0


def test_narrowing_leaves_a_minimum_that_is_not_the_least():
    hull, _, _ = seeded_hull(BOXES)
    wrong = minimum_below(BOXES, (0.0, 0.0, -1.0))
    assert wrong.distance == pytest.approx(-DEEP, abs=1e-12)
    found, least, _ = narrow(*BOXES.both, hull, wrong, HOW, new_work())
    assert_least(BOXES, found, least)
    assert found.normal == pytest.approx(X, abs=1e-12)


@pytest.mark.parametrize("limit", [0, 1, 3, 10])
def test_cut_off_it_still_bounds(limit):
    for case in (EGGS, TURNED, INSIDE):
        hull, _, _ = seeded_hull(case)
        work = new_work()
        work.counts[LIMIT] = limit
        found, least, _ = narrow(*case.both, hull, NOTHING, HOW, work)
        assert least <= case.least_depth() + 1e-12
        # a step that has begun is ended
        assert work.counts[EVALUATIONS] <= limit + 1
        if found.found:
            assert found.distance <= -case.depth(found.normal) + 1e-12


def test_rivals_are_tried_where_one_may_be_less():
    """Aligned boxes: the depths along x and -x differ by 1e-4, less than the proof asks."""
    case = Placed(box(0.5, 1.0, 1.0), box(0.2, 0.3, 0.3), (5e-5, 0.0, 0.0))
    wrong = minimum_below(case, (-1.0, 0.0, 0.0))
    assert wrong.distance == pytest.approx(-0.70005, abs=1e-12)
    for rivals, distance in ((0, -0.70005), (1, -0.69995)):
        hull, _, _ = seeded_hull(case)
        how = (TOLERANCE, DEPTH_PROOF, rivals)
        found, _, _ = narrow(*case.both, hull, wrong, how, new_work())
        assert found.distance == pytest.approx(distance, abs=1e-12)


def test_a_kept_polytope_that_proves_the_depth_costs_nothing():
    hull, _, _ = seeded_hull(BOXES)
    best = minimum_below(BOXES, X)
    work = new_work()
    found, least, _ = narrow_kept(*BOXES.both, hull, best, HOW, work)
    assert found == best
    assert least == pytest.approx(0.4, abs=1e-13)
    assert work.counts[EVALUATIONS] == 0


def test_a_kept_polytope_takes_in_the_witness_points_own_difference():
    """A ball about the origin in a box: the seeds' facet lacks the ball's own pole along x."""
    case = Placed(box(0.5, 1.0, 1.0), ball(0.4), (0.1, 0.0, 0.0))
    best = minimum_below(case, X)
    hull, _, _ = seeded_hull(case)
    before, bound = hull.sizes[0], nearest_facet(hull, False)[1]
    assert not settles(case.pair, best, bound, DEPTH_PROOF)
    work = new_work()
    work.counts[LIMIT] = 0  # nothing else is tried
    found, least, _ = narrow_kept(*case.both, hull, best, HOW, work)
    assert found == best
    added = vertices(hull)[before:, :3]
    assert np.abs(added - (0.8, 0.0, 0.0)).sum(axis=1).min() < 1e-9
    assert bound <= least <= 0.8


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("n", [None, X, (0.0, 0.0, -1.0)])
def test_a_search_ends_at_the_least_depth(case, n):
    best = NOTHING if n is None else minimum_below(case, n)
    work = new_work()
    found, least = search(*case.both, best, TOLERANCE, DEPTH_PROOF, MAX_RIVALS, work)
    assert_least(case, found, least)
    assert (work.counts[SEARCHES], work.counts[KEPT]) == (1, 0)
    assert not work.polytope.any()


def test_a_search_of_bodies_apart_bounds_no_depth():
    case = BALLS.at(*(2.0 * np.array(WAY)))
    found, least = search(*case.both, NOTHING, TOLERANCE, DEPTH_PROOF, MAX_RIVALS, new_work())
    assert least < 0.0
    assert found.distance == pytest.approx(0.3, abs=1e-9)


def test_a_search_asks_only_whether_bodies_overlap_where_the_proof_is_1():
    """The minimum that is given stays, though it is not the least."""
    wrong = minimum_below(BOXES, (0.0, 0.0, -1.0))
    work = new_work()
    found, least = search(*BOXES.both, wrong, TOLERANCE, 1.0, 0, work)
    assert found == wrong
    assert 0.0 <= least <= 0.4
    assert work.counts[EVALUATIONS] == 0


def test_a_search_keeps_its_polytope_and_begins_with_the_last_one_s():
    best = minimum_below(EGGS, WAY)
    first = keeping_work(np.zeros(N_POLYTOPE))
    found, least = search(*EGGS.both, best, TOLERANCE, DEPTH_PROOF, MAX_RIVALS, first)
    assert_least(EGGS, found, least)
    assert (first.counts[SEARCHES], first.counts[KEPT]) == (1, 1)
    assert first.polytope[N_VERTICES] > 0.0

    moved = EGGS.at(*(np.array(EGGS.p) + 1e-3))
    best = minimum_below(moved, WAY)
    second = keeping_work(first.polytope)
    found, least = search(*moved.both, best, TOLERANCE, DEPTH_PROOF, MAX_RIVALS, second)
    assert_least(moved, found, least)
    assert (second.counts[SEARCHES], second.counts[KEPT]) == (0, 1)
    assert second.counts[EVALUATIONS] < first.counts[EVALUATIONS]


def test_a_kept_polytope_that_is_of_no_use_is_made_anew():
    first = keeping_work(np.zeros(N_POLYTOPE))
    search(*EGGS.both, NOTHING, TOLERANCE, DEPTH_PROOF, MAX_RIVALS, first)
    away = EGGS.at(*(-1.12 * np.array(EGGS.p)))
    assert away.least_depth() > 0.0
    second = keeping_work(first.polytope)
    found, least = search(*away.both, NOTHING, TOLERANCE, DEPTH_PROOF, MAX_RIVALS, second)
    assert_least(away, found, least)
    assert second.counts[SEARCHES] == 1


def test_a_kept_polytope_that_does_not_prove_the_depth_is_made_anew():
    """By a proof that no bound gives, twice the depth: as it is, and then an exact one."""
    first = keeping_work(np.zeros(N_POLYTOPE))
    best = minimum_below(BOXES, X)
    search(*BOXES.both, best, TOLERANCE, DEPTH_PROOF, MAX_RIVALS, first)
    assert first.counts[KEPT] == 1
    second = keeping_work(first.polytope)
    found, least = search(*BOXES.both, best, TOLERANCE, -1.0, MAX_RIVALS, second)
    assert second.counts[SEARCHES] == 2
    assert found.distance == pytest.approx(-0.4, abs=1e-12)
    assert least == pytest.approx(0.4, abs=1e-12)


@pytest.mark.parametrize(
    ("x", "y", "depth", "n"), [(1.6, 0.3, 0.4, X), (0.3, -1.5, 0.5, (0.0, -1.0, 0.0))]
)
def test_a_planar_search_stays_in_its_plane(x, y, depth, n):
    """Squares of half width 1: s = 2 |n_x| + 2 |n_y| - n.p in the plane."""
    pair, pose = planar(x, y)
    start = Depth(False, -math.inf, n, begin_along(pair, pose, n))
    found, least = search(pair, pose, start, TOLERANCE, DEPTH_PROOF, MAX_RIVALS, new_work())
    assert found.found
    assert found.normal == pytest.approx(n, abs=1e-12)
    assert found.distance == pytest.approx(-depth, abs=1e-12)
    assert (1.0 - DEPTH_PROOF) * depth <= least <= depth


def test_crossing_segments_are_searched_as_what_they_are():
    case = Placed(segment((-1, 0, 0), (1, 0, 0)), segment((0, -1, 0), (0, 1, 0)), (0.1, 0.2, 0.5))
    found, least = search(*case.both, NOTHING, TOLERANCE, DEPTH_PROOF, MAX_RIVALS, new_work())
    assert found.distance == pytest.approx(0.5, abs=1e-12)
    assert vector(found.normal) == pytest.approx(Z, abs=1e-12)
    assert least == -math.inf


def test_the_vertices_of_a_search_are_points_of_the_difference():
    """Each of n.x is at most s(n), along many n."""
    hull, _, _ = seeded_hull(EGGS)
    narrow(*EGGS.both, hull, NOTHING, HOW, new_work())
    rows = vertices(hull)[:, :3]
    assert len(rows) > SEEDS
    for n in (X, Y, Z, unit(1, 2, 3), unit(-1, 1, -2), WAY):
        assert (rows @ n).max() <= EGGS.depth(n) + 1e-12
