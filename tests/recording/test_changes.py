"""Changes of a mode between two times: all that halving can see, each in its place."""

from __future__ import annotations

from bisect import bisect_right
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pytest

from standoff.recording.changes import Found, changes


class Known(NamedTuple):
    time: float
    mode: int


class Line:
    """A mode that counts the given instants that are past."""

    def __init__(self, instants: list[float]) -> None:
        self.instants, self.looks = instants, 0

    def at(self, time: float, *_: Known) -> Known:
        self.looks += 1
        return Known(time, bisect_right(self.instants, time))

    def found(self, resolution: float, *more: object) -> list[tuple[Known, Known]]:
        ends = self.at(0.0), self.at(1.0)
        return changes(*ends, self.at, resolution, lambda *pair: pair, *more)  # type: ignore[arg-type]


def test_every_change_is_found_in_its_place(rng: np.random.Generator) -> None:
    instants = np.sort(rng.uniform(0.01, 0.99, 9)).tolist()
    apart = min(b - a for a, b in pairwise(instants))
    found = Line(instants).found(0.4 * apart)
    assert [(low.mode, high.mode) for low, high in found] == [(k, k + 1) for k in range(9)]
    for (low, high), instant in zip(found, instants, strict=True):
        assert low.time < instant <= high.time
        assert high.time - low.time <= 0.4 * apart


def test_two_changes_nearer_than_the_resolution_are_one() -> None:
    ((low, high),) = Line([0.3, 0.3 + 1e-9]).found(1e-6)
    assert (low.mode, high.mode) == (0, 2)


def test_the_resolution_ends_at_neighbouring_numbers() -> None:
    ((low, high),) = Line([0.3]).found(0.0)
    assert high.time == np.nextafter(low.time, 1.0)


def test_nothing_is_looked_for_where_nothing_has_changed() -> None:
    line = Line([])
    assert line.found(1e-9) == []
    assert line.looks == 2


@pytest.mark.parametrize(("proven", "tries", "asked"), [(True, 3, 1), (False, 3, 3), (True, 0, 0)])
def test_another_way_is_tried_first(proven: bool, tries: int, asked: int) -> None:
    line, times = Line([0.3]), []

    def otherwise(low: Known, high: Known) -> Found[tuple[Known, Known]]:
        times.append((low.time, high.time))
        return ((low, high), False) if proven else (None, True)

    ((low, high),) = line.found(1e-6, otherwise, tries)
    assert len(times) == asked
    assert (high.time - low.time <= 1e-6) == (asked != 1)


def test_what_counts_as_a_change_may_be_told() -> None:
    """Modes of one parity are alike: of five changes one is seen, of two none."""
    instants = [0.1, 0.3, 0.5, 0.7, 0.9]

    def odd(low: Known, high: Known) -> bool:
        return (low.mode - high.mode) % 2 == 1

    found = Line(instants).found(1e-3, None, 0, odd)
    assert [(low.mode, high.mode) for low, high in found] == [(0, 1)]
    assert Line([0.3, 0.4]).found(1e-3, None, 0, odd) == []
