"""Surfaces and curves from formulas: derivatives, bounds, and every way to be refused."""

import copy
import importlib
import pickle
import subprocess
import sys

import numpy as np
import pytest
import sympy

from standoff.geometry.formulas import FormulaCurve, FormulaError, FormulaSurface

HALF_PI = np.pi / 2
SURFACES = {
    "egg": (
        ("a*cos(u)*cos(v)/(1+k*sin(v))", "b*sin(u)*cos(v)/(1+k*sin(v))", "c*sin(v)"),
        (-1.5, 1.5, -HALF_PI, HALF_PI),
        {"a": 1, "b": 0.8, "c": 1.3, "k": 0.25},
    ),
    "paraboloid": (("u", "v", "-(a*u**2 + b*v**2)/2"), (-1, 1, -2, 1), {"a": 0.3, "b": 1 / 7}),
    "torus": (
        ("(R + r*cos(v))*cos(u)", "(R + r*cos(v))*sin(u)", "r*sin(v)"),
        (0, 6, -1.5, 1.5),
        {"R": 2.0, "r": 0.6},
    ),
    "bump": (("u", "v", "exp(-(u**2 + v**2)/s**2)"), (-1, 1, -1, 1), {"s": 2.3}),
    "all functions": (
        (
            "sinh(u)*tanh(v) + asin(u/3)*acos(v/3) + atan(u*v)",
            "log(3 + u)**1.7 + cosh(v)/sqrt(4 - u) + tan(v/2) + abs(u - 5)",
            "atan2(2 + u, v) + pi*u + E*v - 2**u + (3 + v)**u",
        ),
        (-1, 1, -1, 1),
        {},
    ),
}
CURVES = {
    "helix": (("cos(t)", "sin(t)", "h*t"), (0, 7), {"h": 0.1}),
    "bent": (("t", "sqrt(2 + t)*exp(-t)", "t**3/(2 - t)"), (-1, 1), {}),
}


def made(name):
    formulas, domain, parameters = SURFACES[name]
    return FormulaSurface(*formulas, domain, parameters)


def known_jet(formulas, parameters, variables, at):
    """The jet by SymPy's own differentiation of SymPy's own reading, to 30 digits."""
    symbols = sympy.symbols(variables, real=True)
    names = {str(s): s for s in np.atleast_1d(symbols)}
    read = [sympy.sympify(f.replace("abs", "Abs"), locals=names) for f in formulas]
    orders = {1: ["", "t", "tt"], 2: ["", "u", "v", "uu", "uv", "vv"]}[len(variables.split())]
    # rationals of the parameters' decimals, as the formula takes them
    values = {sympy.Symbol(k): sympy.Rational(repr(float(x))) for k, x in parameters.items()}
    values |= dict(zip(np.atleast_1d(symbols), map(sympy.Float, at), strict=True))
    by = [[names[letter] for letter in order] for order in orders]
    rows = [[sympy.diff(e, *order) if order else e for e in read] for order in by]
    return np.array([[float(e.evalf(30, subs=values)) for e in row] for row in rows])


