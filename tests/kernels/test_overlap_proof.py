"""The proof that two bodies overlap: never of bodies apart, always of bodies that overlap by more
than its margin; and each of its steps by hand."""

import numpy as np
import pytest
from depth_cases import BALLS, BOXES, EGGS, TURNED, WAY, drawn, planar, seeded_hull, vertices
from hand_made import new_work
from hand_made_pairs import Placed, X, Z, ball, box, half_space, point, segment, unit, vector
from hull_making import seeded
from pointed import pointed

from draws import draws
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import pair_span
from standoff.kernels.depth.difference_hull import FACETS, facet_normal, nearest_facet
from standoff.kernels.depth.overlap import (
    below_plane,
    cores_meet,
    farthest_place,
    grows_about,
    is_left,
    nearest_on_facet,
    nearest_on_side,
    overlap_proven,
    proof_margin,
    swept_radii,
    way_out,
    with_overlap,
    within_radii,
)
from standoff.kernels.depth.penetration import begin_along, box_depth, contact_scale
from standoff.kernels.pair.certified import CERTIFIED, OVERLAP, PENETRATING, UNCERTIFIED
from standoff.kernels.pair.events import EVALUATIONS, EVENTS, LIMIT, SEARCHES
from standoff.kernels.tolerances import OVERLAP_NOISE
from standoff.kernels.values import Found, Pair

TETRAHEDRON = np.array([(-1, -1, -1), (3, -1, -1), (-1, 3, -1), (-1, -1, 3)], dtype=float)
"""Its corner is square, and the sum of the coordinates is 1 on the fourth facet."""


def spent():
    work = new_work()
    work.counts[LIMIT] = 0
    return work


def proven(case, work=None):
    n = unit(*case.p) if any(case.p) else Z
    return overlap_proven(*case.both, begin_along(*case.both, n), work or new_work())


def test_the_margin_is_what_roundoff_and_slack_may_add():
    for case in (BOXES, BOXES.at(50.0, 0.0, 0.0)):
        span = pair_span(case.pair, case.pose.p, 0.0)
        assert proof_margin(*case.both) == pytest.approx(OVERLAP_NOISE * span)
    loose = [np.array(body.reals) for body in (BOXES.a.body, BOXES.b.body)]
    loose[0][L.SLACK], loose[1][L.SLACK] = 1e-3, 2e-3
    pair = Pair(BOXES.pair.ints_a, pointed(loose[0]), BOXES.pair.ints_b, pointed(loose[1]))
    assert proof_margin(pair, BOXES.pose) == pytest.approx(3e-3)


def test_the_nearest_point_of_a_side():
    assert nearest_on_side((-1.0, 1.0, 0.0), (3.0, 1.0, 0.0)) == pytest.approx((0.0, 1.0, 0.0))
    assert nearest_on_side((1.0, 1.0, 0.0), (3.0, 1.0, 0.0)) == (1.0, 1.0, 0.0)
    assert nearest_on_side((-3.0, 1.0, 0.0), (-1.0, 1.0, 0.0)) == (-1.0, 1.0, 0.0)
    assert nearest_on_side(X, X) == X


def test_the_left_of_a_side_is_that_seen_from_outside():
    assert is_left(Z, (0.0, 0.0, 0.0), X, (0.5, 0.1, 7.0))
    assert not is_left(Z, (0.0, 0.0, 0.0), X, (0.5, -0.1, 7.0))
    assert is_left(Z, (0.0, 0.0, 0.0), X, (0.5, 0.0, 0.0))


def shifted_hull(shift):
    hull, solid, _ = seeded(TETRAHEDRON + shift)
    assert solid
    assert hull.sizes[FACETS] == 4
    return hull


def facet_along(hull, n):
    return max(range(4), key=lambda m: float(np.dot(facet_normal(hull, m), n)))


@pytest.mark.parametrize(
    ("shift", "foot", "nearest"),
    [
        # above the floor's inside, beyond its side along x, beyond its square corner
        ((0.0, 0.0, 3.0), True, (0.0, 0.0, 2.0)),
        ((0.0, 2.0, 3.0), False, (0.0, 1.0, 2.0)),
        ((2.0, 2.0, 3.0), False, (1.0, 1.0, 2.0)),
    ],
)
def test_the_nearest_point_of_a_facet(shift, foot, nearest):
    hull = shifted_hull(np.array(shift))
    down = facet_along(hull, (0.0, 0.0, -1.0))
    on_foot, x = nearest_on_facet(hull, down)
    assert on_foot == foot
    assert x == pytest.approx(nearest, abs=1e-15)


