"""The hybrid automaton of Eqs. (15)-(17): resets across boundaries, and the switching functions.

The switching functions are Kuhn-Tucker multipliers: slopes of the distance along the unit
directions that lead off a feature. They are the Voronoi tests of Lin and Canny: the sign of the
slope along an edge at its end is the vertex-edge Voronoi plane, the sign along a face's inward
conormal the edge-face Voronoi surface. No Voronoi boundary is ever built.
"""

from math import cos, exp, log, sin

import numpy as np

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import add, axpy, cross, dot, scale, sub, unit
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    best_chart,
    best_coedge,
    chart_jet,
    chart_record,
    coedge_conormal,
    coedge_parameters,
    coedge_record,
    dimension,
    edge_jet,
    edge_record,
    feature_jet,
    is_creased,
    vertex_record,
)
from standoff.kernels.body.trimming import HIT_COEDGE, HIT_END, TURN, wrapped
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.tolerances import (
    CREASE_FIRST,
    CREASE_LAST,
    CREASE_STEPS,
    FAN_REFINE,
    FAN_SCAN,
    SLOPE,
)
from standoff.kernels.values import NO_CHART, Side

NOT_TRIED = np.int64(-1)  # of the type of a feature's number: a literal would compile twice
NONE_TRIED = (NOT_TRIED, NOT_TRIED, NOT_TRIED)


@kernel
def is_smooth(ints, feature):
    return (
        dimension(ints, feature) == 1
        and ints[edge_record(ints, feature) + L.EDGE_FLAGS] & L.SMOOTH != 0
    )


@kernel
def coedge_face(ints, coedge):
    return ints[
        chart_record(ints, ints[coedge_record(ints, coedge) + L.COEDGE_CHART]) + L.CHART_FACE
    ]


@kernel
def onto_face(ints, reals, coedge, t):
    """Reset edge -> face: (feature, chart, u, v) of the edge's point at t on the coedge's face."""
    k = best_coedge(ints, reals, coedge, t)
    u, v, _, _, _ = coedge_parameters(ints, reals, k, t)
    chart = ints[coedge_record(ints, k) + L.COEDGE_CHART]
    return ints[chart_record(ints, chart) + L.CHART_FACE], chart, u, v


@kernel
def across(ints, reals, feature, coedge, t):
    """Reset face -> face over a smooth edge."""
    e = edge_record(ints, feature)
    other = ints[e + L.EDGE_COEDGE_0]
    if coedge_face(ints, other) == coedge_face(ints, coedge):
        other = ints[e + L.EDGE_COEDGE_1]
    return onto_face(ints, reals, other, t)


@kernel
def onto_boundary(ints, reals, side, hit):
    """Reset at a hit: the side on the boundary that the step has reached."""
    if hit.kind == HIT_COEDGE:
        edge = ints[coedge_record(ints, hit.index) + L.COEDGE_EDGE]
        if edge < 0:
            return Side(ints[L.N_FACES] + ints[L.N_EDGES] - 1 - edge, NO_CHART, 0.0, 0.0)
        return Side(ints[L.N_FACES] + edge, NO_CHART, hit.t, 0.0)
    if hit.kind == HIT_END:
        vertex = ints[edge_record(ints, side.feature) + L.EDGE_FIRST + hit.index]
        return Side(ints[L.N_FACES] + ints[L.N_EDGES] + vertex, NO_CHART, 0.0, 0.0)
    return in_best_chart(ints, reals, side)


@kernel
def in_best_chart(ints, reals, side):
    """The same point of a face in the chart that sees it most centrally."""
    x = chart_jet(ints, reals, side.chart, side.p, side.q)[0]
    chart, p, q = best_chart(ints, reals, side.chart, x)
    return Side(side.feature, chart, p, q)


@kernel
def normalised_parameter(ints, reals, feature, p):
    """A closed edge's parameter in its first period; a cylinder's angle needs no seam."""
    if dimension(ints, feature) == 1:
        e = edge_record(ints, feature)
        if ints[e + L.EDGE_FLAGS] & L.CLOSED:
            return wrapped(p, reals[ints[e + L.EDGE_REALS] + L.EDGE_T0])
    return p


