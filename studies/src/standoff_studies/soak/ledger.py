"""The progress of a soak: a file, written whole or not at all, from which it can continue."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from standoff.checks.numbers import whole_number
from standoff.tracking.status import Status
from standoff.version import __version__
from standoff.whole_files import write_whole
from standoff_studies.soak.adversary import CASES, WILD_FRAMES
from standoff_studies.soak.cases import PER_DRAWER
from standoff_studies.soak.reading import entry, read_facts, rows, written
from standoff_studies.soak.tally import Tally

NAME = "soak.json"
Part = tuple[int, int]
"""Pairs first .. end - 1."""


@dataclass
class Ledger:
    """The finished pairs, and their counts.

    Attributes
    ----------
    seed, frames : int
    done : list of (first, end)
        Sorted, apart from each other.
    tally : Tally
    """

    seed: int
    frames: int
    done: list[Part] = field(default_factory=list)
    tally: Tally = field(default_factory=Tally)

    def add(self, part: Part, tally: Tally) -> None:
        """Add a finished part."""
        merged: list[Part] = []
        for first, end in sorted([*self.done, part]):
            if merged and first <= merged[-1][1]:
                merged[-1] = merged[-1][0], max(end, merged[-1][1])
            else:
                merged.append((first, end))
        self.done = merged
        self.tally.add(tally)

    def left(self, pairs: int) -> list[Part]:
        """Return what is left of a number of pairs, in parts that share a drawer of shapes."""
        parts, at = [], 0
        for first, end in [*self.done, (pairs, pairs)]:
            while at < min(first, pairs):
                stop = min(first, pairs, (at // PER_DRAWER + 1) * PER_DRAWER)
                parts.append((at, stop))
                at = stop
            at = max(at, end)
        return parts

    def pairs_done(self) -> int:
        """Return how many pairs are finished."""
        return sum(end - first for first, end in self.done)

    def facts(self) -> dict[str, Any]:
        """Return plain data."""
        return {
            "standoff": __version__,
            "seed": self.seed,
            "frames": self.frames,
            "done": [list(part) for part in self.done],
            **self.tally.facts(),
        }

    def write(self, folder: Path) -> None:
        """Write the file.

        Raises
        ------
        OSError
            As on a full disk.
        """
        write_whole({folder / NAME: written(self.facts())})

    @classmethod
    def read(cls, folder: Path, seed: int, frames: int) -> Ledger:
        """Return the ledger of a folder, to continue with.

        Raises
        ------
        OSError
            There is none.
        ValueError
            It is damaged, or of another run: another seed, number of frames or version.
        """
        file = folder / NAME
        try:
            facts = read_facts(file)
            known = {name: entry(facts, name) for name in ("standoff", "seed", "frames")}
            done = _parts(entry(facts, "done"))
            tally = Tally.of(facts)
        except ValueError as error:
            raise ValueError(f"{file} is not a ledger of a soak: {error}") from error
        wanted = {"standoff": __version__, "seed": seed, "frames": frames}
        for name, value in wanted.items():
            if known[name] != value:
                raise ValueError(
                    f"{file} is of a run with {name} {known[name]}, not {value}: give that, or "
                    "another folder."
                )
        ledger = cls(seed, frames, done, tally)
        wrong = ledger.inconsistency()
        if wrong:
            raise ValueError(f"{file} is damaged: {wrong}. Start again in another folder.")
        return ledger

    def inconsistency(self) -> str:
        """Return which sums contradict the finished pairs; "" if none does."""
        pairs, sums = self.pairs_done(), self.tally.sums
        frames = pairs * self.frames
        wanted = {
            "pairs": (sums["pairs"], pairs),
            "frames": (sums["frames"], frames),
            "certificates": (sums["certificates"], CASES * pairs),
            "frames of all statuses": (sum(sums[status.name] for status in Status), frames),
            "certified": (
                sums["certified"],
                sums[Status.CONVERGED.name] + sums[Status.GLOBAL.name],
            ),
        }
        for name, (count, right) in wanted.items():
            if count != right:
                return f"it counts {count} {name} where {right} were done"
        for name, count in sums.items():
            most, things = frames, "frames"
            if name.startswith("certificates"):
                most, things = CASES * pairs, "certificates"
            elif name.startswith("wild"):
                most, things = WILD_FRAMES * pairs, "wild frames"
            if count > most:
                return f"it counts {count} '{name}' in {most} {things}"
        return ""


def _parts(facts: Any) -> list[Part]:
    """The parts from plain data: sorted and disjoint."""
    parts: list[Part] = []
    for first, end in rows(facts, "'done'", 2):
        least = parts[-1][1] + 1 if parts else 0
        first = whole_number(first, "the first pair of a part of 'done'", least)
        parts.append((first, whole_number(end, "the end of a part of 'done'", first + 1)))
    return parts
