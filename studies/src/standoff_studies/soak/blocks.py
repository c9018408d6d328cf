"""Runs of numbered blocks of work, cut off by time, gone on with from any block."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, fields
from multiprocessing import get_context
from typing import Any, ClassVar, Self

from standoff.cli.terminal import tell

TELL = 30.0
"""Seconds between two lines."""
TOLD = 40
"""Faults that are told in full."""


Work = Callable[[int], tuple[Any, list[str]]]


@dataclass(frozen=True)
class Counted:
    """A verdict in counts, none of which a subclass names among its `FAULTS` may be above 0."""

    FAULTS: ClassVar[tuple[str, ...]] = ("wrong",)

    @property
    def sound(self) -> bool:
        return not any(getattr(self, name) for name in self.FAULTS)

    def plus(self, other: Self) -> Self:
        """Two verdicts as one, count by count."""
        names = [each.name for each in fields(self)]
        return type(self)(**{name: getattr(self, name) + getattr(other, name) for name in names})


def options(description: str | None, noun: str, count: int, size: int) -> argparse.ArgumentParser:
    """The options that all runs have, of blocks of `size`."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument(f"--{noun}", type=int, default=count, dest="count")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help=f"the first block of {size:,}")
    parser.add_argument("--minutes", type=float, default=float("inf"))
    parser.add_argument("--workers", type=int, default=1)
    return parser


def run(given: argparse.Namespace, size: int, work: Work) -> Any:
    """The sum of all blocks, each by `work` of its number, in one process or several; None if there
    was time for none. Tells what was counted so far, and the faults; at last the blocks done."""
    begun = told = time.monotonic()
    last, faults, total = given.first - (-given.count // size), 0, None
    number = given.first
    for verdict, lines in _results(given, last, work, begun + 60.0 * given.minutes):
        number += 1
        total = verdict if total is None else total.plus(verdict)
        for line in lines[: max(TOLD - faults, 0)]:
            tell(line)
        faults += len(lines)
        if time.monotonic() - told > TELL:
            told = time.monotonic()
            tell(f"{told - begun:.0f} s, to block {number}: {total}")
    tell(f"seed {given.seed}, blocks {given.first} to {number}, {time.monotonic() - begun:.0f} s:")
    tell(str(total))
    return total


def _results(
    given: argparse.Namespace, last: int, work: Work, until: float
) -> Iterator[tuple[Any, list[str]]]:
    """Of each block in turn, until the time is over."""
    if given.workers == 1:
        for number in range(given.first, last):
            if time.monotonic() > until:
                return
            yield work(number)
        return
    with ProcessPoolExecutor(given.workers, mp_context=get_context("spawn")) as processes:
        for first in range(given.first, last, given.workers):
            if time.monotonic() > until:
                return
            yield from processes.map(work, range(first, min(first + given.workers, last)))
