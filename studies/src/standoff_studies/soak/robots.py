"""``python -m standoff_studies.soak.robots``: robots' files that are damaged, and proofs of paths.

See `robot_files` and `robot_paths`. The exit code is 1 if anything is wrong.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections import Counter
from pathlib import Path

from standoff.cli.terminal import tell
from standoff_studies.soak import robot_files, robot_paths

TELL = 30.0
"""Seconds between two lines."""


class Tally:
    """Counts what came of cases, and tells what is wrong and how far they are."""

    def __init__(self, what: str, count: int) -> None:
        self.what, self.count = what, count
        self.counts: Counter[str] = Counter()
        self.wrong = 0
        self._told = time.monotonic()

    def add(self, number: int, became: str, wrong: str) -> None:
        self.counts[became] += 1
        if wrong:
            self.wrong += 1
            tell(f"{self.what} {number}: {wrong}")
        if time.monotonic() - self._told > TELL:
            self._told = time.monotonic()
            tell(self.line())

    def line(self) -> str:
        told = ", ".join(f"{n} {became}" for became, n in sorted(self.counts.items()))
        return f"{self.counts.total()} of {self.count} {self.what}s: {told}; {self.wrong} wrong"


def proofs(count: int, seed: int) -> Tally:
    """Hold so many proofs against samples."""
    tally, number = Tally("proof", count), 0
    while tally.counts.total() < count:
        for case in robot_paths.cases_of(seed, number):
            what = f"{case.package}, {', '.join(case.kinds)}, {case.path}: {case.wrong}"
            tally.add(number, case.verdict, what if case.wrong else "")
        number += 1
    return tally


def files(count: int, seed: int) -> Tally:
    """Read so many damaged files."""
    tally = Tally("file", count)
    with tempfile.TemporaryDirectory() as folder:
        for number in range(count):
            found = robot_files.case_of(seed, number, Path(folder))
            what = f"{found.kind}, {found.damage}: {found.wrong}"
            tally.add(number, f"{found.kind} {found.became}", what if found.wrong else "")
    return tally


def main() -> int:
    """Run the command."""
    parser = argparse.ArgumentParser(prog="python -m standoff_studies.soak.robots")
    parser.add_argument("--proofs", type=int, default=10_000, help="proofs along paths")
    parser.add_argument("--files", type=int, default=2_000, help="damaged files")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    tallies = files(given.files, given.seed), proofs(given.proofs, given.seed)
    for tally in tallies:
        tell(tally.line())
    return int(any(tally.wrong for tally in tallies))


if __name__ == "__main__":
    raise SystemExit(main())
