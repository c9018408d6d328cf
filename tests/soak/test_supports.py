"""The soak's judge against the tests' oracles, and each of its bodies against its own surface."""

import numpy as np
import pytest

from oracles.between_poles import Gore, Spindle
from oracles.revolved import Egg
from oracles.rounded_polytopes import RoundedPolytope
from oracles.superellipsoids import Superellipsoid
from oracles.support import Box, Cap, Capsule, Cone, Cylinder, Ellipsoid, Lens, Polytope, Sphere
from standoff.soak.placing import inside_parts
from standoff.soak.shapes import KINDS, Shape, made

ORACLES = {
    "sphere": lambda r: Sphere(r),
    "capsule": lambda r, length: Capsule(r, length),
    "ellipsoid": lambda axes: Ellipsoid(*axes),
    "cylinder": lambda r, length: Cylinder(r, length),
    "cone": lambda r, height: Cone(r, height),
    "box": lambda axes: Box(*axes),
    "rounded box": lambda axes, rounding: Box(*axes, rounding),
    "polytope": lambda vertices: Polytope(vertices),
    "rounded polytope": lambda vertices, rounding: RoundedPolytope(vertices, rounding),
    "lens": lambda radius, offset: Lens(radius, offset),
    "cap": lambda radius, offset: Cap(radius, offset),
    "superellipsoid": lambda axes, e1, e2: Superellipsoid(*axes, e1, e2),
    "creased superellipsoid": lambda axes, e1, e2: Superellipsoid(*axes, e1, e2),
    "egg": lambda radius, length, taper: Egg(radius, length, taper),
    "spindle": lambda radius, length: Spindle(radius, length),
    "gore": lambda radius, height, sides: Gore(radius, height, sides),
    "sewn ellipsoid": lambda axes: Ellipsoid(*axes),
}
FORMULAS = {"formula power ball", "formula dome"}
BOUNDED = sorted(set(KINDS) - {"halfspace"} - FORMULAS)


def directions(rng, count=400):
    axes = np.vstack([np.eye(3), -np.eye(3)])
    n = rng.normal(size=(count, 3))
    return np.vstack([axes, n / np.linalg.norm(n, axis=1)[:, None]])


@pytest.mark.parametrize("kind", sorted(ORACLES))
def test_support_values_are_the_oracles(kind):
    rng = np.random.default_rng()
    numbers = KINDS[kind].draw(rng)
    n = directions(rng)
    found = made(Shape(kind, numbers)).support.points(n)
    values, _ = ORACLES[kind](**numbers).support_many(n)
    size = np.abs(found).max()
    np.testing.assert_allclose((n * found).sum(axis=1), values, rtol=0, atol=1e-13 * size)


@pytest.mark.parametrize("kind", BOUNDED)
def test_farthest_points_lie_on_the_body_and_no_other_lies_farther(kind):
    rng = np.random.default_rng()
    one = made(Shape(kind, KINDS[kind].draw(rng)))
    n = directions(rng)
    points = one.support.points(n)
    core, radius = inside_parts(one)
    size = max(np.abs(points).max(), 1e-300)
    assert np.abs(core.outside(points - radius * n)).max() <= 1e-12 * size
    heights = n @ points.T
    assert (heights - np.diag(heights)[:, None]).max() <= 1e-13 * size
    # a little beyond is outside
    beyond = points - radius * n + 1e-6 * size * n
    if kind != "point":
        assert core.outside(beyond).min() > 1e-9 * size
