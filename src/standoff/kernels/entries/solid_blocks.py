"""Where everything is in the block of memory that a frame of two solids goes on from, as C has it,
and in the table of addresses of what was loaded.

A block is read and written by one thread; only the part before WORK outlives a frame.
"""

from typing import Any, NamedTuple

from standoff.kernels.algebra.rigid import read_rotation, read_vector, relative_pose
from standoff.kernels.compiler.decorators import ahead, ints_at, kernel, reals_at
from standoff.kernels.entries.tracked_solids import TOLD_REALS
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.contact_frame import CONTACT_ROOM
from standoff.kernels.solids.contact_front import CONTACT_REALS
from standoff.kernels.solids.contact_places import F_ROWS, F_STORE, KEPT_REALS
from standoff.kernels.solids.front_branches import BRANCH_REALS, MERGED_REALS, MOST_MERGED
from standoff.kernels.solids.front_rows import KEY_REALS, N_ROWS, ROW_REALS, STORE_REALS
from standoff.kernels.solids.minima_sets import MOST_SETS, SET_REALS
from standoff.kernels.solids.point_depth import MOST_TIES, UNTURNED, Known, Probe
from standoff.kernels.solids.spatial_progress import BEST_REALS, LEFT_REALS, MINIMUM_REALS
from standoff.kernels.solids.stationary import Fans
from standoff.kernels.values import Pose

# Rows that a front may have: more are not cut any further, so that an interval is told; local
# minima that are followed, and pairs of points that are kept.
MOST_FRONT, MOST_BRANCHES, MOST_LOCAL = 1 << 16, 1 << 8, 1 << 14
# Pairs of nodes and of leaves that a search from nothing has room for, and what closes one.
MOST_NODES, MOST_PAIRS, CLOSING = 1 << 16, 1 << 14, 2048
# What a table of addresses holds: each followed by how many elements lie there. First of A, then of
# B: packed boundary, leaves and tree, fans, vectors at vertices, points of the boundary.
T_INTS, T_REALS, T_OWN, T_NUMBERS, T_FAN_INTS, T_FAN_REALS, T_NORMALS, T_REFERENCES = range(8)
T_OF_SOLID = 8
# Then the point as a solid, what is asked, and of each leaf of A and of B how it is told.
T_POINT, T_ASKED, T_LEAVES_A, T_LEAVES_B = 16, 20, 21, 22
N_TABLED = 23
# What is asked: as of frames (tolerance, rounding, up to which distance local minima are kept, how
# much of that is for patches alone); the evaluations allowed; the sizes of both; how deep an
# overlap is looked for, of the sizes; to what points are proven; the evaluations of a start; the
# slack of both; and the evaluations of a point.
Q_FRAME, Q_DEADLINE, Q_SIZE_A, Q_SIZE_B, Q_DEEP, Q_PROOF, Q_IN_TIME = 0, 4, 5, 6, 7, 8, 9
Q_SLACK, Q_POINTS = 10, 11
N_ASKED = 12

# Statuses that only solids have, as of ``standoff.tracking.status``.
WITHIN, CONTAINED = 10, 13
# What is told of a frame.
A_STATUS, A_INSIDE, A_SINGLE, A_COMPLETE, A_N_MINIMA, A_EVALUATIONS, A_RESTARTS, A_ANEW = range(8)
A_LOWER, A_UPPER = 8, 9
A_REALS = 10
# What is told of a local minimum: distance, a lower bound, its key, whether it is felt, the leaves,
# parameters, both points and the normal, world axes.
M_DISTANCE, M_LOWER, M_KEY, M_FELT, M_LEAVES, M_PARAMETERS, M_A, M_B, M_NORMAL = (
    0, 1, 2, 3, 4, 6, 10, 13, 16,
)  # fmt: skip
M_REALS = 19

