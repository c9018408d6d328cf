"""Descent of E over the hybrid automaton: safeguarded Newton steps, holds and releases.

A step that meets a boundary is cut there and the boundary is *held*: the pair is solved again
with fewer parameters until a full step fits or nothing is free. Only at such a stationary point
are the switching functions tested, and at most one feature, the steepest, is released. As E
falls between two releases, no stationary point is met twice.
"""

import numpy as np

from standoff.kernels import layout as L
from standoff.kernels.compiling import kernel, shared
from standoff.kernels.events import (
    CHART_CHANGES,
    CORRECTIONS,
    EVALUATIONS,
    LIMIT,
    REGULARISED,
    log_event,
)
from standoff.kernels.features import dimension, feature_jet, moved_jet, pair_span
from standoff.kernels.feedback import gradient_norm, law, stiff_step
from standoff.kernels.switching import (
    NONE_TRIED,
    is_smooth,
    normalised_parameter,
    off_crease,
    onto_boundary,
    steepest_untried,
)
from standoff.kernels.switching import across as across_edge
from standoff.kernels.system import energy, feedforward, gradient, hessian, projection_errors
from standoff.kernels.tolerances import (
    ARMIJO,
    AT_REST,
    ENERGY_NOISE,
    EPS,
    MAX_HALVINGS,
    MAX_ITERATIONS,
    MAX_POLISH,
    MAX_STALLS,
    POLISH_RATIO,
    RECHART,
    SHARP_POLISH,
    SLOPE,
    SLOPE_NOISE,
    TOUCHING,
    VALLEY_STEPS,
)
from standoff.kernels.trimming import HIT_COEDGE, HIT_LIMIT, NO_HIT, walk
from standoff.kernels.vectors import norm, rotate_back, scale, sub

ORIGIN = (0.0, 0.0, 0.0)
NO_EDGE = np.int64(-1)  # of the type of a feature's number: a literal would compile twice

STATIONARY = 0
EXHAUSTED = 1  # the iterations, or the frame's evaluations, ran out
CONTACT = 2  # the surfaces met: no direction is left


@kernel
def pair_jets(pair, R, p, mode, q):
    """Both jets in A's frame at modes (feature_a, chart_a, feature_b, chart_b), parameters q."""
    ia, ra, ib, rb = pair
    jet_a = feature_jet(ia, ra, mode[0], mode[1], q[0], q[1])
    jet_b = feature_jet(ib, rb, mode[2], mode[3], q[2], q[3])
    return jet_a, moved_jet(R, p, jet_b)


@kernel
def walk_pair(pair, mode, q, step):
    """(s, body, hit, index, t): how much of a step of both bodies fits, and who stops it."""
    ia, ra, ib, rb = pair
    sa, ha, na, ta = walk(ia, ra, mode[0], mode[1], q[0], q[1], step[0], step[1])
    sb, hb, nb, tb = walk(ib, rb, mode[2], mode[3], q[2], q[3], step[2], step[3])
    if hb == NO_HIT or (ha != NO_HIT and sa <= sb):
        return sa, 0, ha, na, ta
    return sb, 1, hb, nb, tb


@kernel
def set_mode(mode, q, body, feature, chart, a, b):
    mode[2 * body] = feature
    mode[2 * body + 1] = chart
    q[2 * body] = a
    q[2 * body + 1] = b


@kernel
def take_hit(pair, mode, q, body, hit, index, t, last_smooth, s, counts, events):
    """Apply the reset of a boundary hit. Returns the smooth edge passed, or -1."""
    ia, ra, ib, rb = pair
    ints, reals = (ia, ra) if body == 0 else (ib, rb)
    source, chart = mode[2 * body], mode[2 * body + 1]
    a, b = q[2 * body], q[2 * body + 1]
    feature, new_chart, na, nb = onto_boundary(ints, reals, source, chart, a, b, hit, index, t)
    if hit == HIT_LIMIT:
        counts[CHART_CHANGES] += 1
        set_mode(mode, q, body, feature, new_chart, na, nb)
        return -1
    passed = -1
    # Ping-pong over one smooth edge: held as an edge the second time, where E decides.
    if hit == HIT_COEDGE and is_smooth(ints, feature) and feature != last_smooth:
        passed = feature
        feature, new_chart, na, nb = across_edge(ints, reals, feature, index, t)
    set_mode(mode, q, body, feature, new_chart, na, nb)
    log_event(events, counts, body, source, feature, 1.0 - s, 0.0)
    return passed


@kernel
def recentre(pair, mode, q, counts):
    """Change to the most central chart where a witness point nears its own's rim. Any change?"""
    changed = False
    ia, ra, ib, rb = pair
    for body in range(2):
        ints, reals = (ia, ra) if body == 0 else (ib, rb)
        feature, chart = mode[2 * body], mode[2 * body + 1]
        if dimension(ints, feature) == 2 and ints[ints[L.FACES] + L.FACE_STRIDE * feature + 1] > 1:
            u, v = q[2 * body], q[2 * body + 1]
            if max(abs(u), abs(v)) > RECHART:
                to, chart, u, v = onto_boundary(
                    ints, reals, feature, chart, u, v, HIT_LIMIT, -1, 0.0
                )
                if chart != mode[2 * body + 1]:
                    counts[CHART_CHANGES] += 1
                    changed = True
                    set_mode(mode, q, body, to, chart, u, v)
        q[2 * body] = normalised_parameter(ints, reals, feature, q[2 * body])
    return changed


