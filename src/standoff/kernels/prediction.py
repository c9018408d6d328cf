"""The warm start: what a frame keeps for the next one, and the prediction made from it."""

from standoff.kernels import layout as L
from standoff.kernels.compiling import kernel
from standoff.kernels.features import chart_jet, chart_record
from standoff.kernels.feedback import metric_inverse
from standoff.kernels.frame import (
    CUT,
    DEADLINE,
    HAS_TWIST,
    HISTORY,
    INSIDE,
    LAST_BOUND,
    LAST_DISTANCE,
    LAST_NORMAL,
    LAST_RATE,
    LAST_STEP,
    LOST,
    MODE,
    NOT_CERTIFIED,
    O_PREDICTOR,
    OVERLAPPING,
    POSE,
    PREDICT_FEEDFORWARD,
    PREDICT_FEEDFORWARD_2,
    PREDICT_NONE,
    RATE,
    TIME,
    TWIST,
    Q,
)
from standoff.kernels.jets import chart_parameters
from standoff.kernels.vectors import axpy, dot, scale


@kernel
def predict(state, options, h, dq):
    """dq = h w: feedforward, its two-step Adams-Bashforth blend, or the secant of two frames."""
    n = int(state[HISTORY])
    kind = options[O_PREDICTOR]
    for k in range(4):
        dq[k] = 0.0
    if kind == PREDICT_NONE or n == 0:
        return
    ratio = 0.0
    if kind == PREDICT_FEEDFORWARD_2 and n == 2:
        ratio = 0.5 * h / state[LAST_STEP]
    for k in range(4):
        dq[k] = h * ((1.0 + ratio) * state[RATE + k] - ratio * state[LAST_RATE + k])


@kernel
def carry_over(pair, state, mode):
    """Move the last frame's parameters and rates into this frame's charts. False where a feature
    has changed: then they say nothing of the new one."""
    if state[MODE] != mode[0] or state[MODE + 2] != mode[2]:
        return False
    for body in range(2):
        ints, reals = (pair[0], pair[1]) if body == 0 else (pair[2], pair[3])
        old, new = int(state[MODE + 2 * body + 1]), mode[2 * body + 1]
        if old == new:
            continue
        at = 2 * body
        jet = chart_jet(ints, reals, old, state[Q + at], state[Q + at + 1])
        moved = axpy(state[RATE + at], jet[1], scale(state[RATE + at + 1], jet[2]))
        r = chart_record(ints, new)
        u, v, depth = chart_parameters(reals, ints[r + L.CHART_REALS], jet[0])
        if depth <= 0.0:
            return False
        jet = chart_jet(ints, reals, new, u, v)
        i = metric_inverse(jet[1], jet[2])
        a, b = i[0] * dot(jet[1], moved), i[1] * dot(jet[1], moved) + i[2] * dot(jet[2], moved)
        state[Q + at], state[Q + at + 1] = u, v
        state[RATE + at], state[RATE + at + 1] = i[0] * a + i[1] * b, i[2] * b
    return True


@kernel
def keep(state, motion, has_twist, options, h, mode, q, w_ff, same, status, query, inside):
    """Write the state after a frame. `same`: the rates of two frames belong to one mode."""
    R, p, v, w = motion
    feed = has_twist and options[O_PREDICTOR] >= PREDICT_FEEDFORWARD
    if feed:
        two = same and state[HISTORY] >= 1.0 and state[HAS_TWIST] == 1.0
        for k in range(4):
            state[LAST_RATE + k] = state[RATE + k]
            state[RATE + k] = w_ff[k]
        state[HISTORY] = 2.0 if two else 1.0
    else:
        state[HISTORY] = 0.0
        # points cut off on their way have no rate
        if same and h > 0.0 and status != DEADLINE:
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
    d, bound, _, n = query
    for k in range(3):
        state[LAST_NORMAL + k] = n[k]
    state[LAST_DISTANCE] = d
    state[LAST_BOUND] = bound
    state[INSIDE] = 1.0 if inside else 0.0
    state[LOST] = 1.0 if status in (OVERLAPPING, NOT_CERTIFIED) else 0.0
    state[CUT] = state[CUT] + 1.0 if status == DEADLINE else 0.0
