"""The witness points of one frame from those of the last, in both laws, apart or in contact."""

from math import inf

from standoff.kernels.certificate import certify_along
from standoff.kernels.certified import (
    CERTIFIED,
    NOT_APART,
    PENETRATING,
    UNCERTIFIED,
    settle_and_weigh,
    weigh,
)
from standoff.kernels.cold_start import global_query
from standoff.kernels.compiling import kernel
from standoff.kernels.contact_frame import bound_along, contact_query, some_direction
from standoff.kernels.depth_search import overlap_shown
from standoff.kernels.descent import ORIGIN, pair_jets
from standoff.kernels.events import EVALUATIONS, LIMIT, RESTARTS
from standoff.kernels.frame import (
    CUT,
    DEPTH_GLOBAL,
    INSIDE,
    INTEGRAL,
    LAST_BOUND,
    LAST_DISTANCE,
    LAST_NORMAL,
    LAW_PAPER,
    LOST,
    MODE,
    O_DEPTH,
    O_LAW,
    O_SWITCHING,
    O_TOLERANCE,
    POSE,
    SWITCH_NONE,
    TWIST,
    Q,
)
from standoff.kernels.paper_law import apply_step, paper_frame, read_errors
from standoff.kernels.penetration import (
    NOTHING,
    begin_along,
    contact_scale,
    minimum_along,
    restore,
)
from standoff.kernels.prediction import predict
from standoff.kernels.rigid import read_rotation, read_vector
from standoff.kernels.tolerances import PATIENCE, POLISHED, SHIFTED_GAP, TURN
from standoff.kernels.vectors import dot, sub


@kernel
def from_state(state, mode, q):
    for k in range(4):
        mode[k] = int(state[MODE + k])
        q[k] = state[Q + k]


@kernel
def follow_predicted(pair, motion, state, options, h, mode, q, w_ff, dq, counts, events):
    """(fresh, outcome, d, bound, normal, apart) of one step of the predictor-corrector.

    It predicts with the feedforward, then makes one Newton correction (the paper's feedback under
    Euler with K h = 1), more where a mode changes; where the certificate's gap stays above the
    tolerance it corrects to roundoff. `apart` tells that the witness points have not passed each
    other along the last normal.
    """
    R, p, v, w = motion
    n = read_vector(state, LAST_NORMAL)
    tolerance = options[O_TOLERANCE]
    predict(state, options, h, dq)
    apply_step(pair, mode, q, dq, counts, events)
    if state[LAST_DISTANCE] < SHIFTED_GAP * contact_scale(pair):
        jet_a, jet_b = pair_jets(pair, R, p, mode, q)
        if dot(n, sub(jet_b[0], jet_a[0])) <= 0.0:
            return False, UNCERTIFIED, 0.0, -inf, n, False
    fresh, outcome, d, bound, normal = settle_and_weigh(
        pair, R, p, v, w, mode, q, w_ff, 1.0, tolerance, tolerance, counts, events
    )
    if outcome == UNCERTIFIED:
        fresh, outcome, d, bound, normal = settle_and_weigh(
            pair, R, p, v, w, mode, q, w_ff, 1.0, 0.0, tolerance, counts, events
        )
    return fresh, outcome, d, bound, normal, True


@kernel
def follow_paper(pair, motion, state, options, h, mode, q, w_ff, dq, counts, events):
    """What `follow_predicted` returns, of one frame of the paper's law."""
    R, p, _, _ = motion
    n = read_vector(state, LAST_NORMAL)
    before = (
        read_rotation(state, POSE),
        read_vector(state, POSE + 9),
        read_vector(state, TWIST),
        read_vector(state, TWIST + 3),
    )
    paper_frame(pair, before, motion, state, options, h, mode, q, counts, events, dq)
    jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    tolerance = options[O_TOLERANCE]
    outcome, d, bound, normal = weigh(pair, R, p, mode, q, jet_a, jet_b, ORIGIN, tolerance)
    # while it still converges from a wrong start the normal tells nothing
    settled = state[LAST_BOUND] > 0.5 * state[LAST_DISTANCE]
    apart = dot(n, sub(jet_b[0], jet_a[0])) > 0.0 or not settled
    return False, outcome, d, bound, normal, apart


@kernel
def polished(pair, R, p, mode, q, n, d, bound, tolerance, counts):
    """(d, bound, n) of a certified pair very near contact, after Newton's method in the
    contact-regular form: the direction between its witness points has lost its digits."""
    if d > POLISHED * contact_scale(pair) or counts[EVALUATIONS] >= counts[LIMIT]:
        return d, bound, n
    kind, n_new, d_new, _ = minimum_along(pair, R, p, mode, q, n, bound, tolerance, counts)
    if kind == NOTHING:
        return d, bound, n
    jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    bound_new, _ = certify_along(pair, R, p, mode, q, jet_a[0], jet_b[0], n_new)
    return d_new, bound_new, n_new


@kernel
def anywhere_apart(pair, R, p, options, goal, first, mode, q, w_ff, counts, events):
    """(outcome, d, bound, upper, normal, inside) of a cold query where the bodies are apart; else
    the outcome is NOT_APART, and `anywhere` finds the answer. `first` is the start that is tried
    first.
    """
    outcome, d, bound, normal = global_query(pair, R, p, first, mode, q, w_ff, goal, counts, events)
    if outcome != CERTIFIED:
        return NOT_APART, d, bound, d, normal, False
    d, bound, normal = polished(pair, R, p, mode, q, normal, d, bound, goal, counts)
    return outcome, d, bound, d, normal, False


