"""Bodies at rest on one another, and the set of witness points by closed form."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

import standoff as so
from standoff.geometry import ConicArc, Line

Array = NDArray[np.float64]

GAPS = (1.0, 1e-6, 0.0, -1e-6, -1e-2)

s = so.shapes
BOX, PLATE = s.box(1, 1, 1), s.box(10, 10, 1)
CYLINDER, CONE, CAPSULE = s.cylinder(0.5, 2), s.cone(0.5, 1), s.capsule(0.2, 1)
ROUNDED = s.box(1, 1, 1, rounding=0.1)
HALF_ANGLE = np.arctan(0.5)
TILTED = so.Pose.exp([np.pi / 4, 0, 0]).rotation
ROOF = s.polytope(BOX.vertex_points @ TILTED.T)
CROSSED = ROOF.transformed(np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]))
SQUARE = s.planar_loop(
    [
        Line((*p, 0.0), (*q, 0.0))
        for p, q in (((0, 0), (1, 0)), ((1, 0), (1, 1)), ((1, 1), (0, 1)), ((0, 1), (0, 0)))
    ]
)
ELLIPSE = s.planar_loop([ConicArc((0, 0, 0), (2, 0, 0), (0, 1, 0))])
Z = np.array([0.0, 0.0, 1.0])
TOP = 0.5


@dataclass(frozen=True)
class Case:
    """B above A at gap 0, in A's frame, and the set's corners on A."""

    name: str
    a: so.Body = field(repr=False)
    b: so.Body = field(repr=False)
    position: tuple[float, float, float]
    corners: Array = field(repr=False)
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0)
    dim: int = 0
    normals: int = 0
    normal: tuple[float, float, float] = (0.0, 0.0, 1.0)
    gaps: tuple[float, ...] = GAPS
    arc: bool = False

    def __str__(self) -> str:
        return self.name


def _rectangle(x0: float, x1: float, y0: float, y1: float, z: float = TOP) -> Array:
    return np.array([[x, y, z] for x in (x0, x1) for y in (y0, y1)])


def _disc(x: float, y: float, r: float, z: float = TOP) -> Array:
    t = np.linspace(0, 2 * np.pi, 721)
    return np.column_stack([x + r * np.cos(t), y + r * np.sin(t), 0 * t + z])


def _discs(apart: float, r: float, z: float) -> Array:
    """What two discs share, their centres at x = 0 and x = apart."""
    both = np.vstack([_disc(0, 0, r, z), _disc(apart, 0, r, z)])
    inside = [np.hypot(both[:, 0] - c, both[:, 1]) <= r * (1 + 1e-12) for c in (0, apart)]
    tips = np.sqrt(r * r - apart * apart / 4) * np.array([[0, 1, 0], [0, -1, 0]])
    return np.vstack([both[inside[0] & inside[1]], tips + np.array([apart / 2, 0, z])])


def _spot(*x: float) -> Array:
    return np.array([x])


def _ends(p: tuple[float, float, float], q: tuple[float, float, float]) -> Array:
    return np.array([p, q])


APART = (1.0, 1e-6)
LYING, ON_SIDE = (np.pi / 2, 0, 0), (np.pi / 2 + HALF_ANGLE, 0, 0)
SIDE = np.hypot(0.5, 1.0)
LOW = 0.5 * np.sin(HALF_ANGLE)  # of the cone's frame above the floor, when it lies on its side
CASES = [
    Case("box: area", BOX, BOX, (0.3, 0.2, 1), _rectangle(-0.2, 0.5, -0.3, 0.5), dim=2),
    Case("box: same area", BOX, BOX, (0, 0, 1), _rectangle(-0.5, 0.5, -0.5, 0.5), dim=2),
    Case("box: sliver", BOX, BOX, (1 - 1e-5, 0, 1), _rectangle(0.5 - 1e-5, 0.5, -0.5, 0.5), dim=2),
    Case(
        "box: edge on edge",
        BOX,
        BOX,
        (1, 0.2, 1),
        _ends((0.5, -0.3, TOP), (0.5, 0.5, TOP)),
        dim=1,
        normals=1,
        gaps=(*APART, 0.0),
    ),
    Case(
        "box: corner on corner",
        BOX,
        BOX,
        (1, 1, 1),
        _spot(0.5, 0.5, TOP),
        normals=2,
        gaps=(*APART, 0.0),
    ),
    Case(
        "box: edge on face",
        BOX,
        BOX,
        (0.1, 0.3, TOP + np.sqrt(0.5)),
        _ends((-0.4, 0.3, TOP), (0.5, 0.3, TOP)),
        (np.pi / 4, 0, 0),
        dim=1,
    ),
    Case("box: crossed edges", ROOF, CROSSED, (0, 0, 2 * np.sqrt(0.5)), _spot(0, 0, np.sqrt(0.5))),
    Case(
        "cylinder lying", PLATE, CYLINDER, (1, 2, 1), _ends((1, 1, TOP), (1, 3, TOP)), LYING, dim=1
    ),
    Case(
        "cylinder lying over the rim",
        PLATE,
        CYLINDER,
        (1, 4.5, 1),
        _ends((1, 3.5, TOP), (1, 5, TOP)),
        LYING,
        dim=1,
    ),
    Case("cylinder standing", PLATE, CYLINDER, (1, 2, 1.5), _disc(1, 2, 0.5), dim=2, arc=True),
    Case(
        "cylinder on its rim",
        PLATE,
        CYLINDER,
        (0, 0, TOP + np.cos(0.3) + 0.5 * np.sin(0.3)),
        _spot(0, np.sin(0.3) - 0.5 * np.cos(0.3), TOP),
        (0.3, 0, 0),
    ),
    Case("cone on its base", PLATE, CONE, (0, 1, 1), _disc(0, 1, 0.5), dim=2, arc=True),
    Case("cone on its apex", PLATE, CONE, (0, 1, 1), _spot(0, 1, TOP), (np.pi, 0, 0)),
    Case(
        "cone on its side",
        PLATE,
        CONE,
        (0, 0, TOP + LOW),
        _ends((0, -0.5 * np.cos(HALF_ANGLE), TOP), (0, SIDE - 0.5 * np.cos(HALF_ANGLE), TOP)),
        ON_SIDE,
        dim=1,
    ),
    Case("disc on disc", CYLINDER, CYLINDER, (0.7, 0, 2), _discs(0.7, 0.5, 1.0), dim=2, arc=True),
    Case(
        "disc on disc: sliver",
        CYLINDER,
        CYLINDER,
        (1 - 1e-5, 0, 2),
        _discs(1 - 1e-5, 0.5, 1.0),
        dim=2,
        arc=True,
    ),
    Case(
        "disc beside disc",
        CYLINDER,
        CYLINDER,
        (1, 0, 2),
        _spot(0.5, 0, 1),
        normals=1,
        gaps=(*APART, 0.0),
    ),
    Case("ellipsoid", PLATE, s.ellipsoid(1, 2, 3), (1, 2, 3.5), _spot(1, 2, TOP)),
    Case(
        "capsule over the rim",
        PLATE,
        CAPSULE,
        (1, 4.7, TOP + 0.2),
        _ends((1, 4.2, TOP), (1, 5, TOP)),
        LYING,
        dim=1,
    ),
    Case(
        "capsules parallel",
        CAPSULE,
        s.capsule(0.3, 1),
        (0.5, 0, 0.3),
        _ends((0.2, 0, -0.2), (0.2, 0, 0.5)),
        dim=1,
        normal=(1, 0, 0),
    ),
    Case(
        "capsules crossed",
        CAPSULE,
        s.capsule(0.3, 1),
        (0.5, 0, 0),
        _spot(0.2, 0, 0),
        (0.4, 0, 0),
        normal=(1, 0, 0),
    ),
    Case("lens", PLATE, s.lens(1, 0.45), (0, 0, TOP + np.sqrt(1 - 0.45**2)), _spot(0, 0, TOP)),
    Case(
        "cap", PLATE, s.cap(1, 0.3), (0, 0, TOP - 0.3), _disc(0, 0, np.sqrt(0.91)), dim=2, arc=True
    ),
    Case(
        "rounded box: area", ROUNDED, ROUNDED, (0.3, 0, 1), _rectangle(-0.1, 0.4, -0.4, 0.4), dim=2
    ),
    Case(
        "rounded box: edge",
        ROUNDED,
        ROUNDED,
        (0.8, 0, 1),
        _ends((0.4, -0.4, TOP), (0.4, 0.4, TOP)),
        dim=1,
    ),
    Case(
        "half-space, box", s.halfspace(), BOX, (3, 2, 0.5), _rectangle(2.5, 3.5, 1.5, 2.5, 0), dim=2
    ),
    Case(
        "half-space, cylinder",
        s.halfspace(),
        CYLINDER,
        (1, 2, 0.5),
        _ends((1, 1, 0), (1, 3, 0)),
        LYING,
        dim=1,
    ),
    Case("half-space, ball", s.halfspace(), s.sphere(0.3), (1, 2, 0.3), _spot(1, 2, 0)),
    Case("point on face", PLATE, s.point(), (1, 2, TOP), _spot(1, 2, TOP)),
    Case(
        "squares: side",
        SQUARE,
        SQUARE,
        (0.3, 1, 0),
        _ends((0.3, 1, 0), (1, 1, 0)),
        dim=1,
        normal=(0, 1, 0),
    ),
    Case(
        "squares: corners",
        SQUARE,
        SQUARE,
        (1, 1, 0),
        _spot(1, 1, 0),
        normals=1,
        normal=(0, 1, 0),
        gaps=(*APART, 0.0),
    ),
    Case("ellipse on square", SQUARE, ELLIPSE, (0.3, 2, 0), _spot(0.3, 1, 0), normal=(0, 1, 0)),
]


@dataclass(frozen=True)
class Overlap:
    """B at a pose in A's frame, one of the normals of least width, and witness points for it."""

    name: str
    a: so.Body = field(repr=False)
    b: so.Body = field(repr=False)
    position: tuple[float, float, float]
    normal: tuple[float, float, float]
    x: tuple[float, float, float]
    y: tuple[float, float, float]
    dim: int
    normals: int
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __str__(self) -> str:
        return self.name


