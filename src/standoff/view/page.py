"""The live page: one thread owns the pair and all that is shown of it."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from traceback import format_exc
from typing import Any

from standoff.errors import StandoffError
from standoff.kernels.compiler.notices import say
from standoff.scene import Scene, load_scene
from standoff.view.access import Access
from standoff.view.panel import HANDS, Panel
from standoff.view.server import guarded_server, stop
from standoff.view.stage import Stage
from standoff.wording import printable

PERIOD = 0.04
"""Time between two looks at what the pages ask for [s]: a browser that draws without a graphics
card keeps up with it in small windows."""


class Page:
    """A scene in the browser: played, or a body of it dragged by a handle.

    Parameters
    ----------
    scene : Scene
    host : str
        Name or address to bind to.
    port : int, optional
        If not given, any that is free.
    others : mapping of str to Path, optional
        Scenes that the page can open besides, by title.

    Attributes
    ----------
    address : str
        To be opened in a browser; it holds the token of this run.
    stage : Stage
        What is shown.

    Raises
    ------
    ModuleNotFoundError
        If viser is not installed; the message names the extra.
    StandoffError
        If the port is not available, or the pair cannot be tracked.
    """

    def __init__(
        self,
        scene: Scene,
        *,
        host: str = "127.0.0.1",
        port: int | None = None,
        others: Mapping[str, Path] | None = None,
    ) -> None:
        self._asked: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._closing = threading.Event()
        self._told_last = ""
        self._others = {scene.title: scene.file, **(others or {})}
        access = Access(host)
        self.server = guarded_server(access, port)
        self.port: int = self.server.get_port()
        self.address = access.address(self.port)
        try:
            self.panel = Panel(self.server, self._asked.put, self, tuple(self._others))
            self.stage = Stage(self.server, self.panel, self._asked.put, scene)
        except BaseException:
            stop(self.server)
            raise
        self.server.on_client_connect(self.stage_seen)
        self._thread = threading.Thread(target=self._work, name="standoff-page", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Close the port; the page says that it is disconnected."""
        self._closing.set()
        self._thread.join()
        stop(self.server)

    def wait(self) -> None:
        """Return when the page is closed, as by an interrupt."""
        self._closing.wait()

    def __repr__(self) -> str:
        return f"<Page of {self.stage.scene.title!r} at {self.address}>"

    def _repr_html_(self) -> str:
        frame = 'width="100%" height="600" style="border:0"'
        return f'<iframe src="{self.address}" {frame}></iframe>'

    def __enter__(self) -> Page:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    async def stage_seen(self, client: Any) -> None:
        """Aim the camera of a page that has just been opened."""
        self.stage.picture.aim_one(client)

        # What all pages begin with may reach this one later, and undo it.
        @client.camera.on_update
        async def _(_: Any) -> None:
            self.stage.picture.aim_again(client)

    def play(self, playing: bool) -> None:
        """Play the motion, or pause."""
        self.stage.play(playing)

    def seek(self, time: float) -> None:
        """Show the motion at a time [s]."""
        self.stage.seek(time)

    def speed(self, factor: float) -> None:
        """Play this many times as fast as the motion."""
        self.stage.speed(factor)

    def hand(self, which: str) -> None:
        """Give the handle to A, to B or to nothing."""
        if which in HANDS:
            self.stage.hand(which)

    def back(self) -> None:
        """Put the bodies back to where the scene has them."""
        self.stage.back()

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
            limit = self.stage.max_force
            self.stage = Stage(self.server, self.panel, self._asked.put, scene, limit)

    def export(self, client: Any) -> None:
        """Send the run to a page as a file."""
        from standoff.view.export import page_of

        if self.stage.player is not None and client is not None:
            content = page_of(self.stage.player.recording).encode()
            name = f"{self.stage.scene.file.stem}.html"
            client.send_file_download(name, content, save_immediately=True)

    def _work(self) -> None:
        try:
            self._serve()
        finally:
            self._closing.set()  # whoever waits for the page is told, whatever ended it

    def _serve(self) -> None:
        last = time.monotonic()
        while not self._closing.wait(max(0.0, last + PERIOD - time.monotonic())):
            now = time.monotonic()
            self._attempt(lambda elapsed=now - last: self.stage.look(elapsed))  # type: ignore[misc]
            while not self._asked.empty():
                self._attempt(self._asked.get())
            last = now

    def _attempt(self, task: Callable[[], None]) -> None:
        """Do something that a page asked for; what cannot be done is told there."""
        try:
            task()
        except (StandoffError, OSError) as error:
            self._notify(str(error))
        except Exception as error:
            # A fault of ours, or a message that nobody thought of: one page must not end the thread
            # that all pages live by.
            told = printable(format_exc().rstrip(), keep="\n")
            if told != self._told_last:  # the same at every look is said once
                say(f"the page goes on after a fault:\n{told}")
            self._told_last = told
            self._notify(f"an unexpected fault, told where the page was started: {error!r}")

    def _notify(self, text: str) -> None:
        for client in self.server.get_clients().values():
            with suppress(Exception):  # one that has just gone
                client.add_notification("Not done", text, auto_close_seconds=10.0, color="red")
