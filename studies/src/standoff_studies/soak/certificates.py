"""``standoff soak --certificates N``: only the adversary, which lists every failed check."""

from __future__ import annotations

import time
from collections import Counter
from pathlib import Path
from typing import Any

from standoff.cli.errors import CommandError, ExitCode
from standoff.cli.facts import json_text
from standoff.cli.output import make_folder, write_whole
from standoff.cli.terminal import tell
from standoff_studies.soak.adversary import Breach, run_round
from standoff_studies.soak.failures import breach_facts
from standoff_studies.soak.reading import written
from standoff_studies.soak.tally import Tally

PER_ROUND = 1000
"""Cases of a round: more than in a soak, because nothing else is done."""

FAILURE = "breach-{}.json"
"""The worst case of each check that failed."""


def run_certificates(cases: int, seed: int, folder: Path, as_json: bool) -> int:
    """Run rounds of the adversary up to a number of cases, and print what they found.

    Raises
    ------
    CommandError
        If the number or the folder cannot be used.
    """
    if cases < 1:
        raise CommandError(f"--certificates {cases}: give 1 or more")
    make_folder(folder, "-o")
    tally, failed, worst = Tally(), Counter[str](), dict[str, Breach]()
    started = time.perf_counter()
    for number in range(-(-cases // PER_ROUND)):
        counted, breaches = run_round(seed, number, PER_ROUND)
        tally.add(counted)
        for breach in breaches:
            what = breach.miss.what
            failed[what] += 1
            if what not in worst or _beyond(breach) > _beyond(worst[what]):
                worst[what] = breach
    files = _write(worst, folder)
    if as_json:
        facts: dict[str, Any] = {"seed": seed, **tally.facts(), "failed": dict(failed)}
        tell(json_text(facts | {"files": {what: str(file) for what, file in files.items()}}))
    else:
        _print(tally, seed, time.perf_counter() - started)
    for what, rounds in failed.most_common():
        miss = worst[what].miss
        tell(
            f"standoff: {what}: in {rounds} rounds, at worst {miss.value:.6g} where "
            f"{miss.allowed:.3g} is allowed; {files[what]} reproduces it",
            error=True,
        )
    return ExitCode.FAILED if failed else ExitCode.DONE


def _beyond(breach: Breach) -> float:
    """The value as a multiple of what is allowed; sizes of bodies differ by 1e12."""
    _, _, value, allowed = breach.miss
    return value / allowed if value == value and allowed > 0.0 else float("inf")


def _write(worst: dict[str, Breach], folder: Path) -> dict[str, Path]:
    """Write a file for the worst case of each check."""
    files = {}
    for k, (what, breach) in enumerate(sorted(worst.items())):
        files[what] = folder / FAILURE.format(k)
        write_whole({files[what]: written(breach_facts(breach))})
    return files


def _print(tally: Tally, seed: int, seconds: float) -> None:
    tell(f"seed {seed}: {tally.sums['certificates']:,} certificates in {seconds:.1f} s")
    for line in tally.lines():
        tell(line)
