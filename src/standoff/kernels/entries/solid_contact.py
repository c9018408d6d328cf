"""Local minima of the signed distance of two solids, as Python calls what finds them."""

from numba import types

from standoff.kernels.compiler.decorators import ahead, entry, kernel, pointer
from standoff.kernels.compiler.entry import READ, WRITE, WRITE_INTS
from standoff.kernels.entries.minima import BOTH_FANS, fans_at
from standoff.kernels.entries.solid_blocks import Q_FRAME, Q_POINTS, Q_PROOF, Q_SIZE_A, Q_SIZE_B
from standoff.kernels.entries.solid_meeting import go_on_from, meet_at, pressed
from standoff.kernels.entries.solid_points import BESIDE, heap_and_space
from standoff.kernels.entries.solids import ROOM, SOLIDS, STILL, side_at
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.contact_frame import AT_NORMALS, AT_SETS
from standoff.kernels.solids.contact_proof import parts_pieces
from standoff.kernels.solids.contact_search import search_signed
from standoff.kernels.solids.contact_sets import gather_signed
from standoff.kernels.solids.minima_sets import SET_REALS, SET_ROW
from standoff.kernels.solids.overlap_depth import Two
from standoff.kernels.solids.patch import span_all
from standoff.kernels.solids.point_depth import Known, Probe
from standoff.kernels.solids.spatial_progress import (
    LOST,
    MINIMUM_REALS,
    N_MINIMA,
    NORMAL,
    POINTS,
)

# What is kept of a contact and a frame's room; of its front what a frame changes; and what is told.
KEEPS = types.Tuple((WRITE, WRITE, WRITE, WRITE, WRITE, WRITE))
# What a search for a point's depth fills, and its room.
PROBING = types.Tuple((WRITE, WRITE, ROOM))
# What a frame tells: how many places; the deepest that is felt, -1 where no overlap is proven; a
# length that no translation is less than which parts the solids; of that place the signed
# distance, both points and the normal, A's frame; and a translation that parts the solids.
N_PLACES, FIRST, DEPTH, DISTANCE, AT_BOTH, ALONG, PARTING = 0, 1, 2, 3, 4, 10, 13
TOLD_REALS = 16


@kernel
def tell_met(met, row, room, told):
    """`row`: of a set of minima, that of the deepest place which is felt."""
    o = AT_NORMALS + MINIMUM_REALS * int(row[SET_ROW])
    told[DISTANCE], told[DEPTH] = row[0], met.depth
    for k in range(6):
        told[AT_BOTH + k] = room[o + POINTS + k]
    for k in range(3):
        told[ALONG + k], told[PARTING + k] = room[o + NORMAL + k], met.way[k]


# As a search has them, and what sets of minima are written to.
LISTS = types.Tuple((WRITE, WRITE, WRITE))


@entry(SOLIDS, READ, BOTH_FANS, LISTS, READ, WRITE_INTS, WRITE_INTS, work="solids")
def signed_minima(solids, pose, fans, lists, asked, stack, counts):
    """All minima of the signed distance up to a length on both sides of 0, into the rows of
    `lists`: how many sets of them there are, -1 where there is no room. `asked`: how much of the
    length is for their patches alone."""
    a, b = side_at(solids[0], STILL, S.PRESSED), side_at(solids[1], pose, S.PRESSED)
    around = fans_at(fans[0]), fans_at(fans[1])
    best, minima, sets = pointer(lists[0], 0), pointer(lists[1], 0), pointer(lists[2], 0)
    best[N_MINIMA], best[LOST] = 0.0, 0.0
    c = pointer(counts, 0)
    for k in range(len(counts)):
        c[k] = 0
    search_signed(a, b, around, best, minima, pointer(stack, 0), len(stack) // 2, c)
    n = gather_signed(a, b, best, minima, asked[0], sets)
    if n > 0 and asked[0] > 0.0:
        span_all(best, minima, asked[0], sets, n)
    return n


@entry(SOLIDS, READ, BESIDE, BOTH_FANS, KEEPS, READ, PROBING, WRITE_INTS, work="solids")
def follow_contact(solids, pose, beside, fans, keeps, asked, probing, counts):
    """A frame of a contact that is kept, B at a pose in A's frame, and the front after it where the
    solids are proven to overlap. `asked`: as of a block; `counts`: of the frame, then from the 8th
    on of its proof."""
    kept, room, told = pointer(keeps[0], 0), pointer(keeps[1], 0), keeps[5]
    best, ties, work = probing
    heap, space = heap_and_space(work)
    lists, count = (pointer(best, 0), pointer(ties, 0)), pointer(counts, 0)
    wanted = pointer(asked, 0)
    probe = Probe(
        side_at(beside[0], STILL, S.EITHER), asked[Q_FRAME + 1], asked[Q_PROOF], asked[Q_POINTS],
        lists, heap, space, ahead(count, 8),
    )  # fmt: skip
    at_a, at_b = pointer(beside[1], 0), pointer(beside[2], 0)
    a = Known(side_at(solids[0], STILL, S.OUTSIDE), at_a, at_a, 0, asked[Q_SIZE_A])
    b = Known(side_at(solids[1], STILL, S.OUTSIDE), at_b, at_b, 0, asked[Q_SIZE_B])
    two = Two(a, b, side_at(solids[1], pose, S.OUTSIDE).pose, probe)
    both = pressed(two, (fans_at(fans[0]), fans_at(fans[1])))
    met = meet_at(two, both, kept, wanted, room, count)
    told[N_PLACES], told[FIRST] = met.n, met.first
    if met.first >= 0:
        row = ahead(room, AT_SETS + SET_REALS * met.first)
        front = pointer(keeps[2], 0), pointer(keeps[3], 0), pointer(keeps[4], 0)
        go_on_from(kept, row, front)
        tell_met(met, row, room, pointer(told, 0))


@entry(SOLIDS, READ, READ, types.Tuple((WRITE, WRITE)), WRITE_INTS, work="solids")
def pieces_parted(solids, pose, row, lists, counts):
    """By how much B is moved along a row's normal, at which its two leaves are proven not to meet;
    0: not proven."""
    a, b = side_at(solids[0], STILL, S.PRESSED), side_at(solids[1], pose, S.PRESSED)
    best, minima = pointer(lists[0], 0), pointer(lists[1], 0)
    leaves, q = (int(row[1]), int(row[2])), (row[3], row[4], row[5], row[6])
    n = (row[NORMAL], row[NORMAL + 1], row[NORMAL + 2])
    return parts_pieces(a, b, leaves, (q, n, row[0]), best, minima, pointer(counts, 0))
