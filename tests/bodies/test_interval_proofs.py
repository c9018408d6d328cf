"""Convexity proofs of formulas: what is proven, what is refused, and that bounds are bounds."""

import numpy as np
import pytest
import sympy

from shares import only
from standoff.bodies.proofs.formulas import forms, signs, symbolic
from standoff.bodies.proofs.formulas.normals import least_cosines
from standoff.bodies.proofs.formulas.signs import proven_sign
from standoff.bodies.proofs.interval import prove
from standoff.geometry.boxes import grid
from standoff.geometry.formulas import FormulaSurface

PI = np.pi
SQUARE = (-1, 1, -1, 1)


def least_curvature(surface, sense, n=40, sides=False):
    """The least normal curvature on a grid, outward positive, and the jets' points and normals."""
    u0, u1, v0, v1 = surface.domain
    inner = np.linspace(0, 1, n) if sides else (np.arange(n) + 0.5) / n
    least, points, normals = np.inf, [], []
    for u in u0 + inner * (u1 - u0):
        for v in v0 + inner * (v1 - v0):
            x, xu, xv, xuu, xuv, xvv = surface.jet(u, v)
            normal = np.cross(xu, xv)
            normal = (sense or 1) * normal / np.linalg.norm(normal)
            first = np.array([[xu @ xu, xu @ xv], [xu @ xv, xv @ xv]])
            second = -np.array([[xuu @ normal, xuv @ normal], [xuv @ normal, xvv @ normal]])
            least = min(least, np.linalg.eigvals(np.linalg.solve(first, second)).real.min())
            points.append(x)
            normals.append(normal)
    return least, np.array(points), np.array(normals)


def rise(points, normals):
    """How far any point stands above the tangent plane of any other."""
    return max(float(np.einsum("ij,ij->i", normals, p - points).max()) for p in points)


