"""One frame of the paper's law: integrate, saturate, switch; with the variants that it prints."""

from standoff.kernels.compiling import kernel, shared
from standoff.kernels.descent import (
    NO_EDGE,
    pair_jets,
    recentre,
    release_pair,
    take_hit,
    walk_pair,
)
from standoff.kernels.events import CHART_CHANGES, CORRECTIONS, EVENTS, SATURATIONS
from standoff.kernels.features import pair_span
from standoff.kernels.feedback import gradient_norm
from standoff.kernels.frame import (
    ERRORS,
    FEEDBACK_PI,
    INTEGRAL,
    MODE,
    O_DATA,
    O_FEEDBACK,
    O_SATURATION,
    O_SWITCHING,
    SATURATE_ZERO,
    SWITCH_MULTIPLIERS,
    SWITCH_VORONOI,
)
from standoff.kernels.integrators import N_CHANGES, integrate
from standoff.kernels.system import gradient, projection_errors
from standoff.kernels.tolerances import (
    EPS,
    MAX_VORONOI_PASSES,
    SLOPE,
    SLOPE_NOISE,
    TOUCHING,
    WOUND_UP,
)
from standoff.kernels.trimming import HIT_LIMIT, NO_HIT, walk
from standoff.kernels.vectors import norm, rotate_back, sub
from standoff.kernels.voronoi import voronoi_switch


@kernel
def apply_step(pair, mode, q, dq, counts, events):
    """Walk dq until a boundary, and hold that boundary."""
    step = (dq[0], dq[1], dq[2], dq[3])
    s, body, hit, index, t = walk_pair(pair, mode, q, step)
    for k in range(4):
        q[k] += s * dq[k]
    if hit != NO_HIT:
        take_hit(pair, mode, q, body, hit, index, t, NO_EDGE, s, counts, events)
    else:
        recentre(pair, mode, q, counts)


@kernel
def zeroed_step(pair, mode, q, dq, counts, events):
    """The paper's saturation: a component that leads out of its feature is zeroed after the solve.

    Each parameter goes by itself as far as its feature lets it; no feature is left.
    """
    ia, ra, ib, rb = pair
    for k in range(4):
        body = k // 2
        ints, reals = (ia, ra) if body == 0 else (ib, rb)
        first = k % 2 == 0
        feature, chart = mode[2 * body], mode[2 * body + 1]
        a, b = q[2 * body], q[2 * body + 1]
        da, db = (dq[k], 0.0) if first else (0.0, dq[k])
        s, hit, index, t = walk(ints, reals, feature, chart, a, b, da, db)
        q[k] += s * dq[k]
        if hit == HIT_LIMIT:
            take_hit(pair, mode, q, body, hit, index, t, NO_EDGE, s, counts, events)
            return
        counts[SATURATIONS] += hit != NO_HIT
    recentre(pair, mode, q, counts)


@kernel
def voronoi_passes(pair, R, p, mode, q, span, counts, events):
    """Test both bodies' features against each other's witness points until none switches."""
    ia, ra, ib, rb = pair
    for _ in range(MAX_VORONOI_PASSES):
        jet_a, jet_b = pair_jets(pair, R, p, mode, q)
        if voronoi_switch(ia, ra, 0, jet_b[0], span, mode, q, counts, events):
            continue
        x = rotate_back(R, sub(jet_a[0], p))
        if not voronoi_switch(ib, rb, 1, x, span, mode, q, counts, events):
            return


@kernel
def saturate_integral(pair, R, p, options, state, mode, q, counts):
    """Keep each part of the integral within what WOUND_UP spans of error would command; those that
    are cut are counted as saturations."""
    if options[O_FEEDBACK] != FEEDBACK_PI:
        return
    jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    span = pair_span(pair, p, norm(sub(jet_a[0], jet_b[0])))
    for k in range(4):
        tangent = jet_a[1 + k] if k < 2 else jet_b[k - 1]
        most = WOUND_UP * span * norm(tangent) / options[O_DATA]
        if not abs(state[INTEGRAL + k]) <= most:
            state[INTEGRAL + k] = most if state[INTEGRAL + k] > 0.0 else -most
            counts[SATURATIONS] += 1


@kernel
def drop_unbounded(change, counts):
    """A frame whose integration overflows changes nothing, and counts as saturated."""
    total = 0.0
    for k in range(N_CHANGES):
        total += 0.0 * change[k]  # NaN from an infinite or no number
    if total != 0.0:
        for k in range(N_CHANGES):
            change[k] = 0.0
        counts[SATURATIONS] += 1


@kernel
def remember(pair, R, p, options, state, mode, q, change, saturated, moved, counts):
    """Carry the integrated errors and their integral over the frame.

    Where a switch, a change of chart or a saturation has `moved` them the errors are read anew
    from Eqs. (1)-(4). The integral waits in a frame that is `saturated`, or it would wind up; that
    of a body whose feature or chart has changed begins again.
    """
    for k in range(4):
        state[ERRORS + k] += change[4 + k]
        if not saturated:
            state[INTEGRAL + k] += change[8 + k]
    for body in range(2):
        at = 2 * body
        if state[MODE + at] != mode[at] or state[MODE + at + 1] != mode[at + 1]:
            moved = True
            state[INTEGRAL + at] = 0.0
            state[INTEGRAL + at + 1] = 0.0
    saturate_integral(pair, R, p, options, state, mode, q, counts)
    if moved:
        read_errors(pair, R, p, state, mode, q)


@kernel
def read_errors(pair, R, p, state, mode, q):
    """The integrated errors, set to those of Eqs. (1)-(4)."""
    jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    psi = projection_errors(jet_a, jet_b)
    for k in range(4):
        state[ERRORS + k] = psi[k]


@shared
def paper_frame(pair, before, motion, state, options, h, mode, q, counts, events, change):
    """Integrate w = -M⁻¹(v(Psi) + b) from the frame before to this one, then switch.

    before and motion are (R, p, v, w) of B in A's frame at the frame before and at this one.
    """
    integrate(pair, before, motion, h, options, state, mode, q, counts, change)
    drop_unbounded(change, counts)
    counts[CORRECTIONS] += 1
    if options[O_SATURATION] == SATURATE_ZERO:
        zeroed_step(pair, mode, q, change, counts, events)
    else:
        apply_step(pair, mode, q, change, counts, events)
    R, p, _, _ = motion
    jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    dR = sub(jet_a[0], jet_b[0])
    d = norm(dR)
    span = pair_span(pair, p, d)
    if d > TOUCHING * span and options[O_SWITCHING] == SWITCH_MULTIPLIERS:
        # released before it is at rest, a feature is taken back and given up for ever: a slope
        # must exceed the residual's own
        slope = gradient_norm(jet_a, jet_b, gradient(projection_errors(jet_a, jet_b)))
        floor = max(SLOPE, max(SLOPE_NOISE * EPS * span, slope) / d)
        release_pair(pair, R, mode, q, dR, floor, counts, events)
    elif options[O_SWITCHING] == SWITCH_VORONOI:
        voronoi_passes(pair, R, p, mode, q, span, counts, events)
    saturated = counts[SATURATIONS] > 0
    moved = saturated or counts[CHART_CHANGES] + counts[EVENTS] > 0
    remember(pair, R, p, options, state, mode, q, change, saturated, moved, counts)
