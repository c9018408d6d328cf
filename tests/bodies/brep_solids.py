"""Boundaries of solids that are not convex, with what is known of each in closed form."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

import standoff as so
from standoff.bodies import Apex, Edge, Face
from standoff.geometry import (
    Cone,
    ConicArc,
    Cylinder,
    Line,
    Plane,
    Revolution,
    Sphere,
    SurfaceCurve,
    Torus,
)

ORIGIN = np.zeros(3)
X, Y, Z = np.eye(3)


@dataclass(frozen=True)
class Solid:
    """Parts, and what they enclose.

    Attributes
    ----------
    vertices, edges, faces, senses : as for ``Boundary.from_brep``.
    inside : whether points (n, 3) are inside, away from the boundary.
    volume, area : float
    kinds : how many edges of each kind, by name.
    low, high : corners of its box.
    """

    vertices: np.ndarray
    edges: list[Edge]
    faces: list[Face]
    inside: Callable[[np.ndarray], np.ndarray]
    volume: float
    area: float
    kinds: dict[str, int]
    low: np.ndarray
    high: np.ndarray
    senses: list[int | None] | None = None


def prism(outline: Sequence[tuple[float, float]], height: float) -> tuple[list, list, list]:
    """Vertices, edges and faces over a polygon that runs counterclockwise."""
    n = len(outline)
    low = np.array([(x, y, 0.0) for x, y in outline])
    points = np.concatenate([low, low + height * Z])
    edges = [Edge(Line(points[k], points[(k + 1) % n]), k, (k + 1) % n) for k in range(n)]
    edges += [
        Edge(Line(points[n + k], points[n + (k + 1) % n]), n + k, n + (k + 1) % n) for k in range(n)
    ]
    edges += [Edge(Line(points[k], points[n + k]), k, n + k) for k in range(n)]
    top = Face((Plane.through(height * Z, X, Y),), tuple((n + k, 1) for k in range(n)))
    bottom = Face((Plane.through(ORIGIN, Y, X),), tuple((k, -1) for k in reversed(range(n))))
    sides = [
        Face(
            (Plane.through(points[k], points[(k + 1) % n] - points[k], Z),),
            ((k, 1), (2 * n + (k + 1) % n, 1), (n + k, -1), (2 * n + k, -1)),
        )
        for k in range(n)
    ]
    return list(points), edges, [top, bottom, *sides]


def l_shape() -> Solid:
    """Two units long each way, one wide."""
    outline = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    vertices, edges, faces = prism(outline, 1.0)

    def inside(p: np.ndarray) -> np.ndarray:
        x, y, z = p.T
        plan = (x > 0) & (y > 0) & (x < 2) & (y < 2) & ~((x > 1) & (y > 1))
        return plan & (z > 0) & (z < 1)

    kinds = {"convex": 17, "reflex": 1}
    return Solid(
        np.array(vertices), edges, faces, inside, 3.0, 14.0, kinds, ORIGIN, np.array([2.0, 2, 1])
    )


def drilled(radius: float = 0.5) -> Solid:
    """A box of 4 x 2 x 1 with a hole along z through it, off its middle."""
    vertices, edges, faces = prism([(0, 0), (4, 0), (4, 2), (0, 2)], 1.0)
    centre = np.array([1.0, 1.0, 0.0])
    first = len(edges)
    for height in (0.0, 1.0):
        circle = ConicArc(centre + height * Z, radius * X, radius * Y)
        edges.append(Edge(circle))
    top, bottom, *sides = faces
    top = Face(top.charts, (*top.loop, (first + 1, -1)))
    bottom = Face(bottom.charts, (*bottom.loop, (first, 1)))
    wall = Face((Cylinder(np.diag([radius, radius, 1.0]), centre),), ((first, -1), (first + 1, 1)))

    def inside(p: np.ndarray) -> np.ndarray:
        box = ((p > 0) & (p < [4, 2, 1])).all(axis=1)
        return box & (np.hypot(p[:, 0] - 1, p[:, 1] - 1) > radius)

    hole = np.pi * radius**2
    area = 2 * (8 + 4 + 2) - 2 * hole + 2 * np.pi * radius
    return Solid(
        np.array(vertices),
        edges,
        [top, bottom, *sides, wall],
        inside,
        8.0 - hole,
        area,
        {"convex": 14},
        ORIGIN,
        np.array([4.0, 2, 1]),
    )


def ring(major: float = 2.0, minor: float = 0.5) -> Solid:
    """A torus of its outer and its inner half: two smooth circles."""
    half = 0.5 * np.pi
    charts = [
        Torus(major, minor, v0=-half, v1=half),
        Torus(major, minor, v0=half, v1=3.0 * half),
    ]
    edges = []
    for levels in ((half, half), (-half, 3.0 * half)):
        own = [SurfaceCurve.isoline(c, v=v) for c, v in zip(charts, levels, strict=True)]
        both = [(charts[1], own[1].pcurve)]
        edges.append(Edge(SurfaceCurve(charts[0], own[0].pcurve, 0.0, 2.0 * np.pi, both)))
    faces = [Face((charts[0],), ((1, 1), (0, -1))), Face((charts[1],), ((0, 1), (1, -1)))]

    def inside(p: np.ndarray) -> np.ndarray:
        return np.hypot(np.hypot(p[:, 0], p[:, 1]) - major, p[:, 2]) < minor

    reach = np.array([major + minor, major + minor, minor])
    return Solid(
        np.zeros((0, 3)),
        edges,
        faces,
        inside,
        2.0 * np.pi**2 * major * minor**2,
        4.0 * np.pi**2 * major * minor,
        {"smooth": 2},
        -reach,
        reach,
    )


def hollow_ball(inner: float = 0.6, centre: tuple[float, float, float] = (0.1, 0.0, -0.2)) -> Solid:
    """A unit ball with a spherical cavity off its centre: two shells without edges."""
    charts = [
        so.shapes.sphere_atlas(np.eye(3), ORIGIN),
        so.shapes.sphere_atlas(inner * np.eye(3), np.array(centre)),
    ]

    def inside(p: np.ndarray) -> np.ndarray:
        return (np.linalg.norm(p, axis=1) < 1) & (np.linalg.norm(p - centre, axis=1) > inner)

    return Solid(
        np.zeros((0, 3)),
        [],
        [Face(c) for c in charts],
        inside,
        4.0 / 3.0 * np.pi * (1.0 - inner**3),
        4.0 * np.pi * (1.0 + inner**2),
        {},
        -np.ones(3),
        np.ones(3),
    )


def dented(radius: float = 0.5, pit: bool = True) -> Solid:
    """A cube of side 2 with a hemispherical pit, or dome, amid its top."""
    square = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    vertices, edges, faces = prism(square, 2.0)
    first = len(edges)
    edges.append(Edge(ConicArc(2.0 * Z, radius * X, radius * Y)))
    top, *others = faces
    top = Face(top.charts, (*top.loop, (first, -1)))
    atlas = so.shapes.sphere_atlas(radius * np.eye(3), 2.0 * Z)
    faces = [top, *others, Face(atlas, ((first, 1),))]

    def inside(p: np.ndarray) -> np.ndarray:
        box = ((p > [-1, -1, 0]) & (p < [1, 1, 2])).all(axis=1)
        ball = np.linalg.norm(p - 2.0 * Z, axis=1) < radius
        return box & ~ball if pit else box | (ball & (p[:, 2] > 2))

    half = 2.0 / 3.0 * np.pi * radius**3
    area = 24.0 - np.pi * radius**2 + 2.0 * np.pi * radius**2
    return Solid(
        np.array(vertices),
        edges,
        faces,
        inside,
        8.0 - half if pit else 8.0 + half,
        area,
        {"convex": 13} if pit else {"convex": 12, "reflex": 1},
        np.array([-1.0, -1, 0]),
        np.array([1.0, 1, 2 if pit else 2 + radius]),
        [None] * 6 + [-1 if pit else 1],
    )


def countersunk() -> Solid:
    """A cylinder of radius 2 and height 2 with a conical pit of depth 1 amid its top."""
    edges = [
        Edge(ConicArc(ORIGIN, 2 * X, 2 * Y)),
        Edge(ConicArc(2 * Z, 2 * X, 2 * Y)),
        Edge(ConicArc(2 * Z, X, Y)),
    ]
    faces = [
        Face((Plane.through(ORIGIN, Y, X),), ((0, -1),)),
        Face((Cylinder(np.diag([2.0, 2, 1]), ORIGIN),), ((0, 1), (1, -1))),
        Face((Plane.through(2 * Z, X, Y),), ((1, 1), (2, -1))),
        Face((Cone(np.eye(3), Z),), ((2, 1),), (Apex(0, 0.0, 0.0, 2 * np.pi),)),
    ]

    def inside(p: np.ndarray) -> np.ndarray:
        r = np.hypot(p[:, 0], p[:, 1])
        return (r < 2) & (p[:, 2] > 0) & (p[:, 2] < 2) & ~(p[:, 2] > 1 + r)

    return Solid(
        np.array([[0.0, 0, 1]]),
        edges,
        faces,
        inside,
        8 * np.pi - np.pi / 3,
        4 * np.pi + 8 * np.pi + 3 * np.pi + np.sqrt(2) * np.pi,
        {"convex": 3},
        np.array([-2.0, -2, 0]),
        np.array([2.0, 2, 2]),
    )


def bolt_blank() -> Solid:
    """A shaft under a wider head: two cylinders with a reflex circle where they meet."""
    radii, heights = (1.0, 1.0, 2.0, 2.0), (0.0, 3.0, 3.0, 4.0)
    edges = [Edge(ConicArc(h * Z, r * X, r * Y)) for r, h in zip(radii, heights, strict=True)]
    faces = [
        Face((Plane.through(ORIGIN, Y, X),), ((0, -1),)),
        Face((Cylinder(np.diag([1.0, 1, 1]), ORIGIN),), ((0, 1), (1, -1))),
        Face((Plane.through(3 * Z, Y, X),), ((2, -1), (1, 1))),
        Face((Cylinder(np.diag([2.0, 2, 1]), ORIGIN),), ((2, 1), (3, -1))),
        Face((Plane.through(4 * Z, X, Y),), ((3, 1),)),
    ]

    def inside(p: np.ndarray) -> np.ndarray:
        r, z = np.hypot(p[:, 0], p[:, 1]), p[:, 2]
        return ((r < 1) & (z > 0) & (z <= 3)) | ((r < 2) & (z > 3) & (z < 4))

    return Solid(
        np.zeros((0, 3)),
        edges,
        faces,
        inside,
        7 * np.pi,
        np.pi + 6 * np.pi + 3 * np.pi + 4 * np.pi + 4 * np.pi,
        {"convex": 3, "reflex": 1},
        np.array([-2.0, -2, 0]),
        np.array([2.0, 2, 4]),
    )


def apple() -> list:
    """Patches of a torus, by a circle that is turned: they close a shell once sewn."""
    circle = ConicArc((2.0, 0, 0), 0.5 * X, 0.5 * Z)
    whole = Revolution(circle)
    quarter = 0.5 * np.pi
    return [
        whole.restricted(a * quarter, (a + 1) * quarter, b * quarter, (b + 1) * quarter)
        for a in range(4)
        for b in range(4)
    ]


def shells_of_balls() -> list:
    """Patches of a ball of radius 1 and of another within it, all facing out of their own."""
    from standoff.geometry import ellipsoid_patches

    return [*ellipsoid_patches(1, 1, 1), *ellipsoid_patches(0.5, 0.5, 0.5)]


SOLIDS = {
    "L": l_shape,
    "drilled": drilled,
    "ring": ring,
    "hollow ball": hollow_ball,
    "pit": dented,
    "dome": lambda: dented(pit=False),
    "countersunk": countersunk,
    "bolt": bolt_blank,
}

__all__ = ["SOLIDS", "Solid", "Sphere", "apple", "prism", "shells_of_balls"]
