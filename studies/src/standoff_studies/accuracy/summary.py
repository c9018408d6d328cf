"""Worst and median errors of groups of rows."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass
from math import isnan, nan
from statistics import median
from typing import TypeVar

from standoff_studies.accuracy.measuring import Row, Verdict

Key = TypeVar("Key", bound=Hashable)

QUANTITIES = ("distance", "witness", "normal")
TARGETS = (1e-12, 1e-9, 1e-9)
"""Targets below which errors of distance, witness points (over the size) and normal (rad) stay."""


@dataclass(frozen=True)
class Summary:
    """A group of answers of one engine.

    Attributes
    ----------
    cases : how many there were.
    median, worst : errors in the order of `QUANTITIES`; NaN if nothing could be compared.
    certified : how many were certified; None for engines that do not certify.
    wrong : how many were wrong by more than 1e-6 of the size, or made a false claim.
    deeper : how many were true depths although a smaller one exists.
    nothing : how many had no finite answer.
    """

    cases: int
    median: tuple[float, ...]
    worst: tuple[float, ...]
    certified: int | None
    wrong: int
    deeper: int
    nothing: int


def three_errors(row: Row) -> tuple[float, float, float]:
    """Return a row's errors in the order of `QUANTITIES`."""
    return row.distance_error, row.witness_error, row.normal_error


def summarised(rows: Iterable[Row], key: Callable[[Row], Key]) -> dict[Key, Summary]:
    """Return the summary of every group, in the order in which the groups appear."""
    groups: dict[Key, list[Row]] = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return {name: summary(group) for name, group in groups.items()}


def summary(rows: list[Row]) -> Summary:
    """Sum up one group. Errors that are NaN, such as that of a missing normal, are omitted."""
    errors = map(three_errors, rows)
    found = [[e for e in each if not isnan(e)] for each in zip(*errors, strict=True)]
    certified = [row.certified for row in rows if row.certified is not None]

    def count(verdict: Verdict) -> int:
        return sum(row.verdict == verdict for row in rows)

    return Summary(
        len(rows),
        tuple(median(each) if each else nan for each in found),
        tuple(max(each, default=nan) for each in found),
        sum(certified) if certified else None,
        count(Verdict.WRONG),
        count(Verdict.DEEPER),
        count(Verdict.NOTHING),
    )


def misses(rows: Iterable[Row]) -> list[Row]:
    """Return the rows that miss a target, the worst first."""

    def excess(row: Row) -> float:
        pairs = zip(three_errors(row), TARGETS, strict=True)
        return max((error / target for error, target in pairs if not isnan(error)), default=0.0)

    return sorted((row for row in rows if excess(row) > 1), key=excess, reverse=True)
