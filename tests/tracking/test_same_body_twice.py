"""One body given in two ways: as a ready-made shape and as patches, formulas or another shape."""

import numpy as np
import pytest

import standoff as so
from families.nurbs_bodies import egg_nets, lens_nets
from oracles.exact_pairs import random_normal, random_rotation
from standoff.geometry import (
    BezierPatch,
    ConicArc,
    FormulaSurface,
    RationalBezier,
    ellipsoid_octants,
    ellipsoid_patches,
)

AXES = (1.0, 0.6, 0.8)
DISTANCE = 1e-12
"""Difference of distances, over the size."""
WITNESS = 1e-9
"""Difference of witness points, over the size."""


def from_nets(nets):
    return so.Body.from_patches([BezierPatch(n[..., :3] / n[..., 3:], n[..., 3]) for n in nets])


def paraboloid_formulas():
    sectors = [(2 * np.pi * j / 3, 2 * np.pi * (j + 1) / 3, 0, 1) for j in range(3)]
    return so.Body.from_patches(
        [
            FormulaSurface("v*cos(u)", "v*sin(u)", z, sector)
            for sector in sectors
            for z in ("0.7*(1 - v**2)", "0")
        ]
    )


PAIRS = {
    "ellipsoid in six patches": (
        lambda: so.shapes.ellipsoid(*AXES),
        lambda: so.Body.from_patches(ellipsoid_patches(*AXES)),
    ),
    "ellipsoid in eight octants": (
        lambda: so.shapes.ellipsoid(*AXES),
        lambda: so.Body.from_patches(ellipsoid_octants(*AXES)),
    ),
    "elevated ellipsoid": (
        lambda: so.shapes.ellipsoid(*AXES),
        lambda: so.Body.from_patches([p.elevated(9, 7) for p in ellipsoid_patches(*AXES)]),
    ),
    "ellipsoid as superellipsoid": (
        lambda: so.shapes.ellipsoid(*AXES),
        lambda: so.shapes.superellipsoid(*AXES, 1, 1),
    ),
    "ellipsoid as egg": (
        lambda: so.shapes.ellipsoid(0.7, 0.7, 1.1),
        lambda: so.shapes.egg(0.7, 2.2, 0.0),
    ),
    "lens": (lambda: so.shapes.lens(1, 0.45), lambda: from_nets(lens_nets(1, 0.45))),
    "egg": (
        lambda: so.shapes.egg(1.0, 3.0, 0.4),
        lambda: from_nets(egg_nets(np.sqrt(1 - 0.16), 1.5, 0.4)),
    ),
    "spindle of three and of eight patches": (
        lambda: so.shapes.spindle(0.4, 2.0),
        lambda: so.shapes.spindle(0.4, 2.0, 8),
    ),
    "spindle as a hull of revolution": (
        lambda: so.shapes.spindle(0.4, 2.0),
        lambda: so.shapes.hull_of_revolution(
            RationalBezier([(0, 0, -1), (2 / 2.1, 0, 0), (0, 0, 1)], [1, 21 / 29, 1])
        ),
    ),
    "cylinder as a hull of revolution": (
        lambda: so.shapes.cylinder(0.5, 2.0),
        lambda: so.shapes.hull_of_revolution(
            RationalBezier([(0.5, 0, -1), (0.1, 0, 0), (0.5, 0, 1)])
        ),
    ),
    "paraboloid of formulas and of revolution": (
        paraboloid_formulas,
        lambda: so.shapes.hull_of_revolution(
            RationalBezier([(1, 0, 0), (0.5, 0, 0.7), (0, 0, 0.7)])
        ),
    ),
    "box as a rounded polytope": (
        lambda: so.shapes.box(1, 2, 3, 0.2),
        lambda: so.shapes.rounded_polytope(
            [[i, 2 * j, 3 * k] for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)], 0.2
        ),
    ),
    "ring": (
        lambda: so.shapes.hull_of_revolution(ConicArc((2, 0, 0), (0.5, 0, 0), (0, 0, 0.5))),
        lambda: so.shapes.hull_of_revolution(
            ConicArc((2, 0, 0), (0.5, 0, 0), (0, 0, 0.5), -np.pi / 2, np.pi / 2)
        ),
    ),
}


@pytest.mark.parametrize("name", PAIRS)
def test_answers_are_the_same(name):
    first, second = (make() for make in PAIRS[name])
    other, rng = so.shapes.ellipsoid(0.3, 0.5, 0.4), np.random.default_rng(31)
    size = first.size + other.size
    for _ in range(60):
        pose = so.Pose(random_rotation(rng), np.zeros(3))
        # bounding balls apart: the pair is separated, and its witness points are unique
        away = (0.5 * size + 2 * rng.uniform()) * random_normal(rng)
        answers = [
            so.distance(
                body, other, pose, so.Pose(random_rotation(np.random.default_rng(32)), away)
            )
            for body in (first, second)
        ]
        assert all(answer.status is so.Status.CONVERGED for answer in answers)
        one, two = answers
        assert abs(one.distance - two.distance) <= DISTANCE * size
        assert abs(one.point_a - two.point_a).max() <= WITNESS * size
        assert abs(one.point_b - two.point_b).max() <= WITNESS * size
