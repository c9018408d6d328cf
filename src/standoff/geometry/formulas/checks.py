"""Conditions that a formula must satisfy to become a surface or a curve."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np

from standoff.checks.numbers import GREATEST
from standoff.checks.real_numbers import real_array, shape_of, shown
from standoff.errors import FormulaError
from standoff.geometry.boxes import Boxes, grid
from standoff.geometry.formulas.compiled import Formula, compiled
from standoff.geometry.formulas.enclosures import (
    CHUNK,
    DIVE,
    FIRST_GRID,
    Enclosure,
    without_bounds,
)
from standoff.geometry.formulas.expressions import parameter_values, read_expression
from standoff.geometry.intervals import Interval
from standoff.geometry.tolerances import VANISHING_NORMAL
from standoff.typing import Array

SURFACE_VARIABLES = ("u", "v")
CURVE_VARIABLES = ("t",)
# A side of a patch may be collapsed: within this fraction of the domain from its border, a
# vanishing normal is left to the convexity proof.
RIM = 1.0 / 32.0
# Halvings of a box while no normal is proven in it, and boxes examined in one patch.
DEEPEST = 60
MOST_BOXES = 8_000


def limits(domain: Any, names: tuple[str, ...], what: str) -> tuple[float, ...]:
    """(u0, u1, v0, v1) or (first, last) as floats.

    Raises FormulaError: not finite, or empty.
    """
    wanted = "(" + ", ".join(names) + ")"
    name = "domain" if what.endswith(".domain") else ""
    if shape_of(domain) != (len(names),):
        raise FormulaError(f"{what} = {shown(domain)}: give {wanted}.", name, domain)
    try:
        values = tuple(float(x) for x in real_array(domain))
    except (TypeError, ValueError) as error:
        raise FormulaError(
            f"{what} = {shown(domain)} is not numeric: give {wanted}.", name, domain
        ) from error
    if not np.isfinite(values).all():
        raise FormulaError(f"{what} = {values} is not finite: give finite {wanted}.", name, values)
    for k in range(0, len(values), 2):
        if not values[k] < values[k + 1]:
            raise FormulaError(
                f"{what} = {values} is empty: give {names[k]} < {names[k + 1]}.", name, values
            )
    return values


def read_formula(
    given: Sequence[Any], variables: tuple[str, ...], parameters: Mapping[str, Any] | None
) -> Formula:
    """Three coordinates, read and compiled.

    Raises FormulaError: they cannot be read, or do not contain one of the variables: a point, or a
    curve instead of a patch.
    """
    values = parameter_values(parameters, variables)
    expressions = tuple(
        read_expression(e, name, variables, values)
        for e, name in zip(given, ("x", "y", "z"), strict=True)
    )
    used = {s.name for e in expressions for s in e.free_symbols}
    for variable in variables:
        if variable not in used:
            shape = "point" if len(variables) == 1 or not used else "curve"
            raise FormulaError(
                f"x = {given[0]}, y = {given[1]}, z = {given[2]} do not depend on {variable}: a "
                f"{shape}, of zero size. Use {' and '.join(variables)}."
            )
    return compiled(expressions, variables)


def named(variables: tuple[str, ...], at: Sequence[float] | Array) -> str:
    return ", ".join(f"{v} = {float(x):.6g}" for v, x in zip(variables, at, strict=True))


def check_finite(formula: Formula, domain: Sequence[float]) -> None:
    """Raise FormulaError unless the jet is proven finite on the whole domain."""
    place = without_bounds(Enclosure(formula.jet, formula.variables), domain)
    if place is None:
        _check_range(formula, domain)
        return
    with np.errstate(all="ignore"):
        rows = formula.values(*place)
    x, y, z = formula.expressions
    what = (
        "has a pole, or is not real,"
        if not np.isfinite(rows[0]).all()
        else ("has unbounded second derivatives: a pole, a kink or an undefined value,")
    )
    raise FormulaError(
        f"x = {x}, y = {y}, z = {z} {what} at about {named(formula.variables, place)}, inside "
        f"{tuple(domain)}: cut the domain before that place, or write the formula without it."
    )


def _check_range(formula: Formula, domain: Sequence[float]) -> None:
    """Raise FormulaError if lengths or their derivatives leave the range of the library."""
    ends = np.array(domain).reshape(-1, 2)
    for shares in product(np.linspace(0.0, 1.0, 5), repeat=len(ends)):
        place = ends[:, 0] + np.array(shares) * (ends[:, 1] - ends[:, 0])
        greatest = float(np.abs(formula.values(*place)).max())
        if not greatest <= GREATEST:
            x, y, z = formula.expressions
            raise FormulaError(
                f"x = {x}, y = {y}, z = {z} or a derivative reaches {greatest:.3g} at "
                f"{named(formula.variables, place)}, beyond {GREATEST:g}: choose a larger unit."
            )


def check_normal(formula: Formula, domain: Sequence[float]) -> None:
    """Raise FormulaError if the normal of a surface vanishes, except on its sides."""
    corners = np.array(domain).reshape(2, 2)
    at = np.linspace(0.0, 1.0, 9)
    spots = [corners[:, 0] + np.array([a, b]) * np.diff(corners)[:, 0] for a in at for b in at]
    lengths = np.array([_normal_length(formula, p) for p in spots])
    inner = np.array([0.0 < a < 1.0 and 0.0 < b < 1.0 for a in at for b in at])
    place = _without_direction(formula, domain, VANISHING_NORMAL * float(lengths.max()))
    if lengths[inner].max() <= 0.0:
        place = np.asarray(spots[int(np.flatnonzero(inner)[0])])
    if place is not None:
        raise FormulaError(
            f"x_u x x_v vanishes at about {named(formula.variables, place)}: the patch has no "
            "normal there. Only a whole side of the domain may collapse to a point; use another "
            "parametrisation or a smaller domain."
        )


def check_tangent(formula: Formula, domain: Sequence[float]) -> None:
    """Raise FormulaError if the tangent of a curve vanishes."""
    place = _without_direction(formula, domain, 0.0)
    if place is not None:
        raise FormulaError(
            f"The tangent vanishes at about {named(formula.variables, place)}: use another "
            "parametrisation or a smaller range."
        )


def _normal_length(formula: Formula, at: Sequence[float] | Array) -> float:
    rows = formula.values(*at)
    return float(np.linalg.norm(np.cross(rows[1], rows[2])))


def direction_bounds(bounds: Interval, surface: bool) -> Interval:
    """(3, n) bounds of x_u x x_v, or of x_t, from bounds of a jet's rows."""
    row = [Interval(bounds.lo[k], bounds.hi[k]) for k in range(9 if surface else 6)]
    if not surface:
        parts = row[3:6]
    else:
        (a, b, c), (d, e, f) = row[3:6], row[6:9]
        parts = [b * f - c * e, c * d - a * f, a * e - b * d]
    return Interval(np.stack([p.lo for p in parts]), np.stack([p.hi for p in parts]))