def test_a_polytope_grows_from_its_point_nearest_to_the_origin():
    """Through its nearest facet where the origin is inside, towards the origin elsewhere."""
    inside = shifted_hull(np.array((0.5, 0.3, 0.4)))
    at, _ = nearest_facet(inside, False)
    assert way_out(inside, 4.0) == pytest.approx(facet_normal(inside, at), abs=1e-15)
    # below the floor, beyond its side, beyond its corner
    assert way_out(shifted_hull(np.array((0.0, 0.0, 3.0))), 4.0) == pytest.approx((0.0, 0.0, -1.0))
    beside = way_out(shifted_hull(np.array((0.0, 2.0, 3.0))), 4.0)
    assert beside == pytest.approx(unit(0, -1, -2), abs=1e-15)
    beyond = way_out(shifted_hull(np.array((2.0, 2.0, 3.0))), 4.0)
    assert beyond == pytest.approx(unit(-1, -1, -2), abs=1e-15)


def test_a_planar_polytope_grows_in_its_plane():
    square = [(x, y) for x in (-1.0, 1.0) for y in (-1.0, 1.0)]
    prism = [(x + 1.5, y + 0.2, z) for x, y in square for z in (-8.0, 8.0)]
    hull, solid, _ = seeded(np.array(prism), planar=1)
    assert solid
    assert way_out(hull, 4.0) == pytest.approx((-1.0, 0.0, 0.0), abs=1e-15)


@pytest.mark.parametrize("n", [WAY, unit(1, 2, 3), unit(-1, 0.2, 0.4)])
def test_a_step_gives_points_of_both_bodies_and_what_they_part_by(n):
    for case in (BALLS, EGGS, TURNED, BOXES):
        on_both, place, distance = farthest_place(*case.both, n, new_work())
        assert on_both
        gap = case.gap(place)
        # of A - B: no direction has it beyond the difference's support
        for m in (X, Z, n, unit(1, -1, 1)):
            assert -float(np.dot(m, gap)) <= case.depth(m) + 1e-12
        # and the distance is no less than the start's, which the boxes bound, nor more than any
        assert distance >= -box_depth(*case.both, n) - 1e-12
        assert distance <= -case.least_depth() + 1e-12
    assert not farthest_place(*BALLS.both, n, spent())[0]


def hull_of_seeds(case):
    hull, solid, _ = seeded_hull(case)
    assert solid
    return hull


@pytest.mark.parametrize("depth", [0.8, 1e-3, 1e-6, 1e-9])
def test_it_grows_about_the_origin_of_bodies_that_overlap(depth):
    """Balls that overlap by less and less: the samples alone do not show it."""
    case = BALLS.at(*((1.7 - depth) * np.array(WAY)))
    hull = hull_of_seeds(case)
    shown = nearest_facet(hull, False)[1] > 0.0
    assert shown == (depth > 0.1)
    margin = proof_margin(*case.both)
    work = new_work()
    assert grows_about(*case.both, hull, margin, work)
    assert nearest_facet(hull, False)[1] > margin
    rows = vertices(hull)[:, :3]
    for n in (WAY, X, Z, unit(1, -2, 3)):
        assert (rows @ n).max() <= case.depth(n) + 1e-12
    if not shown:
        assert work.counts[EVALUATIONS] > 0
        assert not grows_about(*case.both, hull_of_seeds(case), margin, spent())
    assert not grows_about(*case.both, hull_of_seeds(case), 2.0, new_work())


@pytest.mark.parametrize("gap", [0.0, 1e-12, 1e-9, 1e-3, 0.5])
def test_it_does_not_of_bodies_that_are_apart_or_touch(gap):
    for case in (
        BALLS.at(*((1.7 + gap) * np.array(WAY))),
        BOXES.at(1.3 + gap, 0.5, -0.3),
    ):
        assert not grows_about(*case.both, hull_of_seeds(case), 0.0, new_work())
        assert not cores_meet(*case.both, proof_margin(*case.both), new_work())
        assert not proven(case)


