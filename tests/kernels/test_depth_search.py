"""The search of all depths: seeds, proofs and probes, on boxes, balls, segments and ellipsoids."""

import math

import numpy as np
import pytest
from hand_made import new_work
from hand_made_pairs import (
    Placed,
    Solid,
    X,
    Y,
    Z,
    ball,
    box,
    ellipsoid,
    point,
    segment,
    turn,
    unit,
    vector,
)
from hull_making import assert_closed, hull_of

import standoff as so
from draws import draws
from standoff.geometry import Line
from standoff.kernels.depth.descent import descend
from standoff.kernels.depth.difference_hull import FACETS, POINT_REALS, facet_normal, nearest_facet
from standoff.kernels.depth.penetration import begin_along, contact_scale
from standoff.kernels.depth.search import (
    SEEDS,
    deepest_below,
    difference,
    less_deep,
    narrow,
    narrow_kept,
    overlap_shown,
    search,
    search_flat,
    seed,
    seed_direction,
    seed_hull,
    settles,
)
from standoff.kernels.pair.events import EVALUATIONS, KEEPING, KEPT, LIMIT, SEARCHES
from standoff.kernels.pair.polytope_layout import N_POLYTOPE, N_VERTICES
from standoff.kernels.tolerances import DEPTH_PROOF, MAX_RIVALS, PRISM, TOUCHING
from standoff.kernels.values import Depth, Pair, Pose, Work

TOLERANCE = 1e-10
HOW = (TOLERANCE, DEPTH_PROOF, MAX_RIVALS)
P = (0.4, 0.3, 1.2)
BALLS = Placed(ball(1.0), ball(0.7), P)
WAY = unit(*P)
BOXES = Placed(box(1.0, 0.8, 0.6), box(0.3, 0.4, 0.5), (0.9, 0.5, -0.3))
DEEP = 0.6 + 0.5 - 0.3
"""Of BOXES: along -z. Along x it is 0.4, the least; along y 0.7."""
TURNED = Placed(box(1.0, 0.8, 0.6), box(0.5, 0.4, 0.3), (0.7, 0.2, 0.1), turn((1, 2, 3), 0.9))
EGGS = Placed(
    ellipsoid(1.0, 0.8, 0.6), ellipsoid(0.3, 0.7, 0.5), (0.3, 0.2, 0.9), turn((1, 2, 3), 0.9)
)
INSIDE = EGGS.at(0.1, 0.0, 0.05)
ROUND = Placed(box(1.0, 0.8, 0.6), ball(0.5), (0.9, 0.5, -0.3))
CASES = [BALLS, BOXES, TURNED, EGGS, INSIDE, ROUND]
NOTHING = Depth(False, -math.inf, Z, begin_along(*BALLS.both, Z))


def begun(case, n, distance=math.nan):
    return Depth(False, distance, n, begin_along(*case.both, n))


def minimum_below(case, n):
    found = descend(*case.both, begun(case, n), TOLERANCE, new_work())
    assert found.found
    return found


def seeded_hull(case):
    hull = hull_of(np.zeros((0, 3)))
    solid, way = seed_hull(*case.both, hull, contact_scale(case.pair))
    return hull, solid, way


def vertices(hull):
    return hull.points.reshape(-1, POINT_REALS)[: hull.sizes[0]]


def test_seeds_are_the_axes_and_the_corners_of_a_cube():
    ways = np.array([seed_direction(False, k) for k in range(SEEDS)])
    np.testing.assert_allclose(np.linalg.norm(ways, axis=1), 1.0, atol=1e-15)
    found = {tuple(np.sign(np.round(way, 12)).astype(int).tolist()) for way in ways}
    axes = {tuple(x) for x in np.vstack([np.eye(3), -np.eye(3)]).astype(int).tolist()}
    corners = {(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)}
    assert found == axes | corners


def test_planar_seeds_go_round_their_plane():
    ways = np.array([seed_direction(True, k) for k in range(8)])
    np.testing.assert_allclose(np.linalg.norm(ways, axis=1), 1.0, atol=1e-15)
    angles = np.sort(np.arctan2(ways[:, 1], ways[:, 0]))
    np.testing.assert_allclose(np.diff(angles), np.pi / 4.0, atol=1e-15)
    assert not ways[:, 2].any()


