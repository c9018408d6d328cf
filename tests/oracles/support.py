"""Support functions and support points of the ready-made convex shapes, in the body frame.

All shapes are centred with axis z: semi-axes for the ellipsoid; full lengths for the box
(rounding included), the cylinder, the cone (apex at +height/2) and the capsule (its cylindrical
part only). ``Shape``, ``Affine`` and ``Placed`` come from ``shape``, planar loops are in ``loops``.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .facets import Facets
from .shape import Affine, Placed, Shape, directions, dot, unit

__all__ = [
    "Affine",
    "Box",
    "Cap",
    "Capsule",
    "Cone",
    "Cylinder",
    "Ellipsoid",
    "HalfSpace",
    "Lens",
    "Placed",
    "Point",
    "Polytope",
    "Segment",
    "Shape",
    "SharpBox",
    "Sphere",
    "Swept",
    "Vertices",
    "directions",
    "unit",
]

Array = NDArray[Any]

MEMBERSHIP = 8 * np.finfo(float).eps
"""Relative slack of a point's membership in a ball of a lens: a few roundings of its radius."""


def _best(normals: Array, candidates: Sequence[Array], allowed: Sequence[Array]) -> Array:
    """Return for each direction the allowed candidate of greatest ``n.x``."""
    values = np.stack(
        [
            np.where(ok, dot(normals, point), -np.inf)
            for point, ok in zip(candidates, allowed, strict=True)
        ]
    )
    chosen = values.argmax(axis=0)
    return np.stack(candidates)[chosen, np.arange(len(normals))]


class Vertices(Shape):
    """Convex hull of ``vertices`` (m, 3): points, segments and polytopes."""

    def __init__(self, vertices: ArrayLike) -> None:
        self.vertices: Array = np.atleast_2d(np.asarray(vertices, dtype=float))
        if self.vertices.ndim != 2 or self.vertices.shape[1] != 3:
            raise ValueError(f"vertices must have shape (m, 3), got {self.vertices.shape}")
        self.bounding_radius = float(np.linalg.norm(self.vertices, axis=1).max())

    def points(self, normals: Array) -> Array:
        return self.vertices[(normals @ self.vertices.T).argmax(axis=1)].astype(normals.dtype)

    def maximisers(self, normal: ArrayLike, tolerance: float) -> Array:
        direction = unit(directions(normal))[0]
        values = self.vertices @ direction
        return self.vertices[values >= values.max() - tolerance * self.bounding_radius]


class Point(Vertices):
    """The origin."""

    def __init__(self) -> None:
        super().__init__(np.zeros((1, 3)))


class Segment(Vertices):
    """A segment of full ``length`` along z."""

    def __init__(self, length: float) -> None:
        self.length = float(length)
        super().__init__([[0, 0, -length / 2], [0, 0, length / 2]])

    def special_normals(self, rng: np.random.Generator) -> Array:
        angle = rng.uniform(0, 2 * np.pi)
        return np.array([[np.cos(angle), np.sin(angle), 0.0]])


class Polytope(Vertices):
    """Convex hull of ``vertices`` (m, 3), with its faces and edges from Qhull."""

    def __init__(self, vertices: ArrayLike) -> None:
        super().__init__(vertices)
        self.facets = Facets(self.vertices)

    def special_normals(self, rng: np.random.Generator) -> Array:
        first, second = self.facets.edge_normals
        weight = rng.uniform(0, 1, (len(first), 1))
        return np.vstack([self.facets.normals, unit(weight * first + (1 - weight) * second)])


class Sphere(Shape):
    """A ball of radius ``radius``."""

    def __init__(self, radius: float) -> None:
        self.radius = self.bounding_radius = self.sweep = float(radius)

    def points(self, normals: Array) -> Array:
        return self.radius * unit(normals)


class Ellipsoid(Shape):
    """An ellipsoid of semi-axes ``a, b, c``."""

    def __init__(self, a: float, b: float, c: float) -> None:
        self.axes: Array = np.array([a, b, c], dtype=float)
        self.bounding_radius = float(self.axes.max())

    def points(self, normals: Array) -> Array:
        return self.axes * unit(self.axes * normals)


