"""Proofs by Taylor series over boxes: bounds that are bounds, at poles too, and what they prove."""

import numpy as np
import pytest
import sympy

from shares import only
from standoff.bodies.proofs import interval
from standoff.bodies.proofs.formulas import forms, normals
from standoff.bodies.proofs.formulas.taylor import (
    Expansion,
    TaylorBounds,
    curvature,
    normal,
    poles_of,
)
from standoff.geometry.boxes import Boxes, grid
from standoff.geometry.formulas import FormulaSurface
from standoff.geometry.formulas.expressions import read_expression
from standoff.geometry.formulas.series_program import SeriesProgram
from standoff.geometry.intervals import Interval
from standoff.geometry.series import powers

PI = np.pi
HALF = PI / 2

SERIES = [
    "sin(u + 2*v)", "cos(u*v) + u/(2 + v)", "exp(u)*tanh(v + u)", "atan2(1 + u, v - u**2)",
    "asin(u*v/2) + acos(v/3)", "atan(u - v)", "tan(u/2 + v/3)", "sqrt(3 + u*v)",
    "(2 + u + v**2)**(3/7)", "(2 + u)**v", "log(3 + u - v)", "sinh(u)*cosh(v)",
    "pi*u**3*v**2 - 0.1", "(1 + u**2)**(-2)*(u - v)**4", "sqrt(2)*u**5 + v**0.5/3",
]  # fmt: skip


@pytest.mark.parametrize("text", SERIES)
def test_series_hold_every_derivative(text):
    expression = read_expression(text, "x", ("u", "v"), {})
    u, v = sympy.symbols("u v")
    rng = np.random.default_rng(4)
    low = np.array([0.3, 0.4])
    width = 1e-3
    sides = [Interval(np.array([a]), np.array([a + width])) for a in low]
    series = SeriesProgram([expression], ("u", "v"))(*sides, order=3)[0]
    for row, (k, m) in enumerate(powers(3)):
        derivative = expression.diff(*([u] * k + [v] * m)) if k + m else expression
        derivative = derivative / (sympy.factorial(k) * sympy.factorial(m))
        values = []
        for a, b in (low, low + width, *(low + width * rng.uniform(size=(2, 2)))):
            values.append(float(derivative.evalf(25, subs={u: sympy.Float(a, 25), v: b})))
        assert series.lo[row, 0] <= min(values)
        assert max(values) <= series.hi[row, 0]
        assert series.hi[row, 0] - series.lo[row, 0] <= 300 * width * (0.1 + abs(values[0]))


PATCHES = {
    "graph": ("u", "v", "sqrt(9 - u**2 - v**2*u)", (-1, 1, -1, 1)),
    "two poles in v": ("sin(v)*cos(u)", "0.7*sin(v)*sin(u)", "0.9*cos(v)", (0, 2, 0, PI)),
    "two poles in u": ("sin(u)*cos(v)", "0.7*sin(u)*sin(v)", "0.9*cos(u)", (0, PI, 0, 2)),
    "apex at v0": ("v*cos(u)", "v*sin(u)", "-v - v**2", (0, 2, 0, 1)),
    "apex at v1": ("(1 - v)*cos(u)", "(1 - v)*sin(u)", "v*(3 - v)", (0, 2, 0, 1)),
    "apex at u1": ("(1 - u)*cos(v)", "(1 - u)*sin(v)", "u*(3 - u)", (0, 1, 0, 2)),
    "pressed in": ("sin(v)*cos(u)", "sin(v)*sin(u)", "cos(v) - cos(v)**4", (0, 2, 0, HALF)),
}


def curvatures(surface, u, v):
    """(K, H^2, H, unit normal along x_u x x_v) by the jet."""
    _, xu, xv, xuu, xuv, xvv = surface.jet(u, v)
    n = np.cross(xu, xv)
    n = n / np.linalg.norm(n)
    first = np.array([[xu @ xu, xu @ xv], [xu @ xv, xv @ xv]])
    shape = np.linalg.solve(first, np.array([[xuu @ n, xuv @ n], [xuv @ n, xvv @ n]]))
    mean = 0.5 * np.trace(shape)
    return np.linalg.det(shape), mean * mean, mean, n


