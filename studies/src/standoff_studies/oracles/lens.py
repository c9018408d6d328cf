"""The intersection of equal balls around an axis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff_studies.oracles.shape import Region, dot, unit

Array = NDArray[Any]

MEMBERSHIP = 8 * np.finfo(float).eps
"""Relative slack of a point's membership in a ball of a lens: a few roundings of its radius."""


class Lens(Region):
    """Intersection of ``count`` balls of ``radius`` centred at -offset (cos t_i, sin t_i, 0).

    Along any direction the farthest point is that of one ball, or of the circle of two, or one
    of the two tips: the farthest of those that lie in all balls.
    """

    def __init__(self, radius: float, offset: float, count: int = 3) -> None:
        if not 0 < offset < radius or count < 2:
            raise ValueError(f"need 0 < offset < radius, count >= 2; got {offset}, {radius}")
        self.radius, self.offset, self.count = float(radius), float(offset), int(count)
        angle = 2 * np.pi * np.arange(count) / count
        self.centres: Array = -offset * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
        self.tip = float(np.sqrt((radius - offset) * (radius + offset)))
        self.pairs = [(i, j) for i in range(count) for j in range(i)]
        self.bounding_radius = self.tip

    def outside(self, points: Array) -> Array:
        steps = points[:, None] - self.centres
        return np.asarray(np.linalg.norm(steps, axis=2).max(axis=1) - self.radius)

    def contains(self, points: Array, skip: tuple[int, ...] = ()) -> Array:
        """Return (k,) whether the points lie in every ball except those of ``skip``."""
        inside = np.ones(len(points), dtype=bool)
        for index, centre in enumerate(self.centres):
            if index not in skip:
                step = points - centre
                inside &= np.sqrt(dot(step, step)) <= self.radius * (1 + MEMBERSHIP)
        return inside

    def circle(self, first: int, second: int) -> tuple[Array, Array, float]:
        """Return centre, unit axis and radius of the circle in which two spheres intersect."""
        start, end = self.centres[first], self.centres[second]
        half = np.linalg.norm(end - start) / 2
        radius = np.sqrt((self.radius - half) * (self.radius + half))
        return (start + end) / 2, unit((end - start)[None])[0], float(radius)

    def points(self, normals: Array) -> Array:
        candidates: list[Array] = []
        allowed: list[Array] = []
        along = self.radius * unit(normals)
        for index, centre in enumerate(self.centres):
            candidates.append(centre + along)
            allowed.append(self.contains(candidates[-1], skip=(index,)))
        for pair in self.pairs:
            centre, axis, radius = self.circle(*pair)
            across = normals - (normals @ axis)[:, None] * axis
            candidates.append(centre + radius * unit(across))
            allowed.append(self.contains(candidates[-1], skip=pair) & (dot(across, across) > 0))
        for sign in (-1.0, 1.0):
            tip = np.array([0.0, 0.0, sign * self.tip])
            candidates.append(np.broadcast_to(tip, normals.shape).astype(normals.dtype))
            allowed.append(np.ones(len(normals), dtype=bool))
        return _best(normals, candidates, allowed)


def _best(normals: Array, candidates: Sequence[Array], allowed: Sequence[Array]) -> Array:
    """For each direction, the allowed candidate with the greatest ``n.x``."""
    values = np.stack(
        [
            np.where(ok, dot(normals, point), -np.inf)
            for point, ok in zip(candidates, allowed, strict=True)
        ]
    )
    chosen = values.argmax(axis=0)
    return np.asarray(np.stack(candidates)[chosen, np.arange(len(normals))])