# The block: poses that are given; what the frame before came to; whether its solids overlapped;
# from where the boundaries are seen; B's pose in A's frame in it, and when they were last apart,
# with the distance and the bound; 1 where a frame is to begin anywhere; then what Front and Frames
# of Python have, the answer, the local minima, the contact, and at the end of what is kept the
# front's keys and rows.
POSES, MODE, OVERLAPPED, SEEN, BEFORE, LAST = 0, 24, 25, 26, 28, 40
LAST_LEAST, LAST_LOW = LAST + 12, LAST + 13
FRESH = LAST + 14
BEST = FRESH + 1
STORE = BEST + BEST_REALS
BRANCHES = STORE + STORE_REALS
ANSWER = BRANCHES + BRANCH_REALS * MOST_BRANCHES
MINIMA = ANSWER + A_REALS
CONTACT = MINIMA + M_REALS * MOST_SETS
KEYS = CONTACT + KEPT_REALS
ROWS = KEYS + KEY_REALS * MOST_FRONT
WORK = ROWS + ROW_REALS * MOST_FRONT
FIXED = CONTACT + F_ROWS
CONTACT_ROW, KEY_ROW, FRONT_ROW = CONTACT_REALS, KEY_REALS, ROW_REALS
CONTACT_COUNT, FRONT_COUNT = CONTACT + F_STORE + N_ROWS, STORE + N_ROWS
# What the block is in: nothing known; the last answer told neither that the solids are apart nor
# that they overlap; a front; a contact.
STARTING, UNKNOWN, APART, IN_CONTACT = 0.0, 1.0, 2.0, 3.0
# Work space.
W_TOLD = WORK
W_SETS = W_TOLD + TOLD_REALS
W_MERGED = W_SETS + SET_REALS * (MOST_SETS + 4)
W_ROOM = W_MERGED + MERGED_REALS * MOST_MERGED
W_MINIMA = W_ROOM + CONTACT_ROOM
W_BEST = W_MINIMA + MINIMUM_REALS * MOST_LOCAL
W_TIES = W_BEST + BEST_REALS
W_CLOSING = W_TIES + MINIMUM_REALS * MOST_TIES
W_PAIRS = W_CLOSING + CLOSING
W_KEYS = W_PAIRS + LEFT_REALS * MOST_PAIRS
W_NODES = W_KEYS + MOST_NODES
W_COUNTS = W_NODES + 2 * MOST_NODES
N_SOLIDS_BLOCK = W_COUNTS + 16


class Given(NamedTuple):
    """What a frame reads: both solids as they are known, directions from their vertices, what asks
    of points, B's pose in A's frame, what is asked, the block, and where its work is counted."""

    a: Any
    b: Any
    fans: Any
    probe: Any
    pose: Any
    asked: Any
    block: Any
    counts: Any


@kernel
def tabled_reals(table, k):
    return reals_at(table[2 * k], table[2 * k + 1])


@kernel
def tabled_ints(table, k):
    return ints_at(table[2 * k], table[2 * k + 1])


@kernel
def boundary_of(table, k, pose, sense):
    """The boundary whose arrays begin at the k-th entry."""
    return S.Side(
        tabled_ints(table, k + T_INTS),
        tabled_reals(table, k + T_REALS),
        tabled_ints(table, k + T_OWN),
        tabled_reals(table, k + T_NUMBERS),
        pose,
        sense,
    )


@kernel
def unmoved():
    return Pose(UNTURNED, (0.0, 0.0, 0.0))


@kernel
def fans_of(table, k):
    return Fans(tabled_ints(table, k + T_FAN_INTS), tabled_reals(table, k + T_FAN_REALS))


@kernel
def known_of(table, k, size):
    return Known(
        boundary_of(table, k, unmoved(), S.OUTSIDE),
        tabled_reals(table, k + T_NORMALS),
        tabled_reals(table, k + T_REFERENCES),
        table[2 * (k + T_REFERENCES) + 1] // 3,
        size,
    )


@kernel
def searching(block, nodes):
    """(a heap, room) of a search from nothing; `nodes`: the block's integers there."""
    heap = (ahead(block, W_KEYS), nodes, ahead(nodes, MOST_NODES), MOST_NODES)
    return heap, (ahead(block, W_PAIRS), MOST_PAIRS, ahead(block, W_CLOSING))


@kernel
def probe_of(table, block, asked, nodes, counts):
    """What asks of points, with the block's room for it."""
    heap, room = searching(block, nodes)
    lists = ahead(block, W_BEST), ahead(block, W_TIES)
    point = boundary_of(table, T_POINT, unmoved(), S.EITHER)
    asked_of = asked[Q_FRAME + 1], asked[Q_PROOF], asked[Q_POINTS]
    return Probe(point, asked_of[0], asked_of[1], asked_of[2], lists, heap, room, counts)


@kernel
def given_at(table, address):
    """What a frame reads, of a block at an address with the poses of the frame."""
    table = ints_at(table, 2 * N_TABLED)
    block = reals_at(address, N_SOLIDS_BLOCK)
    nodes = ints_at(address + 8 * W_NODES, 2 * MOST_NODES)
    counts = ints_at(address + 8 * W_COUNTS, 16)
    asked = tabled_reals(table, T_ASKED)
    for k in range(8):
        counts[8 + k] = 0  # each frame's proof may take as much as is asked
    probe = probe_of(table, block, asked, nodes, ahead(counts, 8))
    a = known_of(table, 0, asked[Q_SIZE_A])
    b = known_of(table, T_OF_SOLID, asked[Q_SIZE_B])
    pose = relative_pose(ahead(block, POSES), ahead(block, POSES + 12))
    fans = fans_of(table, 0), fans_of(table, T_OF_SOLID)
    return Given(a, b, fans, probe, pose, asked, block, counts)


@kernel
def pose_kept(block, o):
    return Pose(read_rotation(block, o), read_vector(block, o + 9))


@kernel
def seen_at(known, pose, sense):
    x = known.side
    return S.Side(x.ints, x.reals, x.own, x.numbers, pose, sense)
