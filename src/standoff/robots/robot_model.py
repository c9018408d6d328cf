"""What of a robot does not depend on its configuration, and where its geometries are."""

from __future__ import annotations

import math
from itertools import combinations
from typing import Any

import numpy as np

from standoff.checks.numbers import positive
from standoff.errors import StandoffError
from standoff.read_only import KeepsReadOnly
from standoff.robots.geoms import Geoms
from standoff.robots.horizons import Horizons
from standoff.robots.joints import Joints
from standoff.robots.kinematics import Kinematics
from standoff.robots.loaded import Loaded
from standoff.robots.obstacles import Obstacles, with_obstacles
from standoff.robots.report import STILL, RobotReport, of_obstacles
from standoff.robots.rows import Mounted, RobotRows
from standoff.shown_names import hides
from standoff.typing import Array
from standoff.wording import counted
from standoff.world import World


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
