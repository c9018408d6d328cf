"""Making figures one by one, each written separately, and the results."""

from __future__ import annotations

import time
import traceback
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from standoff.whole_files import write_whole
from standoff_studies.paper.catalogue import make
from standoff_studies.paper.figure import Entry, Statement, shown_tables
from standoff_studies.paper.writers import ANIMATION, files_of


@dataclass(frozen=True)
class Made:
    """A figure that was made, or that failed.

    Attributes
    ----------
    entry : Entry
    seconds : float
        Time that it took, including the run of its chapter if it was the first to need it [s].
    caption, text, animation_text : str
        As in its Artwork.
    statements : tuple of Statement
    shown : mapping of str to mapping of str to list of str
        The tables that are printed in full: name, then heading and column, as text.
    files : tuple of Path
        The files written.
    error : str
        Why it failed; empty if it did not.
    unwritten : bool
        It failed because its files could not be written.
    """

    entry: Entry
    seconds: float
    caption: str = ""
    text: str = ""
    animation_text: str = ""
    statements: tuple[Statement, ...] = ()
    shown: Mapping[str, Mapping[str, list[str]]] = field(default_factory=dict)
    files: tuple[Path, ...] = ()
    error: str = ""
    unwritten: bool = False

    def file(self, ending: str) -> Path | None:
        """Return the written file with an extension, if there is one."""
        return next((path for path in self.files if path.suffix == ending), None)


def make_and_write(entry: Entry, folder: Path, animations: bool) -> Made:
    """Make a figure and write its files; the result says if something went wrong."""
    started = time.perf_counter()
    try:
        artwork = make(entry)
        files = files_of(entry, artwork, folder, animations)
    except Exception as error:
        return Made(entry, time.perf_counter() - started, error=told(error))
    try:
        write_whole(files)
    except OSError as error:
        reason = f"could not be written: {error}"
        return Made(entry, time.perf_counter() - started, error=reason, unwritten=True)
    moving = artwork.animation is not None and any(p.suffix == ANIMATION for p in files)
    return Made(
        entry,
        time.perf_counter() - started,
        artwork.caption,
        artwork.text,
        artwork.animation.text if moving and artwork.animation is not None else "",
        tuple(plain(statement) for statement in artwork.statements),
        shown_tables(artwork),
        tuple(files),
    )


def told(error: Exception) -> str:
    """Return an exception in one line, with the place where it was raised."""
    frames = traceback.extract_tb(error.__traceback__)
    where = f" ({Path(frames[-1].filename).name}, line {frames[-1].lineno})" if frames else ""
    return f"{type(error).__name__}: {' '.join(str(error).split())}{where}"


def plain(statement: Statement) -> Statement:
    """Return a statement whose verdict is Python's own True, False or None."""
    return statement._replace(holds=None if statement.holds is None else bool(statement.holds))