def test_swept_bodies_overlap_by_their_radii():
    """Points 1.0 apart, swept by 0.7 and 0.4."""
    case = Placed(point(0.7), point(0.4), vector(np.array(WAY)))
    assert swept_radii(case.pair) == pytest.approx(1.1)
    place = begin_along(*case.both, Z)
    margin = proof_margin(*case.both)
    assert within_radii(*case.both, place, margin)
    assert proven(case)
    for distance, shown in ((1.1 + 1e-9, False), (1.1, False), (1.1 - 1e-9, True)):
        at = case.at(*(distance * np.array(WAY)))
        assert within_radii(*at.both, place, margin) == shown
        assert proven(at) == shown
    assert not within_radii(*case.both, place, 0.2)
    # what is not swept has no radii, and a place off its face is none
    cores = Placed(point(), point(), (0.0, 0.0, 0.0))
    assert not within_radii(*cores.both, place, margin)
    swept = Placed(box(1.0, 1.0, 1.0), point(0.5), (1.3, 0.0, 1.2))
    off = swept.place((0.9, 0.0, 1.0), (0.0, 0.0, 0.0))._replace(v=1.3)
    assert not within_radii(*swept.both, off, margin)
    assert within_radii(*swept.both, off._replace(v=1.0), margin)


@pytest.mark.parametrize(
    ("height", "below"), [(0.6, True), (0.8 - 1e-9, True), (0.8 + 1e-9, False)]
)
def test_a_point_below_a_plane_overlaps_it(height, below):
    """The plane at 0.3, the ball's lowest point at height - 0.5, between the samples."""
    case = Placed(half_space(Z, 0.3), ball(0.5), (0.1, -0.2, height))
    margin = proof_margin(*case.both)
    assert below_plane(*case.both, Z, margin, new_work()) == below
    assert proven(case) == below
    swept = Placed(half_space(Z, 0.3), point(0.5), (0.1, -0.2, height))
    assert proven(swept) == below
    other = Placed(ball(0.5), half_space(Z, 0.3), (0.1, -0.2, -height))
    assert proven(other) == below


def test_what_has_no_inside_is_not_proven():
    a, b = segment((-1, 0, 0), (1, 0, 0)), segment((0, -1, 0), (0, 1, 0))
    crossing = Placed(a, b, (0.1, 0.2, 0.0))
    work = new_work()
    assert not cores_meet(*crossing.both, 0.0, work)
    assert work.counts[SEARCHES] == 1
    assert not proven(crossing)


@pytest.mark.parametrize(
    ("x", "shown"), [(1.6, True), (2.0 - 1e-6, True), (2.0, False), (2.1, False)]
)
def test_planar_squares(x, shown):
    pair, pose = planar(x, 0.3)
    assert overlap_proven(pair, pose, begin_along(pair, pose, X), new_work()) == shown


@pytest.mark.parametrize("lift", [0.0, 1e-13, 1e-9, 1e-3, 1.0])
def test_bodies_apart_are_never_proven_to_overlap(lift, rng):
    for _ in range(draws(20)):
        case, n = drawn(rng, lift)
        assert case.depth(n) <= 1e-15
        assert not proven(case)


def test_bodies_that_overlap_are_proven_to(rng):
    """Down to depths of 1e-8 of the size, which the least s(n) of a search tells."""
    for _ in range(draws(20)):
        case, _ = drawn(rng, -float(10.0 ** rng.uniform(-6, 0)))
        true = case.least_depth()
        if abs(true) > 1e-8 * contact_scale(case.pair):
            assert proven(case) == (true > 0.0)


def test_switches_on_the_way_are_not_the_frame_s():
    here = TURNED.at(0.0, 0.0, 0.0)
    case = here.at(here.depth(X) - 1e-4, 0.0, 0.0)
    alone = new_work()
    assert cores_meet(*case.both, proof_margin(*case.both), alone)
    assert alone.counts[EVENTS] > 0
    work = new_work()
    assert proven(case, work)
    assert work.counts[EVENTS] == 0


def test_only_what_is_not_certified_is_asked():
    """Nor what is certainly apart, nor a frame that has no evaluations left."""
    place = begin_along(*BOXES.both, X)
    found = Found(UNCERTIFIED, place, 0.1, -1.0, 0.1, X)
    named = with_overlap(*BOXES.both, found, new_work())
    assert named == found._replace(outcome=OVERLAP)
    for outcome in (CERTIFIED, PENETRATING):
        other = found._replace(outcome=outcome)
        assert with_overlap(*BOXES.both, other, new_work()) == other
    above = found._replace(lower=1e-9)
    assert with_overlap(*BOXES.both, above, new_work()) == above
    assert with_overlap(*BOXES.both, found, spent()) == found
    apart = BOXES.at(1.4, 0.5, -0.3)
    assert with_overlap(*apart.both, found, new_work()) == found
