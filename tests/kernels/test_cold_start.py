"""The global start: each kind of start by brute force over the samples, and where a query ends."""

import math

import numpy as np
import pytest
from hand_made import new_work
from hand_made_pairs import (
    Placed,
    X,
    Z,
    ball,
    box,
    ellipsoid,
    half_space,
    packed,
    point,
    point_at,
    turn,
    unit,
)

import standoff as so
from draws import draws
from standoff.kernels.body import layout as L
from standoff.kernels.pair.certified import (
    CERTIFIED,
    TOUCHING_OR_OVERLAPPING,
    UNCERTIFIED,
    settle_and_weigh,
)
from standoff.kernels.pair.cold_start import (
    FIRST,
    MAX_STARTS,
    alternating,
    at_sample,
    at_samples,
    farthest_along,
    gilbert,
    global_query,
    nearest_facing,
    nearest_to,
    sample_normal,
    sample_point,
    support_sample,
)
from standoff.kernels.pair.events import EVALUATIONS, LIMIT, RESTARTS
from standoff.kernels.values import ORIGIN, Side, resting, side_of

TOLERANCE = 1e-10
TURN = turn((1, 2, 3), 0.9)
EGGS = Placed(ellipsoid(1.0, 0.8, 0.6), ellipsoid(0.3, 0.7, 0.5), (1.2, 0.7, 1.1), TURN)
BOXES = Placed(box(1.0, 0.8, 0.6), box(0.3, 0.4, 0.5), (1.5, 0.9, 1.3), TURN)
CASES = [EGGS, BOXES]


def samples(body):
    """(points, normals) of a body's samples, (n, 3) each, by its layout."""
    o, n = body.ints[L.SAMPLE_REALS], body.ints[L.N_SAMPLES]
    rows = body.reals[o : o + L.SAMPLE_STRIDE * n].reshape(n, L.SAMPLE_STRIDE)
    return rows[:, :3], rows[:, 3:6]


def in_a(case, rows, moved=True):
    """B's points (or its directions) in A's frame."""
    return rows @ np.array(case.R).reshape(3, 3).T + (np.array(case.p) if moved else 0.0)


@pytest.mark.parametrize("body", [EGGS.a.body, BOXES.a.body, so.shapes.cylinder(0.5, 1.0)])
def test_samples_stand_on_their_features(body):
    points, normals = samples(body)
    for k in range(body.ints[L.N_SAMPLES]):
        side = at_sample(*packed(body), k)
        assert sample_point(*packed(body), k) == tuple(points[k])
        assert sample_normal(*packed(body), k) == tuple(normals[k])
        np.testing.assert_allclose(point_at(body, side), points[k], atol=1e-14)
        on_face = side.feature < body.n_faces
        assert np.linalg.norm(normals[k]) == pytest.approx(1.0 if on_face else 0.0)


def test_an_egg_s_sample_normals_are_outward():
    points, normals = samples(EGGS.a.body)
    gradient = points / np.array([1.0, 0.64, 0.36])
    gradient /= np.linalg.norm(gradient, axis=1)[:, None]
    np.testing.assert_allclose(normals, gradient, atol=1e-14)


@pytest.mark.parametrize("n", [X, Z, unit(1, 2, 3), unit(-1, 1, -2)])
def test_the_samples_farthest_along_a_direction(n):
    for case in CASES:
        of_a, of_b = samples(case.a.body)[0], in_a(case, samples(case.b.body)[0])
        k = support_sample(*packed(case.a.body), n)
        assert of_a[k] @ n == pytest.approx((of_a @ n).max(), abs=1e-15)
        i, j = farthest_along(*case.both, n)
        assert i == k
        assert of_b[j] @ n == pytest.approx((of_b @ n).min(), abs=1e-14)


def test_a_place_of_two_samples():
    place = at_samples(BOXES.pair, 7, 11)
    assert side_of(place, 0) == Side(*at_sample(*packed(BOXES.a.body), 7))
    assert side_of(place, 1) == Side(*at_sample(*packed(BOXES.b.body), 11))