CONVEX = {
    "cap of a sphere": (("u", "v", "sqrt(4 - u**2 - v**2)"), SQUARE, 1, True),
    "the same from below": (("u", "v", "-sqrt(4 - u**2 - v**2)"), SQUARE, -1, True),
    "paraboloid": (("u", "v", "-(0.3*u**2 + v**2/7)/2"), SQUARE, 1, True),
    "quartic, flat in the middle": (("u", "v", "-u**4 - v**2"), SQUARE, 1, True),
    "flat along a line and at a point": (("u", "v", "-u**4 - v**4"), SQUARE, 1, True),
    "collapsed side": (
        ("cos(u)*sin(v)", "sin(u)*sin(v)", "cos(v)"), (0, PI / 2, 0, PI / 2), -1, True,
    ),
    "dome with a pole, nearly a hemisphere": (
        ("cos(u)*sin(v)", "sin(u)*sin(v)", "cos(v)"), (0, 2 * PI, 0, 1.55), -1, True,
    ),
    "gore between two poles": (
        ("cos(u)*cos(v)/(1 + sin(v)/5)", "sin(u)*cos(v)/(1 + sin(v)/5)", "sin(v)"),
        (0, 2, -PI / 2, PI / 2), 1, False,
    ),
    "sphere but for its poles": (
        ("cos(u)*sin(v)", "sin(u)*sin(v)", "cos(v)"), (0, 6, 0.1, 3), -1, False,
    ),
    "half a torus": (
        ("(2 + cos(v))*cos(u)", "(2 + cos(v))*sin(u)", "sin(v)"), (0, 2, -PI / 2, PI / 2), 1, False,
    ),
    "cylinder": (("cos(u)", "sin(u)", "v"), (0, 3, 0, 1), 1, True),
    "cone to its apex": (("v*cos(u)", "v*sin(u)", "-v"), (0, 2 * PI, 0, 1), -1, True),
    "oblique cone": (("v*cos(u)", "v*sin(u)/2", "-v + v*cos(u)/9"), (0, 6, 0, 1), -1, True),
    "logarithm of a sum of exponentials": (
        ("u", "v", "-log(exp(u) + exp(v) + exp(-u - v))"), SQUARE, 1, True,
    ),
    "too long for exact algebra": (
        ("u + 0.1*sin(v)", "v + 0.05*tanh(u)",
         "-cosh(u) - exp(v/2) - u*v/9 + log(3 + u)/9 + sqrt(4 - u*v)/7"), SQUARE, 1, True,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CONVEX)
def test_convex_patches_are_proven(name):
    formulas, domain, sense, hemisphere = CONVEX[name]
    proof = prove(FormulaSurface(*formulas, domain))
    assert (proof.convex, proof.defect, proof.tilt, proof.curvature) == (True, 0.0, 0.0, 0.0)
    assert (proof.sense, proof.hemisphere, proof.method) == (sense, hemisphere, "interval")


@pytest.mark.parametrize("name", ["paraboloid", "collapsed side", "cone to its apex"])
def test_affine_images_are_proven(name):
    formulas, domain, sense, hemisphere = CONVEX[name]
    rng = np.random.default_rng(21)
    for _ in range(6):
        linear = rng.normal(size=(3, 3))
        image = FormulaSurface(*formulas, domain).transformed(linear, rng.normal(size=3))
        proof = prove(image)
        assert (proof.convex, proof.defect, proof.hemisphere) == (True, 0.0, hemisphere)
        turned = sense * np.sign(np.linalg.det(linear))
        assert proof.sense == turned
        least, points, normals = least_curvature(image, turned, 20)
        assert least >= -1e-9
        assert rise(points, normals) <= 1e-9


def test_a_flat_patch_serves_either_way():
    proof = prove(FormulaSurface("u + v", "u - v", "0.1*u - 0.3*v", SQUARE))
    assert (proof.convex, proof.sense, proof.defect, proof.hemisphere) == (True, 0, 0.0, True)


def test_a_patch_is_hollow_from_its_other_side():
    formulas, domain, sense, _ = CONVEX["paraboloid"]
    patch = FormulaSurface(*formulas, domain)
    assert prove(patch, sense).convex
    hollow = prove(patch, -sense)
    assert (hollow.convex, hollow.sense, hollow.defect) == (False, -sense, np.inf)
    mirrored = patch.transformed(np.diag([1.0, 1.0, -1.0]), np.zeros(3))
    assert prove(mirrored, -sense).convex
    assert not prove(mirrored, sense).convex
    # a dimple of a bowl is a dent from one side, and most of the bowl from the other
    bowl = FormulaSurface(*BENT["deep dimple"][0], SQUARE, {"d": 0.1})
    assert prove(bowl).curvature == prove(bowl, 1).curvature
    assert prove(bowl, -1).curvature < -4.0
    flat = FormulaSurface("u", "v", "u - v", SQUARE)
    assert prove(flat, 1).convex
    assert prove(flat, -1).convex


BENT = {
    "saddle": (("u", "v", "u**2 - v**2"), SQUARE, {}, -2.0),
    "inflected": (("u", "v", "-u**3/9 - v**2"), SQUARE, {}, None),
    "inside of a torus": (
        ("(2 + cos(v))*cos(u)", "(2 + cos(v))*sin(u)", "sin(v)"), (0, 1, 2, 4), {}, -1.0,
    ),
    "torus past its top": (
        ("(2 + cos(v))*cos(u)", "(2 + cos(v))*sin(u)", "sin(v)"), (0, 1, 0, PI / 2 + 0.01), {},
        np.cos(PI / 2 + 0.01) / (2 + np.cos(PI / 2 + 0.01)),
    ),
    "catenoid": (("cosh(v)*cos(u)", "cosh(v)*sin(u)", "v"), (0, 1, -0.5, 1), {}, -1.0),
    "deep dimple": (
        ("u", "v", "-(u**2 + v**2)/2 + d*exp(-50*(u**2 + v**2))"), SQUARE, {"d": 0.1}, None,
    ),
    "narrow dimple off the middle": (
        ("u", "v", "-(u**2 + v**2)/2 + d*exp(-9000*((u - 0.33)**2 + (v - 0.47)**2))"), SQUARE,
        {"d": 1e-3}, None,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", BENT)
def test_patches_that_bend_inward_are_refused_with_the_place(name):
    formulas, domain, parameters, known = BENT[name]
    surface = FormulaSurface(*formulas, domain, parameters)
    proof = prove(surface)
    assert not proof.convex
    least, points, normals = least_curvature(surface, proof.sense)
    if known is not None:
        assert proof.curvature <= known * (1 - 1e-12)
        assert proof.curvature == pytest.approx(known, rel=0.06)
    assert proof.curvature <= least
    assert rise(points, normals) <= proof.defect
    assert proof.defect > 0.0
    # at the place named the patch does bend so
    u, v = proof.place
    there = surface.restricted(u, u + 1e-9, v, v + 1e-9)
    assert least_curvature(there, proof.sense, 1)[0] == pytest.approx(proof.curvature, rel=0.08)


@pytest.mark.parametrize("depth", only([1e-12, 1e-6, 1e-2], [1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2]))
def test_grooves_are_graded(depth):
    """z = -d (u^4 - u^2/2) - v^2/2 dents by d/16 below its hull."""
    surface = FormulaSurface("u", "v", "-16*d*(u**4 - u**2/2) - v**2/2", SQUARE, {"d": depth})
    proof = prove(surface)
    assert not proof.convex
    assert proof.curvature == pytest.approx(-16 * depth, rel=0.15)
    assert proof.curvature <= -16 * depth
    assert depth <= proof.defect <= 300 * depth
    _, points, normals = least_curvature(surface, proof.sense, 30)
    # roundoff of the sampled heights
    assert rise(points, normals) <= proof.defect + 1e-15
    assert 16 * depth * 0.1 <= proof.tilt <= 300 * depth


def test_a_mended_groove_is_convex():
    below = FormulaSurface("u", "v", "-(u**4 + u**2/1000000) - v**2/2", SQUARE)
    assert prove(below).defect == 0.0


def test_bounds_scale_with_the_body():
    formulas, domain, parameters, _ = BENT["deep dimple"]
    surface = FormulaSurface(*formulas, domain, parameters)
    one, ten = prove(surface), prove(surface.transformed(10 * np.eye(3), np.ones(3)))
    assert ten.curvature == pytest.approx(one.curvature / 10, rel=1e-12)
    assert ten.defect == pytest.approx(one.defect * 10, rel=1e-6)
    flat = prove(surface.transformed(np.diag([3.0, 1.0, 0.2]), np.zeros(3)))
    least, points, normals = least_curvature(
        surface.transformed(np.diag([3.0, 1.0, 0.2]), np.zeros(3)), flat.sense
    )
    assert flat.curvature <= least < 0
    assert rise(points, normals) <= flat.defect


def test_bounds_hold_for_random_patches(rng):
    for trial in range(4):
        a, b, c, d, e, f = rng.normal(size=6) * [0.3, 0.3, 0.1, 0.1, 0.2, 0.2]
        height = f"-(u**2 + v**2)/2 + {a}*u**3 + {b}*u*v + {c}*sin(2*u + v) + {d}*exp(u*v)"
        surface = FormulaSurface(
            f"u + {e}*v**2", f"v + {f}*sin(u)/2", height, (-0.5, 0.5, -0.5, 0.5)
        )
        proof = prove(surface)
        least, points, normals = least_curvature(surface, proof.sense, 25, sides=True)
        assert proof.curvature <= max(least, 0.0) + 1e-12, (trial, height)
        assert proof.convex == (proof.defect == 0.0)
        if proof.convex:
            assert least >= -1e-9
        else:
            assert proof.curvature >= 1.3 * min(least, 0.0) - 1e-3
            assert rise(points, normals) <= proof.defect
        if proof.hemisphere:
            assert np.linalg.norm(normals.mean(axis=0)) > 0.0


def test_without_exact_algebra_the_verdict_is_the_same(monkeypatch):
    monkeypatch.setattr(symbolic, "MOST_TERMS", 0)
    for name, convex in (("paraboloid", True), ("saddle", False), ("deep dimple", False)):
        formulas, domain = (CONVEX | BENT)[name][:2]
        parameters = BENT[name][2] if name in BENT else {}
        # a formula of its own, so that no exact forms of it are known
        x = f"{formulas[0]} + 3"
        surface = FormulaSurface(x, *formulas[1:], domain, parameters)
        assert not forms.curvature_forms(surface.formula).exact
        proof = prove(surface)
        assert (proof.convex, proof.defect == 0.0) == (convex, convex)


@pytest.mark.parametrize("name", CONVEX)
def test_exact_forms_are_the_curvatures(name):
    formulas, domain, _, _ = CONVEX[name]
    surface = FormulaSurface(*formulas, domain)
    form = forms.curvature_forms(surface.formula)
    assert form.exact == (name != "too long for exact algebra")
    rng = np.random.default_rng(22)
    at = rng.uniform(np.array(domain[::2]) + 0.05, np.array(domain[1::2]) - 0.05)
    values = dict(zip(sympy.symbols("u v"), map(sympy.Float, at), strict=True))

    def number(expression):
        return float(expression.evalf(30, subs=values))

    _, xu, xv, xuu, xuv, xvv = surface.jet(*at)
    n = np.cross(xu, xv)
    length = np.linalg.norm(n)
    first = np.array([[xu @ xu, xu @ xv], [xu @ xv, xv @ xv]])
    second = np.array([[xuu @ n, xuv @ n], [xuv @ n, xvv @ n]]) / length
    shape = np.linalg.solve(first, second)
    gauss, mean = np.linalg.det(shape), 0.5 * np.trace(shape)
    assert number(form.gauss) == pytest.approx(gauss, rel=1e-10, abs=1e-13)
    assert number(form.mean_square) == pytest.approx(mean**2, rel=1e-10, abs=1e-13)
    assert np.sign(number(sympy.Mul(*form.mean_signs))) == np.sign(np.round(mean, 12))
    if abs(gauss) > 1e-12:
        assert np.sign(number(sympy.Mul(*form.gauss_signs))) == np.sign(gauss)
    direction = np.array([number(e) for e in form.normal])
    direction *= np.sign(number(sympy.Mul(*form.normal_signs)))
    np.testing.assert_allclose(direction / np.linalg.norm(direction), n / length, atol=1e-12)


@pytest.mark.parametrize(
    ("text", "domain", "sign"),
    [
        ("1 + u*v", (-0.9, 0.9, -1, 1), 1),
        ("-1 - u**2*v", SQUARE, 0),
        ("u*v", (0, 1, 0, 1), 1),
        ("u*v", (0, 1, -1, 0), -1),
        ("u*v", SQUARE, 0),
        ("u*(1 - u)", (0, 1, 0, 1), 1),  # zero on two sides of the domain
        ("sin(u)", (0, PI, 0, 1), 1),
        ("sin(u)", (0, PI + 1e-9, 0, 1), 0),
        ("cos(u)**2 - 1 + sin(u)**2 + u", (0, 1, 0, 1), 0),  # zero to roundoff: not proven
        # below zero in a strip 2e-4 wide between all samples
        ("(u - 0.123456)**2 - 1/100000000", SQUARE, 0),
        ("(u - 0.123456)**2 + 1/100000000", SQUARE, 1),
        ("u**2 + v**2", SQUARE, 1),  # touches zero inside
        ("exp(-900*((u - 0.33)**2 + (v - 0.47)**2)) - 0.5", SQUARE, 0),
        ("0.5 - exp(-900*((u - 0.33)**2 + (v - 0.47)**2))", SQUARE, 0),
        ("1/u", (0.1, 1, 0, 1), 1),
    ],
)
def test_signs(text, domain, sign):
    expression = sympy.sympify(text, rational=True)
    assert proven_sign(expression, ("u", "v"), domain) == sign
    assert proven_sign(-expression, ("u", "v"), domain) == -sign


def test_normals_lean_no_more_than_bounded():
    """On a unit sphere the cosine to the axis z is the height."""
    cap = FormulaSurface("u", "v", "sqrt(1 - u**2 - v**2)", (-0.5, 0.5, -0.6, 0.6))
    boxes = grid(cap.domain, 32)
    cosines = least_cosines(cap.formula, cap.domain, boxes, np.eye(3), np.array([0.0, 0.0, 1.0]))
    far = np.maximum(np.abs(boxes.low), np.abs(boxes.high))
    heights = np.sqrt(1 - (far**2).sum(axis=1))
    assert (cosines <= heights).all()
    np.testing.assert_allclose(cosines, heights, rtol=0.1)
    squeezed = np.linalg.inv(np.diag([1.0, 1.0, 0.1])).T
    steep = least_cosines(cap.formula, cap.domain, boxes, squeezed, np.array([0.0, 0.0, 1.0]))
    known = 10 * heights / np.hypot(10 * heights, np.sqrt(1 - heights**2))
    assert (steep <= known + 1e-12).all()


def test_steeper_dents_rise_further():
    """A shear along z keeps the graph's own curvature but leans its normals."""
    groove = FormulaSurface("u", "v", "-16*d*(u**4 - u**2/2) - v**2/2", SQUARE, {"d": 1e-6})
    upright = prove(groove)
    sheared = np.array([[1.0, 0, 0], [0, 1.0, 0], [0, 3.0, 1.0]])
    leaning = prove(groove.transformed(sheared, np.zeros(3)))
    assert upright.defect < leaning.defect < np.inf
    assert upright.hemisphere
    assert leaning.hemisphere


def test_constants_have_their_sign():
    assert proven_sign(sympy.Rational(-1, 3), ("u", "v"), SQUARE) == -1
    assert signs.sign_of_product([sympy.Integer(-2), sympy.pi], ("u", "v"), SQUARE) == -1
