"""Convexity of NURBS and rational Bezier patches, by Bernstein bounds with subdivision.

Every span of a NURBS is a rational Bezier patch whose curvature is the quotient of polynomials
(see ``forms``). If all coefficients of the 2x2 polynomial P are semidefinite matrices, so is P on
the whole box; otherwise the box is halved, the worst first, until each box is proven or the least
curvature and its places are known well. Nothing is decided by sampling.

Where the curvature only touches zero, along a line inside a span, the bound decreases with the
square of the boxes' width and ends at some 1e-5 of the size: not proven, yet not found to bend
inward. A knot on the line (`refined`) makes the proof possible: if a first proof fails, a second
one cuts the spans at redundant knots too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from standoff.best_first import SearchPart, best_first
from standoff.bodies.proofs.boxes import (
    ROOT,
    CurvatureBound,
    DyadicBox,
    curvature_bound,
    deep_enough,
)
from standoff.bodies.proofs.defects import Dent, dents_total
from standoff.bodies.proofs.forms import Forms, forms_of, with_poles
from standoff.bodies.proofs.normals import in_hemisphere
from standoff.bodies.proofs.proof import PatchProof
from standoff.bodies.proofs.straight import Grid, Nearness, plane_nearness, ruled_along, turn_to
from standoff.bodies.proofs.tolerances import (
    CURVATURE_ROUNDING,
    NEARLY_FLAT,
    PROVEN_DEFECT,
    ROUNDED_POINTS,
    STRAIGHT_TURN,
)
from standoff.errors import StandoffError
from standoff.geometry import bernstein
from standoff.geometry.nurbs import NurbsSurface
from standoff.geometry.validation import Domain
from standoff.typing import Array

Box = tuple[DyadicBox, CurvatureBound]

# Boxes halved in one span before the rest counts as dents as deep as their bounds.
MOST_SPLITS = 1000
# The same for a patch that is not convex: enough to show the size of its dents.
FINE_SPLITS = 150


@dataclass(frozen=True, eq=False)
class BernsteinSpan:
    """A span with its homogeneous points and forms, scaled so that the surface has size one.

    `moved` is the length by which the points of a pole were moved together.
    """

    domain: tuple[float, float, float, float]
    points: Array
    moved: float
    forms: Forms

    def parameters(self, cell: DyadicBox) -> tuple[float, float]:
        """(u, v) of the surface at a box's centre."""
        s, t = cell.centre
        u0, u1, v0, v1 = self.domain
        return u0 + s * (u1 - u0), v0 + t * (v1 - v0)


@dataclass(frozen=True, eq=False)
class SpanBound:
    """What the search found in one span: dents, the least curvature and its box."""

    dents: list[Dent]
    convex: bool
    found: float
    cell: DyadicBox


def prove(surface: NurbsSurface, outward: int | None = None) -> PatchProof:
    """Prove that a NURBS or rational Bezier patch is convex, or bound by how much it is not.

    Raises ValueError: a knot where the surface may be creased: a proof needs each smooth part
    separately.

    Parameters
    ----------
    surface : of any degree, and at least C1 inside its domain.
    outward : +1 if f_u x f_v points outward, -1 if inward; if not given, the side to which the
        patch bulges more.
    """
    _refuse_creases(surface)
    proof, bent = _proven(surface, outward, spare=False)
    if not proof.convex and not bent and any(len(knots) for knots in surface.spare_knots()):
        finer, _ = _proven(surface, outward, spare=True)
        proof = finer if finer.convex else proof
    return proof


