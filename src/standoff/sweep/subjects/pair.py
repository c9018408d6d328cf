"""A sweep of two convex bodies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.kernels.tolerances import FARTHEST, ROTATION
from standoff.motion import Pose
from standoff.motion.rotations import defect
from standoff.scene import Scene
from standoff.sweep.parameters import Parameter, moved
from standoff.sweep.rows import Rows
from standoff.sweep.subjects.subject import Alone, Subject
from standoff.sweep.tolerances import SOUND_HOME
from standoff.tracking.many_distances import Distances, answered_rows, rows_at_made_poses

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ConvexPair(Subject):
    """The two convex bodies of a scene's pair.

    Attributes
    ----------
    scene : Scene
        Seen through the pair.
    bodies : pair of Body
    homes : pair of Pose
        World poses of A and B where all parameters are zero.
    within : float or None
    """

    scene: Scene
    bodies: tuple[Body, Body]
    homes: tuple[Pose, Pose]
    within: float | None

    @property
    def length_unit(self) -> str:
        return self.scene.length_unit

    @property
    def name(self) -> str:
        return " and ".join(self.scene.pair)

    @property
    def movable(self) -> tuple[str, ...]:
        return self.scene.pair

    @property
    def planar(self) -> bool:
        return any(body.dimension == 2 for body in self.bodies)

    def poses(self, parameters: Sequence[Parameter], numbers: Array) -> tuple[Array, Array]:
        """Return the world poses of A and B, (n, 4, 4) each, or (1, 4, 4) where none moves it."""
        a, b = (
            moved(home, body, parameters, numbers)
            for home, body in zip(self.homes, self.scene.pair, strict=True)
        )
        return a, b

    def distances(self, parameters: Sequence[Parameter], numbers: Array) -> Distances:
        """Return the distances of rows."""
        return answered_rows(*self.bodies, *self.poses(parameters, numbers), within=self.within)

    def rows(self, parameters: Sequence[Parameter], numbers: Array, first: int) -> Rows:
        poses = self.poses(parameters, numbers)
        if self._sound_homes and all(_near(x) for x in poses):
            return Rows.of(first, rows_at_made_poses(*self.bodies, poses, self.within))
        return Rows.of(first, self.distances(parameters, numbers).rows)

    @cached_property
    def _sound_homes(self) -> bool:
        """Are the poses that are made of them rotations, so that none is to be repaired?

        Of planar bodies their tilt is looked at as well: they are left to `distances`.
        """
        off = max(float(defect(pose.rotation)) for pose in self.homes)
        return not self.planar and off <= SOUND_HOME * ROTATION

    def alone(self, parameters: Sequence[Parameter], numbers: Array, row: int) -> Alone:
        found = self.distances(parameters, numbers)
        poses = tuple(zip(self.scene.pair, (x[0] for x in found.poses), strict=True))
        rows = Rows.of(row, found.rows)
        return Alone(rows, found[0], self.scene.pair, self.bodies, poses, {})

    def facts(self) -> dict[str, Any]:
        return {
            "pair": self.reported(),
            "bodies": {"a_sha256": self.bodies[0].digest, "b_sha256": self.bodies[1].digest},
            "poses": dict(zip("ab", (p.matrix.tolist() for p in self.homes), strict=True)),
        }

    def reported(self) -> dict[str, Any]:
        return dict(zip("ab", self.scene.pair, strict=True))


def _near(poses: Array) -> bool:
    """Are all positions of poses (n, 4, 4) finite, and so near that none is refused?"""
    return bool(np.abs(poses[:, :3, 3]).max() < FARTHEST / 3.0)
