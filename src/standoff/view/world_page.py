"""The live page of a world."""

from __future__ import annotations

from standoff.view.moving_world import MovingWorld
from standoff.view.served import ServedPage
from standoff.view.world_panel import WorldPanel
from standoff.view.world_stage import WorldStage


class WorldPage(ServedPage):
    """A world in the browser: played, or a body of it dragged by a handle.

    Raises StandoffError if the world refuses its poses; and as `ServedPage`.

    Parameters
    ----------
    given : MovingWorld
    host, port : as for `ServedPage`
    """

    def __init__(
        self, given: MovingWorld, *, host: str = "127.0.0.1", port: int | None = None
    ) -> None:
        super().__init__(host=host, port=port)
        with self._opening():
            moving = given.world.moving
            self.panel = WorldPanel(self.server, self._asked.put, self, moving)
            self.stage: WorldStage = WorldStage(self.server, self.panel, self._asked.put, given)

    def hand(self, number: int | None) -> None:
        """Give the handle to one of the moving bodies, by its number among them, or to nothing."""
        self.stage.hand(number)
