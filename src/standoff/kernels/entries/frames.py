"""One frame of the hybrid tracker, in both laws; and the first one, a cold query."""

from __future__ import annotations

from standoff.kernels.algebra.rigid import relative_pose
from standoff.kernels.body.features import dimension
from standoff.kernels.compiler.calls import address_of, call_frame
from standoff.kernels.compiler.decorators import kernel, shared, stack_counts
from standoff.kernels.frame.answer import judge, write_answer
from standoff.kernels.frame.apart import track_predicted
from standoff.kernels.frame.inputs import moving, twisted
from standoff.kernels.frame.prediction import feeds, next_state
from standoff.kernels.frame.smooth import (
    CALL_HAS_TWIST,
    CALL_INTS_A,
    CALL_INTS_B,
    CALL_OPTIONS,
    CALL_OUT,
    CALL_POSE_A,
    CALL_POSE_B,
    CALL_REALS_A,
    CALL_REALS_B,
    CALL_STATE,
    CALL_TWIST_A,
    CALL_TWIST_B,
)
from standoff.kernels.pair.certified import (
    CERTIFIED,
    NOT_APART,
    UNCERTIFIED,
    settle_and_weigh,
    weigh,
)
from standoff.kernels.pair.contact_newton import contact_rates
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.events import (
    EVENTS,
    GENERAL_FRAMES,
    KEEPING,
    KEPT,
    LIMIT,
    N_COUNTS,
    NO_LIMIT,
    RESTARTS,
    exhausted,
    tidy_events,
)
from standoff.kernels.pair.polytope_layout import N_VERTICES
from standoff.kernels.paper.frame import track_carried, track_paper
from standoff.kernels.paper.integrators import feedforward_now
from standoff.kernels.paper.law import begun
from standoff.kernels.state.arrays import (
    FINE,
    NOT_KNOWN_APART,
    OUT_COUNTS,
    START_ANYWHERE,
    START_HERE,
)
from standoff.kernels.state.state import (
    Integrated,
    fresh_state,
    read_place,
    read_state,
    write_state,
)
from standoff.kernels.state.tracked import Shown, Tracked, without_rates
from standoff.kernels.tolerances import START_GAP
from standoff.kernels.values import NO_RATES, ORIGIN, Found

NOT_INTEGRATED = Integrated(NO_RATES, NO_RATES, 0.0)


@shared
def answer_frame(pair, inputs, motion, shown, solve, status, out, work):
    """Write the answer of a frame. Returns the rates of its parameters, which are found here where
    no evaluation of the frame belongs to its witness points.
    """
    found, jets, rates = shown.found, shown.jets, shown.rates
    n_rate = ORIGIN
    if inputs.has_twist:
        if shown.inside:
            n_rate, rates = contact_rates(pair, motion, jets, found.normal, found.distance, work)
        elif not shown.fresh and found.distance > 0.0:
            rates = feedforward_now(pair, motion, found.place, solve, work)
    known = Shown(found, jets, shown.inside, shown.fresh, rates)
    write_answer(pair, inputs, motion, known, n_rate, status, out)
    return rates


@kernel
def copy_counts(work, out):
    for k in range(N_COUNTS):
        out[OUT_COUNTS + k] = work.counts[k]


@kernel
def begin_at(pair, motion, place, given, goal, work):
    """What is found at a place that is given: there, or by descent from it."""
    pose = motion.pose
    if given == START_HERE:
        jets = pair_jets(pair, pose, place)
        outcome, d, lower, normal = weigh(pair, pose, place, jets, ORIGIN, goal)
        return Found(outcome, place, d, lower, d, normal)
    return settle_and_weigh(pair, motion, place, 0.0, 0.0, goal, work).found


@kernel
def start_frame(query_from, pair, inputs, options, state, given, out, work):
    """The first frame: anywhere by the query given, by descent from the state's place, or there."""
    motion = twisted(inputs, relative_pose(inputs.pose_a, inputs.pose_b))
    goal = min(options.tolerance, START_GAP)
    place = read_place(state)
    found = Found(UNCERTIFIED, place, 0.0, -1.0, 0.0, ORIGIN)
    inside = False
    work.counts[LIMIT] = NO_LIMIT  # a start has no deadline
    if given != START_ANYWHERE:
        found = begin_at(pair, motion, place, given, goal, work)
    if found.outcome != CERTIFIED and given != START_HERE:
        work.counts[RESTARTS] += 0 if given == START_ANYWHERE else 1
        found, inside = query_from(pair, motion.pose, goal, work)
        if found.outcome == NOT_APART:
            return NOT_KNOWN_APART
    status = judge(pair, motion.pose.p, found, given == START_HERE, goal, False)
    shown = without_rates(pair, motion.pose, found, inside, NOT_INTEGRATED).shown
    rates = answer_frame(pair, inputs, motion, shown, options.solve, status, out, work)
    integrated = NOT_INTEGRATED
    if options.paper:
        integrated = begun(pair, motion.pose, found.place, 0.0)
    work.counts[EVENTS] = 0
    known = Tracked(Shown(found, shown.jets, inside, False, rates), integrated)
    before = fresh_state(found.place, integrated)
    feed = feeds(options.predictor, inputs.has_twist)
    write_state(next_state(pair, before, motion, 0.0, known, feed, status), state)
    copy_counts(work, out)
    return FINE


