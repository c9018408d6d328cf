"""Switching as the paper prints it: Voronoi tests on the opposing witness point alone.

A face's region ends at the ruled surface of its normals along an edge, an edge's at the planes
square to it at its ends. Both are tested at the point of the edge that is closest to the opposing
point, so that the answer does not depend on this body's own parameters. A point behind the body,
within a face's normals drawn backwards, is in that face's region by these tests: they are blind to
the far side, which the certificate sees.
"""

from standoff.kernels import layout as L
from standoff.kernels.compiling import kernel
from standoff.kernels.events import log_event
from standoff.kernels.features import (
    chart_record,
    coedge_conormal,
    coedge_record,
    dimension,
    edge_jet,
    edge_record,
    vertex_point,
    vertex_record,
)
from standoff.kernels.switching import across, end_direction, is_smooth, onto_face, steepest_release
from standoff.kernels.tolerances import CLOSEST_SAMPLES, CLOSEST_STEPS, EPS, SLOPE, SLOPE_NOISE
from standoff.kernels.vectors import dot, norm, scale, sub, unit

SAME = -1  # the feature is kept


@kernel
def closest_on_edge(ints, reals, edge, x):
    """(t, at_end): the edge's closest parameter to x, sought from samples by bounded Newton.

    at_end is 0 or 1 where it is an end of the edge, else -1.
    """
    e = edge_record(ints, edge)
    o = ints[e + L.EDGE_REALS]
    t0, t1 = reals[o + L.EDGE_T0], reals[o + L.EDGE_T1]
    closed = ints[e + L.EDGE_FLAGS] & L.CLOSED != 0
    width = (t1 - t0) / CLOSEST_SAMPLES
    t, best = t0, 1e300
    for k in range(CLOSEST_SAMPLES + 1):
        s = t0 + k * width
        d = norm(sub(edge_jet(ints, reals, edge, s)[0], x))
        if d < best:
            t, best = s, d
    low, high = t - width, t + width
    if not closed:
        low, high = max(low, t0), min(high, t1)
    for _ in range(CLOSEST_STEPS):
        c, ct, ctt = edge_jet(ints, reals, edge, t)
        away = sub(c, x)
        slope = dot(away, ct)
        if slope > 0.0:
            high = t
        else:
            low = t
        curvature = dot(ct, ct) + dot(away, ctt)
        step = -slope / curvature if curvature > 0.0 else 0.0
        if curvature <= 0.0 or not low <= t + step <= high:
            step = 0.5 * (low + high) - t
        t += step
        if abs(step) <= 4.0 * EPS * (abs(t) + t1 - t0):
            break
    if not closed and (t <= t0 or t >= t1):
        return (t0, 0) if t <= t0 else (t1, 1)
    return t, -1


@kernel
def in_vertex_region(ints, reals, vertex, x, noise):
    """Does x lie in a vertex's region: does no direction off the vertex lead nearer to it?"""
    away = sub(x, vertex_point(ints, reals, vertex))
    d = norm(away)
    if d <= noise:
        return True
    return steepest_release(ints, reals, vertex, 0.0, scale(1.0 / d, away))[0] >= -(
        SLOPE + noise / d
    )


@kernel
def face_of(ints, coedge):
    """A coedge's face; -1 where there is none."""
    if coedge < 0:
        return -1
    return ints[
        chart_record(ints, ints[coedge_record(ints, coedge) + L.COEDGE_CHART]) + L.CHART_FACE
    ]


@kernel
def beyond_corner(ints, reals, face, vertex, x, noise):
    """Does x lie beyond a face's corner: does none of its edges there lead nearer to x?

    vertex counts from the body's first. Faces on the corner's other sides do not matter.
    """
    away = sub(x, vertex_point(ints, reals, ints[L.N_FACES] + ints[L.N_EDGES] + vertex))
    for k in range(ints[L.N_EDGES]):
        edge = ints[L.N_FACES] + k
        e = edge_record(ints, edge)
        if (
            face_of(ints, ints[e + L.EDGE_COEDGE_0]) != face
            and face_of(ints, ints[e + L.EDGE_COEDGE_1]) != face
        ):
            continue
        for end in range(2):
            if ints[e + L.EDGE_FIRST + end] != vertex:
                continue
            if dot(away, end_direction(ints, reals, edge, end)) > noise + SLOPE * norm(away):
                return False
    return True


