"""Convexity of a patch given by a formula, proven over the whole patch by interval arithmetic.

With N = x_u x x_v, II = N . (x_uu, x_uv, x_vv) / |N| and I the metric, a patch is convex if its
Gaussian curvature K = det II / det I is nowhere negative and its mean curvature H keeps one sign.
Their numerators are factored exactly (``formulas.forms``); first the sign of each factor is proven.
If all factors keep their signs as required, the patch is convex. Otherwise the least curvature
    k = H - sqrt(H^2 - K)
is bounded from below by halving the box with the worst bound, until the bound is within a twentieth
of a computed value, or enough boxes have been tried.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from standoff.best_first import SearchPart, best_first
from standoff.bodies.proofs.defects import Dent, dents_total
from standoff.bodies.proofs.formulas.forms import (
    CurvatureForms,
    curvature_forms,
    forms_as_written,
)
from standoff.bodies.proofs.formulas.normals import hemisphere_axis, least_cosines
from standoff.bodies.proofs.formulas.signs import (
    FIRST_GRID,
    ExpressionBounds,
    sign_of_product,
    widest,
)
from standoff.bodies.proofs.formulas.taylor import TaylorBounds, curvature
from standoff.bodies.proofs.proof import PatchProof
from standoff.bodies.proofs.tolerances import BEND_ROUNDOFF, FEW_OPERATIONS
from standoff.geometry.boxes import Boxes, grid
from standoff.geometry.formulas import FormulaSurface
from standoff.geometry.formulas.compiled import Formula
from standoff.geometry.formulas.enclosures import Enclosure, hull, images
from standoff.geometry.formulas.expressions import sympy_module
from standoff.geometry.intervals import TINY, Interval
from standoff.typing import Array

# The search may end when the bound of the least curvature is within this factor of a value seen.
NEARNESS = 1.05
# Boxes of one search, each 10 to 20 microseconds for 2000 characters of program: 1 to 2 seconds.
MOST_BOXES = 100_000
WORST = 512
# A box costs more with Taylor series: the logarithm of their width must be smaller by this.
SERIES_GAIN = 3.0
# Logarithm of a width that represents bounds that are not known in all boxes.
UNKNOWN = 1e6
# A dent with normals whose cosine to the axis is below this has no bound as a graph.
STEEPEST = 0.05


def prove(surface: FormulaSurface, outward: int | None = None) -> PatchProof:
    """Prove that a patch is convex over its domain, or bound by how much it is not.

    Parameters
    ----------
    surface : FormulaSurface
    outward : +1 if f_u x f_v points out of the body, -1 if into it; if not given, the side to which
        the patch bulges.

    Returns
    -------
    PatchProof
        In the units of `surface`; `place` in its parameters. A flat patch is convex.
    """
    domain = tuple(float(x) for x in surface.domain)
    stretch, squeeze = np.linalg.svd(surface.linear, compute_uv=False)[[0, -1]]
    turn = 1 if np.linalg.det(surface.linear) > 0.0 else -1
    found = _bent(surface.formula, domain, 0 if outward is None else turn * outward)
    axis = hemisphere_axis(surface.formula, domain)
    # curvature is II / I: the map's greatest stretch over the square of its least
    least = found.least * float(stretch / squeeze**2) if found.least < 0.0 else 0.0
    defect, tilt = 0.0, 0.0
    if least < 0.0:
        defect, tilt = _rise(surface, found, least, axis)
    return PatchProof(
        convex=found.convex,
        defect=defect,
        method="interval",
        hemisphere=axis is not None,
        place=found.place,
        sense=turn * found.sense,
        tilt=tilt,
        curvature=least,
    )


@dataclass(frozen=True, eq=False)
class Bent:
    """The least normal curvature of a formula's patch, before any affine map.

    Attributes
    ----------
    convex : proven, up to roundoff
    least : a lower bound, 1/length; 0 if no curvature bends inward
    place : (u, v) of the least computed curvature
    sense : as in PatchProof
    dents : boxes that may bend inward, and the bound of each
    """

    convex: bool
    least: float
    place: tuple[float, float]
    sense: int
    dents: Boxes
    bounds: Array


Box = tuple[list[float], list[float], int]
"""A box's corners, and the axis to halve it across."""

NO_DENTS = Boxes(np.zeros((0, 2)), np.zeros((0, 2)))


