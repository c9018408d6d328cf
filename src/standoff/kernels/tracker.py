"""One frame of the hybrid tracker, in both laws, on flat arrays.

The state goes in and comes out as one float64 array, so that it is a value. All its parts are in
A's frame. A step answers for the poses it is given.
"""

from math import inf

import numpy as np

from standoff.kernels import layout as L
from standoff.kernels.certificate import certify
from standoff.kernels.cold_start import (
    CERTIFIED,
    TOUCHING_OR_OVERLAPPING,
    UNCERTIFIED,
    global_query,
)
from standoff.kernels.compiling import kernel
from standoff.kernels.descent import (
    CORRECTIONS,
    EVENTS,
    N_COUNTS,
    RESTARTS,
    pair_jets,
    recentre,
    release_pair,
    settle,
    take_hit,
    walk_pair,
)
from standoff.kernels.feedback import gradient_norm
from standoff.kernels.integrators import integrate, law_at
from standoff.kernels.rigid import (
    mean_twist,
    read_rotation,
    read_vector,
    relative_pose,
    relative_twist,
)
from standoff.kernels.system import gradient, projection_errors
from standoff.kernels.tolerances import EPS, MAX_ITERATIONS, ROTATION, SLOPE, SLOPE_NOISE, TOUCHING
from standoff.kernels.trimming import NO_HIT
from standoff.kernels.vectors import add, axpy, cross, dot, norm, rotate, scale, sub

# State.
MODE = 0  # feature_a, chart_a, feature_b, chart_b
Q = 4  # u, v, r, s
RATE = 8  # feedforward w_ff of this frame, or the secant's
LAST_RATE = 12  # that of the frame before
LAST_STEP = 16  # time from the frame before to this one
HISTORY = 17  # how many of RATE, LAST_RATE are valid
POSE = 18  # R (9, row-major), p (3)
TWIST = 30  # v, w
HAS_TWIST = 36  # 1 where RATE is a feedforward, 0 where it is a secant
TIME = 37
LOST = 38  # 1 where the last frame had no certified witness points: start globally
N_STATE = 39

# Options.
LAW_PC, LAW_PAPER = 0, 1
PREDICT_NONE, PREDICT_SECANT, PREDICT_FEEDFORWARD, PREDICT_FEEDFORWARD_2 = range(4)
O_LAW, O_PREDICTOR, O_INTEGRATOR, O_GAIN, O_TOLERANCE = range(5)
N_OPTIONS = 5

# Output.
DISTANCE, LOWER_BOUND = 0, 1
POINT_A, POINT_B, NORMAL = 2, 5, 8
OUT_MODE, OUT_Q = 11, 15
OUT_RATE, VELOCITY_A, VELOCITY_B, RESIDUAL, STATUS = 19, 20, 23, 26, 27
OUT_COUNTS = 28
N_OUT = OUT_COUNTS + N_COUNTS

# Status numbers, those of standoff.tracking.Status.
CONVERGED, TRACKING, OVERLAPPING, NOT_CERTIFIED = range(4)

MAX_EVENTS = 64


@kernel
def is_rotation(T):
    """Finite, orthonormal to ROTATION and not mirrored."""
    for i in range(3):
        for j in range(i, 3):
            total = 0.0
            for k in range(3):
                total += T[3 * i + k] * T[3 * j + k]
            if not abs(total - (1.0 if i == j else 0.0)) <= ROTATION:
                return False
    third = cross(read_vector(T, 0), read_vector(T, 3))
    return (
        dot(third, read_vector(T, 6)) > 0.0
        and T[9] + T[10] + T[11] < inf
        and (T[9] + T[10] + T[11] > -inf)
    )


@kernel
def bad_rotations(Ta, Tb):
    if not is_rotation(Ta):
        return 1
    return 0 if is_rotation(Tb) else 2


