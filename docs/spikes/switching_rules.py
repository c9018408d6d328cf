"""The descent of ``standoff.kernels.pair.descent.settle`` with its switching rule to choose.

With OURS it is that function, step by step; the script checks that both end at the same place.
The other rules live only here.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from standoff.kernels.algebra.vectors import axpy, dot, norm, scale, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    best_coedge,
    chart_record,
    coedge_parameters,
    coedge_record,
    dimension,
    edge_jet,
    feature_jet,
)
from standoff.kernels.body.trimming import HIT_COEDGE, HIT_END, HIT_LIMIT, NO_HIT, walk
from standoff.kernels.pair.descent import (
    NO_EDGE,
    Advance,
    Step,
    advance,
    line_search,
    pair_jets,
    recentre,
    release_along,
    take_hit,
    walk_pair,
)
from standoff.kernels.pair.newton import (
    gradient_norm,
    law,
    metric_inverse,
    pair_metric,
    unwhiten_step,
    whiten_gradient,
    whiten_hessian,
)
from standoff.kernels.pair.system import feedforward, gradient, hessian, projection_errors
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
from standoff.kernels.values import ORIGIN, STILL, Side, body_of, side_of, with_side

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
def along(g, change):
    """What a step changes E by, to first order."""
    return g[0] * change[0] + g[1] * change[1] + g[2] * change[2] + g[3] * change[3]


@compiled
def newton_step(rule, jets, p, g, span, tally):
    """(change of the parameters, has H a direction that is not stiff?)."""
    jet_a, jet_b = jets
    H = hessian(jet_a, jet_b)
    still = gradient(feedforward(jet_a, jet_b, STILL, (p, ORIGIN, ORIGIN)))
    metrics = pair_metric(jet_a, jet_b)
    change, _, flat, valley, _ = law(metrics, jet_a, jet_b, g, H, still, span)
    tally[SOLVES] += 1
    tally[FLAT] += flat
    if flat and rule in (FLOOR, DROP):
        change = flat_solve(rule, jet_a, jet_b, g, H, span)
    return change, valley


@compiled
def advance_clipped(pair, pose, place, step, g, last_smooth, work):
    """`advance`, but each body's part of the step is cut at that body's own boundary."""
    a, b, change = side_of(place, 0), side_of(place, 1), step.change
    of_a = walk(pair.ints_a, pair.reals_a, a.feature, a.chart, a.p, a.q, change[0], change[1])
    of_b = walk(pair.ints_b, pair.reals_b, b.feature, b.chart, b.p, b.q, change[2], change[3])
    cut = (of_a.s * change[0], of_a.s * change[1], of_b.s * change[2], of_b.s * change[3])
    step = Step(cut, step.energy, along(g, cut), step.noise, step.flat)
    s, ok, on_step, trial, jets = line_search(pair, pose, place, step, 1.0)
    if not ok:
        return Advance(False, False, False, place, jets, last_smooth)
    if not on_step or s < 1.0 or (of_a.kind == NO_HIT and of_b.kind == NO_HIT):
        trial, changed = recentre(pair, trial, work)
        return Advance(True, False, changed, trial, jets, NO_EDGE)
    passed = NO_EDGE
    if of_a.kind != NO_HIT:
        trial, passed = take_hit(pair, trial, 0, of_a, last_smooth, work)
    if of_b.kind != NO_HIT:
        trial, passed = take_hit(pair, trial, 1, of_b, last_smooth, work)
    return Advance(True, True, True, trial, jets, passed)


@compiled
def slope_limit(span, d, slope):
    return max(SLOPE, max(SLOPE_NOISE * EPS * span, slope) / d)


@compiled
def release(pair, pose, place, dR, limit, work):
    """(released, place): `release_along` the direction of dR."""
    d = norm(dR)
    return release_along(pair, pose, place, scale(-1.0 / d, dR), d, limit, work)


@compiled
def descend(rule, pair, pose, place, work, tally):
    """(how it ended, place): descend from a place under a rule."""
    if rule == ZEROING:
        return descend_zeroing(pair, pose, place, work, tally)
    size = pair.reals_a[L.SIZE] + pair.reals_b[L.SIZE]
    stalls, polish, last_smooth = 0, 0, NO_EDGE
    last_slope, last_release = 1e300, 1e300
    for _ in range(MAX_ITERATIONS):
        jet_a, jet_b = jets = pair_jets(pair, pose, place)
        dR = sub(jet_a[0], jet_b[0])
        d = norm(dR)
        span = size + d
        if d <= TOUCHING * span:
            return CONTACT, place
        E, noise = 0.5 * d * d, ENERGY_NOISE * EPS * span * d
        g = gradient(projection_errors(jet_a, jet_b))
        slope = gradient_norm(jet_a, jet_b, g)
        if slope > AT_REST * EPS * span:
            change, valley = newton_step(rule, jets, pose.p, g, span, tally)
            step = Step(change, E, along(g, change), noise, valley)
            in_noise = -0.5 * step.descent <= noise
            polish += in_noise
            polished = in_noise and polish > MAX_POLISH and slope > POLISH_RATIO * last_slope
            last_slope = slope
            if not polished:
                if rule == CLIP:
                    made = advance_clipped(pair, pose, place, step, g, last_smooth, work)
                else:
                    made = advance(pair, pose, place, step, last_smooth, work)
                place, last_smooth = made.place, made.last_smooth
                if made.held:
                    polish, last_slope = 0, 1e300
                if made.held and rule == AT_ONCE:
                    jet_a, jet_b = pair_jets(pair, pose, place)
                    dR = sub(jet_a[0], jet_b[0])
                    limit = slope_limit(span, norm(dR), 0.0)
                    released, place = release(pair, pose, place, dR, limit, work)
                    tally[RELEASES] += released
                if made.ok:
                    continue
        if last_release - noise < E:
            stalls += 1
            if stalls > MAX_STALLS:
                return STALLED, place
        last_release = E
        limit = slope_limit(span, d, 0.0 if rule == EAGER else slope)
        released, place = release(pair, pose, place, dR, limit, work)
        if not released:
            return STATIONARY, place
        tally[RELEASES] += 1
        polish, last_slope = 0, 1e300
    return EXHAUSTED, place


# --- zeroing: the boundary is held, but the pair is still solved with the whole face ---------


class Grip(NamedTuple):
    """A body's hold on the boundary of the face that it came from."""

    coedge: int  # NO_EDGE: it has none
    t: float  # parameter of the edge


