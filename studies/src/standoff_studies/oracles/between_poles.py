"""Bodies between two poles on the z axis: the spindle and the gore body (a cloister vault)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff_studies.oracles.flats import Flat, family_flat
from standoff_studies.oracles.revolved import turned
from standoff_studies.oracles.shape import Region, directions, extended, unit

Array = NDArray[Any]

INNER = 0.95
"""Fraction of the range of rulings' angles from which one is drawn, so that none is at a pole."""


class Bow:
    """The circular arc from (0, -half) through (bulge, 0) to (0, half), in the (r, z) plane."""

    def __init__(self, bulge: float, half: float) -> None:
        if not 0 < bulge < half:
            raise ValueError(f"bulge {bulge} must lie between 0 and half the length, {half}")
        self.half, self.bulge = extended(half), extended(bulge)
        self.radius = (self.half**2 + self.bulge**2) / (2 * self.bulge)
        self.centre = self.bulge - self.radius

    def points(self, r: Array, z: Array) -> tuple[Array, Array]:
        """Return the (r, z) of the arc farthest along directions (r, z) with r >= 0."""
        radius, bulge, half = (
            np.asarray(x, dtype=r.dtype) for x in (self.radius, self.bulge, self.half)
        )
        length = np.sqrt(r * r + z * z)
        safe = np.where(length > 0, length, 1)
        height = radius * z / safe
        # centre + radius r / length, without the cancellation of slender arcs
        reach = bulge - radius * (z / safe) * (z / (safe + r))
        beyond = (np.abs(height) >= half) | (reach <= 0)
        end = np.where(z >= 0, half, -half)
        return np.where(beyond, 0, reach), np.where(beyond, end, height)

    def outside(self, r: Array, z: Array) -> Array:
        """Signed distance to the circle: positive exactly outside, for r >= 0."""
        radius, bulge, centre = (float(x) for x in (self.radius, self.bulge, self.centre))
        beyond = r - bulge
        return np.asarray(
            (beyond * (beyond + 2 * radius) + z * z) / (np.hypot(r - centre, z) + radius)
        )


class Spindle(Region):
    """A circular arc revolved about its chord: ``radius`` at the equator, full ``length``."""

    def __init__(self, radius: float, length: float) -> None:
        self.bow = Bow(radius, length / 2)
        self.bounding_radius = length / 2

    def points(self, normals: Array) -> Array:
        across = np.sqrt((normals[:, :2] ** 2).sum(axis=1))
        return turned(normals, *self.bow.points(across, normals[:, 2]))

    def outside(self, points: Array) -> Array:
        return self.bow.outside(np.hypot(points[:, 0], points[:, 1]), points[:, 2])


class Gore(Region):
    """At every height a regular polygon of ``sides`` corners, which are on circular arcs.

    Corner j of every polygon is at the angle 2 pi j / sides; ``radius`` is the distance of the
    corners from the axis at the equator, ``height`` is from pole to pole.
    """

    def __init__(self, radius: float, height: float, sides: int) -> None:
        self.bow = Bow(radius, height / 2)
        self.sides = int(sides)
        self.bounding_radius = height / 2
        # pi in extended precision, so that the corners are good to the last digit
        angle = 2 * np.arctan2(extended(0), extended(-1)) * np.arange(sides) / sides
        self.corners: Array = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
        middle = (angle + angle[1] / 2).astype(float)
        self.middles: Array = np.stack([np.cos(middle), np.sin(middle), 0 * middle], axis=1)
        self.shrink = float(np.cos(np.pi / sides))

    def points(self, normals: Array) -> Array:
        corners = self.corners.astype(normals.dtype)
        along = normals @ corners.T
        chosen = along.argmax(axis=1)
        r, z = self.bow.points(along[np.arange(len(normals)), chosen], normals[:, 2])
        point = r[:, None] * corners[chosen]
        point[:, 2] = z
        return np.asarray(point)

    def outside(self, points: Array) -> Array:
        """Signed distance to the cylinder of the nearest patch."""
        reach = np.maximum((points @ self.middles.T).max(axis=1) / self.shrink, 0)
        height = self.bow.outside(reach, points[:, 2])
        slope = np.hypot((reach - float(self.bow.centre)) / self.shrink, points[:, 2])
        return np.asarray(height / np.maximum(slope / float(self.bow.radius), 1))

    def maximisers(self, normal: ArrayLike, tolerance: float) -> Array:
        """Both ends of a ruling if two corners are equally far."""
        direction = unit(directions(normal))[0]
        corners = self.corners.astype(direction.dtype)
        along = corners @ direction
        best = along.max()
        chosen = np.flatnonzero(along >= best - tolerance)
        r, z = self.bow.points(np.array([best]), direction[2:])
        point = r[0] * corners[chosen]
        point[:, 2] = z[0]
        return np.asarray(point if r[0] > 0 else point[:1])

    @property
    def _top(self) -> float:
        """The greatest angle of a ruling's normal above the equator."""
        return float(np.arcsin(self.bow.half / self.bow.radius))

    def special_normals(self, rng: np.random.Generator) -> Array:
        """A random normal of every patch, perpendicular to one of its rulings."""
        angle = rng.uniform(-0.99 * self._top, 0.99 * self._top, (self.sides, 1))
        flat = np.cos(angle) * self.middles / self.shrink
        return unit(flat + np.sin(angle) * np.array([0.0, 0.0, 1.0]))

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        number = int(rng.integers(self.sides))
        first, second = self.corners[number], self.corners[(number + 1) % self.sides]
        # the middle of a side of the unit polygon, divided by its square: n.corner = cos(t)
        outward = (first + second) / (1 + first @ second)

        def ruling(t: Any) -> tuple[Array, Array]:
            normal = np.cos(t) * outward + np.sin(t) * extended([0, 0, 1])
            r = self.bow.centre + self.bow.radius * np.cos(t)
            lift = self.bow.radius * np.sin(t) * extended([0, 0, 1])
            return unit(normal), np.stack([r * first + lift, r * second + lift])

        top = INNER * self._top
        return [family_flat(ruling, float(rng.uniform(-top, top)))]
