"""Curvature and normals of a formula's patch from its Taylor series over boxes.

Over a box x = sum of c_km du^k dv^m, exact at its middle up to the highest order, whose
coefficients are bounds over all of the box. Sums and products of such series bound the numerators
of K and H with an error of the box's width to their order, however long the formula would be
multiplied out.

At a side v = v0 that is one point, w = v - v0, the series about v0 is divided by w:
    x = x0 + w y,  x_u = w y_u,  x_u x x_v = w n,  n = y_u x x_v,
and the second fundamental form in (d/du) / w and d/dv, over w, is
    n.y_uu / w,  n.y_uv,  n.x_vv.
Where the pole is smooth n.y_uu vanishes at v0 too, and is divided again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from standoff.bodies.proofs.formulas.symbolic import Ring, TooLargeError, cross, dot
from standoff.bodies.proofs.tolerances import DOMAIN_ROUNDINGS, NEARLY_COLLAPSED, QUOTIENT_ROUNDOFF
from standoff.geometry.boxes import Boxes
from standoff.geometry.formulas.compiled import Formula
from standoff.geometry.formulas.expressions import sympy_module
from standoff.geometry.formulas.series_program import SeriesProgram
from standoff.geometry.interval_vectors import stacked
from standoff.geometry.intervals import Interval, interval, near
from standoff.geometry.series import Series, powers
from standoff.typing import Array

# Order of the series of x: those of its second derivatives are of two less, and of four less at a
# smooth pole. Higher orders take fewer boxes and more time.
ORDER = 4
ORDER_AT_POLE = 6
# A box nearer to a pole than this many of its own widths is expanded about the pole.
POLE_WIDTHS = 1.0
# Boxes evaluated at once: some megabytes.
CHUNK = 512
# Characters of program that one box costs beside those of the formula: the forms' own products.
FORMS_LENGTH = 400
# What a product of series costs, in operations of the programs of plain bounds.
PRODUCT = 30.0


# Over n boxes: values, (k, n); the same at the boxes' middles; slopes along u and along v of what
# they are made of, which say where to halve.
Bounded = tuple[Interval, Interval, list[Interval]]


class TaylorBounds:
    """Bounds over boxes of one patch; called as ``signs.Bounds`` are.

    Parameters
    ----------
    formula, domain : of the patch
    evaluate : `curvature` or `normal`
    """

    def __init__(
        self,
        formula: Formula,
        domain: tuple[float, ...],
        evaluate: Callable[[Expansion], Bounded],
    ) -> None:
        self.program = SeriesProgram(formula.expressions, formula.variables)
        self.poles = poles_of(formula, domain)
        self.evaluate = evaluate
        forms = FORMS_LENGTH if evaluate is curvature else 0
        self.cost = max(1.0, PRODUCT * (self.program.length + forms) / 2000.0)

    def __call__(self, boxes: Boxes) -> Bounded:
        near = np.full(len(boxes), -1)
        for k, pole in enumerate(self.poles):
            low, high = boxes.low[:, pole.axis], boxes.high[:, pole.axis]
            gap = low - pole.level if pole.inward > 0 else pole.level - high
            near[gap <= POLE_WIDTHS * (high - low)] = k
        found: list[Bounded] = []
        order = []
        for k in range(-1, len(self.poles)):
            which = np.flatnonzero(near == k)
            for first in range(0, len(which), CHUNK):
                part = which[first : first + CHUNK]
                at = self.poles[k] if k >= 0 else None
                order.append(part)
                with np.errstate(all="ignore"):
                    found.append(self.evaluate(Expansion(self.program, boxes[part], at)))
        back = np.argsort(np.concatenate(order))

        def joined(parts: Sequence[Interval]) -> Interval:
            low = np.concatenate([p.lo for p in parts], axis=1)[:, back]
            return Interval(low, np.concatenate([p.hi for p in parts], axis=1)[:, back])

        values, middles, slopes = zip(*found, strict=True)
        return joined(values), joined(middles), [joined([s[k] for s in slopes]) for k in (0, 1)]


class Expansion:
    """The series of x about the boxes' middles, or about a pole, and over the boxes."""

    def __init__(self, program: SeriesProgram, boxes: Boxes, pole: Pole | None) -> None:
        self.program, self.boxes = program, boxes
        self.pole, self.count = pole, len(boxes)
        order = ORDER if pole is None else ORDER_AT_POLE
        centres = [interval(c) for c in boxes.middle.T]
        reach = boxes.sides
        if pole is not None:
            k, one = pole.axis, np.ones(len(boxes))
            centres[k] = Interval(pole.at.lo * one, pole.at.hi * one)
            reach[k] = Interval(
                np.minimum(reach[k].lo, centres[k].lo), np.maximum(reach[k].hi, centres[k].hi)
            )
        # each box twice: at its centre, and over all of it
        both = [
            Interval(np.append(c.lo, r.lo), np.append(c.hi, r.hi))
            for c, r in zip(centres, reach, strict=True)
        ]
        self.x = program(both[0], both[1], order=order)
        self.away = [s - c for s, c in zip(boxes.sides, centres, strict=True)]
        self.to_middle = [interval(m) - c for m, c in zip(boxes.middle.T, centres, strict=True)]
        if pole is not None:
            self.away[pole.axis] = _inward(self.away[pole.axis], pole)
            self.to_middle[pole.axis] = _inward(self.to_middle[pole.axis], pole)
            # of w itself
            self.w = Series.variable(
                Interval(
                    np.append(0.0 * one, np.minimum(self.away[pole.axis].lo, 0.0)),
                    np.append(0.0 * one, np.maximum(self.away[pole.axis].hi, 0.0)),
                ),
                pole.axis,
                order,
            )

    def at_middles(self) -> Expansion:
        """About the boxes' middles though a pole is near: there they have no extent."""
        middle = self.boxes.middle
        return Expansion(self.program, Boxes(middle, middle), None)

    def bounds(self, f: Series) -> tuple[Interval, Interval]:
        """Over the boxes and at their middles, (n,)."""
        n = self.count
        at, over = f.columns(slice(n)), f.columns(slice(n, None))
        value = _summed(at, over, self.away)
        return value.within(over.constant), _summed(at, over, self.to_middle)

    def slopes(self, f: Series) -> list[Interval]:
        """Along u and v over the boxes, (n,); unknown of a series of order 0."""
        n = self.count
        if f.order == 0:
            unknown = np.full(n, np.nan)
            return [Interval(unknown, unknown)] * 2
        return [Interval(f.lo[k, n:], f.hi[k, n:]) for k in (1, 2)]

    def length(self, f: list[Series]) -> Array:
        """Of a vector at the boxes' centres, about: to compare slopes by."""
        at = np.stack([0.5 * (s.lo[0, : self.count] + s.hi[0, : self.count]) for s in f])
        return np.asarray(np.sqrt((at * at).sum(axis=0)))


