"""A robot's bodies as worlds: one for each horizon that is asked for."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from standoff.read_only import KeepsReadOnly
from standoff.robots.geoms import Geoms
from standoff.robots.tolerances import FIRST_HORIZON, WIDER
from standoff.typing import Ints
from standoff.world import World
from standoff.world.packed import pieces_of

KEPT = 16
"""Worlds that are kept beside that of the robot's own horizon: those made last."""


class Horizons(KeepsReadOnly):
    """Worlds of the same bodies and pairs.

    Attributes
    ----------
    pairs : (k, 2) array
        Numbers i < j of all pairs that are watched.
    """

    def __init__(
        self, geoms: Geoms, watched: frozenset[tuple[int, int]], own: int, within: float
    ) -> None:
        """`own`: how many of the geometries are the model's; the rest are obstacles. `within`: the
        robot's own horizon."""
        n = len(geoms.names)
        still = geoms.joints < 0
        counts = np.zeros((n, n), dtype=bool)
        for i, j in watched:
            counts[i, j] = True
        counts[:own, own:] = True
        counts &= ~np.outer(still, still)
        self._geoms, self._counts = geoms, counts
        self.pairs: Ints = np.argwhere(counts)
        self._within, self._worlds = within, dict[float, World]()

    def world(self, within: float) -> World:
        """The world with a horizon, length; made once."""
        found = self._worlds.get(within)
        if found is None:
            # threads may ask at once, as those of `clearances`: the first that is made is kept
            found = self._worlds.setdefault(within, self._made(within))
            # states belong to the world of the robot's own horizon: that one stays
            others = [horizon for horizon in list(self._worlds) if horizon != self._within]
            for horizon in others[:-KEPT]:
                self._worlds.pop(horizon, None)
        return found

    def widening(self, first: float) -> Iterator[World]:
        """Worlds with wider and wider horizons, the last without one; `first` or infinity."""
        horizon = first if first < math.inf else FIRST_HORIZON * self.size()
        for _ in range(3):
            yield self.world(horizon)
            horizon *= WIDER
        yield self.world(math.inf)

    def size(self) -> float:
        """Of all bounded bodies together, length."""
        pieces = [piece for body in self._geoms.bodies for piece in pieces_of(body)]
        sizes = [piece.body.size for piece in pieces if piece.body.bounded]
        return max(float(np.sqrt(np.square(sizes).sum())), np.finfo(float).tiny)

    def _made(self, within: float) -> World:
        geoms = self._geoms
        names, still = geoms.names, geoms.joints < 0
        watched = self._counts | self._counts.T
        among = np.argwhere(np.triu(~watched, 1) & ~np.outer(still, still))
        return World(
            dict(zip(names, geoms.bodies, strict=True)),
            within=None if within == math.inf else within,
            fixed={names[k]: geoms.placements[k] for k in np.flatnonzero(still)},
            ignore=[(names[i], names[j]) for i, j in among.tolist()],
        )
