"""Integrals of several functions at once over rectangles, refined until successive rules agree.

Fejér's second rule with 2^k - 1 nodes. It is open, so that no collapsed side is evaluated, has
positive weights, and every other node is a node of the previous rule, so that the difference of the
two costs nothing (J. Waldvogel, BIT Numerical Mathematics 46, 2006, 195-202).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.moments.tolerances import LEAST_SHARE
from standoff.typing import Array

# Levels of the rules along each parameter: 2^k - 1 nodes. After the last one a cell is halved.
FIRST_LEVEL, LAST_LEVEL = 3, 6
# The sum of a rule has this many roundings (eps of the sum of its terms' magnitudes): a smaller
# difference between two rules means nothing.
ROUNDINGS = 16.0
# A remainder is this many times the value predicted from the last two differences.
SAFETY = 8.0
# A cell this narrow, as a fraction of its original rectangle, is not refined further.
NARROWEST_CELL = 2.0**-40

# Points that a boundary of many cells may use for each, some ten times as many as at first.
CELL_NODES = 500

# About as many nodes are evaluated at once as the caches hold the values of.
BATCH_NODES = 4096

Integrand = Callable[[Sequence[Any], Array, Array], Array]
"""Pieces, and parameters (k, m) and (k, n) of k cells, to values (k, m, n, columns) on their
grids."""


@dataclass(frozen=True)
class MomentCell:
    """A rectangle of parameters with its rule.

    Attributes
    ----------
    function : Integrand
        Cells with the same function and levels are evaluated together.
    low, high : pairs of float
        Its corners.
    levels : pair of int
        2^level - 1 nodes along each parameter.
    owner : int
        The face of which it is a part.
    piece : any
        What the function is to know of this cell.
    """

    function: Integrand
    low: tuple[float, float] = (0.0, 0.0)
    high: tuple[float, float] = (1.0, 1.0)
    levels: tuple[int, int] = (FIRST_LEVEL, FIRST_LEVEL)
    owner: int = 0
    piece: Any = None

    @property
    def nodes(self) -> int:
        return int((2 ** self.levels[0] - 1) * (2 ** self.levels[1] - 1))


class Sums(NamedTuple):
    """The integrals of cells, (cells, columns).

    Attributes
    ----------
    values : by the rule.
    first, second : their errors along each parameter, estimated from the rules with half and a
        quarter of the nodes.
    magnitude : integrals of the absolute values.
    """

    values: Array
    first: Array
    second: Array
    magnitude: Array

    @property
    def remainder(self) -> Array:
        return self.first + self.second

    def only(self, which: NDArray[np.int_]) -> Sums:
        return Sums(*(rows[which] for rows in self))


@dataclass(frozen=True)
class Total:
    """Integrals over all cells, (columns,), and estimates of their errors.

    Attributes
    ----------
    values : array
    remainder : array
        Errors from the finite number of nodes.
    magnitude : array
        Integrals of absolute values.
    nodes : int
        How many points were used.
    of : dict
        (values, remainder) of each owner's cells.
    """

    values: Array
    remainder: Array
    magnitude: Array
    nodes: int
    of: dict[int, tuple[Array, Array]]


@cache
def rule(level: int) -> tuple[Array, Array]:
    """(nodes (n,) on [0, 1], weights (3, n) at them of this rule and of the two previous ones)."""
    n = 2**level - 1
    angles = np.pi * np.arange(1, n + 1) / (n + 1)
    weights = np.zeros((3, n))
    for k in range(3):
        step = 2**k
        weights[k, step - 1 :: step] = _weights(angles[step - 1 :: step])
    return 0.5 * (1.0 - np.cos(angles)), weights


def _weights(angles: Array) -> Array:
    odd = np.arange(1, len(angles) + 1, 2)
    series = (np.sin(np.outer(angles, odd)) / odd).sum(axis=1)
    return np.asarray(2.0 * np.sin(angles) * series / (len(angles) + 1))


def evaluated(cells: Sequence[MomentCell]) -> Sums:
    """Integrals of cells by their rules, and their estimated errors along each parameter."""
    alike: dict[tuple[Integrand, tuple[int, int]], list[int]] = {}
    for k, cell in enumerate(cells):
        alike.setdefault((cell.function, cell.levels), []).append(k)
    order, parts = [], []
    for numbers in alike.values():
        size = max(BATCH_NODES // cells[numbers[0]].nodes, 1)
        for first in range(0, len(numbers), size):
            batch = numbers[first : first + size]
            order += batch
            parts.append(_together([cells[k] for k in batch]))
    return _joined(parts).only(np.argsort(order))


def _joined(parts: Sequence[Sums]) -> Sums:
    return Sums(*map(np.concatenate, zip(*parts, strict=True)))


def _together(cells: Sequence[MomentCell]) -> Sums:
    """The same for cells with the same function and levels."""
    low, high = (np.array([getattr(cell, end) for cell in cells]) for end in ("low", "high"))
    spans = high - low
    rules = [rule(level) for level in cells[0].levels]
    t, s = (low[:, i, None] + spans[:, i, None] * rules[i][0] for i in (0, 1))
    values = cells[0].function([cell.piece for cell in cells], t, s)
    values = values * spans.prod(axis=1)[:, None, None, None]
    (_, along), (_, across) = rules
    by_first = along @ (across[0] @ values)
    by_second = across @ (along[0] @ values.swapaxes(1, 2))
    magnitude = along[0] @ (across[0] @ np.abs(values))
    return Sums(by_first[:, 0], _remainders(by_first), _remainders(by_second), magnitude)


def _remainders(sums: Array) -> Array:
    """The estimated errors of the finest of three rules, (cells, 3, columns).

    They are the last difference, times its ratio to the previous difference, times SAFETY: more
    than all later differences together if they keep decreasing at this rate. The ratio counts as at
    least LEAST_SHARE, in case two rules agree by chance.
    """
    last, before = np.abs(sums[:, 0] - sums[:, 1]), np.abs(sums[:, 1] - sums[:, 2])
    size, previous = (np.linalg.norm(rows, axis=1) for rows in (last, before))
    share = np.divide(SAFETY * size, previous, out=np.ones_like(size), where=previous > 0.0)
    return np.asarray(np.clip(share, LEAST_SHARE, 1.0)[:, None] * last)


def integrate(
    cells: list[MomentCell], scale: Callable[[Array], Array], tolerance: float, most: int
) -> Total:
    """Refine cells until the sum of their error estimates is within a tolerance.

    Parameters
    ----------
    cells : list of MomentCell
    scale : callable
        From the integrals (columns,) the scales of their errors; inf for columns that need not be
        accurate.
    tolerance : float
        Relative to these scales.
    most : int
        About the greatest number of points to use, or `CELL_NODES` for each cell if that is more.
        What is reached by then is the answer, and its remainder says how accurate it is.
    """
    most = max(most, CELL_NODES * len(cells))
    sums = evaluated(cells)
    nodes = sum(cell.nodes for cell in cells)
    while nodes < most:
        unit = 1.0 / scale(sums.values.sum(axis=0))
        costs = _excesses(cells, sums, unit)
        if costs.sum() <= tolerance:
            break
        due = costs > 0.5 * tolerance / len(cells)
        needs = np.column_stack([(one * unit).max(axis=1) for one in (sums.first, sums.second)])
        finer = [part for k in np.flatnonzero(due) for part in _refined(cells[k], *needs[k])]
        nodes += sum(cell.nodes for cell in finer)
        kept = np.flatnonzero(~due)
        cells = [cells[k] for k in kept] + finer
        sums = _joined([sums.only(kept), evaluated(finer)])
    return Total(
        sums.values.sum(axis=0),
        sums.remainder.sum(axis=0),
        sums.magnitude.sum(axis=0),
        nodes,
        _owned(cells, sums),
    )


def _owned(cells: Sequence[MomentCell], sums: Sums) -> dict[int, tuple[Array, Array]]:
    owners, numbers = np.unique([cell.owner for cell in cells], return_inverse=True)
    found = np.zeros((2, len(owners), sums.values.shape[1]))
    for k, rows in enumerate((sums.values, sums.remainder)):
        np.add.at(found[k], numbers, rows)
    return {owner: (found[0, i], found[1, i]) for i, owner in enumerate(owners.tolist())}


def _excesses(cells: Sequence[MomentCell], sums: Sums, unit: Array) -> Array:
    """Of each cell the greatest relative error; 0 if it is roundoff or the cell cannot be
    halved."""
    low, high = (np.array([getattr(cell, end) for cell in cells]) for end in ("low", "high"))
    rounding = ROUNDINGS * np.finfo(float).eps * sums.magnitude
    errors = (np.maximum(sums.remainder - rounding, 0.0) * unit).max(axis=1)
    return np.where((high - low).min(axis=1) < NARROWEST_CELL, 0.0, errors)


def _refined(cell: MomentCell, *needs: float) -> list[MomentCell]:
    """More nodes along the parameter that needs them; after the last rule, two halves."""
    # both, if neither is much better than the other
    axes = [k for k in (0, 1) if needs[k] >= 0.1 * max(needs)]
    low, high, levels = cell.low, cell.high, list(cell.levels)
    full = [k for k in axes if levels[k] == LAST_LEVEL]
    for k in axes:
        levels[k] = min(levels[k] + 1, LAST_LEVEL)
    if not full:
        return [replace(cell, levels=(levels[0], levels[1]))]
    axis = max(full, key=lambda k: needs[k])
    levels[axis] = LAST_LEVEL - 1
    middle = 0.5 * (low[axis] + high[axis])
    left = tuple(middle if k == axis else high[k] for k in (0, 1))
    right = tuple(middle if k == axis else low[k] for k in (0, 1))
    pair = (levels[0], levels[1])
    return [
        replace(cell, high=(left[0], left[1]), levels=pair),
        replace(cell, low=(right[0], right[1]), levels=pair),
    ]
