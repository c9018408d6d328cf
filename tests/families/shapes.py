"""Random bodies of every kind, each as an oracle's shape and as the library's body."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import standoff as so
from oracles.loops import BezierCurve, PlanarLoop
from standoff.geometry import RationalBezier
from standoff_studies import oracles as oracle
from standoff_studies.oracles import Shape

Rng = np.random.Generator

ELLIPSOID_RATIO = 100.0
"""Greatest ratio of an ellipsoid's axes."""
PLANAR = (
    ((1, 0), (0.775, 0.645), (0.175, 1.005), (-0.5, 0.9)),
    ((-0.5, 0.9), (-0.87, 0.41), (-0.91, -0.27), (-0.6, -0.8)),
    ((-0.6, -0.8), (0.12, -1.04), (0.76, -0.72), (1, 0)),
)
"""The planar golden body."""


@dataclass(frozen=True)
class Twin:
    """One body twice: ``shape`` judges, ``body`` is judged."""

    shape: Shape
    body: so.Body


Maker = Callable[[Rng], Twin]


def random_lengths(rng: Rng, count: int, low: float = 0.2, high: float = 5.0) -> list[float]:
    return [float(x) for x in np.exp(rng.uniform(np.log(low), np.log(high), count))]


def ellipsoid(rng: Rng) -> Twin:
    axes = random_lengths(rng, 3, ELLIPSOID_RATIO**-0.5, ELLIPSOID_RATIO**0.5)
    return Twin(oracle.Ellipsoid(*axes), so.shapes.ellipsoid(*axes))


def _lens(rng: Rng, share: float) -> Twin:
    (radius,) = random_lengths(rng, 1, 0.4, 2.5)
    return Twin(oracle.Lens(radius, share * radius), so.shapes.lens(radius, share * radius))


def lens(rng: Rng) -> Twin:
    return _lens(rng, rng.uniform(0.05, 0.9))


def thin_lens(rng: Rng) -> Twin:
    """Centres so far out that a tenth down to a thousandth of the radius is left."""
    return _lens(rng, 1.0 - 10.0 ** rng.uniform(-3, -1))


def point(rng: Rng) -> Twin:
    del rng
    return Twin(oracle.Point(), so.shapes.point())


def planar_point(rng: Rng) -> Twin:
    twin = point(rng)
    twin.shape.dimension = 2
    return twin


def box(rng: Rng) -> Twin:
    """Sharp in half of the cases."""
    lengths = random_lengths(rng, 3)
    rounding = 0.0 if rng.random() < 0.5 else float(rng.uniform(0, 0.45) * min(lengths))
    return Twin(oracle.Box(*lengths, rounding), so.shapes.box(*lengths, rounding))


def cylinder(rng: Rng) -> Twin:
    radius, length = random_lengths(rng, 2)
    return Twin(oracle.Cylinder(radius, length), so.shapes.cylinder(radius, length))


def cone(rng: Rng) -> Twin:
    radius, height = random_lengths(rng, 2)
    return Twin(oracle.Cone(radius, height), so.shapes.cone(radius, height))


def capsule(rng: Rng) -> Twin:
    radius, length = random_lengths(rng, 2)
    return Twin(oracle.Capsule(radius, length), so.shapes.capsule(radius, length))


def cap(rng: Rng) -> Twin:
    (radius,) = random_lengths(rng, 1)
    height = float(radius * rng.uniform(-0.9, 0.95))
    return Twin(oracle.Cap(radius, height), so.shapes.cap(radius, height))


def flat_ended(rng: Rng) -> Twin:
    """A body whose side facing -z is flat and whose side facing +z may be."""
    return (box, cylinder, cone, cap)[rng.integers(4)](rng)


def flat_topped(rng: Rng) -> Twin:
    """A body whose side facing +z is flat."""
    return (box, cylinder)[rng.integers(2)](rng)


def polytope(rng: Rng) -> Twin:
    count = int(rng.integers(4, 40))
    vertices = rng.normal(size=(count, 3)) * np.exp(rng.uniform(-1, 1, 3))
    return Twin(oracle.Polytope(vertices), so.shapes.polytope(vertices))


def half_space(rng: Rng) -> Twin:
    del rng
    return Twin(oracle.HalfSpace(), so.shapes.halfspace())


def loop(rng: Rng) -> Twin:
    """The planar golden body, stretched along both axes."""
    stretch = np.exp(rng.uniform(-1, 1, 2))
    curves = [np.array(points) * stretch for points in PLANAR]
    return Twin(
        PlanarLoop([BezierCurve(points) for points in curves]),
        so.shapes.planar_loop([RationalBezier(points) for points in curves]),
    )


SOLIDS: tuple[Maker, ...] = (
    ellipsoid,
    lens,
    thin_lens,
    point,
    box,
    cylinder,
    cone,
    capsule,
    cap,
    polytope,
)


def solid(rng: Rng) -> Twin:
    """Any bounded spatial body."""
    return SOLIDS[rng.integers(len(SOLIDS))](rng)


def extended_solid(rng: Rng) -> Twin:
    """Any bounded spatial body but the point: two points are never free and close."""
    makers = [maker for maker in SOLIDS if maker is not point]
    return makers[rng.integers(len(makers))](rng)
