"""Frames of two solids that move, as Python calls them."""

from math import inf

from numba import types

from standoff.kernels.algebra.rigid import relative_pose, unit_quaternion
from standoff.kernels.algebra.vectors import norm
from standoff.kernels.compiler.decorators import entry, kernel, pointer
from standoff.kernels.compiler.entry import (
    INT,
    INTS,
    READ,
    READ_ROWS,
    REAL,
    ROWS,
    WRITE,
    WRITE_INTS,
)
from standoff.kernels.entries.minima import BOTH_FANS, fans_at
from standoff.kernels.entries.solids import SOLIDS, STILL, side_at
from standoff.kernels.solids.front_branches import branch_reach, number_sets, renew_branches
from standoff.kernels.solids.front_frame import (
    FARTHEST_AHEAD,
    FARTHEST_GONE,
    FRAMES_AHEAD,
    begin,
    far_side,
    follow,
    frame,
    is_single,
    motion_between,
    rest_for,
    rounding_of,
)
from standoff.kernels.solids.front_held import counted_apart, is_known_apart
from standoff.kernels.solids.front_rows import (
    FRAME,
    GONE,
    KNOWN,
    N_MERGED,
    N_ROWS,
    ROW_REALS,
    Front,
    Travel,
    begin_motion,
    list_awake,
)
from standoff.kernels.solids.minima_sets import MOST_SETS, SET_REALS, gather
from standoff.kernels.solids.patch import span_all
from standoff.kernels.solids.spatial_pieces import leaf_jet
from standoff.kernels.solids.spatial_progress import (
    ABOVE,
    AT,
    BUDGET,
    LEAF_A,
    LEAF_B,
    LEAST,
    LOST,
    MEETING,
    MET,
    N_MINIMA,
    N_OPEN,
    OPEN,
    ROUNDING,
    SIZE,
    STOP,
    TOLERANCE,
    evaluations,
    farthest,
)
from standoff.kernels.solids.spatial_tolerances import MOTION_SPARE
from standoff.kernels.state.arrays import BAD_POSE_A, BAD_POSE_B, FINE, is_pose

# What a frame tells: how it ended, distance, bound, motion, both points, leaves and parameters,
# rows of the front, evaluations, 1 where the front was made anew, 1 where the solids are sure
# to be apart because they were, and have not moved so far, and how many local minima are told.
ENDED, DISTANCE, BOUND, MOTION, POINT_A, POINT_B, LEAVES, PARAMETERS = 0, 1, 2, 3, 4, 7, 10, 12
ROWS_TOLD, TAKEN, ANEW, SURE, N_SETS = 16, 17, 18, 19, 20
TOLD_REALS = 21
N_COUNTS = 5
# How it ended: proven and at one place; several places, or what may be, to be looked for; not
# proven; and met, or not known to be apart, so that a query from nothing is to decide.
SINGLE, SEVERAL, INTERVAL, TO_ASK = 0.0, 1.0, 2.0, 3.0


@kernel
def tell(a, b, best, minima, least, front, counts, out):
    """`least`: what the solids are at least apart by, as they were before."""
    low = min(best[LEAST] - best[TOLERANCE], best[OPEN])
    out[DISTANCE], out[BOUND] = best[LEAST], max(low, least)
    best[OPEN] = out[BOUND]
    leaf_a, leaf_b = int(best[LEAF_A]), int(best[LEAF_B])
    x = leaf_jet(a, leaf_a, best[AT], best[AT + 1])[0]
    y = leaf_jet(b, leaf_b, best[AT + 2], best[AT + 3])[0]
    for k in range(3):
        out[POINT_A + k], out[POINT_B + k] = x[k], y[k]
    out[LEAVES], out[LEAVES + 1] = leaf_a, leaf_b
    for k in range(4):
        out[PARAMETERS + k] = best[AT + k]
    out[ROWS_TOLD], out[TAKEN] = front.store[0], evaluations(counts)


