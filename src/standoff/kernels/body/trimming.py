"""Walking on a feature until its boundary: trimming loops, ends of edges, limits of charts."""

from math import hypot, inf, pi

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    chart_record,
    coedge_parameters,
    coedge_record,
    dimension,
    edge_record,
    is_creased,
)
from standoff.kernels.body.line_roots import TOUCHING_LINE, line_roots
from standoff.kernels.compiler.decorators import shared, uncontracted
from standoff.kernels.tolerances import (
    AIM_FIRST,
    AIM_STEP,
    ALONG_AIM,
    FAR_OUT,
    PARAMETER_NOISE,
    PCURVE_OVERLAP,
    RAYS,
    SAME_CROSSING,
    SLIVER_AIM,
    TOUCH_WIDTH,
)
from standoff.kernels.values import Hit

NO_HIT = 0
HIT_COEDGE = 1  # index: the coedge; t: its parameter
HIT_END = 2  # index: 0 or 1, the end of the edge
HIT_LIMIT = 3  # the chart's limit: change charts

TURN = 2.0 * pi


@uncontracted
def wrapped(t, t0):
    return t0 + (t - t0) % TURN


@uncontracted
def in_period(ints, reals, record, u):
    """u within the period in which the trimming curves of a chart lie. `record` is the chart's."""
    at = ints[record + L.CHART_PERIODIC]
    if at <= L.REPEATS or reals[at] <= u <= reals[at] + TURN:
        return u
    return wrapped(u, reals[at])


@uncontracted
def next_period(ints, reals, record, u):
    """1 or -1 for parameters past the end or the start of that period, else 0."""
    at = ints[record + L.CHART_PERIODIC]
    if at <= L.REPEATS or reals[at] <= u <= reals[at] + TURN:
        return 0
    return 1 if u > reals[at] else -1


@uncontracted
def in_range(ints, reals, coedge, t):
    """(inside, t) with t brought into the pcurve's range, periods included."""
    c = coedge_record(ints, coedge)
    o = ints[c + L.COEDGE_REALS]
    t0, t1 = reals[o + L.PCURVE_FIRST], reals[o + L.PCURVE_LAST]
    kind = ints[c + L.COEDGE_KIND]
    periodic = ints[chart_record(ints, ints[c + L.COEDGE_CHART]) + L.CHART_PERIODIC] != 0
    p = o + L.PCURVE_DATA
    around = periodic and kind == L.LINE and abs(reals[p]) == 1.0 and reals[p + 3] == 0.0
    if kind == L.CONIC or around:
        t = wrapped(t, t0)
        if t > t1 and t - TURN >= t0 - PCURVE_OVERLAP:
            t -= TURN
    if t < t0 - PCURVE_OVERLAP or t > t1 + PCURVE_OVERLAP:
        return False, t
    return True, min(max(t, t0), t1)


@uncontracted
def crossings(ints, reals, coedge, u, v, du, dv, noise):
    """Both crossings of a step with a coedge: (count, s, outward, t, s, outward, t).

    s counts steps from (u, v), and is 0 where (u, v) is on the coedge but for noise (parameter
    units); outward is +1 where the step leaves the face, -1 where it enters.
    """
    c = coedge_record(ints, coedge)
    o = ints[c + L.COEDGE_REALS] + L.PCURVE_DATA
    kind = ints[c + L.COEDGE_KIND]
    n, ta, tb = line_roots(reals, kind, o, u, v, du, dv, noise)
    count = 0
    s1 = s2 = t1 = t2 = 0.0
    out1 = out2 = 0
    length2 = du * du + dv * dv
    for k in range(2 if n == TOUCHING_LINE else n):
        t = ta if k == 0 else tb
        x, y, tx, ty, depth = coedge_parameters(ints, reals, coedge, t)
        inside, t = in_range(ints, reals, coedge, t)
        if depth <= 0.0 or not inside:
            continue
        across = tx * dv - ty * du
        inward = ints[c + L.COEDGE_SIDE] * across
        if kind == L.LINE and across != 0.0:
            # free of t's roundoff along the line, which swamps a small step
            s = ((y - v) * tx - (x - u) * ty) / across
        else:
            s = ((x - u) * du + (y - v) * dv) / length2
        if n == TOUCHING_LINE:
            # the line only touches the curve: outside all along, if the face is on its side
            along = ints[c + L.COEDGE_SIDE] * (tx * du + ty * dv)
            if (along > 0.0) != (tb < 0.0):
                break
            inward = -1.0
            s = min(s, 0.0) if abs(s) * sqrt(length2) < TOUCH_WIDTH else s
        if inward == 0.0:
            continue
        out = 1 if inward < 0.0 else -1
        if n != TOUCHING_LINE and abs(s) * abs(inward) <= noise * hypot(tx, ty):
            if abs(s) * sqrt(length2) > TOUCH_WIDTH:
                # along the coedge: crossed here, if it is left at all
                t += ((u - x) * tx + (v - y) * ty) / (tx * tx + ty * ty)
                inside, t = in_range(ints, reals, coedge, t)
                if not inside or abs(inward) <= noise * hypot(tx, ty):
                    continue
            s = 0.0
        if count == 0:
            s1, out1, t1 = s, out, t
        else:
            s2, out2, t2 = s, out, t
        count += 1
        if n == TOUCHING_LINE:
            break
    return count, s1, out1, t1, s2, out2, t2


