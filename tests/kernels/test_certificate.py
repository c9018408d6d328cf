"""The certificate at witness points set by hand: never above the distance, tight at the true ones.

A box and a point, whose distance is that of closed forms, and an ellipsoid above a point.
"""

import math
from itertools import product

import numpy as np
import pytest
from hand_made import (
    BOX,
    CORNER,
    CORNER_AT,
    EDGE,
    at_vertex,
    beside,
    on_edge,
    on_top,
    place_of,
    unit,
)

import standoff as so
from standoff.kernels.pair.certificate import (
    between,
    certify,
    certify_along,
    edge_cone,
    nearest_normal,
    overhang,
    vertex_cone,
)
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.values import Side

INTS, REALS = BOX.ints, BOX.reals
NO_HINT = (0.0, 0.0, 0.0)
ALONG_EDGE = (0.0, 1.0, 0.0)
ROUNDOFF = 1e-13


def jets_at(pair, pose, side):
    """Both jets, in A's frame: at a side of the body, and of the point."""
    return pair_jets(pair, pose, place_of(side))


def certified(x, side, body=BOX, hint=NO_HINT):
    """(distance of the witness points, lower bound, normal) with the point at x."""
    pair, pose = beside(x, body)
    jets = jets_at(pair, pose, side)
    d, bound, normal, blur = certify(pair, pose, place_of(side), jets, hint)
    assert blur == 0.0
    assert d == pytest.approx(math.dist(jets[0][0], x), rel=1e-15)
    return d, bound, normal


def box_distance(x):
    return float(np.linalg.norm(np.maximum(np.abs(x) - 1.0, 0.0)))


@pytest.mark.parametrize(
    ("x", "side", "normal"),
    [
        ((0.3, -0.2, 3.0), on_top(0.3, -0.2), (0.0, 0.0, 1.0)),
        ((2.0, 0.4, 2.0), on_edge(0.3), unit(1, 0, 1)),
        ((1.5, 0.0, 3.0), on_edge(0.5), unit(0.5, 0, 2)),
        ((2.0, 3.0, 1.5), at_vertex(CORNER_AT), unit(1, 2, 0.5)),
    ],
)
def test_it_is_tight_at_the_witness_points(x, side, normal):
    d, bound, n = certified(x, side)
    assert d == pytest.approx(box_distance(x), abs=1e-15)
    assert d - ROUNDOFF <= bound < d
    assert n == pytest.approx(normal, abs=1e-14)


@pytest.mark.parametrize(
    "x", [(0.0, 0.0, 3.0), (2.0, 0.4, 2.0), (2.0, 3.0, 1.5), (1.001, 1.001, 1.001), (4.0, 0.0, 0.9)]
)
def test_it_is_no_greater_at_any_other_points(x):
    """From every vertex, along an edge and all over the top."""
    sides = [at_vertex(k) for k in range(BOX.n_vertices)]
    sides += [on_edge(t) for t in np.linspace(0.0, 1.0, 7).tolist()]
    grid = np.linspace(-1.0, 1.0, 5).tolist()
    sides += [on_top(*at) for at in product(grid, grid)]
    for side in sides:
        for hint in (NO_HINT, unit(*x), unit(1, -2, 3)):
            assert certified(x, side, hint=hint)[1] <= box_distance(x)


def test_beside_the_witness_point_the_face_s_own_normal_is_tight():
    """The points are sqrt(4 + 0.13) apart; nothing hangs over at A along the top's normal."""
    d, bound, n = certified((0.0, 0.0, 3.0), on_top(0.3, 0.2))
    assert d == pytest.approx(math.sqrt(4.13), abs=1e-15)
    assert bound == pytest.approx(2.0, abs=ROUNDOFF)
    assert n == pytest.approx((0.0, 0.0, 1.0), abs=1e-15)


def test_a_hint_that_is_better_is_taken():
    """Witness points that nearly meet: their direction is of no use, the hint is."""
    pair, pose = beside((0.2, 0.1, 1.0 + 1e-9))
    place, jets = place_of(at_vertex(CORNER_AT)), jets_at(pair, pose, at_vertex(CORNER_AT))
    _, plain, _, _ = certify(pair, pose, place, jets, NO_HINT)
    _, bound, n, _ = certify(pair, pose, place, jets, (0.0, 0.0, 1.0))
    assert bound == pytest.approx(1e-9, abs=ROUNDOFF)
    assert bound >= plain
    assert n == (0.0, 0.0, 1.0)


def test_it_holds_on_a_curved_face_and_is_tight_at_its_top():
    """An ellipsoid of semi-axis 1 along z below a point at z = 3: 2 apart."""
    body = so.shapes.ellipsoid(2.0, 1.5, 1.0)
    x, best = (0.0, 0.0, 3.0), -np.inf
    for chart in range(len(body.face_parts[0].charts)):
        for u, v in product(np.linspace(-0.9, 0.9, 7).tolist(), repeat=2):
            side = Side(np.int64(0), np.int64(chart), u, v)
            _, bound, _ = certified(x, side, body)
            assert bound <= 2.0
            best = max(best, bound)
    assert best == pytest.approx(2.0, abs=ROUNDOFF)