@kernel
def how_ended(a, b, best, minima, low, counts):
    if best[MET] > 0.0:
        return TO_ASK
    if low <= 0.0:  # without time a query would tell no more, and the next frame goes on from here
        return INTERVAL if evaluations(counts) > best[BUDGET] else TO_ASK
    if low < best[LEAST] - best[TOLERANCE]:
        return INTERVAL
    # what ties was not gone through
    if best[N_OPEN] > 0.0 and evaluations(counts) > best[BUDGET]:
        return INTERVAL
    return SINGLE if is_single(a, b, best, minima) else SEVERAL


@kernel
def front_at(front):
    store, keys, rows, branches, merged = front
    most = len(rows) // ROW_REALS
    lists = pointer(branches, 0), pointer(merged, 0)
    return Front(pointer(store, 0), pointer(keys, 0), pointer(rows, 0), most, *lists)


@kernel
def told_minima(a, b, fans, front, travel, best, minima, out):
    """Write the local minima, their branches and patches; how many, -1 where they are to be looked
    for. `out`: room for them, and the number of the frame."""
    sets, frame = out
    if best[LOST] > 0.0:
        return -1
    n = gather(a, b, fans, best, minima, travel.wider, sets)
    if n > 0 and travel.wider > 0.0:
        span_all(best, minima, travel.wider, sets, n)
    if n > 0:
        number_sets(front, minima, sets, n, branch_reach(best[SIZE], travel.ahead), frame)
        renew_branches(front, minima, sets, n)
    return n


@kernel
def ask(best, asked, away):
    """What is asked of a frame, at how far the solids' frames are from each other. In `asked` stand
    the tolerance, the share of the sizes and the distance that is for rounding, up to which
    distance local minima are kept, 0: only the nearest pairs, and how much of that is for their
    patches alone."""
    best[ROUNDING] = asked[1] * (best[SIZE] + away)
    best[TOLERANCE] = max(asked[0], 4.0 * best[ROUNDING])
    best[MEETING], best[ABOVE] = best[TOLERANCE], asked[2]
    best[STOP] = max(best[BUDGET], 1.0)
    best[LEAST], best[OPEN], best[MET] = inf, inf, 0.0
    best[N_MINIMA], best[N_OPEN], best[LOST] = 0.0, 0.0, 0.0


@kernel
def apart_frame(sides, low, asked, front, search, counts, out):
    """A frame of two solids that were proven to be `low` apart, told but for its local minima; how
    B travels in it. sides: A, B before and B now."""
    a, last, now = sides
    best, minima = search
    store = front.store
    step, radius = motion_between(last, now, best[SIZE])
    if store[N_ROWS] == 0.0:
        store[KNOWN] = -inf
    if low > 0.0:
        store[KNOWN] = max(store[KNOWN], store[GONE] + low)
    store[GONE] += step
    if store[GONE] > FARTHEST_GONE * best[SIZE]:
        begin_motion(front, FARTHEST_GONE * MOTION_SPARE * best[SIZE])
    store[FRAME] += 1.0
    ahead = min(FRAMES_AHEAD * step, FARTHEST_AHEAD * best[SIZE])
    afar = far_side(a, now, radius)
    spare = rounding_of(now, best[SIZE]) + rounding_of(last, best[SIZE])
    gone, turning, turn = store[GONE], 1.0 / radius, unit_quaternion(now.pose.R)
    travel = Travel(
        gone, ahead, radius, turning, afar, False, now.pose, turn, spare, asked[2], asked[3],
        step, last.pose, unit_quaternion(last.pose.R),
    )  # fmt: skip
    ask(best, asked, norm(now.pose.p))
    for k in range(N_COUNTS):
        counts[k] = 0
    begin(a, now, best, minima)
    if best[ABOVE] > 0.0:  # that pair is none of the minima now
        best[N_MINIMA] = 0.0
    goal = farthest(best) + best[ROUNDING]
    list_awake(front, goal, rest_for(step, best[SIZE]), travel)
    known = is_known_apart(front, travel)
    follow(a, now, front, goal, counted_apart(travel) if known else travel, best, minima, counts)
    anew, sure = frame(a, now, front, travel, best, minima, counts)
    tell(a, now, best, minima, min(low - step, best[LEAST]), front, counts, out)
    out[ENDED], out[MOTION] = how_ended(a, now, best, minima, out[BOUND], counts), step
    out[ANEW], out[SURE], out[N_SETS] = 1.0 if anew else 0.0, 1.0 if sure else 0.0, 0.0
    return travel


