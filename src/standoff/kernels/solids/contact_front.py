"""The front of a contact: pairs of nodes and of leaves that hold all common normals of two
boundaries up to a length on both sides of 0, each with how far B may move before it is to be looked
at.

A pair of nodes rests by what is proven of it. In a pair of leaves that may hold a common normal now
Newton's method goes on in each frame from where it came to. Where it came to none it is tried again
in one of some frames, or where a branch ends, or a common normal leaves its leaves, that may go
on there; where the way there is held at a side of a leaf, not before the motion may have changed
that, and where leaves that are curved round each other are apart, not before they may be half as
far. Two vertices have one normal, which comes to 0 when they meet, and not before.
"""

from math import inf
from typing import Any, NamedTuple

from standoff.kernels.algebra.rigid import read_vector
from standoff.kernels.algebra.vectors import norm, scale, sub
from standoff.kernels.compiler.decorators import kernel, shared
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.contact_ends import keep_end
from standoff.kernels.solids.contact_minimum import middles_of
from standoff.kernels.solids.contact_rest import apart_for, held_for
from standoff.kernels.solids.contact_search import (
    follow_signed,
    is_vertex,
    keep_signed,
    normal_in_leaves,
    normal_of_leaves,
    rests_for,
)
from standoff.kernels.solids.front_branches import (
    B_LEAVES,
    B_POINTS,
    B_TAKEN,
    BRANCH_REALS,
)
from standoff.kernels.solids.front_frame import GROWN, GROWN_BY
from standoff.kernels.solids.front_rows import FRAME, GONE, MAKING, N_BRANCHES, N_MADE, N_ROWS
from standoff.kernels.solids.spatial_boxes import gap_of, node_reach, normals_shut_for
from standoff.kernels.solids.spatial_minimum import jets_at
from standoff.kernels.solids.spatial_pieces import ZERO, along, leaf_box, leaf_ints, leaf_jet
from standoff.kernels.solids.spatial_progress import (
    ABOVE,
    BUDGET,
    LEAF_PAIRS,
    LOST,
    N_MINIMA,
    NODE_PAIRS,
    ROUNDING,
    evaluations,
    middle,
)
from standoff.kernels.solids.spatial_search import node_ints

# What a row holds: leaves (-1 - node where it is a node), up to which motion it rests, what
# Newton's method came to, and where; where it came to none, from where it began.
C_A, C_B, C_REST, C_TOLD, C_AT = 0, 1, 2, 3, 4
CONTACT_REALS = 8
# Not looked at yet; came to a common normal; came to none; came to none, as the leaves moved apart
# are nearest at a side of one, and rests while that can hardly have changed; came to none, and is
# apart, and rests until it may be near contact.
UNSEEN, CAME, CAME_TO_NONE, HELD, APART = 0.0, 1.0, 2.0, 3.0, 4.0
# Times the way of a common normal out of its leaves, within which it is looked for beside them.
PAST_LEAF = 2.0
# Of the distance of two vertices: how far B may move, in ticks, before they are looked at again.
RESTS_ABOVE = 0.5
# Of so many frames in one it is tried again in a pair of leaves in which it came to none, at least.
MOST_RETRIED_IN = 4


class Both(NamedTuple):
    """Two solids, B at its pose in A's frame, with the directions from their vertices."""

    a: Any
    b: Any
    fans: Any


@kernel
def put_pair(front, k, i, j):
    o, r = CONTACT_REALS * k, front.rows
    r[o + C_A], r[o + C_B], r[o + C_REST], r[o + C_TOLD] = i, j, -inf, UNSEEN


@kernel
def make_rows(front):
    """One row, of both roots."""
    front.store[N_ROWS], front.store[N_MADE], front.store[MAKING] = 1.0, 0.0, 1.0
    put_pair(front, 0, -1, -1)