@uncontracted
def well_inside(reals, o, u, v):
    """Do parameters lie in the rectangle on the face of the chart whose reals begin at o?"""
    b = o + L.INNER
    return reals[b] <= u <= reals[b + 1] and reals[b + 2] <= v <= reals[b + 3]


@uncontracted
def far_out(reals, o, u, v):
    """Are parameters so much greater than those on the face that their roundoff is wider than it?

    The face of a half-space, and one without area, have no rectangle to decide by.
    """
    b = o + L.INNER
    low, high = reals[b] + reals[b + 2], reals[b + 1] + reals[b + 3]
    if not (-inf < low <= high < inf):
        return False
    width = 1.0 + max(abs(reals[b]), abs(reals[b + 1])) + max(abs(reals[b + 2]), abs(reals[b + 3]))
    return abs(u) + abs(v) > FAR_OUT * width


@uncontracted
def to_limit(limit, u, v, du, dv):
    """How much of a step fits within |u|, |v| <= limit, at most 1."""
    best = 1.0
    if limit < inf:
        for k in range(2):
            a, da = (u, du) if k == 0 else (v, dv)
            if da != 0.0:
                best = min(best, max(((limit if da > 0.0 else -limit) - a) / da, 0.0))
    return best


@uncontracted
def walk_face(ints, reals, chart, u, v, du, dv):
    """(s, hit, index, t): how much of the step fits on the face, s <= 1, and what it hits."""
    r = chart_record(ints, chart)
    first = ints[r + L.CHART_COEDGE]
    best, hit, index, where = 1.0, NO_HIT, -1, 0.0
    if du == 0.0 and dv == 0.0:
        return best, hit, index, where
    u = in_period(ints, reals, r, u)
    turn = next_period(ints, reals, r, u + du)
    best = to_limit(reals[ints[r + L.CHART_REALS] + L.LIMIT], u, v, du, dv)
    if best < 1.0:
        hit = HIT_LIMIT
    # the nearest crossings behind: the last one inward where the start is on the face
    left, entered, left_at, left_t = -inf, -inf, -1, 0.0
    for k in range(first, first + ints[r + L.CHART_N_COEDGES]):
        # beside a crease parameters of any order of magnitude differ
        creased = is_creased(ints, ints[L.N_FACES] + ints[coedge_record(ints, k) + L.COEDGE_EDGE])
        noise = 0.0 if creased else PARAMETER_NOISE * (1.0 + abs(u) + abs(v))
        # and, where the step leaves the period, as it enters the next one
        for period in range(2 if turn else 1):
            count, s1, out1, t1, s2, out2, t2 = crossings(
                ints, reals, k, u - period * turn * TURN, v, du, dv, noise
            )
            for m in range(count):
                s, out, t = (s1, out1, t1) if m == 0 else (s2, out2, t2)
                if out > 0 and 0.0 <= s <= best:
                    best, hit, index, where = s, HIT_COEDGE, k, t
                elif out > 0 and left < s < 0.0:
                    left, left_at, left_t = s, k, t
                elif out < 0 and entered < s <= 0.0:
                    entered = s
    if left > entered and -left * hypot(du, dv) <= TOUCH_WIDTH:
        # roundoff has carried the start outside: back to where it left
        return 0.0, HIT_COEDGE, left_at, left_t
    return best, hit, index, where


@uncontracted
def passes_an_end(ints, reals, chart, u, v):
    """Are parameters beyond the end of a face without width, whose border is one line twice?"""
    r = chart_record(ints, chart)
    b = ints[r + L.CHART_REALS] + L.INNER
    if reals[b] <= reals[b + 1] or ints[r + L.CHART_N_COEDGES] != 2:
        return False
    kind = ints[coedge_record(ints, ints[r + L.CHART_COEDGE]) + L.COEDGE_KIND]
    return kind == L.LINE and not on_face(ints, reals, chart, u, v)


