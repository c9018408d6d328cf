"""The options of ``standoff soak``: data that tyro fills in and the command reads."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import arg


@dataclass(frozen=True)
class SoakOptions:
    """The options of the command: one for each field, with the field's docstring as its help."""

    pairs: Annotated[int, arg(metavar="N", help_behavior_hint="")] = 1000
    """Pairs in all; 1000 if not given."""
    seed: Annotated[int, arg(metavar="S", help_behavior_hint="")] = 0
    """Seed of the pairs, 0 or more; 0 if not given."""
    frames: Annotated[int, arg(metavar="M", help_behavior_hint="")] = 2000
    """Frames of each pair; 2000 if not given."""
    jobs: Annotated[int | None, arg(metavar="J", help_behavior_hint="")] = None
    """Processes; 2 if not given. With 1 in this process, where a pair that hangs is not noticed."""
    output: Annotated[Path, arg(aliases=["-o"], metavar="DIR", help_behavior_hint="")] = Path(
        "standoff-soak"
    )
    """Folder of the ledger soak.json and of a failure's file; made if it does not exist. If not
    given, standoff-soak."""
    resume: Annotated[bool, arg(help_behavior_hint="")] = False
    """Go on with the soak in DIR, of the same seed and frames."""
    replay: Annotated[Path | None, arg(metavar="FILE", help_behavior_hint="")] = None
    """Only run the pair of a failure's file again."""
    certificates: Annotated[int | None, arg(metavar="N", help_behavior_hint="")] = None
    """Only ask the certificate by itself, in about N cases of known distance, and list every check
    that fails."""
    worlds: Annotated[int | None, arg(metavar="N", help_behavior_hint="")] = None
    """Only worlds of many bodies: N of them, each of M frames, all of whose pairs are judged."""
    json: Annotated[bool, arg(help_behavior_hint="")] = False
    """Print the ledger as JSON."""

    def announcement(self) -> str:
        """What is about to be done."""
        from standoff.cli.announcement import shown

        if self.replay is not None:
            return f"running the pair of {shown(self.replay)} again"
        if self.certificates is not None:
            return f"asking the certificate by itself in {self.certificates:,} cases"
        if self.worlds is not None:
            return f"judging all pairs of {self.worlds:,} worlds, each {self.frames:,} frames"
        return (
            f"tracking and checking random pairs up to {self.pairs:,}, each "
            f"{self.frames:,} frames, into {shown(self.output)}"
        )