@pytest.mark.parametrize("name", SURFACES)
def test_a_surface_has_sympys_derivatives(name):
    formulas, domain, parameters = SURFACES[name]
    surface = made(name)
    rng = np.random.default_rng(5)
    for _ in range(4):
        at = rng.uniform(domain[::2], domain[1::2])
        known = known_jet(formulas, parameters, "u v", at)
        np.testing.assert_allclose(np.array(surface.jet(*at)), known, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", CURVES)
def test_a_curve_has_sympys_derivatives(name):
    formulas, ends, parameters = CURVES[name]
    curve = FormulaCurve(*formulas, *ends, parameters)
    assert (curve.first, curve.last) == ends
    for t in np.random.default_rng(6).uniform(*ends, 4):
        known = known_jet(formulas, parameters, "t", [t])
        np.testing.assert_allclose(np.array(curve.jet(t)), known, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", SURFACES)
def test_derivatives_are_those_of_the_point(name):
    """Central differences of eighth order: no SymPy."""
    _, domain, _ = SURFACES[name]
    surface = made(name)
    offsets, weights, step = [1, 2, 3, 4], [4 / 5, -1 / 5, 4 / 105, -1 / 280], 0.004
    rng = np.random.default_rng(7)
    for _ in range(10):
        margin = 0.1 * np.diff(domain)[::2]
        u, v = rng.uniform(np.array(domain[::2]) + margin, np.array(domain[1::2]) - margin)

        def slope(component, du, dv, u=u, v=v):
            parts = [
                w * (np.array(surface.jet(u + o * du, v + o * dv)[component]))
                - w * np.array(surface.jet(u - o * du, v - o * dv)[component])
                for o, w in zip(offsets, weights, strict=True)
            ]
            return sum(parts) / step

        jet = surface.jet(u, v)
        for row, (component, du, dv) in {
            1: (0, step, 0),
            2: (0, 0, step),
            3: (1, step, 0),
            4: (1, 0, step),
            5: (2, 0, step),
        }.items():
            np.testing.assert_allclose(jet[row], slope(component, du, dv), rtol=1e-8, atol=1e-8)


def test_sympy_expressions_and_text_are_one_formula():
    u, v = sympy.symbols("u v", real=True)
    a = sympy.Symbol("a")
    given = FormulaSurface(u, v, -a * (u**2 + 0.5 * v**2), (-1, 1, -1, 1), {"a": 0.3})
    text = FormulaSurface("u", "v", "-a*(u**2 + v**2/2)", (-2, 1, -1, 1), {"a": 0.3})
    assert given.formula is text.formula
    other = FormulaSurface("u", "v", "-a*(u**2 + v**2/2)", (-2, 1, -1, 1), {"a": 0.4})
    assert other.formula is not text.formula


def test_an_affine_image_shares_the_compiled_function():
    surface, curve = made("egg"), FormulaCurve("cos(t)", "sin(t)", "0.1*t", 0, 5)
    rng = np.random.default_rng(8)
    linear, shift = rng.normal(size=(3, 3)), rng.normal(size=3)
    for shape, at in ((surface, (0.3, 0.4)), (curve, (0.3,))):
        image = shape.transformed(linear, shift).transformed(linear, shift)
        assert image.formula is shape.formula
        before, after = np.array(shape.jet(*at)), np.array(image.jet(*at))
        expected = before @ (linear @ linear).T
        expected[0] += linear @ shift + shift
        np.testing.assert_allclose(after, expected, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("name", SURFACES)
def test_the_box_holds_the_patch_and_is_tight(name):
    rng = np.random.default_rng(9)
    surface = made(name).transformed(rng.normal(size=(3, 3)), rng.normal(size=3))
    u0, u1, v0, v1 = surface.domain
    low, high = surface.box()
    points = np.array(
        [surface.jet(u, v)[0] for u in np.linspace(u0, u1, 80) for v in np.linspace(v0, v1, 80)]
    )
    size = np.linalg.norm(high - low)
    assert (low <= points.min(axis=0)).all()
    assert (points.max(axis=0) <= high).all()
    assert (points.min(axis=0) - low).max() <= 1e-2 * size
    assert (high - points.max(axis=0)).max() <= 1e-2 * size


def test_the_box_of_a_curve():
    curve = FormulaCurve("cos(t)", "sin(t)", "0.1*t", 0, 5).transformed(2 * np.eye(3), np.ones(3))
    low, high = curve.box()
    known_low, known_high = [-1, -1, 1], [3, 3, 2]
    assert (low <= known_low).all()
    assert (known_high <= high).all()
    np.testing.assert_allclose([low, high], [known_low, known_high], atol=1e-3)


def test_a_closed_curve():
    assert FormulaCurve("cos(t)", "2*sin(t)", "0", 0, 2 * np.pi).closed
    assert not FormulaCurve("cos(t)", "2*sin(t)", "0", 0, 6).closed
    # a loop with a corner where it closes
    assert not FormulaCurve("t*(1 - t)", "t*(1 - t)*(1 - 2*t)", "t*(1-t)", 0, 1).closed


def test_restricted_domains():
    surface = made("egg")
    smaller = surface.restricted(-1, 1, -1, 0)
    assert smaller.domain == (-1, 1, -1, 0)
    assert smaller.formula is surface.formula
    low, high = smaller.box()
    assert high[2] < 1e-3 < surface.box()[1][2]
    assert (low < high).all()
    with pytest.raises(FormulaError, match="leaves the surface's own"):
        surface.restricted(-1, 2, -1, 0)
    with pytest.raises(FormulaError, match="empty"):
        surface.restricted(1, -1, -1, 0)


def test_copies_are_the_same_formula():
    surface, curve = made("torus"), FormulaCurve("cos(t)", "sin(t)", "t", 0, 1)
    turned = surface.transformed(np.diag([1.0, 2, 3]), np.ones(3)).restricted(1, 2, 0, 1)
    for shape in (copy.copy(turned), copy.deepcopy(turned), pickle.loads(pickle.dumps(turned))):
        assert shape.formula is surface.formula
        assert shape.domain == (1, 2, 0, 1)
        np.testing.assert_array_equal(shape.jet(1.5, 0.5), turned.jet(1.5, 0.5))
    assert pickle.loads(pickle.dumps(curve)).formula is curve.formula


READ_PICKLE = """
import pickle, sys
surface = pickle.load(open(sys.argv[1], "rb"))
print(surface.domain, *(float(x).hex() for row in surface.jet(1.5, 0.5) for x in row))
"""


def test_another_process_compiles_anew(tmp_path):
    surface = made("torus").transformed(np.diag([1.0, 2, 3]), np.ones(3))
    path = tmp_path / "surface.pickle"
    path.write_bytes(pickle.dumps(surface))
    command = [sys.executable, "-c", READ_PICKLE, str(path)]
    answer = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    numbers = [float(x).hex() for row in surface.jet(1.5, 0.5) for x in row]
    assert answer.split(") ")[1].split() == numbers
    assert surface.formula.address < 2**53


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            "uu + 1",
            r"Unknown symbol 'uu' in z = uu \+ 1 at position 1\. Did you mean 'u'\? Known: u,",
        ),
        ("1 + radius*u", r"'radius'.*position 5.*Known: u, v, bend, pi, E, sin"),
        ("bent*u", r"Did you mean 'bend'\?"),
        ("sine(u)", r"Unknown symbol 'sine'.*Did you mean 'sin'\?"),
        ("u + (v", r"syntax error at position 5: '\(' was never closed"),
        ("u +* v", "syntax error at position 4"),
        ("u v", "syntax error at position 3"),
        ("", "is empty"),
        ("u\n+v", "one line"),
        ("u*" * 2500 + "v", "at most 4000 are read"),
        ("u^2", r"powers are written \*\*, not \^"),
        ("u // 2", "FloorDiv is not arithmetic"),
        ("u % 2", "Mod is not arithmetic"),
        ("__import__('os').system('true')", "only the named functions may be called"),
        ("(lambda: 1)()", "only the named functions may be called"),
        ("u.real", "Attribute is not arithmetic"),
        ("[u for u in (1, 2)]", "ListComp is not arithmetic"),
        ("u if v else 1", "IfExp is not arithmetic"),
        ("'u'", "not a number"),
        ("True*u", "not a number"),
        ("2j*u", "not a number"),
        ("sin", "sin needs its argument in parentheses"),
        ("sin(u, v)", "sin takes 1 argument at"),
        ("atan2(u)", "atan2 takes 2 arguments at"),
        ("u(v)", "u is not a function: write a product"),
        ("9**9**9*u", "a power beyond float64"),
        ("u**1000", "exponent 1000: at most 64"),
        ("1e999*u", "a number beyond float64"),
        ("u/(v - v)", "division by zero"),
        ("u + 0**(-1)", "division by zero"),
        ("sqrt(-1)*u", "divides by zero or is not real"),
        ("log(0)", "not a finite real number"),
        (None, "give text such as"),
        (float("nan"), "finite number"),
        (sympy.Symbol("w") * 2, "Unknown symbol 'w'"),
        (sympy.gamma(sympy.Symbol("u")), "gamma.*is not known"),
        (sympy.Symbol("u") * sympy.I, "not known"),
        (sympy.Symbol("u") ** 100, "exponent 100"),
    ],
)
def test_unreadable_formulas_are_refused(text, words):
    with pytest.raises(FormulaError, match=words):
        FormulaSurface("u", "v", text, (-1, 1, -1, 1), {"bend": 0.3})


