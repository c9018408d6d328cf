"""The command ``standoff soak``, as tyro reads it: options and what to do with them."""

from __future__ import annotations

from dataclasses import dataclass

from standoff_studies.soak.options import SoakOptions


@dataclass(frozen=True)
class SoakCommand(SoakOptions):
    """Track random pairs and check every answer.

    The checks use support functions; it stops at the first failure.

    Exit codes: 0 done; 1 files could not be written; 2 bad input; 3 a check failed.
    """

    def run(self) -> int:
        """Run it; see `standoff_studies.soak.command.run_soak`."""
        from standoff_studies.soak.command import run_soak

        return run_soak(self)