def facing(case):
    """(squared distances, do they face each other) of all sampled pairs, (n_a, n_b)."""
    (x, n), (y, m) = samples(case.a.body), samples(case.b.body)
    gap = in_a(case, y)[None, :, :] - x[:, None, :]
    toward_b = np.einsum("ijk,ik->ij", gap, n) >= 0.0
    toward_a = np.einsum("ijk,jk->ij", gap, in_a(case, m, moved=False)) <= 0.0
    return (gap**2).sum(axis=2), toward_a & toward_b


def test_the_nearest_pair_that_face_each_other():
    for case in (*CASES, EGGS.at(0.7, 0.3, 0.4), EGGS.at(0.3, 0.8, 0.2), BOXES.at(0.9, 0.5, 0.4)):
        far, faces = facing(case)
        assert faces.any()
        i, j = nearest_facing(*case.both)
        assert faces[i, j]
        assert far[i, j] == pytest.approx(far[faces].min(), rel=1e-12)


def test_where_no_samples_face_each_other_the_first_are_told():
    """Concentric balls, one in the other."""
    case = Placed(ball(1.0), ball(0.7), (0.01, 0.0, 0.0))
    assert not facing(case)[1].any()
    assert nearest_facing(*case.both) == (0, 0)


def test_the_nearest_sample_to_a_point_that_it_faces():
    points, normals = samples(EGGS.a.body)
    for z, normal in (
        ((2.0, 1.0, 0.5), ORIGIN),
        ((0.0, 0.0, 0.9), ORIGIN),
        ((2.0, 1.0, 0.5), unit(1, 1, 0)),
    ):
        gap = np.array(z) - points
        seen = (np.einsum("ij,ij->i", gap, normals) >= 0.0) & (gap @ normal <= 0.0)
        far = np.where(seen, (gap**2).sum(axis=1), np.inf)
        k = nearest_to(*packed(EGGS.a.body), z, normal)
        if seen.any():
            assert far[k] == pytest.approx(far.min(), rel=1e-12)
        else:
            assert k == 0
    # with an outward normal away from the body no sample faces the point
    assert nearest_to(*packed(EGGS.a.body), (2.0, 0.0, 0.0), X) == 0


def test_alternating_samples_are_each_the_nearest_to_the_other(rng):
    ways = rng.normal(size=(draws(30), 3))
    cases = [case.at(*(2.5 * np.array(unit(*n)))) for n in ways for case in (EGGS, BOXES)]
    for case in cases:
        i, j = alternating(*case.both)
        far, faces = facing(case)
        assert faces[i, j]
        assert far[i, j] == pytest.approx(far[faces[:, j], j].min(), rel=1e-12)
        assert far[i, j] == pytest.approx(far[i, faces[i]].min(), rel=1e-12)
        # and in these cases the nearest of all
        assert far[i, j] <= far[faces].min() * 1.5


@pytest.mark.parametrize("case", [*CASES, EGGS.at(0.0, 0.0, -2.0), BOXES.at(-2.0, 0.1, 0.2)])
def test_gilbert_s_direction_is_that_of_the_nearest_points(case):
    """Of the samples' hulls: between the distance and what the direction's own plane shows."""
    w = gilbert(*case.both)
    x, y = samples(case.a.body)[0], in_a(case, samples(case.b.body)[0])
    n = np.array(unit(*w))
    separation = (y @ n).min() - (x @ n).max()
    assert 0.0 < separation <= np.linalg.norm(w) + 1e-12
    assert np.linalg.norm(w) - separation < 0.02 * case.size


def test_gilbert_s_direction_of_points_is_exact():
    case = Placed(point(), point(0.5), (0.3, -0.4, 1.2))
    assert gilbert(*case.both) == pytest.approx((0.3, -0.4, 1.2))


def query(case, first=FIRST, tolerance=TOLERANCE, work=None):
    work = work or new_work()
    return global_query(*case.both, first, tolerance, work), work


@pytest.mark.parametrize("gap", [3.0, 0.3, 1e-3, 1e-9])
@pytest.mark.parametrize("n", [X, Z, unit(1, 2, 3), unit(-1, 0.3, -2)])
def test_two_balls_are_found_at_the_first_start(gap, n):
    case = Placed(ball(1.0), ball(0.7), tuple(float(x) for x in (1.7 + gap) * np.array(n)), TURN)
    found, work = query(case)
    assert found.outcome == CERTIFIED
    assert found.distance == pytest.approx(gap, abs=1e-12)
    assert found.lower <= gap
    assert found.upper == found.distance
    assert work.counts[RESTARTS] == 0
    np.testing.assert_allclose(case.gap(found.place), gap * np.array(n), atol=1e-7)


