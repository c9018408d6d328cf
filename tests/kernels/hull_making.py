"""Polytopes in arrays, for tests of what grows and keeps them."""

import numpy as np

from standoff.kernels.depth.difference_hull import (
    ALL_CORNERS,
    ALL_FACETS,
    ALL_POINTS,
    ALL_RIMS,
    FACET_REALS,
    FACETS,
    MAX_FACETS,
    N_SIZES,
    POINT_REALS,
    POINTS,
    Hull,
    Vertex,
    begin_hull,
    empty_hull,
    put_vertex,
)

SIZE = 4.0
"""Of the bodies that the points are said to come from."""


def seeded(points, planar=0, size=SIZE):
    """(hull, solid, direction) over points."""
    hull = hull_of(points, planar)
    return hull, *begin_hull(hull, len(points), size)


def hull_of(points, planar=0, exact=False):
    """A hull without facets, with points in its arrays."""
    hull = Hull(
        np.zeros(N_SIZES, dtype=np.int64),
        np.full(ALL_POINTS, np.nan),
        np.zeros(ALL_CORNERS, dtype=np.int64),
        np.full(ALL_FACETS, np.nan),
        np.zeros(MAX_FACETS, dtype=np.int64),
        np.zeros(ALL_RIMS, dtype=np.int64),
    )
    empty_hull(hull, planar, exact)
    for k, x in enumerate(np.asarray(points, dtype=float)):
        put_vertex(hull.points, k, alone(x))
    return hull


def alone(x):
    """A vertex that is a point of A, B being the origin."""
    return Vertex(tuple(map(float, x)), tuple(map(float, x)), (0.0, 0.0, 0.0))


def rows(hull):
    """(points, corners, facets) of a hull, a row each."""
    sizes = hull.sizes
    points = hull.points.reshape(-1, POINT_REALS)[: sizes[POINTS], :3]
    corners = hull.corners.reshape(-1, 3)[: sizes[FACETS]]
    return points, corners, hull.facets.reshape(-1, FACET_REALS)[: sizes[FACETS]]


def assert_closed(hull):
    """Every directed side has its reverse once, all points lie below all facets, Euler holds."""
    points, corners, facets = rows(hull)
    sides = [
        (int(corners[m, k]), int(corners[m, (k + 1) % 3]))
        for m in range(len(facets))
        for k in range(3)
    ]
    assert len(set(sides)) == len(sides)
    assert {side[::-1] for side in sides} == set(sides)
    used = {i for side in sides for i in side}
    assert len(used) - len(sides) // 2 + len(facets) == 2
    for m in range(len(facets)):
        heights = (points - points[corners[m, 0]]) @ facets[m, :3]
        assert heights.max() <= 1e-9 * SIZE