@pytest.mark.parametrize(
    ("formulas", "domain", "words"),
    [
        # a pole between all points of any sampling
        (("u", "v", "1/(u - 0.123456789)"), (-1, 1, -1, 1), r"pole.*u = 0\.123457, v ="),
        (("u", "v", "1/(u - 0.5)"), (-1, 1, -1, 1), r"pole.*u = 0\.5, v ="),
        (("u", "v", "1/(u - v - 0.1)"), (-1, 1, -1, 1), "pole"),
        (("u", "v", "tan(u)"), (0, 3, -1, 1), r"pole.*u = 1\.5708, v"),
        (("u", "v", "log(u)"), (0, 1, -1, 1), r"pole.*u = \d(\.\d+)?e-\d+, v"),
        (("u", "v", "sqrt(1 - u**2 - v**2)"), (-1, 1, -1, 1), "is not real"),
        (("u", "v", "asin(u)"), (-2, 1, -1, 1), "is not real"),
        (("u", "v", "(u - 0.3)**0.5"), (0, 1, -1, 1), "is not real"),
        (("u", "v", "abs(u - 0.3)"), (0, 1, -1, 1), r"kink.*u = 0\.3, v"),
        (("u", "v", "sqrt(u**2 + v**2)"), (-1, 1, -1, 1), r"kink"),
        (("u", "v", "exp(exp(exp(8*u)))"), (-1, 1, -1, 1), "pole"),
        (("1", "2", "3"), (-1, 1, -1, 1), "a point, of zero size"),
        (("u", "u**2", "2"), (-1, 1, -1, 1), "do not depend on v: a curve, of zero size"),
        (("u + v", "u + v", "u + v"), (-1, 1, -1, 1), "vanishes at about"),
        # the apex of a cone inside; the same at its side is a pole of the patch
        (("v*cos(u)", "v*sin(u)", "v"), (0, 1, -0.7, 1), r"vanishes at about u = .*, v = .*e-1"),
        (("u**3", "v", "u**2"), (-0.7, 1, -1, 1), r"vanishes at about u = .*e-1"),
        (("u", "v", "u*v"), (1, -1, -1, 1), r"domain = \(1.0, -1.0, -1.0, 1.0\) is empty.*u0 < u1"),
        (("u", "v", "u*v"), (-1, 1, 1, 1), "is empty: give v0 < v1"),
        (("u", "v", "u*v"), (-1, np.inf, 1, 2), "is not finite"),
        (("u", "v", "u*v"), (-1, np.nan, 1, 2), "is not finite"),
        (("u", "v", "u*v"), (-1, 1), r"give \(u0, u1, v0, v1\)"),
        (("u", "v", "u*v"), (-1, "a", 0, 1), "is not numeric"),
    ],
)
def test_formulas_that_are_no_patch_are_refused(formulas, domain, words):
    with pytest.raises(FormulaError, match=words):
        FormulaSurface(*formulas, domain)


