"""The scale beside the plot: round numbers that differ as they are written."""

from __future__ import annotations

from decimal import Decimal
from math import ceil, floor, log10
from typing import NamedTuple

from standoff.typing import Array
from standoff.view.tolerances import LEVEL_PLOT

STEPS = 4
"""Steps of a scale at most, before it is widened to whole ones: more crowd a low plot."""

CALM = 0.35
"""Share of a scale that curves must fill to keep it: a plot that is scaled anew at each look
cannot be read."""

LONGEST = 7
"""Characters of a number beside the plot; a longer one is written with an exponent."""


class PlotScale(NamedTuple):
    """Of the numbers upwards in a plot.

    Attributes
    ----------
    ticks : tuple of float
        Evenly spaced; the first and the last are the ends of the scale.
    labels : tuple of str
        The same in writing; no two are equal.
    """

    ticks: tuple[float, ...]
    labels: tuple[str, ...]

    def holds(self, low: float, high: float) -> bool:
        """Can curves between these two be read on it?"""
        first, last = self.ticks[0], self.ticks[-1]
        return first <= low and high <= last and high - low >= CALM * (last - first)


def scale_of(values: Array, size: float, known: PlotScale | None = None) -> PlotScale:
    """Return the scale for curves.

    Parameters
    ----------
    values : array
        All numbers of the curves; at least one, all finite.
    size : float
        Of the bodies; its unit is that of `values`.
    known : PlotScale, optional
        Stays where the curves can be read on it.
    """
    low, high = float(values.min()), float(values.max())
    if known is not None and known.holds(low, high):
        return known
    if high - low < LEVEL_PLOT * size:
        half = max(abs(low), abs(high), 0.01 * size) / 2.0
        low, high = low - half, high + half
    power = floor(log10((high - low) / STEPS))
    unit = Decimal(1).scaleb(power)
    wide = (high - low) / STEPS / float(unit)
    # A little less than `wide`, as its own roundoff would skip a step that fits exactly.
    step = unit * next(times for times in (1, 2, 5, 10) if times >= 0.999 * wide)
    first, last = floor(low / float(step)), ceil(high / float(step))
    ticks = [k * step for k in range(first, last + 1)]
    return PlotScale(tuple(float(tick) for tick in ticks), _written(ticks, step))


def _written(ticks: list[Decimal], step: Decimal) -> tuple[str, ...]:
    """All ticks with as many digits as tell a step."""
    decimals = max(0, -int(step.normalize().as_tuple().exponent))
    plain = tuple("0" if not tick else f"{tick:.{decimals}f}" for tick in ticks)
    if max(len(label) for label in plain) <= LONGEST + 1:
        return plain
    largest = max(abs(tick) for tick in ticks)
    digits = largest.adjusted() - step.adjusted()
    short = tuple("0" if not tick else f"{tick:.{digits}e}" for tick in ticks)
    return min(plain, short, key=lambda labels: max(len(label) for label in labels))
