"""Frames of two solids that move, as Python calls them."""

from standoff.kernels.compiler.decorators import entry, kernel, pointer
from standoff.kernels.compiler.entry import INT, INTS, READ, READ_ROWS, ROWS, WRITE, WRITE_INTS
from standoff.kernels.algebra.vectors import norm, sub
from standoff.kernels.entries.solids import SOLIDS, STILL, side_at
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.front_frame import (
    FRAMES_AHEAD,
    begin,
    far_side,
    follow,
    frame,
    is_single,
    motion_between,
)
from standoff.kernels.solids.front_rows import FRAME, GONE, N_MADE, Front, ROW_REALS, Travel
from standoff.kernels.solids.spatial_pieces import leaf_jet
from standoff.kernels.solids.spatial_progress import (
    AT,
    LEAF_A,
    LEAF_B,
    LEAST,
    MET,
    N_MINIMA,
    N_OPEN,
    OPEN,
    SIZE,
    TOLERANCE,
    evaluations,
)

# What a frame tells: how it ended, distance, bound, motion, both points, leaves and parameters,
# rows of the front, evaluations, and 1 where the front was made anew.
ENDED, DISTANCE, BOUND, MOTION, POINT_A, POINT_B, LEAVES, PARAMETERS = 0, 1, 2, 3, 4, 7, 10, 12
ROWS_TOLD, TAKEN, ANEW = 16, 17, 18
TOLD_REALS = 19
# How it ended: proven and at one place; several places or a continuum, to be looked for; not
# proven; and met, or not known to be apart, so that a query from nothing is to decide.
SINGLE, SEVERAL, INTERVAL, TO_ASK = 0.0, 1.0, 2.0, 3.0


@kernel
def tell(a, b, best, minima, anew, front, counts, out):
    out[DISTANCE], out[BOUND] = best[LEAST], min(best[LEAST] - best[TOLERANCE], best[OPEN])
    leaf_a, leaf_b = int(best[LEAF_A]), int(best[LEAF_B])
    x = leaf_jet(a, leaf_a, best[AT], best[AT + 1])[0]
    y = leaf_jet(b, leaf_b, best[AT + 2], best[AT + 3])[0]
    for k in range(3):
        out[POINT_A + k], out[POINT_B + k] = x[k], y[k]
    out[LEAVES], out[LEAVES + 1] = leaf_a, leaf_b
    for k in range(4):
        out[PARAMETERS + k] = best[AT + k]
    out[ROWS_TOLD], out[TAKEN] = front.store[0], evaluations(counts)
    out[ANEW] = 1.0 if anew else 0.0
    if best[MET] > 0.0 or out[BOUND] <= 0.0:
        out[ENDED] = TO_ASK
    elif out[BOUND] < best[LEAST] - best[TOLERANCE]:
        out[ENDED] = INTERVAL
    else:
        out[ENDED] = SINGLE if is_single(a, b, best, minima) else SEVERAL


FRONT = (WRITE, WRITE, WRITE)


@entry(
    SOLIDS, READ, READ_ROWS, INTS, WRITE, WRITE, WRITE, WRITE, WRITE, WRITE_INTS, ROWS,
    work="solids",
)  # fmt: skip
def solid_frames(solids, before, poses, senses, best, minima, store, keys, rows, counts, told):
    """Frames one after the other, B at poses in A's frame, into the rows of `told`, up to one that
    does not end SINGLE; how many were done.

    before: B's pose of the last frame, the least distance and the bound there. best: where the
    witness points were, and what is asked."""
    a = side_at(solids[0], STILL, senses[0])
    last, now = side_at(solids[1], before, senses[1]), side_at(solids[1], before, senses[1])
    distance, low = before[12], before[13]
    front = Front(pointer(store, 0), pointer(keys, 0), pointer(rows, 0), len(rows) // ROW_REALS)
    b, m, c = pointer(best, 0), pointer(minima, 0), pointer(counts, 0)
    for i in range(len(poses)):
        now = side_at(solids[1], poses[i], senses[1])
        step, radius = motion_between(last, now, best[SIZE])
        sure = step < low and store[N_MADE] > 0.0
        store[GONE] += step
        store[FRAME] += 1.0
        travel = Travel(
            store[GONE], FRAMES_AHEAD * step, radius, 1.0 / radius, far_side(a, now, radius), sure
        )
        b[LEAST], b[OPEN], b[MET], b[N_MINIMA], b[N_OPEN] = 1e300, 1e300, 0.0, 0.0, 0.0
        for k in range(5):
            c[k] = 0
        begin(a, now, b, m)
        follow(a, now, front, distance, step, b, m, c)
        anew = frame(a, now, front, travel, b, m, c)
        out = pointer(told, TOLD_REALS * i)
        tell(a, now, b, m, anew, front, c, out)
        out[MOTION] = step
        last, distance, low = now, out[DISTANCE], out[BOUND]
        if out[ENDED] != SINGLE:
            return i + 1
    return len(poses)