FREE = Grip(NO_EDGE, 0.0)


@compiled
def face_of(ints, reals, coedge, t):
    """(coedge, side): a boundary's point at t on the face that carries it."""
    k = best_coedge(ints, reals, coedge, t)
    u, v, _, _, _ = coedge_parameters(ints, reals, k, t)
    chart = ints[coedge_record(ints, k) + L.COEDGE_CHART]
    return k, Side(ints[chart_record(ints, chart) + L.CHART_FACE], chart, u, v)


@compiled
def zeroed(pair, place, body, grip, a, b):
    """(place, grip, a, b): one body's part (a, b) of the step, that across a held boundary dropped.

    A part that leads inward frees the body: it is on its face again.
    """
    if grip.coedge < 0:
        return place, grip, a, b
    ints, reals = body_of(pair, body)
    side = side_of(place, body)
    k, inner = face_of(ints, reals, grip.coedge, grip.t)
    _, _, du, dv, _ = coedge_parameters(ints, reals, k, grip.t)
    c = coedge_record(ints, k)
    if ints[c + L.COEDGE_SIDE] * (du * b - dv * a) > 0.0:
        return with_side(place, body, inner), FREE, a, b
    edge = ints[L.N_FACES] + ints[c + L.COEDGE_EDGE]
    jet = feature_jet(ints, reals, 0, inner.chart, inner.p, inner.q)
    tangent = edge_jet(ints, reals, edge, grip.t)[1]
    part = dot(axpy(a, jet[1], scale(b, jet[2])), tangent) / dot(tangent, tangent)
    if dimension(ints, side.feature) == 0:
        o = ints[ints[L.EDGES] + L.EDGE_STRIDE * ints[c + L.COEDGE_EDGE] + L.EDGE_REALS]
        at_first = grip.t == reals[o + L.EDGE_T0]
        if part == 0.0 or (part > 0.0) != at_first:
            return place, grip, 0.0, 0.0
        place = with_side(place, body, Side(edge, NO_EDGE, grip.t, 0.0))
    return place, grip, part, 0.0