@kernel
def predict(state, options, h, dq):
    """dq = h w: feedforward, its two-step Adams-Bashforth blend, or the secant of two frames."""
    n = int(state[HISTORY])
    kind = options[O_PREDICTOR]
    dq[:] = 0.0
    if kind == PREDICT_NONE or n == 0:
        return
    ratio = 0.0
    if kind == PREDICT_FEEDFORWARD_2 and n == 2 and state[HAS_TWIST] == 1.0:
        ratio = 0.5 * h / state[LAST_STEP]
    for k in range(4):
        dq[k] = h * ((1.0 + ratio) * state[RATE + k] - ratio * state[LAST_RATE + k])


@kernel
def apply_step(pair, mode, q, dq, counts, events):
    """Walk dq until a boundary, and hold that boundary. True where the whole step fitted."""
    step = (dq[0], dq[1], dq[2], dq[3])
    s, body, hit, index, t = walk_pair(pair, mode, q, step)
    for k in range(4):
        q[k] += s * dq[k]
    if hit != NO_HIT:
        take_hit(pair, mode, q, body, hit, index, t, -1, s, counts, events)
        return False
    return recentre(pair, mode, q, counts) == 0


@kernel
def pc_frame(pair, R, p, v, w, state, options, h, mode, q, w_ff, counts, events, dq):
    """Predict with the feedforward, then one Newton correction, more where a mode changes.

    The correction is the paper's feedback under Euler with K h = 1. Returns whether w_ff
    belongs to the final mode.
    """
    predict(state, options, h, dq)
    apply_step(pair, mode, q, dq, counts, events)
    _, fresh = settle(
        pair, R, p, v, w, mode, q, w_ff, 1, options[O_TOLERANCE], MAX_ITERATIONS, counts, events
    )
    return fresh


@kernel
def paper_frame(pair, R, p, v, w, state, options, h, mode, q, counts, events, dq):
    """Integrate w = -M⁻¹(K Psi + b) from the frame before to this one, then switch."""
    before = (
        read_rotation(state[POSE : POSE + 9]),
        read_vector(state, POSE + 9),
        read_vector(state, TWIST),
        read_vector(state, TWIST + 3),
    )
    forward = 0.0 if options[O_PREDICTOR] == PREDICT_NONE else 1.0
    integrate(
        pair,
        before,
        (R, p, v, w),
        h,
        options[O_GAIN],
        forward,
        int(options[O_INTEGRATOR]),
        mode,
        q,
        counts,
        dq,
    )
    counts[CORRECTIONS] += 1
    apply_step(pair, mode, q, dq, counts, events)
    jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    dR = sub(jet_a[0], jet_b[0])
    d = norm(dR)
    span = pair[1][L.SIZE] + pair[3][L.SIZE] + d
    if d > TOUCHING * span:
        floor = max(SLOPE, SLOPE_NOISE * EPS * span / d)
        release_pair(pair, R, mode, q, dR, floor, counts, events)


@kernel
def erase_loops(events, n, body, start, end):
    """Keep of one body's events the loop-free path from start to end; mark the others with -1.

    A prediction may cross a boundary and the correction come back: that is no event.
    """
    last = -1
    for k in range(n):
        if events[k, 0] != body:
            continue
        if events[k, 2] == start:  # back where the frame began
            for m in range(k + 1):
                if events[m, 0] == body:
                    events[m, 0] = -1.0
            continue
        for m in range(k):
            if events[m, 0] == body and events[m, 2] == events[k, 2]:
                for i in range(m + 1, k + 1):
                    if events[i, 0] == body:
                        events[i, 0] = -1.0
                break
    at = start
    broken = False
    for k in range(n):
        if events[k, 0] == body:
            broken = broken or events[k, 1] != at
            at = events[k, 2]
            last = k
    if at == end and not broken:
        return
    # the path was cut by a restart: one event from start to end
    for k in range(n):
        if events[k, 0] == body:
            events[k, 0] = -1.0
    if start != end and n > 0:
        k = last if last >= 0 else 0
        if last < 0:
            for m in range(n):
                if events[m, 0] == -1.0:
                    k = m
                    break
        events[k, 0] = body
        events[k, 1] = start
        events[k, 2] = end
        events[k, 3] = np.nan
        events[k, 4] = np.nan


