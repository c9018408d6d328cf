"""What of a robot does not depend on its configuration, and where its geometries are."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import combinations
from typing import Any

import numpy as np

from standoff.checks.numbers import positive
from standoff.errors import StandoffError
from standoff.read_only import KeepsReadOnly
from standoff.robots.geoms import Geoms
from standoff.robots.joints import Joints
from standoff.robots.kinematics import Kinematics
from standoff.robots.loaded import Loaded
from standoff.robots.obstacles import Obstacles, with_obstacles
from standoff.robots.report import STILL, RobotReport, of_obstacles
from standoff.robots.rows import Mounted, RobotRows
from standoff.robots.tolerances import FIRST_HORIZON, WIDER
from standoff.shown_names import hides
from standoff.typing import Array, Ints
from standoff.wording import counted
from standoff.world import World
from standoff.world.packed import pieces_of


@hides("loaded", "nearest_rows")
class RobotModel(KeepsReadOnly):
    """Joints, geometries, pairs and obstacles of a `Robot`; see there."""

    def __init__(self, loaded: Loaded, *, within: float | None, obstacles: Obstacles) -> None:
        self.loaded = loaded
        self.within = math.inf if within is None else positive(within, "within", infinite=True)
        self.obstacles = obstacles
        self.kinematics: Kinematics = loaded.kinematics
        self.joints: Joints = loaded.joints
        self.geoms: Geoms = with_obstacles(loaded.geoms, obstacles)
        own = len(loaded.geoms.names)
        self._horizons = Horizons(self.geoms, loaded.pairs, own, self.within)
        support = np.zeros((len(self.geoms.names), self.kinematics.support.shape[1]))
        support[self.geoms.moving] = self.kinematics.support
        self._mounted = Mounted(
            self.geoms.links, support, self.kinematics.fold, self._horizons.size()
        )

    @property
    def nq(self) -> int:
        return self.kinematics.nq

    @property
    def nv(self) -> int:
        return self.kinematics.nv

    @property
    def lower(self) -> Array:
        return self.joints.lower

    @property
    def upper(self) -> Array:
        return self.joints.upper

    @property
    def world(self) -> World:
        return self._horizons.world(self.within)

    @property
    def pairs(self) -> list[tuple[str, str]]:
        names = self.geoms.names
        return [(names[i], names[j]) for i, j in self._horizons.pairs.tolist()]

    def report(self) -> RobotReport:
        """What became of every geometry, which pairs are watched, and why others are not."""
        names = self.geoms.names
        watched = set(map(tuple, self._horizons.pairs.tolist()))
        reasons = self.loaded.left_out
        overlapping: list[tuple[str, str]] = []
        if watched:
            rows = self._rows(self.kinematics.check(self.kinematics.neutral()), self.world)
            overlapping = [rows.names[k] for k in np.flatnonzero(rows.distance < 0.0).tolist()]
        return RobotReport(
            self.loaded.source,
            self.joints.names,
            self.loaded.reports + of_obstacles(self.obstacles),
            tuple(self.pairs),
            tuple(
                (names[i], names[j], reasons.get((i, j), STILL))
                for i, j in combinations(range(len(names)), 2)
                if (i, j) not in watched
            ),
            tuple(overlapping),
            self.loaded.notes,
        )

    def outside(self, q: Any) -> tuple[str, ...]:
        """Names of the joints that a configuration (nq,) has outside their limits."""
        q = self.kinematics.check(q)
        wrong = np.flatnonzero((q < self.lower) | (q > self.upper))
        owners = (self.joints.owner(i) for i in wrong.tolist())
        return tuple(dict.fromkeys(self.joints.names[j] for j in owners))

    def poses(self, q: Any) -> Array:
        """(n, 4, 4) world poses of all geometries, in the order of ``geoms``."""
        found = np.array(self.geoms.placements)
        found[self.geoms.moving] = self.kinematics.poses(self.kinematics.check(q))
        return found

    def nearest_rows(self, q: Array) -> RobotRows:
        """All pairs within the first of wider and wider horizons that has any, at a configuration
        that is checked.

        Raises StandoffError: there is no pair.
        """
        motion = self.kinematics.motion(q)
        for world in self._horizons.widening(self.within):
            answer = world.distances(motion.poses)
            if len(answer.pairs):
                return RobotRows(answer, q, motion, self._mounted, world.within)
        raise StandoffError(f"No pair of {self.loaded.source} was found.")

    def _rows(self, q: Array, world: World) -> RobotRows:
        motion = self.kinematics.motion(q)
        return RobotRows(world.distances(motion.poses), q, motion, self._mounted, world.within)

    def __repr__(self) -> str:
        pairs = counted(len(self._horizons.pairs), "pair")
        return f"<Robot of {self.loaded.source}: nq {self.nq}, nv {self.nv}, {pairs}>"


# A robot's bodies as worlds: one for each horizon that is asked for.

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
