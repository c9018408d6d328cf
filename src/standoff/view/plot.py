"""The plot of the page: two curves of the last seconds, such as distance and lower bound."""

from __future__ import annotations

from collections import deque
from typing import Any, NamedTuple

import numpy as np

from standoff.typing import Array
from standoff.view.player import Player
from standoff.view.plot_scale import PlotScale, scale_of
from standoff.view.readout import COLOURS

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
