"""How far a run has come, shown where somebody can see it."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import Progress as Bar

from standoff.recording.simulate import Progress


@contextmanager
def progress_bar(doing: str = "tracking") -> Iterator[Progress | None]:
    """Show a progress bar on stderr where that is a terminal; `doing` stands before it."""
    if not sys.stderr.isatty():
        yield None
        return
    with Bar(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("starting", total=None)

        def show(done: int, total: int) -> None:
            bar.update(task, completed=done, total=total, description=doing)

        yield show
