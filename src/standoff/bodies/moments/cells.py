"""Integrals of several functions at once over rectangles, refined until successive rules agree.

Fejér's second rule with 2^k - 1 nodes. It is open, so that no collapsed side is evaluated, has
positive weights, and every other node is a node of the previous rule, so that the difference of the
two costs nothing (J. Waldvogel, BIT Numerical Mathematics 46, 2006, 195-202).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from standoff.bodies.moments.tolerances import LEAST_SHARE
from standoff.geometry.validation import Array

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

Integrand = Callable[[Array, Array], Array]
"""Parameters (m,) and (n,) to values (m, n, columns) on their grid."""


@dataclass(frozen=True)
class Cell:
    """A rectangle of parameters with its rule.

    Attributes
    ----------
    function : Integrand
    low, high : pairs of float
        Its corners.
    levels : pair of int
        2^level - 1 nodes along each parameter.
    owner : int
        The face of which it is a part.
    """

    function: Integrand
    low: tuple[float, float] = (0.0, 0.0)
    high: tuple[float, float] = (1.0, 1.0)
    levels: tuple[int, int] = (FIRST_LEVEL, FIRST_LEVEL)
    owner: int = 0


@dataclass(frozen=True)
class Sums:
    """A cell's integrals (columns,).

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


def evaluated(cell: Cell) -> Sums:
    """A cell's integrals by its rule, and their estimated errors along each parameter."""
    spans = [b - a for a, b in zip(cell.low, cell.high, strict=True)]
    rules = [rule(level) for level in cell.levels]
    t, s = (a + span * r[0] for a, span, r in zip(cell.low, spans, rules, strict=True))
    values = cell.function(t, s) * (spans[0] * spans[1])
    (_, along), (_, across) = rules
    by_first = along @ (across[0] @ values)
    by_second = across @ (along[0] @ values.swapaxes(0, 1))
    magnitude = along[0] @ (across[0] @ np.abs(values))
    return Sums(by_first[0], _remainder(by_first), _remainder(by_second), magnitude)


def _remainder(sums: Array) -> Array:
    """The estimated error of the finest of three rules, (3, columns).

    It is the last difference, times its ratio to the previous difference, times SAFETY: more than
    all later differences together if they keep decreasing at this rate. The ratio counts as at
    least LEAST_SHARE, in case two rules agree by chance.
    """
    last, before = np.abs(sums[0] - sums[1]), np.abs(sums[1] - sums[2])
    size, previous = float(np.linalg.norm(last)), float(np.linalg.norm(before))
    share = SAFETY * size / previous if previous > 0.0 else 1.0
    return np.asarray(min(max(share, LEAST_SHARE), 1.0) * last)


def integrate(
    cells: list[Cell], scale: Callable[[Array], Array], tolerance: float, most: int
) -> Total:
    """Refine cells until the sum of their error estimates is within a tolerance.

    Parameters
    ----------
    cells : list of Cell
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
    found = [(cell, evaluated(cell)) for cell in cells]
    nodes = sum(_count(cell) for cell in cells)
    while nodes < most:
        unit = 1.0 / scale(np.sum([sums.values for _, sums in found], axis=0))
        costs = np.array([_excess(cell, sums, unit) for cell, sums in found])
        if costs.sum() <= tolerance:
            break
        due = costs > 0.5 * tolerance / len(found)
        finer = [part for k in np.flatnonzero(due) for part in _refined(*found[k], unit)]
        nodes += sum(_count(cell) for cell in finer)
        kept = [found[k] for k in np.flatnonzero(~due)]
        found = kept + [(cell, evaluated(cell)) for cell in finer]
    of: dict[int, tuple[Array, Array]] = {}
    for cell, sums in found:
        values, remainder = of.get(cell.owner, (0.0, 0.0))
        of[cell.owner] = values + sums.values, remainder + sums.remainder
    return Total(
        np.sum([sums.values for _, sums in found], axis=0),
        np.sum([sums.remainder for _, sums in found], axis=0),
        np.sum([sums.magnitude for _, sums in found], axis=0),
        nodes,
        of,
    )


def _count(cell: Cell) -> int:
    return int((2 ** cell.levels[0] - 1) * (2 ** cell.levels[1] - 1))


def _excess(cell: Cell, sums: Sums, unit: Array) -> float:
    """The greatest relative error of a cell; 0 if it is roundoff or the cell cannot be halved."""
    spans = [b - a for a, b in zip(cell.low, cell.high, strict=True)]
    if min(spans) < NARROWEST_CELL:
        return 0.0
    rounding = ROUNDINGS * np.finfo(float).eps * sums.magnitude
    return float((np.maximum(sums.remainder - rounding, 0.0) * unit).max())


def _refined(cell: Cell, sums: Sums, unit: Array) -> list[Cell]:
    """More nodes along the parameter that needs them; after the last rule, two halves."""
    needs = [float((one * unit).max()) for one in (sums.first, sums.second)]
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