@lru_cache(maxsize=256)
def _bent(formula: Formula, domain: tuple[float, ...], sense: int) -> Bent:
    """If `sense` is 0, the side to which the patch bulges counts as outward."""
    forms = curvature_forms(formula)
    middle = (0.5 * (domain[0] + domain[1]), 0.5 * (domain[2] + domain[3]))
    gauss = mean = 0
    if forms.exact and forms.gauss != 0:
        gauss = sign_of_product(forms.gauss_signs, formula.variables, domain)
    if forms.exact and forms.mean_square != 0:
        mean = sign_of_product(forms.mean_signs, formula.variables, domain)
    if (gauss > 0 or forms.gauss == 0) and (mean != 0 or forms.mean_square == 0):
        hollow = mean != 0 and sense == mean
        least = -np.inf if hollow else 0.0  # no bound needed: it is no part of a convex body
        return Bent(not hollow, least, middle, sense or -mean, NO_DENTS, np.zeros(0))
    not_saddled = gauss > 0 or forms.gauss == 0
    return _BoxSearch(formula, forms, domain, not_saddled, mean, sense or -mean).run()


class _BoxSearch:
    """Best first: the boxes with the worst bounds are halved."""

    def __init__(
        self,
        formula: Formula,
        forms: CurvatureForms,
        domain: tuple[float, ...],
        not_saddled: bool,
        mean: int,
        sense: int,
    ) -> None:
        self.formula, self.domain = formula, domain
        self.not_saddled, self.one_sided = not_saddled, mean != 0 and sense == -mean
        self.size = np.diff(np.reshape(domain, (-1, 2)), axis=1).ravel()
        self.bounds = _sharper(formula, forms, domain)
        self.diameter = _extent(formula, grid(domain, 2 * FIRST_GRID))
        self.boxes = grid(domain, 2 * FIRST_GRID)
        seen = self.bounds(self.boxes)[1]
        # outward is the side to which most of the patch bulges
        side = np.nansum(np.sign(seen.lo[2] + seen.hi[2]))
        self.sense = sense or -int(np.sign(side)) or 1
        self.enough = -BEND_ROUNDOFF / self.diameter

    def parts(self, boxes: Boxes, wholes: Array | float = -np.inf) -> list[SearchPart[Box]]:
        """Boxes with lower bounds of k, and its values at their middles.

        `wholes` are the bounds (n,) of the boxes that these are parts of: the bound of a part is
        never worse than that of its whole.
        """
        value, middle, slopes = self.bounds(boxes)
        at_middle = self.curvature(middle)
        seen = np.where(np.isfinite(at_middle), at_middle, np.inf)
        with np.errstate(all="ignore"):
            bound = self.curvature(value)
        bound = np.maximum(np.where(np.isnan(bound), -np.inf, bound), wholes)
        axis = widest(boxes, slopes, self.size)
        rows = zip(boxes.low.tolist(), boxes.high.tolist(), axis.tolist(), strict=True)
        return [
            SearchPart(k, box, at, k >= self.enough)
            for k, box, at in zip(bound.tolist(), rows, seen.tolist(), strict=True)
        ]

    def halves(self, chosen: list[SearchPart[Box]]) -> list[SearchPart[Box]]:
        boxes, axis = _boxes(chosen)
        bound = np.array([part.bound for part in chosen])
        return self.parts(boxes.halves(axis), np.concatenate([bound, bound]))

    def curvature(self, value: Interval) -> Array:
        """Lower bounds of k = H - sqrt(H^2 - K), from those of K, H^2 and a form of H's sign.

        H counts as positive where the patch bulges outward. Where K < 0, k increases with H and K.
        """
        with np.errstate(invalid="ignore", divide="ignore"):
            dip = 0.0 * value.lo[0] if self.not_saddled else np.maximum(-value.lo[0], 0.0)
            side = value.lo[2] if self.sense < 0 else -value.hi[2]
            high = np.sqrt(np.maximum(value.hi[1], 0.0))
            low = np.sqrt(np.maximum(value.lo[1], 0.0))
            outward = np.where(dip == 0.0, 0.0, -dip / (low + np.sqrt(low * low + dip)))
            least = np.maximum(value.lo[0], 0.0) if self.not_saddled else value.lo[0]
            inward = -(high + np.sqrt(np.maximum(high * high - least, 0.0)))
            bound = np.where(self.one_sided | (side >= 0.0), outward, inward)
        # the roundoff of these few operations
        return np.asarray(bound * (1.0 + FEW_OPERATIONS))

    def run(self) -> Bent:
        enough, first = self.enough, self.parts(self.boxes)
        # each split makes two boxes
        most = 0.5 * (MOST_BOXES / self.bounds.cost - len(first))
        searched = best_first(
            first,
            self.halves,
            goal=lambda found: min(enough, NEARNESS * min(found, 0.0) + 0.5 * enough),
            most=lambda _: most,
            batch=WORST,
        )
        parts = searched.open + searched.closed
        place = searched.place
        if place is None:  # no value was computed: take the place of the worst bound
            place = min(parts, key=lambda part: part.bound).body
        u, v = Boxes(*np.array([place[:2]]).swapaxes(0, 1)).middle[0].tolist()
        least = min(0.0, searched.least)
        dents = [part for part in parts if part.bound < 0.0]
        bounds = np.array([part.bound for part in dents])
        return Bent(least >= enough, least, (u, v), self.sense, _boxes(dents)[0], bounds)


