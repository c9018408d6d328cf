"""Cold queries of many poses in one call."""

from math import inf
from typing import Any, NamedTuple

import numpy as np

from standoff.kernels.algebra.rigid import read_rotation, read_vector, relative_pose
from standoff.kernels.compiler.decorators import (
    ahead,
    entry,
    ints_at,
    ints_on_stack,
    kernel,
    pointer,
    reals_on_stack,
    small,
    stack_counts,
    stack_log,
)
from standoff.kernels.compiler.entry import INT, READ_BLOCKS, ROWS, WRITE_INTS
from standoff.kernels.entries.blocks import N_TABLE, copy_pose, tabled_options, tabled_pair
from standoff.kernels.entries.frames import clear_counts, start_frame
from standoff.kernels.frame.inputs import inputs_at, refused
from standoff.kernels.frame.restart import anywhere
from standoff.kernels.frame.smooth_start import smooth_start
from standoff.kernels.lanes.ellipsoids import N_ANSWER, query_block
from standoff.kernels.lanes.layout import N_POSE, lane, put_pose
from standoff.kernels.lanes.layout import ROWS as LANE_ROWS
from standoff.kernels.lanes.rows import TRIED, query_row, whole_ellipsoid
from standoff.kernels.pair.events import CORRECTIONS, EVALUATIONS, N_COUNTS
from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.kernels.state.arrays import (
    BAD_ARRAYS,
    CONVERGED,
    FINE,
    N_MOTION,
    N_OUT,
    N_STATE,
    OUT_COUNTS,
    OUT_RATE,
    POSE_A,
    POSE_B,
    RESIDUAL,
    START_ANYWHERE,
    STATUS,
    TWIST_A,
    is_pose,
)
from standoff.kernels.tolerances import START_GAP
from standoff.kernels.values import Pose, Work


@kernel
def start_at(pair, options, pose_a, pose_b, out):
    """A cold query at poses (4, 4): FINE, or which of them is refused."""
    motion, state = reals_on_stack(N_MOTION), reals_on_stack(N_STATE)
    square = copy_pose(pose_a, ahead(motion, POSE_A))
    if not (copy_pose(pose_b, ahead(motion, POSE_B)) and square):
        return BAD_ARRAYS
    for k in range(TWIST_A, N_MOTION):
        motion[k] = 0.0
    inputs = inputs_at(motion, False)
    why = refused(pair, inputs)
    if why != FINE:
        return why
    for k in range(N_STATE):
        state[k] = 0.0
    none = reals_on_stack(N_POLYTOPE)
    work = Work(stack_counts(), stack_log(), none, none)
    clear_counts(work)
    return start_frame(anywhere, pair, inputs, options, state, START_ANYWHERE, out, work)


class Table(NamedTuple):
    """What all rows of a batch have in common, as pointers to rows of poses (4, 4) and answers."""

    pair: Any
    options: Any
    poses_a: Any
    poses_b: Any
    stride_a: int  # 0 where one pose is given for all rows
    stride_b: int
    outs: Any
    done: Any  # array


@kernel
def start_row(table, k):
    """Answer a row by itself."""
    pose_a = ahead(table.poses_a, table.stride_a * k)
    pose_b = ahead(table.poses_b, table.stride_b * k)
    out = ahead(table.outs, N_OUT * k)
    table.done[k] = start_at(table.pair, table.options, pose_a, pose_b, out)


@kernel
def place_rows(table, first, end, poses, poses_a):
    """Put a block's poses into lanes: B's in A's frame, and A's. The last row stands for those
    that lack."""
    motion = reals_on_stack(N_MOTION)
    for row in range(LANE_ROWS):
        copy_poses(table, min(first + row, end - 1), motion)
        pose, pose_a = placed(motion)
        put_pose(pose, poses, row)
        put_pose(pose_a, poses_a, row)


@small
def copy_poses(table, k, motion):
    """Copy a row's poses as 12 numbers each. Are their last rows 0 0 0 1?"""
    square = copy_pose(ahead(table.poses_a, table.stride_a * k), ahead(motion, POSE_A))
    return copy_pose(ahead(table.poses_b, table.stride_b * k), ahead(motion, POSE_B)) and square


@small
def placed(motion):
    """(B's pose in A's frame, A's) of a row's motion."""
    pose_a = Pose(read_rotation(motion, POSE_A), read_vector(motion, POSE_A + 9))
    return relative_pose(ahead(motion, POSE_A), ahead(motion, POSE_B)), pose_a


