"""The far side: a face whose tangent plane the opposing point is behind, and the way off it.

The printed regions end at an edge's ruled surface of normals, drawn on both sides of the face. A
point behind the body, within a face's normals drawn backwards, is in that face's region by these
tests. Lin and Canny and V-Clip leave the face there; so do these guards, unless told to keep it.
The way leads over the edge of the body that is nearest to the opposing point.
"""

from standoff.kernels.algebra.vectors import active, dot, norm, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    chart_jet,
    chart_normal,
    chart_record,
    coedge_record,
    edge_jet,
    edge_record,
    normal_of_kind,
)
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.pair.events import FOOT_POINTS, SOLVED_PARAMETERS
from standoff.kernels.pair.switching import is_smooth, onto_face
from standoff.kernels.paper.foot_points import closest_on_edge, reset_onto_edge
from standoff.kernels.tolerances import MOST_TURNED, OFF_COLLAPSED, SLOPE
from standoff.kernels.values import NO_CHART, Side


@kernel
def has_plane(ints, reals, side):
    """Does a face have a tangent plane at its point? On a collapsed side it has none."""
    c = chart_record(ints, side.chart)
    jet = chart_jet(ints, reals, side.chart, side.p, side.q)
    kind, o = ints[c + L.CHART_KIND], ints[c + L.CHART_REALS]
    normal, noise = normal_of_kind(kind, reals, o, jet)
    return active(normal) == 1.0 and noise <= MOST_TURNED


@kernel
def height_over(ints, reals, side, x):
    """Height of x over the tangent plane at a face's point (length): negative behind it."""
    jet = chart_jet(ints, reals, side.chart, side.p, side.q)
    return dot(chart_normal(ints, reals, side.chart, side.p, side.q), sub(x, jet[0]))


@kernel
def height_at_edge(ints, reals, coedge, t, x):
    """Height of x over a face's tangent plane at its edge's point (length).

    At an end where a side has collapsed there is no plane: a little along the edge there is.
    """
    face, chart, u, v = onto_face(ints, reals, coedge, t)
    if not has_plane(ints, reals, Side(face, chart, u, v)):
        edge = ints[L.N_FACES] + ints[coedge_record(ints, coedge) + L.COEDGE_EDGE]
        o = ints[edge_record(ints, edge) + L.EDGE_REALS]
        t0, t1 = reals[o + L.EDGE_T0], reals[o + L.EDGE_T1]
        t += OFF_COLLAPSED * (0.5 * (t0 + t1) - t)
        face, chart, u, v = onto_face(ints, reals, coedge, t)
    return height_over(ints, reals, Side(face, chart, u, v), x)


@kernel
def coedge_of_face(ints, edge, face):
    """The coedge of an edge that a face has; -1 where it is not the face's."""
    e = edge_record(ints, edge)
    for side in range(2):
        coedge = ints[e + L.EDGE_COEDGE_0 + side]
        if coedge >= 0:
            chart = ints[coedge_record(ints, coedge) + L.COEDGE_CHART]
            if ints[chart_record(ints, chart) + L.CHART_FACE] == face:
                return coedge
    return -1


@kernel
def nearest_edge(ints, reals, x, work):
    """(edge, t): the body's edge nearest to x, at its foot point; -1 where it has none."""
    best, least, at = -1, 1e300, 0.0
    for k in range(ints[L.N_EDGES]):
        edge = ints[L.N_FACES] + k
        work.counts[FOOT_POINTS] += 1
        t = closest_on_edge(ints, reals, edge, x)[0]
        d = norm(sub(edge_jet(ints, reals, edge, t)[0], x))
        if d < least:
            best, least, at = edge, d, t
    return best, at


@kernel
def off_far_side(ints, reals, side, x, noise, reset, work):
    """(left, slope, distance, side): off a face of the far side, on the edge nearest to x.

    An edge of the face's own is entered as any other switch enters it. Another has no parameter of
    this face's: it is entered at the foot point, which is counted as solved.
    """
    d = norm(sub(x, chart_jet(ints, reals, side.chart, side.p, side.q)[0]))
    height, least = height_over(ints, reals, side, x), -(SLOPE * d + noise)
    if height >= least and has_plane(ints, reals, side):
        return False, 0.0, d, side
    edge, t = nearest_edge(ints, reals, x, work)
    if edge < 0:
        return False, 0.0, d, side
    coedge = coedge_of_face(ints, edge, side.feature)
    if coedge >= 0:
        there = reset_onto_edge(ints, reals, coedge, side, t, reset, work)
    elif is_smooth(ints, edge):
        face, chart, u, v = onto_face(
            ints, reals, ints[edge_record(ints, edge) + L.EDGE_COEDGE_0], t
        )
        there = Side(face, chart, u, v)
    else:
        there = Side(edge, NO_CHART, t, 0.0)
    work.counts[SOLVED_PARAMETERS] += coedge < 0
    return True, height / d, d, there
