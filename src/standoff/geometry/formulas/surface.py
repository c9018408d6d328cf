"""Surfaces given by formulas."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from standoff.errors import FormulaError
from standoff.geometry.boxes import grid
from standoff.geometry.formulas.checks import (
    SURFACE_VARIABLES,
    check_finite,
    check_normal,
    limits,
    read_formula,
)
from standoff.geometry.formulas.compiled import Formula, compiled
from standoff.geometry.formulas.enclosures import Enclosure, hull
from standoff.geometry.surfaces import Surface
from standoff.geometry.validation import affine_map
from standoff.kernels.body import layout as L
from standoff.typing import Array

if TYPE_CHECKING:
    from standoff.geometry.boxes import Boxes
    from standoff.geometry.intervals import Interval

# Boxes per side whose hull is the box of a patch: its excess decreases with the square.
BOX_GRID = 24
ENDS = ("u0", "u1", "v0", "v1")


class FormulaSurface(Surface):
    """A patch from formulas in u and v: x(u, v), y(u, v), z(u, v), lengths in the body's frame.

    Raises FormulaError: an unknown symbol, bad syntax or anything but arithmetic; an empty domain;
    a parameter without a value; a pole, or a value that is not real, in the patch (checked by proof
    over all of it; the place is named); a point or a curve instead of a patch; a normal that
    vanishes inside. Raises ImportError: SymPy is not installed: it comes with the extra `formulas`.

    Parameters
    ----------
    x, y, z : str, SymPy expression or number
        In u, v, the parameters, pi, E, sin, cos, tan, asin, acos, atan, atan2, sinh, cosh, tanh,
        exp, log, sqrt, abs, + - * / ** and parentheses. Text is never run as Python.
    domain : (u0, u1, v0, v1)
        Ranges of u and v, finite.
    parameters : {name: number}, optional
        They become part of the formula.

    Notes
    -----
    It is differentiated twice by SymPy, common parts are computed once, and it is compiled once per
    process. A formula must be C² with a normal everywhere inside; a side may collapse to a point (a
    pole) as long as its second derivatives stay finite.
    """

    kind = L.FORMULA
    periodic = False
    projection = None
    part_of = None
    ruled = False
    proof = "interval"
    bulge = None
    formula: Formula

    @property
    def formulas(self) -> tuple[Formula, ...]:
        return (self.formula,)

    def __init__(
        self,
        x: Any,
        y: Any,
        z: Any,
        domain: Sequence[float],
        parameters: Mapping[str, Any] | None = None,
    ) -> None:
        inside = limits(domain, ENDS, "FormulaSurface.domain")
        formula = read_formula((x, y, z), SURFACE_VARIABLES, parameters)
        check_finite(formula, inside)
        check_normal(formula, inside)
        _fill(self, formula, inside, np.eye(3), np.zeros(3))

    def _data(self) -> Array:
        return np.array([self.formula.address])

    def transformed(self, linear: Array, shift: Array) -> FormulaSurface:
        """The exact image under x -> linear x + shift, by the same compiled function."""
        linear, shift = affine_map(linear, shift)
        return _surface(
            self.formula, self.domain, linear @ self.linear, linear @ self.shift + shift
        )

    def restricted(self, u0: float, u1: float, v0: float, v1: float) -> FormulaSurface:
        """The same surface on a smaller domain; parameters stay the same.

        Raises FormulaError: the domain is empty or leaves the present one.
        """
        smaller = limits((u0, u1, v0, v1), ENDS, "FormulaSurface.domain")
        a, b, c, d = self.domain
        if not (a <= smaller[0] and smaller[1] <= b and c <= smaller[2] and smaller[3] <= d):
            raise FormulaError(f"The domain {smaller} leaves the surface's own, {self.domain}.")
        return _surface(self.formula, smaller, self.linear, self.shift)

    def box(self) -> tuple[Array, Array]:
        """(low, high), each (3,), body frame, which contain the patch by interval bounds."""
        bounds = Enclosure(self.formula.jet[:9], SURFACE_VARIABLES)
        return hull(bounds, grid(self.domain, BOX_GRID), self.linear, self.shift)

    def jets_over(self, boxes: Boxes) -> Interval:
        from standoff.geometry.formulas.series_program import series_program
        from standoff.geometry.jet_bounds import derivatives

        return derivatives(series_program(self.formula)(*boxes.sides, order=2))

    def highest(self, direction: Array) -> None:
        """None: its `box` is used instead."""
        return

    def __reduce__(self) -> tuple[Any, ...]:
        parts = (self.formula.expressions, self.domain, self.linear, self.shift)
        return _rebuilt_surface, parts


def _fill(
    surface: FormulaSurface, formula: Formula, domain: Sequence[float], linear: Array, shift: Array
) -> None:
    object.__setattr__(surface, "formula", formula)
    u0, u1, v0, v1 = (float(x) for x in domain)
    Surface.__init__(surface, linear, shift, (u0, u1, v0, v1))


def _surface(
    formula: Formula, domain: Sequence[float], linear: Array, shift: Array
) -> FormulaSurface:
    surface = object.__new__(FormulaSurface)
    _fill(surface, formula, domain, linear, shift)
    return surface


def _rebuilt_surface(
    expressions: tuple[Any, ...], domain: Sequence[float], linear: Array, shift: Array
) -> FormulaSurface:
    """A surface in another process: its formula is compiled again there."""
    return _surface(compiled(expressions, SURFACE_VARIABLES), domain, linear, shift)
