"""Foot points of the opposing witness point on edges, and the resets that enter an edge.

A foot point is what a guard needs. Whether a reset takes its parameter is another matter: as
printed it does not, see `reset_onto_edge`. Foot points and parameters taken from them are counted.
"""

from standoff.kernels.algebra.vectors import dot, norm, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    best_coedge,
    chart_jet,
    chart_record,
    coedge_parameters,
    coedge_record,
    edge_jet,
    edge_record,
)
from standoff.kernels.body.jets import chart_parameters
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.pair.events import SOLVED_PARAMETERS
from standoff.kernels.pair.switching import across, is_smooth
from standoff.kernels.state.arrays import RESET_NEAREST
from standoff.kernels.tolerances import BRACKET_ROUNDINGS, CLOSEST_SAMPLES, CLOSEST_STEPS, EPS
from standoff.kernels.values import NO_CHART, Side


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
