"""Nearest points on trimming curves: the witness of a pair of leaves whose surfaces meet, or are
nearer to each other, off the faces themselves."""

from math import inf

from standoff.kernels.body.features import coedge_parameters
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_minimum import nearest
from standoff.kernels.solids.spatial_pieces import leaf_ints, meets, part_box
from standoff.kernels.solids.spatial_progress import middle

# Places that are tried on each piece of a trimming curve, and on all of a leaf.
ON_A_PIECE, ON_A_LEAF = 4, 16


@kernel
def holds(box, u, v):
    return box.u0 <= u <= box.u1 and box.v0 <= v <= box.v1


@kernel
def nearest_on_trim(a, b, counts):
    """(parameters of A's place and B's, distance): of places along A's trimming curves in its part,
    the one that is nearest to B's part; inf where there is none."""
    side, own = a.side, a.side.own
    r = leaf_ints(side, a.leaf)
    start = middle(b.box)
    best, least = (0.0, 0.0, start[0], start[1]), inf
    if own[r + S.DIM] != 2 or own[r + S.CUT] == 0:
        return best, least
    first, tried = own[S.LISTS] + own[r + S.LIST], 0
    for k in range(own[r + S.N_LIST]):
        piece = own[first + k]
        o = own[S.R_PIECES] + S.PIECE_REALS * piece
        ta, tb = side.numbers[o], side.numbers[o + 1]
        if tried >= ON_A_LEAF or not meets(part_box(side, piece, ta, tb), a.box):
            continue
        coedge = own[own[S.PIECES] + S.PIECE_INTS * piece]
        for i in range(ON_A_PIECE):
            t = ta + (i + 0.5) / ON_A_PIECE * (tb - ta)
            u, v, _, _, _ = coedge_parameters(side.ints, side.reals, coedge, t)
            u += side.numbers[o + S.P_SHIFT]
            if not holds(a.box, u, v):
                continue
            tried += 1
            at = S.Box(u, u, v, v)
            q, distance = nearest(
                side, a.leaf, at, b.side, b.leaf, b.box, (u, v, best[2], best[3]), counts
            )
            if distance < least:
                best, least = q, distance
    return best, least
