"""Frames on blocks of memory, as ``Tracker`` calls them: as values, in place, and many in a row.

A block holds a frame's answer, the state after it and what was given (``state.arrays``). Bodies and
options are reached by a table of their addresses.
"""

from typing import Any, NamedTuple

import numpy as np
from numba import types

from standoff.kernels.compiler.decorators import (
    ahead,
    entry,
    ints_at,
    kernel,
    pointer,
    reals_at,
    reals_on_stack,
    stack_counts,
    stack_log,
)
from standoff.kernels.compiler.entry import BLOCKS, INT, READ, REAL, ROWS, WRITE
from standoff.kernels.entries.frames import frame_paper, frame_predicted
from standoff.kernels.entries.tracker import inputs_at, refused
from standoff.kernels.pair.events import EVENT_COLUMNS, EVENTS
from standoff.kernels.pair.polytope_layout import N_POLYTOPE, N_VERTICES
from standoff.kernels.state.arrays import (
    BAD_ARRAYS,
    BLOCK_DONE,
    BLOCK_EVENTS,
    BLOCK_HAS_TWIST,
    BLOCK_MOTION,
    BLOCK_POLYTOPE,
    BLOCK_STATE,
    BLOCK_TIME_STEP,
    DISTANCE,
    FINE,
    MORE_EVENTS,
    N_BLOCK,
    N_KEEPING_BLOCK,
    N_STATE,
    NOT_GIVEN,
    POSE_A,
    POSE_B,
    TWIST_A,
    TWIST_B,
)
from standoff.kernels.state.options import read_options
from standoff.kernels.values import Pair, Work

RECORDS = types.Tuple((ROWS, ROWS))

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


class Polytopes(NamedTuple):
    """Where the polytope of the frame before stands, and where this one's may be kept."""

    last: Any  # pointers
    own: Any


@kernel
def where_kept(block, length):
    """Where a block's polytope begins; 0 where it has none."""
    first = block[BLOCK_POLYTOPE]
    return int(first) if N_BLOCK <= first <= length - N_POLYTOPE else 0


@kernel
def answered(frame, table, block, room, polytopes):
    """One frame on a block with switches up to its `room`-th number: the state is changed in place,
    the answer and its switches written."""
    inputs = inputs_at(ahead(block, BLOCK_MOTION), block[BLOCK_HAS_TWIST] != 0.0)
    why = refused(inputs)
    if why != FINE:
        return why
    counts, log = stack_counts(), stack_log()
    tabled = ints_at(table, N_TABLE)
    options = read_options(reals_at(tabled[TABLE_OPTIONS], tabled[TABLE_OPTIONS + 1]))
    state, out = ahead(block, BLOCK_STATE), block
    work = Work(counts, log, polytopes.last, polytopes.own)
    frame(tabled_pair(tabled), inputs, block[BLOCK_TIME_STEP], options, state, out, work)
    switches = counts[EVENTS]
    if BLOCK_EVENTS + EVENT_COLUMNS * switches > room:
        return MORE_EVENTS
    for k in range(EVENT_COLUMNS * switches):
        block[BLOCK_EVENTS + k] = log[k]
    return FINE


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
def read_given(arrays):
    """(are they poses and twists by their shapes, where they stand)."""
    pose_a, pose_b, twist_a, twist_b = arrays
    square = pose_a.shape == (4, 4) and pose_b.shape == (4, 4)
    has_a, has_b = is_given(twist_a, len(twist_a)), is_given(twist_b, len(twist_b))
    at = Given(
        pointer(pose_a, 0),
        pointer(pose_b, 0),
        pointer(twist_a, 0),
        pointer(twist_b, 0),
        has_a,
        has_b,
    )
    return square and fit(len(twist_a), has_a, len(twist_b), has_b), at


