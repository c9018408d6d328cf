"""Leaves of a planar boundary: parts of its curves with rigorous ranges."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.errors import BodyError
from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.interval_vectors import length
from standoff.geometry.intervals import Interval
from standoff.kernels.solids import planar_layout as P
from standoff.solids.planar.tolerances import (
    ARC_OF_CIRCLE,
    PADDED,
    TURN_OF_ARC,
    TURN_OF_LEAF,
    UNEVEN_LEAF,
)
from standoff.typing import Array

MOST_CUTS = 14
FEWEST_LEAVES = 3  # of a loop, so that no two leaves share both ends


class Ranges(NamedTuple):
    """Bounds over pieces of a curve, each (n,)."""

    bend: Array
    fastest: Array
    least: Array
    greatest: Array


def form_of(curve: Curve) -> int:
    """Is it a line, an arc of a circle, or neither?"""
    if isinstance(curve, Line):
        return P.LINE
    if isinstance(curve, ConicArc):
        a, b, _ = curve.basis().T
        sizes = float(np.linalg.norm(a)), float(np.linalg.norm(b))
        uneven = abs(sizes[0] - sizes[1]) + abs(float(a @ b)) / sizes[0]
        if uneven <= ARC_OF_CIRCLE * sizes[0]:
            return P.ARC
    return P.GENERAL


def ranges_over(curve: Curve, first: Array, last: Array) -> Ranges:
    """Bounds of |x_tt|, |x_t| and the curvature, of growing parameter, over parts of a curve."""
    with np.errstate(all="ignore"):
        jets = curve.jets_over(Interval(np.minimum(first, last), np.maximum(first, last)))
        x1, y1, x2, y2 = jets[0, 1], jets[1, 1], jets[0, 2], jets[1, 2]
        speed = length(x1, y1)
        curvature = (x1 * y2 - y1 * x2) / (speed * speed * speed)
        return Ranges(length(x2, y2).hi, speed.hi, curvature.lo, curvature.hi)


def cut_curve(curve: Curve, at_least: int) -> tuple[Array, Ranges]:
    """Ascending parameters (n + 1,) between the leaves of a curve, and the leaves' bounds.

    Raises BodyError: a curve whose tangent vanishes.
    """
    form = form_of(curve)
    spans = np.asarray(curve.spans(), dtype=np.float64)
    if form == P.ARC:
        at_least = max(at_least, int(np.ceil((curve.last - curve.first) / TURN_OF_ARC)))
    parts = [np.linspace(a, b, at_least + 1) for a, b in pairwise(spans)]
    cuts = np.unique(np.concatenate(parts))
    for _ in range(MOST_CUTS):
        ranges = ranges_over(curve, cuts[:-1], cuts[1:])
        known = np.isfinite(ranges.bend + ranges.fastest + ranges.least + ranges.greatest)
        if form != P.GENERAL:
            break
        arc = ranges.fastest * np.diff(cuts)
        turn = np.maximum(np.abs(ranges.least), np.abs(ranges.greatest)) * arc
        uneven = (ranges.greatest - ranges.least) * arc
        with np.errstate(invalid="ignore"):
            wide = ~known | (turn > TURN_OF_LEAF) | (uneven > UNEVEN_LEAF)
        if not wide.any():
            break
        middles = 0.5 * (cuts[:-1] + cuts[1:])[wide]
        cuts = np.sort(np.concatenate([cuts, middles]))
    if not known.all():
        place = 0.5 * (cuts[:-1] + cuts[1:])[~known][0]
        raise BodyError(
            f"The curve {curve!r} has no bounds near t = {place:.6g}, at "
            f"{curve.point(float(place))[:2]}: its tangent vanishes there; cut it there, or give "
            "it another parameter.",
            "loops",
            curve,
        )
    return cuts, ranges


class Leaves(NamedTuple):
    """Leaves of one curve in a loop: `reals` (n, N_LEAF) without the ends, `ints` (n, N_LEAF_INT)
    without what depends on the loop, and the first points (n, 2) of all."""

    reals: Array
    ints: NDArray[np.int64]
    starts: Array


def leaves_of(curve: Curve, backward: bool, at_least: int) -> Leaves:
    """The leaves of a curve in the direction in which its loop runs along it."""
    cuts, ranges = cut_curve(curve, at_least)
    n, form = len(cuts) - 1, form_of(curve)
    reals, ints = np.zeros((n, P.N_LEAF)), np.zeros((n, P.N_LEAF_INT), dtype=np.int64)
    reals[:, P.FROM], reals[:, P.UNTIL] = cuts[:-1], cuts[1:]
    reals[:, P.BEND], reals[:, P.GREATEST_SPEED] = ranges.bend, ranges.fastest
    reals[:, P.LEAST_K], reals[:, P.GREATEST_K] = ranges.least, ranges.greatest
    if form == P.LINE:
        reals[:, [P.BEND, P.LEAST_K, P.GREATEST_K]] = 0.0
    if form == P.ARC:
        centre = curve.basis()[:2, 2]
        reals[:, P.CENTRE : P.CENTRE + 2] = centre
    ints[:, P.FORM], ints[:, P.KIND] = form, curve.kind
    if backward:
        reals = reals[::-1].copy()
        reals[:, [P.FROM, P.UNTIL]] = reals[:, [P.UNTIL, P.FROM]]
        reals[:, [P.LEAST_K, P.GREATEST_K]] = -reals[:, [P.GREATEST_K, P.LEAST_K]]
    starts = np.array([curve.point(float(t))[:2] for t in reals[:, P.FROM]])
    size = float(np.abs(starts).max()) + float(np.abs(curve.point(curve.last)).max())
    reals[:, P.PAD] = PADDED * (size + float(ranges.fastest.max()) * float(np.diff(cuts).max()))
    return Leaves(reals, ints, starts)
