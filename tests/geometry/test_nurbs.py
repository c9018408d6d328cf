"""NURBS surfaces and curves: jets against SciPy, exact changes of form, refusal of bad input."""

import itertools

import numpy as np
import pytest
import splines

from standoff.geometry import BezierPatch, NurbsCurve, NurbsSurface

# Relative to the size of the control points and, for derivatives, of the span.
ORACLE = 1e-13
DEGREES = range(1, 10)


def points_inside(rng, surface, count):
    u0, u1, v0, v1 = surface.domain
    return zip(rng.uniform(u0, u1, count), rng.uniform(v0, v1, count), strict=True)


def assert_same_points(one, other, rng, where=lambda u, v: (u, v)):
    for u, v in points_inside(rng, one, 12):
        np.testing.assert_allclose(other.jet(*where(u, v))[0], one.jet(u, v)[0], atol=1e-12)


@pytest.mark.parametrize("p", DEGREES)
def test_surface_jets_are_scipys(p, rng):
    for q in rng.choice(np.arange(1, 10), 3):
        surface = splines.random_surface(rng, p, int(q), clamped=bool(rng.integers(2)))
        for u, v in points_inside(rng, surface, 6):
            scales = splines.scales(surface, u, v)
            known = splines.surface_jet(surface, u, v)
            for found, want, scale in zip(surface.jet(u, v), known, scales, strict=True):
                limit = ORACLE * max(scale, float(np.abs(want).max()))
                assert np.abs(found - want).max() <= limit


@pytest.mark.parametrize("degree", DEGREES)
def test_curve_jets_are_scipys(degree, rng):
    for clamped in (True, False):
        curve = splines.random_curve(rng, degree, clamped)
        breaks = curve.vector.breaks
        for low, high in itertools.pairwise(breaks):
            t = rng.uniform(low, high)
            known = splines.curve_jet(curve, t)
            for k, (found, want) in enumerate(zip(curve.jet(t), known, strict=True)):
                limit = ORACLE * max((degree / (high - low)) ** k, np.abs(want).max())
                assert np.abs(found - want).max() <= limit


def test_bezier_patch_is_its_bernstein_sum(rng):
    patch = BezierPatch(rng.normal(size=(3, 4, 3)), rng.uniform(0.5, 2.0, (3, 4)))
    assert patch.domain == (0.0, 1.0, 0.0, 1.0)
    assert patch.degrees == (2, 3)
    u, v = 0.3, 0.8
    basis = (
        np.outer([0.49, 0.42, 0.09], [0.008, 3 * 0.04 * 0.8, 3 * 0.2 * 0.64, 0.512]) * patch.weights
    )
    want = np.tensordot(basis, patch.control_points, 2) / basis.sum()
    np.testing.assert_allclose(patch.jet(u, v)[0], want, atol=1e-15)


@pytest.mark.parametrize("clamped", [True, False])
def test_elevated_and_refined_surfaces_are_the_same(clamped, rng):
    for p, q in ((1, 3), (2, 8), (5, 4)):
        surface = splines.random_surface(rng, p, q, clamped)
        elevated = surface.elevated(p + 2, 9)
        assert elevated.degrees == (p + 2, 9)
        assert len(elevated.breaks()[0]) == len(surface.breaks()[0])
        assert_same_points(surface, elevated, rng)
        u0, u1, v0, v1 = surface.domain
        middle = 0.37 * u0 + 0.63 * u1
        refined = surface.refined([middle], [v0 + 0.1 * (v1 - v0), v0 + 0.9 * (v1 - v0)])
        assert refined.control_points.shape[0] == surface.control_points.shape[0] + 1
        assert refined.control_points.shape[1] == surface.control_points.shape[1] + 2
        assert_same_points(surface, refined, rng)


def test_turned_surfaces_have_the_same_points(rng):
    surface = splines.random_surface(rng, 3, 2, clamped=False)
    assert_same_points(surface, surface.reversed_u(), rng, lambda u, v: (-u, v))
    assert_same_points(surface, surface.reversed_v(), rng, lambda u, v: (u, -v))
    assert_same_points(surface, surface.swapped(), rng, lambda u, v: (v, u))


