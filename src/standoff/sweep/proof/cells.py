"""Cells of a box of parameters: made by halving, so that they fill it exactly."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.typing import Array, Ints

DEEPEST = 50
"""Most halvings along one parameter: all middles are then exact in a double."""


class Cells(NamedTuple):
    """Cells of the unit cube of parameters.

    Attributes
    ----------
    place : (n, columns) array of int
        Which of the 2**depth parts of each parameter's range, from 0 on.
    depth : (n, columns) array of int
        How often each range was halved.
    known : (n, pairs) array
        What is proven of each pair's distance in a cell that holds it, -inf at first: length. No
        columns where there is but one pair.
    """

    place: Ints
    depth: Ints
    known: Array

    @classmethod
    def whole(cls, columns: int, pairs: int = 0) -> Cells:
        """Return the whole box, as one cell."""
        nothing = np.zeros((1, columns), dtype=np.int64)
        return cls(nothing, nothing, np.full((1, pairs), -np.inf))

    @classmethod
    def together(cls, parts: Sequence[Cells]) -> Cells:
        """Return the cells of several, in their order."""
        return cls(
            np.concatenate([part.place for part in parts]),
            np.concatenate([part.depth for part in parts]),
            np.concatenate([part.known for part in parts]),
        )

    @property
    def middles(self) -> Array:
        """(n, columns) middles in the unit cube, exact."""
        middles: Array = np.ldexp(self.place + 0.5, -self.depth)
        return middles

    @property
    def halves(self) -> Array:
        """(n, columns) half sides in the unit cube, exact."""
        halves: Array = np.ldexp(0.5, -self.depth)
        return halves

    @property
    def levels(self) -> Ints:
        """(n,) how often each was halved in all: its volume is 2**-level of the box's."""
        levels: Ints = self.depth.sum(axis=1)
        return levels

    def at(self, which: Any) -> Cells:
        """Return some of them."""
        return Cells(*(column[which] for column in self))

    def halved(self, along: Ints) -> Cells:
        """Return both halves of each, next to each other.

        Parameters
        ----------
        along : (n,) array of int
            The parameter that is halved, of each cell.
        """
        place, depth = np.repeat(self.place, 2, axis=0), np.repeat(self.depth, 2, axis=0)
        rows, columns = np.arange(len(place)), np.repeat(along, 2)
        depth[rows, columns] += 1
        place[rows, columns] = 2 * place[rows, columns] + rows % 2
        return Cells(place, depth, np.repeat(self.known, 2, axis=0))

    def holding(self, points: Array) -> NDArray[np.bool_]:
        """Return which of n points of the unit cube is in the cell of its row; ends count."""
        inside: NDArray[np.bool_] = np.all(np.abs(points - self.middles) <= self.halves, axis=1)
        return inside
