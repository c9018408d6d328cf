"""Bodies of revolution about z: hulls of revolved planar curves."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff_studies.oracles import Shape, directions, unit
from standoff_studies.oracles.revolved import turned

from .loops import Curve

Array = NDArray[Any]

BISECTIONS = 70
"""Halvings of a bracket of angles."""
ANGLES = 240
"""Directions of half a turn that are looked through for jumps of the support point."""
JUMP = 1e-6
"""A support point that moves this far, over the size, in a bisected bracket has jumped."""
STRETCHES = 24
"""Parts of a curve that are searched one by one: it need not be convex."""
SAMPLES = 32
"""Samples of a part that tell whether it may hold the farthest point."""
RIVAL = 1e-3
"""Parts whose best sample is within this of the best, over the size, are searched."""
CLIMBS = 30
"""Steps on a part: halvings alone leave 1e-12 of it, and the value is good to its square."""
SETTLED = 1e-12
"""Change of a parameter that ends a search: the value is then good to its square."""
ZOOM = 40
"""Directions of one round of the search for the direction along which a point is farthest."""


class Stretch:
    """A part of a curve, short enough for ``n.c(t)`` to have two maxima on it at most."""

    def __init__(self, curve: Curve, start: float, end: float) -> None:
        self.curve, self.grid = curve, np.linspace(start, end, SAMPLES + 1)
        self.samples: Array = curve.jet(self.grid)[0]

    def farthest(self, flat: Array) -> Array:
        """Return its points (k, 2) of greatest ``n.c``, from its two highest peaks of samples."""
        values = self.samples @ flat.T
        padded = np.pad(values, ((1, 1), (0, 0)), constant_values=-np.inf)
        peaks = (values >= padded[:-2]) & (values >= padded[2:])
        highest = np.argsort(np.where(peaks, values, -np.inf), axis=0)[[-1, -2]]
        found = self._climb(np.vstack([flat, flat]), highest.ravel())
        options = found.reshape(2, -1, 2).swapaxes(0, 1)
        chosen = (options * flat[:, None]).sum(axis=2).argmax(axis=1)
        return np.asarray(options[np.arange(len(flat)), chosen])

    def _climb(self, flat: Array, best: Array) -> Array:
        """Newton steps, safeguarded by bisection, from samples; the samples' own points count."""
        low, high = self.grid[np.maximum(best - 1, 0)], self.grid[np.minimum(best + 1, SAMPLES)]
        t = self.grid[best].copy()
        for _ in range(CLIMBS):
            point, velocity, bend = self.curve.jet(t)
            slope, curvature = (velocity * flat).sum(axis=1), (bend * flat).sum(axis=1)
            low, high = np.where(slope >= 0, t, low), np.where(slope <= 0, t, high)
            newton = t - slope / np.where(curvature < 0, curvature, -np.inf)
            inside = (newton >= low) & (newton <= high) & (curvature < 0)
            following = np.where(inside, newton, (low + high) / 2)
            if np.abs(following - t).max() <= SETTLED * np.abs(self.grid).max():
                break
            t = following
        lower = (point * flat).sum(axis=1) < (self.samples[best] * flat).sum(axis=1)
        return np.where(lower[:, None], self.samples[best], point)


