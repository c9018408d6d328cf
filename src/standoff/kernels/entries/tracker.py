"""The hybrid tracker as Python calls it: starts, frames from block to block or in place, and many
in a row; one call of a frame behind all of them (`frames.frame`).
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
    reals_on_stack,
    small,
)
from standoff.kernels.compiler.entry import BLOCKS, INT, READ, READ_ROWS, REAL, ROWS, WRITE
from standoff.kernels.entries.blocks import (
    N_TABLE,
    Given,
    Polytopes,
    answered,
    answered_by,
    answered_in_place,
    copied,
    fit,
    is_given,
    read_given,
    read_poses,
    started,
    tabled_options,
    tabled_pair,
    where_kept,
)
from standoff.kernels.frame.restart import anywhere, anywhere_apart
from standoff.kernels.lanes.frames import frames_in_lanes
from standoff.kernels.pair.polytope_layout import N_POLYTOPE, N_VERTICES
from standoff.kernels.state.arrays import (
    BAD_ARRAYS,
    BLOCK_DONE,
    BLOCK_POLYTOPE,
    BLOCK_STATE,
    DISTANCE,
    FINE,
    N_BLOCK,
    N_KEEPING_BLOCK,
    N_STATE,
    NOT_KNOWN_APART,
    START_ANYWHERE,
)

RECORDS = types.Tuple((ROWS, ROWS))
MANY_RECORDS = types.Tuple((READ_ROWS, READ_ROWS, ROWS, ROWS))
PART = types.UniTuple(INT, 2)


@entry(INT, WRITE, INT, work="query")
def start_apart(table, block, given):
    """`start` of bodies that are apart; NOT_KNOWN_APART, with nothing changed, where they may not
    be. It needs none of what is compiled for contact.
    """
    return (
        started(anywhere_apart, table, pointer(block, 0), given)
        if len(block) >= N_BLOCK
        else BAD_ARRAYS
    )


@entry(INT, WRITE, INT, work="contact")
def start(table, block, given):
    """Begin at the poses in a block: anywhere (a global query), by descent from the state's mode,
    or there.

    Returns FINE, or what of the poses and twists is refused.
    """
    return (
        started(anywhere, table, pointer(block, 0), given) if len(block) >= N_BLOCK else BAD_ARRAYS
    )


def start_anywhere(table, block, given=START_ANYWHERE):
    """`start`, by way of `start_apart` while nothing has needed what is compiled for contact."""
    if getattr(start, "ready", True):
        return start(table, block, given)
    answer = start_apart(table, block, given)
    return start(table, block, given) if answer == NOT_KNOWN_APART else answer


@kernel
def queried(query_from, table, arrays, block):
    """A start anywhere at poses and twists that are copied into a block."""
    sound, at = read_given(arrays)
    own = pointer(block, 0)
    if not (sound and len(block) >= N_BLOCK and copied(at, 0.0, own)):
        return BAD_ARRAYS
    for k in range(N_STATE):
        own[BLOCK_STATE + k] = 0.0
    own[BLOCK_POLYTOPE] = 0.0
    return started(query_from, table, own, START_ANYWHERE)


@entry(INT, ROWS, ROWS, WRITE, WRITE, WRITE, work="query", terse=True)
def query_apart(table, pose_a, pose_b, twist_a, twist_b, block):
    """`query` of bodies that are apart; NOT_KNOWN_APART where they may not be."""
    return queried(anywhere_apart, table, (pose_a, pose_b, twist_a, twist_b), block)


@entry(INT, ROWS, ROWS, WRITE, WRITE, WRITE, work="contact", terse=True)
def query(table, pose_a, pose_b, twist_a, twist_b, block):
    """`start` anywhere, at poses (4, 4) and twists, (6,) or [NOT_GIVEN], as they are given."""
    return queried(anywhere, table, (pose_a, pose_b, twist_a, twist_b), block)


def query_anywhere(table, pose_a, pose_b, twist_a, twist_b, block):
    """`query`, by way of `query_apart` while nothing has needed what is compiled for contact."""
    if getattr(query, "ready", True):
        return query(table, pose_a, pose_b, twist_a, twist_b, block)
    answer = query_apart(table, pose_a, pose_b, twist_a, twist_b, block)
    if answer == NOT_KNOWN_APART:
        return query(table, pose_a, pose_b, twist_a, twist_b, block)
    return answer


@kernel
def value_at(table, before, given, h, block, polytopes):
    """One frame from the state in one block to another block, both of N_BLOCK numbers or more."""
    if not copied(given, h, block):
        return BAD_ARRAYS
    for k in range(N_STATE):
        block[BLOCK_STATE + k] = before[BLOCK_STATE + k]
    return answered(table, block, N_BLOCK, polytopes)


@kernel
def value_of(table, before, given, h, block):
    """`value` of what was read of the arrays given."""
    sound, at = given
    if not (sound and len(before) >= N_BLOCK and len(block) >= N_BLOCK):
        return BAD_ARRAYS
    old, new = pointer(before, 0), pointer(block, 0)
    scratch = reals_on_stack(N_POLYTOPE)
    scratch[N_VERTICES] = 0.0
    kept = where_kept(old, len(before))
    last = ahead(old, kept) if kept > 0 else scratch
    new[BLOCK_POLYTOPE] = N_BLOCK if len(block) >= N_KEEPING_BLOCK else 0.0
    own = ahead(new, N_BLOCK) if len(block) >= N_KEEPING_BLOCK else scratch
    return value_at(table, old, at, h, new, Polytopes(last, own))


@entry(INT, READ, ROWS, ROWS, WRITE, WRITE, REAL, WRITE, work="frames", terse=True)
def value(table, before, pose_a, pose_b, twist_a, twist_b, h, block):
    """One frame from the state in one block to another block.

    Poses (4, 4) and twists, (6,) or [NOT_GIVEN], are read as they are given. A block of
    N_KEEPING_BLOCK numbers may keep a polytope. Returns FINE; else what is refused, or
    MORE_EVENTS, and the block holds no answer.
    """
    return value_of(table, before, read_given((pose_a, pose_b, twist_a, twist_b)), h, block)


@entry(INT, READ, ROWS, ROWS, REAL, WRITE, work="frames", terse=True)
def value_by_poses(table, before, pose_a, pose_b, h, block):
    """`value` without twists: each array that Python hands over costs a tenth of a microsecond."""
    return value_of(table, before, read_poses(pose_a, pose_b), h, block)


@entry(INT, BLOCKS, BLOCKS, ROWS, ROWS, WRITE, INT, RECORDS, work="runs")
def values(table, poses_a, poses_b, twists_a, twists_b, steps, first, records):
    """`value` of many frames: frame k goes from block k to block k + 1.

    poses (n, 4, 4), twists (n, 6) or (n, 1) of NOT_GIVEN, steps (n,). `records` are blocks
    (n + 1, N_BLOCK) and two polytopes (2, N_POLYTOPE): frame k reads that of k % 2 and keeps the
    other. Begins at frame `first`. Returns the first frame that is not FINE and why; n, FINE at the
    end.
    """
    blocks, polytopes = records
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
        done = value_at(table, old, one, h[k], new, turns)
        if done != FINE:
            return k, done
    return n, FINE


class Many(NamedTuple):
    """What frames of many states read and write; pointers to rows."""

    pair: Any
    options: Any
    poses: Any  # of A, of B: 16 numbers each
    twists: Any  # of A, of B, and how many numbers each
    steps: Any
    records: Any  # old blocks and polytopes, new ones


@kernel
def given_row(many, k):
    """Poses and twists of row k."""
    way_a, way_b, of_a, of_b = many.twists
    twist_a, twist_b = ahead(way_a, of_a * k), ahead(way_b, of_b * k)
    has_a, has_b = is_given(twist_a, of_a), is_given(twist_b, of_b)
    at_a, at_b = ahead(many.poses[0], 16 * k), ahead(many.poses[1], 16 * k)
    return Given(at_a, at_b, twist_a, twist_b, has_a, has_b)


@small
def frame_of_row(many, k):
    """(pair, options, block) of row k."""
    return many.pair, many.options, ahead(many.records[2], N_BLOCK * k)


@small
def begin_row(many, k):
    """Make the block of row k ready: what is given, and the state before. Are there poses?"""
    block = ahead(many.records[2], N_BLOCK * k)
    block[BLOCK_POLYTOPE] = 0.0
    if not copied(given_row(many, k), many.steps[k], block):
        block[BLOCK_DONE] = BAD_ARRAYS
        return False
    before = ahead(many.records[0], N_BLOCK * k)
    for i in range(N_STATE):
        block[BLOCK_STATE + i] = before[BLOCK_STATE + i]
    block[BLOCK_DONE] = FINE
    return True


@small
def end_row(many, k, good):
    """Answer row k by itself where it is not, and was begun."""
    if good:
        return
    block = ahead(many.records[2], N_BLOCK * k)
    if block[BLOCK_DONE] == FINE:
        last, own = ahead(many.records[1], N_POLYTOPE * k), ahead(many.records[3], N_POLYTOPE * k)
        turns = Polytopes(last, own)
        block[BLOCK_DONE] = answered_by(many.pair, many.options, block, N_BLOCK, turns)


@entry(INT, BLOCKS, BLOCKS, ROWS, ROWS, WRITE, PART, MANY_RECORDS, work="runs")
def value_of_each(table, poses_a, poses_b, twists_a, twists_b, steps, part, records):
    """`value` of many states, one frame each: row k goes from its old block to its new one.

    Arrays as of `values`. `records` are old and new blocks (n, N_BLOCK), each followed by its
    polytopes (n, N_POLYTOPE), the new ones 0. Makes rows part[0] .. part[1] - 1; the BLOCK_DONE of
    a new block says what came of it.
    """
    old, old_kept, new, new_kept = records
    n, of_a, of_b = len(steps), twists_a.shape[1], twists_b.shape[1]
    square = poses_a.shape == (n, 4, 4) and poses_b.shape == (n, 4, 4)
    rows = len(twists_a) == n and len(twists_b) == n
    alike = old.shape == (n, N_BLOCK) and new.shape == (n, N_BLOCK)
    kept = old_kept.shape == (n, N_POLYTOPE) and new_kept.shape == (n, N_POLYTOPE)
    if not (square and rows and alike and kept and part[0] >= 0 and part[1] <= n):
        return BAD_ARRAYS
    given = Many(
        tabled_pair(ints_at(table, N_TABLE)),
        tabled_options(ints_at(table, N_TABLE)),
        (pointer(poses_a, 0), pointer(poses_b, 0)),
        (pointer(twists_a, 0), pointer(twists_b, 0), of_a, of_b),
        pointer(steps, 0),
        (pointer(old, 0), pointer(old_kept, 0), pointer(new, 0), pointer(new_kept, 0)),
    )
    for k in range(part[0], part[1]):
        one = given_row(given, k)
        if not fit(of_a, one.has_a, of_b, one.has_b):
            return BAD_ARRAYS
    frames_in_lanes(begin_row, frame_of_row, end_row, given, part[0], part[1])
    return FINE


@entry(INT, WRITE, work="frames")
def step(table, block):
    """One frame in a long block, in place, its polytope with it.

    Returns FINE; or, with nothing changed, what of the poses and twists is refused.
    """
    return answered_in_place(table, pointer(block, 0), len(block))


@kernel
def moved_in_place(table, given, h, block):
    """`moved` of what was read of the arrays given."""
    sound, at = given
    if len(block) < N_BLOCK:
        return np.nan
    done = BAD_ARRAYS
    if sound and copied(at, h, pointer(block, 0)):
        done = answered_in_place(table, pointer(block, 0), len(block))
    block[BLOCK_DONE] = done
    return block[DISTANCE] if done == FINE else np.nan


@entry(INT, ROWS, ROWS, WRITE, WRITE, REAL, WRITE, work="frames", terse=True)
def moved(table, pose_a, pose_b, twist_a, twist_b, h, block):
    """`step` with poses and twists that are copied into the block first.

    Returns the distance where the frame is FINE; else nan, and the block's BLOCK_DONE says why.
    Where poses or twists are refused the block's own may have been written over, nothing else.
    """
    return moved_in_place(table, read_given((pose_a, pose_b, twist_a, twist_b)), h, block)


@entry(INT, ROWS, ROWS, REAL, WRITE, work="frames", terse=True)
def moved_by_poses(table, pose_a, pose_b, h, block):
    """`moved` without twists."""
    return moved_in_place(table, read_poses(pose_a, pose_b), h, block)
