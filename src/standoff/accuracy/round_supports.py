"""Support points of the shapes about the axis z: discs, cones, caps, eggs, spindles, gores."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.accuracy.flats import Flat, face_flat, family_flat
from standoff.accuracy.supports import Array, Support, dot, extended, unit

BISECTIONS = 12
"""Halvings of an egg's polar angle before Newton's steps."""
NEWTON_STEPS = 6
"""Newton's steps of an egg's polar angle: from 1e-3 rad to the last digit, with some to spare."""
INNER = 0.95
"""Part of a family of rulings that is drawn from, so that none is at the family's end."""

Real = NDArray[np.floating[Any]]


def _radial(normals: Array) -> Array:
    """The unit vectors (k, 3) square to z, zero where a normal is along z."""
    return unit(normals * np.array([1, 1, 0]))


def _turned(normals: Array, r: Array, z: Array) -> Array:
    """The points at radius r and height z on the side where the normals point."""
    point = r[:, None] * _radial(normals)
    point[:, 2] = z
    return point


def _around(t: Any, r: Any, z: Any) -> Array:
    return extended([r * np.cos(t), r * np.sin(t), z])


def disc_flat(sign: float, radius: float, z: float) -> Flat:
    """A disc whose outward normal is (0, 0, sign)."""
    corners = np.stack([_around(t, radius, z) for t in 2 * np.pi * np.arange(3) / 3])
    return face_flat(extended([0, 0, sign]), corners)


class Cylinder(Support):
    """A cylinder of full length."""

    def __init__(self, radius: float, length: float) -> None:
        self.radius, self.half = radius, length / 2

    def points(self, normals: Array) -> Array:
        height = np.where(normals[:, 2] >= 0, self.half, -self.half)
        return _turned(normals, np.full_like(height, self.radius), height)

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        def ruling(t: Any) -> tuple[Array, Array]:
            ends = [_around(t, self.radius, z) for z in (-self.half, self.half)]
            return _around(t, 1, 0), np.stack(ends)

        sign = float(rng.choice([-1, 1]))
        side = family_flat(ruling, float(rng.uniform(0, 2 * np.pi)))
        return [disc_flat(sign, self.radius, sign * self.half), side]


class Cone(Support):
    """A cone: apex at +height/2, base disc at -height/2."""

    def __init__(self, radius: float, height: float) -> None:
        self.radius, self.half = radius, height / 2

    def points(self, normals: Array) -> Array:
        height = np.full(len(normals), -self.half, dtype=normals.dtype)
        base = _turned(normals, np.full_like(height, self.radius), height)
        apex = np.array([0, 0, self.half])
        return np.where((normals @ apex > dot(normals, base))[:, None], apex, base)

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        def ruling(t: Any) -> tuple[Array, Array]:
            ends = [_around(t, self.radius, -self.half), extended([0, 0, self.half])]
            return unit(_around(t, 2 * extended(self.half), self.radius)), np.stack(ends)

        side = family_flat(ruling, float(rng.uniform(0, 2 * np.pi)))
        return [disc_flat(-1.0, self.radius, -self.half), side]


class Cap(Support):
    """The part z >= offset of the ball of ``radius`` around the origin."""

    def __init__(self, radius: float, offset: float) -> None:
        self.radius, self.offset = radius, offset
        self.rim = np.sqrt((extended(radius) - offset) * (extended(radius) + offset))

    def points(self, normals: Array) -> Array:
        ball = self.radius * unit(normals)
        height = np.full(len(normals), self.offset, dtype=normals.dtype)
        rim = _turned(normals, np.full_like(height, self.rim), height)
        return np.where(ball[:, 2:] >= self.offset, ball, rim)

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        del rng
        return [disc_flat(-1.0, float(self.rim), self.offset)]