@kernel
def step_frame(track, pair, inputs, steps, options, state, out, work):
    """A frame of the law that is given: the state is changed in place, the answer written. `steps`
    are the time h, and what `track` goes by: h, or a change of the parameters over it. The counts
    are 0 before it.
    """
    h, step = steps
    before = read_state(state)
    work.counts[LIMIT] = options.deadline
    motion = moving(inputs, before, h)
    shown, integrated = track(pair, motion, before, options, step, work)
    found = shown.found
    status = judge(pair, motion.pose.p, found, options.paper, options.tolerance, exhausted(work))
    rates = answer_frame(pair, inputs, motion, shown, options.solve, status, out, work)
    old, new = before.place, found.place
    if work.counts[EVENTS] > 0 or old.feature_a != new.feature_a or old.feature_b != new.feature_b:
        tidy_events(work, old.feature_a, old.feature_b, new.feature_a, new.feature_b)
    known = Tracked(Shown(found, shown.jets, shown.inside, shown.fresh, rates), integrated)
    feed = feeds(options.predictor, inputs.has_twist)
    write_state(next_state(pair, before, motion, h, known, feed, status), state)
    copy_counts(work, out)


@kernel
def clear_counts(work):
    for k in range(N_COUNTS):
        work.counts[k] = 0
    work.counts[KEEPING], work.counts[KEPT] = 0, 0


@kernel
def forget_polytope(work):
    """Leave the next frame no polytope where this one has kept none."""
    if work.counts[KEPT] == 0:
        work.polytope[N_VERTICES] = 0.0


@kernel
def answered_smoothly(pair, inputs, h, options, state, out):
    """Has the smooth frame, whose address is among the options, made the answer? If not nothing has
    been written.
    """
    call = stack_counts()
    call[CALL_INTS_A], call[CALL_REALS_A] = address_of(pair.ints_a), address_of(pair.reals_a)
    call[CALL_INTS_B], call[CALL_REALS_B] = address_of(pair.ints_b), address_of(pair.reals_b)
    call[CALL_POSE_A], call[CALL_POSE_B] = address_of(inputs.pose_a), address_of(inputs.pose_b)
    call[CALL_TWIST_A], call[CALL_TWIST_B] = address_of(inputs.twist_a), address_of(inputs.twist_b)
    call[CALL_HAS_TWIST] = 1 if inputs.has_twist else 0
    call[CALL_OPTIONS] = address_of(options.numbers)
    call[CALL_STATE], call[CALL_OUT] = address_of(state), address_of(out)
    return call_frame(options.smooth, address_of(call), h) != 0


@kernel
def on_faces(pair, state):
    """Were both witness points on faces? Elsewhere the smooth frame need not be asked."""
    place = read_place(state)
    a, b = dimension(pair.ints_a, place.feature_a), dimension(pair.ints_b, place.feature_b)
    return a == 2 and b == 2


@shared
def frame_predicted(pair, inputs, h, options, state, out, work):
    """A frame of the predictor-corrector, for single steps and for runs."""
    clear_counts(work)
    if options.smooth != 0:
        if on_faces(pair, state) and answered_smoothly(pair, inputs, h, options, state, out):
            forget_polytope(work)
            return
        work.counts[GENERAL_FRAMES] = 1
    step_frame(track_predicted, pair, inputs, (h, h), options, state, out, work)
    forget_polytope(work)


@shared
def frame_paper(pair, inputs, h, options, state, out, work):
    """A frame of the paper's law, for single steps and for runs."""
    clear_counts(work)
    step_frame(track_paper, pair, inputs, (h, h), options, state, out, work)
    forget_polytope(work)


@shared
def frame_carried(pair, inputs, h, change, options, state, out, work):
    """A frame whose parameters were integrated together with the bodies' motion."""
    clear_counts(work)
    step_frame(track_carried, pair, inputs, (h, change), options, state, out, work)
    forget_polytope(work)
