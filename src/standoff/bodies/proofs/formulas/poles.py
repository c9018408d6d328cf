"""Collapsed sides of a patch given by a formula, proven by exact algebra of one parameter."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from standoff.bodies.proofs.formulas.symbolic import Ring, TooLargeError, cross, dot
from standoff.bodies.proofs.tolerances import DOMAIN_ROUNDINGS, NEARLY_COLLAPSED
from standoff.geometry.formulas.compiled import Formula
from standoff.geometry.formulas.expressions import sympy_module
from standoff.geometry.intervals import Interval, interval, near

PARTS_OF_PI = 12


@dataclass(frozen=True, eq=False)
class Pole:
    """A side that is one point.

    Attributes
    ----------
    axis : 0 where u, 1 where v is constant on the side
    level : the domain's end there
    at : bounds of the exact value of the parameter, which `level` may have been rounded from
    inward : +1 where the domain lies at greater values, else -1
    smooth : the surface has a tangent plane there, else it may be a pointed apex
    """

    axis: int
    level: float
    at: Interval
    inward: int
    smooth: bool


@lru_cache(maxsize=256)
def poles_of(formula: Formula, domain: tuple[float, ...]) -> list[Pole]:
    found = []
    for side, level in enumerate(domain):
        axis = side // 2
        for exact in _values(level) if _looks_collapsed(formula, domain, side) else ():
            if not _vanishing(_along(formula, axis, exact)):
                continue
            at = interval(float(exact)) if exact.is_Rational else near(float(exact))
            smooth = _vanishing([_bend(formula, axis, exact)])
            found.append(Pole(axis, level, at, -1 if side % 2 else 1, smooth))
            break
    return found


def _looks_collapsed(formula: Formula, domain: tuple[float, ...], side: int) -> bool:
    """Is the side shorter than a part of the opposite corners' distance: cheap, no proof."""
    axis, level = side // 2, domain[side]
    first, last = domain[2 - 2 * axis], domain[3 - 2 * axis]
    points = [
        formula.values(*((level, t) if axis == 0 else (t, level)))[0]
        for t in (first, 0.5 * (first + last), last)
    ]
    middle = formula.values(0.5 * (domain[0] + domain[1]), 0.5 * (domain[2] + domain[3]))[0]
    length = max(float(np.linalg.norm(p - points[1])) for p in points)
    return length <= NEARLY_COLLAPSED * float(np.linalg.norm(middle - points[1]))


def _values(level: float) -> Iterable[Any]:
    """The numbers that a side's parameter may stand for."""
    sympy = sympy_module()
    yield sympy.Rational(level)
    times = round(level / np.pi * PARTS_OF_PI)
    exact = sympy.pi * sympy.Rational(times, PARTS_OF_PI)
    if times and abs(float(exact) - level) <= DOMAIN_ROUNDINGS * np.spacing(abs(level)):
        yield exact


def _along(formula: Formula, axis: int, exact: Any) -> list[Any]:
    """The derivatives of x along the side."""
    sympy = sympy_module()
    across, along = (sympy.Symbol(formula.variables[k]) for k in (axis, 1 - axis))
    return [sympy.diff(e.subs(across, exact), along) for e in formula.expressions]


def _bend(formula: Formula, axis: int, exact: Any) -> Any:
    """Zero where the directions that leave the pole stay in one plane.

    They are x_v there (v the parameter across); their determinant with x_uv and x_uuv.
    """
    sympy = sympy_module()
    across, along = (sympy.Symbol(formula.variables[k]) for k in (axis, 1 - axis))
    away = [sympy.diff(e, across).subs(across, exact) for e in formula.expressions]
    turned = [sympy.diff(e, along) for e in away]
    return dot(cross(away, turned), [sympy.diff(e, along) for e in turned])


def _vanishing(expressions: Sequence[Any]) -> bool:
    """Are they zero for every value of the parameter that is left."""
    try:
        ring = Ring(expressions)
        return all(ring.read(e).is_zero for e in expressions)
    except (TooLargeError, ZeroDivisionError):
        return False
