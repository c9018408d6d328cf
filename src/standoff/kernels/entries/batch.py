"""Cold queries of many poses in one call."""

from math import inf
from typing import Any, NamedTuple

import numpy as np

from standoff.kernels.algebra.rigid import read_rotation, read_vector, relative_pose
from standoff.kernels.compiler.decorators import (
    ahead,
    entry,
    ints_on_stack,
    kernel,
    pointer,
    reals_on_stack,
    small,
    stack_counts,
    stack_log,
)
from standoff.kernels.compiler.entry import INT, INTS, READ_BLOCKS, ROWS, WRITE_INTS
from standoff.kernels.entries.blocks import N_TABLE, copy_pose, tabled_options, tabled_pair
from standoff.kernels.entries.frames import clear_counts, start_frame
from standoff.kernels.frame.inputs import inputs_at, refused
from standoff.kernels.frame.restart import anywhere
from standoff.kernels.frame.smooth_start import smooth_start
from standoff.kernels.lanes.cold_layout import block_on_stack
from standoff.kernels.lanes.ellipsoids import query_block
from standoff.kernels.lanes.layout import ROWS as LANE_ROWS
from standoff.kernels.lanes.layout import lane, put_pose
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


class Rows(NamedTuple):
    """Rows of poses (4, 4) and of answers, as pointers."""

    poses_a: Any
    poses_b: Any
    stride_a: int  # 0 where one pose is given for all rows
    stride_b: int
    outs: Any
    done: Any  # array


class Pairs(NamedTuple):
    """Which bodies each row is of, as pointers."""

    tables: Any  # integers: tables of addresses, one behind the other
    which: Any  # integers: the number of each row's table
    stride: int  # 0 where one is given for all rows


class Batch(NamedTuple):
    """All that is given."""

    pairs: Pairs
    rows: Rows


@kernel
def table_of(batch, k):
    """The table of a row."""
    pairs = batch.pairs
    return ahead(pairs.tables, N_TABLE * pairs.which[pairs.stride * k])


@kernel
def pair_at(batch, k):
    """The bodies of a row."""
    return tabled_pair(table_of(batch, k))


@small
def poses_of(rows, k):
    """Where a row's poses are."""
    return ahead(rows.poses_a, rows.stride_a * k), ahead(rows.poses_b, rows.stride_b * k)


@kernel
def start_row(batch, k):
    """Answer a row by itself."""
    rows, table = batch.rows, table_of(batch, k)
    pose_a, pose_b = poses_of(rows, k)
    out = ahead(rows.outs, N_OUT * k)
    rows.done[k] = start_at(tabled_pair(table), tabled_options(table), pose_a, pose_b, out)


@small
def copy_poses(rows, k, motion):
    """Copy a row's poses as 12 numbers each. Are their last rows 0 0 0 1?"""
    pose_a, pose_b = poses_of(rows, k)
    square = copy_pose(pose_a, ahead(motion, POSE_A))
    return copy_pose(pose_b, ahead(motion, POSE_B)) and square


@small
def placed(motion):
    """(B's pose in A's frame, A's) of a row's motion."""
    pose_a = Pose(read_rotation(motion, POSE_A), read_vector(motion, POSE_A + 9))
    return relative_pose(ahead(motion, POSE_A), ahead(motion, POSE_B)), pose_a


@kernel
def read_places(rows, k, motion):
    """Copy a row's poses. Are they poses, or would a row by itself be refused?"""
    square = copy_poses(rows, k, motion)
    return square and is_pose(ahead(motion, POSE_A)) and is_pose(ahead(motion, POSE_B))


@small
def goal_of(options):
    """How narrow the gap of a proof must be, in spans."""
    return min(options.tolerance, START_GAP)


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
def may_lane(batch, k):
    """Is a row of two ellipsoids? With a horizon the boxes come first."""
    table = table_of(batch, k)
    pair, options = tabled_pair(table), tabled_options(table)
    whole = whole_ellipsoid(pair.ints_a) and whole_ellipsoid(pair.ints_b)
    return whole and options.within == inf