X, ASIDE, HERE = (1, 0, 0), (0.6, 0.8, 0), (0, 0, 0)
ROUND, TWICE = s.ellipsoid(1, 1, 1), s.ellipsoid(2, 2, 2)
LONG, SHORT, EGG = s.ellipsoid(1, 1, 3), s.ellipsoid(1, 1, 2), s.ellipsoid(1, 2, 3)
BALL = s.sphere(0.3)
OVERLAPS = [
    Overlap("concentric balls", BALL, BALL, HERE, X, (0.3, 0, 0), (-0.3, 0, 0), 0, 2),
    Overlap("concentric patches", ROUND, TWICE, HERE, X, (1, 0, 0), (-2, 0, 0), 0, 2),
    Overlap("coaxial ellipsoids", LONG, SHORT, HERE, X, (1, 0, 0), (-1, 0, 0), 0, 1),
    Overlap("ellipsoids", EGG, EGG, HERE, X, (1, 0, 0), (-1, 0, 0), 0, 0),
    Overlap(
        "coaxial capsules",
        CAPSULE,
        CAPSULE,
        (0, 0, 0.3),
        ASIDE,
        (0.12, 0.16, 0.1),
        (-0.12, -0.16, 0.1),
        1,
        1,
    ),
    Overlap(
        "axes crossing",
        CAPSULE,
        CAPSULE,
        (0, 0, 0.3),
        X,
        (0.2, 0, 0.3),
        (-0.2, 0, 0.3),
        0,
        0,
        (0.7, 0, 0),
    ),
    Overlap(
        "coaxial cylinders",
        CYLINDER,
        CYLINDER,
        (0, 0, 0.3),
        ASIDE,
        (0.3, 0.4, 0.1),
        (-0.3, -0.4, 0.1),
        1,
        1,
    ),
    Overlap(
        "ball about an end",
        BALL,
        CAPSULE,
        (0, 0, -0.5),
        (0, 0.6, 0.8),
        (0, 0.18, 0.24),
        (0, -0.12, -0.16),
        0,
        2,
    ),
    Overlap(
        "ball about the axis",
        BALL,
        CAPSULE,
        (0, 0, 0.2),
        ASIDE,
        (0.18, 0.24, 0),
        (-0.12, -0.16, 0),
        0,
        1,
    ),
]
