"""Degenerate bodies, each kind with a level of degeneracy, and poses whose answer is known.

A kind makes a body of size about 1 at a level (an aspect ratio, a length over the size, an angle);
``aims`` are the normals at which its degenerate places are met. The truth is by construction from
support points (``oracles.exact_pairs``).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

import standoff as so
from families import curved_shapes, nurbs_bodies, shapes
from families.shapes import Rng, Twin
from oracles.exact_pairs import random_rotation
from oracles.loops import BezierCurve
from oracles.revolved import RevolvedHull
from standoff.geometry import BezierPatch, RationalBezier, ellipsoid_octants, ellipsoid_patches
from standoff_studies import oracles as oracle
from standoff_studies.oracles import Affine, Egg, Gore, Spindle, Superellipsoid

Array = NDArray[np.float64]
Maker = Callable[[Rng, float], Twin]

NEAR = (0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3)
"""How far beside a degenerate normal it is aimed, radians."""


def unit_rows(rows: object) -> Array:
    array = np.array(rows, dtype=float)
    return array / np.linalg.norm(array, axis=1, keepdims=True)


AXES = np.vstack([np.eye(3), -np.eye(3)])
DIAGONALS = unit_rows([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
HALVES = unit_rows(
    [np.roll([i, j, 0], k) for i in (-1, 1) for j in (-1, 1) for k in range(3)]  # between two axes
)


@dataclass(frozen=True)
class Kind:
    """A family of degenerate bodies.

    ``levels`` are those of the suite; ``harder`` ones only the benchmark runs, to find limits.
    """

    make: Maker
    levels: tuple[float, ...]
    harder: tuple[float, ...] = ()
    aims: Array = field(default_factory=lambda: AXES)


def _axes(rng: Rng, ratio: float) -> tuple[float, float, float]:
    """Semi-axes of a plate, a needle or anything between, of greatest ratio ``ratio``."""
    middle = (1.0, 1.0 / ratio, ratio ** -float(rng.uniform(0, 1)))[rng.integers(3)]
    a, b, c = rng.permutation([1.0, middle, 1.0 / ratio])
    return float(a), float(b), float(c)


def _thin_and_long(rng: Rng, ratio: float) -> tuple[float, float]:
    first, second = rng.permutation([1.0, 1.0 / ratio])
    return float(first), float(second)


def ellipsoid(rng: Rng, ratio: float) -> Twin:
    axes = _axes(rng, ratio)
    return Twin(oracle.Ellipsoid(*axes), so.shapes.ellipsoid(*axes))


def box(rng: Rng, ratio: float) -> Twin:
    lengths = _axes(rng, ratio)
    return Twin(oracle.Box(*lengths), so.shapes.box(*lengths))


def rounded_box(rng: Rng, ratio: float) -> Twin:
    lengths = _axes(rng, ratio)
    rounding = 0.25 * min(lengths)
    return Twin(oracle.Box(*lengths, rounding), so.shapes.box(*lengths, rounding))


def cylinder(rng: Rng, ratio: float) -> Twin:
    radius, length = _thin_and_long(rng, ratio)
    return Twin(oracle.Cylinder(radius, length), so.shapes.cylinder(radius, length))


def cone(rng: Rng, ratio: float) -> Twin:
    radius, height = _thin_and_long(rng, ratio)
    return Twin(oracle.Cone(radius, height), so.shapes.cone(radius, height))


def capsule(rng: Rng, ratio: float) -> Twin:
    radius, length = _thin_and_long(rng, ratio)
    return Twin(oracle.Capsule(radius, length), so.shapes.capsule(radius, length))


def superellipsoid(rng: Rng, ratio: float) -> Twin:
    e1, e2 = (float(e) for e in rng.uniform(0.2, 1.8, 2))
    axes = _axes(rng, ratio)
    return Twin(Superellipsoid(*axes, e1, e2), so.shapes.superellipsoid(*axes, e1, e2))


def nurbs_ellipsoid(rng: Rng, ratio: float) -> Twin:
    axes = _axes(rng, ratio)
    patches = (ellipsoid_patches, ellipsoid_octants)[rng.integers(2)](*axes)
    return Twin(oracle.Ellipsoid(*axes), so.Body.from_patches(patches))


def thin_lens(rng: Rng, ratio: float) -> Twin:
    del rng
    offset = 1.0 - 1.0 / ratio
    return Twin(oracle.Lens(1.0, offset), so.shapes.lens(1.0, offset))


def cap(rng: Rng, ratio: float) -> Twin:
    """A shallow cap, or a ball with a tiny flat."""
    height = (1.0 - 1.0 / ratio) * (1 if rng.random() < 0.5 else -1)
    return Twin(oracle.Cap(1.0, height), so.shapes.cap(1.0, height))


def needle(rng: Rng, ratio: float) -> Twin:
    """A slender spindle, gore or egg: bodies with poles."""
    thin = 1.0 / ratio
    kind = rng.integers(3)
    if kind == 0:
        return Twin(Spindle(thin, 2.0), so.shapes.spindle(thin, 2.0))
    if kind == 1:
        return Twin(Gore(thin, 2.0, 4), so.shapes.gore(thin, 2.0, 4))
    return Twin(Egg(thin, 2.0, 0.4), so.shapes.egg(thin, 2.0, 0.4))


def _hull(points: list[list[float]]) -> Twin:
    vertices = np.array(points)
    return Twin(oracle.Polytope(vertices), so.shapes.polytope(vertices))


def short_capsule(rng: Rng, length: float) -> Twin:
    radius = float(rng.uniform(0.3, 1.0))
    return Twin(oracle.Capsule(radius, length), so.shapes.capsule(radius, length))


def cut_corner(rng: Rng, edge: float) -> Twin:
    """A cube with a corner cut off: three edges of about ``edge``, a face of its square."""
    del rng
    corners = [list(row) for row in (DIAGONALS * np.sqrt(3.0)).round() if (row < 0).any()]
    cuts = [[1.0 - edge * (i == k) for i in range(3)] for k in range(3)]
    return _hull(corners + cuts)


def chiselled(rng: Rng, edge: float) -> Twin:
    """A wedge whose edge is a face only ``edge`` wide."""
    del rng
    base = [[x, y, 0.0] for x in (-1.0, 1.0) for y in (-1.0, 1.0)]
    return _hull(base + [[x, y * edge, 1.0] for x in (-0.5, 0.5) for y in (-1.0, 1.0)])


def small_rounding(rng: Rng, rounding: float) -> Twin:
    lengths = [float(x) for x in rng.uniform(0.5, 1.0, 3)]
    return Twin(oracle.Box(*lengths, rounding), so.shapes.box(*lengths, rounding))


def roof(rng: Rng, angle: float) -> Twin:
    """A box under a flat roof: two faces meet at ``angle`` from tangent."""
    del rng
    walls = [[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (0.0, 1.0)]
    ridge = [[0.0, y, 1.0 + 0.5 * angle] for y in (-1.0, 1.0)]
    return _hull(walls + ridge)


def sewn_roof(rng: Rng, angle: float) -> Twin:
    """The same of ten plane patches: seams between patches in one plane, and a ridge of `angle`."""
    del rng
    heights = [1.0, 1.0 + 0.5 * angle, 1.0]

    def corner(i: int, y: float, top: bool) -> list[float]:
        return [i - 1.0, y, heights[i] if top else 0.0]

    def quad(corners: list[tuple[int, float, bool]]) -> list[list[list[float]]]:
        first, second, third, fourth = (corner(*place) for place in corners)
        return [[first, second], [third, fourth]]

    quads = [
        quad([(j, y, top) for j in (i, i + 1) for y in (-1.0, 1.0)])
        for i in range(2)
        for top in (False, True)
    ]
    quads += [
        quad([(j, y, top) for j in (i, i + 1) for top in (False, True)])
        for i in range(2)
        for y in (-1.0, 1.0)
    ]
    quads += [quad([(end, y, top) for y in (-1.0, 1.0) for top in (False, True)]) for end in (0, 2)]
    vertices = np.array(quads).reshape(-1, 3)
    return Twin(
        oracle.Polytope(np.unique(vertices, axis=0)),
        so.Body.from_patches([BezierPatch(np.array(quad)) for quad in quads]),
    )


def nearly_ball(rng: Rng, angle: float) -> Twin:
    """A lens of three spheres whose centres are ``angle`` apart: dihedral angles of that."""
    del rng
    return Twin(oracle.Lens(1.0, angle), so.shapes.lens(1.0, angle))


def flat_top(rng: Rng, width: float) -> Twin:
    """A body of revolution whose curved side ends, tangent, in a flat disc ``width`` wide."""
    del rng
    points = [[1.0, 0.0], [1.0, 0.7], [width, 0.7]]
    space = RationalBezier([[x, 0.0, z] for x, z in points])
    return Twin(RevolvedHull([BezierCurve(points)]), so.shapes.hull_of_revolution(space))


def box_like(rng: Rng, exponent: float) -> Twin:
    """Superellipsoids whose faces are flat at one point: curvature 0 there."""
    axes = [float(x) for x in rng.uniform(0.5, 1.0, 3)]
    return Twin(
        Superellipsoid(*axes, exponent, exponent),
        so.shapes.superellipsoid(*axes, exponent, exponent),
    )


FLATTENED: tuple[Callable[[Rng], Twin], ...] = (
    shapes.ellipsoid,
    shapes.lens,
    shapes.cylinder,
    shapes.cone,
    shapes.cap,
    shapes.polytope,
    curved_shapes.egg,
    curved_shapes.superellipsoid,
    curved_shapes.gore,
    nurbs_bodies.any_nurbs,
)


def flattened(rng: Rng, ratio: float) -> Twin:
    """A plain body flattened along a random direction: sheared axes, oblique sections."""
    twin = FLATTENED[rng.integers(len(FLATTENED))](rng)
    turn = random_rotation(rng)
    matrix = turn @ np.diag([1.0, 1.0, 1.0 / ratio]) @ turn.T
    return Twin(Affine(twin.shape, matrix), twin.body.transformed(matrix))


def user_patches(rng: Rng, degree: float) -> Twin:
    """NURBS patches collapsed at poles (lens, octants), or with G1 seams at cube diagonals."""
    del degree
    kind = rng.integers(3)
    if kind == 0:
        return nurbs_bodies.lens(rng)
    axes = [float(x) for x in rng.uniform(0.4, 1.0, 3)]
    patches = (ellipsoid_octants, ellipsoid_patches)[kind - 1](*axes)
    return Twin(oracle.Ellipsoid(*axes), so.Body.from_patches(patches))


RATIOS, HARDER = (1e2, 1e4), (1e3, 1e5, 1e6)
SMALL, SMALLER = (1e-3, 1e-6, 1e-8), (1e-4, 1e-5, 1e-7, 1e-9)
SEAMS = np.vstack([AXES, DIAGONALS, HALVES])

KINDS: dict[str, Kind] = {
    "thin ellipsoid": Kind(ellipsoid, RATIOS, HARDER),
    "thin box": Kind(box, RATIOS, HARDER, np.vstack([AXES, HALVES])),
    "thin rounded box": Kind(rounded_box, RATIOS, HARDER, np.vstack([AXES, HALVES])),
    "disc or rod": Kind(cylinder, RATIOS, HARDER),
    "flat or sharp cone": Kind(cone, RATIOS, HARDER),
    "slender capsule": Kind(capsule, RATIOS, HARDER),
    "thin superellipsoid": Kind(superellipsoid, RATIOS, HARDER, np.vstack([AXES, HALVES])),
    "thin NURBS ellipsoid": Kind(nurbs_ellipsoid, RATIOS, HARDER, SEAMS),
    "thin lens": Kind(thin_lens, RATIOS, HARDER),
    "shallow cap": Kind(cap, RATIOS, HARDER),
    "slender spindle, gore, egg": Kind(needle, RATIOS, HARDER),
    "flattened body": Kind(flattened, RATIOS, (1e3, 1e5), SEAMS),
    "short edges: cut corner": Kind(cut_corner, SMALL, SMALLER, SEAMS),
    "short edges: capsule": Kind(short_capsule, SMALL, SMALLER, np.vstack([AXES, HALVES])),
    "short edges: chisel": Kind(chiselled, SMALL, SMALLER),
    "small rounding": Kind(small_rounding, SMALL, SMALLER, SEAMS),
    "dihedral angle: roof": Kind(roof, SMALL, SMALLER),
    "dihedral angle: sewn roof": Kind(sewn_roof, SMALL, SMALLER),
    "dihedral angle: lens": Kind(nearly_ball, SMALL, SMALLER, np.vstack([AXES, HALVES])),
    "flat patch, G1": Kind(flat_top, (0.5, 1e-3), (1e-1, 1e-2, 1e-4)),
    "flat points": Kind(box_like, (0.5, 0.1), (0.3, 0.2, 1.8)),
    "poles and seams of patches": Kind(user_patches, (1.0,), (), SEAMS),
}
"""Every kind of degenerate body with its levels."""


def _ball(rng: Rng) -> Twin:
    r = float(np.exp(rng.uniform(-3, 0)))
    return Twin(oracle.Sphere(r), so.shapes.sphere(r))


def _brick(rng: Rng) -> Twin:
    lengths = [float(x) for x in rng.uniform(0.2, 1.0, 3)]
    return Twin(oracle.Box(*lengths), so.shapes.box(*lengths))


def _pebble(rng: Rng) -> Twin:
    axes = [float(x) for x in rng.uniform(0.2, 1.0, 3)]
    return Twin(oracle.Ellipsoid(*axes), so.shapes.ellipsoid(*axes))


def _point(rng: Rng) -> Twin:
    del rng
    return Twin(oracle.Point(), so.shapes.point())


def _half_space(rng: Rng) -> Twin:
    del rng
    return Twin(oracle.HalfSpace(), so.shapes.halfspace())


PARTNERS = (_ball, _brick, _pebble, _point, _half_space)


def partner(rng: Rng, body: Twin) -> Twin:
    """The other body of a pair: plain, or the degenerate one once more."""
    number = rng.integers(len(PARTNERS) + 1)
    return body if number == len(PARTNERS) else PARTNERS[number](rng)


def scaled(twin: Twin, scale: float) -> Twin:
    """The same body larger or smaller; points and half-spaces have no size."""
    if twin.body.size == 0.0 or isinstance(twin.shape, oracle.HalfSpace):
        return twin
    matrix = scale * np.eye(3)
    return Twin(Affine(twin.shape, matrix), twin.body.transformed(matrix))


def aimed(rng: Rng, kind: Kind, rotation: Array) -> Array | None:
    """A world normal at or beside one of a kind's degenerate places; None for any at all."""
    if rng.random() < 0.3:
        return None
    aim = kind.aims[rng.integers(len(kind.aims))]
    beside = NEAR[rng.integers(len(NEAR))] * rng.normal(size=3)
    normal = rotation @ (aim + beside)
    return np.asarray(normal / np.linalg.norm(normal))
