"""A sweep of all pairs of a scene that count."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from standoff.motion import Pose
from standoff.scene import Scene
from standoff.sweep.parameters import Parameter, moved
from standoff.sweep.rows import Rows
from standoff.sweep.subjects.nearest import drawn_answer, names_of, nearest_of, rows_of
from standoff.sweep.subjects.shapes import digest_of_shape
from standoff.sweep.subjects.subject import Alone, Subject
from standoff.typing import Array
from standoff.wording import counted
from standoff.world import World
from standoff.world.answer import WorldAnswer


@dataclass(frozen=True, eq=False)
class SceneWorld(Subject):
    """The bodies of a scene, and its pairs that count.

    Attributes
    ----------
    scene : Scene
    world : World
        With the horizon.
    homes : tuple of Pose
        World poses of its moving bodies, in its order, where all parameters are zero.
    within : float or None
        Of the job, or of the scene's ``[world]``.
    """

    scene: Scene
    world: World
    homes: tuple[Pose, ...]
    within: float | None

    @property
    def length_unit(self) -> str:
        return self.scene.length_unit

    @property
    def name(self) -> str:
        return f"a world of {counted(len(self.world), 'body', 'bodies')}"

    @property
    def movable(self) -> tuple[str, ...]:
        return self.world.moving

    @property
    def planar(self) -> bool:
        return self.world.dimension == 2

    def poses(self, parameters: Sequence[Parameter], numbers: Array) -> Array:
        """Return the world poses (n, m, 4, 4) of the m moving bodies in n rows."""
        found = np.empty((len(numbers), len(self.homes), 4, 4))
        for k, (name, home) in enumerate(zip(self.world.moving, self.homes, strict=True)):
            found[:, k] = moved(home, name, parameters, numbers)
        return found

    def _answers(self, poses: Array) -> Iterator[WorldAnswer]:
        return (self.world.distances(frame) for frame in poses)

    def rows(self, parameters: Sequence[Parameter], numbers: Array, first: int) -> Rows:
        return rows_of(self._answers(self.poses(parameters, numbers)), first)

    def alone(self, parameters: Sequence[Parameter], numbers: Array, row: int) -> Alone:
        poses = self.poses(parameters, numbers)
        answer = next(self._answers(poses))
        every = dict(zip(self.world.moving, poses[0], strict=True))
        every |= {name: pose.matrix for name, pose in self.world.fixed_poses.items()}
        rows, nearest = rows_of([answer], row), nearest_of(answer)
        if nearest is None:
            named = tuple((name, every[name]) for name in self.world.moving)
            return Alone(rows, None, ("", ""), (None, None), named, {})
        shown = drawn_answer(self.world, nearest)
        named = tuple((name, every[name]) for name in nearest.names)
        return Alone(rows, shown, nearest.names, nearest.bodies, named, {})

    def facts(self) -> dict[str, Any]:
        poses = dict(zip(self.world.moving, self.homes, strict=True)) | self.world.fixed_poses
        return {
            "world": {
                "bodies": {name: digest_of_shape(x) for name, x in self.world.bodies.items()},
                "poses": {name: pose.matrix.tolist() for name, pose in poses.items()},
                "fixed": list(self.world.fixed),
                "pairs": [[a, b, self.world.margin(a, b)] for a, b in self.world.pairs()],
                "law": repr(self.world.law),
            }
        }

    def reported(self) -> dict[str, Any]:
        return {"bodies": list(self.world.bodies)}

    def pair_names(self, number: int) -> tuple[str, str] | None:
        return names_of(list(self.world.bodies), number)
