"""Patches of every kind of surface, drawn, each with the part of its domain where it is regular."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import standoff.geometry as g

ORIGIN = np.zeros(3)


@dataclass(frozen=True)
class Kind:
    """A maker of surfaces from a generator, and (u0, u1, v0, v1)."""

    make: Callable[[np.random.Generator], Any]
    domain: tuple[float, float, float, float]


def bent(n: int, m: int, rng: np.random.Generator, rough: float) -> np.ndarray:
    """(n, m, 3) control points of a saddle with some noise."""
    u, v = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, m), indexing="ij")
    saddle = np.stack([u, v, 0.3 * u * u - 0.2 * v * v], -1)
    return saddle + rough * rng.uniform(-1, 1, (n, m, 3))


def weights(shape: tuple[int, ...], rng: np.random.Generator) -> np.ndarray:
    return np.exp(rng.uniform(-0.5, 0.5, shape))


def bezier(rng: np.random.Generator) -> Any:
    p, q = rng.integers(1, 8, 2)
    shape = (p + 1, q + 1)
    w = weights(shape, rng) if rng.uniform() < 0.7 else None
    return g.BezierPatch(bent(*shape, rng, 0.15), w)


def knots(n: int, p: int) -> np.ndarray:
    return np.r_[[0.0] * p, np.linspace(0, 1, n - p + 1), [1.0] * p]


def nurbs(rng: np.random.Generator) -> Any:
    n, m, p, q = 6, 5, 3, 2
    return g.NurbsSurface(bent(n, m, rng, 0.05), knots(n, p), knots(m, q), weights((n, m), rng))


def profile(rng: np.random.Generator) -> Any:
    """A curve at x > 0, near the x-z plane's x = 1."""
    points = np.array([[1.0, 0, 0], [1.5, 0, 0.3], [1.2, 0, 0.9], [0.7, 0, 1.2]])
    points[:, [0, 2]] += 0.05 * rng.uniform(-1, 1, (4, 2))
    return g.RationalBezier(points, weights((4,), rng))


def spline(rng: np.random.Generator) -> Any:
    points = np.array([[1.0, 0, 0], [1.5, 0, 0.3], [1.2, 0, 0.9], [1.4, 0, 1.2], [0.9, 0, 1.5]])
    return g.NurbsCurve(points, knots(5, 2), weights((5,), rng))


def pole(rng: np.random.Generator) -> Any:
    """A quarter of a circle, turned: a hemisphere whose pole is at v = 0."""
    quarter = g.RationalBezier([[0, 0, -1], [1, 0, -1], [1, 0, 0]], [1, np.sqrt(0.5), 1])
    return g.Revolution(quarter)


def formula(rng: np.random.Generator) -> Any:
    z = "0.3*u**2 - 0.2*u*v + exp(0.4*v)*cos(u)"
    return g.FormulaSurface("u", "v", z, (-1, 1, -1, 1))


def stretched(rng: np.random.Generator) -> np.ndarray:
    return np.diag([1.0, 1.0, rng.uniform(0.3, 3.0)])


def exponents(rng: np.random.Generator) -> dict[str, float]:
    return dict(zip(("e1", "e2"), rng.uniform(0.2, 1.7, 2), strict=True))


