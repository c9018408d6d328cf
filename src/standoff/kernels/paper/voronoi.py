"""Switching as the paper prints it: Voronoi tests on the opposing witness point alone.

A face's region ends at the ruled surface of its normals along an edge, an edge's at the planes
square to it at its ends. Both are tested at the point of the edge that is closest to the opposing
point, so that the answer does not depend on this body's own parameters. A point behind the body,
within a face's normals drawn backwards, is in that face's region by these tests: they are blind to
the far side, which the certificate sees.

Such a foot point is what a guard needs. Whether a reset takes its parameter is another matter: as
printed it does not, see `reset_onto_edge`. Foot points and parameters taken from them are counted.
"""

from standoff.kernels.algebra.vectors import dot, norm, scale, sub, unit
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    best_coedge,
    chart_jet,
    chart_record,
    coedge_conormal,
    coedge_parameters,
    coedge_record,
    dimension,
    edge_jet,
    edge_record,
    vertex_point,
    vertex_record,
)
from standoff.kernels.body.jets import chart_parameters
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.pair.events import FOOT_POINTS, SOLVED_PARAMETERS, log_event
from standoff.kernels.pair.switching import (
    across,
    end_direction,
    is_smooth,
    onto_face,
    steepest_release,
)
from standoff.kernels.state.arrays import RESET_NEAREST
from standoff.kernels.tolerances import (
    BRACKET_ROUNDINGS,
    CLOSEST_SAMPLES,
    CLOSEST_STEPS,
    EPS,
    SLOPE,
    SLOPE_NOISE,
)
from standoff.kernels.values import NO_CHART, Side, body_of, side_of, with_side

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
        if abs(step) <= BRACKET_ROUNDINGS * EPS * (abs(t) + t1 - t0):
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
def off_face(ints, reals, face, x, noise, work):
    """(slope, gap, coedge, t): where x has left a face's region, steepest first; coedge -1 where it
    has not.

    gap is the distance from x to the foot point at t, where the slope was taken.
    """
    best, gap, left, at = 0.0, 0.0, -1, 0.0
    for k in range(ints[L.N_EDGES]):
        edge = ints[L.N_FACES] + k
        e = edge_record(ints, edge)
        for side in range(2):
            coedge = ints[e + L.EDGE_COEDGE_0 + side]
            if face_of(ints, coedge) != face:
                continue
            work.counts[FOOT_POINTS] += 1
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
                best, gap, left, at = slope, d, coedge, t
    return best, gap, left, at


@kernel
def seen_from(ints, reals, side, chart):
    """(seen, u, v): a face's point in another chart of it."""
    if side.chart == chart:
        return True, side.p, side.q
    x = chart_jet(ints, reals, side.chart, side.p, side.q)[0]
    u, v, depth = chart_parameters(reals, ints[chart_record(ints, chart) + L.CHART_REALS], x)
    return depth > 0.0, u, v


@kernel
def off_parameters(ints, reals, coedge, side, t):
    """(square of the distance in (u, v), its half slope, square of the pcurve's speed) between the
    pcurve at t and a face's point."""
    k = best_coedge(ints, reals, coedge, t)
    chart = ints[coedge_record(ints, k) + L.COEDGE_CHART]
    seen, u, v = seen_from(ints, reals, side, chart)
    x, y, dx, dy, depth = coedge_parameters(ints, reals, k, t)
    if not seen or depth <= 0.0:
        return 1e300, 0.0, 0.0
    a, b = x - u, y - v
    return a * a + b * b, a * dx + b * dy, dx * dx + dy * dy


@kernel
def nearest_in_parameters(ints, reals, coedge, side):
    """The edge's parameter at which its pcurve is nearest in (u, v) to a face's point.

    Sought as `closest_on_edge` does, in the plane of the parameters: the opposing point is not
    asked.
    """
    c = coedge_record(ints, coedge)
    edge = ints[L.N_FACES] + ints[c + L.COEDGE_EDGE]
    e = edge_record(ints, edge)
    o = ints[e + L.EDGE_REALS]
    t0, t1 = reals[o + L.EDGE_T0], reals[o + L.EDGE_T1]
    width = (t1 - t0) / CLOSEST_SAMPLES
    t, best = t0, 2e300
    for k in range(CLOSEST_SAMPLES + 1):
        s = t0 + k * width
        d2 = off_parameters(ints, reals, coedge, side, s)[0]
        if d2 < best:
            t, best = s, d2
    low, high = t - width, t + width
    if ints[e + L.EDGE_FLAGS] & L.CLOSED == 0:
        low, high = max(low, t0), min(high, t1)
    for _ in range(CLOSEST_STEPS):
        _, slope, speed2 = off_parameters(ints, reals, coedge, side, t)
        if slope > 0.0:
            high = t
        else:
            low = t
        step = -slope / speed2 if speed2 > 0.0 else 0.0
        step = min(max(t + step, low), high) - t
        t += step
        if abs(step) <= BRACKET_ROUNDINGS * EPS * (abs(t) + t1 - t0):
            break
    return t