@pytest.mark.parametrize("name", PATCHES)
def test_bounds_hold_up_to_the_poles(name):
    *formulas, domain = PATCHES[name]
    surface = FormulaSurface(*formulas, domain)
    boxes = grid(domain, 6)
    value = TaylorBounds(surface.formula, surface.domain, curvature)(boxes)[0]
    direction = TaylorBounds(surface.formula, surface.domain, normal)(boxes)[0]
    assert np.isfinite(value.lo[1:]).all()
    rng = np.random.default_rng(8)
    for i in range(len(boxes)):
        for u, v in rng.uniform(boxes.low[i], boxes.high[i], size=(3, 2)):
            gauss, square, mean, n = curvatures(surface, u, v)
            for row, x in ((0, gauss), (1, square)):
                spare = 1e-9 * (1 + abs(x))
                assert value.lo[row, i] - spare <= x <= value.hi[row, i] + spare
            assert value.hi[2, i] >= 0 if mean > 0 else value.lo[2, i] <= 0
            # some multiple of the normal, in its sense, lies within the bounds
            with np.errstate(divide="ignore", invalid="ignore"):
                ends = np.sort([direction.lo[:, i] / n, direction.hi[:, i] / n], axis=0)
            assert max(0.0, np.nanmax(ends[0])) <= np.nanmin(ends[1]) * (1 + 1e-9)


def test_the_remainder_is_counted():
    """A polynomial of degree 5 by series of order 4 about the middle."""
    u, v = sympy.symbols("u v")
    boxes = Boxes(np.zeros((1, 2)), np.ones((1, 2)))
    expansion = Expansion(SeriesProgram([u**5 + v], ("u", "v")), boxes, None)
    value, middle = expansion.bounds(expansion.x[0])
    assert value.lo[0] <= 0.0
    assert value.hi[0] >= 2.0
    assert middle.lo[0] <= 0.5**5 + 0.5 <= middle.hi[0]
    assert middle.hi[0] - middle.lo[0] <= 1e-14


def test_bounds_narrow_with_the_boxes():
    *formulas, domain = PATCHES["graph"]
    surface = FormulaSurface(*formulas, domain)
    bounds = TaylorBounds(surface.formula, surface.domain, curvature)
    values = [bounds(grid(domain, n))[0] for n in (6, 12)]
    widths = [float((value.hi[0] - value.lo[0]).max()) for value in values]
    assert widths[1] < 0.5 * widths[0]


@pytest.mark.parametrize(
    ("formulas", "domain", "known"),
    [
        (PATCHES["two poles in v"][:3], (0, 2, 0, PI), [(1, 1, True), (1, -1, True)]),
        (PATCHES["two poles in v"][:3], (0, 2, 0.1, 3), []),
        (PATCHES["two poles in u"][:3], (0, HALF, 0, 2), [(0, 1, True)]),
        (PATCHES["apex at u1"][:3], (0, 1, 0, 2), [(0, -1, False)]),
        # open by a hair, no pole
        (("(1e-12 + v)*cos(u)", "(1e-12 + v)*sin(u)", "-v**2"), (0, 2, 0, 1), []),
        # nearly smooth, no smooth pole
        (("v*cos(u)", "v*sin(u)", "-v**2 - 1e-12*v"), (0, 2, 0, 1), [(1, 1, False)]),
    ],
)
def test_poles_are_proven(formulas, domain, known):
    surface = FormulaSurface(*formulas, domain)
    poles = poles_of(surface.formula, surface.domain)
    assert [(p.axis, p.inward, p.smooth) for p in poles] == known


@pytest.fixture
def _without_algebra(monkeypatch):
    """As if every formula were too long for the exact forms."""
    for module in (interval, normals):
        monkeypatch.setattr(module, "curvature_forms", forms.forms_as_written)
    caches = interval._bent, normals.hemisphere_axis, normals._normal_bounds
    for cache in caches:
        cache.cache_clear()
    yield
    for cache in caches:
        cache.cache_clear()


