"""Walks on faces: no step leaves a face, however it grazes the boundary it starts on."""

import numpy as np
import pytest
from numba import njit

import standoff as so
from standoff.kernels.body import layout as L
from standoff.kernels.body import trimming
from standoff.kernels.body.trimming import HIT_COEDGE
from standoff.kernels.compiler.decorators import pointer
from standoff.kernels.entries.queries import on_face

NEAR = 3e-14
"""How far outside (parameter units) a walk may end: the noise of its start."""


@njit
def walk_face(ints, reals, chart, u, v, du, dv):
    # kernels are compiled for pointers
    return trimming.walk_face(pointer(ints, 0), pointer(reals, 0), chart, u, v, du, dv)


def wedge() -> so.Body:
    """A box's top cut slantwise: five edges that are parallel to no axis of (u, v)."""
    return so.shapes.polytope(
        [[0, 0, 0], [2, 0.3, 0], [2.4, 1.1, 0], [1.1, 1.7, 0], [-0.2, 1.2, 0], [1.1, 0.8, 1]]
    )


BODIES = {
    "polygon": wedge(),
    "disc": so.shapes.cap(1.0, 0.5),
    "sphere": so.shapes.cap(1.0, 0.6),
    "cylinder": so.shapes.cylinder(0.7, 1.3),
}


def single_charts(body):
    """(chart, coedges) of the charts that stand alone."""
    rows = body.ints[body.ints[L.CHARTS] :][: L.CHART_STRIDE * body.ints[L.N_CHARTS]]
    for k, row in enumerate(rows.reshape(-1, L.CHART_STRIDE)):
        if body.reals[row[L.CHART_REALS] + L.LIMIT] == np.inf and row[L.CHART_N_COEDGES]:
            first = row[L.CHART_COEDGE]
            yield k, range(first, first + row[L.CHART_N_COEDGES])


def boundary_point(body, coedge, rng):
    """A point of a coedge with its unit tangent and the side of the face."""
    row = body.ints[body.ints[L.COEDGES] + L.COEDGE_STRIDE * coedge :][: L.COEDGE_STRIDE]
    o = row[L.COEDGE_REALS]
    t = rng.uniform(body.reals[o], body.reals[o + 1])
    matrix = body.reals[o + 2 : o + 11].reshape(3, 3)
    conic = row[L.COEDGE_KIND] == L.CONIC
    h = matrix @ ([np.cos(t), np.sin(t), 1] if conic else [t, 0, 1])
    ht = matrix @ ([-np.sin(t), np.cos(t), 0] if conic else [1, 0, 0])
    p = h[:2] / h[2]
    tangent = (ht[:2] - p * ht[2]) / h[2]
    return p, tangent / np.linalg.norm(tangent), row[L.COEDGE_SIDE]


@pytest.mark.parametrize("name", BODIES)
def test_no_grazing_step_leaves_the_face(name, rng):
    body = BODIES[name]
    stopped = 0
    for _ in range(4000):
        charts = list(single_charts(body))
        chart, coedges = charts[rng.integers(len(charts))]
        p, tangent, side = boundary_point(body, rng.choice(list(coedges)), rng)
        inward = side * np.array([-tangent[1], tangent[0]])
        p = p + rng.integers(-2, 3) * np.spacing(p)
        angle = rng.choice([-1, 1]) * 10.0 ** rng.uniform(-18, -3)
        length = 10.0 ** rng.uniform(-6, 0)
        step = length * (rng.choice([-1, 1]) * tangent + angle * inward)
        s, hit, _, _ = walk_face(body.ints, body.reals, chart, *p, *step)
        end = p + s * step
        stopped += hit == HIT_COEDGE
        inside = end + NEAR * inward
        assert on_face(body.ints, body.reals, chart, *end) or on_face(
            body.ints, body.reals, chart, *inside
        ), (chart, p, step, s, hit)
    assert stopped > 500


def test_a_start_outside_by_more_than_roundoff_returns_to_the_boundary():
    # found by fresh seeds: a grazing step had left the face by 6.6e-9, and no later one came back
    body = so.shapes.box(2.0, 2.0, 2.0)
    chart, coedges = next(single_charts(body))
    p, tangent, side = boundary_point(body, coedges[0], np.random.default_rng(5))
    outward = -side * np.array([-tangent[1], tangent[0]])
    s, hit, index, _ = walk_face(body.ints, body.reals, chart, *(p + 6.6e-9 * outward), *outward)
    assert (s, hit, index) == (0.0, HIT_COEDGE, coedges[0])
