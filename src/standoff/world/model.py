"""What of a world does not change: bodies, rules, and what its frames read."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from standoff.typing import Array, Ints
from standoff.world.broad_phase import BroadPhase
from standoff.world.packed import PackedLaws
from standoff.world.pieces import PieceUnion
from standoff.world.rules import Names
from standoff.world.shapes import Shape
from standoff.world.solid_pairs import SolidPairs


class Model(NamedTuple):
    """A world's data.

    Attributes
    ----------
    key : str
        The mark of this world: its states have the same, and its copies.
    listed : tuple of (str, Body, solid or Compound)
        All bodies with their names, in order.
    names : Names
    moving, fixed : tuple of str
    moving_rows, fixed_rows : arrays
        Their numbers.
    poses_of_fixed : (n, 4, 4) array
    planar : bool
    minima : float
        All minima below it are asked, length; -inf for the nearest alone.
    search : BroadPhase
    laws : PackedLaws
    solids : SolidPairs
    """

    key: str
    listed: tuple[tuple[str, Shape | PieceUnion], ...]
    names: Names
    moving: tuple[str, ...]
    fixed: tuple[str, ...]
    moving_rows: Ints
    fixed_rows: Ints
    poses_of_fixed: Array
    planar: bool
    minima: float
    search: BroadPhase
    laws: PackedLaws
    solids: SolidPairs

    @property
    def most(self) -> int:
        """How many pieces a body has at most."""
        return int(self.search.pieces.first[-1])

    def pair_number(self, i: int, j: int) -> int:
        """The number of a pair of bodies, as in the keys of the table of pairs."""
        return min(i, j) * len(self.listed) + max(i, j)

    def all_poses(self, moving: Array) -> Array:
        """Poses of all bodies, of those that move; a copy."""
        if not self.fixed:
            return moving.copy()
        every = np.empty((len(self.listed), 4, 4))
        every[self.moving_rows], every[self.fixed_rows] = moving, self.poses_of_fixed
        return every
