"""Branches: the local minima of the frame before, each gone on with from where it was.

A branch is kept through the leaves of the same face or edge as it goes from one into the next. It
has a number for as long as it lives, and what it comes to on another feature is known by its place.
"""

from math import inf, pi

from standoff.kernels.algebra.vectors import dot, norm, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.front_motion import put_three, three_at
from standoff.kernels.solids.front_rows import N_BRANCHES, N_MERGED, NEXT_BRANCH
from standoff.kernels.solids.minima_sets import SET_BRANCH, SET_REALS, SET_ROW, points_of
from standoff.kernels.solids.spatial_minimum import nearest
from standoff.kernels.solids.spatial_pieces import leaf_box, leaf_ints, leaf_jet
from standoff.kernels.solids.spatial_progress import (
    MINIMUM_REALS,
    farthest,
    keep,
    on_both,
)
from standoff.kernels.solids.spatial_tolerances import HELD_SLOPE, PAST_SIDE, SAME_BASIN

# What a branch holds: leaves, parameters, its number, both points in A's frame, and 1 once a
# minimum of this frame has its number.
B_LEAVES, B_AT, B_NUMBER, B_POINTS, B_TAKEN = 0, 2, 6, 7, 13
BRANCH_REALS = 14
# Of a branch that has come to the place of another one: the frame of the call, both numbers. There
# is room for so many.
MERGED_REALS, MOST_MERGED = 3, 256
# From leaf to leaf in one frame.
MOST_HANDOVERS = 4


@kernel
def at_side(x, low, high, first, last, at_cuts):
    """-1 or 1 where a parameter is at an end of its interval, else 0; if asked, only at an end that
    is none of the leaf's."""
    if high <= low:
        return 0.0
    if x <= low and (low > first or not at_cuts):
        return -1.0
    return 1.0 if x >= high and (high < last or not at_cuts) else 0.0


@kernel
def slope_at(i, part, jet, u, v, delta, at_cuts):
    """(sine by which a pair is nearer, or farther, across the side of a part that its parameter `i`
    is at, which side); 0: at none."""
    box, whole = part.box, leaf_box(part.side, part.leaf)
    if i == 0:
        side = at_side(u, box.u0, box.u1, whole.u0, whole.u1, at_cuts)
    else:
        side = at_side(v, box.v0, box.v1, whole.v0, whole.v1, at_cuts)
    tangent = jet[1 + i]
    length = norm(tangent) * norm(delta)
    return (abs(dot(delta, tangent)) / length if side != 0.0 and length > 0.0 else 0.0), side


@kernel
def steepest_side(a, b, q, at_cuts):
    """(sine, parameter, side) of the side of a part across which a pair is nearest, to first
    order; of those sides only at which a leaf was cut, where that is asked."""
    ja, jb = leaf_jet(a.side, a.leaf, q[0], q[1]), leaf_jet(b.side, b.leaf, q[2], q[3])
    delta = sub(jb[0], ja[0])
    most, which, side = 0.0, -1, 0.0
    for i in range(2):
        sine, end = slope_at(i, a, ja, q[0], q[1], delta, at_cuts)
        if sine > most:
            most, which, side = sine, i, end
        sine, end = slope_at(i, b, jb, q[2], q[3], delta, at_cuts)
        if sine > most:
            most, which, side = sine, 2 + i, end
    return most, which, side


@kernel
def holds_across(side, k, leaf, u, v):
    """Is a leaf of the same chart, or of the same edge, as another one, and has the parameters?"""
    r, s = leaf_ints(side, leaf), leaf_ints(side, k)
    if side.own[r + S.FEATURE] != side.own[s + S.FEATURE]:
        return False
    if side.own[r + S.DIM] != side.own[s + S.DIM] or side.own[r + S.CHART] != side.own[s + S.CHART]:
        return False
    box = leaf_box(side, k)
    return box.u0 <= u <= box.u1 and box.v0 <= v <= box.v1


@kernel
def leaf_beyond(side, leaf, u, v, i, end):
    """(leaf, u) next to one across the side that its parameter `i` is at; -1: the feature ends."""
    box = leaf_box(side, leaf)
    x = u + (end * PAST_SIDE * (box.u1 - box.u0) if i == 0 else 0.0)
    y = v + (end * PAST_SIDE * (box.v1 - box.v0) if i == 1 else 0.0)
    k, shift = leaf_beside(side, leaf, x, y)
    return k, u + shift


@kernel
def leaf_beside(side, leaf, u, v):
    """(another leaf of the same face or edge that has the parameters, by how much u is more there):
    what goes round is met again a turn away; -1: none."""
    for turn in range(3):
        shift = 2.0 * pi * (turn if turn < 2 else -1)
        for k in range(side.own[S.N_LEAVES]):
            if k != leaf and holds_across(side, k, leaf, u + shift, v):
                return k, shift
    return -1, 0.0


