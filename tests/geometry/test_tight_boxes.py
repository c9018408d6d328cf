"""Boxes of NURBS surfaces and curves: they hold all of it, and little more."""

import numpy as np
import pytest
import splines

from standoff.geometry import Extrusion, NurbsCurve, Revolution, bernstein, ellipsoid_patches
from standoff.geometry.hulls import tight_box
from standoff.geometry.tolerances import TIGHT_BOX

# Of the diagonal: a box may be too large by TIGHT_BOX of that of the control points; samples miss
# some.
SEEN = 2e-3
# Samples that may be nearest to an outermost point, in each span and to each side, and how many
# times finer the grid round them is.
NEAREST = 4
FINER = 10


def cloud(surface, count=41):
    """Points of every span on a grid with its boundary, and on finer grids round the outermost."""
    t = np.linspace(0.0, 1.0, count)
    step, fine = t[1], np.linspace(-1.0, 1.0, 2 * FINER + 1)
    found = []
    for span in surface.spans():
        x = grid_points(span.points, t, t)
        found.append(x.reshape(3, -1))
        order = np.argsort(x.reshape(3, -1), axis=1)
        nearest = np.unique(np.concatenate([order[:, :NEAREST], order[:, -NEAREST:]]))
        for i, j in zip(*np.unravel_index(nearest, x.shape[1:]), strict=True):
            u, v = (np.clip(t[k] + step * fine, 0.0, 1.0) for k in (i, j))
            found.append(grid_points(span.points, u, v).reshape(3, -1))
    return np.concatenate(found, axis=1).T


def grid_points(points, u, v):
    h = bernstein.grid_values(points, u, v)
    return h[:3] / h[3]


def assert_tight(box, points):
    low, high = box
    rounding = 4e-15 * np.abs(points).max()
    assert (low <= points.min(axis=0) + rounding).all()
    assert (high >= points.max(axis=0) - rounding).all()
    too_large = max((points.min(axis=0) - low).max(), (high - points.max(axis=0)).max())
    assert too_large <= SEEN * np.linalg.norm(high - low)


def test_boxes_of_surfaces_are_tight(rng):
    for _ in range(12):
        surface = splines.random_surface(rng, *rng.integers(1, 10, 2))
        far = surface.transformed(np.eye(3), 100.0 * rng.normal(size=3))
        u0, u1, v0, v1 = surface.domain
        part = surface.restricted(0.6 * u0 + 0.4 * u1, u1, v0, 0.5 * (v0 + v1))
        for one in (surface, far, part):
            assert_tight(one.box(), cloud(one))


def test_boxes_of_curves_are_tight(rng):
    for _ in range(12):
        curve = splines.random_curve(rng, int(rng.integers(1, 10)))
        h = bernstein.basis(curve.degree, np.linspace(0.0, 1.0, 801)) @ curve.blocks
        assert_tight(curve.box(), (h[..., :3] / h[..., 3:]).reshape(-1, 3))


def test_boxes_of_ellipsoids_are_those_of_the_ellipsoid():
    axes = np.array([1.0, 1.3, 0.7])
    boxes = np.array([patch.box() for patch in ellipsoid_patches(*axes)])
    np.testing.assert_allclose(boxes[:, 0].min(axis=0), -axes, rtol=1e-3)
    np.testing.assert_allclose(boxes[:, 1].max(axis=0), axes, rtol=1e-3)


def test_a_plane_or_one_point_needs_no_halving():
    corners = np.array([[0.0, 0.0, 1.0], [1.0, 2.0, 1.0], [3.0, 1.0, 1.0], [2.0, 5.0, 1.0]])
    h = np.ones((1, 4, 2, 2))
    h[0, :3] = corners.T.reshape(3, 2, 2)
    low, high = tight_box(h)
    np.testing.assert_array_equal(low, corners.min(axis=0))
    np.testing.assert_array_equal(high, corners.max(axis=0))


@pytest.mark.parametrize("sweep", [Revolution, Extrusion])
def test_swept_surfaces_reach_as_far_as_their_profile(sweep):
    """Its control points reach twice as far out."""
    profile = NurbsCurve([[1, 0, 0], [1.5, 0, 1], [1, 0, 2]], [0, 0, 0, 1, 1, 1])
    surface = Revolution(profile) if sweep is Revolution else Extrusion(profile, [0.0, 1.0, 0.0])
    high = surface.box()[1]
    # the middle of the quadratic is half way to its control point
    np.testing.assert_allclose(high[[0, 2]], [1.25, 2.0], atol=2.0 * TIGHT_BOX)
    assert (high[[0, 2]] >= [1.25, 2.0]).all()
