"""Switching as the paper prints it: Voronoi tests on the opposing witness point alone.

A face's region ends at the ruled surface of its normals along an edge, an edge's at the planes
square to it at its ends. Both are tested at the point of the edge that is closest to the opposing
point, so that the answer does not depend on this body's own parameters. Points behind a
face, within its normals drawn backwards, are the matter of `far_side`.
"""

from standoff.kernels.algebra.vectors import dot, norm, scale, sub, unit
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    chart_record,
    coedge_conormal,
    coedge_record,
    dimension,
    edge_jet,
    edge_record,
    vertex_point,
    vertex_record,
)
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.pair.events import FOOT_POINTS, SOLVED_PARAMETERS, log_event
from standoff.kernels.pair.switching import (
    end_direction,
    onto_face,
    steepest_release,
)
from standoff.kernels.paper.far_side import height_at_edge, off_far_side
from standoff.kernels.paper.foot_points import closest_on_edge, reset_onto_edge
from standoff.kernels.state.arrays import FAR_SIDE_KEPT, FAR_SIDE_LEFT, RESET_NEAREST
from standoff.kernels.tolerances import (
    EPS,
    SLOPE,
    SLOPE_NOISE,
)
from standoff.kernels.values import NO_CHART, Side, body_of, side_of, with_side

SAME = -1  # the feature is kept


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
def off_edge(ints, reals, side, x, noise, far_side, work):
    """(slope, gap, feature, chart, p, q): where x has left an edge's region.

    An end that x lies beyond is entered at its vertex; a face at the edge's own point.
    """
    edge, p = side.feature, side.p
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
    in_front = False
    for k in range(2):
        coedge = ints[e + L.EDGE_COEDGE_0 + k]
        if coedge >= 0:
            slope = -dot(away, coedge_conormal(ints, reals, coedge, tangent, t)[0]) / d
            if slope >= -(SLOPE + noise / d):
                continue
            # of two faces that x has come over, one that it is behind would be left at once
            front = far_side == FAR_SIDE_KEPT or height_at_edge(ints, reals, coedge, t, x) > -noise
            if (front and not in_front) or (front == in_front and slope < best):
                best, in_front = slope, front
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
def gives_to(ints, reals, side, face, x, noise, work):
    """Would an edge pass x on to this face?"""
    if dimension(ints, side.feature) != 1:
        return False
    return off_edge(ints, reals, side, x, noise, FAR_SIDE_LEFT, work)[2] == face


@kernel
def switch_off_face(pair, body, x, noise, place, options, work):
    """`voronoi_switch` of a face."""
    ints, reals = body_of(pair, body)
    side = side_of(place, body)
    if options.far_side == FAR_SIDE_LEFT:
        left, slope, gap, there = off_far_side(ints, reals, side, x, noise, options.reset, work)
        # A face that turns far may have x behind some of its planes and over its middle: an edge
        # that would give x back is not entered.
        if left and not gives_to(ints, reals, there, side.feature, x, noise, work):
            log_left(work, body, side.feature, there.feature, slope, gap)
            return True, with_side(place, body, there)
    slope, gap, coedge, t = off_face(ints, reals, side.feature, x, noise, work)
    if coedge >= 0:
        there = reset_onto_edge(ints, reals, coedge, side, t, options.reset, work)
        log_left(work, body, side.feature, there.feature, slope, gap)
        return True, with_side(place, body, there)
    vertex = collapsed_side(ints, reals, side.feature, x, noise, work)
    if vertex == SAME:
        return False, place
    log_left(work, body, side.feature, vertex, 0.0, 0.0)
    return True, with_side(place, body, Side(vertex, NO_CHART, 0.0, 0.0))


@kernel
def voronoi_switch(pair, body, x, span, place, options, work):
    """(switched, place): test one body's feature against the opposing point x, in this body's
    frame."""
    ints, reals = body_of(pair, body)
    noise = SLOPE_NOISE * EPS * span
    side = side_of(place, body)
    dim, reset, far_side = dimension(ints, side.feature), options.reset, options.far_side
    if dim == 2:
        return switch_off_face(pair, body, x, noise, place, options, work)
    if dim == 1:
        slope, gap, to, chart, a, b = off_edge(ints, reals, side, x, noise, far_side, work)
    else:
        slope, gap, to, chart, a, b = off_vertex(ints, reals, side.feature, x, noise, reset, work)
    if to == SAME:
        return False, place
    log_left(work, body, side.feature, to, slope, gap)
    return True, with_side(place, body, Side(to, chart, a, b))