def _proven(surface: NurbsSurface, outward: int | None, spare: bool) -> tuple[PatchProof, bool]:
    """As `prove`, with spans that also end at redundant knots if `spare`; was it found concave?"""
    grid, size, reach = _grid(surface, spare)
    pieces = _pieces(grid, reach)
    every = [piece.forms for piece in pieces]
    plane = plane_nearness([piece.points for piece in pieces], every)
    moved = max(piece.moved for piece in pieces)
    far = max(reach, 1.0)
    if plane.distance <= ROUNDED_POINTS * far and plane.turn <= STRAIGHT_TURN * far:
        proof = PatchProof(
            convex=True,
            defect=(plane.rise + moved) * size,
            method="bernstein",
            hemisphere=in_hemisphere(every),
            place=pieces[0].parameters(ROOT),
            sense=0,
            tilt=plane.turn,
        )
        return proof, False
    pieces, near = _straightened(grid, pieces, reach) or (pieces, Nearness(0.0, 0.0))
    bends = np.concatenate([_bends(piece.forms) for piece in pieces])
    sense = outward if outward is not None else (-1 if float(bends.sum()) > 0.0 else 1)
    results = [_search(piece, sense) for piece in pieces]
    dents = [dent for r in results for dent in r.dents]
    rise, tilt = dents_total(dents)
    worst = int(np.argmin([np.nan_to_num(r.found, nan=np.inf) for r in results]))
    convex = rise <= PROVEN_DEFECT * max(reach, 1.0) and all(r.convex for r in results)
    rise, tilt = min(rise + near.rise, plane.rise), min(tilt + near.turn, plane.turn)
    flat = convex and float(np.abs(bends).max(initial=0.0)) <= NEARLY_FLAT and _flat(pieces, sense)
    proof = PatchProof(
        convex=convex,
        defect=(rise + moved) * size,
        method="bernstein",
        hemisphere=in_hemisphere(every),
        place=pieces[worst].parameters(results[worst].cell),
        sense=0 if flat else sense,
        tilt=tilt,
        curvature=-max((d.curvature for d in dents), default=0.0) / size,
    )
    return proof, results[worst].found < -CURVATURE_ROUNDING


def _refuse_creases(surface: NurbsSurface) -> None:
    vectors = (surface.essential_u, surface.essential_v)
    for name, vector, knots in zip("uv", vectors, surface.breaks(), strict=True):
        for knot in knots:
            if vector.multiplicity(knot) >= vector.degree:
                raise StandoffError(
                    f"The surface may be creased at {name} = {knot}, a knot of multiplicity "
                    f"{vector.multiplicity(knot)} with degree {vector.degree}: split it there "
                    "(surface.restricted) and prove its parts."
                )


def _grid(surface: NurbsSurface, spare: bool) -> tuple[Grid, float, float]:
    """The spans of a surface relative to its centre, scaled to size one.

    Also the size, length, and how many sizes away from the origin the control points lie.
    """
    low, high = surface.box()
    centre, size = 0.5 * (low + high), float(np.linalg.norm(high - low))
    reach = float(np.maximum(np.abs(low), np.abs(high)).max()) / size
    spans = surface.spans(spare)
    us = np.unique([span.domain[:2] for span in spans])
    vs = np.unique([span.domain[2:] for span in spans])
    h = np.array([span.points for span in spans])
    h = h / h[:, 3].max()
    h[:, :3] = (h[:, :3] - centre[:, None, None] * h[:, 3:]) / size
    return Grid(us, vs, h.reshape(len(us) - 1, len(vs) - 1, *h.shape[1:])), size, reach


def _pieces(grid: Grid, reach: float) -> list[BernsteinSpan]:
    return [
        _piece((u0, u1, v0, v1), grid.points[i, j], reach)
        for i, (u0, u1) in enumerate(pairwise(grid.us))
        for j, (v0, v1) in enumerate(pairwise(grid.vs))
    ]


def _piece(domain: Domain, points: Array, reach: float) -> BernsteinSpan:
    points, moved = with_poles(points / points[3].max())
    return BernsteinSpan(domain, points, moved, forms_of(points, reach))


