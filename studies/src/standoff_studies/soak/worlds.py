"""``standoff soak --worlds N``: drawn worlds, every pair of every frame judged."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from standoff.cli.errors import CommandError, ExitCode
from standoff.cli.facts import json_text
from standoff.cli.output import make_folder, write_whole
from standoff.cli.terminal import tell
from standoff_studies.soak.failures import world_facts
from standoff_studies.soak.reading import written
from standoff_studies.soak.tally import Tally
from standoff_studies.soak.world_checks import run_world

FAILURE = "world-{}.json"
"""The first world that fails."""


def run_worlds(worlds: int, seed: int, frames: int, folder: Path, as_json: bool) -> int:
    """Run a number of worlds up to the first that fails, and print the counts.

    Raises
    ------
    CommandError
        If the number or the folder cannot be used.
    """
    if worlds < 1:
        raise CommandError(f"--worlds {worlds}: give 1 or more")
    make_folder(folder, "-o")
    tally, file = Tally(), None
    started = time.perf_counter()
    for number in range(worlds):
        counted, faults = run_world(seed, number, frames)
        tally.add(counted)
        if faults:
            file = folder / FAILURE.format(number)
            write_whole({file: written(world_facts(seed, number, frames, faults))})
            break
    seconds = time.perf_counter() - started
    if as_json:
        facts: dict[str, Any] = {"seed": seed, "frames": frames, **tally.facts()}
        tell(json_text(facts | {"failure": None if file is None else str(file)}))
    else:
        pair_frames = tally.sums["pair-frames"]
        tell(f"seed {seed}: {pair_frames:,} pair-frames of worlds in {seconds:.1f} s")
        for line in tally.lines():
            tell(line)
    if file is None:
        return ExitCode.DONE
    first = faults[0]
    tell(
        f"standoff: world {number} failed at frame {first.frame}: {first.what} ({first.value:.6g} "
        f"where {first.allowed:.3g} is allowed); {file} reproduces it",
        error=True,
    )
    return ExitCode.FAILED
