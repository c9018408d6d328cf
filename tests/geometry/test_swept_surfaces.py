"""Surfaces of revolution and extrusion, and the torus: formulas, boxes, refusals."""

import numpy as np
import pytest

from standoff.geometry import (
    ConicArc,
    Extrusion,
    FormulaCurve,
    Line,
    NurbsCurve,
    Plane,
    RationalBezier,
    Revolution,
    Torus,
)

ARC = ConicArc((1.2, 0, 0.3), (0.7, 0, 0.1), (0, 0, 0.9), -1.1, 1.3)
BEZIER = RationalBezier(
    [(0.3, 0, -1), (1.5, 0, -0.8), (0.2, 0, 0.1), (0.9, 0, 0.7)], [1, 2, 0.6, 1]
)
NURBS = NurbsCurve(
    [(0.4, 0, -1), (1, 0, -0.6), (1.3, 0, 0.2), (0.8, 0, 0.9)],
    [0, 0, 0, 0.4, 1, 1, 1],
    [1, 2, 1, 1],
)
FORMULA = FormulaCurve("1 + cos(t)/2", "0", "sin(t)", -1.0, 1.4)
PROFILES = {"line": Line((1, 0, 0), (0.4, 0, 1)), "arc": ARC, "Bezier": BEZIER, "NURBS": NURBS}
PROFILES["formula"] = FORMULA
LINEAR = np.array([[1.0, 0.3, 0], [-0.2, 0.8, 0.1], [0.4, 0, 1.3]])
SHIFT = np.array([0.5, -2.0, 0.1])


def turned(profile, u, v):
    x, xt, xtt = (p[[0, 2]] for p in profile.jet(v))
    radial, across = np.array([np.cos(u), np.sin(u), 0]), np.array([-np.sin(u), np.cos(u), 0])
    rows = [x[0] * radial, x[0] * across, xt[0] * radial, -x[0] * radial, xt[0] * across]
    rows.append(xtt[0] * radial)
    for k, height in ((0, x[1]), (2, xt[1]), (5, xtt[1])):
        rows[k] = rows[k] + [0, 0, height]
    return rows


def parameters(surface, rng, count=200):
    u0, u1, v0, v1 = surface.domain
    return zip(rng.uniform(u0, u1, count), rng.uniform(v0, v1, count), strict=True)


@pytest.mark.parametrize("name", PROFILES)
def test_revolution_is_its_formula(name):
    surface, rng = Revolution(PROFILES[name], 0.2, 2.9), np.random.default_rng(1)
    for u, v in parameters(surface, rng, 20):
        found, expected = surface.jet(u, v), turned(PROFILES[name], u, v)
        np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("name", PROFILES)
def test_extrusion_is_its_formula(name):
    profile, d = PROFILES[name], np.array([0.1, 1.0, -0.3])
    surface, rng = Extrusion(profile, d, -1, 2), np.random.default_rng(2)
    for u, v in parameters(surface, rng, 20):
        c, ct, ctt = profile.jet(u)
        expected = (c + v * d, ct, d, ctt, np.zeros(3), np.zeros(3))
        np.testing.assert_allclose(surface.jet(u, v), expected, rtol=1e-13, atol=1e-13)


def test_torus_is_its_formula():
    surface, rng = Torus(2, 0.5), np.random.default_rng(3)
    circle = ConicArc((2, 0, 0), (0.5, 0, 0), (0, 0, 0.5), -np.pi / 2, np.pi / 2)
    for u, v in parameters(surface, rng, 20):
        found, expected = surface.jet(u, v), turned(circle, u, v)
        np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-13)


SURFACES = {f"revolved {name}": Revolution(p) for name, p in PROFILES.items()}
SURFACES |= {f"sector of revolved {name}": Revolution(p, 0.5, 1.9) for name, p in PROFILES.items()}
SURFACES |= {f"extruded {name}": Extrusion(p, (0.2, 1, 0)) for name, p in PROFILES.items()}
SURFACES |= {"torus": Torus(2, 0.5), "sector of a torus": Torus(2, 0.5, 0.3, 1.2, -0.4, 1.1)}


@pytest.mark.parametrize("name", SURFACES)
def test_maps_and_restrictions_keep_parameters(name):
    surface, rng = SURFACES[name], np.random.default_rng(4)
    image = surface.transformed(LINEAR, SHIFT)
    u0, u1, v0, v1 = surface.domain
    smaller = surface.restricted(u0, 0.5 * (u0 + u1), v0, 0.5 * (v0 + v1))
    assert smaller.domain == (u0, 0.5 * (u0 + u1), v0, 0.5 * (v0 + v1))
    assert image.domain == surface.domain
    for u, v in parameters(smaller, rng, 10):
        jet = surface.jet(u, v)
        expected = [jet[0] @ LINEAR.T + SHIFT, *(part @ LINEAR.T for part in jet[1:])]
        np.testing.assert_allclose(image.jet(u, v), expected, rtol=1e-13, atol=1e-13)
        np.testing.assert_array_equal(smaller.jet(u, v), jet)
    with pytest.raises(ValueError, match="leaves the surface's own"):
        smaller.restricted(u0, u1, v0, v1)
    with pytest.raises(ValueError, match="is empty"):
        surface.restricted(u1, u0, v0, v1)


