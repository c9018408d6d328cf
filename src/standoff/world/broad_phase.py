"""Which pairs of pieces may be within the horizon: boxes, their tree, and the table of pairs.

While every piece stays in its padded box, the table misses no pair: two pieces that are not in it
have padded boxes beyond the horizon. A piece that leaves its box gets another, and its pairs are
found anew (docs/worlds.md).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from standoff.kernels.entries import world as kernels
from standoff.kernels.world import arrays as W
from standoff.kernels.world.tree import MOST_REFITS, N_BOX, SOUGHT_PART
from standoff.typing import Array, Ints
from standoff.world.packed import PackedPieces
from standoff.world.rules import Rules
from standoff.world.state import PaddedTree

FIRST_ROOM = 1024
"""Pairs that a search has room for at first."""


class PlacedPieces(NamedTuple):
    """Where the pieces are in a frame, as the kernels read it.

    Attributes
    ----------
    placed : (n, N_PLACED) array
    sought : (n,) array
        1 where a piece has left its padded box.
    still : (n,) array
        1 where a piece is where it was, to the last bit.
    """

    placed: Array
    sought: Ints
    still: Ints


class PairTable(NamedTuple):
    """Pairs of pieces, sorted: integers (n, N_INTS) and numbers (n, N_KNOWN)."""

    ints: Ints
    known: Array


class BroadPhase(NamedTuple):
    """What a world's search needs that does not change."""

    pieces: PackedPieces
    rules: Rules
    within: float
    reach: float  # the greatest horizon of any pair

    @property
    def everything(self) -> bool:
        """Is there no horizon, so that all pairs are in the table?"""
        return self.reach == math.inf


def empty_placed(n: int) -> PlacedPieces:
    """Before the first frame: nothing is still, and travel begins at 0."""
    placed = np.full((n, W.N_PLACED), np.nan)
    placed[:, W.P_TRAVEL] = 0.0
    return PlacedPieces(placed, np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.int64))


def place(
    search: BroadPhase, poses: Array, tree: PaddedTree, before: Array
) -> tuple[PlacedPieces, int, int, int]:
    """Where the pieces are, the first body whose pose is none (-1: all are poses), how many pieces
    have left their padded boxes, and how many are still."""
    n = len(search.pieces.owners)
    frame = PlacedPieces(np.empty((n, W.N_PLACED)), *np.empty((2, n), dtype=np.int64))
    bad, left, still = kernels.place(search.pieces[:], poses, tree.boxes, before, frame[:])
    return frame, bad, left, still


def first_tree(search: BroadPhase, frame: PlacedPieces) -> PaddedTree:
    """The tree of the first frame: every piece has its box and place."""
    n = len(search.pieces.owners)
    tree = _unordered(search, np.empty((n, N_BOX)))
    frame.sought[:] = 1
    kernels.pad(search.pieces[:], frame[:], tree.boxes, np.zeros(n), tree.arrays, 0)
    return _ordered(search, frame, tree)


def _unordered(search: BroadPhase, boxes: Array) -> PaddedTree:
    """Boxes of all pieces, in no leaves yet."""
    filled = int(np.count_nonzero(search.pieces.planes == 0))
    leaves = 1 << max(0, (filled - 1).bit_length()) if filled else 1
    order, leaf = np.zeros(max(filled, 1), dtype=np.int64), np.full(len(boxes), -1)
    return PaddedTree(boxes, np.empty((2 * leaves, N_BOX)), order, leaf, filled, 0)


def pairs_of_boxes(search: BroadPhase, boxes: Array, reach: float) -> Ints:
    """The pairs of pieces (m, 2) that count and whose boxes (n, 6) come within `reach` (length) of
    each other; of a half-space all of its pairs. That of the body of lesser number stands first."""
    frame = empty_placed(len(boxes))
    tree = _ordered(search, frame, _unordered(search, boxes))
    frame.sought[:] = 1
    found = _found(search._replace(reach=reach), frame, tree)
    return found[:, [W.E_A, W.E_B]]


def _ordered(search: BroadPhase, frame: PlacedPieces, tree: PaddedTree) -> PaddedTree:
    """The same boxes in leaves in the order of their Morton codes, their tree made anew."""
    bounded = np.flatnonzero(search.pieces.planes == 0)
    if not len(bounded):
        return tree
    codes = np.empty(len(bounded), dtype=np.int64)
    kernels.codes(np.ascontiguousarray(tree.boxes[bounded]), codes)
    order = bounded[np.argsort(codes, kind="stable")]
    leaf = tree.leaf.copy()
    leaf[order] = np.arange(len(order))
    leaves = len(tree.nodes) // 2
    nodes = np.empty_like(tree.nodes)
    nodes[leaves : leaves + len(order)] = tree.boxes[order]
    made = PaddedTree(tree.boxes, nodes, order, leaf, tree.n_filled, 0)
    none = PlacedPieces(frame.placed, np.zeros_like(frame.sought), frame.still)
    kernels.pad(
        search.pieces[:], none[:], made.boxes, np.zeros(len(leaf)), made.arrays, tree.n_filled
    )
    return made


def repadded(
    search: BroadPhase, frame: PlacedPieces, tree: PaddedTree, before: Array, left: int
) -> PaddedTree:
    """New padded boxes for the pieces that have left theirs, and the tree of all."""
    ways = frame.placed[:, W.P_TRAVEL] - before[:, W.P_TRAVEL]
    boxes = tree.boxes.copy()
    if left > SOUGHT_PART * len(boxes) or tree.refits >= MOST_REFITS:
        none = np.empty((2, N_BOX)), tree.order, tree.leaf
        kernels.pad(search.pieces[:], frame[:], boxes, ways, none, 0)
        return _ordered(search, frame, tree._replace(boxes=boxes))
    made = tree._replace(boxes=boxes, nodes=tree.nodes.copy(), refits=tree.refits + 1)
    kernels.pad(search.pieces[:], frame[:], boxes, ways, made.arrays, tree.n_filled)
    return made


def table_of(
    search: BroadPhase, frame: PlacedPieces, tree: PaddedTree, old: PairTable
) -> PairTable:
    """The pairs after the pieces that are sought have found theirs."""
    found = _found(search, frame, tree)
    room = len(old.ints) + len(found)
    ints, known = np.empty((room, W.N_INTS), dtype=np.int64), np.empty((room, W.N_KNOWN))
    numbers = found[:, W.E_KEY] // int(search.pieces.first[-1]) ** 2
    margins = numbers, search.rules.margins_of(numbers)
    n = kernels.merged(
        search.pieces[:], frame[:], old[:], found, margins, search.within, (ints, known)
    )
    return PairTable(ints[:n].copy(), known[:n].copy())


def _found(search: BroadPhase, frame: PlacedPieces, tree: PaddedTree) -> Ints:
    """What the search finds, sorted."""
    rules, room = search.rules[:3], FIRST_ROOM
    while True:
        found = np.empty((room, W.N_EMIT), dtype=np.int64)
        if search.everything:
            n = kernels.all_pairs(search.pieces[:], frame[:], rules, found)
        else:
            n = kernels.seek(
                search.pieces[:],
                frame[:],
                tree.boxes,
                tree.arrays,
                tree.n_filled,
                rules,
                search.reach,
                found,
            )
        if n <= room:
            found = found[:n]
            return np.ascontiguousarray(found[np.argsort(found[:, W.E_KEY], kind="stable")])
        room = n
