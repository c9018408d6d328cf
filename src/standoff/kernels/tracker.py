"""One frame of the hybrid tracker, in both laws, on flat arrays.

The state goes in and comes out as one float64 array, so that it is a value. A step answers for
the poses it is given.
"""

import numpy as np

from standoff.kernels.answer import judge, write_answer
from standoff.kernels.certified import CERTIFIED, UNCERTIFIED, settle_and_weigh, weigh
from standoff.kernels.compiling import kernel, pointer
from standoff.kernels.contact import contact_rates
from standoff.kernels.descent import ORIGIN, pair_jets
from standoff.kernels.events import (
    EVALUATIONS,
    EVENT_COLUMNS,
    EVENTS,
    LIMIT,
    MAX_EVENTS,
    N_COUNT_SLOTS,
    N_COUNTS,
    NO_LIMIT,
    RESTARTS,
    tidy_events,
)
from standoff.kernels.frame import (
    FINE,
    LAW_PAPER,
    LAW_PC,
    MODE,
    N_OUT,
    N_STATE,
    O_DEADLINE,
    O_LAW,
    O_TOLERANCE,
    OUT_COUNTS,
    POSE,
    START_ANYWHERE,
    START_HERE,
    refusal,
)
from standoff.kernels.integrators import N_CHANGES, NONE, rates_at
from standoff.kernels.paper_law import read_errors
from standoff.kernels.prediction import carry_over, keep
from standoff.kernels.rigid import (
    mean_twist,
    read_rotation,
    read_vector,
    relative_pose,
    relative_twist,
)
from standoff.kernels.tolerances import START_GAP
from standoff.kernels.track import anywhere, from_state, track


@kernel
def feedforward_now(pair, options, motion, mode, q, w_ff, counts):
    """w_ff at the final witness points, where no evaluation of the frame belongs to them."""
    rates, _, _, _ = rates_at(pair, options, motion, mode, q, NONE, NONE, 0.0, 1.0, counts)
    for k in range(4):
        w_ff[k] = rates[k]


@kernel
def start_frame(
    pair, Ta, Tb, xi_a, xi_b, has_twist, options, state, given, out, mode, q, w_ff, counts, events
):
    R, p = relative_pose(Ta, Tb)
    v, w = relative_twist(Ta, Tb, xi_a, xi_b)
    motion = (R, p, v, w)
    goal = min(options[O_TOLERANCE], START_GAP)
    outcome, d, bound, normal = UNCERTIFIED, 0.0, -1.0, (0.0, 0.0, 0.0)
    inside, n_rate = False, ORIGIN
    counts[LIMIT] = NO_LIMIT  # a start has no deadline
    if given != START_ANYWHERE:
        from_state(state, mode, q)
        if given == START_HERE:
            jet_a, jet_b = pair_jets(pair, R, p, mode, q)
            outcome, d, bound, normal = weigh(pair, R, p, mode, q, jet_a, jet_b, ORIGIN, goal)
        else:
            _, outcome, d, bound, normal = settle_and_weigh(
                pair, R, p, v, w, mode, q, w_ff, 0.0, 0.0, goal, counts, events
            )
    upper = d
    if outcome != CERTIFIED and given != START_HERE:
        counts[RESTARTS] += 0 if given == START_ANYWHERE else 1
        outcome, d, bound, upper, normal, inside = anywhere(
            pair, R, p, options, goal, 0.0, mode, q, w_ff, counts, events
        )
    kind = LAW_PAPER if given == START_HERE else LAW_PC
    status = judge(pair, kind, outcome, p, d, bound, upper, goal, False)
    jets = pair_jets(pair, R, p, mode, q)
    if inside:
        n_rate = contact_rates(pair, motion, jets, normal, d, w_ff, counts)
    elif has_twist and d > 0.0:
        feedforward_now(pair, options, motion, mode, q, w_ff, counts)
    for k in range(N_STATE):
        state[k] = 0.0
    if options[O_LAW] == LAW_PAPER:
        read_errors(pair, R, p, state, mode, q)
    counts[EVENTS] = 0
    query = (d, bound, upper, normal)
    keep(state, motion, has_twist, options, 0.0, mode, q, w_ff, False, status, query, inside)
    write_answer(
        pair, Ta, xi_a, has_twist, motion, mode, q, w_ff, jets, query, inside, n_rate, status, out
    )
    for k in range(N_COUNTS):
        out[OUT_COUNTS + k] = counts[k]


@kernel
def pair_pointers(pair):
    return pointer(pair[0], 0), pointer(pair[1], 0), pointer(pair[2], 0), pointer(pair[3], 0)


@kernel
def start(pair, Ta, Tb, xi_a, xi_b, has_twist, options, state, given, out):
    """Begin at a pose: anywhere (a global query), by descent from the state's mode, or there.

    Returns FINE, or what of the poses and twists is refused.
    """
    refused = refusal(pointer(Ta, 0), pointer(Tb, 0), pointer(xi_a, 0), pointer(xi_b, 0))
    if refused != FINE:
        return refused
    ints, reals = np.zeros(4 + N_COUNT_SLOTS, dtype=np.int64), np.zeros(8)
    log = np.empty(MAX_EVENTS * EVENT_COLUMNS)
    start_frame(
        pair_pointers(pair),
        pointer(Ta, 0),
        pointer(Tb, 0),
        pointer(xi_a, 0),
        pointer(xi_b, 0),
        has_twist,
        pointer(options, 0),
        pointer(state, 0),
        given,
        pointer(out, 0),
        pointer(ints, 0),
        pointer(reals, 0),
        pointer(reals, 4),
        pointer(ints, 4),
        pointer(log, 0),
    )
    ints[0], reals[0], log[0] = 0, 0.0, 0.0  # alive until here, see `pointer`
    return FINE


