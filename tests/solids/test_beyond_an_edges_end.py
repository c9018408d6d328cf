"""Points on the line that an edge is part of, beyond its end: on the face or off it as others are.

Curves of files do not meet at their ends to the last digit, so the same is asked where each curve
is a little short at some of its ends.
"""

from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from families.solid_shapes import prism
from shares import share
from standoff.bodies.face_leaves import face_charts
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import on_face

NOTCHED = [(0, 0), (3, 0), (3, 1), (2, 1), (2, 2), (3, 2), (3, 3), (0, 3)]
STAR = [(0, 0), (2, 1), (4, 0), (3, 2), (4, 4), (2, 3), (0, 4), (1, 2)]
SKEW = [(0, 0), (1, 0.2), (2.1, 0), (1.6, 1.1), (2.3, 2.1), (1, 1.3), (-0.4, 2.2), (0.3, 1)]


@cache
def solid_of(outline):
    return prism(list(outline), 1.0)


def winding(outline: np.ndarray, point: np.ndarray) -> float:
    """How often an outline runs round a point."""
    x, y = (outline - point).T
    angles = np.arctan2(y, x)
    turns = np.diff(np.append(angles, angles[0]))
    return float(np.abs(((turns + np.pi) % (2 * np.pi) - np.pi).sum()) / (2 * np.pi))


def from_outline(outline: np.ndarray, point: np.ndarray) -> float:
    a, b = outline, np.roll(outline, -1, axis=0)
    t = np.clip(((point - a) * (b - a)).sum(1) / ((b - a) ** 2).sum(1), 0, 1)
    return float(np.linalg.norm(a + t[:, None] * (b - a) - point, axis=1).min())


def cut_short(boundary, gap: float, which: int) -> np.ndarray:
    """Its reals with trimming curves shorter by a gap at the ends that a number's bits name."""
    reals = boundary.reals.copy()
    coedges = boundary.ints[boundary.ints[L.COEDGES] :]
    charts = boundary.ints[boundary.ints[L.CHARTS] :][: L.CHART_STRIDE * boundary.ints[L.N_CHARTS]]
    count = charts.reshape(-1, L.CHART_STRIDE)[:, L.CHART_N_COEDGES].sum()
    for k, row in enumerate(coedges[: L.COEDGE_STRIDE * count].reshape(-1, L.COEDGE_STRIDE)):
        o = row[L.COEDGE_REALS]
        reals[o + L.PCURVE_FIRST] += gap * (which >> 2 * k & 1)
        reals[o + L.PCURVE_LAST] -= gap * (which >> 2 * k + 1 & 1)
    return reals


@pytest.mark.parametrize(
    ("outline", "first", "gap"), share(3, [NOTCHED, STAR, SKEW], range(8), [0.0, 1e-10])
)
@given(st.floats(-2.0, 3.0), st.integers(-2, 2), st.integers(0, 2**64 - 1))
def test_beyond_its_end_an_edge_tells_nothing(outline, first, gap, t, roundings, which):
    # the first edge is the first that is looked at
    turned = outline[first:] + outline[:first]
    corners = np.array(turned, dtype=float)
    point = corners[0] + t * (corners[1] - corners[0])
    point = point + roundings * np.spacing(point)
    if from_outline(corners, point) < 1e-9:
        return
    inside = winding(corners, point) > 0.5
    boundary = solid_of(tuple(turned)).boundary
    reals = cut_short(boundary, gap, which)
    seen = 0
    for chart in face_charts(boundary):
        x, xu, xv, *_ = chart.surface.jet(0.0, 0.0)
        if abs(xu[2]) + abs(xv[2]) > 0.0:
            continue  # a wall
        u, v = np.linalg.solve(np.stack([xu[:2], xv[:2]], axis=1), point - x[:2])
        assert bool(on_face(boundary.ints, reals, chart.number, u, v)) == inside
        seen += 1
    assert seen == 2
