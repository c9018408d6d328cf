"""A box of parameters that is asked cell by cell."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from standoff.sweep.parameters import Parameter, in_ranges
from standoff.sweep.proof.cells import DEEPEST, Cells
from standoff.sweep.proof.summary import Kind
from standoff.typing import Array, Ints


class CellFindings(NamedTuple):
    """What was found of n cells.

    Attributes
    ----------
    kind : (n,) array of int
        Their `Kind`, or -1 where they are to be halved.
    along : (n,) array of int
        Along which parameter they are halved.
    lower : (n,) array
        Proven everywhere in the cell [length].
    distance : (n,) array
        An upper bound at the parameters that were asked; inf where none were.
    queries, uncertified : int
        Distances that were asked, and how many of them are not proven.
    known : (n, pairs) array
        As of `Cells`, for their halves.
    """

    kind: Ints
    along: Ints
    lower: Array
    distance: Array
    queries: int
    uncertified: int
    known: Array


class QueryFindings(NamedTuple):
    """What some queries told of their cells.

    Attributes
    ----------
    lower, upper : (n,) arrays
        Between which the distance is anywhere in the cell.
    distance : (n,) array
        An upper bound at the parameters that were asked.
    ways : (n, columns) array
        What each parameter by itself takes from the bound in the middle; of a shape, about what
        halving it gives back.
    moved : (n, columns) array
        How far each parameter by itself can move a point.
    """

    lower: Array
    upper: Array
    distance: Array
    ways: Array
    moved: Array


class ParameterBox(ABC):
    """All that a job's parameters can be.

    Parameters
    ----------
    parameters : sequence of Parameter
    clearance : float
        That is to be proven [length].
    """

    block: int
    """Cells that are asked at once."""

    def __init__(self, parameters: Sequence[Parameter], clearance: float) -> None:
        self.parameters, self.clearance = tuple(parameters), clearance
        self.width = np.array([p.high - p.low for p in parameters])
        self.finest = 0.0
        """A cell whose points move by no more than this is not halved [length]."""

    def numbers(self, cells: Cells) -> Array:
        """Return the parameters (n, columns) that are asked in cells, as rows of the sweep have
        them: in their middles."""
        return in_ranges(self.parameters, cells.middles)

    @property
    def pairs(self) -> int:
        """How many pairs are proven one by one in a cell; 0 where there is but one."""
        return 0

    @property
    def whole(self) -> Cells:
        """The whole box."""
        return Cells.whole(len(self.parameters), self.pairs)

    @abstractmethod
    def moves(self, cells: Cells) -> tuple[Array, Array]:
        """Return how far points can move in cells (n,), and by each parameter (n, columns)."""

    @abstractmethod
    def look(self, cells: Cells) -> CellFindings:
        """Decide of each cell. What is decided depends on that cell alone."""

    def decided(self, cells: Cells, moved: Array, told: QueryFindings, asked: Ints) -> CellFindings:
        """Return what is decided by what was told of all cells; `asked` counts queries and those
        that are not proven."""
        missed = ~(told.distance >= self.clearance)
        # Where the middle is too near no bound from below helps: the cell has to be smaller.
        given = np.where(missed[:, None], told.moved, told.ways)
        given[cells.depth >= DEEPEST] = -1.0
        kind = np.full(len(moved), -1)
        kind[(moved <= self.finest) | (given.max(axis=1) <= 0.0)] = Kind.OPEN
        kind[told.upper < self.clearance] = Kind.VIOLATED
        kind[told.lower >= self.clearance] = Kind.PROVEN
        queries, uncertified = asked.tolist()
        along = given.argmax(axis=1)
        return CellFindings(
            kind, along, told.lower, told.distance, queries, uncertified, cells.known
        )