@kernel
def step_frame(
    pair, Ta, Tb, xi_a, xi_b, has_twist, h, options, state, out, events, mode, q, w_ff, dq, counts
):
    from_state(state, mode, q)
    for k in range(4):
        w_ff[k] = 0.0
    for k in range(N_COUNTS):
        counts[k] = 0
    counts[LIMIT] = int(options[O_DEADLINE])
    R, p = relative_pose(Ta, Tb)
    if has_twist:
        v, w = relative_twist(Ta, Tb, xi_a, xi_b)
    else:
        before = read_rotation(state, POSE)
        v, w = mean_twist(before, read_vector(state, POSE + 9), R, p, h)
    motion = (R, p, v, w)
    fresh, outcome, d, bound, upper, normal, inside = track(
        pair, motion, state, options, h, mode, q, w_ff, dq, counts, events
    )
    exhausted = counts[EVALUATIONS] >= counts[LIMIT]
    tolerance = options[O_TOLERANCE]
    status = judge(pair, options[O_LAW], outcome, p, d, bound, upper, tolerance, exhausted)
    jets = pair_jets(pair, R, p, mode, q)
    n_rate = ORIGIN
    if inside and has_twist:
        n_rate = contact_rates(pair, motion, jets, normal, d, w_ff, counts)
    elif not inside and not fresh and has_twist and d > 0.0:
        feedforward_now(pair, options, motion, mode, q, w_ff, counts)
    old_a, old_b = int(state[MODE]), int(state[MODE + 2])
    same = carry_over(pair, state, mode)
    if counts[EVENTS] > 0 or old_a != mode[0] or old_b != mode[2]:
        tidy_events(events, counts, old_a, old_b, mode[0], mode[2])
    query = (d, bound, upper, normal)
    keep(state, motion, has_twist, options, h, mode, q, w_ff, same, status, query, inside)
    write_answer(
        pair, Ta, xi_a, has_twist, motion, mode, q, w_ff, jets, query, inside, n_rate, status, out
    )
    for k in range(N_COUNTS):
        out[OUT_COUNTS + k] = counts[k]


@kernel
def step(pair, Ta, Tb, xi_a, xi_b, has_twist, h, options, state, out, events):
    """One frame: the state is changed in place, the answer written to `out`.

    Returns FINE; or, with nothing changed, what of the poses and twists is refused.
    """
    refused = refusal(pointer(Ta, 0), pointer(Tb, 0), pointer(xi_a, 0), pointer(xi_b, 0))
    if refused != FINE:
        return refused
    ints, reals = np.empty(4 + N_COUNT_SLOTS, dtype=np.int64), np.empty(8 + N_CHANGES)
    step_frame(
        pair_pointers(pair),
        pointer(Ta, 0),
        pointer(Tb, 0),
        pointer(xi_a, 0),
        pointer(xi_b, 0),
        has_twist,
        h,
        pointer(options, 0),
        pointer(state, 0),
        pointer(out, 0),
        pointer(events, 0),
        pointer(ints, 0),
        pointer(reals, 0),
        pointer(reals, 4),
        pointer(reals, 8),
        pointer(ints, 4),
    )
    ints[0], reals[0] = 0, 0.0  # alive until here, see `pointer`
    return FINE


@kernel
def run(pair, poses_a, poses_b, twists_a, twists_b, has_twist, steps, options, state, outs, events):
    """Many frames in one compiled loop; row k of `outs` answers for row k of the poses.

    poses (n, 12), twists (n, 6), steps (n,), outs (n, N_OUT). Returns (-1, FINE), or the frame
    that was refused and why; the frames before it are answered.
    """
    ints, reals = np.empty(4 + N_COUNT_SLOTS, dtype=np.int64), np.empty(8 + N_CHANGES)
    pointers = pair_pointers(pair)
    mode, counts = pointer(ints, 0), pointer(ints, 4)
    q, w_ff, dq = pointer(reals, 0), pointer(reals, 4), pointer(reals, 8)
    at, why = -1, FINE
    for k in range(poses_a.shape[0]):
        Ta, Tb = pointer(poses_a.ravel(), 12 * k), pointer(poses_b.ravel(), 12 * k)
        xi_a, xi_b = pointer(twists_a.ravel(), 6 * k), pointer(twists_b.ravel(), 6 * k)
        why = refusal(Ta, Tb, xi_a, xi_b)
        if why != FINE:
            at = k
            break
        step_frame(
            pointers,
            Ta,
            Tb,
            xi_a,
            xi_b,
            has_twist,
            steps[k],
            pointer(options, 0),
            pointer(state, 0),
            pointer(outs.ravel(), N_OUT * k),
            pointer(events, 0),
            mode,
            q,
            w_ff,
            dq,
            counts,
        )
    ints[0], reals[0] = 0, 0.0  # alive until here, see `pointer`
    return at, why
