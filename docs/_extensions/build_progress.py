"""How far the build has come: a line where Sphinx, which is asked to be quiet, says nothing.

Sphinx deals the pages out to processes, and tells this one when a part of them has come back.
"""

from __future__ import annotations

from typing import Any

from sphinx.application import Sphinx

from standoff.kernels.compiler.notices import say


class Told:
    """Counts the pages that have been read."""

    def __init__(self) -> None:
        self.total = self.read = 0

    def begin(self, _app: Sphinx, _env: Any, pages: list[str]) -> None:
        """Sphinx knows which pages have changed."""
        self.total = len(pages)
        if pages:
            say(f"docs: reading {self.total} pages and making the paper's figures ...")

    def merge(self, _app: Sphinx, _env: Any, pages: list[str], _other: Any) -> None:
        """A process has read some of them."""
        self.read += len(pages)
        say(f"docs: {self.read} of {self.total} pages read ...")

    def write(self, _app: Sphinx, _env: Any) -> None:
        """All are read."""
        say("docs: writing the pages ...")

    def end(self, app: Sphinx, error: Exception | None) -> None:
        """The last word."""
        if error is None:
            say(f"docs: the pages are in {app.outdir}")


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect to what Sphinx tells the process that was started."""
    told = Told()
    app.connect("env-before-read-docs", told.begin)
    app.connect("env-merge-info", told.merge)
    app.connect("env-check-consistency", told.write)
    app.connect("build-finished", told.end)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
