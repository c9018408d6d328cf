"""Curvature of a patch given by a formula, as expressions whose signs decide its convexity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import Any

from standoff.bodies.proofs.formulas.symbolic import (
    Fraction,
    Ring,
    TooLargeError,
    cross,
    dot,
    scale_of,
)
from standoff.geometry.formulas.compiled import Formula
from standoff.geometry.formulas.expressions import sympy_module

# Pairs of sine and cosine for which both replacements are tried.
MOST_PAIRS = 3
# Terms of a squared normal that is written multiplied out.
SHORT = 2


@dataclass(frozen=True, eq=False)
class CurvatureForms:
    """What decides convexity, as SymPy expressions in u, v of the formula itself.

    Attributes
    ----------
    gauss : Gaussian curvature K
    mean_square : H², of the mean curvature
    gauss_signs, mean_signs : expressions whose product has the sign of K, and of H against
        x_u x x_v, wherever the normal does not vanish
    normal : three expressions along x_u x x_v, without the common factor that vanishes at a
        collapsed side
    normal_signs : expressions whose product has the sign of that factor
    exact : common factors were taken out; else bounds of these have none at collapsed sides
    """

    gauss: Any
    mean_square: Any
    gauss_signs: tuple[Any, ...]
    mean_signs: tuple[Any, ...]
    normal: tuple[Any, ...]
    normal_signs: tuple[Any, ...]
    exact: bool


@lru_cache(maxsize=256)
def curvature_forms(formula: Formula) -> CurvatureForms:
    """The forms of a surface's formula, in the shortest way that exact algebra finds."""
    best, least = None, 0
    for kept in _choices(formula):
        try:
            ring = Ring(formula.jet, kept)
            parts = _fractions(ring, formula)
        except TooLargeError:
            continue
        terms = sum(len(f.above) + len(f.below) for f in (*parts[:2], *parts[2]))
        if best is None or terms < least:
            best, least = (ring, parts), terms
    if best is not None:
        try:
            return _reduced(*best)
        except TooLargeError:
            pass
    return forms_as_written(formula)


def _choices(formula: Formula) -> list[Sequence[Any]]:
    pairs = list(Ring(formula.jet).pairs)
    if len(pairs) > MOST_PAIRS:
        return [[]]
    return [
        [p[k] for p, k in zip(pairs, which, strict=True)]
        for which in product((0, 1), repeat=len(pairs))
    ]


def _numerators(x: Sequence[Sequence[Any]], two: Any) -> tuple[Any, Any, Any]:
    """(K |N|^4, 2 H |N|^3, N) of a jet, N = x_u x x_v."""
    _, xu, xv, xuu, xuv, xvv = x
    n = cross(xu, xv)
    lower, mixed, upper = dot(n, xuu), dot(n, xuv), dot(n, xvv)
    first, both, second = dot(xu, xu), dot(xu, xv), dot(xv, xv)
    gauss = lower * upper - mixed * mixed
    mean = first * upper + second * lower - two * both * mixed
    return gauss, mean, n


def _fractions(ring: Ring, formula: Formula) -> tuple[Fraction, Fraction, Any]:
    """(K |N|^4, 2 H |N|^3, N)."""
    rows = [ring.read(e) for e in formula.jet]
    return _numerators([rows[k : k + 3] for k in range(0, 18, 3)], ring.number(2))


def _reduced(ring: Ring, parts: tuple[Fraction, Fraction, Any]) -> CurvatureForms:
    """With N = c n, n free of common factors: K = (K |N|^4 / c^4) / (n.n)^2, and so for H^2."""
    sympy = sympy_module()
    gauss, mean, n = parts
    # over one denominator, without the ring's relations: they would undo the division
    below = ring.one
    for f in n:
        below = below * (f.below / below.gcd(f.below))
    raised = [f.above * (below / f.below) for f in n]
    common = ring.context.constant(0)
    for p in raised:
        common = p if common == 0 else common.gcd(p)
    c = ring.fraction(common, below)
    free, hidden = ring.without_replaced([p / common for p in raised])
    scale = scale_of(free)
    free = [p / scale for p in free]
    c = c * Fraction(ring, hidden * scale, ring.one)
    direction = [Fraction(ring, p, ring.one) for p in free]
    normal = tuple(ring.written(p) for p in free)
    # a sum of squares has good bounds; its terms multiplied out only where few are left
    square = dot(direction, direction).above
    few = len(square) <= SHORT
    area = ring.written(square) if few else sympy.Add(*(e**2 for e in normal))

    def whole(f: Fraction) -> tuple[Any, tuple[Any, ...]]:
        """The fraction, and its factors of odd multiplicity."""
        if f.is_zero:
            return sympy.Integer(0), (sympy.Integer(0),)
        above, below = ring.factors(f.above), ring.factors(f.below)
        value = sympy.Mul(*(e**m for e, m in above)) / sympy.Mul(*(e**m for e, m in below))
        return value, tuple(e for e, m in [*above, *below] if m % 2)

    gauss_value, gauss_signs = whole(gauss / c**4)
    mean_value = whole(mean * mean / c**6)[0]
    return CurvatureForms(
        gauss=gauss_value / area**2,
        mean_square=mean_value / (4 * area**3),
        gauss_signs=gauss_signs,
        mean_signs=whole(mean)[1],
        normal=normal,
        normal_signs=whole(c)[1],
        exact=True,
    )


@lru_cache(maxsize=256)
def forms_as_written(formula: Formula) -> CurvatureForms:
    """The forms without exact algebra: no bounds at collapsed sides, but nothing multiplied out."""
    jet = formula.jet
    two = sympy_module().Integer(2)
    gauss, mean, n = _numerators([jet[k : k + 3] for k in range(0, 18, 3)], two)
    area = dot(n, n)
    return CurvatureForms(
        gauss=gauss / area**2,
        mean_square=mean**2 / (4 * area**3),
        gauss_signs=(gauss,),
        mean_signs=(mean,),
        normal=n,
        normal_signs=(),
        exact=False,
    )