@kernel
def off_face(ints, reals, face, x, noise):
    """(slope, gap, feature, chart, p, q): where x has left a face's region, steepest first.

    gap is the distance from x to the point where the slope was taken.
    """
    best, gap, to, chart, a, b = 0.0, 0.0, SAME, -1, 0.0, 0.0
    for k in range(ints[L.N_EDGES]):
        edge = ints[L.N_FACES] + k
        e = edge_record(ints, edge)
        for side in range(2):
            coedge = ints[e + L.EDGE_COEDGE_0 + side]
            if face_of(ints, coedge) != face:
                continue
            t, end = closest_on_edge(ints, reals, edge, x)
            corner = ints[e + L.EDGE_FIRST + end] if end >= 0 else -1
            if end >= 0 and not beyond_corner(ints, reals, face, corner, x, noise):
                continue
            c, ct, _ = edge_jet(ints, reals, edge, t)
            away = sub(x, c)
            d = norm(away)
            if d <= noise:
                continue
            conormal = coedge_conormal(ints, reals, coedge, unit(ct), t)[0]
            slope = dot(away, conormal) / d
            if slope < min(best, -(SLOPE + noise / d)):
                best, gap, to, chart, a, b = slope, d, edge, -1, t, 0.0
                if is_smooth(ints, edge):
                    to, chart, a, b = across(ints, reals, edge, coedge, t)
    if to != SAME:
        return best, gap, to, chart, a, b
    return 0.0, 0.0, collapsed_side(ints, reals, face, x, noise), -1, 0.0, 0.0


@kernel
def collapsed_side(ints, reals, face, x, noise):
    """The vertex of one of the face's collapsed sides whose region holds x, else SAME."""
    for k in range(ints[L.N_VERTICES]):
        vertex = ints[L.N_FACES] + ints[L.N_EDGES] + k
        r = vertex_record(ints, vertex)
        for j in range(ints[r + L.VERTEX_N_SECTORS]):
            sector = ints[r + L.VERTEX_SECTORS] + 2 * j
            if (
                reals[ints[sector + 1]] == L.SECTOR_APEX
                and ints[chart_record(ints, ints[sector]) + L.CHART_FACE] == face
                and in_vertex_region(ints, reals, vertex, x, noise)
            ):
                return vertex
    return SAME


@kernel
def off_edge(ints, reals, edge, p, x, noise):
    """(slope, gap, feature, chart, p, q): where x has left an edge's region.

    An end that x lies beyond is entered at its vertex; a face at the edge's own point.
    """
    t, end = closest_on_edge(ints, reals, edge, x)
    e = edge_record(ints, edge)
    c, ct, _ = edge_jet(ints, reals, edge, t)
    away = sub(x, c)
    d = norm(away)
    if d <= noise:
        return 0.0, d, SAME, -1, 0.0, 0.0
    tangent = unit(ct)
    if end >= 0:
        beyond = dot(away, tangent) / d
        slope = -beyond if end == 1 else beyond
        if slope < -(SLOPE + noise / d):
            vertex = ints[L.N_FACES] + ints[L.N_EDGES] + ints[e + L.EDGE_FIRST + end]
            return slope, d, vertex, -1, 0.0, 0.0
    best, to, chart, a, b = 0.0, SAME, -1, 0.0, 0.0
    for side in range(2):
        coedge = ints[e + L.EDGE_COEDGE_0 + side]
        if coedge >= 0:
            slope = -dot(away, coedge_conormal(ints, reals, coedge, tangent, t)[0]) / d
            if slope < min(best, -(SLOPE + noise / d)):
                best = slope
                to, chart, a, b = onto_face(ints, reals, coedge, p)
    return best, d, to, chart, a, b


@kernel
def off_vertex(ints, reals, vertex, x, noise):
    """(slope, gap, feature, chart, p, q): the steepest way off a vertex whose region x has left."""
    away = sub(x, vertex_point(ints, reals, vertex))
    d = norm(away)
    if d <= noise:
        return 0.0, d, SAME, -1, 0.0, 0.0
    slope, to, chart, a, b = steepest_release(ints, reals, vertex, 0.0, scale(1.0 / d, away))
    if slope >= -(SLOPE + noise / d):
        return 0.0, d, SAME, -1, 0.0, 0.0
    return slope, d, to, chart, a, b


@kernel
def voronoi_switch(ints, reals, body, x, span, mode, q, counts, events):
    """Test one body's feature against the opposing point x, in this body's frame. Any switch?"""
    noise = SLOPE_NOISE * EPS * span
    feature = mode[2 * body]
    dim = dimension(ints, feature)
    if dim == 2:
        slope, gap, to, chart, a, b = off_face(ints, reals, feature, x, noise)
    elif dim == 1:
        slope, gap, to, chart, a, b = off_edge(ints, reals, feature, q[2 * body], x, noise)
    else:
        slope, gap, to, chart, a, b = off_vertex(ints, reals, feature, x, noise)
    if to == SAME:
        return False
    log_event(events, counts, body, feature, to, slope * gap, slope)
    mode[2 * body], mode[2 * body + 1] = to, chart
    q[2 * body], q[2 * body + 1] = a, b
    return True
