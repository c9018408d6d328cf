"""What sweeps of a scene's pair have in common, whatever its two bodies are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from standoff.motion import Pose
from standoff.scene import Scene
from standoff.sweep.parameters import Parameter, moved
from standoff.sweep.subjects.shapes import digest_of_shape
from standoff.sweep.subjects.subject import Subject
from standoff.typing import Array
from standoff.world.shapes import Shape


@dataclass(frozen=True, eq=False)
class ScenePair(Subject):
    """The two bodies of a scene's pair.

    Attributes
    ----------
    scene : Scene
        Seen through the pair.
    bodies : pair of Body or Solid
    homes : pair of Pose
        World poses of A and B where all parameters are zero.
    within : float or None
    """

    scene: Scene
    bodies: tuple[Shape, Shape]
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

    def facts(self) -> dict[str, Any]:
        a, b = map(digest_of_shape, self.bodies)
        return {
            "pair": self.reported(),
            "bodies": {"a_sha256": a, "b_sha256": b},
            "poses": dict(zip("ab", (p.matrix.tolist() for p in self.homes), strict=True)),
        }

    def reported(self) -> dict[str, Any]:
        return dict(zip("ab", self.scene.pair, strict=True))
