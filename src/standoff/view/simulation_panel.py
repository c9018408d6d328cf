"""The panel of a simulation: numbers, plot of forces, all contacts, and what a user can ask for."""

from __future__ import annotations

from typing import Any, Protocol

from standoff.view.motion_panel import Glazed, Later, MotionPanel, Plays
from standoff.view.player import Player
from standoff.view.plot import Curves
from standoff.view.shown_simulation import Instant

FORCES = Curves(("total", "greatest"), ("all forces", "the greatest"))
"""Of a simulation."""

STRETCHES = {"×0.1": 0.1, "×0.3": 0.3, "×1": 1.0, "×3": 3.0, "×10": 10.0}
"""How much longer the arrows of forces are than usual, by the words of the page."""


class SimulationRequests(Plays, Glazed, Protocol):
    """What a user of the page can ask for."""

    def step(self) -> None: ...
    def back(self) -> None: ...
    def stretch(self, factor: float) -> None: ...


class SimulationPanel(MotionPanel):
    """All elements of the panel.

    Parameters
    ----------
    server, later : as for `MotionPanel`
    asks : SimulationRequests
    """

    def __init__(self, server: Any, later: Later, asks: SimulationRequests) -> None:
        super().__init__(server, later, asks, FORCES)
        self._asks = asks
        tabs = server.gui.add_tab_group()
        with tabs.add_tab("Move"):
            self._make_playing()
            self._make_steps()
            self._make_arrows()
            self._make_glass(asks)
        with tabs.add_tab("Contacts"):
            self._contacts = server.gui.add_html("")
        with tabs.add_tab("Energy"):
            self._energy = server.gui.add_html("")

    def _make_steps(self) -> None:
        self._step = self._gui.add_button("One step")
        self._back = self._gui.add_button("Back to the start")

        @self._step.on_click
        async def _(_: Any) -> None:
            self._later(self._asks.step)

        @self._back.on_click
        async def _(_: Any) -> None:
            self._later(self._asks.back)

    def _make_arrows(self) -> None:
        self._stretch = self._gui.add_dropdown("arrows", tuple(STRETCHES), initial_value="×1")

        @self._stretch.on_update
        async def _(event: Any) -> None:
            factor = STRETCHES.get(event.target.value, 1.0)
            self._later(lambda: self._asks.stretch(factor))

    def begin(self, title: str, player: Player[Any] | None, usual: float) -> None:
        """Set the panel up.

        Parameters
        ----------
        title : str
        player : Player or None
            None of a system that is stepped.
        usual : float
            Force of which the plot is [force].
        """
        self._gui.set_panel_label(title)
        self._moves(player)
        self._play.visible = self._speed.visible = True
        self._plot.begin(usual)

    def show(self, texts: tuple[str, str, str], instant: Instant) -> None:
        """Show an instant; `texts` are its numbers, its contacts and its energies."""
        for element, text in zip((self._readout, self._contacts, self._energy), texts, strict=True):
            element.content = text
        self._plot.stands(instant)

    def traces(self, instant: Instant) -> None:
        """Add an instant of a system that is stepped to the plot."""
        self._plot.traces(instant.time, instant)

    def rests(self) -> None:
        """Show the plot up to where the system stands."""
        self._plot.rests()

    def forget(self) -> None:
        """Empty the plot."""
        self._plot.forget()
