"""The hybrid tracker as Python calls it: starts, steps and runs of frames on flat arrays.

The state goes in and comes out as one float64 array, so that it is a value. A step answers for the
poses it is given; a frame's poses and twists are one row of numbers (``state.arrays``).
"""

import numpy as np

from standoff.kernels.compiler.decorators import ahead, entry, kernel, pointer, reals_on_stack
from standoff.kernels.compiler.entry import BOOL, INT, PAIR, READ, ROWS, WRITE
from standoff.kernels.entries.frames import frame_paper, frame_predicted, start_frame
from standoff.kernels.frame.inputs import Inputs
from standoff.kernels.frame.restart import anywhere, anywhere_apart
from standoff.kernels.pair.events import EVENT_COLUMNS, MAX_EVENTS, N_COUNT_SLOTS
from standoff.kernels.pair.polytope_layout import N_POLYTOPE, N_VERTICES
from standoff.kernels.state.arrays import (
    FINE,
    N_MOTION,
    N_OUT,
    N_STATE,
    NOT_KNOWN_APART,
    POSE_A,
    POSE_B,
    TWIST_A,
    TWIST_B,
    refusal,
)
from standoff.kernels.state.options import names_paper_law, read_options
from standoff.kernels.values import Pair, Work


@kernel
def pair_pointers(pair):
    return Pair(pointer(pair[0], 0), pointer(pair[1], 0), pointer(pair[2], 0), pointer(pair[3], 0))


@kernel
def input_pointers(motion, row, has_twist):
    """Where a frame's poses and twists stand: row `row` of a flat array of motions."""
    return inputs_at(pointer(motion, N_MOTION * row), has_twist)


@kernel
def inputs_at(motion, has_twist):
    """Where a frame's poses and twists stand, from the first of them on."""
    return Inputs(
        ahead(motion, POSE_A),
        ahead(motion, POSE_B),
        ahead(motion, TWIST_A),
        ahead(motion, TWIST_B),
        has_twist,
    )


@kernel
def refused(inputs):
    """FINE, or which of a frame's poses and twists is not one."""
    return refusal(inputs.pose_a, inputs.pose_b, inputs.twist_a, inputs.twist_b)


@kernel
def start_by(query_from, pair, inputs, options, state, given, out):
    """`start`, with the cold query that it is to make."""
    why = refused(inputs)
    if why != FINE:
        return why
    counts = np.empty(N_COUNT_SLOTS, dtype=np.int64)
    for k in range(N_COUNT_SLOTS):
        counts[k] = 0
    log = np.empty(MAX_EVENTS * EVENT_COLUMNS)
    none = reals_on_stack(N_POLYTOPE)  # a start has none, and keeps none
    answered = start_frame(
        query_from,
        pair_pointers(pair),
        inputs,
        read_options(pointer(options, 0)),
        pointer(state, 0),
        given,
        pointer(out, 0),
        Work(pointer(counts, 0), pointer(log, 0), none, none),
    )
    counts[0], log[0] = 0, 0.0  # alive until here, see `pointer`
    return answered


@entry(PAIR, WRITE, BOOL, READ, WRITE, INT, WRITE, work="query")
def start_apart(pair, motion, has_twist, options, state, given, out):
    """`start` of bodies that are apart; NOT_KNOWN_APART, with nothing changed, where they may not
    be. It needs none of what is compiled for contact.
    """
    inputs = input_pointers(motion, 0, has_twist)
    return start_by(anywhere_apart, pair, inputs, options, state, given, out)


@entry(PAIR, WRITE, BOOL, READ, WRITE, INT, WRITE, work="contact")
def start(pair, motion, has_twist, options, state, given, out):
    """Begin at a pose: anywhere (a global query), by descent from the state's mode, or there.

    Returns FINE, or what of the poses and twists is refused.
    """
    inputs = input_pointers(motion, 0, has_twist)
    return start_by(anywhere, pair, inputs, options, state, given, out)


@kernel
def run_by(frame, pair, given, steps, options, state, outs, events):
    """Many frames in one compiled loop, with the law that they are to follow. `given` is (motions,
    has_twist).
    """
    motions, has_twist = given
    numbers, answers, length = motions.ravel(), outs.ravel(), len(motions)
    motion, out = pointer(numbers, 0), pointer(answers, 0)
    counts = np.empty(N_COUNT_SLOTS, dtype=np.int64)
    scratch = reals_on_stack(N_POLYTOPE)
    scratch[N_VERTICES] = 0.0
    behind = ahead(pointer(state, 0), N_STATE)
    kept = behind if len(state) >= N_STATE + N_POLYTOPE else scratch
    work = Work(pointer(counts, 0), pointer(events, 0), kept, kept)
    pointers = pair_pointers(pair)
    options = read_options(pointer(options, 0))
    h, kept = pointer(steps, 0), pointer(state, 0)
    at, why = -1, FINE
    for k in range(length):
        inputs = inputs_at(ahead(motion, N_MOTION * k), has_twist)
        why = refused(inputs)
        if why != FINE:
            at = k
            break
        frame(pointers, inputs, h[k], options, kept, ahead(out, N_OUT * k), work)
    counts[0] = 0  # alive until here, see `pointer`
    return at, why


@entry(PAIR, ROWS, BOOL, WRITE, READ, WRITE, ROWS, WRITE, work="runs")
def run_predicted(pair, motions, has_twist, steps, options, state, outs, events):
    """Many frames in one compiled loop; row k of `outs` answers for row k of `motions`.

    motions (n, N_MOTION), steps (n,), outs (n, N_OUT). Behind the state there may be N_POLYTOPE
    numbers more, for a polytope that is kept from run to run. Returns (-1, FINE), or the frame that
    was refused and why; the frames before it are answered.
    """
    return run_by(frame_predicted, pair, (motions, has_twist), steps, options, state, outs, events)


@entry(PAIR, ROWS, BOOL, WRITE, READ, WRITE, ROWS, WRITE, work="paper runs")
def run_paper(pair, motions, has_twist, steps, options, state, outs, events):
    """`run_predicted`, of the paper's law."""
    return run_by(frame_paper, pair, (motions, has_twist), steps, options, state, outs, events)


def run(pair, motions, has_twist, steps, options, state, outs, events):
    """Many frames of the law that the options name: `run_predicted` or `run_paper`."""
    many = run_paper if names_paper_law(options) else run_predicted
    return many(pair, motions, has_twist, steps, options, state, outs, events)


def start_anywhere(pair, motion, has_twist, options, state, given, out):
    """`start`, by way of `start_apart` while nothing has needed what is compiled for contact."""
    everything = (pair, motion, has_twist, options, state, given, out)
    if getattr(start, "ready", True):
        return start(*everything)
    answered = start_apart(*everything)
    return start(*everything) if answered == NOT_KNOWN_APART else answered
