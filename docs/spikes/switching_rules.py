"""The descent of ``standoff.kernels.descent.settle`` with its switching rule to choose.

With OURS it is that function, step by step; the script checks that both end at the same place.
The other rules live only here.
"""

import numpy as np
from numba import njit

from standoff.kernels import layout as L
from standoff.kernels.descent import (
    ORIGIN,
    line_search,
    pair_jets,
    recentre,
    release_pair,
    set_mode,
    take_hit,
    walk_pair,
)
from standoff.kernels.events import EVENT_COLUMNS, MAX_EVENTS, new_counts
from standoff.kernels.features import (
    best_coedge,
    chart_record,
    coedge_parameters,
    coedge_record,
    dimension,
    edge_jet,
    feature_jet,
)
from standoff.kernels.feedback import (
    gradient_norm,
    law,
    metric_inverse,
    unwhiten_step,
    whiten_gradient,
    whiten_hessian,
)
from standoff.kernels.system import feedforward, gradient, hessian, projection_errors
from standoff.kernels.tolerances import (
    AT_REST,
    ENERGY_NOISE,
    EPS,
    GRADIENT_NOISE,
    MAX_ITERATIONS,
    MAX_POLISH,
    MAX_STALLS,
    NEGATIVE,
    POLISH_RATIO,
    SLOPE,
    SLOPE_NOISE,
    TOUCHING,
)
from standoff.kernels.trimming import HIT_COEDGE, HIT_END, HIT_LIMIT, NO_HIT, walk
from standoff.kernels.vectors import axpy, dot, norm, scale, sub

# Rules.
OURS = 0  # hold the boundary, solve the reduced pair, test multipliers only when stationary
AT_ONCE = 1  # test the multipliers at the hit itself
CLIP = 2  # cut each body's part of the coupled step at that body's own boundary
ZEROING = 3  # solve with the face held; drop the step's part across the boundary afterwards
FLOOR = 4  # OURS, a flat direction with a slope gets the eigenvalue 1e-11
DROP = 5  # OURS, every flat direction is dropped (minimum norm)
EAGER = 6  # OURS, a release needs a slope beyond roundoff only, not beyond the residual's own

FLAT_FLOOR = 1e-11
# ZEROING has no gradient of its own mode: a step below this many pair sizes ends it.
SHORT = 1e-13

# What `descend` returns.
STATIONARY, EXHAUSTED, CONTACT, STALLED = range(4)

# What it counts.
SOLVES, RELEASES, FLAT = range(3)
N_TALLY = 3

compiled = njit(error_model="numpy")


@compiled
def flat_solve(rule, jet_a, jet_b, g, H, span):
    """The decomposed step with another rule for directions without curvature."""
    ia = metric_inverse(jet_a[1], jet_a[2])
    ib = metric_inverse(jet_b[1], jet_b[2])
    gw = whiten_gradient(ia, ib, g)
    Hw = whiten_hessian(ia, ib, H)
    A = np.empty((4, 4))
    k = 0
    for i in range(4):
        for j in range(i, 4):
            A[i, j] = Hw[k]
            A[j, i] = Hw[k]
            k += 1
    values, V = np.linalg.eigh(A)
    top = max(abs(values[0]), abs(values[3]))
    p = np.zeros(4)
    for i in range(4):
        slope = V[0, i] * gw[0] + V[1, i] * gw[1] + V[2, i] * gw[2] + V[3, i] * gw[3]
        if abs(values[i]) > NEGATIVE * top:
            along = -slope / abs(values[i])
        elif rule == FLOOR and abs(slope) > GRADIENT_NOISE * EPS * span:
            along = -slope / (FLAT_FLOOR * top)
        else:
            along = 0.0
        for j in range(4):
            p[j] += V[j, i] * along
    return unwhiten_step(ia, ib, (p[0], p[1], p[2], p[3]))


@compiled
def newton_step(rule, jet_a, jet_b, g, p, span, tally):
    H = hessian(jet_a, jet_b)
    still = gradient(feedforward(jet_a, jet_b, ORIGIN, ORIGIN, ORIGIN, p, ORIGIN, ORIGIN))
    step, _, _, flat, valley, _ = law(jet_a, jet_b, g, H, still, span)
    tally[SOLVES] += 1
    tally[FLAT] += flat
    if flat and rule in (FLOOR, DROP):
        step = flat_solve(rule, jet_a, jet_b, g, H, span)
    return step, valley


@compiled
def clipped(pair, mode, q, step):
    """Each body's part cut at its own boundary: (step, hits of A, hits of B)."""
    ia, ra, ib, rb = pair
    sa, ha, na, ta = walk(ia, ra, mode[0], mode[1], q[0], q[1], step[0], step[1])
    sb, hb, nb, tb = walk(ib, rb, mode[2], mode[3], q[2], q[3], step[2], step[3])
    return (sa * step[0], sa * step[1], sb * step[2], sb * step[3]), (ha, na, ta), (hb, nb, tb)