class Swept(Shape):
    """Minkowski sum of ``core`` and a ball of radius ``sweep``."""

    def __init__(self, core: Shape, sweep: float) -> None:
        self.core = core
        self.sweep = float(sweep)
        self.bounding_radius = core.bounding_radius + self.sweep

    def points(self, normals: Array) -> Array:
        return self.core.points(normals) + self.sweep * unit(normals)

    def maximisers(self, normal: ArrayLike, tolerance: float) -> Array:
        direction = unit(directions(normal))
        return self.core.maximisers(normal, tolerance) + self.sweep * direction

    def special_normals(self, rng: np.random.Generator) -> Array:
        return self.core.special_normals(rng)


class Capsule(Swept):
    """A segment of ``length`` along z swept by a ball of radius ``radius``."""

    def __init__(self, radius: float, length: float) -> None:
        super().__init__(Segment(length), radius)
        self.radius, self.length = float(radius), float(length)


class SharpBox(Polytope):
    """A box of full lengths ``x, y, z`` without rounding."""

    def __init__(self, x: float, y: float, z: float) -> None:
        self.half: Array = np.array([x, y, z], dtype=float) / 2
        signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
        super().__init__(signs * self.half)

    def points(self, normals: Array) -> Array:
        return np.where(normals >= 0, self.half, -self.half)


class Box(Swept):
    """A box of outer full lengths ``x, y, z``, edges and corners rounded by ``rounding``."""

    def __init__(self, x: float, y: float, z: float, rounding: float = 0.0) -> None:
        if not 0 <= 2 * rounding < min(x, y, z):
            raise ValueError(f"rounding {rounding} must be less than half of {min(x, y, z)}")
        core = SharpBox(x - 2 * rounding, y - 2 * rounding, z - 2 * rounding)
        super().__init__(core, rounding)
        self.half: Array = core.half


def _disc(normals: Array, radius: float, z: float, tolerance: float = 0.0) -> Array:
    """Return support points of the disc of ``radius`` at height ``z``; its centre on the axis."""
    radial = normals * np.array([1.0, 1.0, 0.0])
    flat = np.sqrt(dot(radial, radial)) <= tolerance * np.sqrt(dot(normals, normals))
    point = radius * unit(radial)
    point[flat] = 0.0
    point[:, 2] = z
    return point


def _rim(radius: float, z: float) -> Array:
    """Return three points of a circle, enough to span an area of its disc."""
    angle = 2 * np.pi * np.arange(3) / 3
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(3, z)], axis=1)


class Cylinder(Shape):
    """A cylinder of radius ``radius`` and full length ``length``."""

    def __init__(self, radius: float, length: float) -> None:
        self.radius, self.length = float(radius), float(length)
        self.bounding_radius = float(np.hypot(radius, length / 2))

    def points(self, normals: Array) -> Array:
        point = _disc(normals, self.radius, 0.0)
        point[:, 2] = np.where(normals[:, 2] >= 0, self.length / 2, -self.length / 2)
        return point

    def maximisers(self, normal: ArrayLike, tolerance: float) -> Array:
        direction = unit(directions(normal))
        point = self.points(direction)
        if np.hypot(direction[0, 0], direction[0, 1]) <= tolerance:
            return _rim(self.radius, point[0, 2])
        if abs(direction[0, 2]) <= tolerance:
            return np.vstack([point, point * np.array([1, 1, -1])])
        return point

    def special_normals(self, rng: np.random.Generator) -> Array:
        angle = rng.uniform(0, 2 * np.pi)
        return np.array([[0, 0, 1], [0, 0, -1], [np.cos(angle), np.sin(angle), 0.0]])


