"""All local minima of the signed distance of two boundaries, up to a length on both sides of 0:
Newton's method in every pair of leaves that is near enough, and may have a common normal.

Nothing here needs the solids to be apart. A pair whose signed distance is d has points |d| apart,
so that boxes which are farther from each other than the length hold none; and its normals are
opposed.
"""

from math import inf

from standoff.kernels.algebra.vectors import cross, dot, norm, scale
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.contact_ends import dim_of, is_straight
from standoff.kernels.solids.contact_minimum import (
    is_signed_minimum,
    limits_of,
    middles_of,
    nearest_apart,
    signed_minimum,
    start_of,
)
from standoff.kernels.solids.contact_sets import NO_MINIMUM, put_normal
from standoff.kernels.solids.front_branches import (
    B_AT,
    B_LEAVES,
    B_POINTS,
    B_TAKEN,
    BRANCH_REALS,
    leaf_beside,
)
from standoff.kernels.solids.front_motion import put_three
from standoff.kernels.solids.front_rows import N_BRANCHES
from standoff.kernels.solids.hollow import held_at_hollow, is_hollow
from standoff.kernels.solids.over_plane import is_plane_leaf
from standoff.kernels.solids.planar_tolerances import AT_OPTIMUM
from standoff.kernels.solids.spatial_boxes import gap_of, node_reach, normals_shut_for
from standoff.kernels.solids.spatial_closing import no_pair
from standoff.kernels.solids.spatial_minimum import jets_at
from standoff.kernels.solids.spatial_pieces import ZERO, leaf_box, on_solid
from standoff.kernels.solids.spatial_progress import (
    ABOVE,
    BOUND,
    BUDGET,
    LEAF_PAIRS,
    LOST,
    MINIMUM_REALS,
    N_MINIMA,
    NODE_PAIRS,
    ROUNDING,
    SIZE,
    evaluations,
)
from standoff.kernels.solids.spatial_search import node_ints
from standoff.kernels.solids.spatial_tolerances import NEARLY_OPPOSED, PAST_SIDE
from standoff.kernels.solids.stationary import is_stationary

# Widths of a leaf by which Newton's method may leave it on its way, and end outside of it.
ASTRAY, ENDS_BEYOND = 1.0, PAST_SIDE
# A branch may go anywhere on its face, so far in units of its leaf.
ANYWHERE = 64.0


@kernel
def leaf_holding(side, leaf, u, v):
    """(leaf, u) of the same face or edge that holds a point; -1: none."""
    box = leaf_box(side, leaf)
    wide_u, wide_v = ENDS_BEYOND * (box.u1 - box.u0), ENDS_BEYOND * (box.v1 - box.v0)
    if box.u0 - wide_u <= u <= box.u1 + wide_u and box.v0 - wide_v <= v <= box.v1 + wide_v:
        return leaf, u
    k, shift = leaf_beside(side, leaf, u, v)
    return k, u + shift


@kernel
def is_face(side, leaf):
    return dim_of(side, leaf) == 2


@kernel
def is_vertex(side, leaf):
    return dim_of(side, leaf) == 0


@kernel
def held_along(a, b, fans, leaves, spot, sine):
    """(whether a pair of points is held along its normal, n, d, of how many parameters it is as of
    a fillet); of two edges' two normals n is the one that both solids have. `sine`: of the angle by
    which a small step may lead along it. spot: parameters, normal, signed distance."""
    q, n, d = spot
    # a hollow edge has no normal that leads out of its solid
    sharp = not (is_hollow(a, leaves[0]) or is_hollow(b, leaves[1]))
    of_a_face = is_face(a, leaves[0]) or is_face(b, leaves[1])
    for _ in range(2):
        if sharp and is_stationary(a, b, fans[0], fans[1], q, leaves, n, sine):
            return True, n, d, 0
        if of_a_face:
            break
        if d < 0.0:
            hollow = held_at_hollow(a, b, fans, q, leaves, n, sine)
            if hollow > 0:
                return True, n, d, hollow
        n, d = scale(-1.0, n), -d
    return False, n, d, 0


