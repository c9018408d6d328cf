"""The live page of a pair of solids."""

from __future__ import annotations

from standoff.scene import Scene
from standoff.view.minima_asked import MinimaAsked
from standoff.view.pair_panel import HANDS
from standoff.view.served import ServedPage
from standoff.view.solid_panel import SolidPanel
from standoff.view.solid_stage import SolidStage


class SolidPage(ServedPage):
    """A pair of solids in the browser, with all its minima: played, or dragged by a handle.

    Raises StandoffError if the pair cannot be tracked; and as `ServedPage`.

    Parameters
    ----------
    scene : Scene
    asked : MinimaAsked
    host, port : as for `ServedPage`
    """

    def __init__(
        self,
        scene: Scene,
        asked: MinimaAsked | None = None,
        *,
        host: str = "127.0.0.1",
        port: int | None = None,
    ) -> None:
        super().__init__(host=host, port=port)
        with self._opening():
            self.panel = SolidPanel(self.server, self._asked.put, self)
            asked = asked or MinimaAsked()
            self.stage: SolidStage = SolidStage(
                self.server, self.panel, self._asked.put, scene, asked
            )

    def hand(self, which: str) -> None:
        """Give the handle to A, to B or to nothing."""
        if which in HANDS:
            self.stage.hand(which)

    def glass(self, on: bool) -> None:
        """Show both as if of glass, or only where they overlap."""
        self.stage.glass(on)
