"""Resets and switching functions at the edge and the corners of a box, a cone's apex, a seam."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hand_made import (
    ALONG_X,
    BOX,
    CORNER,
    CORNER_AT,
    EDGE,
    EDGES,
    FACES,
    FRONT,
    TOP,
    at_vertex,
    on_edge,
    on_top,
    unit,
)

import standoff as so
from families.refined_shells import SHELLS
from standoff.geometry import Plane
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import edge_record, feature_jet, vertex_record
from standoff.kernels.body.trimming import HIT_COEDGE, HIT_END, NO_HIT, walk
from standoff.kernels.pair.switching import (
    NONE_TRIED,
    NOT_TRIED,
    across,
    coedge_face,
    is_smooth,
    onto_boundary,
    steepest_in_sector,
    steepest_release,
    steepest_untried,
)

INTS, REALS = BOX.ints, BOX.reals


def walked(side, dp, dq=0.0):
    return walk(INTS, REALS, side.feature, side.chart, side.p, side.q, dp, dq)


def point(side):
    return feature_jet(INTS, REALS, side.feature, side.chart, side.p, side.q)[0]


def test_a_step_that_fits_meets_nothing():
    hit = walked(on_top(0.2, 0.1), -0.5, 0.3)
    assert (hit.kind, hit.s) == (NO_HIT, 1.0)


@pytest.mark.parametrize("y", [-0.7, 0.0, 0.4])
def test_a_step_over_the_rim_is_reset_to_the_edge(y):
    """From (0, y) three to the right: a third of it fits, and the edge's parameter is the same."""
    hit = walked(on_top(0.0, y), 0.0, 3.0)
    assert hit.kind == HIT_COEDGE
    assert hit.s == pytest.approx(1.0 / 3.0, abs=1e-15)
    side = onto_boundary(INTS, REALS, on_top(0.0, y), hit)
    assert side.feature == EDGE
    assert side.p == pytest.approx(0.5 * (1.0 - y), abs=1e-15)
    assert point(side) == pytest.approx((1.0, y, 1.0), abs=1e-15)


def test_a_step_past_an_edge_s_end_is_reset_to_its_vertex():
    for step, corner in ((-1.0, (1.0, 1.0, 1.0)), (1.0, (1.0, -1.0, 1.0))):
        hit = walked(on_edge(0.5), step)
        assert hit.kind == HIT_END
        assert hit.s == pytest.approx(0.5, abs=1e-15)
        side = onto_boundary(INTS, REALS, on_edge(0.5), hit)
        assert side.feature >= FACES + EDGES
        assert point(side) == corner


@pytest.mark.parametrize("lean", [0.1, 0.7, 1.5])
def test_an_edge_releases_the_face_over_which_the_other_body_stands(lean):
    """The slope along a face's inward conormal is minus the sine of the lean."""
    s, c = math.sin(lean), math.cos(lean)
    slope, to, _, u, v = steepest_release(INTS, REALS, EDGE, 0.25, (-s, 0.0, c))
    assert to == TOP
    assert slope == pytest.approx(-s, abs=1e-15)
    assert (u, v) == pytest.approx((-0.5, 1.0), abs=1e-15)  # at y = 0.5
    slope, to, *_ = steepest_release(INTS, REALS, EDGE, 0.25, (c, 0.0, -s))
    assert to == FRONT
    assert slope == pytest.approx(-s, abs=1e-15)


def test_within_the_normal_cone_nothing_is_released():
    for n in (unit(1, 0, 1), unit(0.01, 0, 1), (0.0, 0.0, 1.0)):
        assert steepest_release(INTS, REALS, EDGE, 0.25, n)[:2] == (0.0, -1)
    assert steepest_release(INTS, REALS, CORNER, 0.0, unit(1, 2, 3))[:2] == (0.0, -1)
    assert steepest_release(INTS, REALS, TOP, 0.0, unit(1, 2, 3))[:2] == (0.0, -1)


def test_a_corner_releases_its_steepest_edge_and_then_the_next():
    n = unit(-0.3, -0.2, 1.0)
    length = math.hypot(0.3, 0.2, 1.0)
    slope, to, _, t, _ = steepest_release(INTS, REALS, CORNER, 0.0, n)
    assert (to, t) == (ALONG_X, float(BOX.edge_parts[ALONG_X - FACES].last == CORNER_AT))
    assert slope == pytest.approx(-0.3 / length, abs=1e-15)
    slope, to, *_ = steepest_untried(
        INTS, REALS, CORNER, 0.0, n, (np.int64(ALONG_X), *NONE_TRIED[1:])
    )
    assert to == EDGE
    assert slope == pytest.approx(-0.2 / length, abs=1e-15)
    tried = (np.int64(ALONG_X), np.int64(EDGE), NOT_TRIED)
    assert steepest_untried(INTS, REALS, CORNER, 0.0, n, tried)[:2] == (0.0, -1)


