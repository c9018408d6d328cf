"""What the frames of all laws have in common: motion, status, answer and the next state."""

from standoff.kernels.compiler.decorators import kernel, shared
from standoff.kernels.frame.answer import judge, write_answer
from standoff.kernels.frame.feedforward import feedforward_now
from standoff.kernels.frame.inputs import moving
from standoff.kernels.frame.prediction import feeds, next_state
from standoff.kernels.pair.contact_newton import contact_rates
from standoff.kernels.pair.events import EVENTS, LIMIT, N_COUNTS, exhausted, tidy_events
from standoff.kernels.state.arrays import OUT_COUNTS
from standoff.kernels.state.state import read_state, write_state
from standoff.kernels.state.tracked import Shown, Tracked
from standoff.kernels.values import ORIGIN


@shared
def answer_frame(pair, inputs, motion, shown, solve, status, out, work):
    """Write the answer of a frame. Return the rates of its parameters, which are computed here if
    the frame made no evaluation at its witness points.
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
def step_frame(track, pair, inputs, steps, options, state, out, work):
    """A frame of the given law: change the state in place and write the answer. `steps` are the
    time h, and the argument of `track`: h, or a change of the parameters over it. The counts must
    be 0 before.
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
