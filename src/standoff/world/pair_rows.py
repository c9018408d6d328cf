"""The pairs of a world in one frame, by their rows in the state's table."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from standoff.kernels.state import arrays as K
from standoff.kernels.world import arrays as W
from standoff.motion.vectors import pose_row
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array, Ints
from standoff.world.model import Model
from standoff.world.packed import pieces_of
from standoff.world.pair_answer import PairAnswer, far_block, gradient_of_bodies, swapped
from standoff.world.pieces import PieceUnion
from standoff.world.state import WorldState

if TYPE_CHECKING:
    from standoff.solids.answer import SolidProximity
    from standoff.world.solid_answer import SolidPairAnswer


class PairRows(KeepsReadOnly):
    """A state with its world's data: answers of single rows, and bounds over all pieces.

    Attributes
    ----------
    model : Model
    state : WorldState
    nearest : (n,) array
        Of each near pair of bodies the row of its nearest pieces, by the bodies' numbers.
    """

    __slots__ = ("_keys", "_least", "_numbers", "model", "nearest", "state")

    def __init__(self, model: Model, state: WorldState) -> None:
        self.model, self.state = model, state
        self.nearest = _nearest(state, model.most)
        self._keys: Ints | None = None
        self._numbers: Ints | None = None
        self._least: tuple[Ints, Array] | None = None

    @property
    def keys(self) -> Ints:
        """(m,) of all pairs in the state's table, sorted: contiguous, to be searched often."""
        if self._keys is None:
            self._keys = np.ascontiguousarray(self.state.ints[:, W.I_KEY])
        return self._keys

    @property
    def numbers(self) -> Ints:
        """The numbers of the near pairs of bodies, sorted."""
        if self._numbers is None:
            self._numbers = self.groups(self.nearest)
        return self._numbers

    def groups(self, rows: Ints) -> Ints:
        """The numbers of the pairs of bodies in some rows."""
        found: Ints = self.state.ints[rows, W.I_KEY] // self.model.most**2
        return found

    def lower_bounds(self, rows: Ints) -> Array:
        """Of the pairs of bodies in some rows: over all their pieces."""
        bounds: Array = self.state.known[:, W.C_BOUND]
        if self.model.most == 1 or not len(rows):
            return np.asarray(bounds[rows])
        if self._least is None:
            groups = self.keys // self.model.most**2
            first = np.flatnonzero(np.diff(groups, prepend=-1))
            self._least = groups[first], np.minimum.reduceat(bounds, first)
        numbers, least = self._least
        return np.asarray(least[np.searchsorted(numbers, self.groups(rows))])

    def answer(
        self, row: int, turned: bool = False, alone: bool = False
    ) -> PairAnswer | SolidPairAnswer:
        """The answer in a row; `turned`: of (B, A). The lower bound is that of the bodies, or of
        the pair of pieces alone."""
        ints = self.state.ints[row]
        p, q = int(ints[W.I_A]), int(ints[W.I_B])
        key = int(ints[W.I_KEY])
        if key in self.state.solids.pieces:
            group = key // self.model.most**2
            found = self._alone(key, p, q) if alone else self.state.solids.bodies[group]
            return self._solid(found, (p, q), turned)
        block = np.array(self.state.block(int(ints[W.I_ROW]))[: K.N_BLOCK])
        block[K.BLOCK_POLYTOPE] = 0.0  # that is the next frame's
        if not alone:
            block[K.LOWER_BOUND] = self.lower_bounds(np.array([row]))[0]
        if turned:
            p, q, block = q, p, swapped(block)
        return self._made(p, q, block)

    def far(self, i: int, j: int, bound: float) -> PairAnswer | SolidPairAnswer:
        """The answer of a pair of bodies of which only a bound is known."""
        first = self.model.search.pieces.first
        if self.model.solids.bodies[[i, j]].any():
            from standoff.world.solid_answer import beyond

            pieces = int(first[i]), int(first[j])
            return self._solid(beyond(bound, self._poses(i, j)), pieces, False)
        return self._made(int(first[i]), int(first[j]), far_block(bound))

    def _solid(
        self, found: SolidProximity, pieces: tuple[int, int], turned: bool
    ) -> SolidPairAnswer:
        """An answer of solids with the names of the bodies of two pieces."""
        from standoff.world.solid_answer import named_answer

        owners = self.model.search.pieces.owners
        listed = [self.model.listed[owners[p]] for p in pieces]
        bodies = []
        for (_, body), piece in zip(listed, found.pieces, strict=True):
            whole = not isinstance(body, PieceUnion)
            bodies.append(body if whole else body.pieces[piece].body if piece else body)
        names = [name for name, _ in listed]
        if turned:
            names, bodies = names[::-1], bodies[::-1]
        one, other = names
        return named_answer(found, (one, other), (*bodies,), self.state.time, turned)

    def _alone(self, key: int, p: int, q: int) -> SolidProximity:
        """The answer of two pieces, by the motions of their bodies."""
        found = self.state.solids.pieces[key]
        owners = self.model.search.pieces.owners
        _, pieces, _, arms = zip(*(self._piece(each) for each in (p, q)), strict=True)
        return replace(
            found,
            pieces=pieces,
            minima=tuple(pair._replace(pieces=pieces) for pair in found.minima),
            gradient_rows=gradient_of_bodies(found.gradient_rows, np.array(arms)),
            poses=self._poses(int(owners[p]), int(owners[q])),
        )

    def _poses(self, i: int, j: int) -> tuple[Array, Array]:
        """World poses (12,) of two bodies."""
        a, b = (pose_row(self.state.poses[k, :3, :3], self.state.poses[k, :3, 3]) for k in (i, j))
        return a, b

    def _made(self, p: int, q: int, block: Array) -> PairAnswer:
        names, pieces, bodies, arms = zip(*(self._piece(each) for each in (p, q)), strict=True)
        return PairAnswer(bodies, block, names, pieces, np.array(arms), self.state.time)

    def _piece(self, p: int) -> tuple[str, str, Any, Array]:
        """(name of the body, of the piece, the piece, from the body's origin to the piece's)."""
        fixed = self.model.search.pieces
        i = int(fixed.owners[p])
        name, body = self.model.listed[i]
        k = p - int(fixed.first[i])
        piece = list(body.pieces)[k] if isinstance(body, PieceUnion) else ""
        arm = self.state.placed[p, W.P_SHIFT : W.P_SHIFT + 3] - self.state.poses[i, :3, 3]
        return name, piece, pieces_of(body)[k].body, arm


def _nearest(state: WorldState, most: int) -> Ints:
    near = state.near
    if most == 1 or not len(near):
        return near
    groups = state.ints[near, W.I_KEY] // most**2
    order = np.lexsort((state.known[near, W.C_UPPER], groups))
    first = np.flatnonzero(np.diff(groups[order], prepend=-1))
    return np.asarray(near[order[first]], dtype=np.int64)
