"""Walking on a feature until its boundary: trimming loops, ends of edges, limits of charts."""

from math import atan2, hypot, inf, pi, sqrt

from standoff.kernels import layout as L
from standoff.kernels.compiling import kernel
from standoff.kernels.features import (
    chart_record,
    coedge_parameters,
    coedge_record,
    dimension,
    edge_record,
)
from standoff.kernels.tolerances import HIT_BEHIND, PCURVE_OVERLAP

NO_HIT = 0
HIT_COEDGE = 1  # index: the coedge; t: its parameter
HIT_END = 2  # index: 0 or 1, the end of the edge
HIT_LIMIT = 3  # the chart's limit: change charts

TURN = 2.0 * pi
# A point known no better than this (parameter units, relative) may lie outside by roundoff.
PARAMETER_NOISE = 1e-14
# Rays tried to tell inside from outside: one suffices but where it grazes a corner.
RAYS = 6


@kernel
def wrapped(t, t0):
    return t0 + (t - t0) % TURN


@kernel
def line_roots(reals, kind, o, u, v, du, dv):
    """(count, t1, t2): parameters where the pcurve meets the line through (u, v) along (du, dv)."""
    a, b = dv, -du
    c = -(a * u + b * v)
    m0 = a * reals[o] + b * reals[o + 3] + c * reals[o + 6]
    m1 = a * reals[o + 1] + b * reals[o + 4] + c * reals[o + 7]
    m2 = a * reals[o + 2] + b * reals[o + 5] + c * reals[o + 8]
    if kind == L.LINE:
        if m0 == 0.0:
            return 0, 0.0, 0.0
        return 1, -m2 / m0, 0.0
    amplitude = hypot(m0, m1)
    if abs(m2) > amplitude or amplitude == 0.0:
        return 0, 0.0, 0.0
    middle = atan2(m1, m0)
    half = atan2(sqrt((amplitude - m2) * (amplitude + m2)), -m2)
    return 2, middle + half, middle - half


@kernel
def in_range(ints, reals, coedge, t):
    """(inside, t) with t brought into the pcurve's range, periods included."""
    c = coedge_record(ints, coedge)
    o = ints[c + L.COEDGE_REALS]
    t0, t1 = reals[o + L.PCURVE_FIRST], reals[o + L.PCURVE_LAST]
    kind = ints[c + L.COEDGE_KIND]
    surface = ints[chart_record(ints, ints[c + L.COEDGE_CHART]) + L.CHART_KIND]
    around = (surface == L.CYLINDER or surface == L.CONE) and reals[o + L.PCURVE_MATRIX] != 0.0
    if kind == L.CONIC or around:
        t = wrapped(t, t0)
        if t > t1 and t - TURN >= t0 - PCURVE_OVERLAP:
            t -= TURN
    if t < t0 - PCURVE_OVERLAP or t > t1 + PCURVE_OVERLAP:
        return False, t
    return True, min(max(t, t0), t1)


@kernel
def crossings(ints, reals, coedge, u, v, du, dv):
    """Both crossings of a step with a coedge: (count, s, outward, t, s, outward, t).

    s counts steps from (u, v); outward is +1 where the step leaves the face, -1 where it enters.
    """
    c = coedge_record(ints, coedge)
    o = ints[c + L.COEDGE_REALS] + L.PCURVE_MATRIX
    n, ta, tb = line_roots(reals, ints[c + L.COEDGE_KIND], o, u, v, du, dv)
    count = 0
    s1 = s2 = t1 = t2 = 0.0
    out1 = out2 = 0
    length2 = du * du + dv * dv
    for k in range(n):
        t = ta if k == 0 else tb
        x, y, tx, ty, depth = coedge_parameters(ints, reals, coedge, t)
        inside, t = in_range(ints, reals, coedge, t)
        if depth <= 0.0 or not inside:
            continue
        s = ((x - u) * du + (y - v) * dv) / length2
        inward = ints[c + L.COEDGE_SIDE] * (tx * dv - ty * du)
        if inward == 0.0:
            continue
        out = 1 if inward < 0.0 else -1
        if count == 0:
            s1, out1, t1 = s, out, t
        else:
            s2, out2, t2 = s, out, t
        count += 1
    return count, s1, out1, t1, s2, out2, t2


