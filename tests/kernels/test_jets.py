"""One law for every surface and curve kind: the jet's derivatives are those of its point."""

from math import comb

import numpy as np
import pytest

from standoff.geometry import (
    Cone,
    ConicArc,
    Cylinder,
    Line,
    Plane,
    RationalBezier,
    Sphere,
    pcurve_of,
)

# Central differences of eighth order: with a step of 0.004 in parameters of order one both the
# first term left out and the roundoff are below 1e-10.
OFFSETS = np.array([1, 2, 3, 4])
WEIGHTS = np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280])
STEP = 0.004
TOLERANCE = 1e-7
"""Relative error of a derivative."""
TRIALS = 40


def random_map(rng):
    """An affine map (linear, shift), mirrored in half of the cases, stretched by 0.3 to 3."""
    first, second = (np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in range(2))
    # LAPACK's orthogonal factors of a square matrix are all rotations: mirror by hand.
    stretches = np.exp(rng.uniform(-1.2, 1.2, 3)) * [1, 1, rng.choice([-1, 1])]
    return first @ np.diag(stretches) @ second, rng.normal(size=3)


def difference(function, parameter):
    """d function / d parameter."""
    total = 0.0
    for offset, weight in zip(OFFSETS, WEIGHTS, strict=True):
        step = offset * STEP
        total = total + weight * (function(parameter + step) - function(parameter - step))
    return total / STEP


def assert_derivative(found, known, scale):
    assert np.linalg.norm(found - known) <= TOLERANCE * max(np.linalg.norm(known), scale)


SURFACES = {
    "plane": (Plane, lambda y: y[2], (-2, 2), (-2, 2)),
    "sphere": (Sphere, lambda y: y @ y - 1, (-2, 2), (-2, 2)),
    "cylinder": (Cylinder, lambda y: y[0] ** 2 + y[1] ** 2 - 1, (-9, 9), (-2, 2)),
    "cone": (Cone, lambda y: y[0] ** 2 + y[1] ** 2 - y[2] ** 2, (-9, 9), (0.2, 3)),
}
"""Kind: its class, its canonical equation, and ranges of u and v."""


def assert_surface_law(surface, u, v, scale):
    _, xu, xv, xuu, xuv, xvv = surface.jet(u, v)

    def by_u(component):
        return difference(lambda s: surface.jet(s, v)[component], u)

    def by_v(component):
        return difference(lambda s: surface.jet(u, s)[component], v)

    for found, known in (
        (xu, by_u(0)),
        (xv, by_v(0)),
        (xuu, by_u(1)),
        (xuv, by_v(1)),
        (xuv, by_u(2)),
        (xvv, by_v(2)),
    ):
        assert_derivative(found, known, scale)


@pytest.mark.parametrize("name", SURFACES)
def test_surface_jets(name):
    kind, equation, in_u, in_v = SURFACES[name]
    rng = np.random.default_rng(41)
    for _ in range(TRIALS):
        linear, shift = random_map(rng)
        outer, by = random_map(rng)
        surface = kind(linear, shift).transformed(outer, by)
        u, v = rng.uniform(*in_u), rng.uniform(*in_v)
        canonical = np.linalg.solve(outer @ linear, surface.jet(u, v)[0] - outer @ shift - by)
        assert abs(equation(canonical)) <= 1e-11
        assert_surface_law(surface, u, v, np.abs(outer @ linear).max())


def bernstein_point(points, weights, t):
    """A rational Bezier curve's point by its definition."""
    n = len(points) - 1
    share = np.array([comb(n, i) * t**i * (1 - t) ** (n - i) for i in range(n + 1)]) * weights
    return share @ points / share.sum()


def random_curve(name, rng):
    """A curve of a kind and its point by definition, as a function of the parameter."""
    if name == "line":
        p, q = rng.normal(size=(2, 3))
        return Line(p, q), lambda t: p + t * (q - p)
    if name == "conic":
        centre, a, b = rng.normal(size=(3, 3))
        return ConicArc(centre, a, b, -2.0, 3.0), lambda t: centre + a * np.cos(t) + b * np.sin(t)
    degree = int(name.split()[-1])
    points, weights = rng.normal(size=(degree + 1, 3)), rng.uniform(0.4, 2.5, degree + 1)
    return RationalBezier(points, weights), lambda t: bernstein_point(points, weights, t)


