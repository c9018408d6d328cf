"""The panel of a pair of solids: numbers, plot, all minima, and what a user can ask for."""

from __future__ import annotations

from typing import Any, Protocol

from standoff.solids.answer import SolidProximity
from standoff.view.live_solids import known_of
from standoff.view.motion_panel import Glazed, Later
from standoff.view.pair_panel import Hands, PairPanel
from standoff.view.solid_readout import minima_list, solid_readout


class SolidRequests(Hands, Glazed, Protocol):
    """What a user of the page can ask for."""


class SolidPanel(PairPanel):
    """All elements of the panel.

    Parameters
    ----------
    server, later : as for `MotionPanel`
    asks : SolidRequests
    """

    def __init__(self, server: Any, later: Later, asks: SolidRequests) -> None:
        super().__init__(server, later, asks)
        tabs = server.gui.add_tab_group()
        with tabs.add_tab("Move"):
            self._make_playing()
            self._make_hand()
            self._make_glass(asks)
        with tabs.add_tab("Minima"):
            self._minima = server.gui.add_html("")

    def show(self, answer: SolidProximity) -> None:
        """Show the numbers of an answer."""
        self._readout.content = solid_readout(answer, self._names, self._unit, self._size)
        self._minima.content = minima_list(answer, self._unit)
        self._plot.stands(known_of(answer))

    def traces(self, time: float, answer: SolidProximity) -> None:
        """Add an instant of solids that are moved by hand to the plot."""
        self._plot.traces(time, known_of(answer))
