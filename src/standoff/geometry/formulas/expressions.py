"""Formulas as text or SymPy expressions, read without evaluating any Python.

Text is parsed to Python's syntax tree, and only numbers, the variables, the parameters, pi, E,
the functions below, + - * / ** and parentheses are accepted; SymPy's own parser would run it.
Numbers and parameters become exact fractions (0.3 is 3/10), so that SymPy can simplify.
"""

from __future__ import annotations

import ast
import importlib
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from standoff.checks.names import did_you_mean
from standoff.checks.real_numbers import real_array, shown
from standoff.errors import FormulaError

FUNCTIONS = {
    "sin": "sin", "cos": "cos", "tan": "tan",
    "asin": "asin", "acos": "acos", "atan": "atan", "atan2": "atan2",
    "sinh": "sinh", "cosh": "cosh", "tanh": "tanh",
    "exp": "exp", "log": "log", "sqrt": "sqrt", "abs": "Abs", "Abs": "Abs",
}  # fmt: skip
"""Name in a formula: name in SymPy; only functions that are smooth where they are defined."""
CONSTANTS = ("pi", "E")
# Longer text, or a SymPy expression of more parts, is not written by hand; differentiating it twice
# and compiling it could take minutes.
LONGEST = 4000
MOST_PARTS = 2000
# Powers of numbers beyond the range of float64 (2^1024) are rejected before they are computed:
# 9**9**9 would take forever.
GREATEST_POWER = 1000
# A power with an integer exponent up to this is compiled to products.
GREATEST_EXPONENT = 64


def sympy_module() -> Any:
    """SymPy, imported when it is first needed.

    Raises ImportError: it is not installed.
    """
    return _extra("sympy", "SymPy")


def flint_module() -> Any:
    """python-flint, imported when it is first needed.

    Raises ImportError: it is not installed.
    """
    return _extra("flint", "python-flint")


def _extra(module: str, name: str) -> Any:
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise ImportError(
            f'Formulas need {name}: pip install "standoff[formulas]" (missing: {error.name}).'
        ) from error


def parameter_values(
    parameters: Mapping[str, Any] | None, variables: Iterable[str]
) -> dict[str, Any]:
    """The parameters as exact fractions, by name.

    Raises FormulaError: a name that is not an identifier or is taken, a value that is not a finite
    number.
    """
    taken = {*variables, *FUNCTIONS, *CONSTANTS}
    values = {}
    if not isinstance(parameters, Mapping | None):
        raise FormulaError(
            f"parameters = {shown(parameters)}: give a mapping of names to numbers.",
            "parameters",
            parameters,
        )
    for name, value in dict(parameters or {}).items():
        if not str(name).isidentifier() or name in taken:
            raise FormulaError(
                f"Parameter {shown(name)}: give a name that is an identifier and is not one of "
                f"{', '.join(sorted(taken))}.",
                "parameters",
                parameters,
            )
        try:
            # SymPy's own numbers are accepted too
            number = float(real_array(float(value) if hasattr(value, "free_symbols") else value))
        except (TypeError, ValueError) as error:
            raise FormulaError(
                f"Parameter {name} = {shown(value)} is not a number.", "parameters", parameters
            ) from error
        if not np.isfinite(number):
            raise FormulaError(
                f"Parameter {name} = {number}: give a finite number.", "parameters", parameters
            )
        values[name] = _fraction(repr(number))
    return values


def _number(given: Any, name: str) -> float:
    try:
        number = float(real_array(given))
    except (TypeError, ValueError) as error:
        raise FormulaError(f"{name} = {shown(given)} is not a number.", name, given) from error
    if not np.isfinite(number):
        raise FormulaError(f"{name} = {number}: give a finite number.", name, given)
    return number


def read_expression(
    given: Any, name: str, variables: tuple[str, ...], parameters: Mapping[str, Any]
) -> Any:
    """A formula as a SymPy expression in plain symbols named as `variables`.

    Raises FormulaError: unknown symbols (with the nearest known one), bad syntax (with the
    position), anything that is not arithmetic, numbers beyond float64.

    Parameters
    ----------
    given : str, number or sympy.Expr
    name : what it is the formula of ("x"), for messages
    parameters : values by name, as `parameter_values` gives them
    """
    sympy = sympy_module()
    symbols = {v: sympy.Symbol(v) for v in variables}
    known = {**symbols, **parameters, "pi": sympy.pi, "E": sympy.E}
    if isinstance(given, str):
        result = _Text(given, name, known, variables, parameters).expression()
    elif isinstance(given, sympy.Expr):
        result = _rebuilt(given, name, known, variables, parameters)
    elif isinstance(given, int | float | np.integer | np.floating):
        result = _fraction(repr(_number(given, name)))
    else:
        raise FormulaError(
            f"{name} is {shown(given)}: give text such as 'a*cos(u)', a SymPy expression or a "
            "number.",
            name,
            given,
        )
    if not result.is_number and result.free_symbols <= set(symbols.values()):
        if result.has(sympy.zoo, sympy.nan, sympy.oo, sympy.I):
            raise FormulaError(f"{name} = {given} divides by zero or is not real.", name, given)
        return result
    if result.is_finite is False or result.is_real is False or result is sympy.nan:
        raise FormulaError(f"{name} = {given} is not a finite real number: {result}.", name, given)
    return result


