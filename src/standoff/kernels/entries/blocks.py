"""Frames on blocks of memory: what the entries of a tracker, of batches and of C have in common.

A block holds a frame's answer, the state after it and what was given (``state.arrays``). Bodies and
options are reached by a table of their addresses.
"""

from typing import Any, NamedTuple

from standoff.kernels.compiler.decorators import (
    ahead,
    ints_at,
    kernel,
    pointer,
    reals_at,
    reals_on_stack,
    stack_counts,
    stack_log,
)
from standoff.kernels.entries.frames import clear_counts, frame, has_frame, start_frame
from standoff.kernels.frame.inputs import inputs_at, refused
from standoff.kernels.pair.events import EVENT_COLUMNS, EVENTS
from standoff.kernels.pair.polytope_layout import N_POLYTOPE, N_VERTICES
from standoff.kernels.state.arrays import (
    BAD_ARRAYS,
    BLOCK_EVENTS,
    BLOCK_HAS_TWIST,
    BLOCK_MOTION,
    BLOCK_POLYTOPE,
    BLOCK_STATE,
    BLOCK_TIME_STEP,
    FINE,
    MORE_EVENTS,
    N_BLOCK,
    NOT_GIVEN,
    POSE_A,
    POSE_B,
    TWIST_A,
    TWIST_B,
)
from standoff.kernels.state.options import read_options
from standoff.kernels.values import Pair, Work

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
def tabled_options(table):
    return read_options(reals_at(table[TABLE_OPTIONS], table[TABLE_OPTIONS + 1]))


class Polytopes(NamedTuple):
    """Where the polytope of the frame before is, and where this one's may be kept."""

    last: Any  # pointers
    own: Any


@kernel
def where_kept(block, length):
    """Where a block's polytope begins; 0 where it has none."""
    first = block[BLOCK_POLYTOPE]
    return int(first) if N_BLOCK <= first <= length - N_POLYTOPE else 0


@kernel
def answered(table, block, room, polytopes):
    """One frame on a block with switches up to its `room`-th number: the state is changed in place,
    the answer and its switches written."""
    tabled = ints_at(table, N_TABLE)
    return answered_by(tabled_pair(tabled), tabled_options(tabled), block, room, polytopes)


@kernel
def answered_by(pair, options, block, room, polytopes):
    """`answered` of a pair that is at hand."""
    inputs = inputs_at(ahead(block, BLOCK_MOTION), block[BLOCK_HAS_TWIST] != 0.0)
    why = refused(pair, inputs)
    if why != FINE:
        return why
    if not has_frame(options):
        return BAD_ARRAYS
    counts, log = stack_counts(), stack_log()
    state, out = ahead(block, BLOCK_STATE), block
    work = Work(counts, log, polytopes.last, polytopes.own)
    frame(pair, inputs, block[BLOCK_TIME_STEP], options, state, out, work)
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
def read_poses(pose_a, pose_b):
    """`read_given` where no twists are given."""
    a, b = pointer(pose_a, 0), pointer(pose_b, 0)
    square = pose_a.shape == (4, 4) and pose_b.shape == (4, 4)
    return square, Given(a, b, a, b, False, False)


@kernel
def copied(given, h, block):
    """Copy a frame's poses, twists and time into its block. False where a pose is invalid."""
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
def started(query_from, table, block, given):
    """A start on a block, at the poses in it: anywhere by the query, or from the state in it.

    Returns FINE, or what is refused, or NOT_KNOWN_APART; nothing is changed then.
    """
    tabled = ints_at(table, N_TABLE)
    return started_by(query_from, tabled_pair(tabled), tabled_options(tabled), block, given)


@kernel
def started_by(query_from, pair, options, block, given):
    """`started` of a pair that is at hand."""
    inputs = inputs_at(ahead(block, BLOCK_MOTION), block[BLOCK_HAS_TWIST] != 0.0)
    why = refused(pair, inputs)
    if why != FINE:
        return why
    state = ahead(block, BLOCK_STATE)
    none = reals_on_stack(N_POLYTOPE)  # a start has none, and keeps none
    work = Work(stack_counts(), stack_log(), none, none)
    clear_counts(work)
    return start_frame(query_from, pair, inputs, options, state, given, block, work)


@kernel
def answered_in_place(table, block, length):
    """`answered` on a block of `length` numbers, its polytope in place with it."""
    kept = where_kept(block, length)
    scratch = reals_on_stack(N_POLYTOPE)
    scratch[N_VERTICES] = 0.0
    own = ahead(block, kept) if kept > 0 else scratch
    return answered(table, block, kept if kept > 0 else length, Polytopes(own, own))
