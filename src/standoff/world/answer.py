"""The answer of a world in one frame: near pairs, the closest of all, and the clearance proven."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from standoff.checks.numbers import number
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.entries import world as kernels
from standoff.kernels.world import arrays as W
from standoff.read_only import KeepsReadOnly
from standoff.world.model import Model
from standoff.world.pair_answer import PairAnswer
from standoff.world.pair_arrays import PairArrays
from standoff.world.pair_rows import PairRows
from standoff.world.state import WorldCounts, WorldState

if TYPE_CHECKING:
    from standoff.world.solid_answer import SolidPairAnswer


class WorldAnswer(KeepsReadOnly):
    """What is known of all pairs of a world in one frame.

    ``answer["hand", "shelf"]`` is the `PairAnswer` of two bodies, A the first named; where one of
    them has a solid, the `SolidPairAnswer`.

    Attributes
    ----------
    state : WorldState
    time : float
        Since the start, s.
    clearance : float
        A proven lower bound of the signed distances of *all* pairs that count, the far ones
        included. Never more than the horizon, or than the greatest margin where that is more:
        farther nothing is looked at. Inf where there is no horizon and no pair counts.
    certified : bool
        Are the answers of all near pairs proven?
    counts : WorldCounts
    """

    __slots__ = ("_rows", "model", "state")

    def __init__(self, model: Model, state: WorldState) -> None:
        self.model, self.state = model, state
        self._rows = PairRows(model, state)

    @property
    def time(self) -> float:
        return self.state.time

    @property
    def counts(self) -> WorldCounts:
        return self.state.counts

    @property
    def certified(self) -> bool:
        return self.state.counts.uncertified == 0

    @property
    def clearance(self) -> float:
        bounds = self.state.known[:, W.C_BOUND]
        return min(float(bounds.min(initial=math.inf)), self.model.search.reach)

    @property
    def pairs(self) -> PairArrays:
        """All pairs within their horizon."""
        return PairArrays(self._rows)

    @property
    def closest(self) -> PairAnswer | SolidPairAnswer | None:
        """The nearest pair, or the deepest, first of all one of which one body is inside the
        other's material; None if no pair is within its horizon."""
        rows = self._rows.nearest
        if not len(rows):
            return None
        return self._rows.answer(int(rows[int(np.argmin(self.pairs.order))]))

    @property
    def below_margin(self) -> tuple[PairAnswer | SolidPairAnswer, ...]:
        """The pairs that are not proven to keep the margin that they were given."""
        rows = self._rows.nearest
        margins = self.model.search.rules.margins_of(self._rows.numbers)
        below = (margins > 0.0) & (self._rows.lower_bounds(rows) < margins)
        return tuple(self._rows.answer(int(row)) for row in rows[below])

    def __getitem__(self, names: tuple[str, str]) -> PairAnswer | SolidPairAnswer:
        i, j = self._pair(names)
        row = self._near(i, j)
        if row is None:
            return self._rows.far(i, j, self._bound_of_far(i, j))
        return self._rows.answer(row, turned=i > j)

    def minima(
        self, names: tuple[str, str], below: float = math.inf
    ) -> tuple[PairAnswer | SolidPairAnswer, ...]:
        """All local minima of two bodies' distance that were kept, nearest first.

        Parameters
        ----------
        names : (str, str)
        below : float, optional
            Only those of less distance than this; the world's ``minima`` says which are kept.
        """
        below = below if below == math.inf else number(below, "below")
        i, j = self._pair(names)
        near = self.state.near
        rows = near[self._rows.groups(near) == self.model.pair_number(i, j)]
        rows = rows[np.argsort(self.state.known[rows, W.C_UPPER], kind="stable")]
        found = (self._rows.answer(int(row), turned=i > j, alone=True) for row in rows)
        return tuple(answer for answer in found if answer.distance < below)

    def lower_bound(self, names: tuple[str, str]) -> float:
        """The proven lower bound of two bodies' signed distance, near or far, length."""
        i, j = self._pair(names)
        row = self._near(i, j)
        return self._bound_of_far(i, j) if row is None else self._rows.answer(row).lower_bound

    def _pair(self, names: Any) -> tuple[int, int]:
        """The numbers of two bodies whose pair counts.

        Raises StandoffError.
        """
        if not (isinstance(names, tuple) and len(names) == 2):
            raise StandoffTypeError(
                f"{shown(names)}: ask for a pair by two names, answer['a', 'b'].", "names", names
            )
        i, j = (self.model.names.body(name, "pair") for name in names)
        if not self.model.search.rules.counts(i, j):
            raise StandoffError(
                f"The pair {names} does not count in this world: its rules leave it out, both "
                "are fixed, or it is one body twice.",
                "names",
                names,
            )
        return i, j

    def _near(self, i: int, j: int) -> int | None:
        """The row of two bodies' nearest pieces; None where they are beyond their horizon."""
        number, groups = self.model.pair_number(i, j), self._rows.numbers
        at = int(np.searchsorted(groups, number))
        return int(self._rows.nearest[at]) if at < len(groups) and groups[at] == number else None

    def _bound_of_far(self, i: int, j: int) -> float:
        """Of a pair that is beyond its horizon: it is at least so far apart."""
        search, state, square = self.model.search, self.state, self.model.most**2
        bound = kernels.apart_by_boxes(search.pieces[:], state.placed, i, j)
        key = self.model.pair_number(i, j) * square
        first, last = np.searchsorted(self._rows.keys, [key, key + square])
        if first < last:
            known = float(state.known[first:last, W.C_BOUND].min())
            # pieces that are in no row are beyond the search's reach
            pieces = np.diff(search.pieces.first[:-1])
            whole = last - first == pieces[i] * pieces[j]
            bound = max(bound, known if whole else min(known, search.reach))
        else:
            bound = max(bound, search.reach)
        return float(bound)

    def __repr__(self) -> str:
        return f"<WorldAnswer: {len(self.pairs)} near pairs, clearance {self.clearance:.6g}>"
