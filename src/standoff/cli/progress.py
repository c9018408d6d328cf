"""How far a command has come: a bar in a terminal, elsewhere a line now and then."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import Progress as Bar

from standoff.kernels.compiler.notices import alive
from standoff.progress import Progress

Show = Callable[[int, int, str], None]
"""Called with how many are done, of how many, and what is being done."""


@contextmanager
def progress_shown(doing: str = "starting") -> Iterator[Show]:
    """Show on stderr what is being done: a bar, or where it is no terminal a line every 10 s."""
    if sys.stderr.isatty():
        # A stdout that is not a terminal is left alone: the bar would capture its lines.
        console, both = Console(stderr=True), sys.stdout.isatty()
        with Bar(console=console, transient=True, redirect_stdout=both) as bar:
            task = bar.add_task(doing, total=None)
            yield lambda done, total, doing: bar.update(
                task, completed=done, total=total, description=doing
            )
        return
    latest, started = doing, time.monotonic()

    def note(done: int, total: int, doing: str) -> None:
        nonlocal latest
        latest = f"{doing}: {done} of {total} done"

    with alive(lambda: f"{latest}, {time.monotonic() - started:.0f} s so far ..."):
        yield note


@contextmanager
def progress_bar(doing: str = "tracking") -> Iterator[Progress]:
    """`progress_shown` for a single task."""
    with progress_shown(doing) as show:
        yield lambda done, total: show(done, total, doing)