@kernel
def release_along(pair, R, mode, q, n, d, slope_floor, counts, events):
    """Test the switching functions with the unit vector n from A to B; release the steepest.

    False where none falls faster than `slope_floor`.
    """
    none = NONE_TRIED
    return release_untried(pair, R, mode, q, n, d, slope_floor, none, none, counts, events) >= 0


@kernel
def release_untried(pair, R, mode, q, n, d, slope_floor, tried_a, tried_b, counts, events):
    """`release_along` without the features tried: the body (0 or 1) of the one released, or -1."""
    ia, ra, ib, rb = pair
    back = scale(-1.0, rotate_back(R, n))
    sa, fa, ca, ua, va = steepest_untried(ia, ra, mode[0], q[0], n, tried_a)
    sb, fb, cb, ub, vb = steepest_untried(ib, rb, mode[2], q[2], back, tried_b)
    if min(sa, sb) >= -slope_floor:
        return -1
    if sa <= sb:
        log_event(events, counts, 0, mode[0], fa, sa * d, sa)
        ua, va = off_crease(ia, ra, mode[0], fa, ca, ua, va, scale(d, n))
        set_mode(mode, q, 0, fa, ca, ua, va)
        return 0
    log_event(events, counts, 1, mode[2], fb, sb * d, sb)
    ub, vb = off_crease(ib, rb, mode[2], fb, cb, ub, vb, scale(d, back))
    set_mode(mode, q, 1, fb, cb, ub, vb)
    return 1


@kernel
def release_next(pair, R, mode, q, n, d, slope_floor, tried_a, tried_b, counts, events):
    """(released, tried_a, tried_b): of the features not yet tried in vain the steepest, or, where
    none of them falls, the steepest of all.

    A step into a wide sector may leave the face at its vertex, over the wrong one of its edges,
    and come back for ever, while another edge of the vertex falls.
    """
    body = release_untried(pair, R, mode, q, n, d, slope_floor, tried_a, tried_b, counts, events)
    if body < 0 and max(tried_a[0], tried_b[0]) >= 0:
        none = NONE_TRIED
        body = release_untried(pair, R, mode, q, n, d, slope_floor, none, none, counts, events)
    if body == 0:
        tried_a = (mode[0], tried_a[0], tried_a[1])
    elif body == 1:
        tried_b = (mode[2], tried_b[0], tried_b[1])
    return body >= 0, tried_a, tried_b


@kernel
def release_pair(pair, R, mode, q, dR, slope_floor, counts, events):
    """`release_along` the direction of dR."""
    d = norm(dR)
    return release_along(pair, R, mode, q, scale(-1.0 / d, dR), d, slope_floor, counts, events)


@kernel
def to_valley_floor(pair, R, p, mode, trial):
    """A trial's parameters corrected in the stiff directions, and its jets."""
    jet_a, jet_b = pair_jets(pair, R, p, mode, trial)
    for _ in range(VALLEY_STEPS):
        g = gradient(projection_errors(jet_a, jet_b))
        step = stiff_step(jet_a, jet_b, g, hessian(jet_a, jet_b))
        s = walk_pair(pair, mode, trial, step)[0]
        trial = (
            trial[0] + s * step[0],
            trial[1] + s * step[1],
            trial[2] + s * step[2],
            trial[3] + s * step[3],
        )
        jet_a, jet_b = pair_jets(pair, R, p, mode, trial)
    return trial, jet_a, jet_b


@kernel
def line_search(pair, R, p, mode, q, step, flat, s, E, descent, noise):
    """Halve s until Armijo's rule holds: (s, ok, on_step, parameters, jet_a, jet_b).

    `flat` says that H has a flat direction: a trial that fails may then have left a valley's
    floor, and is brought back to it before it is judged again (on_step False).
    """
    for halving in range(MAX_HALVINGS + 1):
        trial = (
            q[0] + s * step[0],
            q[1] + s * step[1],
            q[2] + s * step[2],
            q[3] + s * step[3],
        )
        jet_a, jet_b = pair_jets(pair, R, p, mode, trial)
        enough = E + ARMIJO * s * descent + noise
        if energy(jet_a, jet_b) <= enough:
            return s, True, True, trial, jet_a, jet_b
        if flat:
            trial, jet_a, jet_b = to_valley_floor(pair, R, p, mode, trial)
            if energy(jet_a, jet_b) <= enough:
                return s, True, False, trial, jet_a, jet_b
        if halving < MAX_HALVINGS:
            s *= 0.5
    return s, False, True, trial, jet_a, jet_b