@kernel
def copied(given, h, block):
    """Copy a frame's poses, twists and time into its block. False where a pose is none."""
    motion = ahead(block, BLOCK_MOTION)
    square = copy_pose(given.pose_a, ahead(motion, POSE_A))
    if not (copy_pose(given.pose_b, ahead(motion, POSE_B)) and square):
        return False
    copy_twist(given.twist_a, given.has_a, ahead(motion, TWIST_A))
    copy_twist(given.twist_b, given.has_b, ahead(motion, TWIST_B))
    block[BLOCK_TIME_STEP] = h
    block[BLOCK_HAS_TWIST] = 1.0 if given.has_a or given.has_b else 0.0
    return True


@kernel
def value_at(frame, table, before, given, h, block, polytopes):
    """One frame from the state in one block to another block, both of N_BLOCK numbers or more."""
    if not copied(given, h, block):
        return BAD_ARRAYS
    for k in range(N_STATE):
        block[BLOCK_STATE + k] = before[BLOCK_STATE + k]
    return answered(frame, table, block, N_BLOCK, polytopes)


@kernel
def value_by(frame, table, before, given, h, block):
    """`value_predicted`, with the law's own frame."""
    sound, at = read_given(given)
    if not (sound and len(before) >= N_BLOCK and len(block) >= N_BLOCK):
        return BAD_ARRAYS
    old, new = pointer(before, 0), pointer(block, 0)
    scratch = reals_on_stack(N_POLYTOPE)
    scratch[N_VERTICES] = 0.0
    kept = where_kept(old, len(before))
    last = ahead(old, kept) if kept > 0 else scratch
    new[BLOCK_POLYTOPE] = N_BLOCK if len(block) >= N_KEEPING_BLOCK else 0.0
    own = ahead(new, N_BLOCK) if len(block) >= N_KEEPING_BLOCK else scratch
    return value_at(frame, table, old, at, h, new, Polytopes(last, own))


@entry(INT, READ, ROWS, ROWS, WRITE, WRITE, REAL, WRITE, work="frames", terse=True)
def value_predicted(table, before, pose_a, pose_b, twist_a, twist_b, h, block):
    """One frame of the predictor-corrector from the state in one block to another block.

    Poses (4, 4) and twists, (6,) or [NOT_GIVEN], are read as they are given. A block of
    N_KEEPING_BLOCK numbers may keep a polytope. Returns FINE; else what is refused, or MORE_EVENTS,
    and the block is of no worth.
    """
    given = pose_a, pose_b, twist_a, twist_b
    return value_by(frame_predicted, table, before, given, h, block)


@entry(INT, READ, ROWS, ROWS, WRITE, WRITE, REAL, WRITE, work="paper", terse=True)
def value_paper(table, before, pose_a, pose_b, twist_a, twist_b, h, block):
    """`value_predicted`, of the paper's law."""
    given = pose_a, pose_b, twist_a, twist_b
    return value_by(frame_paper, table, before, given, h, block)


@kernel
def values_by(frame, table, given, steps, first, blocks, polytopes):
    """`values_predicted`, with the law's own frame."""
    poses_a, poses_b, twists_a, twists_b = given
    n, of_a, of_b = len(steps), twists_a.shape[1], twists_b.shape[1]
    at_a, at_b = pointer(poses_a, 0), pointer(poses_b, 0)
    way_a, way_b = pointer(twists_a, 0), pointer(twists_b, 0)
    block, h = pointer(blocks, 0), pointer(steps, 0)
    square = poses_a.shape == (n, 4, 4) and poses_b.shape == (n, 4, 4)
    rows = len(twists_a) == n and len(twists_b) == n and blocks.shape == (n + 1, N_BLOCK)
    kept = pointer(polytopes, 0)
    if not (square and rows and polytopes.shape == (2, N_POLYTOPE)):
        return first, BAD_ARRAYS
    for k in range(first, n):
        twist_a, twist_b = ahead(way_a, of_a * k), ahead(way_b, of_b * k)
        has_a, has_b = is_given(twist_a, of_a), is_given(twist_b, of_b)
        if not fit(of_a, has_a, of_b, has_b):
            return k, BAD_ARRAYS
        one = Given(ahead(at_a, 16 * k), ahead(at_b, 16 * k), twist_a, twist_b, has_a, has_b)
        old, new = ahead(block, N_BLOCK * k), ahead(block, N_BLOCK * (k + 1))
        new[BLOCK_POLYTOPE] = 0.0
        turns = Polytopes(
            ahead(kept, N_POLYTOPE * (k % 2)), ahead(kept, N_POLYTOPE * ((k + 1) % 2))
        )
        done = value_at(frame, table, old, one, h[k], new, turns)
        if done != FINE:
            return k, done
    return n, FINE


