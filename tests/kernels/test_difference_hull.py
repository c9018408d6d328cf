"""The polytope inside the difference of two bodies: cubes, cross-polytopes and random points.

The radius of the ball about the origin inside it is that of closed forms, and of SciPy's hulls.
"""

import math
from itertools import product

import numpy as np
import pytest
from hull_making import SIZE, alone, assert_closed, hull_of, rows, seeded
from scipy.spatial import ConvexHull

from draws import draws
from standoff.kernels.depth.difference_hull import (
    BROKEN,
    FACETS,
    GREW,
    NO_GAIN,
    POINTS,
    add_facet,
    begin_hull,
    close_facet,
    exact_height,
    facet_normal,
    farthest_from,
    grow,
    grow_difference,
    horizon,
    nearest_facet,
)
from standoff.kernels.tolerances import PRISM

CUBE = np.array(list(product((-1.0, 1.0), repeat=3)))
CROSS = np.vstack([np.eye(3), -np.eye(3)])


@pytest.mark.parametrize(("points", "facets", "radius"), [(CUBE, 12, 1.0), (CROSS, 8, 3**-0.5)])
def test_a_hull_of_points(points, facets, radius):
    hull, solid, _ = seeded(points)
    assert solid
    assert hull.sizes[FACETS] == facets
    assert_closed(hull)
    at, offset = nearest_facet(hull, False)
    assert radius - 1e-13 <= offset <= radius
    assert np.linalg.norm(facet_normal(hull, at)) == pytest.approx(1.0, abs=1e-15)


def test_it_grows_by_points_outside_alone():
    hull, _, _ = seeded(CUBE)
    assert grow(hull, alone((0.5, 0.5, 0.9)), SIZE) == NO_GAIN
    assert grow(hull, alone((0.3, -0.2, 1.0)), SIZE) == NO_GAIN  # in a facet
    assert hull.sizes[FACETS] == 12
    before = hull.sizes[POINTS]
    assert grow(hull, alone((0.0, 0.0, 2.0)), SIZE) == GREW
    assert (hull.sizes[POINTS], hull.sizes[FACETS]) == (before + 1, 14)
    assert_closed(hull)
    assert nearest_facet(hull, False)[1] == pytest.approx(1.0, abs=1e-13)
    for x in CROSS * 2.0:
        grow(hull, alone(x), SIZE)
    # every side of the cube is raised: its edges are now ridges in line with pairs of peaks
    assert nearest_facet(hull, False)[1] == pytest.approx(math.sqrt(2.0), abs=1e-13)


@pytest.mark.parametrize("number", range(draws(4)))
def test_random_points_have_the_radius_of_another_hull(number):
    points = np.random.default_rng(number).normal(size=(40, 3))
    hull, solid, _ = seeded(points[:8], size=10.0)
    assert solid
    for x in points[8:]:
        assert grow(hull, alone(x), 10.0) != BROKEN
    assert_closed(hull)
    other = ConvexHull(points)
    assert nearest_facet(hull, False)[1] == pytest.approx(-other.equations[:, 3].max(), abs=1e-12)
    assert hull.sizes[FACETS] == len(other.simplices)


@pytest.mark.parametrize(
    "points",
    [
        CUBE[CUBE[:, 2] > 0.0],
        np.outer(np.linspace(-1.0, 2.0, 5), [1.0, 2.0, -0.5]),
        np.ones((3, 3)),
    ],
)
def test_flat_points_give_a_direction_square_to_them(points):
    hull, solid, way = seeded(points)
    assert not solid
    assert np.linalg.norm(way) == pytest.approx(1.0, abs=1e-15)
    np.testing.assert_allclose((points - points[0]) @ way, 0.0, atol=1e-14)
    assert hull.sizes[FACETS] == 0


