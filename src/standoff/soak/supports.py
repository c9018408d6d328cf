"""Support functions of the soak's bodies in closed form, many directions at once.

The judge of the soak: nothing here comes from the kernels. Every body is centred with axis z, as
``so.shapes`` has it. ``points`` gives the farthest points along directions, ``outside`` how far
points lie outside (length; first order near the surface, negative inside).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

Array = NDArray[np.float64]

TINY = 1e-300
"""Keeps a zero length from being divided by; no length of a body is near it."""

MEMBERSHIP = 1e-14
"""Part of its radius by which a lens's candidate may lie outside a ball: roundoff of its making.
What it adds to a support value is less than roundoff, as rival candidates meet there."""

HALVINGS = 30
"""Of the half turn that holds an egg's support angle: its value is good to the square."""


def lengths(vectors: Array) -> Array:
    """Return the lengths (n,) of rows (n, k)."""
    return np.asarray(np.sqrt(np.einsum("ij,ij->i", vectors, vectors)))


def dots(a: Array, b: Array) -> Array:
    """Return the inner products (n,) of rows (n, k)."""
    return np.asarray(np.einsum("ij,ij->i", a, b))


class Support(ABC):
    """A convex body by its support function. `radius` is that of the ball swept over its core."""

    radius: float = 0.0

    @abstractmethod
    def points(self, n: Array) -> Array:
        """Return the farthest points (n, 3) along unit directions (n, 3)."""

    @abstractmethod
    def outside(self, x: Array) -> Array:
        """Return how far points (n, 3) lie outside, (n,)."""


class HalfSpace(Support):
    """z <= 0: its support is finite along +z alone, where it is 0; other directions give nan."""

    def points(self, n: Array) -> Array:
        return np.full_like(n, np.nan)

    def outside(self, x: Array) -> Array:
        return x[:, 2]


class Ellipsoid(Support):
    """Of given semi-axes."""

    def __init__(self, axes: Sequence[float]) -> None:
        self.axes = np.array(axes, dtype=np.float64)

    def points(self, n: Array) -> Array:
        scaled = n * self.axes
        return scaled * (self.axes / lengths(scaled)[:, None])

    def outside(self, x: Array) -> Array:
        scaled = x / self.axes
        gauge = lengths(scaled)
        slope = lengths(scaled / self.axes) / np.maximum(gauge, TINY)
        return (gauge - 1.0) / np.maximum(slope, TINY)


class Box(Support):
    """Of given half lengths; also the point and, with two of them zero, the segment."""

    def __init__(self, half: Sequence[float]) -> None:
        self.half = np.array(half, dtype=np.float64)

    def points(self, n: Array) -> Array:
        return np.copysign(self.half, n)

    def outside(self, x: Array) -> Array:
        return np.asarray((np.abs(x) - self.half).max(axis=1))


class Hull(Support):
    """Of given vertices (m, 3)."""

    def __init__(self, vertices: Array) -> None:
        self.vertices = np.array(vertices, dtype=np.float64)
        self.planes = np.array(ConvexHull(self.vertices).equations)

    def points(self, n: Array) -> Array:
        return np.asarray(self.vertices[(n @ self.vertices.T).argmax(axis=1)])

    def outside(self, x: Array) -> Array:
        return np.asarray((x @ self.planes[:, :3].T + self.planes[:, 3]).max(axis=1))


class Swept(Support):
    """The sum of a core and a ball."""

    def __init__(self, core: Support, radius: float) -> None:
        self.core, self.radius = core, radius

    def points(self, n: Array) -> Array:
        return self.core.points(n) + self.radius * n

    def outside(self, x: Array) -> Array:
        """Unknown: the core is judged, at a point less its radius along the normal."""
        raise NotImplementedError("ask the core")


def _disc(n: Array, radius: float, height: float) -> Array:
    """The farthest points of a disc square to z; its point at angle 0 where all are."""
    across = np.hypot(n[:, 0], n[:, 1])
    flat = across <= TINY
    found = np.empty_like(n)
    found[:, :2] = n[:, :2] * (radius / np.where(flat, 1.0, across))[:, None]
    found[flat, 0] = radius
    found[:, 2] = height
    return found


