"""A capsule and a rounded box made of patches that meet smoothly, instead of a swept core.

Every edge is smooth (G1): quarter cylinders, octants of spheres and planes share their normals
along it. The same bodies exist as swept segments and boxes, which gives the answers.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

import standoff as so
from standoff.geometry import ConicArc, Cylinder, Line, Plane, Sphere, Surface

Array = NDArray[np.float64]


class PatchBuilder:
    """Collects patches with corners, and the edges between the corners once each."""

    def __init__(self) -> None:
        self.vertices: list[Array] = []
        self.edges: list[so.bodies.Edge] = []
        self.faces: list[so.bodies.Face] = []
        self._numbers: dict[tuple[int, int], int] = {}

    def vertex(self, point: Array) -> int:
        """Return the number of a corner; corners that coincide are one."""
        for number, known in enumerate(self.vertices):
            if np.linalg.norm(known - point) < 1e-12:
                return number
        self.vertices.append(np.asarray(point, dtype=float))
        return len(self.vertices) - 1

    def edge(self, start: int, end: int, centre: Array | None) -> tuple[int, int]:
        """Return (edge, sense) from corner to corner: a line, or a quarter of a circle."""
        key = (min(start, end), max(start, end))
        if key not in self._numbers:
            p, q = self.vertices[start], self.vertices[end]
            curve: Line | ConicArc = Line(p, q)
            if centre is not None:
                curve = ConicArc(centre, p - centre, q - centre, 0.0, np.pi / 2)
            self._numbers[key] = len(self.edges)
            self.edges.append(so.bodies.Edge(curve, start, end, smooth=True))
        number = self._numbers[key]
        return number, 1 if self.edges[number].first == start else -1

    def patch(
        self,
        surface: Surface,
        corners: Sequence[Array],
        centres: Sequence[Array | None],
        outward: Array,
    ) -> None:
        """Add a face; ``centres[i]`` is that of the arc from corner i to the next, None: a line.

        The corners may run either way round; ``outward`` tells which is counterclockwise.
        """
        points = np.array(corners)
        following = np.roll(points, -1, axis=0)
        area = np.cross(points - points.mean(axis=0), following - points.mean(axis=0)).sum(axis=0)
        order = list(range(len(points)))
        rows = list(centres)
        if area @ outward < 0:
            order = order[::-1]
            rows = [*rows[::-1][1:], rows[-1]]
        numbers = [self.vertex(points[k]) for k in order]
        loop = tuple(
            self.edge(start, end, centre)
            for start, end, centre in zip(numbers, numbers[1:] + numbers[:1], rows, strict=True)
        )
        self.faces.append(so.bodies.Face((surface,), loop))

    def body(self, name: str) -> so.Body:
        return so.Body.from_brep(self.vertices, self.edges, self.faces, name=name)


def _octant(builder: PatchBuilder, centre: Array, radius: float, signs: Array) -> None:
    """Add the octant of a sphere on the side of ``signs``; its chart is centred on its middle."""
    middle = signs / np.linalg.norm(signs)
    frame = np.linalg.svd(middle[None])[2]
    frame[0] = middle
    linear = radius * np.column_stack([frame[1], frame[2], middle])
    corners = [centre + radius * sign * axis for sign, axis in zip(signs, np.eye(3), strict=True)]
    builder.patch(Sphere(linear, centre), corners, [centre] * 3, middle)


def _quarter_cylinder(
    builder: PatchBuilder, ends: tuple[Array, Array], first: Array, second: Array, turn: float
) -> None:
    """Add the panel between two radii about an axis; ``turn`` moves the chart's seam."""
    along = ends[1] - ends[0]
    across = np.cross(along / np.linalg.norm(along), first)
    frame = np.column_stack([first, across, along / np.linalg.norm(along)])
    c, s = np.cos(turn), np.sin(turn)
    spin = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    corners = [ends[0] + first, ends[0] + second, ends[1] + second, ends[1] + first]
    centres = [ends[0], None, ends[1], None]
    builder.patch(Cylinder(frame @ spin, ends[0]), corners, centres, first + second)


def capsule(radius: float, length: float, turn: float = 0.0) -> so.Body:
    """Four panels and two times four octants: ``so.shapes.capsule`` in patches."""
    builder = PatchBuilder()
    low, high = np.array([0, 0, -length / 2]), np.array([0, 0, length / 2])
    for quarter in product((-1.0, 1.0), repeat=2):
        first, second = (
            radius * sign * axis for sign, axis in zip(quarter, np.eye(3), strict=False)
        )
        _quarter_cylinder(builder, (low, high), first, second, turn)
        for end, sign in ((low, -1.0), (high, 1.0)):
            _octant(builder, end, radius, np.array([*quarter, sign]))
    return builder.body("capsule in patches")


def rounded_box(x: float, y: float, z: float, rounding: float, turn: float = 0.0) -> so.Body:
    """Six planes, twelve panels, eight octants: ``so.shapes.box`` with rounding, in patches."""
    builder = PatchBuilder()
    half = np.array([x, y, z]) / 2 - rounding
    for signs in product((-1.0, 1.0), repeat=3):
        _octant(builder, half * signs, rounding, np.array(signs))
    for axis in range(3):
        one, two = (axis + 1) % 3, (axis + 2) % 3
        unit = np.eye(3)
        for a, b in product((-1.0, 1.0), repeat=2):
            middle = a * half[one] * unit[one] + b * half[two] * unit[two]
            ends = middle - half[axis] * unit[axis], middle + half[axis] * unit[axis]
            first, second = rounding * a * unit[one], rounding * b * unit[two]
            _quarter_cylinder(builder, ends, first, second, turn)
        for sign in (-1.0, 1.0):
            out = sign * unit[axis]
            centre = (half[axis] + rounding) * out
            corners = [
                centre + a * half[one] * unit[one] + b * half[two] * unit[two]
                for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))
            ]
            plane = Plane.through(centre, unit[one], sign * unit[two])
            builder.patch(plane, corners, [None] * 4, out)
    return builder.body("rounded box in patches")
