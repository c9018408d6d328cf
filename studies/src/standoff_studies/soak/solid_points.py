"""Signed distances of points from solids, judged by closed forms."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from standoff_studies.soak.solid_outlines import Array
from standoff_studies.soak.solid_poses import Known

NOISE = 1e-11
"""Of the size: what roundings may do to a length."""
BLOCK = 10_000
NEAR = (1e-9, 1e-6, 1e-3, 0.1)
"""Of the size: how far points near the boundary are from it."""
GRID = 0.05
"""Length: points of a grid, or off it by little, lie in the planes of faces and under edges."""
NUDGES = (0.0, 0.0, 1e-15, 1e-12, 1e-9)


class PointVerdict(NamedTuple):
    """Counts: bounds that exclude the truth, wrong sides, nearest points that are off the
    boundary, gradients that are wrong, and intervals wider than the tolerance."""

    points: int = 0
    bound: int = 0
    side: int = 0
    nearest: int = 0
    gradient: int = 0
    open: int = 0

    @property
    def sound(self) -> bool:
        return not (self.bound or self.side or self.nearest or self.gradient)

    def plus(self, other: PointVerdict) -> PointVerdict:
        return PointVerdict(*(a + b for a, b in zip(self, other, strict=True)))

    def __str__(self) -> str:
        return (
            f"{self.points:,} points; bound {self.bound}, side {self.side}, nearest "
            f"{self.nearest}, gradient {self.gradient} wrong; {self.open} open"
        )


def judged(known: Known, solid: Any, count: int, seed: int) -> PointVerdict:
    """Judge the signed distances of drawn points."""
    verdict = PointVerdict()
    for number, first in enumerate(range(0, count, BLOCK)):
        points = drawn(known, min(BLOCK, count - first), np.random.default_rng([seed, number]))
        verdict = verdict.plus(compared(known, points, solid.signed_distance(points)))
    return verdict


def drawn(known: Known, count: int, rng: np.random.Generator) -> Array:
    """Points near the boundary, around the solid, and of a grid, a third each; of the last ones one
    or two coordinates may be any."""
    start = known.sampled.start.point
    middle, spread = start.mean(axis=0), np.ptp(start, axis=0)
    far = middle + (rng.uniform(size=(count, 3)) - 0.5) * 2.0 * spread
    near = start[rng.integers(len(start), size=count)]
    off = rng.choice(NEAR, count)[:, None] * known.size
    near = near + off * rng.normal(size=(count, 3)) / np.sqrt(3.0)
    grid = GRID * np.round(far / GRID) + rng.choice(NUDGES, count)[:, None]
    grid = np.where(rng.uniform(size=(count, 3)) < 0.4, far, grid)
    which = rng.integers(3, size=(count, 1))
    return np.asarray(np.where(which == 0, far, np.where(which == 1, near, grid)))


def compared(known: Known, points: Array, told: Any) -> PointVerdict:
    """What was told of points, beside the closed form."""
    true, noise = known.part.truth.signed(points), NOISE * known.size
    bound = (told.lower_bound > true + noise) | (told.upper_bound < true - noise)
    clear = np.abs(true) > 1e-9 * known.size
    side = clear & ((told.distance < 0.0) != (true < 0.0))
    length = np.linalg.norm(points - told.nearest, axis=1)
    nearest = (np.abs(known.part.truth.signed(told.nearest)) > noise) | (
        np.abs(length - np.abs(told.distance)) > noise
    )
    # from the nearest point to the point, or back where it is inside
    way = np.sign(told.distance)[:, None] * (points - told.nearest)
    off = np.linalg.norm(way - length[:, None] * told.gradient, axis=1)
    gradient = clear & (off > noise)
    counts = [bound, side, nearest, gradient, ~told.converged]
    return PointVerdict(len(points), *(int(np.count_nonzero(each)) for each in counts))
