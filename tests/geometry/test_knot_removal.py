"""Knots that a spline can do without: which are found, and that the spline stays where it is."""

import numpy as np
import pytest
from scipy.interpolate import BSpline

from standoff.geometry import NurbsCurve, NurbsSurface
from standoff.geometry.tolerances import SPARE_KNOT

SPACINGS = [0.3, 0.038, 1e-2, 1e-3, 1e-4, 1e-5]


def spline(rng, degree, inner=(), rational=True):
    """A random curve on knots of its own."""
    knots = np.concatenate([[0.0] * (degree + 1), inner, [1.0] * (degree + 1)])
    count = len(knots) - degree - 1
    weights = np.exp(rng.uniform(-0.5, 0.5, count)) if rational else None
    return NurbsCurve(rng.uniform(-1.0, 1.0, (count, 3)), knots, weights)


@pytest.mark.parametrize("degree", range(1, 10))
@pytest.mark.parametrize("spacing", SPACINGS)
@pytest.mark.parametrize("rational", [False, True])
def test_inserted_knots_cut_no_span(degree, spacing, rational, rng):
    own = (0.25, 0.5, 0.75)
    curve = spline(rng, degree, own, rational)
    new = [t for t in 0.41 + spacing * np.arange(-2, 3) if 0.0 < t < 1.0]
    fine = curve.refined(new).refined(new[:1] if degree > 1 else [])
    assert np.array_equal(fine.essential.knots, curve.knots)
    assert fine.moved <= SPARE_KNOT * np.sqrt(12.0)
    assert set(fine.spare_knots()) == set(new)
    for t in np.linspace(0.0, 1.0, 101):
        assert np.allclose(fine.point(t), curve.point(t), rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("spacing", SPACINGS[1:])
def test_second_derivatives_keep_their_digits(spacing, rng):
    """They are jets of a long span; those of the spans between the knots lose eps / spacing^2."""
    curve = spline(rng, 4)
    fine = curve.refined(list(0.41 + spacing * np.arange(5)))
    for t in 0.41 + spacing * np.linspace(-1.0, 5.0, 31):
        assert np.allclose(fine.jet(t)[2], curve.jet(t)[2], rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_knots_that_are_needed_stay_however_close(degree, rng):
    """Only a cluster that moves the curve by less than its roundoff may be thinned out."""
    for spacing in (0.1, 1e-2, 1e-3):
        own = tuple(0.5 + spacing * np.arange(-1, 2))
        curve = spline(rng, degree, own)
        assert curve.essential is curve.vector
        assert curve.moved == 0.0
        fine = curve.refined([0.2, 0.5 + 0.4 * spacing])
        assert np.array_equal(fine.essential.knots, curve.knots)


def test_a_knot_is_left_out_as_often_as_it_is_spare(rng):
    """Twice inserted where it stood once: once it stays; a corner at full multiplicity stays."""
    curve = spline(rng, 4, (0.5,))
    fine = curve.refined([0.5, 0.5])
    assert fine.vector.multiplicity(0.5) == 3
    assert fine.essential.multiplicity(0.5) == 1
    corner = NurbsCurve([(0, 0), (1, 0), (2, 1), (2, 3), (3, 4)], [0, 0, 0, 1, 1, 2, 2, 2])
    assert corner.essential is corner.vector


@pytest.mark.parametrize("far", [0.0, 1e3])
@pytest.mark.parametrize("lift", [1e-9, 1e-11])
def test_a_point_moved_by_little_keeps_its_knots(far, lift, rng):
    """A change of 1e-9 or 1e-11 of the size is not a roundoff, not even far from the origin."""
    curve = spline(rng, 3).transformed(np.eye(3), np.full(3, far))
    fine = curve.refined([0.41, 0.41 + 1e-4, 0.41 + 2e-4])
    points = fine.control_points.copy()
    points[3] += lift * max(far, 1.0)
    dented = NurbsCurve(points, fine.knots, fine.weights)
    assert len(dented.essential.knots) > len(curve.knots)


def test_what_scipy_inserts_is_found_too(rng):
    knots = np.array([0, 0, 0, 0, 0.3, 0.6, 1, 1, 1, 1.0])
    whole = BSpline(knots, rng.normal(size=(6, 3)), 3)
    fine = whole
    for t in 0.4 + 1e-4 * np.arange(6):
        fine = fine.insert_knot(t)
    curve = NurbsCurve(fine.c, fine.t)
    assert np.array_equal(curve.essential.knots, knots)
    for t in np.linspace(0.0, 1.0, 51):
        assert np.allclose(curve.point(t), whole(t), rtol=0.0, atol=1e-14)


def test_unclamped_knots_are_left_out_inside_the_domain_only(rng):
    curve = NurbsCurve(rng.normal(size=(6, 3)), np.arange(10.0))
    fine = curve.refined([3.3, 3.31, 4.9999])
    assert np.array_equal(fine.essential.knots, curve.knots)


@pytest.mark.parametrize("spacing", SPACINGS)
def test_the_bound_of_the_move_holds_on_a_surface_and_corners_stay(spacing, rng):
    weights = np.exp(rng.uniform(-1.0, 1.0, (4, 6)))
    knots = [0, 0, 0, 0, 0.4, 0.7, 1, 1, 1, 1]
    surface = NurbsSurface(rng.normal(size=(4, 6, 3)), [0] * 4 + [1] * 4, knots, weights)
    new = [t for t in 0.55 + spacing * np.arange(-1, 3) if 0.0 < t < 1.0]
    fine = surface.refined(new, new)
    assert np.array_equal(fine.essential_u.knots, surface.knots_u)
    assert np.array_equal(fine.essential_v.knots, surface.knots_v)
    assert fine.knots_u.size == surface.knots_u.size + len(new)
    reach = float(np.abs(fine.control_points).max())
    assert 0.0 < fine.moved <= 2.0 * SPARE_KNOT * np.sqrt(3.0) * reach
    for u in np.linspace(0.0, 1.0, 9):
        for v in np.linspace(0.0, 1.0, 9):
            off = np.linalg.norm(fine.jet(u, v)[0] - surface.jet(u, v)[0])
            assert off <= fine.moved + 1e-14 * reach
    for u, v in ((0, 0), (0, 1), (1, 0), (1, 1)):
        corner = fine.control_points[-u, -v]
        assert np.allclose(fine.jet(u, v)[0], corner, rtol=4e-16, atol=0.0)


def test_hundreds_of_inserted_knots_are_found_in_a_moment(rng):
    surface = NurbsSurface(rng.normal(size=(4, 4, 3)), [0] * 4 + [1] * 4, [0] * 4 + [1] * 4)
    fine = surface.refined(np.linspace(0.0, 1.0, 202)[1:-1], np.linspace(0.0, 1.0, 102)[1:-1])
    assert len(fine.essential_u.breaks) == len(fine.essential_v.breaks) == 2
