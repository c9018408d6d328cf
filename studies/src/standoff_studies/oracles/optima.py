"""The optimum of two features and its derivatives to 50 digits, by differences: a second truth.

A feature is a point, a segment, a circle, a plane or an ellipsoid, with an independent
parametrisation. The optimum is the root of Lagrange's conditions, found by Newton's method with a
Jacobian from differences; no formula of the library is used.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import mpmath as mp
import numpy as np
from numpy.typing import ArrayLike, NDArray

DIGITS = 50
STEP = mp.mpf(10) ** -15
"""Step of differences, in length and radians: their error is some 1e-15 of a third derivative."""

Array = NDArray[np.float64]
Real = Any  # mpmath's numbers have no types
Vector = list[Real]
Jet = tuple[Vector, list[Vector]]


class Feature(NamedTuple):
    """A point and tangents as functions of `freedom` parameters near 0, in the body's frame."""

    freedom: int
    jet: Callable[[Vector], Jet]
    radius: float = 0.0


def exact(values: ArrayLike) -> Vector:
    return [mp.mpf(float(x)) for x in np.ravel(values)]


def dot(a: Vector, b: Vector) -> Real:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    return [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]


def along(s: Real, a: Vector, b: Vector) -> Vector:
    return [s * x + y for x, y in zip(a, b, strict=True)]


def point(x: ArrayLike) -> Feature:
    x = exact(x)
    return Feature(0, lambda q: (x, []))


def segment(x: ArrayLike, way: ArrayLike) -> Feature:
    x, way = exact(x), exact(way)
    return Feature(1, lambda q: (along(q[0], way, x), [way]))


def plane(x: ArrayLike, first: ArrayLike, second: ArrayLike) -> Feature:
    x, first, second = exact(x), exact(first), exact(second)
    return Feature(2, lambda q: (along(q[0], first, along(q[1], second, x)), [first, second]))


def circle(radius: float, height: float, angle: float) -> Feature:
    """A circle about the z axis, starting at an angle."""
    r, z, start = exact([radius, height, angle])

    def jet(q: Vector) -> Jet:
        c, s = mp.cos(start + q[0]), mp.sin(start + q[0])
        return [r * c, r * s, z], [[-r * s, r * c, mp.mpf(0)]]

    return Feature(1, jet)


def ellipsoid(axes: ArrayLike, normal: ArrayLike) -> Feature:
    """Near the point with a normal; longitude and latitude are rotated so that no pole is near."""
    a = exact(axes)
    n = np.asarray(normal, dtype=float)
    middle = n * np.asarray(axes) / np.linalg.norm(n * np.asarray(axes))
    first = np.cross(middle, np.eye(3)[int(np.abs(middle).argmin())])
    first /= np.linalg.norm(first)
    m, e, f = exact(middle), exact(first), exact(np.cross(middle, first))

    def jet(q: Vector) -> Jet:
        raw = along(q[0], e, along(q[1], f, m))
        length = mp.sqrt(dot(raw, raw))
        on = [x / length for x in raw]
        tangents = []
        for way in (e, f):
            slope = dot(on, way)
            tangents.append([a[k] * (way[k] - slope * on[k]) / length for k in range(3)])
        return [a[k] * on[k] for k in range(3)], tangents

    return Feature(2, jet)


class Placed(NamedTuple):
    """A pose in exact numbers."""

    R: list[Vector]
    p: Vector

    @classmethod
    def of(cls, matrix: Array) -> Placed:
        return cls([exact(row) for row in matrix[:3, :3]], exact(matrix[:3, 3]))

    def turned(self, x: Vector) -> Vector:
        return [dot(row, x) for row in self.R]

    def moved(self, v: Vector, w: Vector) -> Placed:
        """R <- exp(w) R, p <- p + v."""
        angle = mp.sqrt(dot(w, w))
        if angle == 0:
            return Placed(self.R, along(mp.mpf(1), v, self.p))
        axis, columns = [x / angle for x in w], []
        for k in range(3):
            x = [row[k] for row in self.R]
            out = along(mp.cos(angle), x, along(mp.sin(angle), cross(axis, x), [mp.mpf(0)] * 3))
            columns.append(along((1 - mp.cos(angle)) * dot(axis, x), axis, out))
        rows = [[column[k] for column in columns] for k in range(3)]
        return Placed(rows, along(mp.mpf(1), v, self.p))


class Optimum(NamedTuple):
    distance: Real
    normal: Vector
    point_a: Vector
    point_b: Vector


Poses = tuple[Placed, Placed]


