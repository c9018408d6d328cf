"""Shells of patches whose bodies are known: spheres, boxes and cylinders cut in many ways."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.special import comb

from standoff.bodies.shapes import sphere_atlas
from standoff.geometry import BezierPatch, Cone, Cylinder, NurbsSurface, Plane, Surface

Array = NDArray[np.float64]


def cube_sphere(pieces: int = 1, axes: Sequence[float] = (1.0, 1.0, 1.0)) -> list[Surface]:
    """An ellipsoid in 6 pieces² gnomonic charts, x_u cross x_v outward."""
    cuts = np.linspace(-1.0, 1.0, pieces + 1)
    return [
        chart.restricted(cuts[i], cuts[i + 1], cuts[j], cuts[j + 1])
        for chart in sphere_atlas(np.diag(axes), np.zeros(3))
        for i, j in product(range(pieces), repeat=2)
    ]


def box(lengths: Sequence[float]) -> list[Surface]:
    """Six rectangles, x_u cross x_v outward."""
    half = 0.5 * np.asarray(lengths, dtype=float)
    patches: list[Surface] = []
    for axis, sign in product(range(3), (-1.0, 1.0)):
        one, two = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3]
        plane = Plane.through(sign * half[axis] * np.eye(3)[axis], one, sign * two)
        a, b = half[(axis + 1) % 3], half[(axis + 2) % 3]
        patches.append(plane.restricted(-a, a, -b, b))
    return patches


def spindle(radius: float, height: float) -> list[Surface]:
    """A tube of a full turn between two cones: every side is closed, a seam or collapsed."""
    tube = Cylinder(np.diag([radius, radius, 1.0]), np.zeros(3))
    half = 0.5 * height
    low = Cone(np.diag([radius, radius, half]), [0.0, 0.0, -height])
    high = Cone(np.diag([radius, radius, -half]), [0.0, 0.0, height])
    turn = (0.0, 2.0 * np.pi)
    return [
        tube.restricted(*turn, -half, half),
        *(c.restricted(*turn, 0.0, 1.0) for c in (low, high)),
    ]


def turned(profile: Sequence[tuple[float, float]]) -> NurbsSurface:
    """The ruled surface of revolution of two points (radius, z): one full turn, exact."""
    corners = np.array(
        [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]]
    )
    points = np.array([[[r * x, r * y, z] for r, z in profile] for x, y in corners])
    weights = np.tile([[1.0], [np.sqrt(0.5)]], (5, 2))[:9]
    knots = np.array([0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]) / 4.0
    return NurbsSurface(points, knots, [0, 0, 1, 1], weights)


def cylinder(radius: float, length: float) -> list[Surface]:
    """A tube and two discs, each with a seam and knots where it is not C2."""
    half = 0.5 * length
    return [
        turned(((radius, -half), (radius, half))),
        turned(((0.0, -half), (radius, -half))),
        turned(((radius, half), (0.0, half))),
    ]


def square_disc() -> BezierPatch:
    """The unit disc z = 0 as one patch of four quarter circles: singular at its corners."""
    points = [
        [(-1, 0, 0), (-1, -1, 0), (0, -1, 0)],
        [(-1, 1, 0), (0, 0, 0), (1, -1, 0)],
        [(0, 1, 0), (1, 1, 0), (1, 0, 0)],
    ]
    r = np.sqrt(0.5)
    return BezierPatch(points, [[1, r, 1], [r, 1, r], [1, r, 1]])


def bernstein(degree: int, t: Array) -> Array:
    """Values of the Bernstein polynomials, (len(t), degree + 1)."""
    k = np.arange(degree + 1)
    return comb(degree, k) * t[:, None] ** k * (1.0 - t[:, None]) ** (degree - k)


def homogeneous(patch: BezierPatch) -> Array:
    """Control points (w x, w y, w z, w), (p + 1, q + 1, 4)."""
    (span,) = patch.spans()
    return np.moveaxis(span.points, 0, -1)


def bezier(points: Array) -> BezierPatch:
    return BezierPatch(points[..., :3] / points[..., 3:], points[..., 3])


def reparametrised(patch: BezierPatch, skew: float) -> BezierPatch:
    """The same surface with u -> u + skew u (1 - u), along both parameters: of twice the degree."""
    points = homogeneous(patch)
    for axis in (0, 1):
        degree = points.shape[axis] - 1
        t = 0.5 - 0.5 * np.cos(np.pi * np.arange(2 * degree + 1) / (2 * degree))
        raised = np.linalg.solve(
            bernstein(2 * degree, t), bernstein(degree, t + skew * t * (1 - t))
        )
        points = np.moveaxis(np.tensordot(raised, points, (1, axis)), 0, axis)
    return bezier(points)


def projectively_reparametrised(patch: BezierPatch, ratio: float) -> BezierPatch:
    """The same surface with u -> ratio u / (1 - u + ratio u), along both parameters."""
    points = homogeneous(patch)
    n, m = points.shape[:2]
    points = points * (ratio ** np.arange(n))[:, None, None] * (ratio ** np.arange(m))[:, None]
    return bezier(points)


def flipped(patch: BezierPatch) -> BezierPatch:
    """The same surface, u the other way round."""
    return bezier(homogeneous(patch)[::-1])
