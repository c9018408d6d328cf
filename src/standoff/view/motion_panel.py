"""What plays a motion on a page's panel: a button, the time, and the speed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from standoff.view.player import SPEEDS, Player
from standoff.view.plot import DISTANCES, Curves, Plot

PHONE = """<style data-of="phone">@media (max-width: 36em) {
.mantine-Paper-root:has([data-of=phone]),
.mantine-Paper-root:has([data-of=phone]) [style*="width: 20em"] { width: 100% !important; }
}</style>"""
"""Viser's panel of a narrow window is 20 em wide, and leaves a strip of the scene beside it."""

Later = Callable[[Callable[[], None]], None]
"""Takes what is to be done in the page's thread."""


class Plays(Protocol):
    """What a user can ask of a motion."""

    def play(self, playing: bool) -> None: ...
    def seek(self, time: float) -> None: ...
    def speed(self, factor: float) -> None: ...


class Glazed(Protocol):
    """What a user can ask of how bodies look."""

    def glass(self, on: bool) -> None: ...


class MotionPanel:
    """What every panel has: an answer in words, its plot, and what plays a motion; a subclass says
    where that stands.

    Parameters
    ----------
    server : viser.ViserServer
    later : Later
    asks : Plays
    curves : Curves
        What is plotted.
    """

    def __init__(
        self,
        server: Any,
        later: Later,
        asks: Plays,
        curves: Curves = DISTANCES,
    ) -> None:
        self._gui, self._later, self._player = server.gui, later, asks
        self._playing = False
        self._gui.configure_theme(show_logo=False, show_share_button=False)
        self._gui.add_html(PHONE)
        self._readout = self._gui.add_html("")
        self._plot = Plot(server, curves)

    def _make_playing(self) -> None:
        gui = self._gui
        self._play = gui.add_button("Play")
        self._time = gui.add_slider("time, s", 0.0, 1.0, 0.001, 0.0)
        self._speed = gui.add_dropdown("speed", tuple(SPEEDS), initial_value="×1")

        @self._play.on_click
        async def _(_: Any) -> None:
            playing = not self._playing
            self._later(lambda: self._player.play(playing))

        @self._time.on_update
        async def _(event: Any) -> None:
            if event.client is not None:
                time = float(event.target.value)
                self._later(lambda: self._player.seek(time))

        @self._speed.on_update
        async def _(event: Any) -> None:
            factor = SPEEDS.get(event.target.value, 1.0)
            self._later(lambda: self._player.speed(factor))

    def _make_glass(self, asks: Glazed) -> None:
        self._glass = self._gui.add_checkbox("as if of glass", True)

        @self._glass.on_update
        async def _(event: Any) -> None:
            on = bool(event.target.value)
            if event.client is not None:
                self._later(lambda: asks.glass(on))

    def _moves(self, player: Player[Any] | None) -> None:
        """Show the part, with the times of a motion, or hide it where nothing moves by itself."""
        for element in (self._play, self._time, self._speed):
            element.visible = player is not None
        if player is not None:
            self._time.min, self._time.max = player.first, player.last
            self._time.step = (player.last - player.first) / 1000.0
            self._time.value = player.time

    def playing_is(self, playing: bool) -> None:
        """Show whether something is played, or pauses."""
        if self._playing != playing:
            self._playing = playing
            self._play.label = "Pause" if playing else "Play"

    def plays(self, player: Player[Any]) -> None:
        """Show where a recording stands, and its frames up to there."""
        self.playing_is(player.playing)
        self._time.value = round(player.time, 4)
        self._plot.plays(player)
