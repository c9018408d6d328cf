"""The page's panel: numbers, plot, and what a user can ask for."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from html import escape
from typing import Any, Protocol

from standoff.view.laws import INTEGRATORS, NAMES
from standoff.view.motion_panel import Later
from standoff.view.pair_panel import Hands, PairPanel
from standoff.view.player import Player
from standoff.view.pull import LEAST_FORCE, MAX_FORCE
from standoff.view.readout import readout
from standoff.view.shown import ShownPair

LOGGED = 12
"""Newest switches that the log shows."""

ROW = "<tr><td>{:.3f} s</td><td>{}</td><td>{} → {}</td></tr>"
LOG = '<table style="font-size:.8em;margin:.3em .9em;border-spacing:.6em 0">{}</table>'
NONE_YET = '<div style="font-size:.8em;margin:.5em .9em;opacity:.65">no switch yet</div>'


class PairRequests(Hands, Protocol):
    """What a user of the page can ask for; each is done between two looks of the page's thread."""

    def pull(self, on: bool) -> None: ...
    def limit(self, force: float) -> None: ...
    def law(self, name: str, integrator: str, share: float) -> None: ...
    def open(self, title: str) -> None: ...
    def export(self, client: Any) -> None: ...


class Panel(PairPanel):
    """All elements of the panel, for the life of a page.

    Parameters
    ----------
    server, later : as for `MotionPanel`
    asks : PairRequests
    titles : sequence of str
        Of the scenes that can be opened.
    """

    def __init__(
        self,
        server: Any,
        later: Later,
        asks: PairRequests,
        titles: Sequence[str],
    ) -> None:
        super().__init__(server, later, asks)
        self._asks: PairRequests = asks
        self._log: deque[str] = deque(maxlen=LOGGED)
        tabs = server.gui.add_tab_group()
        with tabs.add_tab("Move"):
            self._make_motion()
        with tabs.add_tab("Law"):
            self._make_law()
        with tabs.add_tab("Switches"):
            self._switches = server.gui.add_html(NONE_YET)
        with tabs.add_tab("Scenes"):
            self._make_scenes(titles)

    def _make_motion(self) -> None:
        self._make_playing()
        self._make_hand()
        self._make_pull()
        self._export = self._gui.add_button("Save the run as a page")

        @self._export.on_click
        async def _(event: Any) -> None:
            client = event.client
            self._later(lambda: self._asks.export(client))

    def _make_pull(self) -> None:
        gui = self._gui
        self._pull = gui.add_checkbox("through a spring", False)
        self._limit = gui.add_slider(
            "greatest force, N", LEAST_FORCE, MAX_FORCE, 0.1, MAX_FORCE, visible=False
        )

        @self._pull.on_update
        async def _(event: Any) -> None:
            on = bool(event.target.value)
            if event.client is not None:
                self._later(lambda: self._asks.pull(on))

        @self._limit.on_update
        async def _(event: Any) -> None:
            force = float(event.target.value)
            if event.client is not None:
                self._later(lambda: self._asks.limit(force))

    def _make_law(self) -> None:
        gui = self._gui
        self._law = gui.add_dropdown("law", NAMES, initial_value=NAMES[0])
        self._integrator = gui.add_dropdown("integrator", INTEGRATORS, initial_value="heun")
        self._share = gui.add_slider("gain / greatest", 0.01, 0.99, 0.01, 0.5)
        self._told_law = gui.add_html("")
        for element in (self._law, self._integrator, self._share):

            @element.on_update
            async def _(event: Any) -> None:
                if event.client is None:
                    return
                wanted = (
                    str(self._law.value),
                    str(self._integrator.value),
                    float(self._share.value),
                )
                self._later(lambda: self._asks.law(*wanted))

    def _make_scenes(self, titles: Sequence[str]) -> None:
        chosen = self._gui.add_dropdown("scene", tuple(titles), initial_value=titles[0])
        self._scenes = chosen
        button = self._gui.add_button("Open")

        @button.on_click
        async def _(_: Any) -> None:
            title = str(chosen.value)
            self._later(lambda: self._asks.open(title))

    def begin(
        self,
        title: str,
        player: Player[Any] | None,
        which: str,
        names: tuple[str, str],
        unit: str,
        size: float,
    ) -> None:
        """Set the panel up for a scene, as of `PairPanel`."""
        super().begin(title, player, which, names, unit, size)
        self._export.visible = player is not None

    def pull_is(self, on: bool, limit: float) -> None:
        """Show whether the body is pulled through the coupler, and its greatest force [N]."""
        self._pull.value, self._limit.visible = on, on
        self._limit.max = self._limit.value = limit

    def law_is(self, name: str, integrator: str, share: float, gain: float | None) -> None:
        """Show the law that is followed; `gain` [1/s] is that of the paper's law."""
        self._law.value, self._integrator.value, self._share.value = name, integrator, share
        self._integrator.visible = self._share.visible = gain is not None
        text = "" if gain is None else f"K = {gain:.4g} / s"
        self._told_law.content = (
            f'<div style="font-size:.8em;margin:.3em .9em" data-of="gain">{text}</div>'
        )

    def forget(self) -> None:
        """Empty plot and log."""
        super().forget()
        self._log.clear()
        self._switches.content = NONE_YET

    def switched(self, time: float, body: str, source: object, target: object) -> None:
        """Note a switch of a body's feature."""
        row = ROW.format(time, escape(body), escape(str(source)), escape(str(target)))
        self._log.appendleft(row)
        self._switches.content = LOG.format("".join(self._log))

    def show(self, shown: ShownPair, force: float | None = None) -> None:
        """Show the numbers of an instant; `force` [N] of the coupler where it pulls."""
        self._readout.content = readout(shown, self._names, self._unit, self._size, force)
        self._plot.stands(shown)

    def traces(self, time: float, shown: ShownPair) -> None:
        """Add an instant of a body that is moved by hand to the plot."""
        self._plot.traces(time, shown)
