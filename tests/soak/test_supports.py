"""The soak's judge: its farthest points lie on the surface, and none lies farther."""

import numpy as np
import pytest

from oracles.membership import outside
from standoff_studies.soak.placing import inside_parts
from standoff_studies.soak.shapes import KINDS, Shape, made

FORMULAS = {"formula power ball", "formula dome"}
BOUNDED = sorted(set(KINDS) - {"halfspace"} - FORMULAS)


def directions(rng, count=400):
    axes = np.vstack([np.eye(3), -np.eye(3)])
    n = rng.normal(size=(count, 3))
    return np.vstack([axes, n / np.linalg.norm(n, axis=1)[:, None]])


@pytest.mark.parametrize("kind", BOUNDED)
def test_farthest_points_lie_on_the_surfaces_that_the_tests_know(kind, rng):
    support = made(Shape(kind, KINDS[kind].draw(rng))).support
    points = support.points(directions(rng, 60))
    size = max(np.abs(points).max(), 1e-300)
    assert max(abs(outside(support, point)) for point in points) <= 1e-12 * size


@pytest.mark.parametrize("kind", BOUNDED)
def test_farthest_points_lie_on_the_body_and_no_other_lies_farther(kind, rng):
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