def test_a_planar_pair_s_hull_is_a_prism():
    """A square grows to a greater one, turned; the prism's ends bound nothing."""
    square = [(x, y) for x in (-1.0, 1.0) for y in (-1.0, 1.0)]
    points = np.array([(x, y, z) for x, y in square for z in (-PRISM * SIZE, PRISM * SIZE)])
    hull, solid, _ = seeded(points, planar=1)
    assert solid
    assert nearest_facet(hull, False)[1] == pytest.approx(1.0, abs=1e-13)
    assert grow_difference(hull, alone((0.5, 0.5, 0.0)), SIZE) == NO_GAIN
    before = hull.sizes[POINTS]
    assert grow_difference(hull, alone((3.0, 0.0, 0.0)), SIZE) == GREW
    assert hull.sizes[POINTS] == before + 2
    assert_closed(hull)
    for x in ((-3.0, 0.0, 0.0), (0.0, 3.0, 0.0), (0.0, -3.0, 0.0)):
        assert grow_difference(hull, alone(x), SIZE) == GREW
    # the square is now inside |x| + |y| = 3
    assert nearest_facet(hull, False)[1] == pytest.approx(3.0 / math.sqrt(2.0), abs=1e-12)


def test_facets_that_are_closed_are_passed_over():
    hull, _, _ = seeded(CROSS)
    first, _ = nearest_facet(hull, False)
    close_facet(hull, first)
    second, offset = nearest_facet(hull, True)
    assert second != first
    assert offset == pytest.approx(3**-0.5, abs=1e-13)
    assert nearest_facet(hull, False)[0] == first
    for m in range(hull.sizes[FACETS]):
        close_facet(hull, m)
    assert nearest_facet(hull, True) == (-1, math.inf)


def test_points_in_line_make_no_facet():
    hull = hull_of(np.outer([0.0, 1.0, 2.0], [1.0, 1.0, 0.0]))
    assert not add_facet(hull, 0, 1, 2, SIZE)
    assert hull.sizes[FACETS] == 0


def test_a_rim_in_two_loops_is_none():
    """Two facets without a side in common have no one horizon; two that share one have."""
    corners = np.array([0, 1, 2, 3, 4, 5, 0, 2, 3])
    rim = np.empty(18, dtype=np.int64)
    assert horizon(corners, np.array([0, 1]), 2, rim) == 0
    assert horizon(corners, np.array([0, 2]), 2, rim) == 4
    loop = rim.reshape(-1, 2)[:4].tolist()
    assert [side[1] for side in loop] == [side[0] for side in loop[1:] + loop[:1]]
    assert sorted(map(sorted, loop)) == [[0, 1], [0, 3], [1, 2], [2, 3]]


def test_the_farthest_from_a_point_a_line_and_a_plane():
    points = hull_of([[0.0, 0, 0], [5, 0, 0], [4, 3, 0], [1, 1, 2]]).points
    zero, x, y = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    assert farthest_from(points, 4, 1, zero, zero, zero) == (1, 5.0)
    assert farthest_from(points, 4, 2, zero, x, zero) == (2, 3.0)
    assert farthest_from(points, 4, 3, zero, x, y) == (3, 2.0)


@pytest.mark.parametrize("power", [-16, -14, -12, -11, -10, -9, -8, -6])
def test_an_exact_hull_of_nearly_flush_points_stays_convex(power, rng):
    """A cube's corners and points on its sides and edges, each off by a little: the hull loses no
    more of the cube than that, whatever needles it has, and no point is above a facet of it."""
    off = 10.0**power
    grid = np.array([x for x in product((-1.0, -0.3, 0.2, 1.0), repeat=3) if 1.0 in np.abs(x)])
    points = rng.permutation(grid + off * rng.uniform(-1.0, 1.0, grid.shape))
    hull = hull_of(points[:8], exact=True)
    solid, _ = begin_hull(hull, 8, SIZE)
    assert solid
    for x in points[8:]:
        assert grow(hull, alone(x), SIZE) != BROKEN
    assert_closed(hull)
    at, corners, _ = rows(hull)
    for i, j, k in corners:
        heights = [exact_height(*(tuple(at[m]) for m in (i, j, k)), tuple(x)) for x in points]
        assert max(heights) <= 1e-14
    assert 1.0 - 2.0 * off - 2e-14 <= nearest_facet(hull, False)[1] <= 1.0 + 2.0 * off