@kernel
def cut_nodes(a, i, b, j, front, k):
    """Put the parts of the longer of two nodes in a row's place; whether there is room."""
    n = int(front.store[N_ROWS])
    if n >= front.most:
        return False
    ra, rb = node_ints(a, i), node_ints(b, j)
    leaf_a, leaf_b = a.own[ra + 2], b.own[rb + 2]
    if leaf_b >= 0 or (leaf_a < 0 and node_reach(a, i) >= node_reach(b, j)):
        put_pair(front, k, -1 - a.own[ra], -1 - j)
        put_pair(front, n, -1 - a.own[ra + 1], -1 - j)
    else:
        put_pair(front, k, -1 - i, -1 - b.own[rb])
        put_pair(front, n, -1 - i, -1 - b.own[rb + 1])
    front.store[N_ROWS] = n + 1
    return True


@kernel
def look_at_nodes(a, b, front, k, radius, best, counts):
    """Let a pair of nodes rest, or cut it; whether what is in its place is to be looked at."""
    o, r = CONTACT_REALS * k, front.rows
    i, j = -1 - int(r[o + C_A]), -1 - int(r[o + C_B])
    counts[NODE_PAIRS] += 1
    gap = gap_of(a, i, b, j) - best[ROUNDING]
    free = max(gap - best[ABOVE], normals_shut_for(a, i, b, j, gap, radius))
    if free > 0.0:
        r[o + C_REST] = front.store[GONE] + free
        return False
    leaf_a, leaf_b = a.own[node_ints(a, i) + 2], b.own[node_ints(b, j) + 2]
    if leaf_a >= 0 and leaf_b >= 0:
        put_pair(front, k, leaf_a, leaf_b)
        return True
    if evaluations(counts) > best[BUDGET] or not cut_nodes(a, i, b, j, front, k):
        best[LOST] += 1.0
        return False
    return True


@kernel
def is_near(side, leaf, x, reach):
    """Is a leaf as near as `reach` to a point, as far as it reaches towards it?"""
    box = leaf_box(side, leaf)
    u, v = middle(box)
    jet = leaf_jet(side, leaf, u, v)
    delta = sub(x, jet[0])
    away = norm(delta)
    if away <= reach:
        return True
    half = 0.5 * (box.u1 - box.u0), 0.5 * (box.v1 - box.v0)
    return away - along(side, leaf, jet, scale(1.0 / away, delta), half) <= reach


@kernel
def is_of_one_feature(side, leaf, other):
    return (
        side.own[leaf_ints(side, leaf) + S.FEATURE] == side.own[leaf_ints(side, other) + S.FEATURE]
    )


@kernel
def waits(front, k):
    """Is a row a pair of leaves in which Newton's method came to no common normal, and that is not
    to be looked at in this frame anyway?"""
    o, r = CONTACT_REALS * k, front.rows
    none = r[o + C_TOLD] == CAME_TO_NONE and r[o + C_REST] <= front.store[GONE]
    return none or r[o + C_TOLD] == HELD


@kernel
def wake(both, front, x, y, reach, retried):
    """Look again in the pairs of leaves in which Newton's method came to no common normal, and
    which are as near as `reach` to a pair of points. `retried`: as of `find_contacts`."""
    rows = front.rows
    for k in range(int(front.store[N_ROWS])):
        o = CONTACT_REALS * k
        if retried == 1 and rows[o + C_TOLD] == CAME_TO_NONE:
            continue  # it is tried in this frame anyway
        if (
            waits(front, k)
            and is_near(both.a, int(rows[o + C_A]), x, reach)
            and is_near(both.b, int(rows[o + C_B]), y, reach)
        ):
            rows[o + C_TOLD], rows[o + C_REST] = CAME_TO_NONE, -inf


@kernel
def wake_alike(both, front, leaves):
    """Look again, in turn, in those of the features of a pair of leaves."""
    rows = front.rows
    for k in range(int(front.store[N_ROWS])):
        o = CONTACT_REALS * k
        if (
            waits(front, k)
            and is_of_one_feature(both.a, int(rows[o + C_A]), leaves[0])
            and is_of_one_feature(both.b, int(rows[o + C_B]), leaves[1])
        ):
            rows[o + C_TOLD], rows[o + C_REST] = CAME_TO_NONE, -inf


