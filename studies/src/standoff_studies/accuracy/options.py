"""The options of ``standoff accuracy``: data that tyro fills in and the command reads."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg


@dataclass(frozen=True)
class AccuracyOptions:
    """The options of the command: one for each field, with the field's docstring as its help."""

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
