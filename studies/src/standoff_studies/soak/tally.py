"""What a soak counts: sums and extremes, which may be merged in any order."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from standoff.checks.numbers import whole_number
from standoff_studies.soak.reading import entry, mapping, number, rows, text

EXAMPLES = 40
"""Frames without a certificate that are kept as examples: those of the first pairs."""


@dataclass
class Tally:
    """Counts of frames, the worst of some numbers, and examples of frames without a certificate.

    Attributes
    ----------
    sums : Counter
    worst : dict of float
        Greatest values.
    examples : list of [pair, frame, status, shapes, distance]
    """

    sums: Counter[str] = field(default_factory=Counter)
    worst: dict[str, float] = field(default_factory=dict)
    examples: list[list[Any]] = field(default_factory=list)

    def count(self, name: str, number: int) -> None:
        """Add to a sum; a sum of zero is not stored."""
        if number:
            self.sums[name] += int(number)

    def note(self, name: str, value: float) -> None:
        """Keep the greatest of a value."""
        self.worst[name] = max(float(value), self.worst.get(name, float(value)))

    def add(self, other: Tally) -> None:
        """Merge another tally."""
        self.sums.update(other.sums)
        for name, value in other.worst.items():
            self.note(name, value)
        self.examples = sorted(self.examples + other.examples, key=lambda e: e[:2])[:EXAMPLES]

    def facts(self) -> dict[str, Any]:
        """Return plain data, in an order that does not depend on the merging."""
        return {
            "sums": dict(sorted(self.sums.items())),
            "worst": dict(sorted(self.worst.items())),
            "examples": self.examples,
        }

    def lines(self) -> Iterator[str]:
        """Yield the sums, except that of the pairs, and the worst numbers as they are printed."""
        for name, count in sorted(self.sums.items()):
            if name != "pairs":
                yield f"{count:>13,}  {name}"
        for name, value in sorted(self.worst.items()):
            yield f"{value:>13.6g}  worst: {name}"

    @classmethod
    def of(cls, facts: dict[str, Any]) -> Tally:
        """Return the tally from plain data.

        Raises
        ------
        ValueError
            It is not a tally.
        """
        sums = mapping(entry(facts, "sums"), "'sums'")
        worst = mapping(entry(facts, "worst"), "'worst'")
        examples = rows(entry(facts, "examples"), "'examples'", 5)
        for pair, frame, status, shapes, distance in examples:
            whole_number(pair, "an example's pair", 0)
            whole_number(frame, "an example's frame", 0)
            text(status, "an example's status")
            text(shapes, "an example's pair of shapes")
            if distance is not None:
                number(distance, "an example's distance")
        return cls(
            Counter({name: whole_number(n, f"the sum '{name}'", 0) for name, n in sums.items()}),
            {name: number(value, f"the worst '{name}'") for name, value in worst.items()},
            examples,
        )