@compiled
def on_faces(pair, place, grip_a, grip_b):
    """The place for the solve: what is held on a boundary is on the face that it came from."""
    if grip_a.coedge >= 0:
        place = with_side(place, 0, face_of(pair.ints_a, pair.reals_a, grip_a.coedge, grip_a.t)[1])
    if grip_b.coedge >= 0:
        place = with_side(place, 1, face_of(pair.ints_b, pair.reals_b, grip_b.coedge, grip_b.t)[1])
    return place


@compiled
def kept(ints, side, grip):
    """A grip moved along with the body's point on its edge."""
    return Grip(grip.coedge, side.p) if dimension(ints, side.feature) == 1 else grip


@compiled
def gripped(grip, hit):
    """The grip after a hit: on the face that was left."""
    if hit.kind == HIT_COEDGE:
        return Grip(hit.index, hit.t)
    if hit.kind == HIT_END:
        return Grip(grip.coedge, hit.t)
    return FREE if hit.kind == HIT_LIMIT else grip


@compiled
def advance_gripped(pair, pose, place, step, grip_a, grip_b, work):
    """(moved, place, grips): `advance`, and what is then held on a boundary."""
    body, hit = walk_pair(pair, place, step.change)
    s, ok, _, trial, _ = line_search(pair, pose, place, step, hit.s)
    if not ok:
        return False, place, grip_a, grip_b
    grip_a = kept(pair.ints_a, side_of(trial, 0), grip_a)
    grip_b = kept(pair.ints_b, side_of(trial, 1), grip_b)
    if hit.kind == NO_HIT or s < hit.s:
        trial, _ = recentre(pair, trial, work)
        return True, trial, grip_a, grip_b
    trial, _ = take_hit(pair, trial, body, hit, NO_EDGE, work)
    if body == 0:
        return True, trial, gripped(grip_a, hit), grip_b
    return True, trial, grip_a, gripped(grip_b, hit)


@compiled
def descend_zeroing(pair, pose, place, work, tally):
    """The paper's rule: solve with the faces, then zero what is infeasible."""
    size = pair.reals_a[L.SIZE] + pair.reals_b[L.SIZE]
    grip_a, grip_b = FREE, FREE
    stalls, last_release = 0, 1e300
    for _ in range(MAX_ITERATIONS):
        jet_a, jet_b = jets = pair_jets(pair, pose, on_faces(pair, place, grip_a, grip_b))
        dR = sub(jet_a[0], jet_b[0])
        d = norm(dR)
        span = size + d
        if d <= TOUCHING * span:
            return CONTACT, place
        E, noise = 0.5 * d * d, ENERGY_NOISE * EPS * span * d
        g = gradient(projection_errors(jet_a, jet_b))
        (u, v, r, s), _ = newton_step(ZEROING, jets, pose.p, g, span, tally)
        place, grip_a, u, v = zeroed(pair, place, 0, grip_a, u, v)
        place, grip_b, r, s = zeroed(pair, place, 1, grip_b, r, s)
        jet_a, jet_b = pair_jets(pair, pose, place)
        g = gradient(projection_errors(jet_a, jet_b))
        move_a = axpy(u, jet_a[1], scale(v, jet_a[2]))
        move_b = axpy(r, jet_b[1], scale(s, jet_b[2]))
        if max(norm(move_a), norm(move_b)) > SHORT * span:
            change = (u, v, r, s)
            step = Step(change, E, along(g, change), noise, 0)
            ok, place, grip_a, grip_b = advance_gripped(
                pair, pose, place, step, grip_a, grip_b, work
            )
            if ok:
                continue
        if last_release - noise < E:
            stalls += 1
            if stalls > MAX_STALLS:
                return STALLED, place
        last_release = E
        limit = slope_limit(span, d, 0.0)
        before = place
        released, place = release(pair, pose, place, dR, limit, work)
        if not released:
            return STATIONARY, place
        grip_a = grip_a if place.feature_a == before.feature_a else FREE
        grip_b = grip_b if place.feature_b == before.feature_b else FREE
        tally[RELEASES] += 1
    return EXHAUSTED, place
