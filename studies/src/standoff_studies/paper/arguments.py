"""The command ``standoff paper``, as tyro reads it: options and what to do with them."""

from __future__ import annotations

from dataclasses import dataclass

from standoff_studies.paper.options import PaperOptions


@dataclass(frozen=True)
class PaperCommand(PaperOptions):
    """Make the paper's figures, their data, and a report.

    Exit codes: 0 done; 1 files could not be written; 2 bad input; 3 finished, but a figure failed.
    """

    def run(self) -> int:
        """Run it; see `standoff_studies.paper.command.run_paper`."""
        from standoff_studies.paper.command import run_paper

        return run_paper(self)