@pytest.mark.parametrize("first", range(MAX_STARTS))
def test_every_start_leads_to_the_nearest_points(first):
    """Each but the first is a restart; later ones begin along no direction, and any will do."""
    for case in (EGGS, BOXES):
        found, work = query(case, first)
        assert found.outcome == CERTIFIED
        n = found.normal
        assert found.distance == pytest.approx(-case.depth(n), abs=1e-10)
        assert case.rises_around(n)
        assert work.counts[RESTARTS] >= (1 if first else 0)


def test_drawn_pairs_apart_have_their_distance(rng):
    """The greatest -s(n), which the separation along the normal found shows to be it."""
    solids = [EGGS.a, EGGS.b, BOXES.a, BOXES.b]
    for _ in range(draws(40)):
        a, b = (solids[rng.integers(4)] for _ in range(2))
        R = turn(rng.normal(size=3).tolist(), float(rng.uniform(0.0, 3.0)))
        n = np.array(unit(*rng.normal(size=3)))
        here = Placed(a, b, (0.0, 0.0, 0.0), R)
        p = (here.depth(n) + 10.0 ** rng.uniform(-6, 1)) * n
        case = here.at(*p)
        found, _ = query(case)
        assert found.outcome == CERTIFIED
        assert found.distance == pytest.approx(-case.depth(found.normal), abs=1e-9)
        assert found.distance >= -case.depth(n) - 1e-12
        assert found.lower <= found.distance


def test_overlapping_bodies_are_not_certified():
    for case in (EGGS.at(0.3, 0.2, 0.1), BOXES.at(0.3, 0.2, 0.1)):
        found, work = query(case)
        assert found.outcome in (UNCERTIFIED, TOUCHING_OR_OVERLAPPING)
        assert found.lower <= 0.0
        if found.outcome == UNCERTIFIED:
            assert work.counts[RESTARTS] >= MAX_STARTS - 1


def test_of_uncertified_starts_the_one_of_the_least_gap_is_told():
    """A tolerance below any: it is as good as certified all the same."""
    found, work = query(EGGS, tolerance=-1.0)
    assert found.outcome == UNCERTIFIED
    assert work.counts[RESTARTS] == MAX_STARTS - 1
    assert found.distance - found.lower < 1e-12
    assert EGGS.rises_around(found.normal)


def test_a_start_that_is_cut_off_does_not_take_the_place_of_a_better_one():
    """The first descent ends with nothing between distance and bound; one evaluation is left."""
    first = new_work()
    start = at_samples(EGGS.pair, *alternating(*EGGS.both))
    settle_and_weigh(EGGS.pair, resting(EGGS.pose), start, 0.0, 0.0, -1.0, first)
    work = new_work()
    work.counts[LIMIT] = first.counts[EVALUATIONS] + 1
    found, _ = query(EGGS, tolerance=-1.0, work=work)
    assert work.counts[RESTARTS] == 1
    assert found.distance - found.lower < 1e-12


@pytest.mark.parametrize("limit", [0, 1, 2])
def test_cut_off_it_tells_what_it_has(limit):
    work = new_work()
    work.counts[LIMIT] = limit
    found, _ = query(EGGS, work=work)
    assert work.counts[EVALUATIONS] <= limit
    assert work.counts[RESTARTS] == 0
    true = -EGGS.least_depth()
    assert found.lower <= true + 1e-12
    assert found.distance >= true - 1e-12


def test_over_a_half_space():
    case = Placed(half_space(Z, 0.3), ellipsoid(1.0, 0.8, 0.6), (50.0, -20.0, 3.0), TURN)
    found, _ = query(case)
    assert found.outcome == CERTIFIED
    assert found.normal == pytest.approx(Z, abs=1e-12)
    m = np.array(TURN).reshape(3, 3).T @ np.array(Z)
    expected = 3.0 - 0.3 - math.sqrt(((np.array([1.0, 0.8, 0.6]) * m) ** 2).sum())
    assert found.distance == pytest.approx(expected, abs=1e-12)