@kernel
def tidy_events(events, counts, old_a, old_b, new_a, new_b):
    """Net events of the frame, packed to the front of the log; their number into the counts."""
    n = min(counts[EVENTS], events.shape[0])
    erase_loops(events, n, 0, old_a, new_a)
    erase_loops(events, n, 1, old_b, new_b)
    kept = 0
    for k in range(n):
        if events[k, 0] >= 0.0:
            for j in range(events.shape[1]):
                events[kept, j] = events[k, j]
            kept += 1
    counts[EVENTS] = kept


@kernel
def write_output(pair, Ta, Tb, R, p, v, w, xi_a, has_twist, mode, q, w_ff, d, bound, n, out):
    """Answer in world axes: witness points, normal, rates; d and bound are those of the cores."""
    ia, ra, ib, rb = pair
    Ra, origin = read_rotation(Ta), read_vector(Ta, 9)
    jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    n_w = rotate(Ra, n)
    radius_a, radius_b = ra[L.RADIUS], rb[L.RADIUS]
    x_a = add(rotate(Ra, axpy(radius_a, n, jet_a[0])), origin)
    x_b = add(rotate(Ra, axpy(-radius_b, n, jet_b[0])), origin)
    out[DISTANCE] = d - radius_a - radius_b
    out[LOWER_BOUND] = bound - radius_a - radius_b
    for k in range(3):
        out[POINT_A + k] = x_a[k]
        out[POINT_B + k] = x_b[k]
        out[NORMAL + k] = n_w[k]
    for k in range(4):
        out[OUT_MODE + k] = mode[k]
        out[OUT_Q + k] = q[k]
    out[RESIDUAL] = gradient_norm(jet_a, jet_b, gradient(projection_errors(jet_a, jet_b)))
    if not has_twist:
        for k in range(OUT_RATE, RESIDUAL):
            out[k] = np.nan
        return
    # rates in A's frame: A at rest, so V_A is added in world afterwards
    slide_a = axpy(w_ff[0], jet_a[1], scale(w_ff[1], jet_a[2]))
    carried = add(v, cross(w, sub(jet_b[0], p)))
    move_b = add(carried, axpy(w_ff[2], jet_b[1], scale(w_ff[3], jet_b[2])))
    turn = sub(move_b, slide_a)
    n_rate = scale(1.0 / d, axpy(-dot(turn, n), n, turn)) if d > 0.0 else (0.0, 0.0, 0.0)
    v_a, w_a = read_vector(xi_a, 0), read_vector(xi_a, 3)
    u_a = rotate(Ra, axpy(radius_a, n_rate, slide_a))
    u_b = rotate(Ra, axpy(-radius_b, n_rate, move_b))
    u_a = add(u_a, add(v_a, cross(w_a, sub(x_a, origin))))
    u_b = add(u_b, add(v_a, cross(w_a, sub(x_b, origin))))
    out[OUT_RATE] = dot(n, carried)
    for k in range(3):
        out[VELOCITY_A + k] = u_a[k]
        out[VELOCITY_B + k] = u_b[k]


@kernel
def judge(pair, law_kind, outcome, d, bound, tolerance):
    """Status of an answer by its certificate."""
    radii = pair[1][L.RADIUS] + pair[3][L.RADIUS]
    size = pair[1][L.SIZE] + pair[3][L.SIZE] + radii
    if outcome == TOUCHING_OR_OVERLAPPING or (outcome == CERTIFIED and d <= radii):
        return OVERLAPPING
    if bound > radii and d - bound <= tolerance * (size + d):
        return CONVERGED
    if law_kind == LAW_PAPER:
        return TRACKING
    return NOT_CERTIFIED


