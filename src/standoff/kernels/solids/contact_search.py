"""All local minima of the signed distance of two boundaries, up to a length on both sides of 0:
Newton's method in every pair of leaves that is near enough, and may have a common normal.

Nothing here needs the solids to be apart. A pair whose signed distance is d has points |d| apart,
so that boxes which are farther from each other than the length hold none; and its normals are
opposed.
"""

from math import asin, pi

from standoff.kernels.algebra.vectors import cross, dot, norm, scale, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.contact_minimum import (
    is_signed_minimum,
    limits_of,
    nearest_moved_apart,
    signed_minimum,
)
from standoff.kernels.solids.contact_sets import NO_MINIMUM
from standoff.kernels.solids.front_branches import (
    B_AT,
    B_LEAVES,
    B_POINTS,
    BRANCH_REALS,
    leaf_beside,
)
from standoff.kernels.solids.front_motion import put_three
from standoff.kernels.solids.front_rows import N_BRANCHES
from standoff.kernels.solids.over_plane import is_plane_leaf
from standoff.kernels.solids.planar_tolerances import AT_OPTIMUM
from standoff.kernels.solids.spatial_boxes import (
    angle_between,
    cone_of,
    gap_of,
    node_centre,
    node_reach,
)
from standoff.kernels.solids.spatial_closing import no_pair
from standoff.kernels.solids.spatial_minimum import jets_at
from standoff.kernels.solids.spatial_pieces import (
    leaf_box,
    leaf_ints,
    on_solid,
)
from standoff.kernels.solids.spatial_progress import (
    ABOVE,
    BOUND,
    BUDGET,
    LEAF_PAIRS,
    LOST,
    MINIMUM_REALS,
    MOST_MINIMA,
    N_MINIMA,
    NODE_PAIRS,
    NORMAL,
    POINTS,
    ROUNDING,
    SIZE,
    evaluations,
)
from standoff.kernels.solids.spatial_search import node_ints
from standoff.kernels.solids.spatial_tolerances import CONE_SPARE, PAST_SIDE
from standoff.kernels.solids.stationary import is_stationary

# Widths of a leaf by which Newton's method may leave it on its way, and end outside of it.
ASTRAY, ENDS_BEYOND = 1.0, PAST_SIDE
# A branch may go anywhere on its face, so far in units of its leaf.
ANYWHERE = 64.0


@kernel
def leads_past(axis, angle, way, spread):
    """Are all directions within `spread` of a unit vector outside a cone?"""
    return angle_between(axis, way) - angle - CONE_SPARE > spread


@kernel
def may_oppose(a, i, b, j, gap):
    """May two nodes hold features with a common normal, along the line between their points, from
    either to the other? False is proven."""
    axis_a, angle_a = cone_of(a, i)
    axis_b, angle_b = cone_of(b, j)
    if angle_a < 0.0 or angle_b < 0.0:
        return False
    if pi - angle_a - angle_b - CONE_SPARE - angle_between(axis_a, axis_b) > 0.0:
        return False
    delta = sub(node_centre(b, j), node_centre(a, i))
    length, reach = norm(delta), node_reach(a, i) + node_reach(b, j)
    if gap <= 0.0 or length <= reach:
        return True
    n, spread = scale(1.0 / length, delta), asin(reach / length)
    back = scale(-1.0, n)
    apart = leads_past(axis_a, angle_a, n, spread) or leads_past(axis_b, angle_b, back, spread)
    if not apart:
        return True
    return not (leads_past(axis_a, angle_a, back, spread) or leads_past(axis_b, angle_b, n, spread))


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
    return side.own[leaf_ints(side, leaf) + S.DIM] == 2


