"""The solids of the study: each as a boundary of the library, and by its closed form."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

import standoff as so
from standoff.bodies import Body, Boundary, Edge, Face
from standoff.geometry import (
    Cone,
    ConicArc,
    Cylinder,
    Line,
    Plane,
    RationalBezier,
    Revolution,
    Torus,
)
from standoff_studies.soak.solid_outlines import (
    Arc,
    Array,
    Cubic,
    Outline,
    Piece,
    Segment,
    polygon,
)
from standoff_studies.soak.solid_truth import Egg, Elbow, Hollowed, Swept, Truth, Turned

X, Y, Z = np.eye(3)


class Part(NamedTuple):
    """A solid, twice.

    Attributes
    ----------
    name : str
    boundary : Boundary or Body
    truth : Truth
        Its closed form.
    """

    name: str
    boundary: Boundary
    truth: Truth


def circle(radius: float, height: float) -> Edge:
    """About the axis z."""
    return Edge(ConicArc(height * Z, radius * X, radius * Y))


def turned(profile: Outline, name: str) -> Boundary:
    """A profile (rho, z) turned: planes, cylinders, cones, tori, and revolutions of cubics."""
    edges: list[Edge] = []
    numbers: dict[tuple[float, float], int] = {}

    def rim(point: Array) -> list[tuple[int, int]]:
        key = (round(float(point[0]), 12), round(float(point[1]), 12))
        if key[0] == 0.0:
            return []
        if key not in numbers:
            numbers[key] = len(edges)
            edges.append(circle(*key))
        return [(numbers[key], 1)]

    if not all(isinstance(piece, Segment) for piece in profile.pieces):
        return Boundary.from_patches([_patch(piece) for piece in profile.pieces], name=name)
    faces = []
    for piece in profile.pieces:
        ends = piece.at(np.array([0.0, 1.0]))
        faces.append(Face((quadric(*ends),), tuple(rim(ends[0]) + rim(ends[1]))))
    return Boundary.from_brep(edges=edges, faces=faces, name=name)


def _patch(piece: Piece) -> Torus | Revolution:
    """A surface that ends where the piece ends."""
    if isinstance(piece, Arc):
        low, high = sorted((piece.first, piece.last))
        torus = Torus(float(piece.centre[0]), piece.radius, v0=low, v1=high)
        return torus.transformed(np.eye(3), float(piece.centre[1]) * Z)
    flat = piece.control if isinstance(piece, Cubic) else piece.at(np.array([0.0, 1.0]))
    points = np.insert(flat, 1, 0.0, axis=1)
    return Revolution(RationalBezier(points) if len(points) > 2 else Line(*points))


def quadric(p: Array, q: Array) -> Plane | Cylinder | Cone:
    """Of a segment."""
    (r, z), (r1, z1) = p, q
    if z == z1:
        return Plane.through(z * Z, X, Y)
    if r == r1:
        return Cylinder(np.diag([r, r, 1.0]), np.zeros(3))
    slope = (r1 - r) / (z1 - z)
    return Cone(np.diag([abs(slope), abs(slope), np.sign(slope)]), (z - r / slope) * Z)


def swept(corners: Array, low: float, high: float, hole: float, name: str) -> Boundary:
    """A polygon (n, 2) along z, with a round hole about the axis unless its radius is 0."""
    points, edges, faces = _prism(corners, low, high, 0)
    if hole:
        first = len(edges)
        edges += [circle(hole, low), circle(hole, high)]
        for k in (0, 1):
            faces[k] = Face(faces[k].charts, (*faces[k].loop, (first + k, 1)))
        wall = Cylinder(np.diag([hole, hole, 1.0]), np.zeros(3))
        faces.append(Face((wall,), ((first, 1), (first + 1, 1))))
    return Boundary.from_brep(points, edges, faces, name=name)


def _prism(
    corners: Array, low: float, high: float, first: int
) -> tuple[Array, list[Edge], list[Face]]:
    """Its vertices, edges and faces; these are numbered from `first`, the edges from 3/2 of it."""
    n, e = len(corners), 3 * first // 2
    bottom = np.column_stack([corners, np.full(n, low)])
    points = np.concatenate([bottom, bottom + (high - low) * Z])
    pairs = [(k, (k + 1) % n) for k in range(n)]
    ends = [*pairs, *((n + a, n + b) for a, b in pairs), *((k, n + k) for k in range(n))]
    edges = [Edge(Line(points[a], points[b]), first + a, first + b) for a, b in ends]
    faces = [
        Face((Plane.through(low * Z, X, Y),), tuple((e + k, 1) for k in range(n))),
        Face((Plane.through(high * Z, X, Y),), tuple((e + n + k, 1) for k in range(n))),
    ]
    for k, (a, b) in enumerate(pairs):
        along = points[b] - points[a]
        plane = Plane.through(points[a], along / np.linalg.norm(along), Z)
        loop = ((e + k, 1), (e + 2 * n + b, 1), (e + n + k, -1), (e + 2 * n + a, -1))
        faces.append(Face((plane,), loop))
    return points, edges, faces


def square(half: float) -> Array:
    return half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


def _outline(corners: Array, hole: float = 0.0) -> Outline:
    pieces: list[Piece] = [*polygon(*map(tuple, corners))]
    if hole:
        pieces.append(Arc(np.zeros(2), hole, -np.pi, np.pi))
    return Outline(pieces)


def swept_part(name: str, corners: Array, high: float, hole: float = 0.0) -> Part:
    """A polygon (n, 2) along z from 0 on, with a round hole unless its radius is 0."""
    truth = Swept(_outline(corners, hole), 0.0, high)
    return Part(name, swept(corners, 0.0, high, hole, name), truth)


def _turned(name: str, *pieces: Piece) -> Part:
    p, q = pieces[0].at(np.zeros(1))[0], pieces[-1].at(np.ones(1))[0]
    closing = [] if np.array_equal(p, q) else [Segment(q, p)]
    profile = Outline(pieces, closing)
    return Part(name, turned(profile, name), Turned(profile))


def _chain(*corners: tuple[float, float]) -> list[Segment]:
    return polygon(*corners)[:-1]


def turned_part(name: str, corners: Sequence[tuple[float, float]]) -> Part:
    """A closed polygon (rho, z) about the axis z; it begins and ends there if it touches it."""
    if corners[0][0] == 0.0:
        return _turned(name, *_chain(*corners))
    profile = Outline(polygon(*corners))
    return Part(name, turned(profile, name), Turned(profile))


def bolt(shank: float, head: float, under: float, top: float, name: str = "bolt") -> Part:
    """A shank from z = 0 to `under`, a wider head from there to `top`."""
    corners = ((0, 0), (shank, 0), (shank, under), (head, under), (head, top), (0, top))
    return _turned(name, *_chain(*corners))


def plate(side: float, thick: float, hole: float) -> Part:
    """Square, with a round hole through it."""
    return swept_part("plate", square(0.5 * side), thick, hole)


def bracket(long: float, thick: float, deep: float) -> Part:
    """An angle: two legs of the same length, a reflex edge between them."""
    corners = [[0, 0], [long, 0], [long, thick], [thick, thick], [thick, long], [0, long]]
    return swept_part("bracket", np.array(corners, dtype=float), deep)


def channel(wide: float, tall: float, thick: float, deep: float) -> Part:
    """A U-profile with two reflex edges."""
    a, b, t = wide, tall, thick
    corners = [[0, 0], [a, 0], [a, b], [a - t, b], [a - t, t], [t, t], [t, b], [0, b]]
    return swept_part("channel", np.array(corners, dtype=float), deep)


def ring(major: float, minor: float) -> Part:
    """A torus about the z axis."""
    return _turned("ring", Arc(np.array([major, 0.0]), minor, -np.pi, np.pi))


def hollow(half: float, inner: float) -> Part:
    """A cube with a cubic cavity."""
    truth = Hollowed(
        Swept(_outline(square(half)), -half, half), Swept(_outline(square(inner)), -inner, inner)
    )
    points, edges, faces = _prism(square(half), -half, half, 0)
    more = _prism(square(inner), -inner, inner, len(points))
    boundary = Boundary.from_brep(
        np.concatenate([points, more[0]]), edges + more[1], faces + more[2], name="hollow"
    )
    return Part("hollow", boundary, truth)


def pulley() -> Part:
    """A groove of half a circle, a bore, and a cone: all kinds that turn, of either bend."""
    groove = Arc(np.array([0.6, 0.0]), 0.2, -0.5 * np.pi, -1.5 * np.pi)
    corners = [(0.6, 0.2), (0.6, 0.35), (0.3, 0.5), (0.15, 0.5), (0.15, -0.4), (0.6, -0.4)]
    return _turned("pulley", groove, *_chain(*corners, (0.6, -0.2)))


def vase() -> Part:
    """A cubic turned about the axis, that bends both ways, between two planes."""
    control = np.array([[0.25, 0.0], [0.8, 0.35], [-0.05, 0.65], [0.35, 1.0]])
    foot = Segment(np.array([0.0, 0.0]), control[0])
    lid = Segment(control[-1], np.array([0.0, 1.0]))
    return _turned("vase", foot, Cubic(control), lid)


def elbow(major: float, bore: float, outside: float, leg: float) -> Part:
    """A pipe bent by a quarter turn, with two straight ends; sewn of halves."""
    truth = Elbow(major, bore, outside, leg)
    patches: list[Cylinder | Torus | Revolution] = []
    h = 0.5 * np.pi
    for radius in (bore, outside):
        patches += [Torus(major, radius, 0.0, h, v, v + np.pi) for v in (-h, h)]
    for axes, origin in truth.legs:
        for half in (0.0, np.pi):
            for radius in (bore, outside):
                linear = axes @ np.diag([radius, radius, 1.0])
                patches.append(Cylinder(linear, origin, (half, half + np.pi, 0.0, leg)))
            rim = Line([bore, 0.0, leg], [outside, 0.0, leg])
            patches.append(Revolution(rim, half, half + np.pi).transformed(axes, origin))
    boundary = Boundary.from_patches(patches, name="elbow")
    return Part("elbow", boundary, truth)


def egg(semiaxes: tuple[float, float, float]) -> Part:
    """An ellipsoid."""
    body: Body = so.shapes.ellipsoid(*semiaxes)
    return Part("egg", body, Egg(np.array(semiaxes)))


def brick(wide: float, high: float) -> Part:
    """A convex prism of square section."""
    return swept_part("brick", square(0.5 * wide), high)


def wedge() -> Part:
    """A prism with a notch, of sharp angles: convex edges of 14 and reflex ones of 20 degrees."""
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 0.125], [0.9, 0.3], [0.0, 0.3]])
    return swept_part("wedge", corners, 0.5)


def drum(radius: float, high: float) -> Part:
    """A convex cylinder."""
    return _turned("drum", *_chain((0, 0), (radius, 0), (radius, high), (0, high)))


MAKERS: dict[str, Callable[[], Part]] = {
    "bolt": lambda: bolt(0.2, 0.4, 0.8, 1.0),
    "pin": lambda: bolt(0.04, 0.08, 0.16, 0.2, "pin"),
    "plate": lambda: plate(1.2, 0.3, 0.25),
    "bracket": lambda: bracket(0.9, 0.2, 0.6),
    "channel": lambda: channel(0.9, 0.7, 0.15, 0.8),
    "ring": lambda: ring(0.5, 0.15),
    "hollow": lambda: hollow(0.5, 0.35),
    "pulley": pulley,
    "vase": vase,
    "elbow": lambda: elbow(0.5, 0.14, 0.22, 0.3),
    "egg": lambda: egg((0.5, 0.35, 0.25)),
    "brick": lambda: brick(0.3, 0.2),
    "wedge": wedge,
    "drum": lambda: drum(0.24, 0.4),
}
"""Of each name its part: sizes near 1, and small ones that have room in the others."""