@compiled
def advance(rule, pair, R, p, mode, q, step, valley, g, E, noise, counts, events, last_smooth):
    """Walk, search and hold, as `settle` does: (moved, the smooth edge passed, hit)."""
    descent = g[0] * step[0] + g[1] * step[1] + g[2] * step[2] + g[3] * step[3]
    if rule == CLIP:
        step, hit_a, hit_b = clipped(pair, mode, q, step)
        descent = g[0] * step[0] + g[1] * step[1] + g[2] * step[2] + g[3] * step[3]
        s, body, hit, index, t = 1.0, 0, hit_a[0], hit_a[1], hit_a[2]
    else:
        s, body, hit, index, t = walk_pair(pair, mode, q, step)
        hit_b = (NO_HIT, -1, 0.0)
    reach = s
    s, ok, on_step, trial, _, _ = line_search(
        pair, R, p, mode, q, step, valley, s, E, descent, noise
    )
    if not ok:
        return False, last_smooth, False
    q[0], q[1], q[2], q[3] = trial
    if on_step and s == reach and (hit != NO_HIT or hit_b[0] != NO_HIT):
        passed = -1
        if hit != NO_HIT:
            passed = take_hit(pair, mode, q, body, hit, index, t, last_smooth, s, counts, events)
        if hit_b[0] != NO_HIT:
            passed = take_hit(
                pair, mode, q, 1, hit_b[0], hit_b[1], hit_b[2], last_smooth, s, counts, events
            )
        return True, passed, True
    recentre(pair, mode, q, counts)
    return True, -1, False


@compiled
def slope_limit(span, d, slope):
    return max(SLOPE, max(SLOPE_NOISE * EPS * span, slope) / d)


@compiled
def descend(rule, pair, R, p, mode, q, tally):
    """Descend under a rule from (mode, q), changed in place. Returns how it ended."""
    if rule == ZEROING:
        return descend_zeroing(pair, R, p, mode, q, tally)
    size = pair[1][L.SIZE] + pair[3][L.SIZE]
    counts, events = new_counts(), np.empty(EVENT_COLUMNS * MAX_EVENTS)
    stalls, polish, last_smooth = 0, 0, -1
    last_slope, last_release = 1e300, 1e300
    for _ in range(MAX_ITERATIONS):
        jet_a, jet_b = pair_jets(pair, R, p, mode, q)
        dR = sub(jet_a[0], jet_b[0])
        d = norm(dR)
        span = size + d
        if d <= TOUCHING * span:
            return CONTACT
        E, noise = 0.5 * d * d, ENERGY_NOISE * EPS * span * d
        g = gradient(projection_errors(jet_a, jet_b))
        slope = gradient_norm(jet_a, jet_b, g)
        stationary = slope <= AT_REST * EPS * span
        if not stationary:
            step, valley = newton_step(rule, jet_a, jet_b, g, p, span, tally)
            gain = g[0] * step[0] + g[1] * step[1] + g[2] * step[2] + g[3] * step[3]
            if -0.5 * gain <= noise:
                polish += 1
                stationary = polish > MAX_POLISH and slope > POLISH_RATIO * last_slope
            last_slope = slope
        if not stationary:
            moved, last_smooth, hit = advance(
                rule, pair, R, p, mode, q, step, valley, g, E, noise, counts, events, last_smooth
            )
            if hit:
                polish, last_slope = 0, 1e300
            if hit and rule == AT_ONCE:
                jet_a, jet_b = pair_jets(pair, R, p, mode, q)
                dR = sub(jet_a[0], jet_b[0])
                limit = slope_limit(span, norm(dR), 0.0)
                tally[RELEASES] += release_pair(pair, R, mode, q, dR, limit, counts, events)
            if moved:
                continue
        if last_release - noise < E:
            stalls += 1
            if stalls > MAX_STALLS:
                return STALLED
        last_release = E
        limit = slope_limit(span, d, 0.0 if rule == EAGER else slope)
        if not release_pair(pair, R, mode, q, dR, limit, counts, events):
            return STATIONARY
        tally[RELEASES] += 1
        polish, last_slope = 0, 1e300
    return EXHAUSTED


# --- zeroing: the boundary is held, but the pair is still solved with the whole face ---------


@compiled
def carried(ints, reals, k, feature, t):
    """(coedge, u, v, du, dv) of a held boundary point on the face that carries it."""
    k = best_coedge(ints, reals, k, t)
    u, v, du, dv, _ = coedge_parameters(ints, reals, k, t)
    return k, u, v, du, dv