@kernel
def keep_signed(a, b, fans, leaves, spot, deepest, best, minima):
    """Keep a pair of points with a common normal, if both are on the solids and its depth is no
    more than `deepest`. spot: parameters, normal, signed distance."""
    q, n, d = spot
    if abs(d) > (best[ABOVE] if d >= 0.0 else deepest):
        return
    if not (on_solid(a, leaves[0], q[0], q[1]) and on_solid(b, leaves[1], q[2], q[3])):
        return
    ja, jb = jets_at(a, leaves[0], b, leaves[1], q)
    held, n, d, hollow = held_along(a, b, fans, leaves, (q, n, d), AT_OPTIMUM)
    told = held and is_signed_minimum(ja, jb, n, d, best[SIZE], hollow)
    if not held and not is_face(a, leaves[0]) and not is_face(b, leaves[1]):
        # edges that are tilted a little are pressed beside a minimum
        held, n, d, hollow = held_along(a, b, fans, leaves, spot, NEARLY_OPPOSED)
        if not held or d >= 0.0 or not is_signed_minimum(ja, jb, n, d, best[SIZE], hollow):
            return
    put_normal(leaves, (q, n, d), (ja[0], jb[0]), 0.0 if told else NO_MINIMUM, best, minima)


@kernel
def is_askew(plane, edge, face, line):
    """Is a straight edge, of a jet `line`, not level with a plane? No point of it then has the
    plane's normal across it."""
    if not (is_plane_leaf(plane[0], plane[1]) and dim_of(edge[0], edge[1]) == 1):
        return False
    if norm(line[3]) > 0.0:
        return False
    n = cross(face[1], face[2])
    return abs(dot(n, line[1])) > AT_OPTIMUM * norm(n) * norm(line[1])


@kernel
def never_in(hollow, part):
    """Is one part of a hollow edge, and the other one of what is not held there: a face, or where
    both are straight an edge?"""
    if not is_hollow(hollow.side, hollow.leaf) or is_vertex(part.side, part.leaf):
        return False
    if is_face(part.side, part.leaf):
        return True
    return is_straight(hollow.side, hollow.leaf) and is_straight(part.side, part.leaf)


@kernel
def rests_for(a, b, turn, best):
    """How far B may move before two leaves, as parts, may hold a common normal up to best[ABOVE],
    length; 0: they may now. `turn`: of B as it moves, radians per length. Two planes never do: what
    their faces share has corners, which other pairs hold. Nor does a hollow edge, but with a vertex
    that has gone past it."""
    if is_plane_leaf(a.side, a.leaf) and is_plane_leaf(b.side, b.leaf):
        return inf
    if never_in(a, b) or never_in(b, a):
        return inf
    horizon = best[ABOVE]
    low, free, _ = no_pair(a, b, horizon, best[ROUNDING], turn)
    return max(low - horizon, 0.0) if low >= horizon else free


@kernel
def normal_in_leaves(a, b, q, best, counts):
    """(whether Newton's method comes from parameters to a common normal of two leaves, as parts,
    parameters, n, d)."""
    ja, jb = jets_at(a.side, a.leaf, b.side, b.leaf, q)
    one, other = (a.side, a.leaf), (b.side, b.leaf)
    if is_askew(one, other, ja, jb) or is_askew(other, one, jb, ja):
        return False, q, ZERO, 0.0
    astray, boxes = limits_of((a.box, b.box), ASTRAY), limits_of((a.box, b.box), ENDS_BEYOND)
    found, q, n, d = signed_minimum(a.side, a.leaf, b.side, b.leaf, q, best[SIZE], astray, counts)
    for k in range(4):
        found = found and boxes[0][k] <= q[k] <= boxes[1][k]
    return found, q, n, d


@kernel
def normal_of_leaves(a, b, first, thorough, best, counts):
    """(whether Newton's method comes to a common normal of two leaves, as parts, parameters, n, d;
    the start of the first attempt, as `start_of` tells it, from `first` on). Where one is curved
    round the other it begins at their middles as well, and, if it is to be `thorough`, where they
    are nearest moved apart: a common normal may have come in at a side."""
    begun = start_of(a, b, first, counts)
    start, away, nearest = begun
    found, q, n, d = normal_in_leaves(a, b, start, best, counts)
    if not found and not nearest:
        if norm(away) > 0.0:
            found, q, n, d = normal_in_leaves(a, b, middles_of(a, b), best, counts)
        if not found and thorough:
            beside = nearest_apart(a, b, away, first, counts)
            found, q, n, d = normal_in_leaves(a, b, beside, best, counts)
    return found, q, n, d, begun


