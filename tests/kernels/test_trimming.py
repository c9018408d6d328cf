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


@njit
def walk(ints, reals, feature, chart, u, v, du, dv):
    return trimming.walk(pointer(ints, 0), pointer(reals, 0), feature, chart, u, v, du, dv)


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


def test_a_face_without_width_ends_where_its_line_does():
    """The rim of a flat polygon: its border is one line twice, which no ray along it crosses."""
    body = so.shapes.polygon([[-1.25, 0.75, 0], [-0.75, 0, 0], [-0.75, 0.5, 0]])
    ints, reals = body.ints, body.reals
    lengths = [0.5, np.hypot(0.5, 0.25), np.hypot(0.5, 0.75)]
    ends = []
    for face in (2, 3, 4):
        chart = int(ints[ints[L.FACES] + L.FACE_STRIDE * face])
        inside = [u for u in np.linspace(-2.0, 2.0, 4001) if on_face(ints, reals, chart, u, 0.0)]
        ends.append(inside[-1] - inside[0])
        middle = 0.5 * (inside[0] + inside[-1])
        assert not on_face(ints, reals, chart, middle, 1e-6)
        short = walk(ints, reals, face, chart, middle, 0.0, 0.1, 0.0)
        assert (short.s, short.kind) == (1.0, trimming.NO_HIT)
        for way in (-5.0, 5.0):  # held at its edge, not carried on along the line
            hit = walk(ints, reals, face, chart, middle, 0.0, way, 0.0)
            assert (hit.s, hit.kind) == (0.0, HIT_COEDGE)
            assert hit.t == pytest.approx(0.5, abs=1e-3)
    assert sorted(ends) == pytest.approx(sorted(lengths), abs=2e-3)


@pytest.mark.parametrize("far", [1e8, 1e24, 1e200])
def test_parameters_far_out_are_on_no_face(far):
    """Their roundoff is wider than the face, and everything would be near its boundary."""
    for body in (so.shapes.cylinder(0.7, 1.3), so.shapes.cone(1.0, 2.0), so.shapes.egg(1.0, 1.5)):
        ints, reals = body.ints, body.reals
        for chart in range(ints[L.N_CHARTS]):
            for u, v in ((0.1, -far), (far, 0.2), (-far, -21.0)):
                assert not on_face(ints, reals, chart, u, v)
