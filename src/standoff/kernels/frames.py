"""One frame of the hybrid tracker, in both laws, on pointers; and the first one, a cold query."""

from standoff.kernels.answer import judge, write_answer
from standoff.kernels.certified import CERTIFIED, NOT_APART, UNCERTIFIED, settle_and_weigh, weigh
from standoff.kernels.compiling import kernel, shared
from standoff.kernels.contact import contact_rates
from standoff.kernels.descent import ORIGIN, pair_jets
from standoff.kernels.events import (
    EVALUATIONS,
    EVENTS,
    LIMIT,
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
    N_STATE,
    NOT_KNOWN_APART,
    O_DEADLINE,
    O_LAW,
    O_TOLERANCE,
    OUT_COUNTS,
    POSE,
    START_ANYWHERE,
    START_HERE,
)
from standoff.kernels.integrators import NONE, rates_at
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
from standoff.kernels.track import (
    follow_paper,
    follow_predicted,
    from_state,
    track,
)

# Where the rates of a frame's parameters come from.
KNOWN, OF_LAW, IN_CONTACT = range(3)


@kernel
def feedforward_now(pair, options, motion, mode, q, w_ff, counts):
    """w_ff at the final witness points, where no evaluation of the frame belongs to them."""
    rates, _, _, _ = rates_at(pair, options, motion, mode, q, NONE, NONE, 0.0, 1.0, counts)
    for k in range(4):
        w_ff[k] = rates[k]


@shared
def answer_frame(
    pair, Ta, xi_a, has_twist, rates, motion, options, mode, q, w_ff, counts, query, status, out
):
    """Write the answer of a frame; query is (d, bound, upper, normal) of the cores.

    `rates` says where w_ff comes from: it is KNOWN, or found here OF_LAW or IN_CONTACT.
    """
    R, p, _, _ = motion
    d, _, _, normal = query
    jets = pair_jets(pair, R, p, mode, q)
    n_rate = ORIGIN
    if rates == IN_CONTACT:
        n_rate = contact_rates(pair, motion, jets, normal, d, w_ff, counts)
    elif rates == OF_LAW:
        feedforward_now(pair, options, motion, mode, q, w_ff, counts)
    inside = rates == IN_CONTACT
    write_answer(
        pair, Ta, xi_a, has_twist, motion, mode, q, w_ff, jets, query, inside, n_rate, status, out
    )


@kernel
def start_frame(
    query_from,
    pair,
    Ta,
    Tb,
    xi_a,
    xi_b,
    has_twist,
    options,
    state,
    given,
    out,
    mode,
    q,
    w_ff,
    counts,
    events,
):
    R, p = relative_pose(Ta, Tb)
    v, w = relative_twist(Ta, Tb, xi_a, xi_b)
    motion = (R, p, v, w)
    goal = min(options[O_TOLERANCE], START_GAP)
    outcome, d, bound, normal = UNCERTIFIED, 0.0, -1.0, (0.0, 0.0, 0.0)
    inside = False
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
        outcome, d, bound, upper, normal, inside = query_from(
            pair, R, p, options, goal, 0.0, mode, q, w_ff, counts, events
        )
        if outcome == NOT_APART:
            return NOT_KNOWN_APART
    kind = LAW_PAPER if given == START_HERE else LAW_PC
    status = judge(pair, kind, outcome, p, d, bound, upper, goal, False)
    query = (d, bound, upper, normal)
    rates = IN_CONTACT if inside else (OF_LAW if has_twist and d > 0.0 else KNOWN)
    answer_frame(
        pair, Ta, xi_a, has_twist, rates, motion, options, mode, q, w_ff, counts, query, status, out
    )
    for k in range(N_STATE):
        state[k] = 0.0
    if options[O_LAW] == LAW_PAPER:
        read_errors(pair, R, p, state, mode, q)
    counts[EVENTS] = 0
    keep(state, motion, has_twist, options, 0.0, mode, q, w_ff, False, status, query, inside)
    for k in range(N_COUNTS):
        out[OUT_COUNTS + k] = counts[k]
    return FINE


@kernel
def step_frame(
    follow,
    pair,
    Ta,
    Tb,
    xi_a,
    xi_b,
    has_twist,
    h,
    options,
    state,
    out,
    events,
    mode,
    q,
    w_ff,
    dq,
    counts,
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
        follow, pair, motion, state, options, h, mode, q, w_ff, dq, counts, events
    )
    exhausted = counts[EVALUATIONS] >= counts[LIMIT]
    tolerance = options[O_TOLERANCE]
    status = judge(pair, options[O_LAW], outcome, p, d, bound, upper, tolerance, exhausted)
    query = (d, bound, upper, normal)
    rates = KNOWN
    if has_twist and (inside or (not fresh and d > 0.0)):
        rates = IN_CONTACT if inside else OF_LAW
    answer_frame(
        pair, Ta, xi_a, has_twist, rates, motion, options, mode, q, w_ff, counts, query, status, out
    )
    old_a, old_b = int(state[MODE]), int(state[MODE + 2])
    same = carry_over(pair, state, mode)
    if counts[EVENTS] > 0 or old_a != mode[0] or old_b != mode[2]:
        tidy_events(events, counts, old_a, old_b, mode[0], mode[2])
    keep(state, motion, has_twist, options, h, mode, q, w_ff, same, status, query, inside)
    for k in range(N_COUNTS):
        out[OUT_COUNTS + k] = counts[k]


@shared
def frame_predicted(
    pair,
    Ta,
    Tb,
    xi_a,
    xi_b,
    has_twist,
    h,
    options,
    state,
    out,
    events,
    mode,
    q,
    w_ff,
    dq,
    counts,
):
    """A frame of the predictor-corrector, for single steps and for runs."""
    step_frame(
        follow_predicted,
        pair,
        Ta,
        Tb,
        xi_a,
        xi_b,
        has_twist,
        h,
        options,
        state,
        out,
        events,
        mode,
        q,
        w_ff,
        dq,
        counts,
    )


@shared
def frame_paper(
    pair,
    Ta,
    Tb,
    xi_a,
    xi_b,
    has_twist,
    h,
    options,
    state,
    out,
    events,
    mode,
    q,
    w_ff,
    dq,
    counts,
):
    """A frame of the paper's law, for single steps and for runs."""
    step_frame(
        follow_paper,
        pair,
        Ta,
        Tb,
        xi_a,
        xi_b,
        has_twist,
        h,
        options,
        state,
        out,
        events,
        mode,
        q,
        w_ff,
        dq,
        counts,
    )
