"""How far a run has come, shown where somebody can see it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import Progress as Bar

from standoff.paper.figure import Entry
from standoff.tracking.simulate import Progress

Tell = Callable[[Entry, object], None]
"""Is told of a figure that is begun (None) or done."""


@contextmanager
def progress_bar() -> Iterator[Progress | None]:
    """Show a progress bar on stderr where that is a terminal."""
    if not sys.stderr.isatty():
        yield None
        return
    with Bar(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("starting", total=None)

        def show(done: int, total: int) -> None:
            bar.update(task, completed=done, total=total, description="tracking")

        yield show


@contextmanager
def figures_bar(total: int) -> Iterator[Tell]:
    """Show which figures are being made, and how many are done, where stderr is a terminal."""
    if not sys.stderr.isatty():
        yield lambda entry, result: None
        return
    with Bar(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("starting", total=total)
        begun: dict[str, None] = {}

        def show(entry: Entry, result: object) -> None:
            if result is None:
                begun[entry.key] = None
            else:
                begun.pop(entry.key, None)
                bar.advance(task)
            bar.update(task, description=f"making {' and '.join(begun)}" if begun else "writing")

        yield show


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