@kernel
def reset_onto_edge(ints, reals, coedge, side, t, reset, work):
    """Reset face -> edge: the side on the coedge's edge, or beyond it where the edge is smooth.

    As printed (RESET_NEAREST) the parameter is that nearest in (u, v) to the face's own, so that
    an error is left for the law to drive to zero; else it is the foot point's t, which is exact
    at once.
    """
    edge = ints[L.N_FACES] + ints[coedge_record(ints, coedge) + L.COEDGE_EDGE]
    if reset == RESET_NEAREST:
        t = nearest_in_parameters(ints, reals, coedge, side)
    else:
        work.counts[SOLVED_PARAMETERS] += 1
    if is_smooth(ints, edge):
        feature, chart, p, q = across(ints, reals, edge, coedge, t)
        return Side(feature, chart, p, q)
    return Side(edge, NO_CHART, t, 0.0)


@kernel
def collapsed_side(ints, reals, face, x, noise, work):
    """The vertex of one of the face's collapsed sides whose region holds x, else SAME."""
    for k in range(ints[L.N_VERTICES]):
        vertex = ints[L.N_FACES] + ints[L.N_EDGES] + k
        r = vertex_record(ints, vertex)
        for j in range(ints[r + L.VERTEX_N_SECTORS]):
            sector = ints[r + L.VERTEX_SECTORS] + 2 * j
            if (
                reals[ints[sector + 1]] == L.SECTOR_APEX
                and ints[chart_record(ints, ints[sector]) + L.CHART_FACE] == face
            ):
                work.counts[FOOT_POINTS] += 1
                if in_vertex_region(ints, reals, vertex, x, noise):
                    return vertex
    return SAME


@kernel
def off_edge(ints, reals, edge, p, x, noise, work):
    """(slope, gap, feature, chart, p, q): where x has left an edge's region.

    An end that x lies beyond is entered at its vertex; a face at the edge's own point.
    """
    work.counts[FOOT_POINTS] += 1
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
def steepest_edge(ints, reals, vertex, n):
    """(slope, edge, t): the steepest of the edges that leave a vertex."""
    best, to, at = 0.0, SAME, 0.0
    r = vertex_record(ints, vertex)
    fan = ints[r + L.VERTEX_FAN]
    for k in range(ints[r + L.VERTEX_N_FAN]):
        edge = ints[L.N_FACES] + ints[fan + 2 * k]
        end = ints[fan + 2 * k + 1]
        slope = -dot(n, end_direction(ints, reals, edge, end))
        if slope < best:
            t = reals[ints[edge_record(ints, edge) + L.EDGE_REALS] + L.EDGE_T0 + end]
            best, to, at = slope, edge, t
    return best, to, at


@kernel
def off_vertex(ints, reals, vertex, x, noise, reset, work):
    """(slope, gap, feature, chart, p, q): the steepest way off a vertex whose region x has left.

    A face's collapsed side is left where the slope is steepest, which takes a search of its
    parameter. As printed an edge is taken instead, where one falls: its end has its parameter.
    """
    away = sub(x, vertex_point(ints, reals, vertex))
    d = norm(away)
    if d <= noise:
        return 0.0, d, SAME, -1, 0.0, 0.0
    least, n = -(SLOPE + noise / d), scale(1.0 / d, away)
    if reset == RESET_NEAREST:
        slope, to, t = steepest_edge(ints, reals, vertex, n)
        if slope < least:
            return slope, d, to, -1, t, 0.0
    slope, to, chart, a, b = steepest_release(ints, reals, vertex, 0.0, n)
    if slope >= least:
        return 0.0, d, SAME, -1, 0.0, 0.0
    work.counts[SOLVED_PARAMETERS] += dimension(ints, to) == 2
    return slope, d, to, chart, a, b


@kernel
def log_left(work, body, source, to, slope, gap):
    log_event(work, body, source, to, slope * gap, slope)


@kernel
def switch_off_face(pair, body, x, noise, place, reset, work):
    """`voronoi_switch` of a face."""
    ints, reals = body_of(pair, body)
    side = side_of(place, body)
    slope, gap, coedge, t = off_face(ints, reals, side.feature, x, noise, work)
    if coedge >= 0:
        there = reset_onto_edge(ints, reals, coedge, side, t, reset, work)
        log_left(work, body, side.feature, there.feature, slope, gap)
        return True, with_side(place, body, there)
    vertex = collapsed_side(ints, reals, side.feature, x, noise, work)
    if vertex == SAME:
        return False, place
    log_left(work, body, side.feature, vertex, 0.0, 0.0)
    return True, with_side(place, body, Side(vertex, NO_CHART, 0.0, 0.0))


@kernel
def voronoi_switch(pair, body, x, span, place, reset, work):
    """(switched, place): test one body's feature against the opposing point x, in this body's
    frame."""
    ints, reals = body_of(pair, body)
    noise = SLOPE_NOISE * EPS * span
    side = side_of(place, body)
    dim = dimension(ints, side.feature)
    if dim == 2:
        return switch_off_face(pair, body, x, noise, place, reset, work)
    if dim == 1:
        slope, gap, to, chart, a, b = off_edge(ints, reals, side.feature, side.p, x, noise, work)
    else:
        slope, gap, to, chart, a, b = off_vertex(ints, reals, side.feature, x, noise, reset, work)
    if to == SAME:
        return False, place
    log_left(work, body, side.feature, to, slope, gap)
    return True, with_side(place, body, Side(to, chart, a, b))