@kernel
def keep_signed(a, b, fans, leaves, spot, best, minima):
    """Keep a pair of points with a common normal, if both are on the solids; of two edges' two
    normals the one that both solids have. spot: parameters, normal, signed distance."""
    q, n, d = spot
    horizon = best[ABOVE]
    if abs(d) > horizon or not on_solid(a, leaves[0], q[0], q[1]):
        return
    if not on_solid(b, leaves[1], q[2], q[3]):
        return
    still = is_stationary(a, b, fans[0], fans[1], q, leaves, n, AT_OPTIMUM)
    faces = is_face(a, leaves[0]) or is_face(b, leaves[1])
    if not still and not faces:
        back = scale(-1.0, n)
        if not is_stationary(a, b, fans[0], fans[1], q, leaves, back, AT_OPTIMUM):
            return
        still, n, d = True, back, -d
    if best[N_MINIMA] >= best[MOST_MINIMA]:
        best[LOST] += 1.0
        return
    ja, jb = jets_at(a, leaves[0], b, leaves[1], q)
    o = MINIMUM_REALS * int(best[N_MINIMA])
    minima[o], minima[o + 1], minima[o + 2] = d, leaves[0], leaves[1]
    for k in range(4):
        minima[o + 3 + k] = q[k]
    put_three(minima, o + POINTS, ja[0])
    put_three(minima, o + POINTS + 3, jb[0])
    put_three(minima, o + NORMAL, n)
    told = still and is_signed_minimum(ja, jb, n, d, best[SIZE])
    minima[o + BOUND] = 0.0 if told else NO_MINIMUM
    best[N_MINIMA] += 1.0


@kernel
def is_askew(plane, edge, face, line):
    """Is a straight edge, of a jet `line`, not level with a plane? No point of it then has the
    plane's normal across it."""
    if not (
        is_plane_leaf(plane[0], plane[1]) and edge[0].own[leaf_ints(edge[0], edge[1]) + S.DIM] == 1
    ):
        return False
    if norm(line[3]) > 0.0:
        return False
    n = cross(face[1], face[2])
    return abs(dot(n, line[1])) > AT_OPTIMUM * norm(n) * norm(line[1])


@kernel
def look_in_leaves(a, leaf_a, b, leaf_b, fans, best, minima, counts):
    """Newton's method in a pair of leaves. Of two planes it is left out: what their faces share has
    corners, which other pairs hold."""
    counts[LEAF_PAIRS] += 1
    if is_plane_leaf(a, leaf_a) and is_plane_leaf(b, leaf_b):
        return
    box_a, box_b = leaf_box(a, leaf_a), leaf_box(b, leaf_b)
    pa, pb = S.Part(a, leaf_a, box_a), S.Part(b, leaf_b, box_b)
    horizon = best[ABOVE]
    low, free, _ = no_pair(pa, pb, horizon, best[ROUNDING], 0.0)
    if low > horizon or free > 0.0:
        return
    q = nearest_moved_apart(pa, pb, counts)
    ja, jb = jets_at(a, leaf_a, b, leaf_b, q)
    if is_askew((a, leaf_a), (b, leaf_b), ja, jb) or is_askew((b, leaf_b), (a, leaf_a), jb, ja):
        return
    astray = limits_of((box_a, box_b), ASTRAY)
    found, q, n, d = signed_minimum(a, leaf_a, b, leaf_b, q, best[SIZE], astray, counts)
    if not found:
        return
    low, high = limits_of((box_a, box_b), ENDS_BEYOND)
    for k in range(4):
        if not low[k] <= q[k] <= high[k]:
            return
    keep_signed(a, b, fans, (leaf_a, leaf_b), (q, n, d), best, minima)


@kernel
def follow_signed(a, b, fans, front, best, minima, counts):
    """Go on with each branch of the frame before, wherever on its faces and edges it leads."""
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
        if not found:
            continue
        leaf_a, u = leaf_holding(a, leaf_a, q[0], q[1])
        leaf_b, s = leaf_holding(b, leaf_b, q[2], q[3])
        if leaf_a >= 0 and leaf_b >= 0:
            at = (u, q[1], s, q[3])
            keep_signed(a, b, fans, (leaf_a, leaf_b), (at, n, d), best, minima)


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
        if gap > best[ABOVE] or not may_oppose(a, i, b, j, gap):
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