@kernel
def sector_parameters(reals, o, angle):
    """(u, v) where a sector whose reals begin at o starts, at the sector's angle."""
    if reals[o] != L.SECTOR_APEX:
        return reals[o + 1], reals[o + 2]
    if reals[o + 1] < L.SIDE_U0:
        return angle, reals[o + 2]
    return reals[o + 2], angle


@kernel
def sector_direction(ints, reals, sector, angle):
    """Unit direction that leaves a vertex into a face's sector, at the sector's angle."""
    chart, o = ints[sector], ints[sector + 1]
    u, v = sector_parameters(reals, o, angle)
    jet = chart_jet(ints, reals, chart, u, v)
    if reals[o] == L.SECTOR_APEX:
        side = int(reals[o + 1])
        out = unit(jet[2] if side < L.SIDE_U0 else jet[1])
        return scale(-1.0, out) if side == L.SIDE_V1 or side == L.SIDE_U1 else out
    return unit(axpy(cos(angle), jet[1], scale(sin(angle), jet[2])))


@kernel
def apex_normal(ints, reals, sector, angle):
    """Outward unit normal of a face at its collapsed side.

    One tangent is zero there; beside it, it is the mixed derivative times the way off the side.
    """
    chart, o = ints[sector], ints[sector + 1]
    u, v = sector_parameters(reals, o, angle)
    _, xu, xv, _, xuv, _ = chart_jet(ints, reals, chart, u, v)
    side = int(reals[o + 1])
    normal = cross(xuv, xv) if side < L.SIDE_U0 else cross(xu, xuv)
    outward = reals[ints[chart_record(ints, chart) + L.CHART_REALS] + L.OUTWARD]
    sign = -outward if side == L.SIDE_V1 or side == L.SIDE_U1 else outward
    return scale(sign, unit(normal))


@kernel
def steepest_in_sector(ints, reals, sector, n):
    """(slope, angle): least slope of the distance among a sector's directions."""
    o = ints[sector + 1]
    lo, hi = reals[o + 3], reals[o + 4]
    width = (hi - lo) / FAN_SCAN
    best, at = 1e300, lo
    for k in range(FAN_SCAN + 1):
        slope = -dot(n, sector_direction(ints, reals, sector, lo + k * width))
        if slope < best:
            best, at = slope, lo + k * width
    # golden section around the best direction; the fan of a whole turn may pass lo, hi
    a, b = at - width, at + width
    if not ints[chart_record(ints, ints[sector]) + L.CHART_PERIODIC] or hi - lo < TURN:
        a, b = max(a, lo), min(b, hi)
    ratio = 0.5 * (sqrt(5.0) - 1.0)
    c, d = b - ratio * (b - a), a + ratio * (b - a)
    fc = -dot(n, sector_direction(ints, reals, sector, c))
    fd = -dot(n, sector_direction(ints, reals, sector, d))
    for _ in range(FAN_REFINE):
        if fc < fd:
            b, d, fd = d, c, fc
            c = b - ratio * (b - a)
            fc = -dot(n, sector_direction(ints, reals, sector, c))
        else:
            a, c, fc = c, d, fd
            d = a + ratio * (b - a)
            fd = -dot(n, sector_direction(ints, reals, sector, d))
    return (fc, c) if fc < fd else (fd, d)


@kernel
def end_direction(ints, reals, edge, end):
    """Unit tangent that leaves an edge's end into the edge."""
    o = ints[edge_record(ints, edge) + L.EDGE_REALS]
    tangent = unit(edge_jet(ints, reals, edge, reals[o + L.EDGE_T0 + end])[1])
    return tangent if end == 0 else scale(-1.0, tangent)


@kernel
def steepest_release(ints, reals, feature, p, n):
    """`steepest_untried` with nothing tried yet."""
    return steepest_untried(ints, reals, feature, p, n, NONE_TRIED)