def test_along_a_direction_it_is_the_separation():
    """n.x less the box's support: 2 at most, less where n leans, negative where it points away."""
    pair, pose = beside((0.0, 0.0, 3.0))
    for n in ((0.0, 0.0, 1.0), unit(0.1, 0.0, 1.0), unit(1, 1, 1), (0.0, 0.0, -1.0)):
        exact = 3.0 * n[2] - float(np.abs(n).sum())
        corner = at_vertex(CORNER_AT)
        bound, blur = certify_along(pair, pose, place_of(corner), jets_at(pair, pose, corner), n)
        assert blur == 0.0
        assert bound <= exact
        if min(n) >= 0.0:  # in the corner's cone nothing hangs over
            assert bound == pytest.approx(exact, abs=ROUNDOFF)


def test_overhang_is_the_support_of_the_box():
    """e.(y - x) over the box's points y, from its corner (1, 1, 1); noise by the greatest reach."""
    corner = (1.0, 1.0, 1.0)
    assert overhang(INTS, REALS, corner, (0.1, -0.2, 0.0), 0.0) == pytest.approx(0.4, abs=1e-15)
    assert overhang(INTS, REALS, corner, (0.1, 0.2, 0.3), 0.0) == 0.0
    assert overhang(INTS, REALS, corner, NO_HINT, 0.0) == 0.0
    assert overhang(INTS, REALS, corner, NO_HINT, 1e-3) == pytest.approx(6e-3, abs=1e-17)
    plane = so.shapes.halfspace()
    assert overhang(plane.ints, plane.reals, corner, (1e-9, 0.0, 0.0), 0.0) == math.inf


def test_between_is_the_nearest_of_the_cone():
    x, z = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
    assert between(unit(1, 2, 2), x, z) == pytest.approx(unit(1, 0, 2), abs=1e-15)
    # one that leans along the edge is left as long as it is
    assert between(unit(1, 5, 2), x, z) == pytest.approx(np.array((1, 0, 2)) / 30**0.5, abs=1e-15)
    assert between(unit(-1, 0, 0.1), x, z) == z
    assert between(unit(0.1, 0, -1), x, z) == x
    assert between(unit(0, 1, 1), z, z) == z


def leaning(t, angle, rng):
    """A unit vector at an angle to the unit vector t."""
    square = np.cross(t, rng.normal(size=3))
    square /= np.linalg.norm(square)
    n = math.cos(angle) * np.asarray(t) + math.sin(angle) * square
    return tuple(map(float, n * rng.choice([1.0 - 2e-16, 1.0, 1.0 + 2e-16])))


@pytest.mark.parametrize("opening", [1e-7, 1e-4, 0.1, 1.0, 3.0, 3.14])
def test_no_member_of_a_cone_leans_along_its_edge(opening, rng):
    """Whatever n is: the product with the edge is roundoff, so are those with what is behind."""
    for _ in range(200):
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        a, t = turn[:, 0], turn[:, 2]
        b = math.cos(opening) * a + math.sin(opening) * turn[:, 1]
        angle = 10.0 ** rng.uniform(-17.0, 0.0)
        m = np.array(between(leaning(t, angle, rng), tuple(map(float, a)), tuple(map(float, b))))
        assert abs(m @ t) < 2e-15
        assert np.linalg.norm(m) < 1.0 + 1e-15
        # past neither face's normal: no farther than roundoff in front of what is behind both
        inward_a, inward_b = np.cross(t, a), np.cross(b, t)
        if opening < 3.1:
            inward_a = inward_a * np.sign(inward_a @ b)
            inward_b = inward_b * np.sign(inward_b @ a)
            assert min(m @ inward_a, m @ inward_b) > -4e-15


def test_an_end_and_a_segment_have_no_normal_along_them(rng):
    segment = so.shapes.segment(start=[0.3, -0.2, 0.1], end=[1.1, 0.7, -0.4])
    ints, reals = segment.ints, segment.reals
    t = np.array([0.8, 0.9, -0.5]) / np.linalg.norm([0.8, 0.9, -0.5])
    for _ in range(300):
        n = leaning(t * rng.choice([-1.0, 1.0]), 10.0 ** rng.uniform(-17.0, 0.0), rng)
        cone = edge_cone(ints, reals, 0, 0.5, tuple(map(float, t)))
        m, noise = nearest_normal(ints, reals, 0, cone, n)
        assert abs(np.array(m) @ t) < 2e-15
        assert noise == 0.0
        # the first end: what is outward there falls along the segment
        assert np.array(vertex_cone(ints, reals, 1, n)) @ t < 2e-15


def test_cones_of_an_edge_and_a_corner():
    """The edge's: between +x and +z; the corner's: the octant, or its face or edge nearest by."""
    for n, nearest in ((unit(1, 3, 3), unit(1, 0, 3)), (unit(-1, 0, 1), (0.0, 0.0, 1.0))):
        cone = edge_cone(INTS, REALS, EDGE, 0.5, ALONG_EDGE)
        near, noise = nearest_normal(INTS, REALS, EDGE, cone, n)
        assert near == pytest.approx(nearest, abs=1e-15)
        assert noise == 0.0
    inside = unit(1, 2, 3)
    for n, nearest in (
        (inside, inside),
        (unit(-1, 2, 3), unit(0, 2, 3)),
        (unit(-1, -2, 3), (0.0, 0.0, 1.0)),
    ):
        assert vertex_cone(INTS, REALS, CORNER, n) == pytest.approx(nearest, abs=1e-15)
