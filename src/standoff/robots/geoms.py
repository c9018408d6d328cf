"""The collision geometries of a robot as bodies of a world, and the links that carry them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from standoff.typing import Array, Ints
from standoff.world import Compound
from standoff.world.shapes import Shape

WORLD = -1
"""The joint of what is fixed in the world."""


class Geoms(NamedTuple):
    """Geometries in the order of the robot's world; those fixed in the world have no joint.

    Attributes
    ----------
    names : tuple of str
        As in the model; "link/k" for the k-th unnamed one of a link.
    links : tuple of str
        The link of each.
    joints : (n,) array
        The joint, of `Joints`, in whose moved frame each is fixed; -1 for the world.
    placements : (n, 4, 4) array
        The body's frame in that frame.
    bodies : tuple of Body, Solid or Compound
    """

    names: tuple[str, ...]
    links: tuple[str, ...]
    joints: Ints
    placements: Array
    bodies: tuple[Shape | Compound, ...]

    @property
    def moving(self) -> Ints:
        """Numbers of those that move, in their order."""
        return np.flatnonzero(self.joints >= 0)
