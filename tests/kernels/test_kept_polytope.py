"""A closed surface of triangles with the origin below all of them bounds the ball about it.

Vertices move as two bodies carry them, so the surface need not stay convex; the radius that is
claimed is held to the hull of the vertices by another library.
"""

import numpy as np
import pytest
from hull_making import SIZE, alone, assert_closed, hull_of, rows, seeded
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from draws import draws
from standoff.kernels.depth.difference_hull import (
    FACETS,
    OFFSET,
    POINT_REALS,
    Vertex,
    begin_hull,
    grow,
    nearest_facet,
    put_vertex,
)
from standoff.kernels.depth.kept_polytope import keep, recall
from standoff.kernels.pair.polytope_layout import (
    FIRST_FACET,
    FIRST_VERTEX,
    KEPT_POINTS,
    N_FACETS,
    N_POLYTOPE,
    N_VERTICES,
)
from standoff.kernels.values import Pose

IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
CENTRED = Pose(IDENTITY, (0.0, 0.0, 0.0))


def differences(rng, n):
    """(hull, of_a, of_b): a hull over differences of points of two clouds, and these."""
    of_a, of_b = rng.normal(size=(2, n, 3))
    hull = hull_of(of_a - of_b)
    for k in range(n):
        x, y = tuple(of_a[k].tolist()), tuple(of_b[k].tolist())
        put_vertex(hull.points, k, Vertex(tuple((of_a[k] - of_b[k]).tolist()), x, y))
    begin_hull(hull, n, SIZE)
    return hull, of_a, of_b


def moved_too_far(moved_by, pose, kept):
    """Is the origin above some facet of the surface that was kept, by planes found anew?"""
    vertices = kept[FIRST_VERTEX:FIRST_FACET].reshape(-1, 6)
    moved = vertices[:, :3] - (moved_by.apply(vertices[:, 3:]) + pose.p)
    codes = kept[FIRST_FACET : FIRST_FACET + int(kept[N_FACETS])].astype(int)
    i, j, k = (moved[codes >> shift & 63] for shift in (0, 6, 12))
    return (np.einsum("ij,ij->i", i, np.cross(j - i, k - i)) <= 1e-12).any()


@pytest.mark.parametrize("number", range(draws(40)))
def test_the_radius_claimed_is_inside_the_hull_of_the_vertices(number, rng):
    turn, shift = rng.uniform(0.0, 0.8, size=2)
    hull, of_a, of_b = differences(rng, 24)
    kept = np.zeros(N_POLYTOPE)
    keep(hull, kept)
    assert kept[N_VERTICES] > 0.0
    moved_by = Rotation.from_rotvec(turn * rng.normal(size=3) / np.sqrt(3.0))
    pose = Pose(
        tuple(moved_by.as_matrix().ravel().tolist()),
        tuple((shift * rng.normal(size=3) / np.sqrt(3.0)).tolist()),
    )
    if not recall(hull, pose, False, kept, SIZE):
        assert moved_too_far(moved_by, pose, kept)
        return
    _, least = nearest_facet(hull, False)
    assert np.all(rows(hull)[2][:, OFFSET] > 0.0)
    moved = of_a - (moved_by.apply(of_b) + pose.p)
    radius = -ConvexHull(moved).equations[:, 3].max()
    assert 0.0 < least <= radius + 1e-12


def test_unmoved_it_is_the_same_surface(rng):
    before = -1.0
    while before <= 0.0:  # until one is drawn that holds the origin
        hull, _, _ = differences(rng, 24)
        before = nearest_facet(hull, False)[1]
    count = int(hull.sizes[FACETS])
    kept = np.zeros(N_POLYTOPE)
    keep(hull, kept)
    assert recall(hull, CENTRED, False, kept, SIZE)
    assert hull.sizes[FACETS] == count
    assert_closed(hull)
    assert nearest_facet(hull, False)[1] == pytest.approx(before, abs=1e-13)
    once = kept.copy()
    keep(hull, kept)
    np.testing.assert_array_equal(kept, once)


def test_it_is_none_where_the_origin_is_outside():
    hull, solid, _ = seeded([(-1, -1, -1), (1, -1, -1), (0, 1, -1), (0, 0, 1)])
    assert solid
    kept = np.zeros(N_POLYTOPE)
    keep(hull, kept)
    assert recall(hull, CENTRED, False, kept, SIZE)
    away = Pose(IDENTITY, (0.0, 0.0, 3.0))
    assert not recall(hull, away, False, kept, SIZE)


def test_a_surface_turned_inside_out_is_none():
    """All its facets have the origin above them: were signs forgotten it would bound a depth."""
    hull, _, _ = seeded([(-1, -1, -1), (1, -1, -1), (0, 1, -1), (0, 0, 1)])
    kept = np.zeros(N_POLYTOPE)
    keep(hull, kept)
    for m in range(int(hull.sizes[FACETS])):
        code = int(kept[FIRST_FACET + m])
        i, j, k = code & 63, (code >> 6) & 63, code >> 12
        kept[FIRST_FACET + m] = j | i << 6 | k << 12
    assert not recall(hull, CENTRED, False, kept, SIZE)


@pytest.mark.parametrize("more", [0, 1, 30])
def test_too_many_vertices_are_not_kept(more, rng):
    points = rng.normal(size=(KEPT_POINTS + more, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    hull, _, _ = seeded(points[:10])
    kept = np.ones(N_POLYTOPE)
    for x in points[10:]:
        grow(hull, alone(x), SIZE)
    keep(hull, kept)
    assert kept[N_VERTICES] == (0.0 if more else KEPT_POINTS)
    assert recall(hull, CENTRED, False, kept, SIZE) == (not more)


def test_only_vertices_of_facets_are_kept():
    hull, _, _ = seeded(np.vstack([np.eye(3), -np.eye(3)]))
    for x in 3.0 * np.vstack([np.eye(3), -np.eye(3)]):
        grow(hull, alone(x), SIZE)
    kept = np.zeros(N_POLYTOPE)
    keep(hull, kept)
    assert kept[N_VERTICES] == 6.0
    assert hull.points.reshape(-1, POINT_REALS)[: hull.sizes[0], 0].size > 6
