"""What a world carries from frame to frame, as a value."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.state import arrays as K
from standoff.kernels.world import arrays as W
from standoff.read_only import KeepsReadOnly

if TYPE_CHECKING:
    from standoff.solids.answer import SolidProximity
from standoff.solids.tracked.front import KeptFront
from standoff.typing import Array, Ints

PAGE = 32
"""Bits of a row's number within its page; the page's number stands above them."""
IN_PAGE = (1 << PAGE) - 1


class PaddedTree(NamedTuple):
    """Padded boxes of the pieces, and the tree over them (``kernels.world.tree``)."""

    boxes: Array
    nodes: Array
    order: Ints
    leaf: Ints
    n_filled: int
    refits: int  # since its leaves were put in order

    @property
    def arrays(self) -> tuple[Array, Ints, Ints]:
        """As the kernels read it."""
        return self.nodes, self.order, self.leaf


class WorldCounts(NamedTuple):
    """What a frame took.

    Attributes
    ----------
    open : int
        Pairs of pieces whose tracker's state is kept; of bodies with a solid, pairs of bodies whose
        answer is.
    tracked : int
        Pairs that went on from it in this frame.
    started : int
        Pairs that were asked by a cold query.
    resting : int
        Pairs whose bodies were where they were, and whose answer still holds.
    bounded : int
        Pairs of pieces in the table of which a bound was enough.
    sought : int
        Pieces that had left their padded boxes: their pairs were found anew.
    uncertified : int
        Answers of near pairs that are not proven.
    """

    open: int
    tracked: int
    started: int
    resting: int
    bounded: int
    sought: int
    uncertified: int


class KeptSolids(NamedTuple):
    """Of the near pairs with a solid.

    Attributes
    ----------
    pieces : mapping of int to SolidProximity
        Of pairs of pieces, by their keys in the table.
    bodies : mapping of int to SolidProximity
        Of pairs of bodies, by their numbers.
    fronts : mapping of int to Front
        Of pairs of pieces that were near in two frames: what their trackers go on from.
    """

    pieces: Mapping[int, SolidProximity]
    bodies: Mapping[int, SolidProximity]
    fronts: Mapping[int, KeptFront]


NO_SOLIDS = KeptSolids({}, {}, {})


class WorldState(KeepsReadOnly):
    """The warm start of a world, as a value: goes into a step and comes out of it, never changed.

    Attributes
    ----------
    time : float
        Since ``start``, s.
    poses : (n, 4, 4) array
        World poses of all bodies at its frame, in the world's order.
    counts : WorldCounts
        What the frame took.
    repaired : int
        How many poses had a rounded rotation and were replaced by the nearest one.
    nbytes : int
        Of the memory that it holds.
    """

    __slots__ = (
        "counts",
        "frame",
        "has_twist",
        "ints",
        "key",
        "known",
        "near",
        "pages",
        "placed",
        "poses",
        "repaired",
        "solids",
        "time",
        "tree",
    )

    def __init__(self, key: str, **parts: Any) -> None:
        self.key = key
        for name in self.__slots__:
            if name != "key":
                setattr(self, name, parts[name])
        own = self.poses, self.placed, self.ints, self.known, self.near
        for array in (*own, self.tree.boxes, *self.tree.arrays, *self.pages):
            array.flags.writeable = False

    key: str
    time: float
    frame: int
    has_twist: bool
    poses: Array
    placed: Array
    tree: PaddedTree
    ints: Ints
    known: Array
    near: Ints
    pages: tuple[Array, ...]
    counts: WorldCounts
    repaired: int
    solids: KeptSolids

    @property
    def nbytes(self) -> int:
        arrays = [self.poses, self.placed, self.ints, self.known, self.near, *self.pages]
        return sum(array.nbytes for array in [*arrays, *self.tree[:4]])

    def block(self, row: int) -> Array:
        """The block of a kept row, by its number."""
        found: Array = self.pages[row >> PAGE][row & IN_PAGE]
        return found

    def column(self, pairs: Ints, slots: Any) -> Array:
        """Numbers of the answers of some pairs in the table, (k, ...): gathered from the pages."""
        rows = self.ints[pairs, W.I_ROW]
        at, within = rows >> PAGE, rows & IN_PAGE
        first = np.arange(K.N_OUT)[slots]
        found = np.empty((len(rows), *np.shape(first)))
        for number, page in enumerate(self.pages):
            here = at == number
            if here.any():
                found[here] = page[within[here]][:, first]
        return found

    def __repr__(self) -> str:
        return f"<WorldState at {self.time:.6g} s: {self.counts.open} pairs open>"


def check_key(state: Any, key: str) -> None:
    """Refuse what is not a state of the world with a mark.

    Raises TypeError, ValueError.
    """
    if not isinstance(state, WorldState):
        raise StandoffTypeError(
            f"{shown(state)} is not a WorldState: get one from world.start.", "state", state
        )
    if state.key != key:
        raise StandoffError(
            "The state belongs to another world: begin with world.start.", "state", state
        )