@pytest.mark.parametrize(
    "name", ["line", "conic", *(f"Bezier of degree {n}" for n in (1, 2, 3, 4, 5))]
)
def test_curve_jets(name):
    rng = np.random.default_rng(42)
    for _ in range(TRIALS):
        given, by_definition = random_curve(name, rng)
        linear, shift = random_map(rng)
        curve = given.transformed(linear, shift)
        # Away from the ends: outside [0, 1] the weights of a rational curve may cancel.
        margin = OFFSETS[-1] * STEP
        t = rng.uniform(curve.first + margin, curve.last - margin)
        x, xt, xtt = curve.jet(t)
        np.testing.assert_allclose(x, linear @ by_definition(t) + shift, atol=1e-13)
        scale = np.abs(linear).max()
        assert_derivative(xt, difference(lambda s, c=curve: c.jet(s)[0], t), scale)
        assert_derivative(xtt, difference(lambda s, c=curve: c.jet(s)[1], t), scale)


def flat_conic(rng, height=0.0):
    """A conic arc in the plane z = height, off the axis."""
    centre = np.array([*rng.normal(size=2), height])
    a, b = (np.array([*rng.normal(size=2), 0.0]) for _ in range(2))
    return ConicArc(centre, a, b, -2.5, 3.0)


def circle(radius, height, rng):
    """A circle about the z axis, from anywhere and either way round."""
    angle = rng.uniform(0, 2 * np.pi)
    a = radius * np.array([np.cos(angle), np.sin(angle), 0.0])
    b = radius * np.array([-np.sin(angle), np.cos(angle), 0.0]) * rng.choice([-1, 1])
    return ConicArc([0, 0, height], a, b)


def section_of_unit_sphere(rng):
    """The circle of a plane that cuts the unit sphere within the half about +z."""
    while True:
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        height = rng.uniform(0.1, 0.95)
        a, b = np.linalg.svd(axis[None])[2][1:] * np.sqrt(1 - height**2)
        if height * axis[2] > np.hypot(a[2], b[2]) + 0.05:
            return ConicArc(height * axis, a, b)


def generator(ends, rng):
    """A straight line between two heights, at any angle; ends are (radius, height)."""
    angle = rng.uniform(0, 2 * np.pi)
    around = np.array([np.cos(angle), np.sin(angle)])
    p, q = (np.array([*(radius * around), height]) for radius, height in ends)
    return Line(p, q)


CARRIED = {
    "line in a plane": (Plane, lambda rng: Line(*(np.append(rng.normal(size=2), 0) for _ in "pq"))),
    "conic in a plane": (Plane, flat_conic),
    "section of a sphere": (Sphere, section_of_unit_sphere),
    "circle on a cylinder": (Cylinder, lambda rng: circle(1.0, rng.normal(), rng)),
    "generator of a cylinder": (Cylinder, lambda rng: generator([(1, -0.3), (1, 2)], rng)),
    "circle on a cone": (Cone, lambda rng: (lambda h: circle(h, h, rng))(rng.uniform(0.2, 3))),
    "generator of a cone": (Cone, lambda rng: generator([(0.5, 0.5), (2, 2)], rng)),
}
"""Canonical curves that canonical surfaces carry."""


@pytest.mark.parametrize("name", CARRIED)
def test_a_pcurve_leads_to_its_curve(name):
    kind, draw = CARRIED[name]
    rng = np.random.default_rng(43)
    for _ in range(TRIALS):
        curve = draw(rng)
        linear, shift = random_map(rng)
        surface, image = kind(linear, shift), curve.transformed(linear, shift)
        pcurve = pcurve_of(image, surface)
        for t in np.linspace(image.first, image.last, 25):
            u, v, depth = pcurve.point(t)
            assert depth > 0
            on_surface = surface.jet(u, v)[0]
            np.testing.assert_allclose(
                on_surface, image.point(t), atol=1e-12 * np.abs(linear).max()
            )


def test_a_pcurve_tells_where_its_chart_is_blind():
    equator = ConicArc([0, 0, 0], [1, 0, 0], [0, 0, 1])
    pcurve = pcurve_of(equator, Sphere(np.eye(3), np.zeros(3)))
    for t in np.linspace(0.1, 2 * np.pi, 40):
        assert (pcurve.point(t)[2] > 0) == (np.sin(t) > 0)


@pytest.mark.parametrize(
    ("curve", "surface", "words"),
    [
        (RationalBezier([[1, 0, 0], [1, 1, 0], [0, 1, 0]]), Plane, "no exact pcurve"),
        (ConicArc([0, 0, 0], [1, 0, 0], [0, 1, 0.5]), Cylinder, "only generators and sections"),
        (ConicArc([0.1, 0, 1], [1, 0, 0], [0, 1, 0]), Cone, "only generators and sections"),
    ],
)
def test_curves_without_an_exact_pcurve_are_refused(curve, surface, words):
    with pytest.raises(ValueError, match=words):
        pcurve_of(curve, surface(np.eye(3), np.zeros(3)))
