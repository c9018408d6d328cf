"""A sweep of two convex bodies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from standoff.bodies.body import Body
from standoff.errors import StandoffError
from standoff.kernels.tolerances import FARTHEST, ROTATION
from standoff.motion.rotations import defect
from standoff.sweep.parameters import Parameter
from standoff.sweep.rows import Rows
from standoff.sweep.subjects.scene_pair import ScenePair
from standoff.sweep.subjects.shaped_body import Shaped, answered_shapes, groups
from standoff.sweep.subjects.subject import Alone
from standoff.sweep.tolerances import SOUND_HOME
from standoff.tracking.distance_arrays import Distances
from standoff.tracking.many_distances import answered_rows, fit_poses
from standoff.typing import Array


@dataclass(frozen=True, eq=False)
class ConvexPair(ScenePair):
    """The two convex bodies of a scene's pair.

    Attributes
    ----------
    bodies : pair of Body
        As the scene has them.
    shaped : pair of ShapedBody or None
        What makes the bodies of rows in their place, where parameters change their shapes.
    """

    bodies: tuple[Body, Body]
    shaped: Shaped = (None, None)

    def distances(self, parameters: Sequence[Parameter], numbers: Array) -> Distances:
        """Return the distances of rows of the same shapes.

        Raises StandoffError: rows of several shapes, which no one pair of bodies answers; numbers
        of no body.
        """
        found = list(groups(self.bodies, self.shaped, numbers))
        if len(found) > 1:
            raise StandoffError(
                "These rows have bodies of several shapes, and an answer of many rows is of one "
                "pair of bodies: ask job.answers or job.alone.",
                "job",
            )
        bodies = found[0][1] if found else self.bodies
        a, b = self.poses(parameters, numbers)
        if len(a) == len(b) == 1:  # shapes alone change
            a = np.repeat(a, len(numbers), axis=0)
        return answered_rows(*bodies, a, b, within=self.within)

    def rows(self, parameters: Sequence[Parameter], numbers: Array, first: int) -> Rows:
        poses = self.poses(parameters, numbers)
        if not (self._sound_homes and all(_near(x) for x in poses)):
            poses = fit_poses(*self.bodies, poses)
        try:
            answers, _ = answered_shapes(self.bodies, self.shaped, numbers, poses, self.within)
        except StandoffError as error:
            for k, one in enumerate(numbers):  # to tell the row
                try:
                    list(groups(self.bodies, self.shaped, one[None]))
                except StandoffError as problem:
                    raise StandoffError(f"row {first + k}: {problem}", "job") from error
            raise
        return Rows.of(first, answers)

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
        return Alone(rows, found[0], self.scene.pair, found.bodies, poses, {})

    def facts(self) -> dict[str, Any]:
        shaped = {one.name: one.facts() for one in self.shaped if one is not None}
        return {**super().facts(), **({"shapes": shaped} if shaped else {})}


def _near(poses: Array) -> bool:
    """Are all positions of poses (n, 4, 4) finite, and so near that none is refused?"""
    return bool(np.abs(poses[:, :3, 3]).max() < FARTHEST / 3.0)
