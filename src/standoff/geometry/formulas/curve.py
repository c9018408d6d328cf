"""Curves given by formulas."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from standoff.geometry.boxes import grid
from standoff.geometry.curves import Curve
from standoff.geometry.formulas.checks import (
    CURVE_VARIABLES,
    check_finite,
    check_tangent,
    limits,
    read_formula,
)
from standoff.geometry.formulas.compiled import Formula, compiled
from standoff.geometry.formulas.enclosures import Enclosure, hull
from standoff.geometry.intervals import Interval, interval
from standoff.geometry.tolerances import CLOSED_CURVE
from standoff.geometry.validation import affine_map
from standoff.kernels.body import layout as L
from standoff.typing import Array

# Number of boxes whose hull is the box of a curve: its excess decreases with the square.
BOX_GRID = 256


class FormulaCurve(Curve):
    """A curve from formulas in t: x(t), y(t), z(t), lengths in the body's frame.

    Raises FormulaError as for `FormulaSurface`; a tangent that vanishes. Raises ImportError: SymPy
    is not installed: it comes with the extra `formulas`.

    Parameters
    ----------
    x, y, z : str, SymPy expression or number
        As for `FormulaSurface`, in t.
    first, last : float
        The range of t.
    parameters : {name: number}, optional

    Notes
    -----
    `data` is an affine map (3x3 row-major, shift) and the address of the compiled jet.
    """

    kind = L.FORMULA_CURVE
    formula: Formula

    @property
    def formulas(self) -> tuple[Formula, ...]:
        return (self.formula,)

    def __init__(
        self,
        x: Any,
        y: Any,
        z: Any,
        first: float,
        last: float,
        parameters: Mapping[str, Any] | None = None,
    ) -> None:
        inside = limits((first, last), ("first", "last"), "FormulaCurve (first, last)")
        formula = read_formula((x, y, z), CURVE_VARIABLES, parameters)
        check_finite(formula, inside)
        check_tangent(formula, inside)
        _fill(self, formula, inside, np.eye(3), np.zeros(3))

    @property
    def linear(self) -> Array:
        return self.data[0:9].reshape(3, 3)

    @property
    def shift(self) -> Array:
        return self.data[9:12]

    @property
    def closed(self) -> bool:
        """Whether both ends and their tangents are the same to roundoff."""
        (a, at, _), (b, bt, _) = self.jet(self.first), self.jet(self.last)
        low, high = self.box()
        ends = np.linalg.norm(a - b) <= CLOSED_CURVE * np.linalg.norm(high - low)
        return bool(ends and np.linalg.norm(at - bt) <= CLOSED_CURVE * np.linalg.norm(at))

    def transformed(self, linear: Array, shift: Array) -> FormulaCurve:
        """The exact image under x -> linear x + shift, by the same compiled function."""
        linear, shift = affine_map(linear, shift)
        image = linear @ self.linear, linear @ self.shift + shift
        return _curve(self.formula, (self.first, self.last), *image)

    def box(self) -> tuple[Array, Array]:
        """(low, high), each (3,), body frame, which contain the curve by interval bounds."""
        bounds = Enclosure(self.formula.jet[:6], CURVE_VARIABLES)
        return hull(bounds, grid((self.first, self.last), BOX_GRID), self.linear, self.shift)

    def jets_over(self, t: Interval) -> Interval:
        from standoff.geometry.formulas.series_program import series_program
        from standoff.geometry.interval_vectors import mapped, stacked

        rows = series_program(self.formula)(t, order=2)
        # only the powers u^k: rows 0, 1 and 3 of the series
        jets = stacked([Interval(c.lo[[0, 1, 3]], c.hi[[0, 1, 3]]) for c in rows])
        jets = mapped(self.linear, jets * np.array([1.0, 1.0, 2.0])[:, None])
        shift = np.zeros((3, 3, 1))
        shift[:, 0, 0] = self.shift
        return jets + interval(shift)

    def __reduce__(self) -> tuple[Any, ...]:
        limits = (self.first, self.last)
        return _rebuilt_curve, (self.formula.expressions, limits, self.linear, self.shift)


def _fill(
    curve: FormulaCurve, formula: Formula, inside: tuple[float, ...], linear: Array, shift: Array
) -> None:
    data = np.concatenate([np.ravel(linear), shift, [formula.address]])
    data.flags.writeable = False
    for name, value in (("data", data), ("formula", formula)):
        object.__setattr__(curve, name, value)
    object.__setattr__(curve, "first", inside[0])
    object.__setattr__(curve, "last", inside[1])


def _curve(
    formula: Formula, inside: tuple[float, ...], linear: Array, shift: Array
) -> FormulaCurve:
    curve = object.__new__(FormulaCurve)
    _fill(curve, formula, inside, linear, shift)
    return curve


def _rebuilt_curve(
    expressions: tuple[Any, ...], inside: tuple[float, ...], linear: Array, shift: Array
) -> FormulaCurve:
    """A curve in another process: its formula is compiled again there."""
    return _curve(compiled(expressions, CURVE_VARIABLES), inside, linear, shift)
