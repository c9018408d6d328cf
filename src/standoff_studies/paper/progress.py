"""How far ``standoff paper`` has come, shown where somebody can see it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import Progress as Bar

from standoff_studies.paper.figure import Entry

Tell = Callable[[Entry, object], None]
"""Is told of a figure that is begun (None) or done."""


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
