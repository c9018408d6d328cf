"""Cold queries of many poses in one call."""

from standoff.kernels.compiler.decorators import (
    ahead,
    entry,
    ints_at,
    kernel,
    pointer,
    reals_on_stack,
    stack_counts,
    stack_log,
)
from standoff.kernels.compiler.entry import INT, READ_BLOCKS, ROWS, WRITE_INTS
from standoff.kernels.entries.blocks import N_TABLE, copy_pose, tabled_options, tabled_pair
from standoff.kernels.entries.frames import clear_counts, start_frame
from standoff.kernels.frame.inputs import inputs_at, refused
from standoff.kernels.frame.restart import anywhere
from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.kernels.state.arrays import (
    BAD_ARRAYS,
    FINE,
    N_MOTION,
    N_OUT,
    N_STATE,
    POSE_A,
    POSE_B,
    START_ANYWHERE,
    TWIST_A,
)
from standoff.kernels.values import Work


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


@entry(INT, READ_BLOCKS, READ_BLOCKS, INT, INT, ROWS, WRITE_INTS, work="contact")
def starts(table, poses_a, poses_b, first, end, outs, done):
    """`start` at rows `first` to `end` - 1 of poses (n, 4, 4), or (1, 4, 4) for all rows.

    Row k is answered into row k of outs (n, N_OUT); done[k] is FINE, or what of it is refused.
    """
    tabled = ints_at(table, N_TABLE)
    pair, options = tabled_pair(tabled), tabled_options(tabled)
    at_a, at_b = poses_a.reshape(poses_a.size), poses_b.reshape(poses_b.size)
    way_a, way_b = pointer(at_a, 0), pointer(at_b, 0)
    rows = outs.reshape(outs.size)
    row = pointer(rows, 0)
    one_a, one_b = len(poses_a) == 1, len(poses_b) == 1
    for k in range(first, end):
        pose_a = ahead(way_a, 0 if one_a else 16 * k)
        pose_b = ahead(way_b, 0 if one_b else 16 * k)
        done[k] = start_at(pair, options, pose_a, pose_b, ahead(row, N_OUT * k))