def _inward(w: Interval, pole: Pole) -> Interval:
    """The domain ends at the pole itself: what float64's rounding of it adds is cut off."""
    if pole.inward > 0:
        return Interval(np.maximum(w.lo, 0.0), np.maximum(w.hi, 0.0))
    return Interval(np.minimum(w.lo, 0.0), np.minimum(w.hi, 0.0))


def _summed(at: Series, over: Series, away: list[Interval]) -> Interval:
    """Taylor's formula: the coefficients at the centre, those of the last order over the box."""
    total = interval(0.0)
    steps = [[s**k if k else interval(1.0) for k in range(at.order + 1)] for s in away]
    for row, (k, m) in enumerate(powers(at.order)):
        source = over if k + m == at.order else at
        term = Interval(source.lo[row], source.hi[row])
        for axis, n in ((0, k), (1, m)):
            term = term * steps[axis][n] if n else term
        total = total + term
    return total


def _flipped(x: Interval) -> Interval:
    return Interval(-x.hi, -x.lo)


def _derivatives(x: list[Series], axis: int) -> list[Series]:
    return [s.derivative(axis) for s in x]


def _tangents(e: Expansion) -> tuple[list[Series], list[Series], list[Series]]:
    """(x_u, x_v, n) of order 1 or 2 less than x's; at a pole the one along its side over w."""
    xu, xv = _derivatives(e.x, 0), _derivatives(e.x, 1)
    if e.pole is not None:
        k = e.pole.axis
        scaled = _derivatives([s.divided(k) for s in e.x], 1 - k)
        xu, xv = (scaled, xv) if k == 1 else (xu, scaled)
    return xu, xv, list(cross(xu, xv))


def normal(e: Expansion) -> Bounded:
    """Directions of the normal, along x_u x x_v, of no sure length: (3, n)."""
    n = _tangents(e)[2]
    rows = [e.bounds(s) for s in n]
    slopes = [e.slopes(s) for s in n]
    value, middle = (stacked([r[k] for r in rows]) for k in (0, 1))
    if e.pole is not None and e.pole.inward < 0:
        value, middle = _flipped(value), _flipped(middle)
    return value, middle, [stacked([s[k] for s in slopes]) for k in (0, 1)]