@pytest.mark.usefixtures("_without_algebra")
@pytest.mark.parametrize(
    ("formulas", "domain", "sense"),
    [
        (PATCHES["two poles in v"][:3], (0, 2, 0, HALF), -1),
        (PATCHES["two poles in v"][:3], (0, 2, 1, PI), -1),
        (PATCHES["two poles in u"][:3], (0, HALF, 0, 2), 1),
        (PATCHES["apex at v0"][:3], (0, 2, 0, 1), -1),
        (PATCHES["apex at v1"][:3], (0, 2, 0, 1), 1),
        (PATCHES["apex at u1"][:3], (0, 1, 0, 2), -1),
        (("v*cos(u)", "v*sin(u)", "1 - v**2"), (0, 2, 0, 1), -1),
    ],
)
def test_collapsed_sides_without_exact_algebra(formulas, domain, sense):
    proof = interval.prove(FormulaSurface(*formulas, domain))
    assert (proof.convex, proof.defect, proof.hemisphere) == (True, 0.0, True)
    assert proof.sense == sense


@pytest.mark.usefixtures("_without_algebra")
@pytest.mark.parametrize(
    "height",
    only(["cos(v) - cos(v)**4"], ["cos(v) - cos(v)**4", "cos(v) - exp(-30*sin(v)**2)/50"]),
)
def test_pressed_poles_without_exact_algebra(height):
    surface = FormulaSurface("sin(v)*cos(u)", "sin(v)*sin(u)", height, (0, 2, 0, HALF))
    proof = interval.prove(surface)
    assert not proof.convex
    assert proof.defect > 0.0
    least = np.inf
    for v in np.linspace(1e-3, HALF, 2000):
        gauss, square, mean, _ = curvatures(surface, 1.0, v)
        least = min(least, mean - np.sqrt(max(square - gauss, 0.0)))
    assert least < -0.1
    assert proof.curvature <= least
    assert proof.curvature == pytest.approx(least, rel=0.5)


@pytest.mark.parametrize("depth", only([1e-3, 0.03], [1e-9, 1e-3, 0.03]))
def test_waves_whose_sines_are_strangers_to_the_algebra(depth):
    """r = sin v + d sin 7v: that sin 7v vanishes with sin v is not an identity of polynomials."""
    r = "(sin(v) + d*sin(7*v))"
    surface = FormulaSurface(f"{r}*cos(u)", f"{r}*sin(u)", "cos(v)", (0, 2, 0, HALF), {"d": depth})
    proof = interval.prove(surface)
    v = np.linspace(1e-3, HALF, 4000)
    least = min(curvatures(surface, 1.0, x)[0] for x in v[::40])
    assert proof.convex == (least > 0.0)
    assert proof.hemisphere


def sum_patch(dent):
    """S1 n/sqrt(n.S1 n) + S2 n/sqrt(n.S2 n) of n = (u, v, 1), pressed in along z."""
    squares = [
        [["0.9", "0.2", "-0.1"], ["0.2", "0.5", "0.15"], ["-0.1", "0.15", "0.7"]],
        [["0.3", "-0.1", "0.05"], ["-0.1", "1.2", "0.2"], ["0.05", "0.2", "0.4"]],
    ]
    n = ("u", "v", "1")
    rows = ["0"] * 3
    for square in squares:
        image = [" + ".join(f"({a})*{x}" for a, x in zip(row, n, strict=True)) for row in square]
        norm = f"sqrt({' + '.join(f'({e})*{x}' for e, x in zip(image, n, strict=True))})"
        rows = [f"{row} + ({e})/{norm}" for row, e in zip(rows, image, strict=True)]
    rows[2] += f" - {dent}*exp(-20*(u**2 + v**2))"
    return FormulaSurface(*rows, (-1, 1, -1, 1))


@pytest.mark.parametrize(
    ("dent", "convex"),
    [("0.001", True), pytest.param("0.2", False, marks=pytest.mark.soak)],
)
def test_sums_of_ellipsoids(dent, convex):
    surface = sum_patch(dent)
    assert not forms.curvature_forms(surface.formula).exact
    proof = interval.prove(surface)
    assert (proof.convex, proof.defect == 0.0) == (convex, convex)
    assert proof.hemisphere or not convex
    least = min(curvatures(surface, u, v)[0] for u in np.linspace(-1, 1, 41) for v in (0, 0.1, 0.2))
    assert (least > 0.0) == convex