class Cone(Shape):
    """A cone: apex at +height/2, base disc of ``radius`` at -height/2."""

    def __init__(self, radius: float, height: float) -> None:
        self.radius, self.height = float(radius), float(height)
        self.apex: Array = np.array([0.0, 0.0, self.height / 2])
        self.bounding_radius = float(max(np.hypot(radius, height / 2), height / 2))

    def points(self, normals: Array) -> Array:
        base = _disc(normals, self.radius, -self.height / 2)
        apex = np.broadcast_to(self.apex, base.shape).astype(base.dtype)
        always = np.ones(len(base), dtype=bool)
        return _best(normals, [apex, base], [always, always])

    def maximisers(self, normal: ArrayLike, tolerance: float) -> Array:
        direction = unit(directions(normal))
        if direction[0, 2] < 0 and np.hypot(direction[0, 0], direction[0, 1]) <= tolerance:
            return _rim(self.radius, -self.height / 2)
        base = _disc(direction, self.radius, -self.height / 2)
        if abs(dot(direction, base - self.apex)[0]) <= tolerance * self.bounding_radius:
            return np.vstack([base, self.apex])
        return self.points(direction)

    def special_normals(self, rng: np.random.Generator) -> Array:
        angle = rng.uniform(0, 2 * np.pi)
        side = [self.height * np.cos(angle), self.height * np.sin(angle), self.radius]
        return unit(np.array([[0, 0, -1], side]))


class HalfSpace(Shape):
    """All points with z <= 0: finite support only along +z."""

    bounding_radius = float("inf")

    def points(self, normals: Array) -> Array:
        along = (normals[:, 0] == 0) & (normals[:, 1] == 0) & (normals[:, 2] > 0)
        point = np.full_like(normals, np.inf)
        point[along] = 0.0
        return point

    def support_many(self, normals: ArrayLike) -> tuple[Array, Array]:
        found = self.points(directions(normals))
        return found[:, 2].copy(), found

    def special_normals(self, rng: np.random.Generator) -> Array:
        del rng
        return np.array([[0.0, 0.0, 1.0]])


class Lens(Shape):
    """Intersection of ``count`` balls of ``radius`` centred at -offset (cos t_i, sin t_i, 0)."""

    def __init__(self, radius: float, offset: float, count: int = 3) -> None:
        if not 0 < offset < radius or count < 2:
            raise ValueError(f"need 0 < offset < radius, count >= 2; got {offset}, {radius}")
        self.radius, self.offset, self.count = float(radius), float(offset), int(count)
        angle = 2 * np.pi * np.arange(count) / count
        self.centres: Array = -offset * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
        self.tip = float(np.sqrt((radius - offset) * (radius + offset)))
        self.pairs = [(i, j) for i in range(count) for j in range(i)]
        self.bounding_radius = self.tip

    def contains(self, points: Array, skip: tuple[int, ...] = ()) -> Array:
        """Return (k,) whether the points lie in every ball but those of ``skip``."""
        inside = np.ones(len(points), dtype=bool)
        for index, centre in enumerate(self.centres):
            if index not in skip:
                step = points - centre
                inside &= np.sqrt(dot(step, step)) <= self.radius * (1 + MEMBERSHIP)
        return inside

    def circle(self, first: int, second: int) -> tuple[Array, Array, float]:
        """Return centre, unit axis and radius of the circle of two balls' spheres."""
        start, end = self.centres[first], self.centres[second]
        half = np.linalg.norm(end - start) / 2
        radius = np.sqrt((self.radius - half) * (self.radius + half))
        return (start + end) / 2, unit((end - start)[None])[0], float(radius)

    def points(self, normals: Array) -> Array:
        candidates: list[Array] = []
        allowed: list[Array] = []
        for index, centre in enumerate(self.centres):
            candidates.append(centre + self.radius * unit(normals))
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


class Cap(Shape):
    """The part z >= ``height`` of the ball of ``radius`` centred at the origin."""

    def __init__(self, radius: float, height: float) -> None:
        if not -radius < height < radius:
            raise ValueError(f"height {height} must lie within +-{radius}")
        self.radius, self.height = float(radius), float(height)
        self.rim = float(np.sqrt((radius - height) * (radius + height)))
        self.bounding_radius = self.radius

    def points(self, normals: Array) -> Array:
        ball = self.radius * unit(normals)
        return np.where(ball[:, 2:] >= self.height, ball, _disc(normals, self.rim, self.height))

    def maximisers(self, normal: ArrayLike, tolerance: float) -> Array:
        direction = unit(directions(normal))
        if direction[0, 2] < 0 and np.hypot(direction[0, 0], direction[0, 1]) <= tolerance:
            return _rim(self.rim, self.height)
        return self.points(direction)

    def special_normals(self, rng: np.random.Generator) -> Array:
        del rng
        return np.array([[0.0, 0.0, -1.0]])