class Cylinder(Support):
    """Of a radius and full length."""

    def __init__(self, radius: float, length: float) -> None:
        self.r, self.half = radius, 0.5 * length

    def points(self, n: Array) -> Array:
        found = _disc(n, self.r, 0.0)
        found[:, 2] = np.copysign(self.half, n[:, 2])
        return found

    def outside(self, x: Array) -> Array:
        return np.maximum(np.hypot(x[:, 0], x[:, 1]) - self.r, np.abs(x[:, 2]) - self.half)


class Cone(Support):
    """Base of a radius at -height/2, apex at +height/2."""

    def __init__(self, radius: float, height: float) -> None:
        self.r, self.half = radius, 0.5 * height
        self.slant = np.array([height, radius]) / np.hypot(height, radius)

    def points(self, n: Array) -> Array:
        found = _disc(n, self.r, -self.half)
        apex = dots(n, found) < n[:, 2] * self.half
        found[apex] = (0.0, 0.0, self.half)
        return found

    def outside(self, x: Array) -> Array:
        across = np.hypot(x[:, 0], x[:, 1])
        side = self.slant[0] * across + self.slant[1] * (x[:, 2] - self.half)
        return np.asarray(np.maximum(side, -self.half - x[:, 2]))


class Cap(Support):
    """The part z >= offset of a ball."""

    def __init__(self, radius: float, offset: float) -> None:
        self.r, self.offset = radius, offset
        self.rim = float(np.sqrt((radius - offset) * (radius + offset)))

    def points(self, n: Array) -> Array:
        below = self.r * n[:, 2] < self.offset
        return np.where(below[:, None], _disc(n, self.rim, self.offset), self.r * n)

    def outside(self, x: Array) -> Array:
        return np.maximum(lengths(x) - self.r, self.offset - x[:, 2])


class Lens(Support):
    """The intersection of three balls whose centres lie at `offset` about z."""

    def __init__(self, radius: float, offset: float) -> None:
        angle = 2.0 * np.pi / 3.0 * np.arange(3)
        self.r, self.offset = radius, offset
        self.centres = -offset * np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
        after, last = np.roll(self.centres, -1, axis=0), np.roll(self.centres, -2, axis=0)
        self.middles = 0.5 * (after + last)
        half = 0.5 * float(np.linalg.norm(after[0] - last[0]))
        self.axes = (last - after) / (2.0 * half)
        self.reach = float(np.sqrt((radius - half) * (radius + half)))
        self.tip = float(np.sqrt((radius - offset) * (radius + offset)))

    def points(self, n: Array) -> Array:
        heights = n @ self.centres.T
        best, kind = self.tip * np.abs(n[:, 2]), np.full(len(n), -1)
        slack = MEMBERSHIP * self.r * self.r
        apart = 3.0 * self.offset * self.offset
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            # in both other balls: |c_k + r n - c_i|² <= r²
            inside = apart + 2.0 * self.r * (
                heights[:, k] - np.minimum(heights[:, i], heights[:, j])
            )
            value = heights[:, k] + self.r
            better = (value > best) & (inside <= slack)
            best[better], kind[better] = value[better], k
            # the circle of balls i and j, about half their centres' sum; in ball k:
            across, reach = n - (n @ self.axes[k])[:, None] * self.axes[k], self.reach
            size = np.maximum(lengths(across), TINY)
            value = 0.5 * (heights[:, i] + heights[:, j]) + reach * size
            step = self.middles[k] - self.centres[k]
            within = (
                step @ step
                + 2.0 * reach * (across @ step) / size
                + (reach + self.r) * (reach - self.r)
            )
            better = (value > best) & (within <= slack)
            best[better], kind[better] = value[better], 3 + k
        return self._chosen(n, kind)

    def _chosen(self, n: Array, kind: NDArray[np.int64]) -> Array:
        """The points that win: a tip (-1), on ball k (k) or the circle opposite to it (3 + k)."""
        found = np.zeros_like(n)
        found[:, 2] = np.copysign(self.tip, n[:, 2])
        for k in range(3):
            mine = kind == k
            found[mine] = self.centres[k] + self.r * n[mine]
            mine = kind == 3 + k
            across = n[mine] - (n[mine] @ self.axes[k])[:, None] * self.axes[k]
            scale = self.reach / np.maximum(lengths(across), TINY)
            found[mine] = self.middles[k] + across * scale[:, None]
        return found

    def outside(self, x: Array) -> Array:
        return np.asarray(np.max([lengths(x - c) for c in self.centres], axis=0) - self.r)


