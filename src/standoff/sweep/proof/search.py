"""A box of parameters, cell by cell: proven, violated, halved, or left open.

A cell is proven where a lower bound of the distance in all of it reaches the clearance, violated
where an upper bound is below, and halved otherwise, along the parameter that stands in the way
most. Whatever is decided of a cell depends on that cell alone, so the same cells are found however
they are shared out.

Queries that one group of cells does not use are passed on to the next within a search. Between the
parts of a box, which are searched at the same time on any number of workers, they are not: what a
part may take would depend on those before it, which would have to be done first.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from standoff.sweep.proof.box import CellFindings, ParameterBox
from standoff.sweep.proof.cells import Cells
from standoff.sweep.proof.summary import Kind, Places, ProofSummary
from standoff.typing import Ints

TOGETHER = 1 << 18
"""Cells of one level that are gone on with together; more of them are parted, each part with its
part of the queries. A cell takes some 200 B."""

Recorded = Callable[[Cells, Ints, Ints], None]


def search(
    box: ParameterBox, first: Cells, queries: int, most: int, record: Recorded | None = None
) -> ProofSummary:
    """Search cells and all that they are halved into.

    Parameters
    ----------
    box : ParameterBox
    first : Cells
    queries : int
        Most distances that are asked for; of many pairs, the last cells may take some more.
    most : int
        Places that each list of the summary holds.
    record : callable, optional
        Called with cells as they are looked at, the `Kind` of each, or -1, and along which
        parameter that is then halved.
    """
    return _Search(box, most, record).run(first, queries)


class _Search:
    def __init__(self, box: ParameterBox, most: int, record: Recorded | None) -> None:
        self.box, self.record = box, record
        self.found = ProofSummary(most, len(box.parameters))

    def run(self, first: Cells, queries: int) -> ProofSummary:
        waiting, unused = [(first, queries)], 0
        while waiting:
            cells, left = waiting.pop()
            left, unused = left + unused, 0
            while len(cells.place) and left > 0:
                if len(cells.place) > TOGETHER:
                    waiting += _parted(cells, left)
                    cells, left = cells.at(slice(0)), 0
                    break
                before = self.found.queries
                cells = self._level(cells, left)
                left -= self.found.queries - before
            self._leave(cells)
            unused = left
        return self.found

    def _level(self, cells: Cells, queries: int) -> Cells:
        """Look at cells while there are queries; returns what those that were not decided are
        halved into, and those that were not looked at."""
        rest, start, end = [], 0, self.found.queries + queries
        while start < len(cells.place) and self.found.queries < end:
            # most cells take a query each
            block = cells.at(slice(start, start + min(self.box.block, end - self.found.queries)))
            start += len(block.place)
            looked = self.box.look(block)
            self._count(block, looked)
            if self.record is not None:
                self.record(block, looked.kind, looked.along)
            left = np.flatnonzero(looked.kind < 0)
            some = block.at(left)._replace(known=looked.known[left])
            rest.append(some.halved(looked.along[left]))
        return Cells.together([*rest, cells.at(slice(start, None))])

    def _count(self, cells: Cells, looked: CellFindings) -> None:
        found = self.found
        found.queries += looked.queries
        found.uncertified += looked.uncertified
        for kind in Kind:
            which = np.flatnonzero(looked.kind == kind)
            found.close(cells.levels[which], kind, looked.lower[which])
            if kind is Kind.OPEN:
                found.open.add(self._places(cells, looked, which))
        missed = np.flatnonzero(looked.distance < self.box.clearance)
        found.counterexamples.add(self._places(cells, looked, missed))
        nearest = np.flatnonzero(np.isfinite(looked.distance))
        if len(nearest):
            least = nearest[[int(looked.distance[nearest].argmin())]]
            found.nearest.add(self._places(cells, looked, least))

    def _places(self, cells: Cells, looked: CellFindings, which: Ints) -> Places:
        some = cells.at(which)
        half = some.halves * self.box.width
        return Places(self.box.numbers(some), half, looked.distance[which], looked.lower[which])

    def _leave(self, cells: Cells) -> None:
        """Count cells that no queries were left for."""
        n = len(cells.place)
        if not n:
            return
        none, unknown = np.zeros(n, dtype=np.int64), np.full(n, -np.inf)
        looked = CellFindings(
            none + Kind.OPEN, none, unknown, np.full(n, np.nan), 0, 0, cells.known
        )
        self.found.close(cells.levels, Kind.OPEN, unknown)
        self.found.open.add(self._places(cells, looked, np.arange(n)))
        if self.record is not None:
            self.record(cells, looked.kind, none)


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