@kernel
def walk(a, b, leaf_a, leaf_b, q, counts):
    """(leaves, parameters, distance) that Newton's method comes to from a pair of points, over the
    leaves of both its features, one after the other."""
    distance = inf
    for _ in range(MOST_HANDOVERS):
        box_a, box_b = leaf_box(a, leaf_a), leaf_box(b, leaf_b)
        q, distance = nearest(a, leaf_a, box_a, b, leaf_b, box_b, q, counts)
        pa, pb = S.Part(a, leaf_a, box_a), S.Part(b, leaf_b, box_b)
        sine, i, end = steepest_side(pa, pb, q, False)
        if sine <= HELD_SLOPE:
            break
        if i < 2:
            k, u = leaf_beyond(a, leaf_a, q[0], q[1], i, end)
            if k < 0:
                break
            leaf_a, q = k, (u, q[1], q[2], q[3])
        else:
            k, u = leaf_beyond(b, leaf_b, q[2], q[3], i - 2, end)
            if k < 0:
                break
            leaf_b, q = k, (q[0], q[1], u, q[3])
    return leaf_a, leaf_b, q, distance


@kernel
def follow_branches(a, b, front, best, minima, counts):
    """Go on with each branch of the frame before, and keep what it comes to among the minima."""
    for i in range(int(front.store[N_BRANCHES])):
        o, r = BRANCH_REALS * i, front.branches
        q = (r[o + B_AT], r[o + B_AT + 1], r[o + B_AT + 2], r[o + B_AT + 3])
        leaf_a, leaf_b = int(r[o + B_LEAVES]), int(r[o + B_LEAVES + 1])
        leaf_a, leaf_b, q, distance = walk(a, b, leaf_a, leaf_b, q, counts)
        x, y = leaf_jet(a, leaf_a, q[0], q[1])[0], leaf_jet(b, leaf_b, q[2], q[3])[0]
        put_three(r, o + B_POINTS, x)
        put_three(r, o + B_POINTS + 3, y)
        pa, pb = S.Part(a, leaf_a, leaf_box(a, leaf_a)), S.Part(b, leaf_b, leaf_box(b, leaf_b))
        if distance <= farthest(best) and on_both(pa, pb, q):
            keep(best, minima, pa, pb, q, distance)


@kernel
def nearest_free(front, minima, sets, n, reach):
    """(set, branch), of those that have none yet the nearest within `reach`; -1: none."""
    r = front.branches
    least, at, which = reach, -1, -1
    for k in range(n):
        if sets[SET_REALS * k + SET_BRANCH] >= 0.0:
            continue
        x, y = points_of(minima, MINIMUM_REALS * int(sets[SET_REALS * k + SET_ROW]))
        for i in range(int(front.store[N_BRANCHES])):
            o = BRANCH_REALS * i
            if r[o + B_TAKEN] > 0.0:
                continue
            off_a = norm(sub(three_at(r, o + B_POINTS), x))
            away = max(off_a, norm(sub(three_at(r, o + B_POINTS + 3), y)))
            if away < least:
                least, at, which = away, k, i
    return at, which


@kernel
def number_sets(front, minima, sets, n, reach, frame):
    """Give each local minimum the number of its branch: of all minima and branches, within
    `reach`, those are paired first that are nearest. Others get a new number."""
    r, count = front.branches, int(front.store[N_BRANCHES])
    for i in range(count):
        r[BRANCH_REALS * i + B_TAKEN] = 0.0
    at, which = nearest_free(front, minima, sets, n, reach)
    while at >= 0:
        sets[SET_REALS * at + SET_BRANCH], r[BRANCH_REALS * which + B_TAKEN] = which, 1.0
        at, which = nearest_free(front, minima, sets, n, reach)
    for k in range(n):
        s = SET_REALS * k + SET_BRANCH
        if sets[s] >= 0.0:
            sets[s] = r[BRANCH_REALS * int(sets[s]) + B_NUMBER]
        else:
            sets[s] = front.store[NEXT_BRANCH]
            front.store[NEXT_BRANCH] += 1.0
    for i in range(count):
        if r[BRANCH_REALS * i + B_TAKEN] == 0.0:
            tell_merged(front, minima, sets, n, reach, frame, i)


@kernel
def tell_merged(front, minima, sets, n, reach, frame, i):
    """Write down whether a branch that has ended came to the place of another one."""
    o, r = BRANCH_REALS * i, front.branches
    count = int(front.store[N_MERGED])
    least, into = reach, -1.0
    for k in range(n):
        x, y = points_of(minima, MINIMUM_REALS * int(sets[SET_REALS * k + SET_ROW]))
        off_a = norm(sub(three_at(r, o + B_POINTS), x))
        away = max(off_a, norm(sub(three_at(r, o + B_POINTS + 3), y)))
        if away < least:
            least, into = away, sets[SET_REALS * k + SET_BRANCH]
    if into >= 0.0 and count < MOST_MERGED:
        m = MERGED_REALS * count
        front.merged[m], front.merged[m + 1], front.merged[m + 2] = frame, r[o + B_NUMBER], into
        front.store[N_MERGED] += 1.0


@kernel
def renew_branches(front, minima, sets, n):
    """The numbered local minima are the branches of the next frame."""
    for k in range(n):
        o, s, r = BRANCH_REALS * k, SET_REALS * k, front.branches
        for i in range(6):
            r[o + B_LEAVES + i] = sets[s + 1 + i]
        r[o + B_NUMBER] = sets[s + SET_BRANCH]
        x, y = points_of(minima, MINIMUM_REALS * int(sets[s + SET_ROW]))
        put_three(r, o + B_POINTS, x)
        put_three(r, o + B_POINTS + 3, y)
    front.store[N_BRANCHES] = n


@kernel
def branch_reach(size, ahead):
    """How far a minimum may be from where its branch came to, length."""
    return SAME_BASIN * size + ahead
