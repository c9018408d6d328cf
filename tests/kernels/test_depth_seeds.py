"""The polytope of seeds: its directions and vertices, needles and flat pairs, overlaps it shows."""

import numpy as np
import pytest
from depth_cases import BOXES, TURNED, drawn, planar, seeded_hull, vertices
from hand_made_pairs import Placed, Solid, X, Z, point, segment, unit
from hull_making import assert_closed, hull_of

import standoff as so
from draws import draws
from standoff.kernels.depth.difference_hull import FACETS, POINT_REALS, facet_normal, nearest_facet
from standoff.kernels.depth.search import SEEDS, overlap_shown, seed, seed_direction
from standoff.kernels.tolerances import PRISM, TOUCHING


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