def _without_direction(formula: Formula, domain: Sequence[float], least: float) -> Array | None:
    """A place where the normal, or the tangent, may vanish after all halvings; None if nowhere.

    least : a computed normal as short as this counts as zero
    """
    surface = len(formula.variables) == 2
    bounds = Enclosure(formula.jet[: 9 if surface else 6], formula.variables)
    ends = np.array(domain).reshape(-1, 2)
    size = np.diff(ends)[:, 0]
    rim = RIM * size if surface else 0.0 * size
    waiting, seen = [(grid(domain, FIRST_GRID), 0)], 0
    while waiting and seen < MOST_BOXES:
        boxes, depth = waiting.pop()
        if len(boxes) > CHUNK:
            waiting.append((boxes[CHUNK:], depth))
            boxes = boxes[:CHUNK]
        seen += len(boxes)
        direction = direction_bounds(bounds(boxes), surface)
        unknown = ((direction.lo <= 0.0) & (direction.hi >= 0.0)).all(axis=0)
        boxes = _inner(boxes[unknown], ends, rim)
        if not len(boxes):
            continue
        if len(boxes) > DIVE:
            waiting.append((boxes[DIVE:], depth))
            boxes = boxes[:DIVE]
        if depth >= DEEPEST:
            place = boxes.middle[0]
            if not surface or _normal_length(formula, place) <= least:
                return np.asarray(place)
            continue
        extent = (boxes.high - boxes.low) / size
        waiting.append((boxes.halves(extent.argmax(axis=1)), depth + 1))
    return None


def _inner(boxes: Boxes, ends: Array, rim: Array) -> Boxes:
    """The boxes that are not entirely within the rim of the domain."""
    at_rim = (boxes.high <= ends[:, 0] + rim) | (boxes.low >= ends[:, 1] - rim)
    return boxes[~at_rim.any(axis=1)]
