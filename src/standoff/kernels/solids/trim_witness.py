"""Nearest points on trimming curves: the witness of a pair of leaves whose surfaces meet, or are
nearer to each other, off the faces themselves."""

from math import inf

from standoff.kernels.algebra.vectors import dot, sub
from standoff.kernels.body.features import coedge_parameters, feature_jet, moved_jet
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_minimum import nearest
from standoff.kernels.solids.spatial_pieces import (
    box_between,
    is_bent,
    leaf_ints,
    leaf_jet,
    meets,
    part_box,
    trim_point,
    whole_box,
)
from standoff.kernels.solids.spatial_progress import middle

# Places that are tried on each piece of a trimming curve, and on all of a leaf; of many pieces one
# on each.
ON_A_PIECE, ON_A_LEAF = 4, 16
# Moves along a curve from the best of these.
SLIDES = 6
# Times that an interval of a trimming curve is narrowed to what is in a part.
NARROWINGS = 6


@kernel
def holds(box, u, v):
    return box.u0 <= u <= box.u1 and box.v0 <= v <= box.v1


@kernel
def within_box(side, piece, box):
    """(first, last) of an interval with all parameters at which a piece of a trimming curve is in a
    box."""
    o = side.own[S.R_PIECES] + S.PIECE_REALS * piece
    first, last = side.numbers[o], side.numbers[o + 1]
    if is_bent(side, piece):
        return (first, last) if meets(whole_box(side, piece), box) else (first, first)
    for _ in range(NARROWINGS):
        step = (last - first) / ON_A_PIECE
        low, high = last, first
        q = trim_point(side, piece, first)
        for i in range(ON_A_PIECE):
            ta, tb = first + i * step, first + (i + 1) * step
            p, q = q, trim_point(side, piece, tb)
            if meets(box_between(side, piece, tb - ta, p, q), box):
                low, high = min(low, ta), max(high, tb)
        if low >= high:
            return first, first
        narrowed = high - low <= 0.5 * (last - first)
        first, last = low, high
        if not narrowed:
            break
    return first, last


@kernel
def from_trim(a, b, piece, t, at, counts):
    """(on A's part, parameters, distance) of a place on a trimming curve of A and of the point of
    B's part that is nearest to it, sought from `at`."""
    side, own = a.side, a.side.own
    coedge = own[own[S.PIECES] + S.PIECE_INTS * piece]
    u, v, _, _, _ = coedge_parameters(side.ints, side.reals, coedge, t)
    u += side.numbers[own[S.R_PIECES] + S.PIECE_REALS * piece + S.P_SHIFT]
    if not holds(a.box, u, v):
        return False, (u, v, at[0], at[1]), inf
    start = (u, v, at[0], at[1])
    q, distance = nearest(side, a.leaf, S.Box(u, u, v, v), b.side, b.leaf, b.box, start, counts)
    return True, q, distance


@kernel
def towards(a, b, piece, t, q):
    """The parameter of a trimming curve of A whose tangent is nearest to a point of B."""
    own = a.side.own
    feature = own[own[S.PIECES] + S.PIECE_INTS * piece + 1]
    jet = moved_jet(a.side.pose, feature_jet(a.side.ints, a.side.reals, feature, -1, t, 0.0))
    slope = dot(jet[1], jet[1])
    if slope <= 0.0:
        return t
    y = leaf_jet(b.side, b.leaf, q[2], q[3])[0]
    return t + dot(jet[1], sub(y, jet[0])) / slope


@kernel
def places_on_each(a):
    """How many places on each piece of a trimming curve in a part are tried."""
    r, own = leaf_ints(a.side, a.leaf), a.side.own
    first, met = own[S.LISTS] + own[r + S.LIST], 0
    for k in range(own[r + S.N_LIST]):
        met += 1 if meets(whole_box(a.side, own[first + k]), a.box) else 0
    return min(max(ON_A_LEAF // max(met, 1), 1), ON_A_PIECE)


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
    first, places = own[S.LISTS] + own[r + S.LIST], places_on_each(a)
    for k in range(own[r + S.N_LIST]):
        piece = own[first + k]
        o = own[S.R_PIECES] + S.PIECE_REALS * piece
        ta, tb = side.numbers[o], side.numbers[o + 1]
        if not meets(part_box(side, piece, ta, tb), a.box):
            continue
        ta, tb = within_box(side, piece, a.box)
        at, here = 0.5 * (ta + tb), inf
        for i in range(places):
            t = ta + (i + 0.5) / places * (tb - ta)
            _, q, distance = from_trim(a, b, piece, t, (best[2], best[3]), counts)
            if distance < here:
                at, here = t, distance
            if distance < least:
                best, least = q, distance
        if here > least:
            continue
        # so that the way to B is across the curve, or as far as the part goes
        step = towards(a, b, piece, at, best) - at
        for _ in range(SLIDES):
            t = min(max(at + step, ta), tb)
            known, q, distance = from_trim(a, b, piece, t, (best[2], best[3]), counts)
            if not known:
                step = 0.5 * (t - at)
            elif distance < least:
                best, least, at = q, distance, t
                step = towards(a, b, piece, at, best) - at
            else:
                break
    return best, least
