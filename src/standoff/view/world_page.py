"""The live page of a world."""

from __future__ import annotations

from standoff.view.moving_world import MovingWorld
from standoff.view.served import ServedPage
from standoff.view.server import stop
from standoff.view.world_panel import WorldPanel
from standoff.view.world_stage import WorldStage


class WorldPage(ServedPage):
    """A world in the browser: played, or a body of it dragged by a handle.

    Parameters
    ----------
    given : MovingWorld
    host : str
        Name or address to bind to.
    port : int, optional
        If not given, any that is free.

    Attributes
    ----------
    address : str
        To be opened in a browser; it holds the token of this run.
    stage : WorldStage
        What is shown.

    Raises
    ------
    ModuleNotFoundError
        If viser is not installed; the message names the extra.
    StandoffError
        If the port is not available, or the world refuses its poses.
    """

    def __init__(
        self, given: MovingWorld, *, host: str = "127.0.0.1", port: int | None = None
    ) -> None:
        super().__init__(host=host, port=port)
        try:
            moving = given.world.moving
            self.panel = WorldPanel(self.server, self._asked.put, self, moving)
            self.stage: WorldStage = WorldStage(self.server, self.panel, self._asked.put, given)
        except BaseException:
            stop(self.server)
            raise
        self._begin()

    def hand(self, number: int | None) -> None:
        """Give the handle to one of the moving bodies, by its number among them, or to nothing."""
        self.stage.hand(number)