@kernel
def are_poses(table, k):
    """Would a row by itself be refused?"""
    motion = reals_on_stack(N_MOTION)
    square = copy_poses(table, k, motion)
    return square and is_pose(ahead(motion, POSE_A)) and is_pose(ahead(motion, POSE_B))


@kernel
def write_row(answers, row, out):
    """Write a row that was answered in lanes."""
    for k in range(OUT_COUNTS):
        out[k] = answers[lane(k, row)]
    complete_row(answers[lane(TRIED, row)], out)


@small
def complete_row(tried, out):
    """Write what the lanes leave out of a row that is apart."""
    for k in range(OUT_RATE, RESIDUAL):
        out[k] = np.nan
    for k in range(N_COUNTS):
        out[OUT_COUNTS + k] = 0.0
    out[STATUS] = CONVERGED
    out[OUT_COUNTS + EVALUATIONS], out[OUT_COUNTS + CORRECTIONS] = tried + 2.0, tried + 1.0


@kernel
def start_ellipsoids(table, first, end):
    """Answer rows in lanes, block by block; those that are not proven there, by themselves."""
    poses, poses_a = reals_on_stack(N_POSE), reals_on_stack(N_POSE)
    answers, good = reals_on_stack(N_ANSWER), ints_on_stack(LANE_ROWS)
    goal = min(table.options.tolerance, START_GAP)
    for begin in range(first, end, LANE_ROWS):
        place_rows(table, begin, end, poses, poses_a)
        query_block(table.pair, goal, poses, poses_a, answers, good)
        for row in range(min(LANE_ROWS, end - begin)):
            k = begin + row
            if good[row] == 1 and are_poses(table, k):
                write_row(answers, row, ahead(table.outs, N_OUT * k))
                table.done[k] = FINE
            else:
                start_row(table, k)


@kernel
def start_ellipsoid(table, k):
    """Answer a row by itself as the lanes do; True, or False where it is not proven so.

    What a thread of a GPU does (`standoff.gpu`).
    """
    motion, out = reals_on_stack(N_MOTION), ahead(table.outs, N_OUT * k)
    square = copy_poses(table, k, motion)
    if not (square and is_pose(ahead(motion, POSE_A)) and is_pose(ahead(motion, POSE_B))):
        return False
    pose, pose_a = placed(motion)
    goal = min(table.options.tolerance, START_GAP)
    good = query_row(table.pair, goal, pose, pose_a, out)
    complete_row(out[TRIED], out)
    return good


@kernel
def start_smooth(look_a, look_b, table, k):
    """Answer a row of two bodies whose faces are of known kinds by itself; True, or False with
    nothing written where a smooth start does not prove it.

    What a thread of a GPU does (`standoff.gpu`).
    """
    motion = reals_on_stack(N_MOTION)
    square = copy_poses(table, k, motion)
    if not (square and is_pose(ahead(motion, POSE_A)) and is_pose(ahead(motion, POSE_B))):
        return False
    goal = min(table.options.tolerance, START_GAP)
    out = ahead(table.outs, N_OUT * k)
    return smooth_start(look_a, look_b, table.pair, inputs_at(motion, False), goal, out)


@entry(INT, READ_BLOCKS, READ_BLOCKS, INT, INT, ROWS, WRITE_INTS, work="contact")
def starts(table, poses_a, poses_b, first, end, outs, done):
    """`start` at rows `first` to `end` - 1 of poses (n, 4, 4), or (1, 4, 4) for all rows.

    Row k is answered into row k of outs (n, N_OUT); done[k] is FINE, or what of it is refused.
    """
    tabled = ints_at(table, N_TABLE)
    pair, options = tabled_pair(tabled), tabled_options(tabled)
    at_a, at_b = poses_a.reshape(poses_a.size), poses_b.reshape(poses_b.size)
    rows = outs.reshape(outs.size)
    stride_a, stride_b = 0 if len(poses_a) == 1 else 16, 0 if len(poses_b) == 1 else 16
    given = Table(
        pair,
        options,
        pointer(at_a, 0),
        pointer(at_b, 0),
        stride_a,
        stride_b,
        pointer(rows, 0),
        done,
    )
    # with a horizon the boxes come first
    if options.within == inf and whole_ellipsoid(pair.ints_a) and whole_ellipsoid(pair.ints_b):
        start_ellipsoids(given, first, end)
    else:
        for k in range(first, end):
            start_row(given, k)
