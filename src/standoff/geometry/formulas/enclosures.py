"""Bounds of expressions over boxes of parameters, and what they prove of a formula's jet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from standoff.geometry.boxes import Boxes, grid
from standoff.geometry.formulas.programs import ENCLOSED, ProgramText
from standoff.geometry.interval_vectors import mapped
from standoff.geometry.intervals import FUNCTIONS, Interval, interval
from standoff.geometry.tolerances import SMALLEST_BOX
from standoff.typing import Array

# Boxes per side with which a search begins.
FIRST_GRID = 8
# Boxes evaluated at once, and in one search: a few milliseconds, about a second.
CHUNK = 256
# Boxes that are halved first, so that a place is found before all of a line of poles is covered.
DIVE = 16
MOST_BOXES = 30_000


class Enclosure:
    """k expressions as a program over intervals."""

    def __init__(self, expressions: Sequence[Any], variables: tuple[str, ...]) -> None:
        lines, outputs = ProgramText(ENCLOSED).body(expressions)
        text = [f"def bounds({', '.join(variables)}):", *lines, f"return [{', '.join(outputs)}]"]
        namespace: dict[str, Any] = dict(FUNCTIONS)
        exec("\n    ".join(text), namespace)
        self._bounds = namespace["bounds"]
        self.length = sum(map(len, text))  # characters: what an evaluation costs

    def __call__(self, boxes: Boxes) -> Interval:
        """Bounds (k, n) of each expression over each box."""
        return self.at(*boxes.sides)

    def at(self, *sides: Interval) -> Interval:
        shape = np.shape(sides[0].lo)
        with np.errstate(all="ignore"):
            rows = [interval(r) for r in self._bounds(*sides)]
        return Interval(
            np.stack([np.broadcast_to(r.lo, shape) for r in rows]),
            np.stack([np.broadcast_to(r.hi, shape) for r in rows]),
        )

    def at_middle(self, boxes: Boxes) -> Interval:
        """Bounds (k, n) at the middle of each box."""
        return self.at(*(interval(c) for c in boxes.middle.T))


def mean_value(value: Interval, middle: Interval, slopes: Sequence[Interval], boxes: Boxes) -> Any:
    """Bounds from value at the middle + slope over the box * distance from the middle.

    All are (k, n); their excess decreases quadratically as boxes shrink.
    """
    centre = boxes.middle
    with np.errstate(all="ignore"):
        result = middle
        for k, slope in enumerate(slopes):
            away = interval(boxes.sides[k]) - interval(centre[:, k])
            result = result + slope * away
    return value.within(result)


def without_bounds(enclosure: Enclosure, domain: Sequence[float]) -> Array | None:
    """A place where the expressions have no finite bound; None if they are finite everywhere."""
    size = np.diff(np.reshape(domain, (-1, 2)), axis=1).ravel()
    waiting = [grid(domain, FIRST_GRID)]
    evaluated = 0
    while waiting:
        boxes = waiting.pop()
        if len(boxes) > CHUNK:
            waiting.append(boxes[CHUNK:])
            boxes = boxes[:CHUNK]
        evaluated += len(boxes)
        boxes = boxes[~enclosure(boxes).known.all(axis=0)]
        if not len(boxes):
            continue
        if len(boxes) > DIVE:
            waiting.append(boxes[DIVE:])
            boxes = boxes[:DIVE]
        extent = (boxes.high - boxes.low) / size
        if extent.max() <= SMALLEST_BOX or evaluated > MOST_BOXES:
            return np.asarray(boxes.middle[0])
        waiting.append(boxes.halves(extent.argmax(axis=1)))
    return None


def images(bounds: Enclosure, boxes: Boxes, linear: Array, shift: Array) -> Interval:
    """(3, n) bounds of linear @ x + shift over each box.

    bounds : of x and its first partial derivatives, three expressions each
    """
    value, *slopes = _by_three(bounds(boxes))
    middle = _by_three(bounds.at_middle(boxes))[0]
    by = interval(shift[:, None])
    natural, centre = mapped(linear, value) + by, mapped(linear, middle) + by
    held: Interval = mean_value(natural, centre, [mapped(linear, s) for s in slopes], boxes)
    return held


def hull(bounds: Enclosure, boxes: Boxes, linear: Array, shift: Array) -> tuple[Array, Array]:
    """(low, high), each (3,), of linear @ x + shift over all boxes."""
    held = images(bounds, boxes, linear, shift)
    return held.lo.min(axis=1), held.hi.max(axis=1)


def _by_three(rows: Interval) -> list[Interval]:
    return [Interval(rows.lo[k : k + 3], rows.hi[k : k + 3]) for k in range(0, len(rows.lo), 3)]
