"""The rectangles of parameters on faces: inside them no walk meets a boundary."""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from standoff.kernels.body import layout as L
from standoff.kernels.body.inner_box import fits
from standoff.kernels.body.trimming import NO_HIT, on_face, walk_face

BODIES = {
    "box": so.shapes.box(1.0, 0.7, 0.5),
    "lens": so.shapes.lens(1.0, 0.45),
    "ellipsoid": so.shapes.ellipsoid(0.5, 0.4, 0.3),
    "cylinder": so.shapes.cylinder(0.3, 0.8),
    "cone": so.shapes.cone(0.4, 0.8),
    "superellipsoid": so.shapes.superellipsoid(0.5, 0.7, 0.9, 0.6, 1.3),
    "half-space": so.shapes.halfspace(),
    "thin lens": so.shapes.lens(1.0, 0.999),
}


def inner(body: so.Body, chart: int) -> np.ndarray:
    o = body.ints[body.ints[L.CHARTS] + L.CHART_STRIDE * chart + L.CHART_REALS] + L.INNER
    return np.asarray(body.reals[o : o + 4])


def without(body: so.Body) -> np.ndarray:
    """The body's reals, as if no rectangle had been found."""
    reals = np.array(body.reals)
    for chart in range(body.ints[L.N_CHARTS]):
        o = body.ints[body.ints[L.CHARTS] + L.CHART_STRIDE * chart + L.CHART_REALS] + L.INNER
        reals[o : o + 4] = L.NO_INNER
    return reals


@pytest.mark.parametrize("name", BODIES)
def test_all_of_it_lies_on_the_face(name: str, rng: np.random.Generator) -> None:
    body = BODIES[name]
    reals = without(body)
    for chart in range(body.ints[L.N_CHARTS]):
        u0, u1, v0, v1 = np.clip(inner(body, chart), -1e3, 1e3)
        assert u0 < u1
        assert v0 < v1
        for _ in range(40):
            (u, a), (v, b) = rng.uniform(u0, u1, 2), rng.uniform(v0, v1, 2)
            assert on_face(body.ints, reals, chart, u, v)
            assert walk_face(body.ints, reals, chart, u, v, a - u, b - v)[:2] == (1.0, NO_HIT)


def test_of_a_box_it_is_the_whole_face() -> None:
    body = BODIES["box"]
    areas = [np.prod(inner(body, chart)[1::2] - inner(body, chart)[::2]) for chart in range(6)]
    assert sorted(areas) == pytest.approx([0.35, 0.35, 0.5, 0.5, 0.7, 0.7], rel=1e-5)


def test_an_atlas_chart_is_used_as_far_as_a_point_stays_in_it() -> None:
    from standoff.kernels.tolerances import RECHART

    body = BODIES["ellipsoid"]
    for chart in range(6):
        np.testing.assert_array_equal(inner(body, chart), [-RECHART, RECHART, -RECHART, RECHART])


def test_a_rectangle_that_crosses_the_loop_or_holds_it_does_not_fit() -> None:
    body = BODIES["box"]
    reals = without(body)
    u0, u1, v0, v1 = inner(body, 0).tolist()
    assert fits(body.ints, reals, 0, (u0, u1, v0, v1))
    assert not fits(body.ints, reals, 0, (u0, 1.2 * u1, v0, v1))
    assert not fits(body.ints, reals, 0, (2.0 * u0, 2.0 * u1, 2.0 * v0, 2.0 * v1))
    assert not fits(body.ints, reals, 0, (2.0 * u1, 3.0 * u1, v0, v1))