@kernel
def anywhere(pair, R, p, options, goal, first, mode, q, w_ff, counts, events):
    """(outcome, d, bound, upper, normal, inside) of a cold query, apart or not."""
    outcome, d, bound, normal = global_query(pair, R, p, first, mode, q, w_ff, goal, counts, events)
    if outcome == CERTIFIED:
        d, bound, normal = polished(pair, R, p, mode, q, normal, d, bound, goal, counts)
        return outcome, d, bound, d, normal, False
    if counts[EVALUATIONS] >= counts[LIMIT]:
        return outcome, d, bound, d, normal, False
    outcome, d, bound, upper, normal = contact_query(
        pair, R, p, 0.0, normal, 1.0, mode, q, w_ff, goal, counts, events
    )
    return outcome, d, bound, upper, normal, outcome == PENETRATING


@kernel
def start_due(state, counts):
    """(is a global start due, which): after frames in a row that were cut off and have spent
    PATIENCE evaluations between them, what they went on from leads nowhere.
    """
    if state[CUT] == 0.0:
        return False, 0.0
    turns = (state[CUT] * counts[LIMIT]) // PATIENCE
    return turns > ((state[CUT] - 1.0) * counts[LIMIT]) // PATIENCE, (turns + 1.0) % 2.0


@kernel
def cut_off(pair, R, p, d, bound, upper, n, mode, q):
    """(d, bound, upper, n, inside) of a frame that ran out of evaluations outside contact.

    Where samples alone show that the bodies overlap, the next frame follows the depth from their
    least direction, and this one answers with what that parts them by.
    """
    n = some_direction(n)
    shown, way, least = overlap_shown(pair, R, p)
    if not shown or bound > 0.0:
        return d, bound, upper, n, False
    begin_along(pair, R, way, mode, q)
    last, along = bound_along(pair, R, p, mode, q, n), bound_along(pair, R, p, mode, q, way)
    if last > along:
        return last, last, -least, n, True
    return along, along, -least, way, True


@kernel
def track(follow, pair, motion, state, options, h, mode, q, w_ff, dq, counts, events):
    """This frame from the last one: (fresh, outcome, d, bound, upper, normal, inside).

    Outside contact one step of the law, which is `follow`; in contact, where the witness points
    pass each other, the local minimum of the depth is followed; where neither certifies, a global
    start. `fresh` tells whether w_ff belongs to the final mode.
    """
    R, p, _, _ = motion
    tolerance = options[O_TOLERANCE]
    alone = options[O_SWITCHING] == SWITCH_NONE
    everywhere = 1.0 if options[O_DEPTH] == DEPTH_GLOBAL else 0.0
    due, first = start_due(state, counts)
    inside = state[INSIDE] != 0.0 and not alone
    if alone or (state[LOST] == 0.0 and (inside or not due)):
        doubted, fresh, d, bound, normal = False, False, 0.0, -inf, ORIGIN
        if not inside:
            fresh, outcome, d, bound, normal, apart = follow(
                pair, motion, state, options, h, mode, q, w_ff, dq, counts, events
            )
            near = state[LAST_DISTANCE] < SHIFTED_GAP * contact_scale(pair)
            lags = options[O_LAW] == LAW_PAPER and apart and outcome == UNCERTIFIED
            # behind the motion, or no longer apart?
            doubted = lags and bound <= 0.0 and (near or overlap_shown(pair, R, p)[0])
            if outcome == CERTIFIED and options[O_LAW] != LAW_PAPER and not alone:
                d, bound, normal = polished(
                    pair, R, p, mode, q, normal, d, bound, tolerance, counts
                )
            if outcome == CERTIFIED or alone or (lags and not doubted):
                return fresh, outcome, d, bound, d, normal, False
            if counts[EVALUATIONS] >= counts[LIMIT] and apart:
                d, bound, upper, normal, inside = cut_off(pair, R, p, d, bound, d, normal, mode, q)
                return fresh, UNCERTIFIED, d, bound, upper, normal, inside
            inside = near or not apart or doubted
        if inside:
            behind = (mode[0], mode[1], mode[2], mode[3]), (q[0], q[1], q[2], q[3])
            from_state(state, mode, q)
            # where frames are cut off Newton's method and the descent take turns
            newton = state[INSIDE] != 0.0 and (state[CUT] // TURN) % 2.0 == 0.0
            warm = 2.0 if newton else 1.0
            n = read_vector(state, LAST_NORMAL)
            outcome, d_in, bound_in, upper, n = contact_query(
                pair, R, p, warm, n, everywhere, mode, q, w_ff, tolerance, counts, events
            )
            if doubted and outcome != PENETRATING:
                restore(mode, q, behind[0], behind[1])
                return False, UNCERTIFIED, d, bound, d, normal, False
            exhausted = counts[EVALUATIONS] >= counts[LIMIT]
            if outcome != UNCERTIFIED or exhausted:
                begin_errors(pair, R, p, options, state, mode, q)
                return False, outcome, d_in, bound_in, upper, n, outcome != CERTIFIED
            from_state(state, mode, q)
    counts[RESTARTS] += 1
    outcome, d, bound, upper, normal, inside = anywhere(
        pair, R, p, options, tolerance, first, mode, q, w_ff, counts, events
    )
    if counts[EVALUATIONS] >= counts[LIMIT] and outcome != CERTIFIED and not inside:
        d, bound, upper, normal, inside = cut_off(pair, R, p, d, bound, upper, normal, mode, q)
    begin_errors(pair, R, p, options, state, mode, q)
    return False, outcome, d, bound, upper, normal, inside


@kernel
def begin_errors(pair, R, p, options, state, mode, q):
    """The paper's law begins anew: its integrated errors are those of the witness points."""
    if options[O_LAW] == LAW_PAPER:
        for k in range(4):
            state[INTEGRAL + k] = 0.0
        read_errors(pair, R, p, state, mode, q)