@kernel
def wake_ended(both, front, reach, retried):
    """A branch that has ended may go on beside where it was, or anywhere on its features."""
    r = front.branches
    for i in range(int(front.store[N_BRANCHES])):
        b = BRANCH_REALS * i
        if r[b + B_TAKEN] == 0.0:
            leaves = int(r[b + B_LEAVES]), int(r[b + B_LEAVES + 1])
            x, y = read_vector(r, b + B_POINTS), read_vector(r, b + B_POINTS + 3)
            wake_alike(both, front, leaves)
            wake(both, front, x, y, reach, retried)


@kernel
def place_of(row, o):
    return (row[o + C_AT], row[o + C_AT + 1], row[o + C_AT + 2], row[o + C_AT + 3])


@kernel
def wake_beside(both, front, k, q, retried, best):
    """A common normal has left the leaves of a row, towards parameters `q` as Newton's method
    tells: look again in those where it may be now."""
    r, o = front.rows, CONTACT_REALS * k
    leaf_a, leaf_b = int(r[o + C_A]), int(r[o + C_B])
    ja, jb = jets_at(both.a, leaf_a, both.b, leaf_b, place_of(r, o))
    ka, kb = jets_at(both.a, leaf_a, both.b, leaf_b, q)
    went = max(norm(sub(ka[0], ja[0])), norm(sub(kb[0], jb[0])))
    reach = PAST_LEAF * went if went > 0.0 else best[ABOVE]
    wake(both, front, ja[0], jb[0], reach, retried)


@kernel
def begin_again(pa, pb, front, k, turn, best, counts):
    """(whether Newton's method comes to a common normal of a row's leaves, parameters, n, d), from
    where they are nearest moved apart."""
    o, r = CONTACT_REALS * k, front.rows
    tried, woken = r[o + C_TOLD] in (CAME_TO_NONE, HELD, APART), r[o + C_REST] == -inf
    first = place_of(r, o) if tried else middles_of(pa, pb)
    found, q, n, d, begun = normal_of_leaves(pa, pb, first, woken, best, counts)
    start, away, nearest = begun
    r[o + C_TOLD], r[o + C_REST] = CAME if found else CAME_TO_NONE, front.store[GONE]
    put_four(r, o + C_AT, q if found else start)
    if not found:
        free = held_for(pa, pb, start, away, turn) if nearest else apart_for(pa, pb, start, best)
        if free > 0.0:
            r[o + C_TOLD], r[o + C_REST] = HELD if nearest else APART, front.store[GONE] + free
    return found, q, n, d


@kernel
def put_four(r, o, q):
    for i in range(4):
        r[o + i] = q[i]


@kernel
def look_at_leaves(both, front, k, turn, retried, best, minima, counts):
    """Keep the common normal of a pair of leaves, or let it rest. One that has left them is beside
    them. `turn`, `retried`: as of `rests_for` and `find_contacts`."""
    o, r = CONTACT_REALS * k, front.rows
    counts[LEAF_PAIRS] += 1
    leaves = int(r[o + C_A]), int(r[o + C_B])
    pa = S.Part(both.a, leaves[0], leaf_box(both.a, leaves[0]))
    pb = S.Part(both.b, leaves[1], leaf_box(both.b, leaves[1]))
    free = rests_for(pa, pb, turn, best)
    if free > 0.0:
        r[o + C_REST] = front.store[GONE] + free
        r[o + C_TOLD] = CAME_TO_NONE if r[o + C_TOLD] >= HELD else r[o + C_TOLD]
        return
    if evaluations(counts) > best[BUDGET]:
        best[LOST] += 1.0
        return
    found, q, n, d = False, place_of(r, o), ZERO, 0.0
    if r[o + C_TOLD] == CAME:
        found, q, n, d = normal_in_leaves(pa, pb, q, best, counts)
        if found:
            put_four(r, o + C_AT, q)
        else:
            wake_beside(both, front, k, q, retried, best)
    if not found:
        found, q, n, d = begin_again(pa, pb, front, k, turn, best, counts)
    if found:
        spot = q, n, d
        keep_signed(both.a, both.b, both.fans, leaves, spot, best[ABOVE], best, minima)
        if retried > 1 and is_vertex(both.a, leaves[0]) and is_vertex(both.b, leaves[1]):
            r[o + C_REST] = front.store[GONE] + RESTS_ABOVE * abs(d)