class RevolvedHull(Shape):
    """The convex hull of planar ``curves`` (r, z), r >= 0, revolved about the z axis."""

    def __init__(self, curves: Sequence[Curve]) -> None:
        cuts = [np.linspace(*curve.span, STRETCHES + 1) for curve in curves]
        self.stretches = [
            Stretch(curve, start, end)
            for curve, cut in zip(curves, cuts, strict=True)
            for start, end in pairwise(cut)
        ]
        self.samples: Array = np.stack([stretch.samples for stretch in self.stretches])
        self.bounding_radius = float(np.linalg.norm(self.samples, axis=2).max()) * 1.001
        self.pieces = self._straight()

    def profile(self, flat: Array) -> Array:
        """Return the (r, z) farthest along directions (k, 2) with r >= 0."""
        flat = flat.astype(float)
        peaks = (self.samples @ flat.T).max(axis=1)
        near = peaks >= peaks.max(axis=0) - RIVAL * self.bounding_radius
        best, found = np.full(len(flat), -np.inf), np.zeros_like(flat)
        for number, stretch in enumerate(self.stretches):
            rows = np.flatnonzero(near[number])
            if len(rows):
                spots = stretch.farthest(flat[rows])
                heights = (spots * flat[rows]).sum(axis=1)
                better = heights > best[rows]
                best[rows[better]], found[rows[better]] = heights[better], spots[better]
        return found

    def points(self, normals: Array) -> Array:
        across = np.sqrt((normals[:, :2] ** 2).sum(axis=1))
        found = self.profile(np.column_stack([across, normals[:, 2]]).astype(float))
        return turned(normals, found[:, 0], found[:, 1]).astype(normals.dtype)

    def _straight(self) -> list[tuple[float, Array]]:
        """Return (angle, two end points) of the profile's straight pieces, discs excluded."""
        edges = np.linspace(-np.pi / 2, np.pi / 2, ANGLES + 1)
        low, high = edges[:-1], edges[1:]
        first, last = self._at(low), self._at(high)
        for _ in range(BISECTIONS):
            jumps = np.linalg.norm(last - first, axis=1) > JUMP * self.bounding_radius
            low, high, first, last = low[jumps], high[jumps], first[jumps], last[jumps]
            if not len(low):
                break
            middle = (low + high) / 2
            half = self._at(middle)
            nearer = np.linalg.norm(half - first, axis=1) > np.linalg.norm(last - half, axis=1)
            low, high = np.where(nearer, low, middle), np.where(nearer, middle, high)
            first = np.where(nearer[:, None], first, half)
            last = np.where(nearer[:, None], half, last)
        middle = (low + high) / 2
        return [(float(a), np.array(e)) for a, *e in zip(middle, first, last, strict=True)]

    def _at(self, angles: Array) -> Array:
        return self.profile(np.column_stack([np.abs(np.cos(angles)), np.sin(angles)]))

    def maximisers(self, normal: ArrayLike, tolerance: float) -> Array:
        """A triangle of a disc's rim, both ends of a cone's generator, or the support point."""
        direction = unit(directions(normal))
        point = self.points(direction)
        across = float(np.hypot(direction[0, 0], direction[0, 1]))
        if across <= tolerance and self._at(np.array([np.pi / 2]))[0, 0] >= 0:
            rim = self.profile(np.array([[1e-300, np.sign(direction[0, 2])]]))[0]
            angle = 2 * np.pi * np.arange(3) / 3
            height = np.full(3, rim[1])
            return np.stack([rim[0] * np.cos(angle), rim[0] * np.sin(angle), height], axis=1)
        angle = np.arctan2(direction[0, 2], across)
        for piece, ends in self.pieces:
            if abs(piece - angle) <= tolerance:
                radial = direction[0] * np.array([1, 1, 0]) / across
                return ends[:, :1] * radial + ends[:, 1:] * np.array([0, 0, 1])
        return point

    def special_normals(self, rng: np.random.Generator) -> Array:
        """The axis both ways, and a random normal of every cone."""
        rows = [np.array([0, 0, 1.0]), np.array([0, 0, -1.0])]
        for piece, _ in self.pieces:
            turn = rng.uniform(0, 2 * np.pi)
            rows.append(
                np.array(
                    [np.cos(piece) * np.cos(turn), np.cos(piece) * np.sin(turn), np.sin(piece)]
                )
            )
        return np.array(rows)

    def outside(self, points: Array) -> Array:
        """How far points lie outside: greatest height over a supporting line, by zooming in."""
        return np.array([self._outside(point) for point in points])

    def _outside(self, point: Array) -> float:
        x, y, z = point
        spot = np.array([np.hypot(x, y), z])
        low, high = -np.pi / 2, np.pi / 2
        best = -np.inf
        for _ in range(7):
            angles = np.linspace(low, high, ZOOM + 1)
            flat = np.column_stack([np.abs(np.cos(angles)), np.sin(angles)])
            heights = flat @ spot - (flat * self.profile(flat)).sum(axis=1)
            step, centre = (high - low) / ZOOM, angles[heights.argmax()]
            best = max(best, float(heights.max()))
            low, high = max(centre - step, -np.pi / 2), min(centre + step, np.pi / 2)
        return best
