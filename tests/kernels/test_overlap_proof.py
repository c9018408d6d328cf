"""The proof that two bodies overlap: true of all that it names, and it names all that there is.

Distances are known by construction from support points, or by whole numbers on a lattice. What a
linear program proves of the same bodies (``oracles.overlap``) is to be proven too.
"""

import math
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hull_making import rows, seeded

import standoff as so
from draws import draws
from families import penetrating, shapes
from families.degenerate import KINDS as DEGENERATE
from families.degenerate import partner
from families.penetrating import KINDS
from oracles.exact_pairs import exact_pair, random_normal, random_rotation
from oracles.overlap import hulls_meet
from standoff.kernels.depth import overlap
from standoff.kernels.depth.difference_hull import facet_normal
from standoff.kernels.pair import events as N
from standoff.kernels.pair.certified import CERTIFIED, OVERLAP, UNCERTIFIED
from standoff.kernels.values import Found, Pair, Place, Pose, Work
from standoff_studies.soak import any_places
from standoff_studies.soak.known_gaps import draw_scene

VERTICES = Place(*[np.int64(0)] * 4, 0.0, 0.0, 0.0, 0.0)
"""Of bodies whose first feature is a vertex; of others a place like any other."""
REACHED = 3e-11
"""Depths, over the pair's size, from which on an overlap is found: COPLANAR, three times."""
CUBE = so.shapes.box(2.0, 2.0, 2.0)
POINT, HOME = so.shapes.point(), (np.eye(3), np.zeros(3))


def seen_from_a(pose_a, pose_b):
    """B's pose in A's frame."""
    (Ra, pa), (Rb, pb) = pose_a, pose_b
    return Pose(tuple((Ra.T @ Rb).ravel().tolist()), tuple((Ra.T @ (pb - pa)).tolist()))


def work_of(counts):
    log = np.zeros(N.MAX_EVENTS * N.EVENT_COLUMNS)
    return Work(counts, log, log, log)


def proven(a, b, pose_a, pose_b, place=VERTICES, counts=None):
    pair = Pair(a.ints, a.reals, b.ints, b.reals)
    work = work_of(N.new_counts() if counts is None else counts)
    return overlap.overlap_proven(pair, seen_from_a(pose_a, pose_b), place, work)


def at(*position):
    return np.eye(3), np.array(position, dtype=float)


