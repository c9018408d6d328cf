"""Support points of the ready-made shapes by closed forms, independent of the kernels.

For a direction n (any length) the support point s(n) is the point of the body farthest along n.
Nothing here is shared with the kernels, with surfaces, or with features: the truth of the
accuracy report rests on these formulas and on nothing else. Body frame; directions (k, 3) in
float64 or in ``numpy.longdouble``, which the points then have too.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import ConvexHull

from standoff.accuracy.flats import Flat, arc_flat, face_flat

Array = NDArray[Any]

COPLANAR = 1e-9
"""Two facets of a hull are one face if their equations differ by no more (no unit, and lengths
of order 1)."""


def unit(vectors: Array) -> Array:
    """Return the rows at unit length; a zero row stays zero."""
    length = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
    return np.asarray(vectors / np.where(length > 0, length, 1))


def dot(first: Array, second: Array) -> Array:
    """Return the row-wise inner products."""
    return np.asarray((first * second).sum(axis=-1))


def extended(values: ArrayLike) -> Array:
    """Return an array in extended precision, where the platform has it."""
    return np.asarray(values, dtype=np.longdouble)


class Support(ABC):
    """A closed convex body, known by its support points."""

    @abstractmethod
    def points(self, normals: Array) -> Array:
        """Return support points (k, 3) for directions (k, 3)."""

    def heights(self, normals: Array) -> Array:
        """Return support values (k,): n.s(n)."""
        return dot(normals, self.points(normals))

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        """Return flat faces and straight lines of the boundary, one drawn of each family."""
        del rng
        return []


class Hull(Support):
    """The convex hull of vertices (m, 3); one is a point, two a segment."""

    def __init__(self, vertices: ArrayLike) -> None:
        self.vertices: Array = np.atleast_2d(np.asarray(vertices, dtype=np.float64))
        self._faces: list[tuple[Array, Array]] | None = None

    def points(self, normals: Array) -> Array:
        chosen = (normals @ self.vertices.T.astype(normals.dtype)).argmax(axis=1)
        return np.asarray(self.vertices[chosen].astype(normals.dtype))

    @property
    def faces(self) -> list[tuple[Array, Array]]:
        """Unit normal (3,), extended, and corner numbers of every face."""
        if self._faces is None:
            self._faces = _faces(self.vertices)
        return self._faces

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        if len(self.vertices) == 1:
            return []
        if len(self.vertices) == 2:
            step = extended(self.vertices[1] - self.vertices[0])
            across = unit(np.cross(step, extended(rng.normal(size=3))))
            around = unit(np.cross(step, across))
            turn = float(rng.uniform(0, 2 * np.pi))
            return [arc_flat(across, around, extended(self.vertices), turn)]
        normal, corners = self.faces[int(rng.integers(len(self.faces)))]
        found = [face_flat(normal, extended(self.vertices[corners]))]
        edge = self._edge(rng, normal, corners)
        return found if edge is None else [*found, edge]

    def _edge(self, rng: np.random.Generator, normal: Array, corners: Array) -> Flat | None:
        """A random edge of a face, with a normal between those of its two faces."""
        for other, theirs in (self.faces[i] for i in rng.permutation(len(self.faces))):
            shared = np.intersect1d(corners, theirs)
            if len(shared) != 2 or other is normal:
                continue
            ends = extended(self.vertices[shared])
            sideways = unit(other - (other @ normal) * normal)
            angle = float(np.arctan2(other @ sideways, other @ normal))
            return arc_flat(normal, sideways, ends, float(rng.uniform(0.05, 0.95)) * angle)
        return None


def _faces(vertices: Array) -> list[tuple[Array, Array]]:
    hull = ConvexHull(vertices)
    scale = float(np.ptp(vertices, axis=0).max())
    left = np.ones(len(hull.simplices), dtype=bool)
    faces = []
    for number, equation in enumerate(hull.equations):
        if not left[number]:
            continue
        lengths = np.array([1.0, 1.0, 1.0, 1.0 / scale])
        same = np.abs((hull.equations - equation) * lengths).max(axis=1) < COPLANAR
        left &= ~same
        a, b, c = extended(vertices[hull.simplices[number]])
        normal = unit(np.cross(b - a, c - a))
        outward = normal if normal @ equation[:3] > 0 else -normal
        faces.append((outward, np.unique(hull.simplices[same])))
    return faces


class Swept(Support):
    """The Minkowski sum of a core and a ball."""

    def __init__(self, core: Support, radius: float) -> None:
        self.core, self.radius = core, radius

    def points(self, normals: Array) -> Array:
        return self.core.points(normals) + self.radius * unit(normals)

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        return [flat.moved_out(self.radius) for flat in self.core.flats(rng)]


class Ellipsoid(Support):
    """An ellipsoid of semi-axes along x, y, z."""

    def __init__(self, *axes: float) -> None:
        self.axes: Array = np.array(axes)

    def points(self, normals: Array) -> Array:
        return self.axes * unit(self.axes * normals)


class Superellipsoid(Support):
    """``(|x/a|^(2/e2) + |y/b|^(2/e2))^(e2/e1) + |z/c|^(2/e1) <= 1``.

    Its gauge is a p-norm within a p-norm, so its support function is the same of the dual
    exponents 2/(2 - e), and the support point is the gradient of that.
    """

    def __init__(self, a: float, b: float, c: float, e1: float, e2: float) -> None:
        self.axes: Array = np.array([a, b, c])
        self.along, self.around = 2 / (2 - e1), 2 / (2 - e2)

    def points(self, normals: Array) -> Array:
        x, y, z = (normals * self.axes).T
        disc, by_x, by_y = _norm(x, y, self.around)
        _, by_disc, by_z = _norm(disc, z, self.along)
        return np.stack([by_disc * by_x, by_disc * by_y, by_z], axis=1) * self.axes


def _norm(x: Array, y: Array, p: float) -> tuple[Array, Array, Array]:
    """``(|x|^p + |y|^p)^(1/p)`` and its two slopes; scaled, so that no power underflows."""
    most = np.maximum(np.abs(x), np.abs(y))
    scale = np.where(most > 0, most, 1)
    a, b = np.abs(x) / scale, np.abs(y) / scale
    length = (a**p + b**p) ** (1 / np.asarray(p, dtype=x.dtype))
    safe = np.where(length > 0, length, 1)
    by_x = np.where(most > 0, np.sign(x) * (a / safe) ** (p - 1), 0)
    by_y = np.where(most > 0, np.sign(y) * (b / safe) ** (p - 1), 0)
    return most * length, by_x, by_y


class HalfSpace(Support):
    """z <= 0: supported along +z only."""

    def points(self, normals: Array) -> Array:
        along = (normals[:, 0] == 0) & (normals[:, 1] == 0) & (normals[:, 2] > 0)
        return np.where(along[:, None], 0, np.full_like(normals, np.inf))

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        corners = np.column_stack([rng.normal(size=(3, 2)), np.zeros(3)])
        return [face_flat(extended([0, 0, 1]), extended(corners))]


class Lens(Support):
    """The intersection of three balls of ``radius`` around -offset (cos 120°i, sin 120°i, 0).

    Along any direction the farthest point is that of one ball, or of the circle of two, or one
    of the two tips: the farthest of those that lie in all balls.
    """

    SLACK = 8 * np.finfo(float).eps
    """Relative slack of a point's membership in a ball: a few roundings of its radius."""

    def __init__(self, radius: float, offset: float) -> None:
        angle = 2 * np.pi * np.arange(3) / 3
        self.radius = radius
        self.centres: Array = -offset * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
        self.tip = np.array([0.0, 0.0, np.sqrt((radius - offset) * (radius + offset))])

    def _inside(self, points: Array, *skipped: int) -> Array:
        steps = points[:, None] - self.centres
        near = np.sqrt(dot(steps, steps)) <= self.radius * (1 + self.SLACK)
        near[:, list(skipped)] = True
        return np.asarray(near.all(axis=1))

    def points(self, normals: Array) -> Array:
        tips = np.where(normals[:, 2:] >= 0, self.tip, -self.tip).astype(normals.dtype)
        best, height = tips, dot(normals, tips)
        for i in range(3):
            first, second = self.centres[i], self.centres[i - 1]
            axis = unit(second - first)
            across = normals - (normals @ axis)[:, None] * axis
            half = float(np.linalg.norm(second - first)) / 2
            circle = np.sqrt((self.radius - half) * (self.radius + half))
            ball = first + self.radius * unit(normals)
            ring = (first + second) / 2 + circle * unit(across)
            for found, inside in (
                (ball, self._inside(ball, i)),
                (ring, self._inside(ring, i, i - 1)),
            ):
                better = inside & (dot(normals, found) > height)
                best = np.where(better[:, None], found, best)
                height = np.where(better, dot(normals, found), height)
        return best