@kernel
def finish(
    pair,
    Ta,
    Tb,
    R,
    p,
    v,
    w,
    xi_a,
    has_twist,
    h,
    options,
    state,
    mode,
    q,
    w_ff,
    fresh,
    status,
    d,
    bound,
    normal,
    counts,
    out,
):
    """Write the state after the frame and the answer."""
    feed = has_twist and options[O_PREDICTOR] >= PREDICT_FEEDFORWARD
    same = fresh
    for k in range(4):
        same = same and state[MODE + k] == mode[k]
    history = state[HISTORY]
    if feed:
        for k in range(4):
            state[LAST_RATE + k] = state[RATE + k]
            state[RATE + k] = w_ff[k]
        state[HISTORY] = 2.0 if same and history >= 1.0 and state[HAS_TWIST] == 1.0 else 1.0
    else:
        # secant of the last two frames in one mode; a period never lies between two frames
        state[HISTORY] = 0.0
        if same and h > 0.0:
            for k in range(4):
                state[RATE + k] = (q[k] - state[Q + k]) / h
            state[HISTORY] = 1.0
    for k in range(4):
        state[MODE + k] = mode[k]
        state[Q + k] = q[k]
    for k in range(9):
        state[POSE + k] = R[k]
    for k in range(3):
        state[POSE + 9 + k] = p[k]
        state[TWIST + k] = v[k]
        state[TWIST + 3 + k] = w[k]
    state[HAS_TWIST] = 1.0 if feed else 0.0
    state[LAST_STEP] = h
    state[TIME] += h
    state[LOST] = 1.0 if status == OVERLAPPING or status == NOT_CERTIFIED else 0.0
    write_output(pair, Ta, Tb, R, p, v, w, xi_a, has_twist, mode, q, w_ff, d, bound, normal, out)
    out[STATUS] = status
    if status == OVERLAPPING:
        # until penetration is tracked an overlapping pair has no number
        for k in range(RESIDUAL + 1):
            if k < OUT_MODE or k >= OUT_RATE:
                out[k] = np.nan
    for k in range(N_COUNTS):
        out[OUT_COUNTS + k] = counts[k]


@kernel
def start(pair, Ta, Tb, xi_a, xi_b, has_twist, options, state, given, out):
    """Begin at a pose: globally, or (`given` 1) by descent from the state's own mode, or there
    as it stands (`given` 2). Returns 0, or the rotation that is none: 1 for A, 2 for B."""
    bad = bad_rotations(Ta, Tb)
    if bad != 0:
        return bad
    mode = np.zeros(4, dtype=np.int64)
    q, w_ff = np.zeros(4), np.zeros(4)
    counts = np.zeros(N_COUNTS, dtype=np.int64)
    events = np.zeros((0, 5))
    R, p = relative_pose(Ta, Tb)
    v, w = relative_twist(Ta, Tb, xi_a, xi_b)
    tolerance = options[O_TOLERANCE]
    goal = min(tolerance, 1e-6)
    outcome, d, bound, normal = UNCERTIFIED, 0.0, -1.0, (0.0, 0.0, 0.0)
    if given:
        for k in range(4):
            mode[k] = int(state[MODE + k])
            q[k] = state[Q + k]
        if given == 1:
            settle(pair, R, p, v, w, mode, q, w_ff, 0, 0.0, MAX_ITERATIONS, counts, events)
        outcome, d, bound, normal = weigh(pair, R, p, mode, q, goal)
    if outcome == UNCERTIFIED and given != 2:
        if given == 1:
            counts[RESTARTS] += 1
        outcome, d, bound, normal = global_query(pair, R, p, mode, q, goal, counts, events)
    status = judge(pair, LAW_PAPER if given == 2 else LAW_PC, outcome, d, bound, goal)
    if has_twist and d > 0.0:
        _, forward, _, _ = law_at(pair, R, p, v, w, mode, q, 1.0, counts)
        for k in range(4):
            w_ff[k] = forward[k]
    state[:] = 0.0
    counts[EVENTS] = 0
    finish(
        pair,
        Ta,
        Tb,
        R,
        p,
        v,
        w,
        xi_a,
        has_twist,
        0.0,
        options,
        state,
        mode,
        q,
        w_ff,
        False,
        status,
        d,
        bound,
        normal,
        counts,
        out,
    )
    return 0


