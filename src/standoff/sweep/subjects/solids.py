"""A sweep of two bodies of which one is a solid that need not be convex."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from standoff.solids.answer import SolidProximity
from standoff.sweep.parameters import Parameter
from standoff.sweep.rows import NO_PAIR, Rows
from standoff.sweep.subjects.scene_pair import ScenePair
from standoff.sweep.subjects.subject import Alone
from standoff.tracking import distance
from standoff.tracking.status import Status
from standoff.typing import Array


@dataclass(frozen=True, eq=False)
class SolidPair(ScenePair):
    """The two bodies of a scene's pair, one of them a solid."""

    def check(self) -> None:
        """Refuse a pair that cannot be asked.

        Raises StandoffError.
        """
        distance(*self.bodies, *self.homes, within=self.within)

    def _answers(
        self, parameters: Sequence[Parameter], numbers: Array
    ) -> list[tuple[Any, Array, Array]]:
        """Of each row the answer and the two poses (4, 4)."""
        a, b = (
            np.broadcast_to(poses, (len(numbers), 4, 4))
            for poses in self.poses(parameters, numbers)
        )
        return [
            (distance(*self.bodies, one, other, within=self.within), one, other)
            for one, other in zip(a, b, strict=True)
        ]

    def rows(self, parameters: Sequence[Parameter], numbers: Array, first: int) -> Rows:
        return _rows([found for found, _, _ in self._answers(parameters, numbers)], first)

    def alone(self, parameters: Sequence[Parameter], numbers: Array, row: int) -> Alone:
        found, *poses = self._answers(parameters, numbers)[0]
        named = tuple(zip(self.scene.pair, poses, strict=True))
        rows = _rows([found], row)
        nearest = None if found.status is Status.FAR else found
        return Alone(rows, nearest, self.scene.pair, self.bodies, named, {})


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
