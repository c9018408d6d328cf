"""Straight-line programs from SymPy expressions: one text for numbers, intervals and kernels."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any

from standoff.errors import FormulaError, StandoffTypeError
from standoff.geometry.formulas.expressions import sympy_module

# Common subexpressions are named r0, r1, ...
SHARED = "r"
# Bits: products of a factored form's numbers stay below 2 to this. Those of fractions with many
# digits, brought to one denominator, do not; the rest up to 2^1024 is for the variables.
MOST_BITS = 900
# Decimal digits to which a constant such as sqrt(2) is computed before it is rounded to float64.
DIGITS = 40
# How a number that float64 cannot represent is written: the nearest one, or an interval about it.
NEAREST, ENCLOSED = "{}", "near({})"
# Infinity as a literal.
INFINITE = "1e999"


def jet_expressions(formula: Sequence[Any], variables: tuple[str, ...]) -> list[Any]:
    """Coordinates, first and second partial derivatives, three expressions each.

    u, v: x, x_u, x_v, x_uu, x_uv, x_vv; t: x, x_t, x_tt.
    """
    sympy = sympy_module()
    symbols = [sympy.Symbol(v) for v in variables]
    first = [[sympy.diff(c, s) for c in formula] for s in symbols]
    second = [
        [sympy.diff(c, t) for c in first[i]] for i in range(len(symbols)) for t in symbols[i:]
    ]
    rows = [list(formula), *first, *second]
    return [shorter(c) for row in rows for c in row]


def shorter(expression: Any) -> Any:
    """The shorter of an expression and the same with common factors taken out."""
    sympy = sympy_module()
    factored = sympy.factor_terms(expression)
    if factored.count_ops() < expression.count_ops() and bits_of(factored) <= MOST_BITS:
        return factored
    return expression


def bits_of(e: Any) -> float:
    """Of an expression's program: log2 of the greatest product of its numbers, or its inverse."""
    if e.is_Rational:
        return float(max(abs(e.p).bit_length(), e.q.bit_length())) if e else 0.0
    parts = [bits_of(a) for a in e.args]
    if e.is_Pow and e.exp.is_Rational:
        return parts[0] * max(1.0, abs(float(e.exp)))
    if not e.is_Mul:
        return max(parts, default=0.0)
    below = [b for a, b in zip(e.args, parts, strict=True) if a.is_Pow and a.exp.is_negative]
    return max(sum(below), sum(parts) - sum(below))


class ProgramText:
    """Python text of expressions with +, -, *, /, ** (integer), power() and named functions.

    near : NEAREST, or ENCLOSED for intervals, which contain even numbers beyond float64
    """

    def __init__(self, near: str = NEAREST) -> None:
        self.near = near

    def body(self, expressions: Sequence[Any]) -> tuple[list[str], list[str]]:
        """(assignments of common parts, one line each; the expressions in terms of these)."""
        sympy = sympy_module()
        names = sympy.numbered_symbols(SHARED)
        shared, reduced = sympy.cse(list(expressions), symbols=names, order="none")
        lines = [f"{name} = {self.code(e)}" for name, e in shared]
        return lines, [self.code(e) for e in reduced]

    def code(self, e: Any) -> str:
        sympy = sympy_module()
        if e.is_Symbol:
            return str(e.name)
        if (
            e.is_Rational
            or e is sympy.pi
            or e is sympy.E
            or (e.is_number and bits_of(e) > MOST_BITS)
        ):
            return self.number(e)
        if e.is_Add:
            return "(" + " + ".join(self.code(a) for a in e.args) + ")"
        if e.is_Mul:
            return self.product(e)
        if isinstance(e, sympy.exp):
            return f"exp({self.code(e.args[0])})"
        if e.is_Pow:
            return self.power(e.base, e.exp)
        if e.is_Function:
            return f"{e.func.__name__}({', '.join(self.code(a) for a in e.args)})"
        raise StandoffTypeError(f"No code for {type(e).__name__}: {e}")

    def number(self, e: Any) -> str:
        value = float(e if e.is_Rational else e.evalf(DIGITS))
        if e != 0 and not sys.float_info.min <= abs(value) <= sys.float_info.max:
            if self.near == NEAREST:
                raise FormulaError(
                    f"A formula, or a derivative of it, has the number {e.evalf(6)}, beyond "
                    "float64: choose another unit, or another scale of its variables."
                )
            return self.near.format(repr(value).replace("inf", INFINITE))
        text = repr(value)
        if not (e.is_Rational and sympy_module().Rational(value) == e):
            return self.near.format(text)
        return f"({text})" if value < 0.0 else text

    def product(self, e: Any) -> str:
        above, below = [], []
        for a in e.args:
            if a.is_Pow and a.exp.is_Rational and a.exp < 0:
                below.append(self.power(a.base, -a.exp))
            else:
                above.append(self.code(a))
        top = "*".join(above) or "1.0"
        return f"({top}/({'*'.join(below)}))" if below else f"({top})"

    def power(self, base: Any, exponent: Any) -> str:
        if exponent.is_Rational and exponent < 0:
            return f"(1.0/{self.power(base, -exponent)})"
        inner = self.code(base)
        if exponent.is_Integer:
            return inner if exponent == 1 else f"({inner}**{int(exponent)})"
        if exponent.is_Rational and exponent.q == 2:
            root, whole = f"sqrt({inner})", exponent.p // 2
            return root if whole == 0 else f"({root}**{int(exponent.p)})"
        return f"power({inner}, {self.code(exponent)})"