def _fraction(text: str) -> Any:
    return sympy_module().Rational(text)


def _unknown(symbol: str, name: str, given: Any, at: str, allowed: Iterable[str]) -> FormulaError:
    names = list(allowed)
    hint = did_you_mean(symbol, names)
    return FormulaError(
        f"Unknown symbol {symbol!r} in {name} = {given}{at}.{hint} Known: {', '.join(names)}.",
        name,
        given,
    )


class _Text:
    """The text of one formula, to be converted to a SymPy expression."""

    def __init__(
        self,
        text: str,
        name: str,
        known: Mapping[str, Any],
        variables: tuple[str, ...],
        parameters: Mapping[str, Any],
    ) -> None:
        self.text = text.strip()
        self.name = name
        self.known = known
        self.names = [*variables, *sorted(parameters), *CONSTANTS]

    def fail(self, node: ast.AST, why: str) -> FormulaError:
        part = ast.get_source_segment(self.text, node) or ""
        return FormulaError(
            f"{self.name} = {self.text}: {why} at position {self.place(node)} ({part[:40]!r}).",
            self.name,
            self.text,
        )

    def place(self, node: ast.AST) -> int:
        """1-based position in the text."""
        return int(getattr(node, "col_offset", 0)) + 1

    def expression(self) -> Any:
        if not self.text:
            raise FormulaError(
                f"{self.name} is empty: give a formula such as 'a*cos(u)'.", self.name, None
            )
        if len(self.text) > LONGEST:
            raise FormulaError(
                f"{self.name} has {len(self.text)} characters: at most {LONGEST} are read.",
                self.name,
                self.text,
            )
        if "\n" in self.text or "\r" in self.text:
            raise FormulaError(f"{self.name} = {self.text!r}: give one line.", self.name, self.text)
        try:
            tree = ast.parse(self.text, mode="eval")
        except SyntaxError as error:
            place = f" at position {error.offset}" if error.offset else ""
            raise FormulaError(
                f"{self.name} = {self.text}: syntax error{place}: {error.msg}.",
                self.name,
                self.text,
            ) from error
        except (ValueError, MemoryError, RecursionError) as error:
            raise FormulaError(
                f"{self.name}: cannot be read: {error}", self.name, self.text
            ) from error
        try:
            return self.build(tree.body)
        except RecursionError as error:
            raise FormulaError(
                f"{self.name} is nested too deeply: use fewer levels.", self.name, None
            ) from error

    def build(self, node: ast.expr) -> Any:
        if isinstance(node, ast.Constant):
            return self.number(node)
        if isinstance(node, ast.Name):
            if node.id in self.known:
                return self.known[node.id]
            if node.id in FUNCTIONS:
                raise self.fail(node, f"{node.id} needs its argument in parentheses,")
            at = f" at position {self.place(node)}"
            raise _unknown(node.id, self.name, self.text, at, [*self.names, *FUNCTIONS])
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.UAdd | ast.USub):
            value = self.build(node.operand)
            return -value if isinstance(node.op, ast.USub) else value
        if isinstance(node, ast.BinOp):
            return self.operation(node)
        if isinstance(node, ast.Call):
            return self.call(node)
        raise self.fail(
            node, f"{type(node).__name__} is not arithmetic (numbers, + - * / **, functions),"
        )

    def number(self, node: ast.Constant) -> Any:
        if isinstance(node.value, bool) or not isinstance(node.value, int | float):
            raise self.fail(node, "not a number")
        text = (ast.get_source_segment(self.text, node) or repr(node.value)).replace("_", "")
        if isinstance(node.value, int):
            text = str(node.value) if node.value.bit_length() <= 1024 else "1e999"
        if not np.isfinite(float(text)) or (float(text) == 0.0 and node.value != 0):
            raise self.fail(node, "a number beyond float64")
        return _fraction(text)

    def operation(self, node: ast.BinOp) -> Any:
        if isinstance(node.op, ast.BitXor):
            raise self.fail(node, "powers are written **, not ^,")
        if not isinstance(node.op, ast.Add | ast.Sub | ast.Mult | ast.Div | ast.Pow):
            raise self.fail(node, f"operator {type(node.op).__name__} is not arithmetic")
        left, right = self.build(node.left), self.build(node.right)
        if isinstance(node.op, ast.Add):
            return left + right
        if isinstance(node.op, ast.Sub):
            return left - right
        if isinstance(node.op, ast.Mult):
            return left * right
        if isinstance(node.op, ast.Div):
            if right.is_zero:
                raise self.fail(node, "division by zero")
            return left / right
        check_power(left, right, lambda why: self.fail(node, why))
        return left**right

    def call(self, node: ast.Call) -> Any:
        if not isinstance(node.func, ast.Name) or node.func.id not in FUNCTIONS:
            if isinstance(node.func, ast.Name):
                at = f" at position {self.place(node)}"
                if node.func.id in self.known:
                    raise self.fail(
                        node, f"{node.func.id} is not a function: write a product with *"
                    )
                raise _unknown(node.func.id, self.name, self.text, at, [*FUNCTIONS, *self.names])
            raise self.fail(node, "only the named functions may be called:")
        wanted = 2 if node.func.id == "atan2" else 1
        if node.keywords or len(node.args) != wanted:
            raise self.fail(node, f"{node.func.id} takes {wanted} argument{'s'[: wanted - 1]}")
        return applied(FUNCTIONS[node.func.id], [self.build(a) for a in node.args])


