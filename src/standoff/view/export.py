"""A recorded run as one page that opens without a server."""

from __future__ import annotations

import asyncio
import contextlib
import threading
from pathlib import Path
from typing import Any

import numpy as np

from standoff.errors import StandoffError
from standoff.recording import Recording
from standoff.view.picture import Picture
from standoff.view.server import VISERS, made_by, viser
from standoff.view.shown import of_frame, what_moved
from standoff.whole_files import file_name, write_whole

PICTURES_A_SECOND = 30
"""Of a saved run, as far as `MOST_PICTURES` allow: a film has 24."""

MOST_PICTURES = 900
"""Of a saved run: each is some 500 bytes of the file before it is compressed."""

POLICY = (
    '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; script-src '
    "'unsafe-inline' 'unsafe-eval' blob:; worker-src blob:; style-src 'unsafe-inline'; "
    'img-src data: blob:; font-src data:; connect-src data: blob:">'
)
"""In the page itself: it loads nothing."""


class _Unheard(VISERS):  # type: ignore[misc]
    """Viser's server of messages without a port: what is sent is only recorded."""

    def _background_worker(self, ready_sem: threading.Semaphore) -> None:
        loop = asyncio.new_event_loop()
        asyncio.set_event_loop(loop)
        self._background_event_loop = loop
        self._stop_event = asyncio.Event()
        self._broadcast_buffer = viser.infra._async_message_buffer.AsyncMessageBuffer(
            loop, persistent_messages=True
        )
        ready_sem.release()
        loop.run_until_complete(self._stop_event.wait())
        loop.close()


def page_of(recording: Recording) -> str:
    """Return a run as a page of HTML that holds all it needs, with play, pause and speed.

    Raises StandoffError if the recording has no bodies or paths.

    Parameters
    ----------
    recording : Recording
        As `so.track` returned it: one from a file does not hold what moved.

    Returns
    -------
    str
    """
    what_moved(recording)
    with made_by(_Unheard):
        server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    try:
        html = _recorded(server, recording)
    finally:
        with contextlib.suppress(RuntimeError):
            server.stop()
    title = recording.info.title or "Standoff"
    return _titled(html, title)


def save_page(recording: Recording, path: str | Path) -> None:
    """Write a run as a page that opens without a server, whole or not at all.

    Raises StandoffError as `page_of`; if the file has another ending. Raises OSError if the file
    cannot be written.

    Parameters
    ----------
    recording : Recording
    path : str or path
        An .html file.
    """
    target = file_name(path)
    if target.suffix.lower() not in (".html", ".htm"):
        raise StandoffError(
            f"{target}: the ending '{target.suffix}' is not known here; name an .html file",
            "path",
            path,
        )
    content = page_of(recording).encode()
    write_whole({target: lambda file: file.write(content)})


def chosen_frames(time: Any) -> Any:
    """Return the numbers of the frames that are shown, evenly over the time."""
    duration = float(time[-1] - time[0])
    count = int(np.clip(duration * PICTURES_A_SECOND, 2, MOST_PICTURES))
    at = np.linspace(time[0], time[-1], min(count, len(time)))
    return np.unique(np.searchsorted(time, at, side="right") - 1)


def _recorded(server: Any, recording: Recording) -> str:
    assert recording.pair is not None
    picture = Picture(server, recording.pair, recording.info.length_unit, handles=False)
    frames = chosen_frames(recording.time).tolist()
    first = of_frame(recording, frames[0])
    picture.aim(first.poses)
    serializer = server.get_scene_serializer()
    for number, frame in enumerate(frames):
        picture.show(of_frame(recording, frame), f"{recording.time[frame]:.2f} s: ")
        until = recording.time[frames[number + 1]] if number + 1 < len(frames) else None
        if until is not None:
            serializer.insert_sleep(float(until - recording.time[frame]))
    found: str = serializer.as_html()
    return found


def _titled(html: str, title: str) -> str:
    from html import escape

    head, body = html.split("<head>", 1)
    named = body.replace("<title>Viser</title>", f"<title>{escape(title)}</title>", 1)
    return f"{head}<head>{POLICY}{named}"
