"""Shapes about the axis z: cylinder, cone, cap, dome, egg, and the hull of a ring."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff_studies.oracles.flats import Flat, face_flat, family_flat
from standoff_studies.oracles.shape import (
    TINY,
    Region,
    Shape,
    directions,
    dot,
    extended,
    lengths,
    unit,
)

Array = NDArray[Any]

BISECTIONS = 12
"""Bisections of an egg's polar angle before Newton's method."""
NEWTON_STEPS = 6
"""Newton steps for an egg's polar angle: from 1e-3 rad to the last digit, with some to spare."""

ACROSS = np.array([1, 1, 0])


def turned(normals: Array, r: ArrayLike, z: ArrayLike) -> Array:
    """Return the points (k, 3) at radius r and height z, one or k numbers each, in the normals'
    azimuth. A normal along the axis has none: its point is on the axis.
    """
    point = np.reshape(np.asarray(r, dtype=normals.dtype), (-1, 1)) * unit(normals * ACROSS)
    point[:, 2] = z
    return np.asarray(point)


def _around(t: Any, r: Any, z: Any) -> Array:
    return extended([r * np.cos(t), r * np.sin(t), z])


def _rim(radius: float, z: float) -> Array:
    """Three points of a circle, enough to span an area of its disc."""
    angle = 2 * np.pi * np.arange(3) / 3
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(3, z)], axis=1)


def _disc_flat(sign: float, radius: Any, z: float) -> Flat:
    """A disc whose outward normal is (0, 0, sign)."""
    corners = np.stack([_around(t, radius, z) for t in 2 * np.pi * np.arange(3) / 3])
    return face_flat(extended([0, 0, sign]), corners)


def _is_axis(direction: Array, tolerance: float) -> bool:
    return bool(np.hypot(direction[0, 0], direction[0, 1]) <= tolerance)


class Cylinder(Region):
    """A cylinder of radius ``radius`` and full length ``length``."""

    def __init__(self, radius: float, length: float) -> None:
        self.radius, self.length = float(radius), float(length)
        self.bounding_radius = float(np.hypot(radius, length / 2))

    def points(self, normals: Array) -> Array:
        half = self.length / 2
        return turned(normals, self.radius, np.where(normals[:, 2] >= 0, half, -half))

    def outside(self, points: Array) -> Array:
        across = np.hypot(points[:, 0], points[:, 1])
        return np.maximum(across - self.radius, np.abs(points[:, 2]) - self.length / 2)

    def maximisers(self, normal: ArrayLike, tolerance: float) -> Array:
        direction = unit(directions(normal))
        point = self.points(direction)
        if _is_axis(direction, tolerance):
            return _rim(self.radius, point[0, 2])
        if abs(direction[0, 2]) <= tolerance:
            return np.vstack([point, point * np.array([1, 1, -1])])
        return point

    def special_normals(self, rng: np.random.Generator) -> Array:
        angle = rng.uniform(0, 2 * np.pi)
        return np.array([[0, 0, 1], [0, 0, -1], [np.cos(angle), np.sin(angle), 0.0]])

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        half = self.length / 2

        def ruling(t: Any) -> tuple[Array, Array]:
            ends = [_around(t, self.radius, z) for z in (-half, half)]
            return _around(t, 1, 0), np.stack(ends)

        sign = float(rng.choice([-1, 1]))
        side = family_flat(ruling, float(rng.uniform(0, 2 * np.pi)))
        return [_disc_flat(sign, self.radius, sign * half), side]


class Cone(Region):
    """A cone: apex at +height/2, base disc of ``radius`` at -height/2."""

    def __init__(self, radius: float, height: float) -> None:
        self.radius, self.height = float(radius), float(height)
        self.apex: Array = np.array([0.0, 0.0, self.height / 2])
        self.bounding_radius = float(max(np.hypot(radius, height / 2), height / 2))

    def points(self, normals: Array) -> Array:
        base = turned(normals, self.radius, -self.height / 2)
        higher = normals @ self.apex >= dot(normals, base)
        return np.where(higher[:, None], self.apex.astype(normals.dtype), base)

    def outside(self, points: Array) -> Array:
        across = np.hypot(points[:, 0], points[:, 1])
        side = self.height * across + self.radius * (points[:, 2] - self.height / 2)
        beyond = side / np.hypot(self.height, self.radius)
        return np.asarray(np.maximum(beyond, -self.height / 2 - points[:, 2]))

    def maximisers(self, normal: ArrayLike, tolerance: float) -> Array:
        direction = unit(directions(normal))
        if direction[0, 2] < 0 and _is_axis(direction, tolerance):
            return _rim(self.radius, -self.height / 2)
        base = turned(direction, self.radius, -self.height / 2)
        if abs(dot(direction, base - self.apex)[0]) <= tolerance * self.bounding_radius:
            return np.vstack([base, self.apex])
        return self.points(direction)

    def special_normals(self, rng: np.random.Generator) -> Array:
        angle = rng.uniform(0, 2 * np.pi)
        side = [self.height * np.cos(angle), self.height * np.sin(angle), self.radius]
        return unit(np.array([[0, 0, -1], side]))

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        half = self.height / 2

        def ruling(t: Any) -> tuple[Array, Array]:
            ends = [_around(t, self.radius, -half), extended([0, 0, half])]
            return unit(_around(t, 2 * extended(half), self.radius)), np.stack(ends)

        side = family_flat(ruling, float(rng.uniform(0, 2 * np.pi)))
        return [_disc_flat(-1.0, self.radius, -half), side]