@kernel
def look_in_leaves(a, leaf_a, b, leaf_b, fans, best, minima, counts):
    """Newton's method in a pair of leaves."""
    counts[LEAF_PAIRS] += 1
    pa, pb = S.Part(a, leaf_a, leaf_box(a, leaf_a)), S.Part(b, leaf_b, leaf_box(b, leaf_b))
    if rests_for(pa, pb, 0.0, best) > 0.0:
        return
    found, q, n, d, _ = normal_of_leaves(pa, pb, middles_of(pa, pb), True, best, counts)
    if found:
        keep_signed(a, b, fans, (leaf_a, leaf_b), (q, n, d), best[ABOVE], best, minima)


@kernel
def follow_signed(a, b, fans, front, deepest, best, minima, counts):
    """Go on with each branch of the frame before, wherever on its faces and edges it leads, down to
    a depth; those that come to no minimum there have ended (B_TAKEN 0)."""
    r = front.branches
    for i in range(int(front.store[N_BRANCHES])):
        o = BRANCH_REALS * i
        q = (r[o + B_AT], r[o + B_AT + 1], r[o + B_AT + 2], r[o + B_AT + 3])
        leaf_a, leaf_b = int(r[o + B_LEAVES]), int(r[o + B_LEAVES + 1])
        limits = limits_of((leaf_box(a, leaf_a), leaf_box(b, leaf_b)), ANYWHERE)
        found, q, n, d = signed_minimum(a, leaf_a, b, leaf_b, q, best[SIZE], limits, counts)
        ja, jb = jets_at(a, leaf_a, b, leaf_b, q)
        put_three(r, o + B_POINTS, ja[0])
        put_three(r, o + B_POINTS + 3, jb[0])
        count, leaf_a, leaf_b, u, s = int(best[N_MINIMA]), -1, -1, 0.0, 0.0
        if found:
            leaf_a, u = leaf_holding(a, int(r[o + B_LEAVES]), q[0], q[1])
            leaf_b, s = leaf_holding(b, int(r[o + B_LEAVES + 1]), q[2], q[3])
        if leaf_a >= 0 and leaf_b >= 0:
            at = (u, q[1], s, q[3])
            keep_signed(a, b, fans, (leaf_a, leaf_b), (at, n, d), deepest, best, minima)
        kept = best[N_MINIMA] > count
        is_one = kept and minima[MINIMUM_REALS * count + BOUND] != NO_MINIMUM
        r[o + B_TAKEN] = 1.0 if is_one else 0.0


@kernel
def search_signed(a, b, fans, best, minima, stack, most, counts):
    """Look in all pairs of leaves that may hold a minimum. What there is no room or time for counts
    as lost. `stack` has room for `most` pairs of nodes."""
    stack[0], stack[1] = 0, 0
    count = 1
    while count > 0:
        count -= 1
        i, j = stack[2 * count], stack[2 * count + 1]
        counts[NODE_PAIRS] += 1
        gap = gap_of(a, i, b, j) - best[ROUNDING]
        if gap > best[ABOVE] or normals_shut_for(a, i, b, j, gap, 1.0) > 0.0:
            continue
        if evaluations(counts) > best[BUDGET] or count + 2 > most:
            best[LOST] += 1.0
            continue
        ra, rb = node_ints(a, i), node_ints(b, j)
        leaf_a, leaf_b = a.own[ra + 2], b.own[rb + 2]
        if leaf_a >= 0 and leaf_b >= 0:
            look_in_leaves(a, leaf_a, b, leaf_b, fans, best, minima, counts)
            continue
        first = leaf_b >= 0 or (leaf_a < 0 and node_reach(a, i) >= node_reach(b, j))
        for k in range(2):
            stack[2 * count] = a.own[ra + k] if first else i
            stack[2 * count + 1] = j if first else b.own[rb + k]
            count += 1