@kernel
def steepest_untried(ints, reals, feature, p, n, tried):
    """The steepest way off an edge or vertex: (slope, feature, chart, p, q).

    n is the unit direction towards the other body, in this body's frame, so the slope of the
    distance along a unit direction c is -n.c. A face has no release: slope 0. The features in
    `tried` are left out.
    """
    best, to, chart, a, b = 0.0, -1, -1, 0.0, 0.0
    dim = dimension(ints, feature)
    if dim == 1:
        e = edge_record(ints, feature)
        tangent = unit(edge_jet(ints, reals, feature, p)[1])
        for side in range(2):
            k = ints[e + L.EDGE_COEDGE_0 + side]
            if k < 0:
                continue
            slope = -dot(n, coedge_conormal(ints, reals, k, tangent, p)[0])
            if slope < best and coedge_face(ints, k) not in tried:
                best = slope
                to, chart, a, b = onto_face(ints, reals, k, p)
    elif dim == 0:
        r = vertex_record(ints, feature)
        fan = ints[r + L.VERTEX_FAN]
        for k in range(ints[r + L.VERTEX_N_FAN]):
            edge = ints[L.N_FACES] + ints[fan + 2 * k]
            end = ints[fan + 2 * k + 1]
            slope = -dot(n, end_direction(ints, reals, edge, end))
            if slope < best and edge not in tried:
                t = reals[ints[edge_record(ints, edge) + L.EDGE_REALS] + L.EDGE_T0 + end]
                best, to, chart, a, b = slope, edge, -1, t, 0.0
        sectors = ints[r + L.VERTEX_SECTORS]
        for k in range(ints[r + L.VERTEX_N_SECTORS]):
            sector = sectors + 2 * k
            if ints[chart_record(ints, ints[sector]) + L.CHART_FACE] in tried:
                continue
            slope, angle = steepest_in_sector(ints, reals, sector, n)
            # along the sector's bound runs an edge: a face released there is left at once
            if slope < best - SLOPE:
                c = ints[sector]
                face = ints[chart_record(ints, c) + L.CHART_FACE]
                u, v = sector_parameters(reals, ints[sector + 1], angle)
                best, to, chart, a, b = slope, face, c, u, v
    return best, to, chart, a, b


@kernel
def on_crease(ints, feature):
    """Is the feature an edge with a crease, or a vertex of one?"""
    if dimension(ints, feature) > 0:
        return is_creased(ints, feature)
    fan = ints[vertex_record(ints, feature) + L.VERTEX_FAN]
    for k in range(ints[vertex_record(ints, feature) + L.VERTEX_N_FAN]):
        if is_creased(ints, ints[L.N_FACES] + ints[fan + 2 * k]):
            return True
    return False


@kernel
def off_crease(ints, reals, source, feature, chart, p, q, gap):
    """(p, q) a little inside the feature that was released, where it leaves a crease.

    Across a crease the curvature is infinite, and no Newton step leads off it. The slope of the
    distance to the other body's witness point, `gap` from here, changes its sign at a parameter of
    any order of magnitude: it is searched for on a logarithmic scale along the way inwards.
    """
    dim = dimension(ints, feature)
    if dim == 1:
        if not is_creased(ints, feature):
            return p, q
        o = ints[edge_record(ints, feature) + L.EDGE_REALS]
        dp, dq = (1.0 if p == reals[o + L.EDGE_T0] else -1.0), 0.0
    elif on_crease(ints, source):
        # seams lie on u = 0 or v = 0 of their charts, the face at greater u and v
        dp, dq = (1.0, 0.0) if abs(p) < abs(q) else (0.0, 1.0)
    else:
        return p, q
    target = add(feature_jet(ints, reals, feature, chart, p, q)[0], gap)
    low, high = log(CREASE_FIRST), log(CREASE_LAST)
    for _ in range(CREASE_STEPS):
        middle = 0.5 * (low + high)
        s = exp(middle)
        jet = feature_jet(ints, reals, feature, chart, p + s * dp, q + s * dq)
        way = sub(target, jet[0])
        if dot(way, jet[1]) * dp + dot(way, jet[2]) * dq > 0.0:
            low = middle
        else:
            high = middle
    s = exp(0.5 * (low + high))
    return p + s * dp, q + s * dq
