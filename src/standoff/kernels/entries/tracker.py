"""The hybrid tracker as Python calls it: starts, steps and runs of frames on flat arrays.

The state goes in and comes out as one float64 array, so that it is a value. A step answers for the
poses it is given; a frame's poses and twists are one row of numbers (``state.arrays``).
"""

from typing import Any, NamedTuple

import numpy as np

from standoff.kernels.compiler.decorators import (
    ahead,
    entry,
    ints_at,
    kernel,
    pointer,
    reals_at,
    stack_counts,
    stack_log,
)
from standoff.kernels.compiler.entry import BLOCKS, BOOL, INT, PAIR, READ, REAL, ROWS, WRITE
from standoff.kernels.entries.frames import frame_paper, frame_predicted, start_frame
from standoff.kernels.frame.inputs import Inputs
from standoff.kernels.frame.restart import anywhere, anywhere_apart
from standoff.kernels.pair.events import EVENT_COLUMNS, EVENTS, MAX_EVENTS, N_COUNT_SLOTS
from standoff.kernels.state.arrays import (
    BAD_ARRAYS,
    BLOCK_EVENTS,
    BLOCK_HAS_TWIST,
    BLOCK_MOTION,
    BLOCK_STATE,
    BLOCK_TIME_STEP,
    FINE,
    MORE_EVENTS,
    N_BLOCK,
    N_MOTION,
    N_OUT,
    N_STATE,
    NOT_CERTIFIED,
    NOT_GIVEN,
    NOT_KNOWN_APART,
    POSE_A,
    POSE_B,
    STATUS,
    TWIST_A,
    TWIST_B,
    UNDECIDED,
    refusal,
)
from standoff.kernels.state.options import names_paper_law, read_options
from standoff.kernels.values import Pair, Work


@kernel
def pair_pointers(pair):
    return Pair(pointer(pair[0], 0), pointer(pair[1], 0), pointer(pair[2], 0), pointer(pair[3], 0))


# What a table of addresses holds: each followed by how many elements lie there.
TABLE_INTS_A, TABLE_REALS_A, TABLE_INTS_B, TABLE_REALS_B, TABLE_OPTIONS = range(0, 10, 2)
N_TABLE = 10


@kernel
def tabled_pair(table):
    return Pair(
        ints_at(table[TABLE_INTS_A], table[TABLE_INTS_A + 1]),
        reals_at(table[TABLE_REALS_A], table[TABLE_REALS_A + 1]),
        ints_at(table[TABLE_INTS_B], table[TABLE_INTS_B + 1]),
        reals_at(table[TABLE_REALS_B], table[TABLE_REALS_B + 1]),
    )


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
def answered(frame, table, block, room):
    """One frame on a block of `room` numbers: the state is changed in place, the answer and its
    switches written."""
    inputs = inputs_at(ahead(block, BLOCK_MOTION), block[BLOCK_HAS_TWIST] != 0.0)
    why = refused(inputs)
    if why != FINE:
        return why
    counts, log = stack_counts(), stack_log()
    tabled = ints_at(table, N_TABLE)
    options = read_options(reals_at(tabled[TABLE_OPTIONS], tabled[TABLE_OPTIONS + 1]))
    state, out = ahead(block, BLOCK_STATE), block
    frame(
        tabled_pair(tabled), inputs, block[BLOCK_TIME_STEP], options, state, out, Work(counts, log)
    )
    switches = counts[EVENTS]
    if BLOCK_EVENTS + EVENT_COLUMNS * switches > room:
        return MORE_EVENTS
    for k in range(EVENT_COLUMNS * switches):
        block[BLOCK_EVENTS + k] = log[k]
    return UNDECIDED if out[STATUS] == NOT_CERTIFIED else FINE


class Given(NamedTuple):
    """Poses and twists as Python gives them."""

    pose_a: Any  # pointers to 16 numbers, (4, 4) by rows
    pose_b: Any
    twist_a: Any  # pointers to 6 numbers, or to NOT_GIVEN
    twist_b: Any
    has_a: bool  # is there a twist?
    has_b: bool


@kernel
def copy_pose(matrix, motion):
    """Copy a (4, 4) pose as 12 numbers. Is its last row 0 0 0 1?"""
    for i in range(3):
        for j in range(3):
            motion[3 * i + j] = matrix[4 * i + j]
        motion[9 + i] = matrix[4 * i + 3]
    last = matrix[12] == 0.0 and matrix[13] == 0.0 and matrix[14] == 0.0
    return last and matrix[15] == 1.0


@kernel
def is_given(twist, length):
    """Is it more than the mark of a twist that was not given?"""
    return not (length == 1 and twist[0] == NOT_GIVEN)


@kernel
def copy_twist(twist, given, motion):
    """Copy a twist: where none was given, the body is at rest."""
    for k in range(6):
        motion[k] = twist[k] if given else 0.0


@kernel
def fit(length_a, has_a, length_b, has_b):
    """Are two twists of six numbers, where they are given?"""
    return (length_a == 6 or not has_a) and (length_b == 6 or not has_b)


@kernel
def value_at(frame, table, before, given, h, block):
    """One frame from the state in one block to another block, both of N_BLOCK numbers."""
    motion = ahead(block, BLOCK_MOTION)
    square = copy_pose(given.pose_a, ahead(motion, POSE_A))
    if not (copy_pose(given.pose_b, ahead(motion, POSE_B)) and square):
        return BAD_ARRAYS
    copy_twist(given.twist_a, given.has_a, ahead(motion, TWIST_A))
    copy_twist(given.twist_b, given.has_b, ahead(motion, TWIST_B))
    for k in range(N_STATE):
        block[BLOCK_STATE + k] = before[BLOCK_STATE + k]
    block[BLOCK_TIME_STEP] = h
    block[BLOCK_HAS_TWIST] = 1.0 if given.has_a or given.has_b else 0.0
    return answered(frame, table, block, N_BLOCK)