@entry(INT, BLOCKS, BLOCKS, ROWS, ROWS, WRITE, INT, RECORDS, work="runs")
def values_predicted(table, poses_a, poses_b, twists_a, twists_b, steps, first, records):
    """`value_predicted` of many frames: frame k goes from block k to block k + 1.

    poses (n, 4, 4), twists (n, 6) or (n, 1) of NOT_GIVEN, steps (n,). `records` are blocks
    (n + 1, N_BLOCK) and two polytopes (2, N_POLYTOPE): frame k reads that of k % 2 and keeps the
    other. Begins at frame `first`. Returns the first frame that is not FINE and why; n, FINE at the
    end.
    """
    given = poses_a, poses_b, twists_a, twists_b
    return values_by(frame_predicted, table, given, steps, first, records[0], records[1])


@entry(INT, BLOCKS, BLOCKS, ROWS, ROWS, WRITE, INT, RECORDS, work="paper runs")
def values_paper(table, poses_a, poses_b, twists_a, twists_b, steps, first, records):
    """`values_predicted`, of the paper's law."""
    given = poses_a, poses_b, twists_a, twists_b
    return values_by(frame_paper, table, given, steps, first, records[0], records[1])


@kernel
def answered_in_place(frame, table, block):
    """`step_predicted`, with the law's own frame."""
    at = pointer(block, 0)
    kept = where_kept(at, len(block))
    scratch = reals_on_stack(N_POLYTOPE)
    scratch[N_VERTICES] = 0.0
    own = ahead(at, kept) if kept > 0 else scratch
    room = kept if kept > 0 else len(block)
    return answered(frame, table, at, room, Polytopes(own, own))


@entry(INT, WRITE, work="frames")
def step_predicted(table, block):
    """One frame of the predictor-corrector in a long block, in place, its polytope with it.

    Returns FINE; or, with nothing changed, what of the poses and twists is refused.
    """
    return answered_in_place(frame_predicted, table, block)


@entry(INT, WRITE, work="paper")
def step_paper(table, block):
    """`step_predicted`, of the paper's law."""
    return answered_in_place(frame_paper, table, block)


@kernel
def moved_in_place(frame, table, given, h, block):
    """`moved_predicted`, with the law's own frame."""
    sound, at = read_given(given)
    if len(block) < N_BLOCK:
        return np.nan
    done = BAD_ARRAYS
    if sound and copied(at, h, pointer(block, 0)):
        done = answered_in_place(frame, table, block)
    block[BLOCK_DONE] = done
    return block[DISTANCE] if done == FINE else np.nan


@entry(INT, ROWS, ROWS, WRITE, WRITE, REAL, WRITE, work="frames", terse=True)
def moved_predicted(table, pose_a, pose_b, twist_a, twist_b, h, block):
    """`step_predicted` with poses and twists that are copied into the block first.

    Returns the distance where the frame is FINE; else nan, and the block's BLOCK_DONE says why.
    Where poses or twists are refused the block's own may have been written over, nothing else.
    """
    return moved_in_place(frame_predicted, table, (pose_a, pose_b, twist_a, twist_b), h, block)


@entry(INT, ROWS, ROWS, WRITE, WRITE, REAL, WRITE, work="paper", terse=True)
def moved_paper(table, pose_a, pose_b, twist_a, twist_b, h, block):
    """`moved_predicted`, of the paper's law."""
    return moved_in_place(frame_paper, table, (pose_a, pose_b, twist_a, twist_b), h, block)
