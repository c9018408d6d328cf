"""A page in the browser, served: one thread owns all that is shown of it."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from traceback import format_exc
from typing import Any, Protocol, Self

from standoff.errors import StandoffError
from standoff.kernels.compiler.notices import say
from standoff.view.access import Access
from standoff.view.server import guarded_server, stop
from standoff.wording import printable

PERIOD = 0.04
"""Time between two looks at what the pages ask for [s]: a browser that draws without a graphics
card keeps up with it in small windows."""


class Aimed(Protocol):
    """A picture that has a place for cameras."""

    def aim_one(self, client: Any) -> None:
        """Put one page's camera where new ones begin."""

    def aim_again(self, client: Any) -> None:
        """Aim the camera of a narrow page that stands where viser puts it, too near."""


class Staged(Protocol):
    """What a page shows."""

    @property
    def title(self) -> str:
        """A line for the reader."""

    @property
    def picture(self) -> Aimed:
        """What is drawn."""

    def look(self, elapsed: float) -> None:
        """Let a time pass [s], and show what has changed."""

    def play(self, playing: bool) -> None:
        """Play the motion, or pause."""

    def seek(self, time: float) -> None:
        """Show the motion at a time [s]."""

    def speed(self, factor: float) -> None:
        """Play this many times as fast as the motion."""

    def back(self) -> None:
        """Put the bodies back to where they were at first."""


class ServedPage:
    """A page at an address, and the thread that does what is asked of it.

    A subclass makes its panel and stage in `_opening`.

    Raises ModuleNotFoundError if viser is not installed; the message names the extra. Raises
    StandoffError if the port is not available.

    Parameters
    ----------
    host : str
        Name or address to bind to.
    port : int, optional
        If not given, any that is free.

    Attributes
    ----------
    address : str
        To be opened in a browser; it holds the token of this run.
    stage : Staged
        What is shown.
    """

    stage: Staged

    def __init__(self, *, host: str = "127.0.0.1", port: int | None = None) -> None:
        self._asked: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._closing = threading.Event()
        self._told_last = ""
        access = Access(host)
        self.server = guarded_server(access, port)
        self.port: int = self.server.get_port()
        self.address = access.address(self.port)

    @contextmanager
    def _opening(self) -> Iterator[None]:
        """Show the stage that is made within, and do from then on what is asked."""
        try:
            yield
        except BaseException:
            stop(self.server)
            raise
        self.server.on_client_connect(self.stage_seen)
        self._thread = threading.Thread(target=self._work, name="standoff-page", daemon=True)
        self._thread.start()

    def play(self, playing: bool) -> None:
        """Play the motion, or pause."""
        self.stage.play(playing)

    def seek(self, time: float) -> None:
        """Show the motion at a time [s]."""
        self.stage.seek(time)

    def speed(self, factor: float) -> None:
        """Play this many times as fast as the motion."""
        self.stage.speed(factor)

    def back(self) -> None:
        """Put the bodies back to where the scene has them."""
        self.stage.back()

    def close(self) -> None:
        """Close the port; the page says that it is disconnected."""
        self._closing.set()
        self._thread.join()
        stop(self.server)

    def wait(self) -> None:
        """Return when the page is closed, as by an interrupt."""
        self._closing.wait()

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {self.stage.title!r} at {self.address}>"

    def _repr_html_(self) -> str:
        frame = 'width="100%" height="600" style="border:0"'
        return f'<iframe src="{self.address}" {frame}></iframe>'

    def __enter__(self) -> Self:
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
