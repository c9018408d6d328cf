"""Random bodies of the curved ready-made shapes, each as an oracle's shape and the library's."""

from __future__ import annotations

import numpy as np

import standoff as so
from families.shapes import Rng, Twin, random_lengths
from oracles.loops import BezierCurve, Curve
from oracles.loops import ConicArc as PlanarArc
from oracles.revolved import RevolvedHull
from standoff.geometry import ConicArc, RationalBezier
from standoff.geometry import Curve as SpaceCurve
from standoff_studies.oracles import Egg, Gore, RoundedPolytope, Spindle, Superellipsoid

SAME_CORNER = 4e-15
"""How far apart (over the size) corners of body and oracle may be: a few roundings."""


def rounded_polytope(rng: Rng) -> Twin:
    """Rounded by a tenth to nine tenths of its inscribed ball's radius, about.

    Where planes meet so flatly that their corner is known to fewer digits than the judges ask
    for, body and oracle are two bodies: another is drawn.
    """
    while True:
        twin = _rounded_polytope(rng)
        known, found = twin.shape.core.vertices, twin.body.vertex_points
        apart = np.linalg.norm(found[:, None] - known, axis=2).min(axis=1).max()
        if apart <= SAME_CORNER * twin.body.size:
            return twin


def _rounded_polytope(rng: Rng) -> Twin:
    vertices = rng.normal(size=(int(rng.integers(4, 25)), 3)) * np.exp(rng.uniform(-1, 1, 3))
    rounding = float(
        np.ptp(vertices, axis=0).min() * np.exp(rng.uniform(np.log(0.01), np.log(0.4)))
    )
    while True:
        try:
            body = so.shapes.rounded_polytope(vertices, rounding)
        except so.BodyError:
            rounding /= 2
            continue
        return Twin(RoundedPolytope(vertices, rounding), body)


def egg(rng: Rng) -> Twin:
    radius, length = random_lengths(rng, 2, 0.4, 2.5)
    taper = float(rng.uniform(-0.7, 0.7))
    return Twin(Egg(radius, length, taper), so.shapes.egg(radius, length, taper))


def superellipsoid(rng: Rng) -> Twin:
    """Exponents 0.2 (nearly a box) to 1.8 (nearly an octahedron), now and then 1 exactly."""
    a, b, c = random_lengths(rng, 3, 0.3, 2.0)
    e1, e2 = (1.0 if rng.random() < 0.1 else float(rng.uniform(0.2, 1.8)) for _ in range(2))
    return Twin(Superellipsoid(a, b, c, e1, e2), so.shapes.superellipsoid(a, b, c, e1, e2))


def spindle(rng: Rng) -> Twin:
    (length,) = random_lengths(rng, 1, 0.5, 3.0)
    radius, patches = float(length / 2 * rng.uniform(0.05, 0.98)), int(rng.integers(3, 9))
    return Twin(Spindle(radius, length), so.shapes.spindle(radius, length, patches))


def gore(rng: Rng) -> Twin:
    (height,) = random_lengths(rng, 1, 0.5, 3.0)
    radius, patches = float(height / 2 * rng.uniform(0.05, 0.98)), int(rng.integers(3, 9))
    return Twin(Gore(radius, height, patches), so.shapes.gore(radius, height, patches))


def revolved_hull(rng: Rng) -> Twin:
    """The hull of a revolved ring, of a wavy profile off the axis, or of one with a pole."""
    kind = rng.integers(3)
    if kind == 0:
        ring, a, b = random_lengths(rng, 3, 0.2, 2.0)
        ring += a
        centre = float(rng.normal())
        planar: Curve = PlanarArc((ring, centre), (a, 0), (0, b), 0, 2 * np.pi)
        curve: SpaceCurve = ConicArc((ring, 0, centre), (a, 0, 0), (0, 0, b))
    else:
        count = int(rng.integers(3, 7))
        points = np.column_stack([rng.uniform(0.1, 2, count), np.sort(rng.normal(size=count))])
        points[0, 0] = 0.0 if kind == 2 else points[0, 0]
        weights = rng.uniform(0.5, 2, count)
        planar = BezierCurve(points, weights)
        curve = RationalBezier(np.insert(points, 1, 0.0, axis=1), weights)
    return Twin(RevolvedHull([planar]), so.shapes.hull_of_revolution(curve))