@pytest.mark.parametrize("name", [name for name in SURFACES if "torus" not in name])
@pytest.mark.parametrize("part", [(0, 1, 0, 1), (0.2, 0.5, 0.4, 0.9)])
def test_boxes_hold_the_surface(name, part):
    surface, rng = SURFACES[name].transformed(LINEAR, SHIFT), np.random.default_rng(5)
    u0, u1, v0, v1 = surface.domain
    a, b, c, d = part
    us, vs = (1 - np.array([a, b])) * u0 + np.array([a, b]) * u1, np.array([c, d])
    surface = surface.restricted(*us, *((1 - vs) * v0 + vs * v1))
    points = np.array([surface.jet(u, v)[0] for u, v in parameters(surface, rng, 3000)])
    low, high = surface.box()
    assert (points >= low - 1e-14).all()
    assert (points <= high + 1e-14).all()
    if "arc" in name or "line" in name:
        assert (high - low).max() <= 1.05 * np.ptp(points, axis=0).max()


def test_highest_of_a_torus():
    rng = np.random.default_rng(6)
    for surface in (SURFACES["torus"], SURFACES["sector of a torus"]):
        image = surface.transformed(LINEAR, SHIFT)
        points = np.array([image.jet(u, v)[0] for u, v in parameters(image, rng, 4000)])
        inside = 0
        for d in rng.normal(size=(60, 3)):
            top = image.highest(d)
            if top is not None:
                inside += 1
                assert d @ image.jet(*top)[0] >= (points @ d).max()
        assert inside > 3


def test_full_turns_are_periodic():
    assert Revolution(ARC).periodic
    assert not Revolution(ARC, 0, 3).periodic
    assert Torus(1, 0.2).periodic
    assert not Torus(1, 0.2, 0, 3).periodic
    assert Extrusion(ConicArc((0, 0, 0), (1, 0, 0), (0, 1, 0)), (0, 0, 1)).periodic
    assert not Extrusion(ARC, (0, 1, 0)).periodic


def test_knots_of_a_profile_are_breaks():
    assert Revolution(NURBS).breaks() == ((), (0.4,))
    assert Extrusion(NURBS, (0, 1, 0)).breaks() == ((0.4,), ())
    assert Revolution(NURBS).restricted(0, 1, 0.5, 1).breaks() == ((), ())
    assert Revolution(BEZIER).breaks() == ((), ())


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Revolution(Line((1, 0, 0), (1, 0.1, 1))), "leaves the plane y = 0 at"),
        (lambda: Revolution(Line((-1, 0, 0), (1, 0, 1))), "meets or crosses the axis at"),
        (lambda: Revolution(Line((0, 0, 0), (0, 0, 1))), "meets or crosses the axis at"),
        (lambda: Revolution(ARC, 0, 7), "from angle 0.0 to 7.0: give 0 < last - first <= 2 pi"),
        (lambda: Revolution(ARC, 1, 1), "from angle 1.0 to 1.0: give"),
        (lambda: Revolution(ARC, 0, np.nan), "last = nan"),
        (lambda: Revolution(Plane(np.eye(3), np.zeros(3))), "give a Curve as its profile"),
        (lambda: Extrusion(ARC, (0, 0, 0)), r"along the direction \(0, 0, 0\)"),
        (lambda: Extrusion(ARC, (0, np.inf, 0)), "direction has a NaN or infinite"),
        (lambda: Extrusion(Line((0, 0, 0), (1, 1, 0)), (2, 2, 0)), "runs along the profile at"),
        (lambda: Extrusion(ARC, (0, 1, 0), 1, 0), "from v = 1.0 to 0.0: give first < last"),
        (lambda: Torus(0, 1), "major = 0.0: must be positive"),
        (lambda: Torus(1, -1), "minor = -1.0: must be positive"),
        (lambda: Torus(1, 2, 0, 1, 0, 3), "from v = 0.0 to 3.0: it meets its axis"),
        (lambda: Torus(2, 1, 0, 9), "from angle 0.0 to 9.0: give"),
    ],
)
def test_refusals(make, words):
    with pytest.raises(ValueError, match=words):
        make()