def bounds(pair, a, b):
    """What the bodies of an exact pair are apart by, at least, and their cores at most: exactly,
    where they are apart along the normal by which they were placed; else, as they may be apart
    along another, by the certificates of a query."""
    if pair.distance > 0.0:
        return pair.distance, pair.distance + a.radius + b.radius
    answer = so.distance(a, b, pair.pose_a, pair.pose_b)
    return answer.lower_bound, answer.upper_bound + a.radius + b.radius


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_apart_is_never_named_and_what_overlaps_is(kind):
    """Gaps and depths down to 1e-15 of the size, of every kind of bodies."""
    rng, named = np.random.default_rng(3), 0
    for number in range(draws(40)):
        a, b = penetrating.bodies(kind, 3, number // penetrating.PER_PAIR)
        size = a.body.size + b.body.size
        depth = float(rng.choice([-1.0, 1.0])) * 10.0 ** rng.uniform(-15.0, -1.0)
        pair = exact_pair(a.shape, b.shape, -depth * size, rng)
        least, most = bounds(pair, a.body, b.body)
        if proven(a.body, b.body, pair.pose_a, pair.pose_b):
            assert least < 0.0
            named += 1
        else:
            assert most > -REACHED * size
    assert named > 0


@pytest.mark.parametrize("kind", DEGENERATE)
def test_degenerate_bodies(kind):
    """Thin ones, short edges, flat points and poles; half-spaces, balls and points beside them."""
    rng = np.random.default_rng(5)
    for number in range(draws(12)):
        levels = DEGENERATE[kind].levels
        try:
            a = DEGENERATE[kind].make(rng, levels[number % len(levels)])
        except so.BodyError:
            continue
        b = partner(rng, a)
        size = sum(x.body.size + x.body.radius for x in (a, b) if x.body.bounded)
        depth = 10.0 ** rng.uniform(-13.0, -2.0) * float(rng.choice([-1.0, 1.0]))
        pair = exact_pair(a.shape, b.shape, -depth * size, rng)
        either = (
            proven(a.body, b.body, pair.pose_a, pair.pose_b),
            proven(b.body, a.body, pair.pose_b, pair.pose_a),
        )
        assert not any(either) or bounds(pair, a.body, b.body)[0] < 0.0


@pytest.mark.parametrize("kind", KINDS)
def test_what_a_linear_program_proves_is_proven(kind):
    rng, both = np.random.default_rng(8), 0
    for number in range(draws(24)):
        a, b = penetrating.bodies(kind, 3, number // 4)
        if a.body.radius > 0.0 or b.body.radius > 0.0:
            continue  # the oracle's shapes are swept, the polytope is of cores
        size = a.body.size + b.body.size
        pair = exact_pair(a.shape, b.shape, -size * 10.0 ** rng.uniform(-9.0, -1.0), rng)
        if hulls_meet(pair.a, pair.b):
            both += 1
            assert proven(a.body, b.body, pair.pose_a, pair.pose_b)
    assert both > 0


@pytest.mark.parametrize("kind", ["ellipsoids", "polytopes", "cones", "mixed"])
def test_anywhere_and_far_from_the_origin(kind):
    """Any poses, near and far from the world's origin, deep and apart, about any centre."""
    rng = np.random.default_rng(13)
    for number in range(draws(30)):
        a, b = penetrating.bodies(kind, 7, number // penetrating.PER_PAIR)
        size = a.body.size + b.body.size
        place = size * 10.0 ** rng.uniform(-2.0, 4.0) * random_normal(rng)
        way = size * rng.uniform(0.0, 0.8) * random_normal(rng)
        pose_a, pose_b = (random_rotation(rng), place), (random_rotation(rng), place + way)
        answer = so.distance(a.body, b.body, pose_a, pose_b)
        if proven(a.body, b.body, pose_a, pose_b):
            assert answer.lower_bound < 0.0
        else:
            assert answer.upper_bound + a.body.radius + b.body.radius > -1e-9 * size


def test_on_a_lattice_and_of_known_gaps():
    """The soak's pairs, whose distances are exact or by construction; any place on their features,
    and any orientation of the pair."""
    named = 0
    for number in range(draws(80)):
        rng = np.random.default_rng(number)
        scene = draw_scene(rng, 11, number // 20)
        a, b = scene.a.body, scene.b.body
        pose_a, pose_b = (
            (x[:9].reshape(3, 3), x[9:]) for x in (np.array(scene.pose_a), np.array(scene.pose_b))
        )
        size = sum(x.size + x.radius for x in (a, b) if x.bounded) + math.dist(pose_a[1], pose_b[1])
        for _ in range(4):
            side_a = any_places.any_side(a.ints, a.reals, rng.random(8))
            side_b = any_places.any_side(b.ints, b.reals, rng.random(8))
            place = Place(
                side_a.feature, side_a.chart, side_b.feature, side_b.chart,
                float(side_a.p), float(side_a.q), float(side_b.p), float(side_b.q),
            )  # fmt: skip
            found = proven(a, b, pose_a, pose_b, place)
            assert not found or scene.truth < 0.0
            if a.bounded and b.bounded and scene.truth + a.radius + b.radius < -1e-9 * size:
                assert found
        named += found
    assert named > 0


def test_points_and_segments():
    """A - B of two segments has no inside: nothing is proven of it. Of a segment and a box it has
    one."""
    rod = so.shapes.capsule(0.5, 2.0)
    line = so.Body.from_brep(rod.vertex_points, rod.edge_parts, name="line")
    across = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    assert not proven(line, line, HOME, (across, np.zeros(3)))
    assert not proven(line, line, HOME, HOME)
    assert not proven(POINT, POINT, HOME, HOME)
    assert not proven(POINT, line, HOME, HOME)
    for body in (line, POINT):
        for pose in (HOME, at(0.3, -0.99, 0.2), at(0.0, 0.0, 1.0 - 1e-10)):
            assert proven(CUBE, body, HOME, pose)
            assert proven(body, CUBE, pose, HOME)
        assert not proven(CUBE, body, HOME, at(1.0, 0.0, 0.0))
        assert not proven(CUBE, body, HOME, at(1.0 + 1e-12, 0.0, 0.0))


@pytest.mark.parametrize("depth", [1e-1, 1e-6, 1e-10, 0.0, -1e-12])
def test_swept_radii_count_where_points_are_nearer_than_they_are(depth):
    """Two balls, whose cores are points, and two rounded boxes on their vertices."""
    ball, swept = so.shapes.sphere(0.5), so.shapes.box(2.0, 2.0, 2.0, 0.5)
    pose = at(1.0 - depth, 0.0, 0.0)
    assert proven(ball, ball, HOME, pose) is (depth > 0.0)
    # vertex 3 of the rounded box: the core is a cube of half that size
    assert proven(swept, swept, HOME, at(2.0 - depth, 0.0, 0.0)) is False
    assert proven(swept, ball, HOME, at(0.2, 0.1, 0.2)) is True


@pytest.mark.parametrize("depth", [1.0, 1e-6, 1e-11, 1e-13, 0.0, -1e-12, -1e-3])
@pytest.mark.parametrize("swept", [False, True])
def test_half_spaces(depth, swept):
    """Just inside a tilted half-space, and just outside, of either body."""
    normal, offset = np.array([1.0, 2.0, 2.0]) / 3.0, 0.7
    wall = so.shapes.halfspace(normal, offset)
    body = so.shapes.sphere(0.5) if swept else so.shapes.ellipsoid(0.5, 0.5, 0.5)
    there = np.eye(3), (offset + 0.5 - depth) * normal + np.array([0.0, 1.0, -1.0])
    assert proven(wall, body, HOME, there) is (depth >= 1e-11)
    assert proven(body, wall, there, HOME) is (depth >= 1e-11)


def test_a_point_in_a_planar_body():
    rng = np.random.default_rng(2)
    for _ in range(draws(10)):
        loop = shapes.loop(rng)
        turn, place = random_rotation(rng, True), np.array([*rng.normal(size=2), 0.0])
        corner = turn @ loop.body.vertex_points[0] + place
        for way, inside in ((1e-9, False), (0.0, False), (-1e-9, True), (-0.1, True)):
            point = np.eye(3), place + (1.0 + way) * (corner - place)
            assert proven(loop.body, POINT, (turn, place), point) is inside
            assert proven(POINT, loop.body, point, (turn, place)) is inside


def test_the_bodies_own_slack_is_left():
    """A sewn body whose surfaces are known to 1e-3 only: less than that is no overlap."""
    slack = np.array([float(x == 2) for x in range(len(CUBE.reals))])
    loose = Pair(CUBE.ints, CUBE.reals + 1e-3 * slack, CUBE.ints, CUBE.reals + 1e-3 * slack)
    for depth, expected in ((1.9e-3, False), (2.1e-3, True), (1e-9, False)):
        pose = seen_from_a(HOME, at(2.0 - depth, 0.1, 0.2))
        work = work_of(N.new_counts())
        assert overlap.overlap_proven(loose, pose, VERTICES, work) is expected


def test_a_deadline_ends_it_and_switches_are_not_counted():
    balls = so.shapes.ellipsoid(1.0, 0.9, 0.8), so.shapes.ellipsoid(0.9, 1.0, 0.8)
    pair = exact_pair(
        shapes.oracle.Ellipsoid(1.0, 0.9, 0.8),
        shapes.oracle.Ellipsoid(0.9, 1.0, 0.8),
        -1e-6,
        np.random.default_rng(1),
    )
    counts = N.new_counts()
    assert proven(*balls, pair.pose_a, pair.pose_b, counts=counts)
    needed = int(counts[N.EVALUATIONS])
    assert needed > 10
    assert (counts[N.SEARCHES], counts[N.EVENTS]) == (1, 0)
    for limit in (0, 1, needed // 2):
        counts = N.new_counts()
        counts[N.LIMIT] = limit
        assert not proven(*balls, pair.pose_a, pair.pose_b, counts=counts)
        assert counts[N.EVALUATIONS] <= limit


@pytest.mark.parametrize(
    ("outcome", "lower", "named"),
    [
        (UNCERTIFIED, -1.0, True),
        (UNCERTIFIED, -math.inf, True),
        (UNCERTIFIED, math.nan, True),
        (UNCERTIFIED, 1e-9, False),  # known to be apart
        (CERTIFIED, -1.0, False),
    ],
)
def test_what_nothing_is_known_of_is_looked_at(outcome, lower, named):
    """Cubes 0.1 deep; their outcome alone is changed."""
    pair = Pair(CUBE.ints, CUBE.reals, CUBE.ints, CUBE.reals)
    found = Found(outcome, VERTICES, 0.3, lower, 0.3, (1.0, 0.0, 0.0))
    pose = seen_from_a(HOME, at(1.9, 0.0, 0.0))
    decided = overlap.with_overlap(pair, pose, found, work_of(N.new_counts()))
    assert decided.outcome == (OVERLAP if named else outcome)
    np.testing.assert_equal(decided[1:], found[1:])
    apart = seen_from_a(HOME, at(2.1, 0.0, 0.0))
    assert overlap.with_overlap(pair, apart, found, work_of(N.new_counts())).outcome == outcome


def nearest_by_brute_force(points):
    """The point of a hull nearest to the origin: on its corners, segments and triangles."""
    best = min(points, key=np.linalg.norm)
    for i, j, k in product(range(len(points)), repeat=3):
        if not i < j < k:
            continue
        a, u, v = points[i], points[j] - points[i], points[k] - points[i]
        system = np.array([[u @ u, u @ v], [u @ v, v @ v]])
        if np.linalg.det(system) > 1e-12:
            s, t = np.linalg.solve(system, [-a @ u, -a @ v])
            if s >= 0.0 and t >= 0.0 and s + t <= 1.0:
                best = min(best, a + s * u + t * v, key=np.linalg.norm)
        for p, q in ((i, j), (j, k), (i, k)):
            way = points[q] - points[p]
            s = np.clip(-points[p] @ way / (way @ way), 0.0, 1.0)
            best = min(best, points[p] + s * way, key=np.linalg.norm)
    return best


@pytest.mark.parametrize("number", range(draws(8)))
def test_the_way_out_of_a_polytope(number):
    """From the nearest point of a polytope that does not hold the origin towards it; in one that
    holds it, the nearest facet's normal."""
    rng = np.random.default_rng(number)
    points = rng.normal(size=(8, 3)) + np.array([0.0, 0.0, 2.5])
    hull, solid, _ = seeded(points)
    assert solid
    nearest = nearest_by_brute_force(points)
    way = overlap.way_out(hull, 4.0)
    if np.linalg.norm(nearest) > 1e-6:
        np.testing.assert_allclose(way, -nearest / np.linalg.norm(nearest), atol=1e-9)
    hull, _, _ = seeded(points - points.mean(axis=0))
    _, corners, facets = rows(hull)
    del corners
    assert overlap.way_out(hull, 4.0) == facet_normal(hull, int(facets[:, 3].argmin()))


@pytest.mark.parametrize("kind", ["ellipsoids", "polytopes", "lenses", "cylinders", "cones"])
@pytest.mark.parametrize("level", [-2.0, -6.0, -10.0])
def test_the_ball_that_a_polytope_is_said_to_hold_is_in_it(kind, level):
    """By exact sums: every facet of the hull that ends a proof is beyond the margin."""
    rng, most = np.random.default_rng(1), math.inf
    a, b = penetrating.bodies(kind, 3, 0)
    size = a.body.size + b.body.size
    while most > -REACHED * size:
        pair = exact_pair(a.shape, b.shape, -size * 10.0**level, rng)
        most = bounds(pair, a.body, b.body)[1]
    kernel_pair = Pair(a.body.ints, a.body.reals, b.body.ints, b.body.reals)
    pose = seen_from_a(pair.pose_a, pair.pose_b)
    hull, _, _ = seeded(np.zeros((1, 3)))
    assert overlap.seed_hull(kernel_pair, pose, hull, overlap.contact_scale(kernel_pair))[0]
    margin = overlap.proof_margin(kernel_pair, pose)
    assert overlap.grows_about(kernel_pair, pose, hull, margin, work_of(N.new_counts()))
    points, corners, _ = rows(hull)
    for i, j, k in corners.tolist():
        x, y, z = ([Fraction(t) for t in points[m].tolist()] for m in (i, j, k))
        u, v = ([q - p for p, q in zip(x, w, strict=True)] for w in (y, z))
        n = [
            u[1] * v[2] - u[2] * v[1],
            u[2] * v[0] - u[0] * v[2],
            u[0] * v[1] - u[1] * v[0],
        ]
        height = sum(p * q for p, q in zip(n, x, strict=True))
        assert height > 0
        assert height**2 >= Fraction(margin) ** 2 * sum(p * p for p in n)