class Cap(Region):
    """The part z >= ``offset`` of the ball of ``radius`` centred at the origin."""

    def __init__(self, radius: float, offset: float) -> None:
        if not -radius < offset < radius:
            raise ValueError(f"offset {offset} must lie within +-{radius}")
        self.radius, self.offset = float(radius), float(offset)
        self.long_rim = np.sqrt((extended(radius) - offset) * (extended(radius) + offset))
        self.rim = float(self.long_rim)
        self.bounding_radius = self.radius

    def points(self, normals: Array) -> Array:
        ball = self.radius * unit(normals)
        rim = turned(normals, self.long_rim, self.offset)
        return np.where(ball[:, 2:] >= self.offset, ball, rim)

    def outside(self, points: Array) -> Array:
        return np.maximum(lengths(points) - self.radius, self.offset - points[:, 2])

    def maximisers(self, normal: ArrayLike, tolerance: float) -> Array:
        direction = unit(directions(normal))
        if direction[0, 2] < 0 and _is_axis(direction, tolerance):
            return _rim(self.rim, self.offset)
        return self.points(direction)

    def special_normals(self, rng: np.random.Generator) -> Array:
        del rng
        return np.array([[0.0, 0.0, -1.0]])

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        del rng
        return [_disc_flat(-1.0, self.rim, self.offset)]


class Dome(Region):
    """``0 <= z <= height (1 - r²/radius²)``: a paraboloid on a disc."""

    def __init__(self, radius: float, height: float) -> None:
        self.radius, self.height = float(radius), float(height)
        self.bounding_radius = float(max(radius, height, np.hypot(radius, height)))

    def points(self, normals: Array) -> Array:
        across = np.sqrt((normals[:, :2] ** 2).sum(axis=1))
        up = np.maximum(normals[:, 2], 0)
        # at r = share * radius the dome has the normal's slope; r is at most that of the rim
        steep = across * self.radius >= 2 * self.height * up
        share = across * self.radius / np.where(steep, 1, 2 * self.height * up)
        share = np.where(steep, 1, share)
        return turned(normals, self.radius * share, self.height * (1 - share) * (1 + share))

    def outside(self, points: Array) -> Array:
        r = np.hypot(points[:, 0], points[:, 1]) / self.radius
        value = points[:, 2] - self.height * (1 - r) * (1 + r)
        slope = np.hypot(1, 2 * self.height * r / self.radius)
        return np.maximum(value / slope, -points[:, 2])


class RingHull(Shape):
    """The hull of a revolved ellipse (r - ring, z) with semi-axes (width, height): the Minkowski
    sum of a disc of radius ``ring`` and an ellipsoid of revolution."""

    def __init__(self, ring: float, width: float, height: float) -> None:
        self.ring, self.axes = float(ring), np.array([width, width, height], dtype=float)
        self.bounding_radius = float(np.hypot(ring + width, height))

    def points(self, normals: Array) -> Array:
        return np.asarray(turned(normals, self.ring, 0) + self.axes * unit(self.axes * normals))

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        sign = float(rng.choice([-1, 1]))
        return [_disc_flat(sign, self.ring, sign * float(self.axes[2]))]


class Egg(Region):
    """``r = b sqrt(1 - t²)/(1 + k t)``, ``z = half t``: a circle in a partial perspective.

    ``radius`` is the greatest r, at t = -k; b = radius sqrt(1 - k²). Convex for |k| <= sqrt(1/2).
    """

    def __init__(self, radius: float, length: float, taper: float) -> None:
        self.half, self.taper = length / 2, float(taper)
        self.width = radius * np.sqrt(1 - extended(taper) ** 2)
        self.bounding_radius = float(np.hypot(radius, length / 2))

    def points(self, normals: Array) -> Array:
        """Solve for the polar angle at which n.x is greatest: its derivative has only one zero."""
        kind, k = normals.dtype, self.taper
        width = np.asarray(self.width, dtype=kind)
        across = width * np.sqrt((normals[:, :2] ** 2).sum(axis=1))
        along = self.half * normals[:, 2]
        low = np.zeros_like(across)
        high = np.full_like(across, np.arctan2(kind.type(0), kind.type(-1)))
        angle = (low + high) / 2
        for step in range(BISECTIONS + NEWTON_STEPS):
            cos, sin = np.cos(angle), np.sin(angle)
            shrink = 1 + k * cos
            slope = across * (cos + k) / shrink**2 - along * sin
            low, high = np.where(slope > 0, angle, low), np.where(slope > 0, high, angle)
            bend = across * sin * (k * cos + 2 * k * k - 1) / shrink**3 - along * cos
            newton = angle - slope / np.where(bend < 0, bend, -np.inf)
            middle = (low + high) / 2
            polish = (step >= BISECTIONS) & (bend < 0)
            angle = np.where(polish, np.clip(newton, low, high), middle)
        cos = np.cos(angle)
        return turned(normals, width * np.sin(angle) / (1 + k * cos), self.half * cos)

    def outside(self, points: Array) -> Array:
        """By the quartic; beyond the plane where the perspective is singular, by the height."""
        t, square = points[:, 2] / self.half, float(self.width) ** 2
        wide, r2 = 1 + self.taper * t, (points[:, :2] ** 2).sum(axis=1)
        value = r2 * wide**2 - square * (1 - t) * (1 + t)
        across = 2 * np.sqrt(r2) * wide**2
        along = (2 * r2 * wide * self.taper + 2 * square * t) / self.half
        found = value / np.maximum(np.hypot(across, along), TINY)
        return np.where(wide > 0, found, np.abs(points[:, 2]) - self.half)
