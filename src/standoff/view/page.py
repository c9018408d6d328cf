"""The live page of a pair."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from standoff.errors import StandoffError
from standoff.scene import Scene, load_scene
from standoff.view.pair_panel import HANDS
from standoff.view.panel import Panel
from standoff.view.served import ServedPage
from standoff.view.stage import Stage
from standoff.world.shapes import is_solid


class Page(ServedPage):
    """A scene in the browser: played, or a body of it dragged by a handle.

    Raises StandoffError if the pair cannot be tracked; and as `ServedPage`.

    Parameters
    ----------
    scene : Scene
    others : mapping of str to Path, optional
        Scenes that the page can open besides, by title.
    host, port : as for `ServedPage`
    """

    def __init__(
        self,
        scene: Scene,
        *,
        host: str = "127.0.0.1",
        port: int | None = None,
        others: Mapping[str, Path] | None = None,
    ) -> None:
        super().__init__(host=host, port=port)
        self._others = {scene.title: scene.file, **(others or {})}
        with self._opening():
            self.panel = Panel(self.server, self._asked.put, self, tuple(self._others))
            self.stage: Stage = Stage(self.server, self.panel, self._asked.put, scene)

    def hand(self, which: str) -> None:
        """Give the handle to A, to B or to nothing."""
        if which in HANDS:
            self.stage.hand(which)

    def pull(self, on: bool) -> None:
        """Pull the dragged body through the virtual coupler, or carry it."""
        self.stage.pull(on)

    def limit(self, force: float) -> None:
        """Lower the coupler's greatest force [N]; it is never raised."""
        self.stage.limit(force)

    def law(self, name: str, integrator: str, share: float) -> None:
        """Follow another law, with a share of the greatest stable gain."""
        self.stage.law(name, integrator, share)

    def open(self, title: str) -> None:
        """Show another scene; where it cannot be shown, the one there is stays."""
        if title in self._others:
            scene = load_scene(self._others[title])
            if any(is_solid(shape) for shape in scene.pair_shapes):
                raise StandoffError(
                    f"{scene.file.name} is of a solid that need not be convex, which has a page of "
                    "its own: start `standoff view` with it."
                )
            limit = self.stage.max_force
            self.stage = Stage(self.server, self.panel, self._asked.put, scene, limit)

    def export(self, client: Any) -> None:
        """Send the run to a page as a file."""
        from standoff.view.export import page_of

        if self.stage.player is not None and client is not None:
            content = page_of(self.stage.player.recording).encode()
            name = f"{self.stage.scene.file.stem}.html"
            client.send_file_download(name, content, save_immediately=True)