def _norm(x: Array, y: Array, p: float) -> tuple[Array, Array, Array]:
    """(|x|^p + |y|^p)^(1/p) and its slopes by x and y."""
    a, b = np.abs(x), np.abs(y)
    scale = np.maximum(np.maximum(a, b), TINY)
    a, b = a / scale, b / scale
    power_a, power_b = a ** (p - 1.0), b ** (p - 1.0)
    total = power_a * a + power_b * b
    value = total ** (1.0 / p)
    slope = value / np.maximum(total, TINY)
    return (
        scale * value,
        np.copysign(power_a * slope, x),
        np.copysign(power_b * slope, y),
    )


def _nested(rows: Array, inner: float, outer: float) -> tuple[Array, Array]:
    """The outer norm of (inner norm of x and y, z), and its gradient."""
    around, by_x, by_y = _norm(rows[:, 0], rows[:, 1], inner)
    value, by_around, by_z = _norm(around, rows[:, 2], outer)
    return value, np.column_stack([by_around * by_x, by_around * by_y, by_z])


class Superellipsoid(Support):
    """Of semi-axes and exponents e1, e2: its support function is the dual nested norm."""

    def __init__(self, axes: Sequence[float], e1: float, e2: float) -> None:
        self.axes = np.array(axes, dtype=np.float64)
        self.gauge = 2.0 / e2, 2.0 / e1
        self.dual = 2.0 / (2.0 - e2), 2.0 / (2.0 - e1)

    def points(self, n: Array) -> Array:
        return _nested(n * self.axes, *self.dual)[1] * self.axes

    def outside(self, x: Array) -> Array:
        value, gradient = _nested(x / self.axes, *self.gauge)
        return (value - 1.0) / np.maximum(lengths(gradient / self.axes), TINY)


class Egg(Support):
    """x, y of the unit sphere shrunk by 1 + k z: see ``so.shapes.egg``."""

    def __init__(self, radius: float, length: float, taper: float) -> None:
        self.half, self.k = 0.5 * length, taper
        self.width = radius * float(np.sqrt(1.0 - taper * taper))

    def points(self, n: Array) -> Array:
        across = np.hypot(n[:, 0], n[:, 1])
        low, high = np.zeros(len(n)), np.full(len(n), np.pi)
        for _ in range(HALVINGS):
            angle = 0.5 * (low + high)
            c = np.cos(angle)
            rising = across * self.width * (c + self.k) > (
                n[:, 2] * self.half * np.sin(angle) * np.square(1.0 + self.k * c)
            )
            np.copyto(low, angle, where=rising)
            np.copyto(high, angle, where=~rising)
        angle = 0.5 * (low + high)
        c = np.cos(angle)
        found = _disc(n, 1.0, 0.0)
        found[:, :2] *= (self.width * np.sin(angle) / (1.0 + self.k * c))[:, None]
        found[:, 2] = self.half * c
        return found

    def outside(self, x: Array) -> Array:
        t = x[:, 2] / self.half
        wide, r = 1.0 + self.k * t, np.hypot(x[:, 0], x[:, 1])
        value = np.square(r * wide) - np.square(self.width) * (1.0 - t) * (1.0 + t)
        across = 2.0 * r * wide * wide
        along = (2.0 * r * r * wide * self.k + 2.0 * np.square(self.width) * t) / self.half
        return np.asarray(value / np.maximum(np.hypot(across, along), TINY))