def test_an_apex_releases_the_side_along_the_steepest_generator():
    """Of directions (cos, sin, -1)/sqrt 2 the one below n is the steepest."""
    cone = so.shapes.cone(1.0, 1.0)
    apex = cone.n_faces + cone.n_edges
    turn, lean = 0.8, 1.2
    n = (math.sin(lean) * math.cos(turn), math.sin(lean) * math.sin(turn), math.cos(lean))
    slope, to, chart, u, v = steepest_release(cone.ints, cone.reals, apex, 0.0, n)
    assert slope == pytest.approx((math.cos(lean) - math.sin(lean)) / math.sqrt(2.0), abs=1e-14)
    _, xu, xv, *_ = feature_jet(cone.ints, cone.reals, to, chart, u, v)
    along = max((xu, xv), key=np.linalg.norm)
    assert abs(np.cross(unit(*along), [math.cos(turn), math.sin(turn), -1.0])).max() < 1e-6
    upright = (0.0, 0.0, 1.0)
    assert steepest_release(cone.ints, cone.reals, apex, 0.0, upright)[:2] == (0.0, -1)


def rectangle(corner, along_u, along_v, parts=1):
    plane = Plane.through(np.array(corner, float), np.array(along_u), np.array(along_v))
    cuts = np.linspace(0.0, 1.0, parts + 1)
    return [plane.restricted(0.0, 1.0, a, b) for a, b in pairwise(cuts)]


@pytest.fixture(scope="module")
def seamed():
    """A box 2 x 3 x 1 whose top is cut across: a vertex amid the edge at x = 2, z = 1."""
    x, y, z = np.diag([2.0, 3.0, 1.0])
    return so.Body.from_patches(
        [
            *rectangle([0, 0, 1], x, y, parts=2),
            *rectangle([0, 0, 0], y, x),
            *rectangle([0, 0, 0], x, z),
            *rectangle([0, 3, 0], z, x),
            *rectangle([0, 0, 0], z, y),
            *rectangle([2, 0, 0], y, z),
        ]
    )


def test_a_wide_sector_is_released_along_the_projection_of_n(seamed):
    """The front has an angle of 180 degrees at the vertex: n's part in the front is the slope."""
    at = next(k for k, x in enumerate(seamed.vertex_points) if np.allclose(x, [2.0, 1.5, 1.0]))
    vertex = seamed.n_faces + seamed.n_edges + at
    ints, reals = seamed.ints, seamed.reals
    record = vertex_record(ints, vertex)
    assert ints[record + L.VERTEX_N_SECTORS] >= 1
    sector = ints[record + L.VERTEX_SECTORS]
    assert reals[ints[sector + 1]] == L.SECTOR_WIDE
    n = (0.8, 0.36, -0.48)
    slope, _ = steepest_in_sector(ints, reals, sector, n)
    assert slope == pytest.approx(-0.6, abs=1e-12)
    slope, to, chart, u, v = steepest_release(ints, reals, vertex, 0.0, n)
    assert slope == pytest.approx(-0.6, abs=1e-12)
    assert to == next(
        k
        for k, face in enumerate(seamed.face_parts)
        if abs(np.cross(*face.charts[0].jet(0.0, 0.0)[1:3])[0]) > 0.9
        and face.charts[0].jet(0.0, 0.0)[0][0] == 2.0
    )
    assert feature_jet(ints, reals, to, chart, u, v)[0] == pytest.approx((2.0, 1.5, 1.0), abs=1e-12)
    # along the edge alone the edge is released: the sector's bound is no steeper
    _, to, *_ = steepest_release(ints, reals, vertex, 0.0, (0.6, 0.8, 0.0))
    assert seamed.n_faces <= to < vertex - at


def test_across_a_smooth_edge_the_point_stays():
    """Seams of an ellipsoid of patches: the other face's parameters of the same point."""
    body = so.Body.from_patches(SHELLS["ellipsoid"]())
    ints, reals = body.ints, body.reals
    smooth = [body.n_faces + k for k in range(body.n_edges) if is_smooth(ints, body.n_faces + k)]
    assert smooth
    for feature in smooth[:4]:
        record = edge_record(ints, feature)
        o = ints[record + L.EDGE_REALS]
        t = 0.7 * reals[o + L.EDGE_T0] + 0.3 * reals[o + L.EDGE_T0 + 1]
        x = feature_jet(ints, reals, feature, -1, t, 0.0)[0]
        sides = [ints[record + k] for k in (L.EDGE_COEDGE_0, L.EDGE_COEDGE_1)]
        for one, other in (sides, sides[::-1]):
            face, chart, u, v = across(ints, reals, feature, one, t)
            assert face == coedge_face(ints, other) != coedge_face(ints, one)
            assert feature_jet(ints, reals, face, chart, u, v)[0] == pytest.approx(x, abs=1e-12)


def test_a_sharp_edge_is_not_smooth():
    assert not is_smooth(INTS, EDGE)
    assert not is_smooth(INTS, TOP)
    assert not is_smooth(INTS, at_vertex(0).feature)