def _straightened(
    grid: Grid, pieces: Sequence[BernsteinSpan], reach: float
) -> tuple[list[BernsteinSpan], Nearness] | None:
    """The patch as one ruled by straight lines, if it is so up to rounding, and how near it is."""
    for along_u in (False, True):
        ruled = ruled_along(grid, along_u, ROUNDED_POINTS * max(reach, 1.0))
        if ruled is None:
            continue
        turn = turn_to(ruled.spans, [piece.forms for piece in pieces], reach, along_u)
        if turn <= STRAIGHT_TURN * max(reach, 1.0):
            return _pieces(ruled.whole, reach), Nearness(ruled.distance, turn)
    return None


def _bends(forms: Forms) -> Array:
    """Twice the mean curvature along f_u x f_v at some points, 1 / size; regular points only."""
    t = np.array([0.125, 0.5, 0.875])
    jacobian = bernstein.grid_values(forms.jacobian, t, t)
    uu, uv, vv = bernstein.grid_values(forms.second, t, t)
    normal = np.linalg.norm(bernstein.grid_values(forms.normal, t, t), axis=0)
    weight = bernstein.grid_values(forms.weight, t, t)
    g = np.einsum("acij,bcij->abij", jacobian, jacobian)
    area = g[0, 0] * g[1, 1] - g[0, 1] ** 2
    for side in forms.sharp:
        distance = (t[:, None], 1.0 - t[:, None], t, 1.0 - t)[side]
        normal = normal * distance
    regular = (area > 0.0) & (normal > 0.0)
    total = g[1, 1] * uu - 2.0 * g[0, 1] * uv + g[0, 0] * vv
    bends: Array = (total * weight**3)[regular] / (area * normal)[regular]
    return bends


def _flat(pieces: Sequence[BernsteinSpan], sense: int) -> bool:
    """Is the patch convex to both sides?"""
    return all(curvature_bound(piece.forms, ROOT, -sense).convex for piece in pieces)


def _search(piece: BernsteinSpan, sense: int) -> SpanBound:
    """Halve the box that may dent most, until all are proven or the dents are known well enough."""

    def part(cell: DyadicBox) -> SearchPart[Box]:
        bound = curvature_bound(piece.forms, cell, sense)
        known = bound.least >= 0.0 or (bound.convex and bound.tight)
        closed = known or deep_enough(piece.forms, cell)
        return SearchPart(_weight(bound), (cell, bound), bound.found, closed)

    def halves(chosen: list[SearchPart[Box]]) -> list[SearchPart[Box]]:
        cell, bound = chosen[0].body
        return [part(half) for half in cell.halves(bound.along_u)]

    searched = best_first(
        [part(ROOT)],
        halves,
        goal=lambda _: np.inf,
        most=lambda found: FINE_SPLITS if found < -CURVATURE_ROUNDING else MOST_SPLITS,
    )
    boxes = [part.body for part in searched.closed + searched.open]
    dents = [_dent(piece, cell, bound) for cell, bound in boxes if bound.least < 0.0]
    convex = not searched.open and all(bound.convex for _, bound in boxes)
    place = ROOT if searched.place is None else searched.place[0]
    return SpanBound(dents, convex, searched.found, place)


def _weight(bound: CurvatureBound) -> float:
    """About minus the turn of normals the wrong way that a box may contain."""
    by_curvature = -bound.least * bound.width if bound.width > 0.0 else np.inf
    return -min(by_curvature, bound.turn)


def _dent(piece: BernsteinSpan, cell: DyadicBox, bound: CurvatureBound) -> Dent:
    h = cell.part(piece.points)
    x = (h[:3] / h[3]).reshape(3, -1)
    low, high = x.min(axis=1), x.max(axis=1)
    if -bound.least * float(np.linalg.norm(high - low)) <= bound.turn:
        return Dent(-bound.least, low, high)
    turn = bound.turn
    if bound.convex and bound.tight:
        # at a sharp apex the curvature grows as 1 / distance, so the turn by rounding stays
        turn = min(turn, bound.apex)
    return Dent(np.inf, low, high, turn)