def test_a_seed_is_the_difference_of_the_corners_farthest_along():
    hull = hull_of(np.zeros((0, 3)))
    n = unit(1, -2, 3)
    assert seed(*TURNED.both, hull.points, 0, n, 1.0) == 1
    x, of_a, of_b = np.split(hull.points[:POINT_REALS], 3)
    R = np.array(TURNED.R).reshape(3, 3)
    np.testing.assert_allclose(x, of_a - (R @ of_b + TURNED.p), atol=1e-15)
    np.testing.assert_array_equal(of_a, [1.0, -0.8, 0.6])
    np.testing.assert_array_equal(np.abs(of_b), [0.5, 0.4, 0.3])
    assert np.dot(n, x) == pytest.approx(TURNED.depth(n), abs=1e-14)


CORNERS = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
SQUARE = so.shapes.planar_loop(
    [Line(x, y) for x, y in zip(CORNERS, CORNERS[1:] + CORNERS[:1], strict=True)]
)


def planar(x, y):
    """Two squares of half width 1, the second at (x, y)."""
    pair = Pair(SQUARE.ints, SQUARE.reals, SQUARE.ints, SQUARE.reals)
    return pair, Pose(BOXES.R, (x, y, 0.0))


def test_a_planar_seed_is_an_edge_of_the_prism():
    hull = hull_of(np.zeros((0, 3)))
    assert seed(*planar(0.5, 0.0), hull.points, 0, unit(1, 1, 0), 3.0) == 2
    high, low = hull.points[:POINT_REALS], hull.points[POINT_REALS : 2 * POINT_REALS]
    np.testing.assert_allclose(high[:3], [1.5, 2.0, 3.0 * PRISM], atol=1e-15)
    np.testing.assert_allclose(low[:3], [1.5, 2.0, -3.0 * PRISM], atol=1e-15)
    # the heights are A's alone
    assert (high[5], high[8]) == (3.0 * PRISM, 0.0)


def test_the_hull_of_seeds_of_aligned_boxes_is_their_difference():
    """Half widths 1.3, 1.2, 1.1 about -p: the nearest face is 0.4 from the origin."""
    hull, solid, _ = seeded_hull(BOXES)
    assert solid
    assert_closed(hull)
    corners = np.abs(vertices(hull)[:, :3] + BOXES.p)
    np.testing.assert_allclose(corners.max(axis=0), [1.3, 1.2, 1.1], atol=1e-15)
    at, least = nearest_facet(hull, False)
    assert least == pytest.approx(0.4, abs=1e-13)
    assert facet_normal(hull, at) == pytest.approx(X, abs=1e-14)


def test_crossing_segments_have_a_flat_difference():
    case = Placed(segment((-1, 0, 0), (1, 0, 0)), segment((0, -1, 0), (0, 1, 0)), (0.0, 0.0, 0.5))
    hull, solid, way = seeded_hull(case)
    assert not solid
    assert np.abs(way) == pytest.approx(Z, abs=1e-15)
    assert hull.sizes[FACETS] == 0


def test_a_needle_s_seeds_are_completed_square_to_their_plane():
    """No seed's direction has the top of a low pyramid farthest along: three corners are flat."""
    n = np.array(unit(1.0, 0.35, 0.15))
    e, f = (np.array(x) for x in (unit(-0.35, 1.0, 0.0), unit(*np.cross(n, (-0.35, 1.0, 0.0)))))
    base = [2.0 * (np.cos(k) * e + np.sin(k) * f) for k in 2.0 * np.pi / 3.0 * np.arange(3)]
    body = so.shapes.polytope([*base, 0.05 * n])
    case = Placed(Solid(body, lambda n: n[..., 0]), point(), (0.0, 0.0, 0.0))
    tops = [np.dot(seed_direction(False, k), 0.05 * n) for k in range(SEEDS)]
    others = [max(np.dot(seed_direction(False, k), x) for x in base) for k in range(SEEDS)]
    assert all(np.array(tops) < others)
    hull, solid, _ = seeded_hull(case)
    assert solid
    assert hull.sizes[FACETS] == 4


SOLIDS = [TURNED.a, TURNED.b, EGGS.a, EGGS.b]


def drawn(rng, lift):
    """A turned pair of boxes or ellipsoids, and a direction along which their cores are `lift`
    apart."""
    a, b = (SOLIDS[rng.integers(4)] for _ in range(2))
    R = turn(rng.normal(size=3).tolist(), float(rng.uniform(0.0, 3.0)))
    n = unit(*rng.normal(size=3))
    here = Placed(a, b, (0.0, 0.0, 0.0), R)
    sideways = np.cross(n, rng.normal(size=3)) * 0.1
    p = sideways + (here.depth(n) + lift) * np.array(n)
    return here.at(*p), n


