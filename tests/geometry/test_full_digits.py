"""Formulas whose numbers have all their digits, against mpmath's own differentiation."""

import mpmath
import numpy as np
import pytest

from draws import draws
from standoff.bodies.proofs.interval import prove
from standoff.geometry.formulas import FormulaCurve, FormulaSurface
from standoff.geometry.formulas.enclosures import Enclosure
from standoff.geometry.formulas.series_program import series_program
from standoff.geometry.intervals import Interval

SURFACES = {
    "asphere": (
        "w*v*cos(u)",
        "w*v*sin(u)",
        "h - (c*(w*v)**2/(1 + sqrt(1 - (1 + k)*c**2*(w*v)**2)) + a*(w*v)**4 + b*(w*v)**6)",
    ),
    "egg": (
        "w*cos(u)*cos(v)/(1 + c*sin(v))",
        "h*sin(u)*cos(v)/(1 + c*sin(v))",
        "(w + a)*sin(v)/(3 + k)**(1/3)",
    ),
    "cascade": (
        "u",
        "v",
        "a/(h + c*u**2/(1 + k*v**2/(2 + b*u*v)))**3 + w**0.7*sqrt(h + c*u + a*v)",
    ),
    "powers": ("u", "v", "w*((h + c*u + a*v)/(w + h))**20 + b*((w + h)/(h + c*u + a*v))**9"),
    "bump": ("w*u", "h*v", "exp(-(c*u**2 + b*v**2)/(1 + k)**2)*(a + b*u)**5"),
}
CURVES = {
    "spiral": ("w*cos(h*t)/(1 + c*t)", "h*sin(w*t)/(1 + c*t)", "a*t**3 + sqrt(h + k*t)"),
    "cascade": ("t", "a/(h + c*t/(1 + k*t**2/(2 + b*t)))**3", "b*exp(c*t)"),
    "powers": ("t", "h*t", "w*((h + c*t)/(w + h))**20 + b*((w + h)/(h + c*t))**9"),
}
DOMAIN = (0.2, 0.9)
PROVEN = ("asphere", "bump")
LEFT = mpmath.mpf(10) ** -40


def numbers(rng, digits):
    """Parameters of this many digits, all but k of both small and large values."""
    drawn = {
        "w": rng.uniform(2, 6), "h": rng.uniform(2, 4), "c": rng.uniform(0.01, 0.09),
        "k": rng.uniform(-0.9, 0.9), "a": 10.0 ** rng.uniform(-6, -2),
        "b": 10.0 ** rng.uniform(-9, -2),
    }  # fmt: skip
    return {name: float(f"{x:.{digits}g}") for name, x in drawn.items()}


def known(texts, parameters, names, at):
    """The jet, differentiated numerically to 60 digits from the decimals of the parameters."""
    orders = (
        [(0,), (1,), (2,)] if len(names) == 1 else [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]
    )
    with mpmath.workdps(60):
        given = {name: mpmath.mpf(repr(x)) for name, x in parameters.items()}
        given |= {f: getattr(mpmath, f) for f in ("sin", "cos", "sqrt", "exp")}
        texts = [t.replace("0.7", "(mpf(7)/10)").replace("(1/3)", "(mpf(1)/3)") for t in texts]

        def value(text):
            code = compile(text, "formula", "eval")
            return lambda *x: eval(
                code, {"mpf": mpmath.mpf} | given | dict(zip(names, x, strict=True))
            )

        at = tuple(map(mpmath.mpf, at))
        return [mpmath.diff(value(t), at, order) if sum(order) else value(t)(*at)
                for order in orders for t in texts]  # fmt: skip


def holds(bounds, exact):
    """Up to what is left of a numerical derivative that is zero."""
    rows = zip(bounds.lo[:, 0], exact, bounds.hi[:, 0], strict=True)
    return all(lo - LEFT <= x <= hi + LEFT for lo, x, hi in rows)


def check(patch, texts, parameters, names, rng):
    at = rng.uniform(*DOMAIN, len(names))
    exact = known(texts, parameters, names, at)
    formula = patch.formula
    found = formula.values(*at).ravel()
    scale = np.array([float(abs(x)) for x in exact]) + 1.0
    assert np.abs(found - np.array(exact, dtype=float)).max() <= 1e-11 * scale.max(), parameters
    sides = [Interval(np.array([x]), np.array([x])) for x in at]
    assert holds(Enclosure(formula.jet, formula.variables).at(*sides), exact)
    series = series_program(formula)(*sides, order=2)
    for k, each in enumerate(series):
        assert holds(Interval(each.lo[:1], each.hi[:1]), exact[k : k + 1])
    low, high = patch.box()
    assert all(low[k] <= exact[k] <= high[k] for k in range(3))


@pytest.mark.parametrize("digits", [3, 17])
@pytest.mark.parametrize("name", SURFACES)
def test_a_surface_is_what_mpmath_says(name, digits, rng):
    for _ in range(draws(2)):
        parameters = numbers(rng, digits)
        surface = FormulaSurface(*SURFACES[name], (*DOMAIN, *DOMAIN), parameters)
        check(surface, SURFACES[name], parameters, "uv", rng)
        if name in PROVEN:
            assert np.isfinite(prove(surface).defect)


@pytest.mark.parametrize("digits", [3, 17])
@pytest.mark.parametrize("name", CURVES)
def test_a_curve_is_what_mpmath_says(name, digits, rng):
    for _ in range(draws(3)):
        parameters = numbers(rng, digits)
        curve = FormulaCurve(*CURVES[name], *DOMAIN, parameters)
        check(curve, CURVES[name], parameters, "t", rng)


@pytest.mark.parametrize("c", [0.05, 0.05012345678901234])
def test_a_lens_of_full_digits_is_proven_convex(c):
    z = "3 - (c*(6*v)**2/(1 + sqrt(1 - (1 + k)*c**2*(6*v)**2)) + a*(6*v)**4)"
    parameters = {"c": c, "k": -0.8, "a": -2e-5}
    dome = FormulaSurface("6*v*cos(u)", "6*v*sin(u)", z, (0, 2 * np.pi, 0, 1), parameters)
    assert prove(dome).convex