def test_curves_elevated_refined_and_reversed_are_the_same(rng):
    curve = splines.random_curve(rng, 4, clamped=False)
    t = rng.uniform(curve.first, curve.last)
    for other, s in (
        (curve.elevated(9), t),
        (curve.refined([0.5 * (curve.first + curve.last)]), t),
        (curve.reversed(), -t),
    ):
        np.testing.assert_allclose(other.point(s), curve.point(t), atol=1e-13)


def test_maps_go_into_the_control_points(rng):
    linear, shift = rng.normal(size=(3, 3)), rng.normal(size=3)
    for shape, at in (
        (splines.random_surface(rng, 3, 4), (0.7, 0.4)),
        (BezierPatch(rng.normal(size=(3, 3, 3))), (0.7, 0.4)),
        (splines.random_curve(rng, 3), (0.6,)),
    ):
        image = shape.transformed(linear, shift)
        assert type(image) is type(shape)
        for k, (found, plain) in enumerate(zip(image.jet(*at), shape.jet(*at), strict=True)):
            want = linear @ plain + (shift if k == 0 else 0.0)
            np.testing.assert_allclose(found, want, rtol=1e-11, atol=1e-11)


def test_box_holds_the_surface_and_follows_its_domain(rng):
    surface = splines.random_surface(rng, 3, 3)
    u0, u1, v0, v1 = surface.domain
    small = surface.restricted(0.6 * u0 + 0.4 * u1, u1, v0, 0.5 * (v0 + v1))
    for part in (surface, small):
        low, high = part.box()
        for u, v in points_inside(rng, part, 50):
            x = part.jet(u, v)[0]
            np.testing.assert_allclose(x, surface.jet(u, v)[0], atol=1e-14)
            assert (low - 1e-12 <= x).all()
            assert (x <= high + 1e-12).all()
    whole, part = (np.subtract(*s.box()[::-1]) for s in (surface, small))
    assert (part <= whole + 1e-12).all()
    assert part.sum() < whole.sum()
    with pytest.raises(ValueError, match="leaves the surface's own"):
        small.restricted(u0, u1, v0, v1)


def test_breaks_are_the_knots_below_c2(rng):
    knots = [0, 0, 0, 0, 1, 2, 2, 3, 3, 3, 4, 4, 4, 4]
    surface = NurbsSurface(rng.normal(size=(10, 3, 3)), knots, [0, 0, 0, 1, 1, 1])
    assert surface.breaks() == ((2.0, 3.0), ())
    assert surface.restricted(0.0, 2.5, 0.0, 1.0).breaks() == ((2.0,), ())
    curve = NurbsCurve(rng.normal(size=(10, 3)), knots)
    assert curve.breaks() == (2.0, 3.0)


def circle(radius=2.0):
    """A full circle of degree 2 in four quarters."""
    ring = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
    w = [1.0, np.sqrt(0.5)] * 4 + [1.0]
    return NurbsCurve(radius * np.array(ring), [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4], w)


def test_a_full_circle_is_closed_and_round():
    curve = circle()
    assert curve.closed
    for t in np.linspace(0.0, 4.0, 23):
        assert np.linalg.norm(curve.point(t)) == pytest.approx(2.0, abs=1e-14)
    corner = NurbsCurve([(0, 0), (1, 0), (0, 1), (0, 0)], [0, 0, 0, 1, 2, 2, 2])
    assert not corner.closed


