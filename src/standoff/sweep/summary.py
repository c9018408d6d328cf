"""What is kept of many rows: totals, a histogram, the worst rows, and those to be looked at."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from standoff.sweep.keep import Keep
from standoff.sweep.rows import Rows
from standoff.sweep.tolerances import PLAIN_SUMS
from standoff.tracking.answers import PROVEN
from standoff.tracking.status import BY_NUMBER, Status
from standoff.typing import Array, Ints

MOST_UNCERTIFIED = 1000
"""Rows without a proof that are listed; all are counted."""

PENDING = 4
"""Times the number of worst rows that may wait to be sorted."""


@dataclass
class Spread:
    """Sum, least and greatest of a number over many rows; nan and infinities do not count.

    The sum is of whole blocks, each added up exactly and rounded once, and so is that of blocks.
    """

    count: int = 0
    sums: list[float] = field(default_factory=list)
    least: float = math.inf
    least_row: int = -1
    most: float = -math.inf
    most_row: int = -1

    def add_rows(self, row: Ints, values: Array) -> None:
        known = np.isfinite(values)
        if not known.all():
            row, values = row[known], values[known]
        if not len(values):
            return
        low, high = int(values.argmin()), int(values.argmax())
        part = Spread(
            len(values),
            [exact_sum(values)],
            float(values[low]),
            int(row[low]),
            float(values[high]),
            int(row[high]),
        )
        self.add(part)

    def add(self, later: Spread) -> None:
        """Add those of later rows: of equal ones, the first stays the least."""
        self.count += later.count
        self.sums += later.sums
        if later.least < self.least:
            self.least, self.least_row = later.least, later.least_row
        if later.most > self.most:
            self.most, self.most_row = later.most, later.most_row

    @property
    def sum(self) -> float:
        return math.fsum(self.sums)

    def facts(self) -> dict[str, Any]:
        some = self.count > 0
        return {
            "count": self.count,
            "sum": self.sum if some else None,
            "min": self.least if some else None,
            "min_row": self.least_row if some else None,
            "max": self.most if some else None,
            "max_row": self.most_row if some else None,
        }

    @classmethod
    def from_facts(cls, facts: Mapping[str, Any]) -> Spread:
        if not facts["count"]:
            return cls()
        ends = (facts[key] for key in ("min", "min_row", "max", "max_row"))
        return cls(facts["count"], [facts["sum"]], *ends)


@dataclass
class Listed:
    """How many rows there are of a kind, and the first of them."""

    most: int
    count: int = 0
    rows: Rows = field(default_factory=Rows.none)

    def add(self, rows: Rows, count: int | None = None) -> None:
        self.count += len(rows.row) if count is None else count
        room = self.most - len(self.rows.row)
        if room and len(rows.row):
            self.rows = self.rows.with_more(rows.at(slice(room)))

    def facts(self) -> dict[str, Any]:
        return {"count": self.count, "rows": self.rows.facts()}


class Summary:
    """What is kept of consecutive rows.

    Parameters
    ----------
    keep : Keep
    """

    def __init__(self, keep: Keep) -> None:
        self.keep = keep
        self.statuses = np.zeros(len(BY_NUMBER), dtype=np.int64)
        self.distance, self.lower_bound = Spread(), Spread()
        self.bins = np.zeros(0 if keep.bins is None else keep.bins.number, dtype=np.int64)
        self._edges = np.empty(0) if keep.bins is None else keep.bins.edges
        self.outside = np.zeros(3, dtype=np.int64)  # of the bins: under, over, no distance
        self.below = Listed(keep.most_below)
        self.uncertified = Listed(MOST_UNCERTIFIED)
        self._worst = Rows.none()
        self._limit = math.inf

    @property
    def rows(self) -> int:
        """How many rows there are."""
        return int(self.statuses.sum())

    @property
    def certified(self) -> int:
        """How many answers are proven."""
        return int(self.statuses[PROVEN].sum())

    @property
    def worst(self) -> Rows:
        """The rows of least distance, the nearest first; of equal ones, the first row first."""
        self._sort()
        return self._worst

    def add_rows(self, rows: Rows) -> None:
        """Add the answers of rows behind those that are in it."""
        self.statuses += np.bincount(rows.status, minlength=len(BY_NUMBER))
        self.distance.add_rows(rows.row, rows.distance)
        self.lower_bound.add_rows(rows.row, rows.lower_bound)
        self._count_bins(rows.distance)
        if self.keep.below is not None:
            # not less than: a row without a bound is not proven to keep anything
            self.below.add(rows.at(np.flatnonzero(~(rows.lower_bound >= self.keep.below))))
        self.uncertified.add(rows.at(np.flatnonzero(~PROVEN[rows.status])))
        self._add_worst(rows.at(np.flatnonzero(rows.distance <= self._limit)))

    def add(self, later: Summary) -> None:
        """Add what is kept of the rows behind those that are in it."""
        self.statuses += later.statuses
        self.distance.add(later.distance)
        self.lower_bound.add(later.lower_bound)
        self.bins += later.bins
        self.outside += later.outside
        self.below.add(later.below.rows, later.below.count)
        self.uncertified.add(later.uncertified.rows, later.uncertified.count)
        self._add_worst(later.worst)

    def _count_bins(self, distance: Array) -> None:
        if self.keep.bins is None:
            return
        known = np.sort(distance[~np.isnan(distance)])
        # Of sorted rows the ends of the bins are found, which are fewer.
        ends = np.searchsorted(known, self._edges)
        self.bins += np.diff(ends)
        self.outside += [ends[0], len(known) - ends[-1], len(distance) - len(known)]

    def _add_worst(self, rows: Rows) -> None:
        if len(rows.row):
            self._worst = self._worst.with_more(rows)
        if len(self._worst.row) > PENDING * self.keep.worst:
            self._sort()

    def _sort(self) -> None:
        order = np.lexsort((self._worst.row, self._worst.distance))[: self.keep.worst]
        self._worst = self._worst.at(order)
        if len(order) == self.keep.worst:
            self._limit = float(self._worst.distance[-1])

    def facts(self) -> dict[str, Any]:
        """Return plain data that JSON can hold, and `from_facts` can read."""
        statuses = zip(BY_NUMBER, self.statuses.tolist(), strict=True)
        found: dict[str, Any] = {
            "rows": self.rows,
            "certified": self.certified,
            "statuses": {status.name: n for status, n in statuses if n},
            "distance": self.distance.facts(),
            "lower_bound": self.lower_bound.facts(),
        }
        if self.keep.bins is not None:
            outside = zip(("under", "over", "no_distance"), self.outside.tolist(), strict=True)
            found["histogram"] = {"counts": self.bins.tolist(), **dict(outside)}
        found["worst"] = self.worst.facts()
        if self.keep.below is not None:
            found["below"] = self.below.facts()
        return found | {"uncertified": self.uncertified.facts()}

    @classmethod
    def from_facts(cls, facts: Mapping[str, Any], keep: Keep) -> Summary:
        """Return the summary of plain data; its sums are those of the whole."""
        found = cls(keep)
        for name, n in facts["statuses"].items():
            found.statuses[Status[name].value] = n
        found.distance = Spread.from_facts(facts["distance"])
        found.lower_bound = Spread.from_facts(facts["lower_bound"])
        if keep.bins is not None:
            histogram = facts["histogram"]
            found.bins[:] = histogram["counts"]
            found.outside[:] = [histogram[key] for key in ("under", "over", "no_distance")]
        found._add_worst(Rows.from_facts(facts["worst"]))
        if keep.below is not None:
            below = facts["below"]
            found.below.add(Rows.from_facts(below["rows"]), below["count"])
        uncertified = facts["uncertified"]
        found.uncertified.add(Rows.from_facts(uncertified["rows"]), uncertified["count"])
        return found


# Sums that are rounded once, of arrays: those of `math.fsum`, in a fifth of its time.

MOST_PIECES: Final = 8
"""Times that digits are cut off before `math.fsum` gets the rest: of distances two do."""


def exact_sum(values: Array) -> float:
    """Return the sum of finite numbers (n,), rounded once.

    Digits above a place that all numbers have in common are cut off and added up, which no
    rounding touches; then those of the rest (S. M. Rump, T. Ogita and S. Oishi, Accurate
    floating-point summation, SIAM J. Sci. Comput. 31, 2008).
    """
    rest, sums = values, list[float]()
    for _ in range(MOST_PIECES):
        most = float(np.abs(rest).max(initial=0.0))
        if most == 0.0:
            return math.fsum(sums)
        if not PLAIN_SUMS[0] < most < PLAIN_SUMS[1]:
            break
        # A power of two so far above all of them that no sum of what is cut off reaches it.
        above = 2.0 ** (math.frexp(most)[1] + len(rest).bit_length())
        cut = (above + rest) - above
        sums.append(float(cut.sum()))
        rest = rest - cut
    return math.fsum([*sums, *rest.tolist()])
