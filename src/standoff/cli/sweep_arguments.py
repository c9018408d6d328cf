"""The command of sweeps and its options, as tyro reads them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg


@dataclass(frozen=True)
class SweepCommand:
    """Find the distances of a pair, a world or a robot at very many poses, kept as totals.

    Stopped at any moment, the same command goes on where it was.

    Example: standoff sweep examples/sweep.toml -o swept --workers 2

    Exit codes: 0 done, 1 results could not be written, 2 bad input, 3 a row is not proven to be as
    far apart as the job asks, or an answer is not certified.
    """

    job: Annotated[Positional[Path], arg(metavar="JOB.toml")]
    """What is swept; docs/sweep.md describes the format."""
    output: Annotated[Path | None, arg(aliases=["-o"], metavar="FOLDER", help_behavior_hint="")] = (
        None
    )
    """Folder for shards and report, new or of the same job."""
    workers: Annotated[int, arg(metavar="NUMBER", help_behavior_hint="")] = 1
    """Processes that share the shards; 1 if not given. The files are the same for any number."""
    cluster: Annotated[str | None, arg(metavar="ADDRESS", help_behavior_hint="")] = None
    """Share the shards on a cluster of Dask instead; the address of its scheduler."""
    estimate: Annotated[bool, arg(help_behavior_hint="")] = False
    """Try some thousand rows, tell what all will take, and write nothing."""
    row: Annotated[int | None, arg(metavar="NUMBER", help_behavior_hint="")] = None
    """Compute this row alone, and print all of it; the first is 0."""
    prove: Annotated[str | None, arg(metavar="clearance=LENGTH", help_behavior_hint="")] = None
    """Prove that the bodies keep this clearance at all parameters in their ranges, cell by cell."""
    plot: Annotated[Path | None, arg(metavar="OUT.png", help_behavior_hint="")] = None
    """Draw the histogram, or with --row both bodies and the answer (.png, .svg or .pdf)."""
    page: Annotated[Path | None, arg(metavar="OUT.html", help_behavior_hint="")] = None
    """Write a page with totals, histogram and the worst rows drawn, which needs no other file."""
    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print what was found as JSON."""