@uncontracted
def beside_line(ints, reals, coedge, u, v):
    """The parameter of a straight pcurve's point nearest to (u, v)."""
    x, y, tx, ty, _ = coedge_parameters(ints, reals, coedge, 0.0)
    t = ((u - x) * tx + (v - y) * ty) / (tx * tx + ty * ty)
    o = ints[coedge_record(ints, coedge) + L.COEDGE_REALS]
    return min(max(t, reals[o + L.PCURVE_FIRST]), reals[o + L.PCURVE_LAST])


@shared
def walk(ints, reals, feature, chart, p, q, dp, dq):
    """How much of a step from parameters (p, q) of any feature fits, and what stops it."""
    dim = dimension(ints, feature)
    if dim == 2:
        o = ints[chart_record(ints, chart) + L.CHART_REALS]
        if well_inside(reals, o, p, q) and well_inside(reals, o, p + dp, q + dq):
            return Hit(1.0, NO_HIT, -1, 0.0)
        s, kind, index, t = walk_face(ints, reals, chart, p, q, dp, dq)
        if kind == NO_HIT and passes_an_end(ints, reals, chart, p + dp, q + dq):
            index = ints[chart_record(ints, chart) + L.CHART_COEDGE]
            return Hit(0.0, HIT_COEDGE, index, beside_line(ints, reals, index, p, q))
        return Hit(s, kind, index, t)
    if dim == 1 and dp != 0.0:
        e = edge_record(ints, feature)
        if not ints[e + L.EDGE_FLAGS] & L.CLOSED:
            o = ints[e + L.EDGE_REALS]
            end = 1 if dp > 0.0 else 0
            s = max((reals[o + L.EDGE_T0 + end] - p) / dp, 0.0)
            if s <= 1.0:
                return Hit(s, HIT_END, end, reals[o + L.EDGE_T0 + end])
    return Hit(1.0, NO_HIT, -1, 0.0)


@uncontracted
def ray_side(ints, reals, record, u, v, du, dv):
    """1 where a ray from (u, v) leaves the face at the first boundary it meets, or (u, v) is on a
    boundary; -1 where it enters there; 0 where it meets none. `record` is the chart's.
    """
    noise = PARAMETER_NOISE * (1.0 + abs(u) + abs(v))
    first = ints[record + L.CHART_COEDGE]
    nearest, side = inf, 0
    for j in range(first, first + ints[record + L.CHART_N_COEDGES]):
        count, s1, out1, _, s2, out2, _ = crossings(ints, reals, j, u, v, du, dv, noise)
        if (count > 0 and s1 == 0.0) or (count > 1 and s2 == 0.0):
            return 1
        for m in range(count):
            s, out = (s1, out1) if m == 0 else (s2, out2)
            if 0.0 < s < nearest * (1.0 - SAME_CROSSING):
                nearest, side = s, out
            elif 0.0 < s <= nearest * (1.0 + SAME_CROSSING):
                side = min(side, out)  # entered and left at once, from outside
    return side


@uncontracted
def on_face(ints, reals, chart, u, v):
    """Is (u, v) on the face? From inside a ray leaves at the first boundary it meets."""
    r = chart_record(ints, chart)
    first = ints[r + L.CHART_COEDGE]
    n = ints[r + L.CHART_N_COEDGES]
    u = in_period(ints, reals, r, u)
    noise = PARAMETER_NOISE * (1.0 + abs(u) + abs(v))
    o = ints[r + L.CHART_REALS]
    if well_inside(reals, o, u, v):
        return True
    limit = reals[o + L.LIMIT]
    if abs(u) > limit or abs(v) > limit or far_out(reals, o, u, v):
        return False
    # Rays are aimed at points of the boundary, so that they meet it.
    across, up = 0.0, 0.0
    for k in range(RAYS):
        if n == 0:
            break
        aim = coedge_record(ints, first + k % n)
        o = ints[aim + L.COEDGE_REALS]
        t = reals[o] + (AIM_FIRST + AIM_STEP * k) * (reals[o + 1] - reals[o])
        x, y, tx, ty, depth = coedge_parameters(ints, reals, first + k % n, t)
        if depth <= 0.0:
            continue
        away = hypot(x - u, y - v)
        if away <= noise:
            return True
        across, up = v - y, x - u
        # along its aim a ray may pass through the ends of what it is aimed at, as it may where a
        # sliver is all that a period's end has left of a rim
        speed = hypot(tx, ty)
        along = abs(tx * across + ty * up) <= ALONG_AIM * speed * away
        if along or speed * (reals[o + 1] - reals[o]) <= SLIVER_AIM * away:
            continue
        side = ray_side(ints, reals, r, u, v, up, -across)
        if side != 0:
            return side > 0
    # along a face without width none does: is the point on its line, between the ends?
    return (across == 0.0 and up == 0.0) or ray_side(ints, reals, r, u, v, across, up) > 0
