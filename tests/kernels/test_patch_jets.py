"""The law of the jets for the kinds with data: NURBS, swept surfaces, tori, formulas, and curves.

The same law as in test_jets.py, in one loop over all kinds.
"""

import numpy as np
import pytest
from test_jets import OFFSETS, STEP, assert_derivative, assert_surface_law, difference, random_map

from standoff.geometry import (
    BezierPatch,
    ConicArc,
    Extrusion,
    FormulaCurve,
    FormulaSurface,
    Line,
    NurbsCurve,
    NurbsPcurve,
    NurbsSurface,
    RationalBezier,
    Revolution,
    SuperellipsoidPole,
    SuperellipsoidSide,
    SurfaceCurve,
    Torus,
)

TRIALS = 12
MARGIN = OFFSETS[-1] * STEP


def grid(rng, rows, columns):
    """Control points near a plane, so that the normal never vanishes."""
    u, v = np.meshgrid(np.linspace(0, 2, rows), np.linspace(0, 3, columns), indexing="ij")
    return np.stack([u, v, np.zeros_like(u)], axis=-1) + 0.3 * rng.normal(size=(rows, columns, 3))


def bezier(p, q):
    def make(rng):
        return BezierPatch(grid(rng, p + 1, q + 1), rng.uniform(0.5, 2, (p + 1, q + 1)))

    return make


def nurbs(rng):
    knots_u, knots_v = [0, 0, 0, 1, 1.7, 3, 3, 3], [-1, 0, 0.5, 2, 2.2, 4, 5, 6, 7]
    return NurbsSurface(grid(rng, 5, 5), knots_u, knots_v, rng.uniform(0.5, 2, (5, 5)))


def profiles(rng):
    """Curves of every kind in the half-plane y = 0, x > 0."""
    points = np.column_stack([rng.uniform(1, 2, 5), np.zeros(5), np.linspace(-1, 1, 5)])
    return {
        "line": Line(points[0], points[4]),
        "conic": ConicArc([1.5, 0, 0], [1, 0, 0.2], [0.1, 0, 0.8], -1.0, 1.0),
        "Bezier": RationalBezier(points, rng.uniform(0.5, 2, 5)),
        "NURBS": NurbsCurve(points, [0, 0, 0, 0, 0.6, 1, 1, 1, 1], rng.uniform(0.5, 2, 5)),
        "formula": FormulaCurve("2 + cos(t)", "0", "sin(t) + t/3", -1.0, 1.0),
    }


def superellipsoid(kind):
    def make(rng):
        e1, e2 = rng.uniform(0.2, 1.8, 2)
        return kind(np.eye(3), np.zeros(3), e1=e1, e2=e2).restricted(0.1, 1.2, 0.1, 1.2)

    return make


KINDS = {
    **{f"Bezier {p} x {q}": bezier(p, q) for p, q in ((1, 1), (2, 3), (3, 1), (5, 4), (9, 9))},
    "NURBS": nurbs,
    "torus": lambda rng: Torus(*rng.uniform([1, 0.2], [2, 0.9])),
    "superellipsoid about its axis": superellipsoid(SuperellipsoidPole),
    "superellipsoid about its equator": superellipsoid(SuperellipsoidSide),
    "formula": lambda rng: FormulaSurface(
        "u", "v*cosh(u)/2", "a*exp(-u**2 - v)/(2 + u*v)", (-1, 1, -1, 1), {"a": rng.uniform(1, 2)}
    ),
    **{
        f"revolution of a {name}": lambda rng, name=name: Revolution(profiles(rng)[name])
        for name in ("line", "conic", "Bezier", "NURBS", "formula")
    },
    **{
        f"extrusion of a {name}": lambda rng, name=name: Extrusion(
            profiles(rng)[name], [0.3, 2, 0.4], -1, 1
        )
        for name in ("line", "conic", "Bezier", "NURBS", "formula")
    },
}


def inside(low, high, breaks, rng):
    """A parameter whose differences stay within one piece."""
    ends = np.array([low, *breaks, high])
    k = rng.choice(len(ends) - 1)
    return rng.uniform(ends[k] + MARGIN, ends[k + 1] - MARGIN)


@pytest.mark.parametrize("name", KINDS)
def test_surface_jets(name):
    rng = np.random.default_rng(71)
    for _ in range(TRIALS):
        surface = KINDS[name](rng).transformed(*random_map(rng))
        u0, u1, v0, v1 = surface.domain
        knots_u, knots_v = ([1, 1.7], [2.2]) if name == "NURBS" else ([], [])
        if name.endswith("of a NURBS"):
            knots_u, knots_v = ([0.6], []) if name.startswith("extrusion") else ([], [0.6])
        u, v = inside(u0, u1, knots_u, rng), inside(v0, v1, knots_v, rng)
        assert_surface_law(surface, u, v, np.abs(surface.jet(u, v)).max())
        np.testing.assert_array_equal(surface.points(np.array([[u, v]])), surface.jet(u, v)[:1])


def curves(rng):
    patch = BezierPatch(grid(rng, 4, 4), rng.uniform(0.5, 2, (4, 4)))
    arc = NurbsPcurve([[0.1, 0.2], [0.9, 0.1], [0.8, 0.9]], [0, 0, 0, 1, 1, 1], [1, 0.7, 2])
    found = {f"NURBS of degree {p}": _nurbs_curve(p, rng) for p in range(1, 10)}
    found["formula"] = FormulaCurve("cos(3*t)", "t**2", "exp(t)/(2 + t)", -1.0, 1.0)
    found["isoline u = 0.3"] = SurfaceCurve.isoline(patch, u=0.3)
    found["isoline v = 0.6"] = SurfaceCurve.isoline(patch, v=0.6)
    found["NURBS on a patch"] = SurfaceCurve(patch, arc, 0.0, 1.0)
    return found


def _nurbs_curve(degree, rng):
    knots = [*[0.0] * (degree + 1), 1.0, *[2.0] * (degree + 1)]
    count = degree + 2
    return NurbsCurve(rng.normal(size=(count, 3)), knots, rng.uniform(0.5, 2, count))


@pytest.mark.parametrize("name", curves(np.random.default_rng(0)))
def test_curve_jets(name):
    rng = np.random.default_rng(72)
    for _ in range(TRIALS):
        linear, shift = random_map(rng)
        given = curves(rng)[name]
        curve = given.transformed(linear, shift)
        knots = [1.0] if name.startswith("NURBS of") else []
        t = inside(curve.first, curve.last, knots, rng)
        x, xt, xtt = curve.jet(t)
        np.testing.assert_allclose(x, linear @ given.point(t) + shift, atol=1e-12)
        np.testing.assert_array_equal(
            curve.points(np.array([t, curve.first])), [x, curve.point(curve.first)]
        )
        scale = np.abs(curve.jet(t)).max()
        assert_derivative(xt, difference(lambda s, c=curve: c.jet(s)[0], t), scale)
        assert_derivative(xtt, difference(lambda s, c=curve: c.jet(s)[1], t), scale)