@kernel
def put_row(batch, k, lanes, row):
    """Put a row into lanes; False where it would be refused."""
    motion = reals_on_stack(N_MOTION)
    if not read_places(batch.rows, k, motion):
        return False
    pose, pose_a = placed(motion)
    put_pose(pose, lanes.poses, row)
    put_pose(pose_a, lanes.poses_a, row)
    lanes.goals[row] = goal_of(tabled_options(table_of(batch, k)))
    return True


@kernel
def are_alike(batch, which):
    """Are all rows of a block of the same two bodies?"""
    others, pairs = 0, batch.pairs
    first = pairs.which[pairs.stride * which[0]]
    for row in range(LANE_ROWS):
        others += 0 if pairs.which[pairs.stride * which[row]] == first else 1
    return others == 0


@kernel
def finish_block(batch, which, n, lanes):
    """Answer the n rows of a block; those that are not proven there, by themselves."""
    if n == 0:
        return
    for row in range(n, LANE_ROWS):  # the last row stands for those that lack
        which[row] = which[n - 1]
        put_row(batch, which[row], lanes, row)
    query_block(pair_at, batch, which, are_alike(batch, which), lanes)
    for row in range(n):
        k = which[row]
        if lanes.good[row] == 1:
            write_row(lanes.answers, row, ahead(batch.rows.outs, N_OUT * k))
            batch.rows.done[k] = FINE
        else:
            start_row(batch, k)


@kernel
def start_rows(batch, first, end):
    """Answer rows, those of ellipsoids in lanes; no row's numbers depend on its neighbours."""
    lanes, which, n = block_on_stack(), ints_on_stack(LANE_ROWS), 0
    last, fits = -1, False
    for k in range(first, end):
        number = batch.pairs.which[batch.pairs.stride * k]
        if number != last:
            last, fits = number, may_lane(batch, k)
        if fits and put_row(batch, k, lanes, n):
            which[n] = k
            n += 1
        else:
            start_row(batch, k)
        if n == LANE_ROWS:
            finish_block(batch, which, n, lanes)
            n = 0
    finish_block(batch, which, n, lanes)


@kernel
def start_ellipsoid(pair, options, rows, k):
    """Answer a row by itself as the lanes do; True, or False where it is not proven so.

    What a thread of a GPU does (`standoff.gpu`).
    """
    motion, out = reals_on_stack(N_MOTION), ahead(rows.outs, N_OUT * k)
    if not read_places(rows, k, motion):
        return False
    pose, pose_a = placed(motion)
    good = query_row(pair, goal_of(options), pose, pose_a, out)
    complete_row(out[TRIED], out)
    return good


@kernel
def start_smooth(look_a, look_b, pair, options, rows, k):
    """Answer a row of two bodies whose faces are of known kinds by itself; True, or False with
    nothing written where a smooth start does not prove it.

    What a thread of a GPU does (`standoff.gpu`).
    """
    motion = reals_on_stack(N_MOTION)
    if not read_places(rows, k, motion):
        return False
    out = ahead(rows.outs, N_OUT * k)
    return smooth_start(look_a, look_b, pair, inputs_at(motion, False), goal_of(options), out)


@entry(INTS, INTS, READ_BLOCKS, READ_BLOCKS, INT, INT, ROWS, WRITE_INTS, work="contact")
def starts(tables, which, poses_a, poses_b, first, end, outs, done):
    """`start` at rows `first` to `end` - 1 of poses (n, 4, 4), or (1, 4, 4) for all rows.

    `tables` are tables of addresses of bodies and options, one behind the other; which (n,), or
    (1,) for all rows, are their numbers. Row k is answered into row k of outs (n, N_OUT); done[k]
    is FINE, or what of it is refused.
    """
    at_a, at_b = poses_a.reshape(poses_a.size), poses_b.reshape(poses_b.size)
    numbers = outs.reshape(outs.size)
    stride_a, stride_b = 0 if len(poses_a) == 1 else 16, 0 if len(poses_b) == 1 else 16
    rows = Rows(pointer(at_a, 0), pointer(at_b, 0), stride_a, stride_b, pointer(numbers, 0), done)
    pairs = Pairs(pointer(tables, 0), pointer(which, 0), 0 if len(which) == 1 else 1)
    start_rows(Batch(pairs, rows), first, end)
