"""The command ``standoff accuracy``, as tyro reads it: options and what to do with them."""

from __future__ import annotations

from dataclasses import dataclass

from standoff_studies.accuracy.options import AccuracyOptions


@dataclass(frozen=True)
class AccuracyCommand(AccuracyOptions):
    """Measure the errors of the answers, by pair of shapes.

    The pairs are exact by construction, at gaps of 1e-6, 1e-3 and 1 and depths of 1e-6, 1e-3 and
    1e-1 of their size.

    Exit codes: 0 done; 1 files could not be written; 2 bad input; 3 finished, but an answer is
    wrong or missing.
    """

    def run(self) -> int:
        """Run it; see `standoff_studies.accuracy.command.run_accuracy`."""
        from standoff_studies.accuracy.command import run_accuracy

        return run_accuracy(self)
