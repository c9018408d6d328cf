"""The hybrid tracker as Python calls it: starts, steps and runs of frames on flat arrays.

The state goes in and comes out as one float64 array, so that it is a value. A step answers for
the poses it is given.
"""

import numpy as np

from standoff.kernels.compiling import entry, kernel, pointer
from standoff.kernels.entry import BOOL, INT, PAIR, READ, REAL, ROWS, WRITE
from standoff.kernels.events import (
    EVENT_COLUMNS,
    MAX_EVENTS,
    N_COUNT_SLOTS,
)
from standoff.kernels.frame import (
    FINE,
    LAW_PAPER,
    N_OUT,
    NOT_KNOWN_APART,
    O_LAW,
    refusal,
)
from standoff.kernels.frames import frame_paper, frame_predicted, start_frame
from standoff.kernels.integrators import N_CHANGES
from standoff.kernels.track import (
    anywhere,
    anywhere_apart,
)


@kernel
def pair_pointers(pair):
    return pointer(pair[0], 0), pointer(pair[1], 0), pointer(pair[2], 0), pointer(pair[3], 0)


@kernel
def start_by(query_from, pair, Ta, Tb, xi_a, xi_b, has_twist, options, state, given, out):
    """`start`, with the cold query that it is to make."""
    refused = refusal(pointer(Ta, 0), pointer(Tb, 0), pointer(xi_a, 0), pointer(xi_b, 0))
    if refused != FINE:
        return refused
    ints, reals = np.empty(4 + N_COUNT_SLOTS, dtype=np.int64), np.empty(8)
    for k in range(4 + N_COUNT_SLOTS):
        ints[k] = 0
    for k in range(8):
        reals[k] = 0.0
    log = np.empty(MAX_EVENTS * EVENT_COLUMNS)
    answered = start_frame(
        query_from,
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
    return answered


@entry(PAIR, WRITE, WRITE, WRITE, WRITE, BOOL, READ, WRITE, INT, WRITE, work="query")
def start_apart(pair, Ta, Tb, xi_a, xi_b, has_twist, options, state, given, out):
    """`start` of bodies that are apart; NOT_KNOWN_APART, with nothing changed, where they may not
    be. It needs none of what is compiled for contact.
    """
    return start_by(anywhere_apart, pair, Ta, Tb, xi_a, xi_b, has_twist, options, state, given, out)


@entry(PAIR, WRITE, WRITE, WRITE, WRITE, BOOL, READ, WRITE, INT, WRITE, work="contact")
def start(pair, Ta, Tb, xi_a, xi_b, has_twist, options, state, given, out):
    """Begin at a pose: anywhere (a global query), by descent from the state's mode, or there.

    Returns FINE, or what of the poses and twists is refused.
    """
    return start_by(anywhere, pair, Ta, Tb, xi_a, xi_b, has_twist, options, state, given, out)


@kernel
def step_by(frame, pair, Ta, Tb, xi_a, xi_b, has_twist, h, options, state, out, events):
    """`step`, with the law's own frame."""
    refused = refusal(pointer(Ta, 0), pointer(Tb, 0), pointer(xi_a, 0), pointer(xi_b, 0))
    if refused != FINE:
        return refused
    ints, reals = np.empty(4 + N_COUNT_SLOTS, dtype=np.int64), np.empty(8 + N_CHANGES)
    frame(
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


@entry(PAIR, WRITE, WRITE, WRITE, WRITE, BOOL, REAL, READ, WRITE, WRITE, WRITE, work="frames")
def step_predicted(pair, Ta, Tb, xi_a, xi_b, has_twist, h, options, state, out, events):
    """One frame of the predictor-corrector: the state is changed in place, the answer written to
    `out`.

    Returns FINE; or, with nothing changed, what of the poses and twists is refused.
    """
    return step_by(
        frame_predicted, pair, Ta, Tb, xi_a, xi_b, has_twist, h, options, state, out, events
    )


@entry(PAIR, WRITE, WRITE, WRITE, WRITE, BOOL, REAL, READ, WRITE, WRITE, WRITE, work="paper")
def step_paper(pair, Ta, Tb, xi_a, xi_b, has_twist, h, options, state, out, events):
    """`step_predicted`, of the paper's law."""
    return step_by(frame_paper, pair, Ta, Tb, xi_a, xi_b, has_twist, h, options, state, out, events)


@kernel
def run_by(
    frame,
    pair,
    poses_a,
    poses_b,
    twists_a,
    twists_b,
    has_twist,
    steps,
    options,
    state,
    outs,
    events,
):
    """Many frames in one compiled loop, with the law that they are to follow."""
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
        frame(
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


@entry(PAIR, ROWS, ROWS, ROWS, ROWS, BOOL, WRITE, READ, WRITE, ROWS, WRITE, work="runs")
def run_predicted(
    pair, poses_a, poses_b, twists_a, twists_b, has_twist, steps, options, state, outs, events
):
    """Many frames in one compiled loop; row k of `outs` answers for row k of the poses.

    poses (n, 12), twists (n, 6), steps (n,), outs (n, N_OUT). Returns (-1, FINE), or the frame
    that was refused and why; the frames before it are answered.
    """
    return run_by(
        frame_predicted,
        pair,
        poses_a,
        poses_b,
        twists_a,
        twists_b,
        has_twist,
        steps,
        options,
        state,
        outs,
        events,
    )


@entry(PAIR, ROWS, ROWS, ROWS, ROWS, BOOL, WRITE, READ, WRITE, ROWS, WRITE, work="paper runs")
def run_paper(
    pair, poses_a, poses_b, twists_a, twists_b, has_twist, steps, options, state, outs, events
):
    """`run_predicted`, of the paper's law."""
    return run_by(
        frame_paper,
        pair,
        poses_a,
        poses_b,
        twists_a,
        twists_b,
        has_twist,
        steps,
        options,
        state,
        outs,
        events,
    )


def step(pair, Ta, Tb, xi_a, xi_b, has_twist, h, options, state, out, events):
    """One frame of the law that the options name: `step_predicted` or `step_paper`."""
    one = step_paper if options[O_LAW] == LAW_PAPER else step_predicted
    return one(pair, Ta, Tb, xi_a, xi_b, has_twist, h, options, state, out, events)


def run(pair, poses_a, poses_b, twists_a, twists_b, has_twist, steps, options, state, outs, events):
    """Many frames of the law that the options name: `run_predicted` or `run_paper`."""
    many = run_paper if options[O_LAW] == LAW_PAPER else run_predicted
    return many(
        pair, poses_a, poses_b, twists_a, twists_b, has_twist, steps, options, state, outs, events
    )


def start_anywhere(pair, Ta, Tb, xi_a, xi_b, has_twist, options, state, given, out):
    """`start`, by way of `start_apart` while nothing has needed what is compiled for contact."""
    everything = (pair, Ta, Tb, xi_a, xi_b, has_twist, options, state, given, out)
    if getattr(start, "ready", True):
        return start(*everything)
    answered = start_apart(*everything)
    return start(*everything) if answered == NOT_KNOWN_APART else answered
