"""The kinds of file that show a recorded run, and what writes each."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

from standoff.progress import Progress
from standoff.recording import Recording

ENDINGS = (".html", ".mp4", ".gif", ".rrd")

FILMS = (".mp4", ".gif")
"""Those of them that are drawn as pictures, of convex bodies alone."""

RunWriter = Callable[[Recording, BinaryIO], object]
"""Writes a run to a stream."""


def writer_of(path: Path, progress: Progress | None = None) -> RunWriter:
    """Return what writes a run to a file of one of the `ENDINGS`.

    Raises ModuleNotFoundError if a library is missing that it needs; the message names the extra.

    Parameters
    ----------
    path : Path
    progress : callable, optional
        ``progress(done, total)`` is called with the pictures of a film drawn so far, and all.
    """
    match ending := path.suffix.lower():
        case ".html":
            from standoff.view.export import page_of

            return lambda recording, file: file.write(page_of(recording).encode())
        case ".rrd":
            from standoff.view.rerun_log import write_rerun

            return write_rerun
    from standoff.view.video import check_installed, write_video

    check_installed(ending)
    return lambda recording, file: write_video(recording, file, ending, progress=progress)