@kernel
def value_by(frame, table, before, given, h, block):
    """`value_predicted`, with the law's own frame."""
    pose_a, pose_b, twist_a, twist_b = given
    square = pose_a.shape == (4, 4) and pose_b.shape == (4, 4)
    has_a, has_b = is_given(twist_a, len(twist_a)), is_given(twist_b, len(twist_b))
    long_enough = len(before) >= N_BLOCK and len(block) >= N_BLOCK
    if not (square and long_enough and fit(len(twist_a), has_a, len(twist_b), has_b)):
        return BAD_ARRAYS
    at = Given(
        pointer(pose_a, 0),
        pointer(pose_b, 0),
        pointer(twist_a, 0),
        pointer(twist_b, 0),
        has_a,
        has_b,
    )
    return value_at(frame, table, pointer(before, 0), at, h, pointer(block, 0))


@entry(INT, READ, ROWS, ROWS, WRITE, WRITE, REAL, WRITE, work="frames", terse=True)
def value_predicted(table, before, pose_a, pose_b, twist_a, twist_b, h, block):
    """One frame of the predictor-corrector from the state in one block to another block.

    Poses (4, 4) and twists, (6,) or [NOT_GIVEN], are read as they are given. Returns FINE or
    UNDECIDED; else what is refused, or MORE_EVENTS, and the block is of no worth.
    """
    given = pose_a, pose_b, twist_a, twist_b
    return value_by(frame_predicted, table, before, given, h, block)


@entry(INT, READ, ROWS, ROWS, WRITE, WRITE, REAL, WRITE, work="paper", terse=True)
def value_paper(table, before, pose_a, pose_b, twist_a, twist_b, h, block):
    """`value_predicted`, of the paper's law."""
    given = pose_a, pose_b, twist_a, twist_b
    return value_by(frame_paper, table, before, given, h, block)


@kernel
def values_by(frame, table, given, steps, first, blocks):
    """`values_predicted`, with the law's own frame."""
    poses_a, poses_b, twists_a, twists_b = given
    n, of_a, of_b = len(steps), twists_a.shape[1], twists_b.shape[1]
    at_a, at_b = pointer(poses_a, 0), pointer(poses_b, 0)
    way_a, way_b = pointer(twists_a, 0), pointer(twists_b, 0)
    block, h = pointer(blocks, 0), pointer(steps, 0)
    square = poses_a.shape == (n, 4, 4) and poses_b.shape == (n, 4, 4)
    rows = len(twists_a) == n and len(twists_b) == n and blocks.shape == (n + 1, N_BLOCK)
    if not (square and rows):
        return first, BAD_ARRAYS
    for k in range(first, n):
        twist_a, twist_b = ahead(way_a, of_a * k), ahead(way_b, of_b * k)
        has_a, has_b = is_given(twist_a, of_a), is_given(twist_b, of_b)
        if not fit(of_a, has_a, of_b, has_b):
            return k, BAD_ARRAYS
        one = Given(ahead(at_a, 16 * k), ahead(at_b, 16 * k), twist_a, twist_b, has_a, has_b)
        old, new = ahead(block, N_BLOCK * k), ahead(block, N_BLOCK * (k + 1))
        done = value_at(frame, table, old, one, h[k], new)
        if done != FINE:
            return k, done
    return n, FINE


@entry(INT, BLOCKS, BLOCKS, ROWS, ROWS, WRITE, INT, ROWS, work="runs")
def values_predicted(table, poses_a, poses_b, twists_a, twists_b, steps, first, blocks):
    """`value_predicted` of many frames: frame k goes from block k to block k + 1.

    poses (n, 4, 4), twists (n, 6) or (n, 1) of NOT_GIVEN, steps (n,), blocks (n + 1, N_BLOCK).
    Begins at frame `first`. Returns the first frame that is not FINE and why; n, FINE at the end.
    """
    given = poses_a, poses_b, twists_a, twists_b
    return values_by(frame_predicted, table, given, steps, first, blocks)


@entry(INT, BLOCKS, BLOCKS, ROWS, ROWS, WRITE, INT, ROWS, work="paper runs")
def values_paper(table, poses_a, poses_b, twists_a, twists_b, steps, first, blocks):
    """`values_predicted`, of the paper's law."""
    given = poses_a, poses_b, twists_a, twists_b
    return values_by(frame_paper, table, given, steps, first, blocks)


@entry(INT, WRITE, work="frames")
def step_predicted(table, block):
    """One frame of the predictor-corrector in a long block, in place.

    Returns FINE or UNDECIDED; or, with nothing changed, what of the poses and twists is refused.
    """
    return answered(frame_predicted, table, pointer(block, 0), len(block))


@entry(INT, WRITE, work="paper")
def step_paper(table, block):
    """`step_predicted`, of the paper's law."""
    return answered(frame_paper, table, pointer(block, 0), len(block))


@kernel
def run_by(frame, pair, given, steps, options, state, outs, events):
    """Many frames in one compiled loop, with the law that they are to follow. `given` is (motions,
    has_twist).
    """
    motions, has_twist = given
    numbers, answers, length = motions.ravel(), outs.ravel(), len(motions)
    motion, out = pointer(numbers, 0), pointer(answers, 0)
    counts = np.empty(N_COUNT_SLOTS, dtype=np.int64)
    work = Work(pointer(counts, 0), pointer(events, 0))
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

    motions (n, N_MOTION), steps (n,), outs (n, N_OUT). Returns (-1, FINE), or the frame
    that was refused and why; the frames before it are answered.
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