NET = np.stack(np.meshgrid([0.0, 1.0, 2.0], [0.0, 1.0, 2.0], [0.0], indexing="ij"), -1)[:, :, 0]
CLAMPED = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]
BAD_SURFACES = {
    "unsorted": ({"knots_u": [0, 0, 0.6, 0.4, 1, 1]}, r"knot 2 = 0.6 is above knot 3 = 0.4; sort"),
    "no room": ({"knots_u": [0, 0, 0, 1]}, r"4 knots for 3 rows.*degree 0.*5 to 13 knots"),
    "high": (
        {"knots_v": np.linspace(0, 1, 14)},
        r"14 knots for 3 columns.*degree 10.*degree of 1 to 9",
    ),
    "few points": ({"knots_u": [0, 0, 0, 0, 1, 1, 1]}, r"degree 3.*needs at least 4 rows"),
    "nan knot": ({"knots_u": [0, 0, np.nan, 1, 1, 1]}, r"knots_u has a NaN"),
    "equal": ({"knots_u": [1, 1, 1, 1, 1, 1]}, r"empty domain: knots 2 and 3 are both 1.0"),
    "nan point": ({"control_points": NET * np.nan}, r"control_points has a NaN"),
    "shape": (
        {"control_points": NET[..., :2]},
        r"shape \(3, 3, 2\): give an array of n by n by 3 numbers",
    ),
    "point": (
        {"control_points": 0 * NET + 4.0},
        r"All control points are \[4. 4. 4.\]: give different",
    ),
    "weight": ({"weights": [[1, 1, 1], [1, 1, -2], [1, 1, 1]]}, r"weights\[\(1, 2\)\] = -2.0"),
    "no weight": ({"weights": np.zeros((3, 3))}, r"weights\[\(0, 0\)\] = 0.0: every weight must"),
    "weights": (
        {"weights": np.ones((2, 3))},
        r"weights has shape \(2, 3\): give an array of 3 by 3 numbers",
    ),
    "words": ({"control_points": "pebble"}, r"control_points is not numeric"),
}


@pytest.mark.parametrize(("change", "message"), BAD_SURFACES.values(), ids=BAD_SURFACES.keys())
def test_bad_surfaces_are_refused(change, message):
    good = {"control_points": NET, "knots_u": CLAMPED, "knots_v": CLAMPED}
    NurbsSurface(**good)
    with pytest.raises(ValueError, match=message):
        NurbsSurface(**(good | change))


def test_too_many_equal_knots_are_refused():
    net = np.zeros((6, 2, 3))
    net[..., 0] = np.arange(6)[:, None]
    with pytest.raises(ValueError, match=r"knot 1.0 occurs 3 times; at most 2 times inside"):
        NurbsSurface(net, [0, 0, 0, 1, 1, 1, 2, 2, 2], [0, 0, 1, 1])
    with pytest.raises(ValueError, match=r"knot 0.0 occurs 4 times; at most 3 times at an end"):
        NurbsSurface(net, [0, 0, 0, 0, 1, 1.5, 2, 2, 2], [0, 0, 1, 1])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([(0, 0), (1, 0), (1, 1)], [0, 0, 1, 0.5, 1, 1]), r"knot 2 = 1.0 is above knot 3 = 0.5"),
        (([(0, 0), (1, 0), (1, 1)], CLAMPED, [1, 0, 1]), r"weights\[1\] = 0.0: every weight"),
        (([(0, 0), (1, 0), (1, 1)], [0, 1]), r"2 knots for 3 control points.*degree -2"),
        (([(0, 0), (1, np.inf), (1, 1)], CLAMPED), r"NaN or infinite"),
        (([(1, 1)] * 3, CLAMPED), r"All control points are \[1. 1. 0.\]"),
    ],
)
def test_bad_curves_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        NurbsCurve(*arguments)


def test_bad_bezier_patches_and_changes_are_refused(rng):
    with pytest.raises(ValueError, match=r"1 control points along u, so degree 0: give 2 to 10"):
        BezierPatch(NET[:1])
    with pytest.raises(ValueError, match=r"11 control points along v, so degree 10"):
        BezierPatch(rng.normal(size=(3, 11, 3)))
    patch = BezierPatch(NET)
    with pytest.raises(ValueError, match=r"Degree 10 asked of a spline of degree 2.*2 to 9"):
        patch.elevated(2, 10)
    with pytest.raises(ValueError, match=r"Degree 1 asked of a spline of degree 2"):
        patch.elevated(1, 2)
    with pytest.raises(ValueError, match=r"knots_u: knot 1.5 is not inside the domain"):
        patch.refined([1.5])
    with pytest.raises(ValueError, match=r"knot 0.5 occurs 3 times; at most 2 times inside"):
        patch.refined([0.5, 0.5, 0.5])


def test_arrays_are_copied_and_read_only():
    net = NET.copy()
    surface = NurbsSurface(net, CLAMPED, CLAMPED)
    net[:] = 7.0
    assert surface.control_points.max() == 2.0
    for array in (surface.control_points, surface.weights, surface.knots_u, surface.data):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
