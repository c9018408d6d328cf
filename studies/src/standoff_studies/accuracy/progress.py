"""How far ``standoff accuracy`` has come, shown where somebody can see it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import Progress as Bar


@contextmanager
def pairs_bar(total: int) -> Iterator[Callable[[str], None]]:
    """Show which pair of shapes is being measured, where stderr is a terminal."""
    if not sys.stderr.isatty():
        yield lambda pair: None
        return
    with Bar(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("starting", total=total)

        def show(pair: str) -> None:
            bar.update(task, description=pair)
            bar.advance(task)

        yield show
