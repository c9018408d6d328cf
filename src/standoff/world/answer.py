"""The answer of a world in one frame: near pairs, the closest of all, and the clearance proven."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from standoff.checks.numbers import number
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.entries import world as kernels
from standoff.kernels.state import arrays as K
from standoff.kernels.world import arrays as W
from standoff.read_only import KeepsReadOnly
from standoff.world.compound import Compound
from standoff.world.packed import pieces_of
from standoff.world.pair_answer import PairAnswer, far_block, swapped
from standoff.world.pair_arrays import PairArrays
from standoff.world.state import WorldCounts, WorldState

if TYPE_CHECKING:
    from standoff.world.world import World

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


class WorldAnswer(KeepsReadOnly):
    """What is known of all pairs of a world in one frame.

    ``answer["hand", "shelf"]`` is the `PairAnswer` of two bodies, A the first named.

    Attributes
    ----------
    state : WorldState
    time : float
        Since the start, s.
    clearance : float
        A proven lower bound of the signed distances of *all* pairs that count, the far ones
        included; with a horizon never more than that, and inf where no pair counts.
    certified : bool
        Are the answers of all near pairs proven?
    counts : WorldCounts
    """

    __slots__ = ("_groups", "state", "world")

    def __init__(self, world: World, state: WorldState) -> None:
        self.world, self.state = world, state
        self._groups = _groups(state, int(world.search.pieces.first[-1]))

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
        return min(float(bounds.min(initial=math.inf)), self.world.search.reach)

    @property
    def pairs(self) -> PairArrays:
        """All pairs within their horizon."""
        return PairArrays(self, self._groups)

    @property
    def closest(self) -> PairAnswer | None:
        """The nearest pair, or the deepest; None if no pair is within its horizon."""
        if not len(self._groups):
            return None
        distance = self.pairs.distance
        return self.of_row(int(self._groups[int(np.argmin(distance))]))

    @property
    def below_margin(self) -> tuple[PairAnswer, ...]:
        """The pairs that are not proven to keep the margin that they were given."""
        found = []
        rules = self.world.search.rules
        for answer, (i, j) in zip(self.pairs, self.pairs.bodies.tolist(), strict=True):
            margin = rules.margin(i, j)
            if margin > 0.0 and answer.lower_bound < margin:
                found.append(answer)
        return tuple(found)

    def __getitem__(self, names: tuple[str, str]) -> PairAnswer:
        i, j = self._pair(names)
        first, last = min(i, j), max(i, j)
        number = first * len(self.world.bodies) + last
        square = int(self.world.search.pieces.first[-1]) ** 2
        groups = self.state.ints[self._groups, W.I_KEY] // square
        at = int(np.searchsorted(groups, number))
        if at < len(groups) and groups[at] == number:
            return self.of_row(int(self._groups[at]), turned=i > j)
        return self._far(i, j)

    def minima(self, names: tuple[str, str], below: float = math.inf) -> tuple[PairAnswer, ...]:
        """All local minima of two bodies' distance that were kept, nearest first.

        Parameters
        ----------
        names : (str, str)
        below : float, optional
            Only those of less distance than this; the world's ``minima`` says which are kept.
        """
        below = below if below == math.inf else number(below, "below")
        i, j = self._pair(names)
        key = min(i, j) * len(self.world.bodies) + max(i, j)
        square = int(self.world.search.pieces.first[-1]) ** 2
        near = self.state.near
        rows = near[self.state.ints[near, W.I_KEY] // square == key]
        rows = rows[np.argsort(self.state.known[rows, W.C_UPPER], kind="stable")]
        found = (self.of_row(int(row), turned=i > j, alone=True) for row in rows)
        return tuple(answer for answer in found if answer.distance < below)

    def lower_bounds(self, rows: Ints) -> Array:
        """Of pairs of bodies, by the rows of their nearest pieces: over all their pieces."""
        keys = self.state.ints[:, W.I_KEY]
        square = int(self.world.search.pieces.first[-1]) ** 2
        if square == 1 or not len(rows):
            alone: Array = self.state.known[rows, W.C_BOUND]
            return alone
        groups = keys // square
        first = np.searchsorted(groups, groups[rows], "left")
        least = np.minimum.reduceat(
            self.state.known[:, W.C_BOUND], np.unique(np.searchsorted(groups, groups, "left"))
        )
        numbers = np.searchsorted(np.unique(groups), groups[first])
        return least[numbers]

    def of_row(self, row: int, turned: bool = False, alone: bool = False) -> PairAnswer:
        """The answer in a row of the state's table; `turned`: of (B, A). The lower bound is that of
        the bodies, or of the pair of pieces alone."""
        ints = self.state.ints[row]
        p, q = int(ints[W.I_A]), int(ints[W.I_B])
        block = np.array(self.state.block(int(ints[W.I_ROW])))
        if not alone:
            block[K.LOWER_BOUND] = self.lower_bounds(np.array([row]))[0]
        if turned:
            p, q, block = q, p, swapped(block)
        return self._made(p, q, block)

    def _made(self, p: int, q: int, block: Array) -> PairAnswer:
        parts = [self._piece(each) for each in (p, q)]
        names, pieces, bodies, arms = zip(*parts, strict=True)
        return PairAnswer(bodies, block, names, pieces, np.array(arms), self.time)

    def _piece(self, p: int) -> tuple[str, str, Any, Array]:
        """(name of the body, of the piece, the piece, from the body's origin to the piece's)."""
        fixed = self.world.search.pieces
        i = int(fixed.owners[p])
        name, body = self.world.listed[i]
        k = p - int(fixed.first[i])
        piece = list(body.pieces)[k] if isinstance(body, Compound) else ""
        arm = self.state.placed[p, W.P_SHIFT : W.P_SHIFT + 3] - self.state.poses[i, :3, 3]
        return name, piece, pieces_of(body)[k].body, arm

    def _pair(self, names: Any) -> tuple[int, int]:
        """The numbers of two bodies whose pair counts.

        Raises
        ------
        StandoffError
        """
        if not (isinstance(names, tuple) and len(names) == 2):
            raise StandoffTypeError(
                f"{shown(names)}: ask for a pair by two names, answer['a', 'b'].", "names", names
            )
        i, j = (self.world.names.body(name, "pair") for name in names)
        if not self.world.search.rules.counts(i, j):
            raise StandoffError(
                f"The pair {names} does not count in this world: it is ignored, or both are fixed.",
                "names",
                names,
            )
        return i, j

    def _far(self, i: int, j: int) -> PairAnswer:
        """The answer of a pair that is beyond its horizon."""
        search, state = self.world.search, self.state
        bound = kernels.apart_by_boxes(search.pieces[:], state.placed, i, j)
        key = (min(i, j) * len(self.world.bodies) + max(i, j)) * int(search.pieces.first[-1]) ** 2
        end = key + int(search.pieces.first[-1]) ** 2
        first, last = np.searchsorted(state.ints[:, W.I_KEY], [key, end])
        if first < last:
            known = float(state.known[first:last, W.C_BOUND].min())
            # pieces that are in no row are beyond the search's reach
            pieces = np.diff(search.pieces.first[:-1])
            whole = last - first == pieces[i] * pieces[j]
            bound = max(bound, known if whole else min(known, search.reach))
        else:
            bound = max(bound, search.reach)
        p, q = int(search.pieces.first[i]), int(search.pieces.first[j])
        return self._made(p, q, far_block(bound))

    def __repr__(self) -> str:
        return f"<WorldAnswer: {len(self.pairs)} near pairs, clearance {self.clearance:.6g}>"


def _groups(state: WorldState, most: int) -> Ints:
    """Of each near pair of bodies the row of its nearest pieces, by the bodies' numbers."""
    near = state.near
    if most == 1 or not len(near):
        return near
    groups = state.ints[near, W.I_KEY] // most**2
    order = np.lexsort((state.known[near, W.C_UPPER], groups))
    first = np.flatnonzero(np.diff(groups[order], prepend=-1))
    return near[order[first]]
