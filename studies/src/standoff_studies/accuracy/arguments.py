"""The command ``standoff accuracy``, as tyro reads it: fields are options, their sentences help."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg


@dataclass(frozen=True)
class AccuracyCommand:
    """Measure the errors of the answers, by pair of shapes.

    The pairs are exact by construction, at gaps of 1e-6, 1e-3 and 1 and depths of 1e-6, 1e-3 and
    1e-1 of their size.

    Exit codes: 0 done, 1 files could not be written, 2 bad input, 3 finished, but an answer is
    wrong or missing.
    """

    shapes: Annotated[
        Positional[tuple[str, ...]], arg(metavar="[SHAPE ...]", help_behavior_hint="")
    ] = ()
    """Only pairs of these, such as sphere 'rounded box'; all if none is given."""
    output: Annotated[Path | None, arg(aliases=["-o"], metavar="DIR", help_behavior_hint="")] = None
    """Write accuracy.parquet (a row a case and engine), accuracy.md, gaps.md and depths.md (tables)
    and accuracy.png to this folder; made if it does not exist."""
    cases: Annotated[int, arg(metavar="N", help_behavior_hint="")] = 10
    """Cases of each pair at each gap and depth; 10 if not given."""
    seed: Annotated[int, arg(metavar="S", help_behavior_hint="")] = 0
    """Seed of all draws; 0 if not given. A pair's cases do not depend on the other pairs."""
    peers: Annotated[bool, arg(help_behavior_hint="")] = False
    """Ask Coal, MuJoCo, python-fcl and OpenCASCADE too: the extra 'peers'."""
    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print the summary as JSON."""

    def announcement(self) -> str:
        """What is about to be done."""
        from standoff.cli.announcement import shown

        shapes = f"pairs of {shown(', '.join(self.shapes))}" if self.shapes else "all pairs"
        return f"measuring the errors of {shapes}, {self.cases} cases at each gap and depth"

    def run(self) -> int:
        """Do it; see `standoff_studies.accuracy.command.run_accuracy`."""
        from standoff_studies.accuracy.command import run_accuracy

        return run_accuracy(self)
