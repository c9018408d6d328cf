"""Progress of ``standoff paper``, shown if somebody can see it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from standoff.cli.progress import progress_shown
from standoff_studies.paper.figure import Entry

Tell = Callable[[Entry, object], None]
"""Called when a figure is begun (with None) or done."""


@contextmanager
def figures_bar(total: int) -> Iterator[Tell]:
    """Show which figures are being made, and how many are done."""
    begun: dict[str, None] = {}
    done = 0
    with progress_shown() as show:

        def tell(entry: Entry, result: object) -> None:
            nonlocal done
            if result is None:
                begun[entry.key] = None
            else:
                begun.pop(entry.key, None)
                done += 1
            figures = "figures" if len(begun) > 1 else "figure"
            show(done, total, f"making {figures} {' and '.join(begun)}" if begun else "writing")

        yield tell