def _boxes(parts: list[SearchPart[Box]]) -> tuple[Boxes, Any]:
    """The boxes (n,) of parts, and the axis along which to halve each."""
    low = np.reshape([part.body[0] for part in parts], (-1, 2))
    high = np.reshape([part.body[1] for part in parts], (-1, 2))
    return Boxes(low, high), np.array([part.body[2] for part in parts], dtype=np.int64)


def _sharper(
    formula: Formula, forms: CurvatureForms, domain: tuple[float, ...]
) -> ExpressionBounds | TaylorBounds:
    """Bounds of K, H^2 and the sign of H: from the exact forms, as written, or by Taylor series.

    Multiplied out, a formula around a distant centre loses digits to cancellation. A long formula
    has wide bounds; Taylor series are narrower unless its derivatives grow with their order.
    """
    boxes = grid(domain, 2 * FIRST_GRID)

    def width(bounds: ExpressionBounds | TaylorBounds) -> float:
        value = bounds(boxes)[0]
        with np.errstate(invalid="ignore"):
            by_box = (value.hi - value.lo)[:2].max(axis=0)
        # at a pointed apex the curvature is infinite: its least value is a bound nevertheless
        unknown = ~np.isfinite(value.lo[:2]).all(axis=0)
        if unknown.any():
            return UNKNOWN * float(unknown.mean())
        finite = np.isfinite(by_box)
        return float(np.log(by_box[finite] + TINY).mean()) if finite.any() else UNKNOWN

    def by_expressions(f: CurvatureForms) -> ExpressionBounds:
        side = sympy_module().Mul(*f.mean_signs)
        return ExpressionBounds([f.gauss, f.mean_square, side], formula.variables)

    taylor = TaylorBounds(formula, domain, curvature)
    least = width(taylor)
    if not forms.exact:
        # differentiating a long formula is slow too: only if there are no series
        if least < UNKNOWN / len(boxes):
            return taylor
        written = by_expressions(forms)
        return written if width(written) < least else taylor
    exact, written = by_expressions(forms), by_expressions(forms_as_written(formula))
    # all else being equal, take the exact forms: the signs of their factors can be proven
    widths = [width(exact), width(written), least + SERIES_GAIN]
    return (exact, written, taylor)[int(np.argmin(widths))]


def _rise(
    surface: FormulaSurface, found: Bent, least: float, axis: tuple[float, ...] | None
) -> tuple[float, float]:
    """(defect, tilt): how far the patch may rise above its own tangent planes, and turn back.

    Seen along `axis` the patch is a graph f, and f'' <= |k| / c^3 along any straight path in the
    graph's domain, where c is the cosine between normal and axis: these are the dents' curvatures
    for ``defects``.
    """
    if not np.isfinite(found.least) and not len(found.dents):
        return np.inf, np.pi
    low, high = surface.box()
    size = float(np.linalg.norm(high - low))
    if axis is None or not np.isfinite(found.bounds).all():
        return size, np.pi
    linear = surface.linear
    cofactors = np.asarray(np.linalg.det(linear) * np.linalg.inv(linear).T)
    upright = linear @ np.array(axis) * np.sign(np.linalg.det(linear))
    upright = upright / np.linalg.norm(upright)
    cosines = least_cosines(surface.formula, surface.domain, found.dents, cofactors, upright)
    held = images(_position(surface.formula), found.dents, linear / size, surface.shift / size)
    bent = -found.bounds * (least / found.least if np.isfinite(found.least) else 1.0) * size
    bent = np.where(cosines > STEEPEST, bent / np.maximum(cosines, STEEPEST) ** 3, np.inf)
    dents = [
        Dent(float(k), lo, hi, np.pi) for k, lo, hi in zip(bent, held.lo.T, held.hi.T, strict=True)
    ]
    rise, tilt = dents_total(dents)
    return rise * size, tilt


def _extent(formula: Formula, boxes: Boxes) -> float:
    """A bound on the greatest distance between points of boxes."""
    low, high = hull(_position(formula), boxes, np.eye(3), np.zeros(3))
    return float(np.linalg.norm(high - low))


@lru_cache(maxsize=256)
def _position(formula: Formula) -> Enclosure:
    return Enclosure(formula.jet[:9], formula.variables)
