"""Bodies between two poles on the z axis: the spindle and the gore body (a cloister vault)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .shape import Shape, directions, unit

Array = NDArray[Any]


class Bow:
    """The circular arc from (0, -half) through (bulge, 0) to (0, half), in the (r, z) plane."""

    def __init__(self, bulge: float, half: float) -> None:
        if not 0 < bulge < half:
            raise ValueError(f"bulge {bulge} must lie between 0 and half the length, {half}")
        self.half, self.bulge = float(half), float(bulge)
        self.radius = (half * half + bulge * bulge) / (2 * bulge)
        self.centre = bulge - self.radius

    def points(self, r: Array, z: Array) -> tuple[Array, Array]:
        """Return the (r, z) of the arc farthest along directions (r, z) with r >= 0."""
        length = np.sqrt(r * r + z * z)
        safe = np.where(length > 0, length, 1)
        height = self.radius * z / safe
        # centre + radius r / length, without the cancellation that slender arcs suffer
        reach = self.bulge - self.radius * (z / safe) * (z / (safe + r))
        beyond = (np.abs(height) >= self.half) | (reach <= 0)
        end = np.where(z >= 0, self.half, -self.half)
        return np.where(beyond, 0, reach), np.where(beyond, end, height)

    def outside(self, r: float, z: float) -> float:
        """Signed distance to the circle: positive exactly outside, for r >= 0."""
        beyond = r - self.bulge
        far = float(np.hypot(r - self.centre, z)) + self.radius
        return (beyond * (beyond + 2 * self.radius) + z * z) / far


class Spindle(Shape):
    """A circular arc revolved about its chord: ``radius`` at the equator, full ``length``."""

    def __init__(self, radius: float, length: float) -> None:
        self.bow = Bow(radius, length / 2)
        self.bounding_radius = length / 2

    def points(self, normals: Array) -> Array:
        radial = normals * np.array([1.0, 1.0, 0.0])
        across = np.sqrt((radial * radial).sum(axis=1))
        r, z = self.bow.points(across, normals[:, 2])
        point = r[:, None] * unit(radial)
        point[:, 2] = z
        return point

    def outside(self, point: ArrayLike) -> float:
        """How far a point lies outside."""
        x, y, z = np.asarray(point, dtype=float)
        return self.bow.outside(float(np.hypot(x, y)), float(z))


class Gore(Shape):
    """At every height a regular polygon of ``sides`` corners, which lie on circular arcs.

    Corner j of every polygon is at the angle 2 pi j / sides; ``radius`` is that of the corners
    at the equator, ``height`` is from pole to pole.
    """

    def __init__(self, radius: float, height: float, sides: int) -> None:
        self.bow = Bow(radius, height / 2)
        self.sides = int(sides)
        self.bounding_radius = height / 2
        angle = 2 * np.pi * np.arange(sides) / sides
        self.corners: Array = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
        middle = angle + np.pi / sides
        self.middles: Array = np.stack([np.cos(middle), np.sin(middle), 0 * angle], axis=1)

    def points(self, normals: Array) -> Array:
        along = normals @ self.corners.astype(normals.dtype).T
        chosen = along.argmax(axis=1)
        r, z = self.bow.points(along[np.arange(len(normals)), chosen], normals[:, 2])
        point = r[:, None] * self.corners[chosen]
        point[:, 2] = z
        return point

    def maximisers(self, normal: ArrayLike, tolerance: float) -> Array:
        """Both ends of a ruling where two corners are equally far."""
        direction = unit(directions(normal))[0]
        along = self.corners @ direction
        best = along.max()
        chosen = np.flatnonzero(along >= best - tolerance)
        r, z = self.bow.points(np.array([best]), direction[2:])
        point = r[0] * self.corners[chosen]
        point[:, 2] = z[0]
        return point if r[0] > 0 else point[:1]

    def special_normals(self, rng: np.random.Generator) -> Array:
        """A random normal of every patch: square to one of its rulings."""
        top = float(np.arcsin(self.bow.half / self.bow.radius))
        angle = rng.uniform(-0.99 * top, 0.99 * top, (self.sides, 1))
        flat = np.cos(angle) * self.middles / np.cos(np.pi / self.sides)
        return unit(flat + np.sin(angle) * np.array([0.0, 0.0, 1.0]))

    def outside(self, point: ArrayLike) -> float:
        """How far a point lies outside: first-order, from the nearest patch's cylinder."""
        p = np.asarray(point, dtype=float)
        shrink = float(np.cos(np.pi / self.sides))
        reach = max(float((self.middles @ p).max()) / shrink, 0.0)
        height = self.bow.outside(reach, float(p[2]))
        gradient = np.hypot((reach - self.bow.centre) / shrink, p[2]) / self.bow.radius
        return float(height / max(gradient, 1.0))
