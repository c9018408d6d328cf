"""What a proof over a box of parameters comes to: shares of its volume, and the worst places."""

from __future__ import annotations

import math
from collections.abc import Mapping
from enum import IntEnum
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from standoff.robots.proof import Verdict
from standoff.typing import Array, Ints


class Kind(IntEnum):
    """What was shown of a cell, in the order in which the shares are told."""

    PROVEN = 0
    VIOLATED = 1
    OPEN = 2


class Places(NamedTuple):
    """Some cells, the worst first.

    Attributes
    ----------
    numbers : (n, columns) array
        Parameters that were asked in them: the middles, and of shapes the largest bodies.
    half : (n, columns) array
        Half sides, in the parameters' units.
    distance : (n,) array
        There; an upper bound of it.
    bound : (n,) array
        Proven in the whole cell.
    """

    numbers: Array
    half: Array
    distance: Array
    bound: Array

    @classmethod
    def none(cls, columns: int) -> Places:
        nothing = np.zeros((0, columns))
        return cls(nothing, nothing, np.zeros(0), np.zeros(0))

    def at(self, which: Any) -> Places:
        """Return some of them."""
        return Places(*(column[which] for column in self))

    def facts(self) -> dict[str, list[Any]]:
        """Return plain data that JSON can hold: None for what is not finite."""
        return {name: _plain(column) for name, column in self._asdict().items()}

    @classmethod
    def from_facts(cls, facts: Mapping[str, Any], columns: int) -> Places:
        numbers, half, distance, bound = (
            np.array(facts[name], dtype=np.float64) for name in cls._fields
        )
        bound = np.where(np.isnan(bound), -np.inf, bound)
        return cls(numbers.reshape(-1, columns), half.reshape(-1, columns), distance, bound)


def _plain(column: Array) -> list[Any]:
    return [
        _plain(x) if isinstance(x, np.ndarray) else float(x) if math.isfinite(x) else None
        for x in column
    ]


class Worst:
    """The first of very many places, by one of their columns; of equal ones the first stays."""

    def __init__(self, most: int, columns: int, by: str) -> None:
        self.most, self.by = most, by
        self.count = 0
        self.places = Places.none(columns)

    def add(self, places: Places, count: int | None = None) -> None:
        """Add later ones."""
        self.count += len(places.distance) if count is None else count
        joined = Places(*(np.concatenate(both) for both in zip(self.places, places, strict=True)))
        order = np.argsort(getattr(joined, self.by), kind="stable")[: self.most]
        self.places = joined.at(order)

    def facts(self) -> dict[str, Any]:
        return {"count": self.count, **self.places.facts()}


class ProofSummary:
    """What is proven of some cells of a box.

    Parameters
    ----------
    most : int
        Places that each list holds.
    columns : int
        Numbers of a place.
    """

    def __init__(self, most: int, columns: int) -> None:
        self.most, self.columns = most, columns
        self.cells: dict[int, list[int]] = {}
        """By level, how many cells were proven, violated and left open."""
        self.queries = 0
        self.uncertified = 0
        self.bound = math.inf
        self.nearest = Worst(1, columns, "distance")
        self.counterexamples = Worst(most, columns, "distance")
        self.open = Worst(most, columns, "bound")

    def close(self, levels: Ints, kind: Kind, bound: Array) -> None:
        """Count cells of a kind."""
        for level, n in zip(*np.unique(levels, return_counts=True), strict=True):
            self.cells.setdefault(int(level), [0] * len(Kind))[kind] += int(n)
        self.bound = min(self.bound, float(bound.min(initial=math.inf)))

    def share(self, kind: Kind) -> Fraction:
        """Return the exact part of the box's volume that cells of a kind fill."""
        return sum((Fraction(n[kind], 1 << level) for level, n in self.cells.items()), Fraction(0))

    def number(self, kind: Kind) -> int:
        """Return how many cells there are of a kind."""
        return sum(n[kind] for n in self.cells.values())

    @property
    def verdict(self) -> Verdict:
        """What is known of the whole box."""
        if self.counterexamples.count:
            return Verdict.VIOLATED
        return Verdict.UNDECIDED if self.number(Kind.OPEN) else Verdict.PROVEN

    def add(self, later: ProofSummary) -> None:
        """Add what is proven of the cells behind those that are in it."""
        for level, counts in later.cells.items():
            own = self.cells.setdefault(level, [0] * len(Kind))
            for kind, n in enumerate(counts):
                own[kind] += n
        self.queries += later.queries
        self.uncertified += later.uncertified
        self.bound = min(self.bound, later.bound)
        for name in ("nearest", "counterexamples", "open"):
            more = getattr(later, name)
            getattr(self, name).add(more.places, more.count)

    def facts(self) -> dict[str, Any]:
        """Return plain data that JSON can hold, and `from_facts` can read."""
        return {
            "verdict": self.verdict.name,
            "shares": {kind.name: float(self.share(kind)) for kind in Kind},
            "number": {kind.name: self.number(kind) for kind in Kind},
            "bound": self.bound if math.isfinite(self.bound) else None,
            "queries": self.queries,
            "uncertified": self.uncertified,
            "cells": {str(level): self.cells[level] for level in sorted(self.cells)},
            "nearest": self.nearest.facts(),
            "counterexamples": self.counterexamples.facts(),
            "open": self.open.facts(),
        }

    @classmethod
    def from_facts(cls, facts: Mapping[str, Any], most: int, columns: int) -> ProofSummary:
        """Return the summary of plain data."""
        found = cls(most, columns)
        found.cells = {int(level): list(counts) for level, counts in facts["cells"].items()}
        found.queries, found.uncertified = facts["queries"], facts["uncertified"]
        if facts["bound"] is not None:
            found.bound = facts["bound"]
        elif found.cells:
            found.bound = -math.inf
        for name in ("nearest", "counterexamples", "open"):
            own = facts[name]
            getattr(found, name).add(Places.from_facts(own, columns), own["count"])
        return found
