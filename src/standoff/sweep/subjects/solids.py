"""A sweep of two bodies of which one is a solid that need not be convex."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.motion import Pose
from standoff.scene import Scene
from standoff.solids.answer import SolidProximity
from standoff.sweep.parameters import Parameter, moved
from standoff.sweep.rows import NO_PAIR, Rows
from standoff.sweep.subjects.shapes import digest_of_shape
from standoff.sweep.subjects.subject import Alone, Subject
from standoff.tracking import distance
from standoff.tracking.status import Status
from standoff.world.shapes import Shape

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SolidPair(Subject):
    """The two bodies of a scene's pair, one of them a solid.

    Attributes
    ----------
    scene : Scene
        Seen through the pair.
    shapes : pair of Body or Solid
    homes : pair of Pose
        World poses of A and B where all parameters are zero.
    within : float or None
    """

    scene: Scene
    shapes: tuple[Shape, Shape]
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
        return any(shape.dimension == 2 for shape in self.shapes)

    def check(self) -> None:
        """Refuse a pair that cannot be asked.

        Raises
        ------
        StandoffError
        """
        distance(*self.shapes, *self.homes, within=self.within)

    def _answers(
        self, parameters: Sequence[Parameter], numbers: Array
    ) -> list[tuple[Any, Array, Array]]:
        """Of each row the answer and the two poses (4, 4)."""
        a, b = (
            np.broadcast_to(moved(home, name, parameters, numbers), (len(numbers), 4, 4))
            for home, name in zip(self.homes, self.scene.pair, strict=True)
        )
        return [
            (distance(*self.shapes, one, other, within=self.within), one, other)
            for one, other in zip(a, b, strict=True)
        ]

    def rows(self, parameters: Sequence[Parameter], numbers: Array, first: int) -> Rows:
        return _rows([found for found, _, _ in self._answers(parameters, numbers)], first)

    def alone(self, parameters: Sequence[Parameter], numbers: Array, row: int) -> Alone:
        found, *poses = self._answers(parameters, numbers)[0]
        named = tuple(zip(self.scene.pair, poses, strict=True))
        rows = _rows([found], row)
        nearest = None if found.status is Status.FAR else found
        return Alone(rows, nearest, self.scene.pair, self.shapes, named, {})

    def facts(self) -> dict[str, Any]:
        a, b = map(digest_of_shape, self.shapes)
        return {
            "pair": self.reported(),
            "bodies": {"a_sha256": a, "b_sha256": b},
            "poses": dict(zip("ab", (p.matrix.tolist() for p in self.homes), strict=True)),
        }

    def reported(self) -> dict[str, Any]:
        return dict(zip("ab", self.scene.pair, strict=True))


def _rows(answers: Sequence[SolidProximity], first: int) -> Rows:
    inside = np.array([found.status is Status.CONTAINED for found in answers])
    far = np.array([found.status is Status.FAR for found in answers])
    distances = np.array([found.distance for found in answers])
    # Of a solid inside another's material what is known is of the wall: of the signed distance
    # that it is less, and no bound.
    distances = np.where(inside, -distances, np.where(far, np.nan, distances))
    bounds = np.where(inside, -np.inf, [found.lower_bound for found in answers])
    return Rows(
        np.arange(first, first + len(answers)),
        distances,
        bounds,
        np.array([found.status.value for found in answers], dtype=np.int64),
        np.full(len(answers), NO_PAIR),
    )
