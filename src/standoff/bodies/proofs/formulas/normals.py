"""Normals of a patch given by a formula: within an open hemisphere, and how far from its axis."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import scipy

from standoff.bodies.proofs.formulas.forms import curvature_forms
from standoff.bodies.proofs.formulas.signs import (
    FIRST_GRID,
    ExpressionBounds,
    sign_of_product,
    widest,
)
from standoff.bodies.proofs.formulas.taylor import TaylorBounds, normal
from standoff.bodies.proofs.tolerances import FEW_OPERATIONS, LEAST_COSINE, SMALLEST_SIGN_BOX
from standoff.geometry.boxes import Boxes, grid
from standoff.geometry.formulas.compiled import Formula
from standoff.geometry.interval_vectors import mapped
from standoff.geometry.intervals import TINY, Interval
from standoff.typing import Array

# Boxes evaluated for one axis.
MOST_BOXES = 8_192
COORDINATES = np.concatenate([np.eye(3), -np.eye(3)])


@lru_cache(maxsize=256)
def hemisphere_axis(formula: Formula, domain: tuple[float, ...]) -> tuple[float, ...] | None:
    """A unit axis with which all normals x_u x x_v surely make less than 90 degrees, or None."""
    forms = curvature_forms(formula)
    if sign_of_product(forms.normal_signs, formula.variables, domain) == 0:
        return None
    bounds = _normal_bounds(formula, domain)
    seen = [bounds(boxes)[1] for boxes in (grid(domain, 2 * FIRST_GRID), _along_sides(domain))]
    normals = np.concatenate([0.5 * (s.lo + s.hi).T for s in seen])
    lengths = np.linalg.norm(normals, axis=1)
    normals = normals[lengths > 0.0] / lengths[lengths > 0.0, None]
    # the axes of coordinates too: seen along one of them a steep graph's normals have a sure sign
    for axis in _promising(normals):
        if _all_on_one_side(bounds, domain, axis):
            return tuple(float(a) for a in axis)
    return None


def _along_sides(domain: tuple[float, ...]) -> Boxes:
    """Points on the sides, where normals lean most: boxes of no extent."""
    u0, u1, v0, v1 = domain
    u, v = np.linspace(u0, u1, FIRST_GRID + 1), np.linspace(v0, v1, FIRST_GRID + 1)
    sides = [(u, 0 * v + v0), (u, 0 * v + v1), (0 * u + u0, v), (0 * u + u1, v)]
    points = np.concatenate([np.stack(s, axis=1) for s in sides])
    return Boxes(points, points)


@lru_cache(maxsize=256)
def _normal_bounds(formula: Formula, domain: tuple[float, ...]) -> ExpressionBounds | TaylorBounds:
    """By the exact forms, free of factors that vanish at a collapsed side, or by Taylor series."""
    forms = curvature_forms(formula)
    if forms.exact:
        return ExpressionBounds(list(forms.normal), formula.variables)
    return TaylorBounds(formula, domain, normal)


def _promising(normals: Array) -> list[Array]:
    """Axes that all normals (n, 3) seen are near enough to, the best first."""
    normals = normals[np.isfinite(normals).all(axis=1)]
    if not len(normals):
        return []
    mean = normals.mean(axis=0)
    axes = [*COORDINATES, centre_of_normals(normals), mean / max(np.linalg.norm(mean), TINY)]
    least = [(float((normals @ a).min()), k) for k, a in enumerate(axes) if a is not None]
    ranked = [axes[k] for cosine, k in sorted(least, reverse=True) if cosine > LEAST_COSINE]
    return [a for a in ranked if a is not None]


def centre_of_normals(normals: Array) -> Array | None:
    """A unit axis with which all (n, 3) normals make less than 90 degrees, None if there is none.

    A linear program: the greatest t with normals @ a >= t and |a_i| <= 1.
    """
    rows = np.column_stack([-normals, np.ones(len(normals))])
    limits = [(-1.0, 1.0)] * 3 + [(None, None)]
    found = scipy.optimize.linprog([0.0, 0.0, 0.0, -1.0], rows, np.zeros(len(rows)), bounds=limits)
    if found.status != 0 or found.x[3] <= 0.0:
        return None
    axis = found.x[:3] / np.linalg.norm(found.x[:3])
    return np.asarray(axis)


def _all_on_one_side(
    bounds: ExpressionBounds | TaylorBounds, domain: tuple[float, ...], axis: Array
) -> bool:
    size = np.diff(np.reshape(domain, (-1, 2)), axis=1).ravel()
    boxes = grid(domain, FIRST_GRID)
    evaluated = 0
    while len(boxes):
        evaluated += len(boxes)
        if (
            evaluated * bounds.cost > MOST_BOXES
            or ((boxes.high - boxes.low) / size).max() < SMALLEST_SIGN_BOX
        ):
            return False
        value, _, slopes = bounds(boxes)
        length = np.sqrt((value.magnitude**2).sum(axis=0))
        is_open = ~(along(value, axis).lo > LEAST_COSINE * length)
        boxes = boxes[is_open]
        slopes = [Interval(s.lo[:, is_open], s.hi[:, is_open]) for s in slopes]
        if len(boxes):
            boxes = boxes.halves(widest(boxes, slopes, size))
    return True


def along(vectors: Interval, axis: Array) -> Interval:
    """(n,) bounds of axis . vectors, (3, n)."""
    row = mapped(axis[None], vectors)
    return Interval(row.lo[0], row.hi[0])


def least_cosines(
    formula: Formula, domain: tuple[float, ...], boxes: Boxes, cofactors: Array, axis: Array
) -> Array:
    """(n,) the least cosine between `axis` and cofactors @ normal over each box; -1 if unknown."""
    value = mapped(cofactors, _normal_bounds(formula, domain)(boxes)[0])
    with np.errstate(invalid="ignore"):
        high = np.sqrt((value.magnitude**2).sum(axis=0)) * (1.0 + FEW_OPERATIONS)
        low = along(value, axis).lo
        cosine = np.where(low > 0.0, low / high, -1.0)
    return np.asarray(np.nan_to_num(cosine, nan=-1.0))
