"""A world walked over the times of its scene: the least of each pair, and when."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from standoff.clearance.report import LeastGap, horizon, uncertified_in
from standoff.progress import Progress
from standoff.scene.scene import Scene
from standoff.tracking.status import Status
from standoff.typing import Array
from standoff.world import World, WorldAnswer
from standoff.world.state import WorldCounts

NamePair = tuple[str, str]


class Walked(NamedTuple):
    """What was seen on the way.

    Attributes
    ----------
    times : (n,) array
        Of the frames, s.
    clearance : (n,) array
        Proven for all pairs, frame by frame [length].
    closest : list of str
        The nearest pair of each frame, as "a - b"; empty where none is near. Where one body is
        inside the other's material the pair is not among them.
    distance : (n,) array
        Its distance [length]; inf where none is near.
    near : dict of names to Nearest
        The least of each pair that was near at any time.
    counts : list of WorldCounts
        Of each frame.
    """

    times: Array
    clearance: Array
    closest: list[NamePair | None]
    distance: Array
    near: dict[NamePair, LeastGap]
    counts: list[WorldCounts]

    @property
    def uncertified(self) -> int:
        """Frames in which an answer is not proven."""
        return sum(count.uncertified > 0 for count in self.counts)


def frames(
    scene: Scene, world: World, times: Array, progress: Progress | None = None
) -> Iterator[tuple[float, WorldAnswer]]:
    """Track a world over times, frame by frame.

    Parameters
    ----------
    scene : Scene
        Its motions move the bodies.
    world : World
    times : (n,) array
        Scene times, s, increasing.
    progress : callable, optional
        Told how many frames are done, and of how many.
    """
    state = world.start(scene.poses(world, float(times[0])))
    yield float(times[0]), world.answer(state)
    for k, (before, time) in enumerate(pairwise(times), 2):
        poses = scene.poses(world, float(time))
        state, answer = world.step(state, poses, dt=float(time - before))
        if progress is not None:
            progress(k, len(times))
        yield float(time), answer


class LeastOfAll:
    """The least of each pair over the frames that it is told."""

    def __init__(self) -> None:
        self.near: dict[NamePair, LeastGap] = {}
        self._times: list[float] = []
        self._clearance: list[float] = []
        self._closest: list[NamePair | None] = []
        self._distance: list[float] = []
        self._counts: list[WorldCounts] = []
        self._order: dict[NamePair, float] = {}

    def add(self, time: float, answer: WorldAnswer) -> None:
        """Take in a frame."""
        pairs = answer.pairs
        distances, lowest, status = pairs.distance, pairs.lower_bound, pairs.status
        order, names = pairs.order, pairs.names
        for k, name in enumerate(names):
            self._one(name, time, (float(order[k]), float(lowest[k])), status[k], answer, k)
        # a wall around a body is no distance of the course
        distances = np.where(np.isneginf(order), np.inf, distances)
        k = int(np.argmin(distances)) if np.isfinite(distances).any() else -1
        self._times.append(time)
        self._clearance.append(answer.clearance)
        self._closest.append(names[k] if k >= 0 else None)
        self._distance.append(float(distances[k]) if k >= 0 else np.inf)
        self._counts.append(answer.counts)

    def _one(
        self,
        names: NamePair,
        time: float,
        found: tuple[float, float],
        status: Status,
        answer: WorldAnswer,
        k: int,
    ) -> None:
        order, lower = found
        known, (uncertified, statuses) = self.near.get(names), uncertified_in(status)
        if known is None:
            self.near[names] = LeastGap(answer.pairs[k], time, lower, uncertified, statuses)
            self._order[names] = order
        elif uncertified or lower < known.lower_bound or order < self._order[names]:
            nearer = order < self._order[names]
            self._order[names] = min(order, self._order[names])
            self.near[names] = LeastGap(
                answer.pairs[k] if nearer else known.answer,
                time if nearer else known.time,
                min(lower, known.lower_bound),
                known.uncertified + uncertified,
                tuple(dict.fromkeys(known.statuses + statuses)),
            )

    def walked(self) -> Walked:
        """Return what was seen."""
        return Walked(
            np.array(self._times),
            np.array(self._clearance),
            self._closest,
            np.array(self._distance),
            self.near,
            self._counts,
        )


def walk(scene: Scene, world: World, times: Array, progress: Progress | None = None) -> Walked:
    """Track a world over times and return the least of each pair."""
    least = LeastOfAll()
    for time, answer in frames(scene, world, times, progress):
        least.add(time, answer)
    return least.walked()


def bounds_over(world: World, near: dict[NamePair, LeastGap]) -> dict[NamePair, float]:
    """Return bounds of the pairs that were never near: each kept beyond its horizon."""
    return {names: horizon(world, names) for names in world.pairs() if names not in near}
