"""The plot of the page: two curves of the last seconds, such as distance and lower bound."""

from __future__ import annotations

from collections import deque
from decimal import Decimal
from math import ceil, floor, log10
from typing import Any, NamedTuple

import numpy as np

from standoff.typing import Array
from standoff.view.player import Player
from standoff.view.readout import COLOURS
from standoff.view.tolerances import LEVEL_PLOT

SPAN = 10.0
"""Time that the plot shows [s]."""

MOST_POINTS = 240
"""Points of a curve in the plot: more are not told apart at its width."""

EVERY = 5
"""Looks between two plots: as all of it is sent anew, it is not drawn at each."""

LOOK = {"stroke": "gray", "grid": {"stroke": "rgba(128,128,128,.2)"}}
TIME_AXIS = {**LOOK, "size": 34, "label": "time, s", "labelSize": 14, "labelGap": 0}

DIGIT, GAP = 7, 22
"""Width of a number's character, and that of its tick and margin [pixels]."""


class Curves(NamedTuple):
    """What is plotted.

    Attributes
    ----------
    names : (str, str)
        Attributes of an instant, numbers, and of a recording, arrays of them.
    labels : (str, str)
        The same in words.
    """

    names: tuple[str, str]
    labels: tuple[str, str]


DISTANCES = Curves(("distance", "lower_bound"), ("distance", "lower bound"))
"""Of pairs and worlds."""


class Plot:
    """Two curves over time.

    Parameters
    ----------
    server : viser.ViserServer
    curves : Curves
    """

    def __init__(self, server: Any, curves: Curves = DISTANCES) -> None:
        self._server, self._curves = server, curves
        self._trace: deque[tuple[float, float, float]] = deque(maxlen=4 * MOST_POINTS)
        self._looks, self._behind = 0, False
        self._size = 1.0
        self._scale: PlotScale | None = None
        empty = np.array([0.0, 1.0])
        self._node = server.gui.add_uplot(
            (empty, empty * 0.0, empty * 0.0),
            (
                {"label": "s"},
                {"label": curves.labels[0], "stroke": COLOURS[0], "width": 2},
                {"label": curves.labels[1], "stroke": COLOURS[1], "width": 1, "dash": (4, 4)},
            ),
            scales={"x": {"time": False, "auto": True}},
            axes=(TIME_AXIS, LOOK),
            legend={"show": False},
            height=150,
            padding=(10, 12, 0, 0),
        )

    def begin(self, size: float) -> None:
        """Be the plot of numbers of that size: of bodies theirs [length]."""
        self._size, self._scale = size, None
        self.forget()

    def forget(self) -> None:
        """Empty the curves of the hand."""
        self._trace.clear()
        self._looks, self._behind = 0, False

    def stands(self, shown: Any) -> None:
        """Show level lines where nothing has moved yet."""
        if self._looks == 0:
            first, second = (np.full(2, value) for value in self._of(shown))
            self._draw(np.array([0.0, 1.0]), first, second)

    def plays(self, player: Player[Any]) -> None:
        """Show a recording up to where it stands."""
        if self._due() or not player.playing:
            rows, run = player.behind(SPAN, MOST_POINTS), player.recording
            first, second = (values[rows] for values in self._of(run))
            self._draw(run.time[rows], first, second)

    def traces(self, time: float, shown: Any) -> None:
        """Go on with an instant of bodies that are moved by hand, or step by step."""
        self._trace.append((time, *self._of(shown)))
        self._behind = True
        if self._due():
            self.rests()

    def rests(self) -> None:
        """Show the curves of the hand up to their last instant."""
        if self._behind:
            self._behind = False
            rows = np.array([row for row in self._trace if row[0] >= self._trace[-1][0] - SPAN])
            # Thinned from the end: the last instant is the one that the table tells.
            every = -(-len(rows) // MOST_POINTS)
            self._draw(*rows[::-every][::-1].T)

    def _of(self, shown: Any) -> tuple[Any, Any]:
        first, second = (getattr(shown, name) for name in self._curves.names)
        return first, second

    def _due(self) -> bool:
        self._looks += 1
        return self._looks % EVERY == 1

    def _draw(self, time: Array, first: Array, second: Array) -> None:
        known = np.isfinite(first) & np.isfinite(second)
        if known.sum() < 2:
            return
        curves = time[known], first[known], second[known]
        self._scale = scale = scale_of(np.concatenate(curves[1:]), self._size, self._scale)
        width = GAP + DIGIT * max(len(label) for label in scale.labels)
        upwards = {**LOOK, "size": width, "splits": scale.ticks, "values": scale.labels}
        with self._server.atomic():
            # Both ranges are told: left to itself the page writes three decimals of a number that
            # changes in the fifth, and finds no range of time when its scale upwards is another.
            self._node.scales = {
                "x": {"time": False, "range": (float(curves[0][0]), float(curves[0][-1]))},
                "y": {"range": (scale.ticks[0], scale.ticks[-1])},
            }
            self._node.axes = (TIME_AXIS, upwards)
            self._node.data = curves


# The scale beside the plot: round numbers that differ as they are written.

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