TURN = (0.0, 6.28)
KINDS = {
    "plane": Kind(lambda rng: g.Plane(np.eye(3), ORIGIN), (-2, 2, -2, 2)),
    "sphere": Kind(lambda rng: g.Sphere(np.eye(3), ORIGIN), (-1.5, 1.5, -1.5, 1.5)),
    "cylinder": Kind(lambda rng: g.Cylinder(stretched(rng), ORIGIN), (*TURN, -2, 2)),
    "cone": Kind(lambda rng: g.Cone(stretched(rng), ORIGIN), (*TURN, 0.05, 2)),
    "torus": Kind(lambda rng: g.Torus(2.0, rng.uniform(0.2, 1.8)), (*TURN, -1.57, 1.57)),
    "pole chart": Kind(
        lambda rng: g.SuperellipsoidPole(np.eye(3), ORIGIN, **exponents(rng)), (-1, 1, -1, 1)
    ),
    "side chart": Kind(
        lambda rng: g.SuperellipsoidSide(np.eye(3), ORIGIN, **exponents(rng)), (-1, 1, -1, 1)
    ),
    "bezier": Kind(bezier, (0, 1, 0, 1)),
    "nurbs": Kind(nurbs, (0, 1, 0, 1)),
    "turned line": Kind(lambda rng: g.Revolution(g.Line([1.5, 0, 0], [0.8, 0, 1])), (*TURN, 0, 1)),
    "turned circle": Kind(
        lambda rng: g.Revolution(g.ConicArc([1.5, 0, 0], [0.8, 0, 0], [0, 0, 1])), (*TURN, *TURN)
    ),
    "turned bezier": Kind(lambda rng: g.Revolution(profile(rng)), (*TURN, 0, 1)),
    "turned spline": Kind(lambda rng: g.Revolution(spline(rng)), (*TURN, 0, 1)),
    "turned quarter": Kind(pole, (*TURN, 0, 1)),
    "turned formula": Kind(
        lambda rng: g.Revolution(g.FormulaCurve("1.5 + 0.3*sin(t)", "0", "t", 0, 2)), (*TURN, 0, 2)
    ),
    "extruded circle": Kind(
        lambda rng: g.Extrusion(g.ConicArc([1, 0, 0], [0.8, 0, 0], [0, 1, 0.2]), [0.3, 0, 1]),
        (*TURN, 0, 1),
    ),
    "extruded bezier": Kind(lambda rng: g.Extrusion(profile(rng), [0.2, 1, 0.1]), (0, 1, 0, 1)),
    "extruded spline": Kind(lambda rng: g.Extrusion(spline(rng), [0.2, 1, 0.1]), (0, 1, 0, 1)),
    "extruded formula": Kind(
        lambda rng: g.Extrusion(g.FormulaCurve("t", "0.3*sin(t)", "0.1*t**2", 0, 2), [0, 1, 1]),
        (0, 2, 0, 1),
    ),
    "formula": Kind(formula, (-1, 1, -1, 1)),
}


def affine(rng: np.random.Generator, similar: bool) -> tuple[np.ndarray, np.ndarray]:
    """A similarity, or any map, mirrored in half of the cases."""
    first, second = (np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in range(2))
    scale = (
        np.exp(rng.uniform(-1, 1, 3)) if not similar else np.exp(rng.uniform(-1, 1)) * np.ones(3)
    )
    return first @ np.diag(scale * rng.choice([-1, 1], 3)) @ second, rng.normal(size=3)


def part(domain: tuple[float, ...], width: float, rng: np.random.Generator) -> np.ndarray:
    """A rectangle, its sides about a share of the domain's."""
    low, high = np.reshape(domain, (2, 2)).T
    size = (high - low) * width * rng.uniform(0.4, 1.0, 2)
    start = low + rng.uniform(0.0, 1.0, 2) * (high - low - size)
    return np.column_stack([start, start + size]).ravel()


@dataclass(frozen=True)
class Sampled:
    """On a grid of a rectangle: points, unit normals, curvatures (least, greatest)."""

    points: np.ndarray
    normals: np.ndarray
    curvatures: np.ndarray


def sampled(surface: Any, rectangle: np.ndarray, count: int = 9) -> Sampled:
    """By the compiled jets, curvatures by their own formula; singular places are left out."""
    u0, u1, v0, v1 = rectangle
    jets = [
        surface.jet(float(u), float(v))
        for u in np.linspace(u0, u1, count)
        for v in np.linspace(v0, v1, count)
    ]
    normals, curvatures = [], []
    for _, xu, xv, xuu, xuv, xvv in jets:
        normal = np.cross(xu, xv)
        length = np.linalg.norm(normal)
        if length <= 1e-9 * max(xu @ xu, xv @ xv):
            continue
        normals.append(normal / length)
        first = np.array([[xu @ xu, xu @ xv], [xu @ xv, xv @ xv]])
        second = np.array([[xuu @ normal, xuv @ normal], [xuv @ normal, xvv @ normal]]) / length
        both = np.sort(np.linalg.eigvals(np.linalg.solve(first, second)).real)
        curvatures.append(both)
    return Sampled(np.array([jet[0] for jet in jets]), np.array(normals), np.array(curvatures))