class Bow:
    """The circular arc from (0, -half) through (bulge, 0) to (0, half), in the (r, z) plane."""

    def __init__(self, bulge: float, half: float) -> None:
        self.half = half
        self.radius = 0.5 * (half * half + bulge * bulge) / bulge
        self.centre = bulge - self.radius

    def points(self, r: Array, z: Array) -> tuple[Array, Array]:
        """Return the r and z farthest along directions (r, z), r >= 0."""
        size = np.maximum(np.hypot(r, z), TINY)
        reach, height = self.centre + self.radius * r / size, self.radius * z / size
        beyond = (reach <= 0.0) | (np.abs(height) >= self.half)
        return np.where(beyond, 0.0, reach), np.where(beyond, np.copysign(self.half, z), height)

    def outside(self, r: Array, z: Array) -> Array:
        return np.hypot(r - self.centre, z) - self.radius


class Spindle(Support):
    """A circular arc turned about its chord."""

    def __init__(self, radius: float, length: float) -> None:
        self.bow = Bow(radius, 0.5 * length)

    def points(self, n: Array) -> Array:
        r, z = self.bow.points(np.hypot(n[:, 0], n[:, 1]), n[:, 2])
        found = _disc(n, 1.0, 0.0)
        found[:, :2] *= r[:, None]
        found[:, 2] = z
        return found

    def outside(self, x: Array) -> Array:
        return np.asarray(self.bow.outside(np.hypot(x[:, 0], x[:, 1]), x[:, 2]))


class Gore(Support):
    """At every height a regular polygon, its corners on circular arcs from pole to pole."""

    def __init__(self, radius: float, height: float, sides: int) -> None:
        self.bow = Bow(radius, 0.5 * height)
        angle = 2.0 * np.pi / sides * np.arange(sides)
        middle = angle + np.pi / sides
        self.corners = np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
        self.middles = np.column_stack([np.cos(middle), np.sin(middle), 0.0 * angle])
        self.shrink = float(np.cos(np.pi / sides))

    def points(self, n: Array) -> Array:
        along = n @ self.corners.T
        chosen = along.argmax(axis=1)
        r, z = self.bow.points(along[np.arange(len(n)), chosen], n[:, 2])
        found = r[:, None] * self.corners[chosen]
        found[:, 2] = z
        return np.asarray(found)

    def outside(self, x: Array) -> Array:
        reach = np.maximum((x @ self.middles.T).max(axis=1) / self.shrink, 0.0)
        height = self.bow.outside(reach, x[:, 2])
        slope = np.hypot((reach - self.bow.centre) / self.shrink, x[:, 2]) / self.bow.radius
        return np.asarray(height / np.maximum(slope, 1.0))


class Dome(Support):
    """0 <= z <= h (1 - r²/R²): a paraboloid on a disc."""

    def __init__(self, radius: float, height: float) -> None:
        self.r, self.h = radius, height

    def points(self, n: Array) -> Array:
        across, up = np.hypot(n[:, 0], n[:, 1]), np.maximum(n[:, 2], 0.0)
        v = np.minimum(across * self.r / np.maximum(2.0 * self.h * up, TINY), 1.0)
        v = np.where(across > 0.0, v, np.where(up > 0.0, 0.0, 1.0))
        found = _disc(n, self.r, 0.0)
        found[:, :2] *= v[:, None]
        found[:, 2] = self.h * (1.0 - v) * (1.0 + v)
        return found

    def outside(self, x: Array) -> Array:
        r = np.hypot(x[:, 0], x[:, 1]) / self.r
        value = x[:, 2] - self.h * (1.0 - r) * (1.0 + r)
        slope = np.hypot(1.0, 2.0 * self.h * r / self.r)
        return np.maximum(value / slope, -x[:, 2])