def check_power(base: Any, exponent: Any, error: Any) -> None:
    """Reject powers that would take forever or leave float64; `error` makes the exception."""
    if exponent.is_Integer and abs(int(exponent)) > GREATEST_EXPONENT and not base.is_number:
        raise error(f"exponent {exponent}: at most {GREATEST_EXPONENT} in size is compiled,")
    if not (base.is_number and exponent.is_number):
        return
    size, times = abs(complex(base.evalf(15))), abs(complex(exponent.evalf(15)))
    if size == 0.0 and complex(exponent.evalf(15)).real < 0.0:
        raise error("division by zero")
    if size > 0.0 and abs(np.log2(size)) * times > GREATEST_POWER:
        raise error("a power beyond float64")


def applied(function: str, arguments: list[Any]) -> Any:
    """A function by its SymPy name; Abs(w) as sqrt(w**2), which SymPy can differentiate twice."""
    sympy = sympy_module()
    if function == "Abs":
        return sympy.sqrt(arguments[0] ** 2)
    return getattr(sympy, function)(*arguments)


def _check_parts(given: Any, name: str) -> None:
    """Reject a user's SymPy expression of too many parts."""
    every = sympy_module().preorder_traversal(given)
    parts = sum(1 for _, _ in zip(every, range(MOST_PARTS), strict=False))
    if parts >= MOST_PARTS:
        raise FormulaError(
            f"{name} has more than {MOST_PARTS} parts: give a simpler expression.", name, given
        )


def _rebuilt(
    given: Any,
    name: str,
    known: Mapping[str, Any],
    variables: tuple[str, ...],
    parameters: Mapping[str, Any],
) -> Any:
    """A user's SymPy expression, checked part by part, in plain symbols without assumptions."""
    sympy = sympy_module()
    _check_parts(given, name)
    names = [*variables, *sorted(parameters), *CONSTANTS]

    def error(why: str) -> FormulaError:
        return FormulaError(f"{name} = {given}: {why}.", name, given)

    def build(e: Any) -> Any:
        if e.is_Symbol:
            if e.name in known and e.name not in CONSTANTS:
                return known[e.name]
            raise _unknown(e.name, name, given, "", names)
        if e.is_Float:
            if not np.isfinite(float(e)):
                raise error(f"{e} is not finite")
            return _fraction(repr(float(e)))
        if e.is_Rational or e in (sympy.pi, sympy.E):
            return e
        arguments = [build(a) for a in e.args]
        if isinstance(e, sympy.exp):
            return sympy.exp(*arguments)
        if e.is_Add or e.is_Mul:
            return e.func(*arguments)
        if e.is_Pow:
            check_power(arguments[0], arguments[1], error)
            return e.func(*arguments)
        if e.is_Function and e.func.__name__ in FUNCTIONS.values():
            return applied(e.func.__name__, arguments)
        raise error(
            f"{e} ({type(e).__name__}) is not known; use {', '.join(FUNCTIONS)} and + - * / **"
        )

    return build(given)
