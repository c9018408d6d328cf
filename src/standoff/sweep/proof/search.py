"""A box of parameters, cell by cell: proven, violated, halved, or left open.

A cell is proven where a lower bound of the distance in all of it reaches the clearance, violated
where an upper bound is below, and halved otherwise, along the parameter that stands in the way
most. Whatever is decided of a cell depends on that cell alone, so the same cells are found however
they are shared out.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.state import arrays as K
from standoff.sweep.job import Job
from standoff.sweep.proof.bounds import PairBounds
from standoff.sweep.proof.cells import DEEPEST, Cells
from standoff.sweep.proof.summary import Kind, Places, ProofSummary
from standoff.tracking.answers import proven
from standoff.tracking.many_distances import answered_rows

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

BLOCK = 8192
"""Cells that are asked at once: their poses and answers, some 5 MB, stay near the processor."""

TOGETHER = 1 << 18
"""Cells of one level that are gone on with together; more of them are parted, each part with its
part of the queries. A cell takes some 200 B."""

Recorded = Callable[[Cells, Whole], None]


class Asked(NamedTuple):
    """What is to be proven, and with how much effort.

    Attributes
    ----------
    clearance : float
        Length.
    finest : float
        A cell whose points move by no more than this is not halved: length.
    queries : int
        Most distances that are asked for.
    """

    clearance: float
    finest: float
    queries: int


class Looked(NamedTuple):
    """What was found of n cells: their `Kind`, or -1 where they are to be halved, and along which
    parameter."""

    kind: Whole
    along: Whole
    lower: Array
    distance: Array
    queries: int
    uncertified: int


class CellSearch:
    """The cells of a job's box.

    Parameters
    ----------
    job : Job
    clearance, finest : float
        As in `Asked`.
    """

    def __init__(self, job: Job, clearance: float, finest: float) -> None:
        self.job, self.clearance, self.finest = job, clearance, finest
        self.bounds = PairBounds(job)

    def look(self, cells: Cells) -> Looked:
        """Decide of each cell, by a query in the middle where no ball is enough."""
        n = len(cells.place)
        half = self.bounds.half(cells)
        moved, ways = self.bounds.moved(half)
        poses = self.job.poses(self.bounds.numbers(cells))
        lower, distance = self.bounds.by_balls(poses, moved), np.full(n, np.inf)
        upper = np.full(n, np.inf)
        ask = np.flatnonzero(~(lower >= self.clearance))
        if not len(ask):
            return Looked(np.full(n, Kind.PROVEN), np.zeros(n, dtype=np.int64), lower, distance, 0, 0)
        found = answered_rows(*self.job.bodies, *(x if len(x) == 1 else x[ask] for x in poses))
        told = self.bounds.bounds(cells.at(ask), found)
        lower[ask] = np.maximum(lower[ask], told.lower)
        upper[ask], distance[ask] = told.upper, found.upper_bound
        missed = ~(distance[ask] >= self.clearance)
        given = np.where(missed[:, None], told.moved, told.ways)
        given[cells.depth[ask] >= DEEPEST] = -1.0
        along = np.zeros(n, dtype=np.int64)
        along[ask] = given.argmax(axis=1)
        kind = np.full(n, -1)
        kind[moved <= self.finest] = Kind.OPEN
        kind[ask[given.max(axis=1, initial=-1.0) <= 0.0]] = Kind.OPEN
        kind[upper < self.clearance] = Kind.VIOLATED
        kind[lower >= self.clearance] = Kind.PROVEN
        doubtful = int(np.count_nonzero(~proven(found.rows[:, K.STATUS])))
        return Looked(kind, along, lower, distance, len(ask), doubtful)

    def run(
        self, first: Cells, queries: int, most: int, record: Recorded | None = None
    ) -> ProofSummary:
        """Search cells and all that they are halved into.

        Parameters
        ----------
        first : Cells
        queries : int
            Most distances that are asked for.
        most : int
            Places that each list of the summary holds.
        record : callable, optional
            Called with cells, and the `Kind` of each, as they are closed.
        """
        found = ProofSummary(most, len(self.job.parameters))
        waiting = [(first, queries)]
        while waiting:
            cells, left = waiting.pop()
            while len(cells.place):
                if left <= 0:
                    self._leave(cells, found, record)
                    break
                if len(cells.place) > TOGETHER:
                    waiting += _parted(cells, left)
                    break
                before = found.queries
                cells = self._level(cells, found, record)
                left -= found.queries - before
        return found

    def _level(self, cells: Cells, found: ProofSummary, record: Recorded | None) -> Cells:
        """Look at all cells; returns what those that were not decided are halved into."""
        rest = []
        for start in range(0, len(cells.place), BLOCK):
            block = cells.at(slice(start, start + BLOCK))
            looked = self.look(block)
            self._count(block, looked, found)
            if record is not None:
                closed = np.flatnonzero(looked.kind >= 0)
                record(block.at(closed), looked.kind[closed])
            left = np.flatnonzero(looked.kind < 0)
            rest.append(block.at(left).halved(looked.along[left]))
        return Cells(*(np.concatenate(part) for part in zip(*rest, strict=True)))

    def _count(self, cells: Cells, looked: Looked, found: ProofSummary) -> None:
        found.queries += looked.queries
        found.uncertified += looked.uncertified
        for kind in Kind:
            which = np.flatnonzero(looked.kind == kind)
            found.close(cells.levels[which], kind, looked.lower[which])
            if kind is Kind.OPEN:
                found.open.add(self._places(cells, looked, which))
        missed = np.flatnonzero(looked.distance < self.clearance)
        found.counterexamples.add(self._places(cells, looked, missed))
        nearest = np.flatnonzero(np.isfinite(looked.distance))
        if len(nearest):
            least = nearest[[int(looked.distance[nearest].argmin())]]
            found.nearest.add(self._places(cells, looked, least))

    def _places(self, cells: Cells, looked: Looked, which: Whole) -> Places:
        some = cells.at(which)
        half = some.halves * self.bounds.width
        numbers = self.bounds.numbers(some)
        return Places(numbers, half, looked.distance[which], looked.lower[which])

    def _leave(self, cells: Cells, found: ProofSummary, record: Recorded | None) -> None:
        """Count cells that no queries were left for."""
        n = len(cells.place)
        unknown = np.full(n, -np.inf)
        found.close(cells.levels, Kind.OPEN, unknown)
        looked = Looked(
            np.full(n, Kind.OPEN), np.zeros(n, dtype=np.int64), unknown, np.full(n, np.nan), 0, 0
        )
        found.open.add(self._places(cells, looked, np.arange(n)))
        if record is not None:
            record(cells, looked.kind)


def _parted(cells: Cells, queries: int) -> list[tuple[Cells, int]]:
    """Cells in parts of half of `TOGETHER`, the last first, each with its part of the queries."""
    parts = -(-len(cells.place) // (TOGETHER // 2))
    ends = [len(cells.place) * k // parts for k in range(parts + 1)]
    shares = [queries * (k + 1) // parts - queries * k // parts for k in range(parts)]
    found = [
        (cells.at(slice(first, end)), share)
        for first, end, share in zip(ends[:-1], ends[1:], shares, strict=True)
    ]
    return found[::-1]