class Pair:
    """Two features near an optimum at two poses."""

    def __init__(
        self,
        features: tuple[Feature, Feature],
        poses: tuple[Array, Array],
        normal: ArrayLike,
        distance: float,
    ) -> None:
        a, b = features
        self.features, self.poses = features, (Placed.of(poses[0]), Placed.of(poses[1]))
        core = mp.mpf(distance) + mp.mpf(a.radius) + mp.mpf(b.radius)
        self.start = [mp.mpf(0)] * (a.freedom + b.freedom) + [*exact(normal), core]
        self.inverse = self._inverse(self.start)
        for _ in range(6):
            self.start = self._root(self.poses, self.start)
            self.inverse = self._inverse(self.start)
        self.start = self._root(self.poses, self.start)

    def _points(self, poses: Poses, y: Vector) -> tuple[Jet, Jet]:
        jets, first = [], 0
        for feature, pose in zip(self.features, poses, strict=True):
            x, tangents = feature.jet(y[first : first + feature.freedom])
            first += feature.freedom
            moved = along(mp.mpf(1), pose.turned(x), pose.p)
            jets.append((moved, [pose.turned(t) for t in tangents]))
        return jets[0], jets[1]

    def _residual(self, poses: Poses, y: Vector) -> Vector:
        (x, f), (z, g) = self._points(poses, y)
        n, d = y[-4:-1], y[-1]
        gap = [z[k] - x[k] - d * n[k] for k in range(3)]
        return [dot(t, n) for t in (*f, *g)] + [*gap, dot(n, n) - 1]

    def _inverse(self, y: Vector) -> list[Vector]:
        base, columns = self._residual(self.poses, y), []
        for k in range(len(y)):
            there = [x + (STEP if i == k else 0) for i, x in enumerate(y)]
            change = self._residual(self.poses, there)
            columns.append([(b - a) / STEP for a, b in zip(base, change, strict=True)])
        J = mp.matrix(len(y))
        for k, column in enumerate(columns):
            for i, value in enumerate(column):
                J[i, k] = value
        inverse = J**-1
        return [[inverse[i, k] for k in range(len(y))] for i in range(len(y))]

    def _root(self, poses: Poses, y: Vector) -> Vector:
        for _ in range(30):
            r = self._residual(poses, y)
            step = [sum(a * b for a, b in zip(row, r, strict=True)) for row in self.inverse]
            y = [a - b for a, b in zip(y, step, strict=True)]
            if max(abs(s) for s in step) < mp.mpf(10) ** -44:
                return y
        return y

    def at(self, twists: Vector) -> Optimum:
        """The optimum after both bodies have moved by 12 numbers."""
        first, second = self.poses
        poses = first.moved(twists[:3], twists[3:6]), second.moved(twists[6:9], twists[9:])
        y = self._root(poses, self.start)
        (x, _), (z, _) = self._points(poses, y)
        n, d = y[-4:-1], y[-1]
        a, b = (mp.mpf(f.radius) for f in self.features)
        return Optimum(d - a - b, n, along(a, n, x), along(-b, n, z))

    def derivatives(self) -> tuple[Array, Array, Array, Array, Array]:
        """Gradient (12,), Hessian (12, 12), Jacobian of the normal, and of both points (3, 12)."""
        zero = [mp.mpf(0)] * 12

        def step(h: Real, *at: int) -> Optimum:
            return self.at([sum((h for i in at if i == k), mp.mpf(0)) for k in range(12)])

        here, ahead = self.at(zero), [step(STEP, k) for k in range(12)]
        back = [step(-STEP, k) for k in range(12)]
        gradient = [
            (p.distance - m.distance) / (2 * STEP) for p, m in zip(ahead, back, strict=True)
        ]
        hessian = np.empty((12, 12))
        for i in range(12):
            for j in range(i + 1):
                both = step(STEP, i, j)
                second = both.distance - ahead[i].distance - ahead[j].distance + here.distance
                hessian[i, j] = hessian[j, i] = float(second / STEP**2)

        def jacobian(name: str) -> Array:
            after, before = ([getattr(x, name) for x in side] for side in (ahead, back))
            return np.array(
                [
                    [float((b - a) / (2 * STEP)) for a, b in zip(m, p, strict=True)]
                    for p, m in zip(after, before, strict=True)
                ]
            ).T

        jacobians = [jacobian(name) for name in ("normal", "point_a", "point_b")]
        normal, on_a, on_b = jacobians
        return np.array([float(x) for x in gradient]), hessian, normal, on_a, on_b