@pytest.mark.parametrize("lift", [1e-12, 1e-6, 1e-2, 1.0])
def test_an_overlap_is_never_shown_of_bodies_apart(lift, rng):
    for _ in range(draws(30)):
        case, n = drawn(rng, lift)
        assert case.depth(n) < 0.0
        assert not overlap_shown(*case.both)[0]


def test_an_overlap_that_is_shown_is_no_deeper_than_it_is(rng):
    shown = 0
    for _ in range(draws(60)):
        case, _ = drawn(rng, -float(rng.uniform(0.05, 0.8)))
        found, n, least = overlap_shown(*case.both)
        if found:
            shown += 1
            assert 0.0 < least <= case.depth(n) + 1e-13
            assert least <= case.least_depth() + 1e-12
    assert shown > draws(60) // 2


def test_an_overlap_of_aligned_boxes_is_shown_to_the_digit():
    found, n, least = overlap_shown(*BOXES.both)
    assert found
    assert n == pytest.approx(X, abs=1e-14)
    assert least == pytest.approx(0.4, abs=1e-13)
    # touching, and overlapping by less than TOUCHING
    for gap in (0.0, -0.1 * TOUCHING):
        assert not overlap_shown(*BOXES.at(1.3 + gap, 0.5, -0.3).both)[0]
    assert overlap_shown(*BOXES.at(1.3 - 1e-9, 0.5, -0.3).both)[0]
    flat = Placed(segment((-1, 0, 0), (1, 0, 0)), segment((0, -1, 0), (0, 1, 0)), (0.0, 0.0, 0.0))
    shown, n, least = overlap_shown(*flat.both)
    assert (shown, least) == (False, 0.0)
    assert np.abs(n) == pytest.approx(Z, abs=1e-15)


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
    found, least = narrow(*case.both, hull, NOTHING, HOW, new_work())
    assert_least(case, found, least)


def test_narrowing_bounds_every_depth_of_drawn_pairs(rng):
    for _ in range(draws(25)):
        case, _ = drawn(rng, -float(rng.uniform(0.05, 0.8)))
        hull, _, _ = seeded_hull(case)
        found, least = narrow(*case.both, hull, NOTHING, HOW, new_work())
        true = case.least_depth()
        if true > 1e-3:
            assert_least(case, found, least)
        elif true < -1e-12:  # apart all the same
            assert least < 0.0


def test_narrowing_leaves_a_minimum_that_is_not_the_least():
    hull, _, _ = seeded_hull(BOXES)
    wrong = minimum_below(BOXES, (0.0, 0.0, -1.0))
    assert wrong.distance == pytest.approx(-DEEP, abs=1e-12)
    found, least = narrow(*BOXES.both, hull, wrong, HOW, new_work())
    assert_least(BOXES, found, least)
    assert found.normal == pytest.approx(X, abs=1e-12)


@pytest.mark.parametrize("limit", [0, 1, 3, 10])
def test_cut_off_it_still_bounds(limit):
    for case in (EGGS, TURNED, INSIDE):
        hull, _, _ = seeded_hull(case)
        work = new_work()
        work.counts[LIMIT] = limit
        found, least = narrow(*case.both, hull, NOTHING, HOW, work)
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
        found, _ = narrow(*case.both, hull, wrong, how, new_work())
        assert found.distance == pytest.approx(distance, abs=1e-12)


def test_a_kept_polytope_that_proves_the_depth_costs_nothing():
    hull, _, _ = seeded_hull(BOXES)
    best = minimum_below(BOXES, X)
    work = new_work()
    found, least = narrow_kept(*BOXES.both, hull, best, HOW, work)
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
    found, least = narrow_kept(*case.both, hull, best, HOW, work)
    assert found == best
    added = vertices(hull)[before:, :3]
    assert np.abs(added - (0.8, 0.0, 0.0)).sum(axis=1).min() < 1e-9
    assert bound <= least <= 0.8


def keeping_work(last):
    """Of a frame that may keep its polytope, and has one kept."""
    work = new_work()
    work.counts[KEEPING] = 1
    return Work(work.counts, work.events, last, np.zeros(N_POLYTOPE))


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