def _forms(e: Expansion) -> tuple[list[Series], Any, Any]:
    """(n, (E, F, G), (L, M, N)); at a pole of y_u and x_v, see the module."""
    xu, xv, n = _tangents(e)
    first = dot(xu, xu), dot(xu, xv), dot(xv, xv)
    if e.pole is None:
        xuu, xuv, xvv = _derivatives(xu, 0), _derivatives(xu, 1), _derivatives(xv, 1)
        return n, first, (dot(n, xuu), dot(n, xuv), dot(n, xvv))
    k = e.pole.axis
    along, across = (xu, xv) if k == 1 else (xv, xu)
    bend = dot(n, _derivatives(along, 1 - k))
    if e.pole.smooth:
        bend = bend.divided(k)
    mixed = dot(n, _derivatives(along, k))
    upper = dot(n, _derivatives(across, k))
    return n, first, (bend, mixed, upper) if k == 1 else (upper, mixed, bend)


def curvature(e: Expansion) -> Bounded:
    """Rows K, H^2 and one with the sign of H against x_u x x_v."""
    n, (ee, ff, gg), (ll, mm, nn) = _forms(e)
    pointed = e.pole is not None and not e.pole.smooth
    if e.pole is None or e.pole.smooth:
        gauss = ll * nn - mm**2
        mean = ee * nn + gg * ll - ff * mm * 2.0
    else:
        # times w: the curvature round the apex is as 1 / w
        gauss = ll * nn - e.w * mm**2
        by_apex, other = (gg * ll, ee * nn) if e.pole.axis == 1 else (ee * nn, gg * ll)
        mean = by_apex + e.w * (other - ff * mm * 2.0)
    pairs = [_ratios(e, gauss, mean, n, k, pointed) for k in (0, 1)]
    size = e.length(n)
    scale = [1.0 / size**4, 1.0 / size**3]
    slopes = [e.slopes(gauss), e.slopes(mean)]
    by_axis = [
        stacked([s[k] * interval(c) for s, c in zip(slopes, scale, strict=True)]) for k in (0, 1)
    ]
    middles = pairs[1] if e.pole is None else _sharper(pairs[1], curvature(e.at_middles())[1])
    return pairs[0], middles, by_axis


def _sharper(a: Interval, b: Interval) -> Interval:
    """By box, the rows of `curvature` with the narrower K; unknown ones are passed over."""
    other = ~(b.hi[0] - b.lo[0] >= a.hi[0] - a.lo[0]) & b.known.all(axis=0)
    return Interval(np.where(other, b.lo, a.lo), np.where(other, b.hi, a.hi))


def _ratios(
    e: Expansion, gauss: Series, mean: Series, n: list[Series], which: int, pointed: bool
) -> Interval:
    """(3, n) K, H^2, and the sign of H, over the boxes (0) or at their middles (1)."""
    top, side = e.bounds(gauss)[which], e.bounds(mean)[which]
    square = interval(0.0)
    for s in n:
        square = square + e.bounds(s)[which] ** 2
    k, h = top / square**2, side**2 / (square**3 * 4.0)
    if e.pole is not None:
        outwards = e.pole.inward < 0
        if outwards and not pointed:
            side = _flipped(side)
        if pointed:
            w = (e.away, e.to_middle)[which][e.pole.axis]
            w = _flipped(w) if outwards else w
            k, h = _over(_flipped(k) if outwards else k, w), _over(h, w**2)
    return stacked([k, h, side])


def _over(x: Interval, w: Interval) -> Interval:
    """x / w of w >= 0, which may be zero at the apex: the limits there."""
    low = np.where(x.lo >= 0.0, x.lo / w.hi, np.where(w.lo > 0.0, x.lo / w.lo, -np.inf))
    high = np.where(x.hi <= 0.0, x.hi / w.hi, np.where(w.lo > 0.0, x.hi / w.lo, np.inf))
    spare = QUOTIENT_ROUNDOFF
    low = np.where(np.isnan(x.lo), np.nan, low - spare * np.abs(low))
    return Interval(low, np.where(np.isnan(x.hi), np.nan, high + spare * np.abs(high)))


# Collapsed sides of a patch given by a formula, proven by exact algebra of one parameter.

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