@kernel
def correction(jet_a, jet_b, p, v, w, g, span, w_ff, counts):
    """(step, g.step, flat, sharp): the Newton step; w_ff gets the feedforward of the same
    factorisation.

    flat is 1 where H has a flat direction, sharp tells one that is curved as beside a crease.
    """
    H = hessian(jet_a, jet_b)
    g_t = gradient(feedforward(jet_a, jet_b, ORIGIN, ORIGIN, ORIGIN, p, v, w))
    step, forward, _, regularised, flat, sharp = law(jet_a, jet_b, g, H, g_t, span)
    w_ff[0], w_ff[1], w_ff[2], w_ff[3] = forward
    counts[EVALUATIONS] += 1
    counts[REGULARISED] += regularised
    descent = g[0] * step[0] + g[1] * step[1] + g[2] * step[2] + g[3] * step[3]
    return step, descent, flat, sharp


@kernel
def advance(pair, R, p, mode, q, step, flat, E, descent, noise, last_smooth, counts, events):
    """Walk a step as far as the boundaries and Armijo's rule let it; hold a boundary reached.

    Returns (ok, held, changed, last_smooth, jet_a, jet_b): held where a boundary was reached,
    changed where the parameters are now another mode's or chart's.
    """
    reach, body, hit, index, t = walk_pair(pair, mode, q, step)
    s, ok, on_step, trial, jet_a, jet_b = line_search(
        pair, R, p, mode, q, step, flat, reach, E, descent, noise
    )
    if not ok:
        return False, False, False, last_smooth, jet_a, jet_b
    counts[CORRECTIONS] += 1
    q[0], q[1], q[2], q[3] = trial
    held = hit != NO_HIT and s == reach and on_step
    if held:
        last_smooth = take_hit(pair, mode, q, body, hit, index, t, last_smooth, s, counts, events)
        changed = True
    else:
        last_smooth = NO_EDGE
        changed = recentre(pair, mode, q, counts)
    if changed:
        jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    return True, held, changed, last_smooth, jet_a, jet_b


@shared
def settle(pair, R, p, v, w, mode, q, w_ff, least, tolerance, counts, events):
    """Descend to a stationary point of the automaton from (mode, q), changed in place.

    At least `least` corrections are made (a float: every literal int would compile once more);
    after that a slope of E below tolerance |dR| (or roundoff) is stationary. (v, w) is B's twist
    in A's frame; w_ff gets the feedforward of the last evaluation. Returns (STATIONARY | EXHAUSTED
    | CONTACT, fresh, jet_a, jet_b): fresh tells whether w_ff belongs to the final mode, the jets
    are those of the final witness points.
    """
    corrections, stalls, polish = 0, 0, 0
    last_slope, last_release = 1e300, 1e300
    last_smooth = NO_EDGE
    tried_a, tried_b = NONE_TRIED, NONE_TRIED
    fresh = False
    jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    for _ in range(MAX_ITERATIONS):
        dR = sub(jet_a[0], jet_b[0])
        d = norm(dR)
        span = pair_span(pair, p, d)
        if d <= TOUCHING * span:
            return CONTACT, fresh, jet_a, jet_b
        if counts[EVALUATIONS] >= counts[LIMIT]:
            return EXHAUSTED, fresh, jet_a, jet_b
        E = 0.5 * d * d
        noise = ENERGY_NOISE * EPS * span * d
        g = gradient(projection_errors(jet_a, jet_b))
        slope = gradient_norm(jet_a, jet_b, g)
        floor = max(AT_REST * EPS * span, tolerance * d)
        if slope > 0.0 and (slope > floor or corrections < least):
            step, descent, flat, sharp = correction(jet_a, jet_b, p, v, w, g, span, w_ff, counts)
            fresh = True
            in_noise = -0.5 * descent <= noise
            polish += in_noise
            # beside a crease E is noise for orders of magnitude, and the slope is not
            most = SHARP_POLISH if sharp and slope > SLOPE * d else MAX_POLISH
            if not (in_noise and polish > most and slope > POLISH_RATIO * last_slope):
                ok, held, changed, last_smooth, jet_a_new, jet_b_new = advance(
                    pair, R, p, mode, q, step, flat, E, descent, noise, last_smooth, counts, events
                )
                last_slope = slope
                if ok:
                    jet_a, jet_b = jet_a_new, jet_b_new
                    corrections += 1
                    fresh = not changed
                    if held:
                        polish, last_slope = 0, 1e300
                    continue
        # Stationary, or no step lowers E: test the switching functions.
        if last_release - noise < E:
            stalls += 1
            if stalls > MAX_STALLS:
                return STATIONARY, fresh, jet_a, jet_b
        else:
            tried_a, tried_b = NONE_TRIED, NONE_TRIED
        last_release = E
        # a slope below the residual's own is not known to be one
        slope_floor = max(SLOPE, max(SLOPE_NOISE * EPS * span, slope) / d)
        n = scale(-1.0 / d, dR)
        released, tried_a, tried_b = release_next(
            pair, R, mode, q, n, d, slope_floor, tried_a, tried_b, counts, events
        )
        if not released:
            return STATIONARY, fresh, jet_a, jet_b
        polish, last_slope, fresh = 0, 1e300, False
        jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    return EXHAUSTED, fresh, jet_a, jet_b
