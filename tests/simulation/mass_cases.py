"""Bodies whose moments are known: each as the library makes it, and by a formula."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import solids
import standoff as so
from solids import Solid
from standoff.geometry import BezierPatch, ConicArc, ellipsoid_patches

SHAPES = so.shapes
HALF = np.pi / 2
TETRAHEDRON = np.array([[0.0, 0, 0], [2, 0, 0], [0, 1, 0], [0.3, 0.2, 1.5]])
CLOUD = np.random.default_rng(5).normal(size=(12, 3)) * [1.0, 2.0, 0.5] + [3.0, -1.0, 2.0]
TINY, HUGE = 1e-12, 1e8


def capsule(radius: float, length: float) -> Solid:
    half, round_end = length / 2, solids.arc(radius, 0.0, length / 2)
    lower = solids.arc(radius, 0.0, -half)
    side = solids.straight(radius, -half, radius, half)
    return solids.revolved((lower, -HALF, 0.0), (side, 0.0, 1.0), (round_end, 0.0, HALF))


def rounded_cylinder(r: float, h: float, rho: float) -> Solid:
    lower, upper = solids.arc(rho, r, -h / 2), solids.arc(rho, r, h / 2)
    side = solids.straight(r + rho, -h / 2, r + rho, h / 2)
    return solids.revolved((lower, -HALF, 0.0), (side, 0.0, 1.0), (upper, 0.0, HALF))


def rounded_cone(r: float, h: float, rho: float) -> Solid:
    """Base, rim, slant and tip."""
    up = np.arctan2(r, h)  # of the slant's normal
    rim, tip = solids.arc(rho, r, -h / 2), solids.arc(rho, 0.0, h / 2)
    out, rise = rho * np.cos(up), rho * np.sin(up)
    side = solids.straight(r + out, -h / 2 + rise, out, h / 2 + rise)
    return solids.revolved((rim, -HALF, up), (side, 0.0, 1.0), (tip, up, HALF))


def egg(radius: float, length: float, taper: float) -> Solid:
    def meridian(t: np.ndarray) -> tuple[np.ndarray, ...]:
        r = radius * np.sqrt(1 - taper**2) * np.cos(t) / (1 + taper * np.sin(t))
        return r, length / 2 * np.sin(t), length / 2 * np.cos(t)

    return solids.revolved((meridian, -HALF, HALF))


def spindle(bulge: float, length: float, r: float = 0.0) -> Solid:
    half = length / 2
    radius = (half**2 + bulge**2) / (2 * bulge)
    reach = np.arcsin(half / radius)
    side = solids.arc(radius + r, bulge - radius, 0.0)
    tips = [solids.arc(r, 0.0, -half), solids.arc(r, 0.0, half)]
    return solids.revolved((tips[0], -HALF, -reach), (side, -reach, reach), (tips[1], reach, HALF))


def cap(radius: float, offset: float) -> Solid:
    return solids.revolved((solids.arc(radius, 0.0, 0.0), np.arcsin(offset / radius), HALF))


def ring_hull(ring: float, a: float, b: float) -> Solid:
    """The hull of a revolved ellipse: its outer half, closed by two discs."""
    return solids.revolved(
        (lambda t: (ring + a * np.cos(t), b * np.sin(t), b * np.cos(t)), -HALF, HALF)
    )


def ring_body(ring: float, a: float, b: float) -> so.Body:
    return SHAPES.hull_of_revolution(ConicArc((ring, 0, 0), (a, 0, 0), (0, 0, b)))


def box_of_patches(a: float, b: float, c: float) -> so.Body:
    corners = np.array([[x, y, z] for x in (-a, a) for y in (-b, b) for z in (-c, c)]) / 2
    corners = corners.reshape(2, 2, 2, 3)
    nets = [np.take(corners, end, axis=axis) for axis in range(3) for end in (0, 1)]
    return so.Body.from_patches([BezierPatch(net) for net in nets])


def ellipsoid_of_patches(a: float, b: float, c: float) -> so.Body:
    return so.Body.from_patches(ellipsoid_patches(a, b, c))


CASES: dict[str, tuple[Callable[[], so.Body], Callable[[], Solid]]] = {
    "sphere": (lambda: SHAPES.sphere(0.7), lambda: solids.ellipsoid(0.7, 0.7, 0.7)),
    "tiny sphere": (lambda: SHAPES.sphere(TINY), lambda: solids.ellipsoid(TINY, TINY, TINY)),
    "ellipsoid": (lambda: SHAPES.ellipsoid(1, 2, 3), lambda: solids.ellipsoid(1, 2, 3)),
    "thin ellipsoid": (
        lambda: SHAPES.ellipsoid(1, 0.02, 3),
        lambda: solids.ellipsoid(1, 0.02, 3),
    ),
    "grown spheroid": (
        lambda: SHAPES.ellipsoid(1, 1, 0.5, rounding=0.3),
        lambda: solids.grown_spheroid(1, 0.5, 0.3),
    ),
    "box": (lambda: SHAPES.box(1, 2, 3), lambda: solids.box(1, 2, 3)),
    "huge box": (
        lambda: SHAPES.box(HUGE, 2 * HUGE, 3 * HUGE),
        lambda: solids.box(HUGE, 2 * HUGE, 3 * HUGE),
    ),
    "plate": (lambda: SHAPES.box(1, 2, 1e-6), lambda: solids.box(1, 2, 1e-6)),
    "rounded box": (
        lambda: SHAPES.box(1, 2, 3, rounding=0.25),
        lambda: solids.rounded_box(0.5, 1.5, 2.5, 0.25),
    ),
    "cylinder": (lambda: SHAPES.cylinder(0.5, 3), lambda: solids.cylinder(0.5, 3)),
    "rounded cylinder": (
        lambda: SHAPES.cylinder(0.5, 3, rounding=0.2),
        lambda: rounded_cylinder(0.5, 3, 0.2),
    ),
    "cone": (lambda: SHAPES.cone(1, 2), lambda: solids.cone(1, 2)),
    "rounded cone": (lambda: SHAPES.cone(1, 2, rounding=0.3), lambda: rounded_cone(1, 2, 0.3)),
    "capsule": (lambda: SHAPES.capsule(0.4, 1.5), lambda: capsule(0.4, 1.5)),
    "small cap": (lambda: SHAPES.cap(1, 0.9), lambda: cap(1, 0.9)),
    "half a ball": (lambda: SHAPES.cap(1, 0.0), lambda: cap(1, 0.0)),
    "large cap": (lambda: SHAPES.cap(1, -0.7), lambda: cap(1, -0.7)),
    "nearly a ball": (lambda: SHAPES.cap(1, -0.9999), lambda: cap(1, -0.9999)),
    "lens": (lambda: SHAPES.lens(2, 1), lambda: solids.lens(2, 1)),
    "lens of several charts": (lambda: SHAPES.lens(2, 0.2), lambda: solids.lens(2, 0.2)),
    "egg": (lambda: SHAPES.egg(1, 2.5, 0.4), lambda: egg(1, 2.5, 0.4)),
    "spindle": (lambda: SHAPES.spindle(0.4, 2), lambda: spindle(0.4, 2)),
    "rounded spindle": (
        lambda: SHAPES.spindle(0.4, 2, rounding=0.1),
        lambda: spindle(0.4, 2, 0.1),
    ),
    "ring": (lambda: ring_body(2, 0.7, 0.4), lambda: ring_hull(2, 0.7, 0.4)),
    "tetrahedron": (
        lambda: SHAPES.polytope(TETRAHEDRON),
        lambda: solids.polytope(TETRAHEDRON),
    ),
    "polytope": (lambda: SHAPES.polytope(CLOUD), lambda: solids.polytope(CLOUD)),
    "sewn box": (lambda: box_of_patches(1, 2, 3), lambda: solids.box(1, 2, 3)),
    "NURBS ellipsoid": (
        lambda: ellipsoid_of_patches(1, 2, 0.5),
        lambda: solids.ellipsoid(1, 2, 0.5),
    ),
}