@pytest.mark.parametrize(
    "formulas_domain",
    [
        (("v*cos(u)", "v*sin(u)", "v"), (0, 1, 0, 1)),  # a collapsed side
        (("u", "v", "sqrt(1 - u**2 - v**2)"), (-0.7, 0.7, -0.7, 0.7)),
        (("u", "v", "1/(u - 0.123456789)"), (0.124, 1, -1, 1)),
        (("u", "v", "u**2.5"), (0, 1, 0, 1)),
        (("u", "v", "abs(u - 3)"), (-1, 1, -1, 1)),
    ],
)
def test_patches_at_the_brink_are_accepted(formulas_domain):
    formulas, domain = formulas_domain
    assert FormulaSurface(*formulas, domain).domain == domain


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        (None, "Unknown symbol 'a'"),
        ({"b": 1.0}, "Unknown symbol 'a'.*Known: u, v, b,"),
        ({"a": np.nan}, "Parameter a = nan"),
        ({"a": "wide"}, "Parameter a = 'wide' is not a number"),
        ({"a": None}, "Parameter a = None is not a number"),
        ({"a": 1.0, "u": 1.0}, "Parameter 'u': give a name"),
        ({"a": 1.0, "sin": 1.0}, "Parameter 'sin': give a name"),
        ({"a": 1.0, "two words": 1.0}, "Parameter 'two words': give a name"),
    ],
)
def test_parameters_are_checked(parameters, words):
    with pytest.raises(FormulaError, match=words):
        FormulaSurface("u", "v", "a*u*v", (-1, 1, -1, 1), parameters)


@pytest.mark.parametrize(
    ("formulas", "ends", "words"),
    [
        (("1", "2", "3"), (0, 1), "a point, of zero size"),
        (("t**3", "t**2", "0"), (-0.7, 1), "tangent vanishes at about t = .*e-"),
        (("t", "1/(t - 0.123456789)", "0"), (0, 1), r"pole.*t = 0\.123457"),
        (("t", "u", "0"), (0, 1), "Unknown symbol 'u'.*Known: t,"),
        (("t", "t", "0"), (1, 1), "is empty: give first < last"),
        (("t", "t", "0"), (0, np.inf), "is not finite"),
    ],
)
def test_formulas_that_are_no_curve_are_refused(formulas, ends, words):
    with pytest.raises(FormulaError, match=words):
        FormulaCurve(*formulas, *ends)


def test_the_missing_library_names_its_extra(monkeypatch):
    imported = importlib.import_module

    def without_sympy(name, *rest):
        if name == "sympy":
            raise ModuleNotFoundError("No module named 'sympy'", name="sympy")
        return imported(name, *rest)

    monkeypatch.setattr(importlib, "import_module", without_sympy)
    with pytest.raises(ImportError, match=r'pip install "standoff\[formulas\]"'):
        FormulaSurface("u", "v", "u*v", (-1, 1, -1, 1))


def test_sympy_is_not_imported_before_it_is_needed():
    code = "import sys, standoff.geometry.formulas; print('sympy' in sys.modules)"
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert answer.stdout.strip() == "False"


@pytest.mark.parametrize("parameters", [[1], "a", 3])
def test_parameters_must_be_a_mapping(parameters):
    with pytest.raises(FormulaError, match="mapping"):
        FormulaSurface("u", "v", "u*v", (0, 1, 0, 1), parameters)
