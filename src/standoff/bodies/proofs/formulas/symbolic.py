"""Exact algebra of formulas: common factors out, so that what is left has a sign to prove.

Every formula is a fraction of polynomials in *generators*: u, v, sines and cosines, exponentials,
roots. Generators are taken as independent except for sin² + cos² = 1, cosh² - sinh² = 1 and
root^q = its radicand; an identity of polynomials stays true whatever the generators stand for.
Polynomials are python-flint's.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import lcm
from typing import Any

from standoff.geometry.formulas.expressions import flint_module, sympy_module

# Terms of a polynomial that is still multiplied, and still factored: some tenths of a second.
MOST_TERMS = 4000
MOST_TERMS_FACTORED = 600
# log2 of a polynomial's greatest coefficient: beyond, the squares in curvature leave float64.
LONG_BITS = 200


class TooLargeError(Exception):
    """The exact algebra would take too long; bounds are then taken without it."""


@dataclass(frozen=True, eq=False)
class Fraction:
    """above / below, polynomials of one ring."""

    ring: Ring
    above: Any
    below: Any

    def __add__(self, other: Fraction) -> Fraction:
        if self.below == other.below:
            return self.ring.fraction(self.above + other.above, self.below)
        above = self.above * other.below + other.above * self.below
        return self.ring.fraction(above, self.below * other.below)

    def __sub__(self, other: Fraction) -> Fraction:
        return self + other * self.ring.number(-1)

    def __mul__(self, other: Fraction) -> Fraction:
        self.ring.check(self.above, other.above)
        return self.ring.fraction(self.above * other.above, self.below * other.below)

    def __truediv__(self, other: Fraction) -> Fraction:
        self.ring.check(self.above, other.below)
        return self.ring.fraction(self.above * other.below, self.below * other.above)

    def __pow__(self, exponent: int) -> Fraction:
        if exponent < 0:
            return self.ring.number(1) / self**-exponent
        result = self.ring.number(1)
        for _ in range(exponent):
            result = result * self
        return result

    @property
    def is_zero(self) -> bool:
        return bool(self.above == 0)


class Ring:
    """The polynomials over the rationals in what the expressions are made of.

    kept : the sines and cosines (or cosh and sinh) whose squares stay; those of their partners are
        replaced. Which choice serves depends on the formula: its denominators should hold kept ones
    """

    def __init__(self, expressions: Iterable[Any], kept: Sequence[Any] = ()) -> None:
        sympy, flint = sympy_module(), flint_module()
        roots: dict[Any, int] = {}
        plain: dict[Any, None] = {}
        self.seen: dict[Any, Any] = {}
        for e in expressions:
            _collect(e, roots, plain, self.seen)
        self.roots = roots
        self.pairs = _pairs(plain)
        plain |= {e: None for pair in self.pairs for e in pair}
        self.replaced = [
            (b, a, sign) if a in kept else (a, b, sign) for (a, b), sign in self.pairs.items()
        ]
        # lexicographic order: in each relation what is replaced stands before what replaces it
        first = [sympy.root(b, q, evaluate=False) for b, q in roots.items()]
        gone = {a for a, _, _ in self.replaced}
        names = sorted(plain, key=lambda e: (e not in gone, str(e)))
        self.generators = [*first, *names]
        texts = [f"g{k}" for k in range(len(self.generators))]
        # written as first met: bounds of -(u - 1)**2 are better than those of -u**2 + 2*u - 1
        self.shapes = [self.seen.get(g, g) for g in self.generators]
        self.context = flint.fmpq_mpoly_ctx.get(texts, flint.Ordering.lex)
        self.of = dict(zip(self.generators, self.context.gens(), strict=True))
        self.one = self.context.constant(1)
        self.relations = list(self._relations())

    def _relations(self) -> Iterable[Any]:
        for (base, q), generator in zip(self.roots.items(), self.generators, strict=False):
            radicand = self.read(base)
            if radicand.below == self.one:
                yield self.of[generator] ** q - radicand.above
        for gone, stays, sign in self.replaced:
            one = 1 if sign > 0 or isinstance(gone, sympy_module().cosh) else -1
            yield self.of[gone] ** 2 + sign * self.of[stays] ** 2 - one

    def check(self, a: Any, b: Any) -> None:
        if len(a) * len(b) > MOST_TERMS * 50 or max(len(a), len(b)) > MOST_TERMS:
            raise TooLargeError

    def number(self, value: Any) -> Fraction:
        return Fraction(self, self.context.constant(value), self.one)

    def reduced(self, polynomial: Any) -> Any:
        for relation in getattr(self, "relations", ()):
            if len(polynomial) > MOST_TERMS:
                raise TooLargeError
            polynomial = polynomial % relation
        return polynomial

    def fraction(self, above: Any, below: Any) -> Fraction:
        """above / below in lowest terms."""
        above, below = self.reduced(above), self.reduced(below)
        if below == 0:
            raise ZeroDivisionError("a formula whose denominator vanishes everywhere")
        if len(above) > MOST_TERMS or len(below) > MOST_TERMS:
            raise TooLargeError
        if below != self.one and above != 0:
            common = above.gcd(below)
            above, below = above / common, below / common
        if above == 0:
            below = self.one
        elif below.is_constant():
            above, below = above / below, self.one
        return Fraction(self, above, below)

    def without_replaced(self, polynomials: Sequence[Any]) -> tuple[list[Any], Any]:
        """Polynomials without their common factors among the replaced, and the product of these.

        A greatest common divisor does not see sin v in (1 - cos² v) cos u. But p = sin v q where
        sin v p = (1 - cos² v) q, and this the division finds.
        """
        found, product = list(polynomials), self.one
        for gone, _, _ in self.replaced:
            factor = self.of[gone]
            square = self.reduced(factor**2)
            while any(found):
                parts = [divmod(self.reduced(factor * p), square) for p in found]
                if any(rest for _, rest in parts):
                    break
                found, product = [q for q, _ in parts], product * factor
        return found, product

    def read(self, e: Any) -> Fraction:
        """A SymPy expression as a fraction of polynomials."""
        flint = flint_module()
        e = canonical(e)
        if e.is_Rational:
            return self.number(flint.fmpq(int(e.p), int(e.q)))
        if e.is_Add:
            total = self.number(0)
            for a in e.args:
                total = total + self.read(a)
            return total
        if e.is_Mul:
            total = self.number(1)
            for a in e.args:
                total = total * self.read(a)
            return total
        if e.is_Pow and e.exp.is_Integer:
            return self.read(e.base) ** int(e.exp)
        if e.is_Pow and e.exp.is_Rational and not isinstance(e, sympy_module().exp):
            q = self.roots[e.base]
            root = self.of[sympy_module().root(e.base, q, evaluate=False)]
            return Fraction(self, root, self.one) ** int(e.exp * q)
        return Fraction(self, self.of[e], self.one)

    def written(self, polynomial: Any) -> Any:
        """A polynomial as a SymPy expression."""
        sympy = sympy_module()
        terms = []
        for powers, c in polynomial.terms():
            parts = [g ** int(p) for g, p in zip(self.shapes, powers, strict=True) if p]
            terms.append(sympy.Mul(sympy.Rational(int(c.p), int(c.q)), *parts))
        return sympy.Add(*terms)

    def factors(self, polynomial: Any) -> list[tuple[Any, int]]:
        """(SymPy expression, multiplicity) of each factor, the constant first."""
        sympy = sympy_module()
        if len(polynomial) > MOST_TERMS_FACTORED:
            constant, parts = polynomial.factor_squarefree()
        else:
            constant, parts = polynomial.factor()
        found = []
        for p, m in parts:
            scale = scale_of([p])
            constant = constant * scale ** int(m)
            found.append((self.written(p / scale), int(m)))
        return [(sympy.Rational(int(constant.p), int(constant.q)), 1), *found]


def scale_of(polynomials: Sequence[Any]) -> Any:
    """A power of two to divide polynomials by whose coefficients are too long for float64.

    1 where they are not: it would only make the program longer.
    """
    bits = max(
        (
            abs(int(c.p)).bit_length() - int(c.q).bit_length()
            for p in polynomials
            for c in p.coeffs()
        ),
        default=0,
    )
    return flint_module().fmpq(2) ** (bits if abs(bits) > LONG_BITS else 0)


def canonical(e: Any) -> Any:
    """Functions and roots with their arguments multiplied out, so that equal ones are one."""
    sympy = sympy_module()
    if e.is_Function:
        return e.func(*(sympy.expand(a) for a in e.args))
    if e.is_Pow and e.exp.is_Rational and not e.exp.is_Integer:
        return sympy.Pow(sympy.expand(e.base), e.exp)
    return e


def _pairs(plain: Iterable[Any]) -> dict[tuple[Any, Any], int]:
    """{(sin w, cos w): 1, (cosh w, sinh w): -1}: sin² + cos² = 1, cosh² - sinh² = 1."""
    sympy = sympy_module()
    pairs: dict[tuple[Any, Any], int] = {}
    for e in plain:
        if isinstance(e, sympy.sin | sympy.cos):
            pairs[sympy.sin(*e.args), sympy.cos(*e.args)] = 1
        if isinstance(e, sympy.cosh | sympy.sinh):
            pairs[sympy.cosh(*e.args), sympy.sinh(*e.args)] = -1
    return pairs


def _collect(e: Any, roots: dict[Any, int], plain: dict[Any, None], seen: dict[Any, Any]) -> None:
    """Note radicands with their roots, and all that is not a sum, product or power."""
    shape, e = e, canonical(e)
    if e.is_Rational:
        return
    if e.is_Add or e.is_Mul:
        for a in e.args:
            _collect(a, roots, plain, seen)
    elif e.is_Pow and e.exp.is_Integer:
        _collect(e.base, roots, plain, seen)
    elif e.is_Pow and e.exp.is_Rational and not isinstance(e, sympy_module().exp):
        _collect(e.base, roots, plain, seen)
        roots[e.base] = lcm(roots.get(e.base, 1), int(e.exp.q))
    else:
        plain.setdefault(e)
        seen.setdefault(e, shape)


def dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    """Of fractions, or of expressions."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Sequence[Any], b: Sequence[Any]) -> tuple[Any, Any, Any]:
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )
