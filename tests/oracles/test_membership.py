"""The measure of how far a point lies outside a shape, against support points."""

import numpy as np
import pytest

from oracles.exact_pairs import random_normal
from oracles.loops import PlanarLoop, line
from oracles.membership import outside
from standoff_studies.oracles import (
    Affine,
    Box,
    Cap,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    Lens,
    Point,
    Polytope,
    Segment,
    SharpBox,
    Sphere,
    Swept,
)

SOLIDS = {
    "sphere": Sphere(0.7),
    "ellipsoid": Ellipsoid(1.0, 0.5, 0.2),
    "capsule": Capsule(0.3, 1.0),
    "box": Box(1.0, 2.0, 3.0),
    "rounded box": Box(1.0, 2.0, 3.0, 0.2),
    "cylinder": Cylinder(0.5, 1.5),
    "cone": Cone(0.5, 1.2),
    "cap": Cap(1.0, 0.3),
    "lens": Lens(1.0, 0.45),
    "sharp box": SharpBox(1.0, 2.0, 3.0),
    "polytope": Polytope(np.random.default_rng(81).normal(size=(12, 3))),
    "affine lens": Affine(Lens(1.0, 0.45), np.diag([0.5, 1.5, 1.0]), (1, 2, 3)),
    "affine cone": Affine(Cone(0.5, 1.2), np.diag([0.5, 1.5, 1.0]), (1, 2, 3)),
}


OWN = [name for name, shape in SOLIDS.items() if not isinstance(shape, Swept | Affine)]
"""Shapes that know how far points lie outside; the tests' measure does not ask them."""


def by_itself(shape, point):
    return shape.outside(np.array([point]))[0]


@pytest.mark.parametrize(
    ("name", "outside"),
    [*((name, outside) for name in SOLIDS), *((name, by_itself) for name in OWN)],
)
def test_zero_on_the_boundary_and_positive_outside(name, outside):
    shape, rng = SOLIDS[name], np.random.default_rng(82)
    # Inside every one of them but the shifted images and the cap, where it is their shift or axis.
    middle = getattr(shape, "shift", np.array([0, 0, 0.6]) if name == "cap" else np.zeros(3))
    for _ in range(100):
        n = random_normal(rng)
        x = shape.support(n)[1]
        assert abs(outside(shape, x)) <= 1e-13
        assert outside(shape, x + 1e-6 * n) > 1e-8
        assert outside(shape, x + 1e-3 * (middle - x)) <= 0


@pytest.mark.parametrize("outside", [outside, by_itself])
def test_shapes_without_volume(outside):
    assert outside(Point(), (0, 0, 0)) == 0
    assert outside(Point(), (0, -2, 0)) == 2
    assert outside(Segment(1.0), (0, 0, 0.5)) == 0
    assert outside(Segment(1.0), (0, 0, 0.7)) == pytest.approx(0.2)
    assert outside(Segment(1.0), (0.3, 0, 0.1)) == pytest.approx(0.3)


def test_planar_loops_are_refused():
    loop = PlanarLoop([line((0, 0), (1, 0)), line((1, 0), (0, 1)), line((0, 1), (0, 0))])
    with pytest.raises(TypeError, match="PlanarLoop is not a set of quadratic inequalities"):
        outside(loop, (0, 0, 0))