@entry(READ_ROWS, READ_ROWS, ROWS, work="solids")
def placed_beside(poses_a, poses_b, out):
    """B's poses in A's frame (n, 12), of world poses of both: FINE, or which of a row's is none."""
    refused = FINE
    for i in range(len(out)):
        a, b = pointer(poses_a, 12 * i), pointer(poses_b, 12 * i)
        if refused == FINE and not is_pose(a):
            refused = BAD_POSE_A
        if refused == FINE and not is_pose(b):
            refused = BAD_POSE_B
        now, to = relative_pose(a, b), pointer(out, 12 * i)
        for k in range(9):
            to[k] = now.R[k]
        for k in range(3):
            to[9 + k] = now.p[k]
    return refused


# B's pose in A's frame in the frame before, with the least distance and the bound there; its poses
# now; what is asked.
WAY = types.Tuple((READ, READ_ROWS, READ))
# As `boundary_distance` has them: where the witness points were stands in the first.
SEARCH = types.Tuple((WRITE, WRITE))
# What is kept beside the rows of the front, their keys, the rows, the branches, and those that have
# merged.
FRONT_ARRAYS = types.Tuple((WRITE, WRITE, WRITE, WRITE, WRITE))


@entry(FRONT_ARRAYS, WRITE, WRITE, INT, REAL, INT, work="solids")
def number_minima(front, minima, sets, n, reach, frame):
    """Give `n` local minima of a frame that were told otherwise the numbers of their branches."""
    kept, rows, out = front_at(front), pointer(minima, 0), pointer(sets, 0)
    number_sets(kept, rows, out, n, reach, frame)
    renew_branches(kept, rows, out, n)


# What frames tell: a row each, and of all together the local minima.
TOLD = types.Tuple((ROWS, WRITE))


@entry(SOLIDS, WAY, INTS, SEARCH, BOTH_FANS, FRONT_ARRAYS, WRITE_INTS, TOLD, work="solids")
def solid_frames(solids, way, senses, search, fans, front, counts, out_arrays):
    """Frames one after the other into the rows of `told`, up to one that does not end SINGLE, in
    which the solids are not sure to be apart, or after which there is no room for local minima; how
    many were done."""
    told, told_sets = out_arrays
    around = fans_at(fans[0]), fans_at(fans[1])
    n_sets = 0
    front[0][N_MERGED] = 0.0
    before, poses, asked = way
    wanted = pointer(asked, 0)
    a = side_at(solids[0], STILL, senses[0])
    last = side_at(solids[1], before, senses[1])
    low = before[13]
    kept = front_at(front)
    best, minima, c = pointer(search[0], 0), pointer(search[1], 0), pointer(counts, 0)
    for i in range(len(poses)):
        now = side_at(solids[1], poses[i], senses[1])
        out = pointer(told, TOLD_REALS * i)
        travel = apart_frame((a, last, now), low, wanted, kept, (best, minima), c, out)
        if best[ABOVE] > 0.0 and out[ENDED] == SINGLE:
            at = pointer(told_sets, SET_REALS * n_sets)
            n = told_minima(a, now, around, kept, travel, best, minima, (at, i))
            out[N_SETS], n_sets = max(n, 0), n_sets + max(n, 0)
            if n < 0:
                out[ENDED] = SEVERAL
        last, low = now, out[BOUND]
        full = SET_REALS * (n_sets + MOST_SETS) > len(told_sets)
        if out[ENDED] != SINGLE or out[SURE] == 0.0 or full:
            return i + 1
    return len(poses)