@kernel
def is_to_be_looked_at(front, k, retried):
    """Does a row not rest, in this frame?"""
    o, r = CONTACT_REALS * k, front.rows
    if r[o + C_REST] > front.store[GONE]:
        return False
    if r[o + C_TOLD] != CAME_TO_NONE or r[o + C_REST] == -inf:
        return True
    return (int(front.store[FRAME]) + k) % retried == 0


@kernel
def keep_ends(both, front, best, minima, counts):
    """Keep the ends of edges' leaves under faces, of all pairs of leaves that do not rest."""
    for k in range(int(front.store[N_ROWS])):
        o, r = CONTACT_REALS * k, front.rows
        rests = r[o + C_REST] > front.store[GONE] and r[o + C_TOLD] != HELD
        if r[o + C_A] >= 0.0 and not rests:
            keep_end(both, (int(r[o + C_A]), int(r[o + C_B])), best, minima, counts)


@kernel
def look_at_rows(both, front, radius, retried, best, minima, counts):
    k = 0
    while k < int(front.store[N_ROWS]):
        if not is_to_be_looked_at(front, k, retried):
            k += 1
        elif front.rows[CONTACT_REALS * k + C_A] >= 0.0:
            look_at_leaves(both, front, k, 1.0 / radius, retried, best, minima, counts)
            k += 1
        elif not look_at_nodes(both.a, both.b, front, k, radius, best, counts):
            k += 1


@kernel
def look_at_woken(both, front, radius, retried, best, minima, counts):
    """Those that were woken after their turn."""
    for k in range(int(front.store[N_ROWS])):
        o = CONTACT_REALS * k
        if front.rows[o + C_TOLD] == CAME_TO_NONE and front.rows[o + C_REST] == -inf:
            look_at_leaves(both, front, k, 1.0 / radius, retried, best, minima, counts)


@kernel
def look_again(both, front, radius, best, minima, counts):
    """Try Newton's method now in all pairs of leaves in which it came to none and that may hold a
    common normal."""
    rows = front.rows
    for k in range(int(front.store[N_ROWS])):
        o = CONTACT_REALS * k
        if waits(front, k):
            rows[o + C_TOLD], rows[o + C_REST] = CAME_TO_NONE, -inf
    look_at_woken(both, front, radius, 1, best, minima, counts)


@shared
def find_contacts(both, front, radius, retried, best, minima, counts):
    """Keep the common normals up to best[ABOVE] on both sides of 0, and what the branches come to
    at any depth. What there is no room or time for counts as lost. `radius`: of B, length, by which
    its turns count as motion; `retried`: of how many frames in one a pair of leaves is tried again
    that came to none."""
    store = front.store
    best[N_MINIMA], best[LOST] = 0.0, 0.0
    store[FRAME] += 1.0
    grown = store[MAKING] == 0.0 and store[N_ROWS] > GROWN * store[N_MADE] + GROWN_BY
    if store[N_ROWS] == 0.0 or grown:
        make_rows(front)
    follow_signed(both.a, both.b, both.fans, front, inf, best, minima, counts)
    wake_ended(both, front, best[ABOVE], retried)
    look_at_rows(both, front, radius, retried, best, minima, counts)
    look_at_woken(both, front, radius, retried, best, minima, counts)
    if store[MAKING] > 0.0 and best[LOST] == 0.0:
        store[N_MADE], store[MAKING] = store[N_ROWS], 0.0