class RingHull(Support):
    """The hull of a revolved ellipse (r - ring, z) of half-axes (width, height): a disc of radius
    ``ring`` plus an ellipsoid of revolution, as Minkowski sums."""

    def __init__(self, ring: float, width: float, height: float) -> None:
        self.ring, self.axes = ring, np.array([width, width, height])

    def points(self, normals: Array) -> Array:
        return np.asarray(self.ring * _radial(normals) + self.axes * unit(self.axes * normals))

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        sign = float(rng.choice([-1, 1]))
        return [disc_flat(sign, self.ring, sign * float(self.axes[2]))]


class Egg(Support):
    """``r = b sqrt(1 - t²)/(1 + k t)``, ``z = half t``, greatest at t = -k."""

    def __init__(self, radius: float, length: float, taper: float) -> None:
        self.half, self.taper = length / 2, taper
        self.width = radius * np.sqrt(1 - extended(taper) ** 2)

    def points(self, normals: Array) -> Array:
        """Solve for the polar angle at which n.x is greatest: its slope falls through one zero."""
        kind, k = normals.dtype, self.taper
        width = np.asarray(self.width, dtype=kind)
        across = width * np.sqrt(normals[:, 0] ** 2 + normals[:, 1] ** 2)
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
        return _turned(normals, width * np.sin(angle) / (1 + k * cos), self.half * cos)


class Bow:
    """The circular arc from (0, -half) through (bulge, 0) to (0, half), in the (r, z) plane."""

    def __init__(self, bulge: float, half: float) -> None:
        self.half = extended(half)
        self.radius = (self.half**2 + extended(bulge) ** 2) / (2 * extended(bulge))
        self.centre = bulge - self.radius

    def farthest(self, r: Array, z: Array) -> tuple[Array, Array]:
        """Return (r, z) of the arc farthest along directions (r, z) with r >= 0."""
        radius, centre, half = (
            np.asarray(x, dtype=r.dtype) for x in (self.radius, self.centre, self.half)
        )
        length = np.sqrt(r * r + z * z)
        length = np.where(length > 0, length, 1)
        reach, height = centre + radius * r / length, radius * z / length
        beyond = (np.abs(height) >= half) | (reach <= 0)
        return np.where(beyond, 0, reach), np.where(beyond, np.where(z >= 0, half, -half), height)


class Spindle(Support):
    """A circular arc revolved about its chord, the axis."""

    def __init__(self, radius: float, length: float) -> None:
        self.bow = Bow(radius, length / 2)

    def points(self, normals: Array) -> Array:
        across = np.sqrt(normals[:, 0] ** 2 + normals[:, 1] ** 2)
        return _turned(normals, *self.bow.farthest(across, normals[:, 2]))


class Gore(Support):
    """At every height a regular polygon whose corners lie on circular arcs between two poles."""

    def __init__(self, radius: float, height: float, sides: int) -> None:
        self.bow, self.sides = Bow(radius, height / 2), sides
        angle = 2 * np.arctan2(extended(0), extended(-1)) * np.arange(sides) / sides
        self.corners = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)

    def points(self, normals: Array) -> Array:
        along = normals @ self.corners.T.astype(normals.dtype)
        chosen = along.argmax(axis=1)
        r, z = self.bow.farthest(along[np.arange(len(normals)), chosen], normals[:, 2])
        point = r[:, None] * self.corners[chosen].astype(normals.dtype)
        point[:, 2] = z
        return np.asarray(point)

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        number = int(rng.integers(self.sides))
        first, second = self.corners[number], self.corners[(number + 1) % self.sides]
        # the middle of a side of the unit polygon, over its own square: n.corner = cos(t)
        outward = (first + second) / (1 + first @ second)

        def ruling(t: Any) -> tuple[Array, Array]:
            normal = np.cos(t) * outward + np.sin(t) * extended([0, 0, 1])
            r = self.bow.centre + self.bow.radius * np.cos(t)
            lift = self.bow.radius * np.sin(t) * extended([0, 0, 1])
            return unit(normal), np.stack([r * first + lift, r * second + lift])

        top = INNER * float(np.arcsin(self.bow.half / self.bow.radius))
        return [family_flat(ruling, float(rng.uniform(-top, top)))]
