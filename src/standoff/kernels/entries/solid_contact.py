"""Local minima of the signed distance of two solids, as Python calls what finds them."""

from math import inf

from numba import types

from standoff.kernels.compiler.decorators import entry, pointer
from standoff.kernels.compiler.entry import READ, WRITE, WRITE_INTS
from standoff.kernels.entries.minima import BOTH_FANS, fans_at
from standoff.kernels.entries.solids import SOLIDS, STILL, side_at
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.contact_frame import Choices, contact_frame
from standoff.kernels.solids.contact_front import Both
from standoff.kernels.solids.contact_places import MOST_ROWS
from standoff.kernels.solids.contact_proof import parts_pieces
from standoff.kernels.solids.contact_search import search_signed
from standoff.kernels.solids.contact_sets import gather_signed
from standoff.kernels.solids.patch import span_all
from standoff.kernels.solids.spatial_progress import LOST, N_MINIMA, NORMAL

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


@entry(SOLIDS, READ, BOTH_FANS, WRITE, WRITE, READ, WRITE_INTS, work="solids")
def follow_contact(solids, pose, fans, kept, room, asked, counts):
    """A frame of a contact that is kept, B at a pose in A's frame, in `room`, which begins with
    what is asked: how many places there are. `asked`: as `signed_minima`."""
    a, b = side_at(solids[0], STILL, S.PRESSED), side_at(solids[1], pose, S.PRESSED)
    c = pointer(counts, 0)
    for k in range(len(counts)):
        c[k] = 0
    both = Both(a, b, (fans_at(fans[0]), fans_at(fans[1])))
    # poses of a track may be far from each other: all pairs of leaves are tried in each frame
    choices = Choices(inf, asked[0], 1, MOST_ROWS)
    return contact_frame(both, pointer(kept, 0), choices, pointer(room, 0), c)


@entry(SOLIDS, READ, READ, types.Tuple((WRITE, WRITE)), WRITE_INTS, work="solids")
def pieces_parted(solids, pose, row, lists, counts):
    """By how much B is moved along a row's normal, at which its two leaves are proven not to meet;
    0: not proven."""
    a, b = side_at(solids[0], STILL, S.PRESSED), side_at(solids[1], pose, S.PRESSED)
    best, minima = pointer(lists[0], 0), pointer(lists[1], 0)
    leaves, q = (int(row[1]), int(row[2])), (row[3], row[4], row[5], row[6])
    n = (row[NORMAL], row[NORMAL + 1], row[NORMAL + 2])
    return parts_pieces(a, b, leaves, (q, n, row[0]), best, minima, pointer(counts, 0))
