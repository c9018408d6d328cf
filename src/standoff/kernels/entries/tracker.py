"""The hybrid tracker as Python calls it: starts, steps and runs of frames on flat arrays.

The state goes in and comes out as one float64 array, so that it is a value. A step answers for the
poses it is given; a frame's poses and twists are one row of numbers (``state.arrays``).
"""

import numpy as np

from standoff.kernels.compiler.decorators import entry, kernel, pointer
from standoff.kernels.compiler.entry import BOOL, INT, PAIR, READ, REAL, ROWS, WRITE
from standoff.kernels.entries.frames import Inputs, frame_paper, frame_predicted, start_frame
from standoff.kernels.frame.restart import anywhere, anywhere_apart
from standoff.kernels.pair.events import EVENT_COLUMNS, MAX_EVENTS, N_COUNT_SLOTS
from standoff.kernels.state.arrays import (
    FINE,
    N_MOTION,
    N_OUT,
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
    o = N_MOTION * row
    return Inputs(
        pointer(motion, o + POSE_A),
        pointer(motion, o + POSE_B),
        pointer(motion, o + TWIST_A),
        pointer(motion, o + TWIST_B),
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
    answered = start_frame(
        query_from,
        pair_pointers(pair),
        inputs,
        read_options(pointer(options, 0)),
        pointer(state, 0),
        given,
        pointer(out, 0),
        Work(pointer(counts, 0), pointer(log, 0)),
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
def step_by(frame, pair, inputs, h, options, state, out, events):
    """`step`, with the law's own frame."""
    why = refused(inputs)
    if why != FINE:
        return why
    counts = np.empty(N_COUNT_SLOTS, dtype=np.int64)
    work = Work(pointer(counts, 0), pointer(events, 0))
    options = read_options(pointer(options, 0))
    frame(pair_pointers(pair), inputs, h, options, pointer(state, 0), pointer(out, 0), work)
    counts[0] = 0  # alive until here, see `pointer`
    return FINE


@entry(PAIR, WRITE, BOOL, REAL, READ, WRITE, WRITE, WRITE, work="frames")
def step_predicted(pair, motion, has_twist, h, options, state, out, events):
    """One frame of the predictor-corrector: the state is changed in place, the answer written to
    `out`.

    Returns FINE; or, with nothing changed, what of the poses and twists is refused.
    """
    inputs = input_pointers(motion, 0, has_twist)
    return step_by(frame_predicted, pair, inputs, h, options, state, out, events)


@entry(PAIR, WRITE, BOOL, REAL, READ, WRITE, WRITE, WRITE, work="paper")
def step_paper(pair, motion, has_twist, h, options, state, out, events):
    """`step_predicted`, of the paper's law."""
    inputs = input_pointers(motion, 0, has_twist)
    return step_by(frame_paper, pair, inputs, h, options, state, out, events)


@kernel
def run_by(frame, pair, given, steps, options, state, outs, events):
    """Many frames in one compiled loop, with the law that they are to follow. `given` is (motions,
    has_twist).
    """
    motions, has_twist = given
    rows = motions.ravel()
    counts = np.empty(N_COUNT_SLOTS, dtype=np.int64)
    work = Work(pointer(counts, 0), pointer(events, 0))
    pointers = pair_pointers(pair)
    options = read_options(pointer(options, 0))
    at, why = -1, FINE
    for k in range(motions.shape[0]):
        inputs = input_pointers(rows, k, has_twist)
        why = refused(inputs)
        if why != FINE:
            at = k
            break
        out = pointer(outs.ravel(), N_OUT * k)
        frame(pointers, inputs, steps[k], options, pointer(state, 0), out, work)
    counts[0] = 0  # alive until here, see `pointer`
    return at, why


@entry(PAIR, ROWS, BOOL, WRITE, READ, WRITE, ROWS, WRITE, work="runs")
def run_predicted(pair, motions, has_twist, steps, options, state, outs, events):
    """Many frames in one compiled loop; row k of `outs` answers for row k of `motions`.

    motions (n, N_MOTION), steps (n,), outs (n, N_OUT). Returns (-1, FINE), or the frame
    that was refused and why; the frames before it are answered.
    """
    return run_by(frame_predicted, pair, (motions, has_twist), steps, options, state, outs, events)


@entry(PAIR, ROWS, BOOL, WRITE, READ, WRITE, ROWS, WRITE, work="paper runs")
def run_paper(pair, motions, has_twist, steps, options, state, outs, events):
    """`run_predicted`, of the paper's law."""
    return run_by(frame_paper, pair, (motions, has_twist), steps, options, state, outs, events)


def step(pair, motion, has_twist, h, options, state, out, events):
    """One frame of the law that the options name: `step_predicted` or `step_paper`."""
    one = step_paper if names_paper_law(options) else step_predicted
    return one(pair, motion, has_twist, h, options, state, out, events)


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
