"""Signs of expressions over a whole domain, proven by intervals and halving."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from standoff.bodies.proofs.tolerances import SMALLEST_SIGN_BOX, ZERO_BOUND
from standoff.geometry.boxes import Boxes, grid
from standoff.geometry.formulas.enclosures import Enclosure, mean_value
from standoff.geometry.formulas.expressions import sympy_module
from standoff.geometry.intervals import Interval
from standoff.typing import Array

FIRST_GRID = 8
CHUNK = 1024
# Boxes evaluated for one sign: beyond, one that is still open is zero, or as good as zero,
# somewhere.
MOST_BOXES = 16_384


class ExpressionBounds:
    """k expressions over boxes, sharpened by their slopes."""

    def __init__(self, expressions: Sequence[Any], variables: tuple[str, ...]) -> None:
        sympy = sympy_module()
        self.count = len(expressions)
        symbols = [sympy.Symbol(v) for v in variables]
        slopes = [sympy.diff(e, s) for s in symbols for e in expressions]
        self.enclosure = Enclosure([*expressions, *slopes], variables)
        # evaluating costs by the operation, so that many fit in the same time when they are few
        self.cost = max(1.0, self.enclosure.length / 2000.0)

    def parts(self, values: Interval) -> list[Interval]:
        k = self.count
        return [
            Interval(values.lo[i : i + k], values.hi[i : i + k])
            for i in range(0, len(values.lo), k)
        ]

    def __call__(self, boxes: Boxes) -> tuple[Interval, Interval, list[Interval]]:
        """Bounds over the boxes and at their middles, (k, n), and of the slopes over the boxes."""
        value, *slopes = self.parts(self.enclosure(boxes))
        middle = self.parts(self.enclosure.at_middle(boxes))[0]
        return mean_value(value, middle, slopes, boxes), middle, slopes

    def at_ends(self, boxes: Boxes, slopes: list[Interval], row: int, greatest: bool) -> Array:
        """The least or the greatest of one expression (n,), where its slopes have one sign.

        A parameter along which it rises or falls over the whole box is set to that end of the
        box: a sign that ends at zero on the border of the domain is proven so.
        """
        low, high = boxes.low.copy(), boxes.high.copy()
        for axis, slope in enumerate(slopes):
            rises, falls = slope.lo[row] >= 0.0, slope.hi[row] <= 0.0
            if greatest:
                rises, falls = falls, rises
            high[rises, axis] = low[rises, axis]
            low[falls & ~rises, axis] = high[falls & ~rises, axis]
        bounds = self.parts(self.enclosure(Boxes(low, high)))[0]
        return np.asarray(bounds.hi[row] if greatest else bounds.lo[row])


def widest(boxes: Boxes, slopes: list[Interval], size: Array) -> Any:
    """The axis (n,) along which the expressions change most over each box."""
    sides = boxes.high - boxes.low
    change = np.stack(
        [np.nanmax(s.magnitude, axis=0, initial=0.0) * sides[:, k] for k, s in enumerate(slopes)], 1
    )
    # where nothing is known, or nothing changes, the longer side; and never a needle of a box
    extent = sides / size
    blind = ~np.isfinite(change).all(axis=1) | (change.max(axis=1) <= 0.0)
    change[blind] = extent[blind]
    change[extent < extent.max(axis=1, keepdims=True) * 2.0**-6] = -1.0
    return change.argmax(axis=1)


def proven_sign(expression: Any, variables: tuple[str, ...], domain: Sequence[float]) -> int:
    """+1 (or -1): nowhere below (above) zero; 0: not proven."""
    if expression.is_number:
        return int(sympy_module().sign(expression.evalf()))  # float64 may not hold it
    bounds = ExpressionBounds([expression], variables)
    size = np.diff(np.reshape(domain, (-1, 2)), axis=1).ravel()
    boxes = grid(domain, FIRST_GRID)
    middle = bounds(boxes)[1]
    up, down = bool((middle.lo > 0.0).any()), bool((middle.hi < 0.0).any())
    if up == down:
        return 0
    evaluated = 0
    while len(boxes):
        if evaluated * bounds.cost > MOST_BOXES:
            return 0
        evaluated += len(boxes)
        value, middle, slopes = bounds(boxes)
        if ((middle.hi < 0.0) if up else (middle.lo > 0.0)).any():
            return 0
        is_open = ~(value.lo[0] >= -ZERO_BOUND) if up else ~(value.hi[0] <= ZERO_BOUND)
        boxes, slopes = (
            boxes[is_open],
            [Interval(s.lo[:, is_open], s.hi[:, is_open]) for s in slopes],
        )
        if not len(boxes):
            break
        ends = bounds.at_ends(boxes, slopes, 0, greatest=not up)
        is_open = ~(ends >= -ZERO_BOUND) if up else ~(ends <= ZERO_BOUND)
        boxes, slopes = (
            boxes[is_open],
            [Interval(s.lo[:, is_open], s.hi[:, is_open]) for s in slopes],
        )
        if len(boxes) and ((boxes.high - boxes.low) / size).max() < SMALLEST_SIGN_BOX:
            return 0
        if len(boxes):
            boxes = boxes.halves(widest(boxes, slopes, size))
    return 1 if up else -1


def sign_of_product(
    factors: Sequence[Any], variables: tuple[str, ...], domain: Sequence[float]
) -> int:
    """The proven sign of a product, 0 where one of its factors' is open."""
    sign = 1
    for factor in factors:
        sign *= proven_sign(factor, variables, domain)
        if sign == 0:
            break
    return sign