@compiled
def zeroed(ints, reals, mode, q, body, carrier, held, a, b):
    """One body's part (a, b) of the step, its part across a held boundary dropped.

    A part that leads inward frees the body: it is on its face again.
    """
    k, u, v, du, dv = carried(ints, reals, carrier[body], mode[2 * body], held[body])
    c = coedge_record(ints, k)
    if ints[c + L.COEDGE_SIDE] * (du * b - dv * a) > 0.0:
        chart = ints[c + L.COEDGE_CHART]
        set_mode(mode, q, body, ints[chart_record(ints, chart) + L.CHART_FACE], chart, u, v)
        carrier[body] = -1
        return a, b
    edge = ints[L.N_FACES] + ints[c + L.COEDGE_EDGE]
    jet = feature_jet(ints, reals, 0, ints[c + L.COEDGE_CHART], u, v)
    tangent = edge_jet(ints, reals, edge, held[body])[1]
    along = dot(axpy(a, jet[1], scale(b, jet[2])), tangent) / dot(tangent, tangent)
    if dimension(ints, mode[2 * body]) == 0:
        o = ints[ints[L.EDGES] + L.EDGE_STRIDE * ints[c + L.COEDGE_EDGE] + L.EDGE_REALS]
        at_first = held[body] == reals[o + L.EDGE_T0]
        if along == 0.0 or (along > 0.0) != at_first:
            return 0.0, 0.0
        set_mode(mode, q, body, edge, -1, held[body], 0.0)
    return along, 0.0


@compiled
def faces_jets(pair, R, p, mode, q, carrier, held):
    """Jets for the solve: a held boundary point keeps the tangents of the face it came from."""
    m, x = mode.copy(), q.copy()
    for body in range(2):
        if carrier[body] >= 0:
            ints, reals = (pair[0], pair[1]) if body == 0 else (pair[2], pair[3])
            k, u, v, _, _ = carried(ints, reals, carrier[body], mode[2 * body], held[body])
            chart = ints[coedge_record(ints, k) + L.COEDGE_CHART]
            set_mode(m, x, body, ints[chart_record(ints, chart) + L.CHART_FACE], chart, u, v)
    return pair_jets(pair, R, p, m, x)


@compiled
def hold(pair, mode, q, carrier, held, body, hit, index, t, counts, events):
    """Take a hit and remember the face that was left."""
    take_hit(pair, mode, q, body, hit, index, t, -1, 1.0, counts, events)
    if hit == HIT_COEDGE:
        carrier[body], held[body] = index, t
    if hit == HIT_END:
        held[body] = t
    if hit == HIT_LIMIT:
        carrier[body] = -1


@compiled
def descend_zeroing(pair, R, p, mode, q, tally):
    """The paper's rule: solve with the faces, then zero what is infeasible."""
    size = pair[1][L.SIZE] + pair[3][L.SIZE]
    counts, events = new_counts(), np.empty(EVENT_COLUMNS * MAX_EVENTS)
    carrier, held = np.full(2, -1), np.zeros(2)
    stalls, last_release = 0, 1e300
    ia, ra, ib, rb = pair
    for _ in range(MAX_ITERATIONS):
        jet_a, jet_b = faces_jets(pair, R, p, mode, q, carrier, held)
        dR = sub(jet_a[0], jet_b[0])
        d = norm(dR)
        span = size + d
        if d <= TOUCHING * span:
            return CONTACT
        E, noise = 0.5 * d * d, ENERGY_NOISE * EPS * span * d
        g = gradient(projection_errors(jet_a, jet_b))
        step, _ = newton_step(ZEROING, jet_a, jet_b, g, p, span, tally)
        a = (step[0], step[1])
        b = (step[2], step[3])
        if carrier[0] >= 0:
            a = zeroed(ia, ra, mode, q, 0, carrier, held, step[0], step[1])
        if carrier[1] >= 0:
            b = zeroed(ib, rb, mode, q, 1, carrier, held, step[2], step[3])
        step = (a[0], a[1], b[0], b[1])
        jet_a, jet_b = pair_jets(pair, R, p, mode, q)
        g = gradient(projection_errors(jet_a, jet_b))
        move_a = axpy(step[0], jet_a[1], scale(step[1], jet_a[2]))
        move_b = axpy(step[2], jet_b[1], scale(step[3], jet_b[2]))
        if max(norm(move_a), norm(move_b)) > SHORT * span:
            descent = g[0] * step[0] + g[1] * step[1] + g[2] * step[2] + g[3] * step[3]
            s, body, hit, index, t = walk_pair(pair, mode, q, step)
            reach = s
            s, ok, _, trial, _, _ = line_search(pair, R, p, mode, q, step, 0, s, E, descent, noise)
            if ok:
                q[0], q[1], q[2], q[3] = trial
                for k in range(2):
                    if dimension(ia if k == 0 else ib, mode[2 * k]) == 1:
                        held[k] = q[2 * k]
                if hit != NO_HIT and s == reach:
                    hold(pair, mode, q, carrier, held, body, hit, index, t, counts, events)
                else:
                    recentre(pair, mode, q, counts)
                continue
        if last_release - noise < E:
            stalls += 1
            if stalls > MAX_STALLS:
                return STALLED
        last_release = E
        old_a, old_b = mode[0], mode[2]
        if not release_pair(pair, R, mode, q, dR, slope_limit(span, d, 0.0), counts, events):
            return STATIONARY
        carrier[0] = carrier[0] if mode[0] == old_a else -1
        carrier[1] = carrier[1] if mode[2] == old_b else -1
        tally[RELEASES] += 1
    return EXHAUSTED
