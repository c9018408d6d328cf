"""The command ``standoff paper``, as tyro reads it: options and what to do with them."""

from __future__ import annotations

from dataclasses import dataclass

from standoff_studies.paper.options import PaperOptions


@dataclass(frozen=True)
class PaperCommand(PaperOptions):
    """Make the figures of the paper, their data, and a report that sets it beside the measured.

    Exit codes: 0 done, 1 files could not be written, 2 bad input, 3 finished, but a figure failed.
    """

    def run(self) -> int:
        """Do it; see `standoff_studies.paper.command.run_paper`."""
        from standoff_studies.paper.command import run_paper

        return run_paper(self)
