"""The panel of a world's page: numbers, plot, matrix, and what a user can ask for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from standoff.view.motion_panel import Later, MotionPanel, Plays
from standoff.view.moving_world import WorldPlotPoint
from standoff.view.player import Player
from standoff.view.tolerances import MAX_TEXT

NOTHING = "nothing"


class WorldRequests(Plays, Protocol):
    """What a user of the page can ask for."""

    def hand(self, number: int | None) -> None: ...
    def back(self) -> None: ...


class WorldPanel(MotionPanel):
    """All elements of the panel.

    Parameters
    ----------
    server, later : as for `MotionPanel`
    asks : WorldRequests
    moving : sequence of str
        Names of the bodies that can be dragged.
    """

    def __init__(
        self,
        server: Any,
        later: Later,
        asks: WorldRequests,
        moving: Sequence[str],
    ) -> None:
        super().__init__(server, later, asks)
        self._asks = asks
        tabs = server.gui.add_tab_group()
        with tabs.add_tab("Move"):
            self._make_playing()
            self._make_hand(moving)
        with tabs.add_tab("Matrix"):
            self._matrix = server.gui.add_html("")

    def _make_hand(self, moving: Sequence[str]) -> None:
        names = [_option(name, k) for k, name in enumerate(moving)]
        self._hand = self._gui.add_dropdown("drag", (*names, NOTHING), initial_value=NOTHING)
        self._back = self._gui.add_button("Back to the scene's poses", visible=False)

        @self._hand.on_update
        async def _(event: Any) -> None:
            if event.client is not None:
                number = self._hand.options.index(event.target.value)
                chosen = number if number < len(names) else None
                self._later(lambda: self._asks.hand(chosen))

        @self._back.on_click
        async def _(_: Any) -> None:
            self._later(self._asks.back)

    def begin(self, title: str, player: Player[Any] | None, size: float) -> None:
        """Set the panel up.

        Parameters
        ----------
        title : str
        player : Player or None
            None where nothing moves by itself.
        size : float
            Of the bodies [length].
        """
        self._gui.set_panel_label(title)
        self._moves(player)
        self._plot.begin(size)

    def hand_is(self, number: int | None) -> None:
        """Show which body has the handle."""
        self._hand.value = self._hand.options[-1 if number is None else number]

    def strayed(self, off: bool) -> None:
        """Show whether bodies are elsewhere than the scene says, so that there is a way back."""
        self._back.visible = off

    def forget(self) -> None:
        """Empty the plot."""
        self._plot.forget()

    def show(self, readout: str, known: WorldPlotPoint) -> None:
        """Show the numbers of an instant."""
        self._readout.content = readout
        self._plot.stands(known)

    def traces(self, time: float, known: WorldPlotPoint) -> None:
        """Add an instant of bodies that are moved by hand to the plot."""
        self._plot.traces(time, known)

    def rests(self) -> None:
        """Show the plot up to where the hand has stopped."""
        self._plot.rests()

    def matrix(self, picture: str) -> None:
        """Show the matrix of clearances."""
        self._matrix.content = picture


def _option(name: str, number: int) -> str:
    """A name as a choice: as long as a message may hold, and like no other."""
    if len(name) <= MAX_TEXT - 8 and name != NOTHING:
        return name
    return f"{name[: MAX_TEXT - 8]} ({number + 1})"