@kernel
def weigh(pair, R, p, mode, q, tolerance):
    """(outcome, d, bound, normal) of the witness points at (mode, q)."""
    jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    d, bound, normal = certify(pair, R, p, mode, q, jet_a[0], jet_b[0])
    size = pair[1][L.SIZE] + pair[3][L.SIZE]
    if bound > 0.0 and d - bound <= tolerance * (size + d):
        return CERTIFIED, d, bound, normal
    if bound <= 0.0 and d <= TOUCHING * (size + d):
        return TOUCHING_OR_OVERLAPPING, d, bound, normal
    return UNCERTIFIED, d, bound, normal


@kernel
def step(pair, Ta, Tb, xi_a, xi_b, has_twist, h, options, state, out, events):
    """One frame: the state array is changed in place, the answer written to `out`.

    Returns 0; or, with nothing changed, the rotation that is none: 1 for A, 2 for B.
    """
    bad = bad_rotations(Ta, Tb)
    if bad != 0:
        return bad
    mode = np.empty(4, dtype=np.int64)
    q, w_ff, dq = np.empty(4), np.zeros(4), np.zeros(4)
    counts = np.zeros(N_COUNTS, dtype=np.int64)
    for k in range(4):
        mode[k] = int(state[MODE + k])
        q[k] = state[Q + k]
    old_a, old_b = mode[0], mode[2]
    R, p = relative_pose(Ta, Tb)
    if has_twist:
        v, w = relative_twist(Ta, Tb, xi_a, xi_b)
    else:
        before = read_rotation(state[POSE : POSE + 9])
        v, w = mean_twist(before, read_vector(state, POSE + 9), R, p, h)
    tolerance = options[O_TOLERANCE]
    paper = options[O_LAW] == LAW_PAPER
    fresh = False
    if state[LOST] == 1.0:
        counts[RESTARTS] += 1
        outcome, d, bound, normal = global_query(pair, R, p, mode, q, tolerance, counts, events)
    elif paper:
        paper_frame(pair, R, p, v, w, state, options, h, mode, q, counts, events, dq)
        outcome, d, bound, normal = weigh(pair, R, p, mode, q, tolerance)
    else:
        fresh = pc_frame(pair, R, p, v, w, state, options, h, mode, q, w_ff, counts, events, dq)
        outcome, d, bound, normal = weigh(pair, R, p, mode, q, tolerance)
        if outcome == UNCERTIFIED:
            _, fresh = settle(
                pair, R, p, v, w, mode, q, w_ff, 1, 0.0, MAX_ITERATIONS, counts, events
            )
            outcome, d, bound, normal = weigh(pair, R, p, mode, q, tolerance)
        if outcome == UNCERTIFIED:
            counts[RESTARTS] += 1
            fresh = False
            outcome, d, bound, normal = global_query(pair, R, p, mode, q, tolerance, counts, events)
    status = judge(pair, options[O_LAW], outcome, d, bound, tolerance)
    if not fresh and has_twist and d > 0.0:
        _, forward, _, _ = law_at(pair, R, p, v, w, mode, q, 1.0, counts)
        for k in range(4):
            w_ff[k] = forward[k]
    if counts[EVENTS] > 0 or old_a != mode[0] or old_b != mode[2]:
        tidy_events(events, counts, old_a, old_b, mode[0], mode[2])
    finish(
        pair,
        Ta,
        Tb,
        R,
        p,
        v,
        w,
        xi_a,
        has_twist,
        h,
        options,
        state,
        mode,
        q,
        w_ff,
        fresh,
        status,
        d,
        bound,
        normal,
        counts,
        out,
    )
    return 0


@kernel
def run(pair, poses_a, poses_b, twists_a, twists_b, has_twist, steps, options, state, outs, events):
    """Many frames in one compiled loop; row k of `outs` answers for row k of the poses."""
    for k in range(poses_a.shape[0]):
        bad = step(
            pair,
            poses_a[k],
            poses_b[k],
            twists_a[k],
            twists_b[k],
            has_twist,
            steps[k],
            options,
            state,
            outs[k],
            events,
        )
        if bad != 0:
            return k, bad
    return -1, 0