@kernel
def walk_face(ints, reals, chart, u, v, du, dv):
    """(s, hit, index, t): how much of the step fits on the face, s <= 1, and what it hits."""
    r = chart_record(ints, chart)
    first = ints[r + L.CHART_COEDGE]
    best, hit, index, where = 1.0, NO_HIT, -1, 0.0
    length = hypot(du, dv)
    if length == 0.0:
        return best, hit, index, where
    limit = reals[ints[r + L.CHART_REALS] + L.LIMIT]
    if limit < inf:
        for k in range(2):
            a, da = (u, du) if k == 0 else (v, dv)
            if da != 0.0:
                s = max(((limit if da > 0.0 else -limit) - a) / da, 0.0)
                if s < best:
                    best, hit = s, HIT_LIMIT
    behind = -(HIT_BEHIND + PARAMETER_NOISE * (1.0 + abs(u) + abs(v)) / length)
    for k in range(first, first + ints[r + L.CHART_N_COEDGES]):
        count, s1, out1, t1, s2, out2, t2 = crossings(ints, reals, k, u, v, du, dv)
        if count > 0 and out1 > 0 and behind <= s1 <= best:
            best, hit, index, where = max(s1, 0.0), HIT_COEDGE, k, t1
        if count > 1 and out2 > 0 and behind <= s2 <= best:
            best, hit, index, where = max(s2, 0.0), HIT_COEDGE, k, t2
    return best, hit, index, where


@kernel
def walk(ints, reals, feature, chart, p, q, dp, dq):
    """(s, hit, index, t) of a step from parameters (p, q) of any feature."""
    dim = dimension(ints, feature)
    if dim == 2:
        return walk_face(ints, reals, chart, p, q, dp, dq)
    if dim == 1 and dp != 0.0:
        e = edge_record(ints, feature)
        if not ints[e + L.EDGE_FLAGS] & L.CLOSED:
            o = ints[e + L.EDGE_REALS]
            end = 1 if dp > 0.0 else 0
            s = max((reals[o + L.EDGE_T0 + end] - p) / dp, 0.0)
            if s <= 1.0:
                return s, HIT_END, end, reals[o + L.EDGE_T0 + end]
    return 1.0, NO_HIT, -1, 0.0


@kernel
def on_face(ints, reals, chart, u, v):
    """Is (u, v) on the face? From inside a ray leaves at the first boundary it meets."""
    r = chart_record(ints, chart)
    first = ints[r + L.CHART_COEDGE]
    n = ints[r + L.CHART_N_COEDGES]
    limit = reals[ints[r + L.CHART_REALS] + L.LIMIT]
    if abs(u) > limit or abs(v) > limit:
        return False
    # Rays are aimed at points of the boundary, so that they meet it.
    for k in range(RAYS):
        if n == 0:
            break
        aim = coedge_record(ints, first + k % n)
        o = ints[aim + L.COEDGE_REALS]
        t = reals[o] + (0.2371 + 0.1113 * k) * (reals[o + 1] - reals[o])
        x, y, _, _, depth = coedge_parameters(ints, reals, first + k % n, t)
        if depth <= 0.0 or hypot(x - u, y - v) == 0.0:
            continue
        nearest, side = inf, 0
        for j in range(first, first + n):
            count, s1, out1, _, s2, out2, _ = crossings(ints, reals, j, u, v, x - u, y - v)
            if count > 0 and 0.0 <= s1 < nearest:
                nearest, side = s1, out1
            if count > 1 and 0.0 <= s2 < nearest:
                nearest, side = s2, out2
        if side != 0:
            return side > 0
    return True
