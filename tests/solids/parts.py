"""Solids that several tests use: a bolt, a plate with a hole, a ring, an angle bracket."""

from __future__ import annotations

import numpy as np

from standoff.bodies import Boundary, Edge, Face
from standoff.geometry import ConicArc, Cylinder, Line, Plane, Torus

X, Y, Z = np.eye(3)


def circle(radius: float, height: float, sense: int = 1) -> Edge:
    return Edge(ConicArc(height * Z, radius * X, sense * radius * Y))


def level(height: float, *loop: tuple[int, int]) -> Face:
    return Face((Plane.through(height * Z, X, Y),), loop)


def wall(radius: float, *loop: tuple[int, int]) -> Face:
    return Face((Cylinder(np.diag([radius, radius, 1.0]), np.zeros(3)),), loop)


def bolt(shank: float, head: float, under: float, top: float) -> Boundary:
    """A shank from z = 0 to `under`, a wider head from there to `top`."""
    edges = [circle(shank, 0.0), circle(shank, under), circle(head, under), circle(head, top)]
    faces = [
        level(0.0, (0, 1)),
        wall(shank, (0, 1), (1, 1)),
        level(under, (1, 1), (2, 1)),
        wall(head, (2, 1), (3, 1)),
        level(top, (3, 1)),
    ]
    return Boundary.from_brep(edges=edges, faces=faces, name="bolt")


def prism(outline: np.ndarray, thick: float, holes: tuple[float, ...] = ()) -> Boundary:
    """A polygon (n, 2) swept from z = 0 to `thick`, with round holes about the z axis."""
    n = len(outline)
    low = np.column_stack([outline, np.zeros(n)])
    high = low + thick * Z
    points = np.concatenate([low, high])
    pairs = [(k, (k + 1) % n) for k in range(n)]
    edges = [Edge(Line(points[a], points[b]), a, b) for a, b in pairs]
    edges += [Edge(Line(points[n + a], points[n + b]), n + a, n + b) for a, b in pairs]
    edges += [Edge(Line(points[k], points[n + k]), k, n + k) for k in range(n)]
    first = len(edges)
    for radius in holes:
        edges += [circle(radius, 0.0), circle(radius, thick)]
    rims = [(first + 2 * k, 1) for k in range(len(holes))]
    faces = [
        level(0.0, *((k, 1) for k in range(n)), *rims),
        level(thick, *((n + k, 1) for k in range(n)), *((r + 1, 1) for r, _ in rims)),
    ]
    for k, (a, b) in enumerate(pairs):
        along = points[b] - points[a]
        loop = ((k, 1), (2 * n + b, 1), (n + k, -1), (2 * n + a, -1))
        faces.append(Face((Plane.through(points[a], along / np.linalg.norm(along), Z),), loop))
    faces += [wall(r, (first + 2 * k, 1), (first + 2 * k + 1, 1)) for k, r in enumerate(holes)]
    return Boundary.from_brep(points, edges, faces, name="prism")


def plate_with_hole(side: float, thick: float, radius: float) -> Boundary:
    """A square plate about the z axis, with a round hole through it."""
    half = 0.5 * side
    square = np.array([[-half, -half], [half, -half], [half, half], [-half, half]])
    return prism(square, thick, (radius,))


def bracket(long: float, thick: float, deep: float) -> Boundary:
    """An angle: two legs of the same length, a reflex edge between them."""
    outline = np.array([[0, 0], [long, 0], [long, thick], [thick, thick], [thick, long], [0, long]])
    return prism(outline.astype(float), deep)


def ring(major: float, minor: float) -> Boundary:
    """A torus about the z axis."""
    return Boundary.from_patches([Torus(major, minor, v0=-np.pi, v1=np.pi)], name="ring")
