"""The least distance of two solids' boundaries: best first over their trees, then each pair of
leaves that is left is closed."""

from standoff.kernels.compiler.decorators import kernel, shared
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_boxes import admits, gap_of, node_reach, push, take
from standoff.kernels.solids.spatial_closing import (
    close_leaves,
    closed_by_any,
    left_out,
    nearest_of,
    no_pair,
)
from standoff.kernels.solids.spatial_pieces import leaf_box
from standoff.kernels.solids.spatial_progress import (
    ABOVE,
    BUDGET,
    LEAF_PAIRS,
    LEAST,
    LEFT_REALS,
    MET,
    MOST_OPEN,
    N_MINIMA,
    N_OPEN,
    NODE_PAIRS,
    NOWHERE,
    OF_LEAVES,
    OPEN,
    ROUNDING,
    TOLERANCE,
    bound_minima,
    evaluations,
    farthest,
    goal_of,
    keep_found,
    leave_open,
)

# Share of the evaluations from which on a search is hard: all pairs are closed loosely first.
LOOSE_FROM = 0.25
# Boxes that a pair with a plane is looked at with when it is met.
MOST_VISITED = 12


@kernel
def node_ints(side, node):
    return side.own[S.NODES] + S.NODE_INTS * node


@kernel
def offer(a, i, b, j, best, heap, count, counts):
    """Put a pair of nodes into the heap unless it cannot hold a nearest pair; its new count."""
    keys, firsts, others, limit = heap
    counts[NODE_PAIRS] += 1
    gap = gap_of(a, i, b, j) - best[ROUNDING]
    if gap > farthest(best) or not admits(a, i, b, j, gap):
        return count
    if count >= limit:
        leave_open(best, -1 - i, -1 - j, NOWHERE, NOWHERE, max(gap, 0.0))
        return count
    return push(keys, firsts, others, count, gap, i, j)


@shared
def search(a, b, best, minima, heap, room, counts):
    """Fill `best` and `minima`; best[OPEN] is then a proven lower bound of what was not closed.

    room: what holds the pairs of leaves that are left, how many fit, and work space."""
    pairs, _, work = room
    count = offer(a, 0, b, 0, best, heap, 0, counts)
    left = 0
    while count > 0 and best[MET] == 0.0:
        key, i, j, count = take(heap[0], heap[1], heap[2], count)
        if key > farthest(best):
            break
        if evaluations(counts) > best[BUDGET] and best[N_MINIMA] > 0.0:
            leave_open(best, -1 - i, -1 - j, NOWHERE, NOWHERE, max(key, 0.0))
            continue
        ra, rb = node_ints(a, i), node_ints(b, j)
        leaf_a, leaf_b = a.own[ra + 2], b.own[rb + 2]
        if leaf_a >= 0 and leaf_b >= 0:
            pa = S.Part(a, leaf_a, leaf_box(a, leaf_a))
            pb = S.Part(b, leaf_b, leaf_box(b, leaf_b))
            left = visit(pa, pb, key, best, minima, room, left, counts)
            continue
        if leaf_b >= 0 or (leaf_a < 0 and node_reach(a, i) >= node_reach(b, j)):
            count = offer(a, a.own[ra], b, j, best, heap, count, counts)
            count = offer(a, a.own[ra + 1], b, j, best, heap, count, counts)
        else:
            count = offer(a, i, b, b.own[rb], best, heap, count, counts)
            count = offer(a, i, b, b.own[rb + 1], best, heap, count, counts)
    loose = False
    for k in range(left):
        pair = pair_left(pairs, k)
        if not loose and evaluations(counts) > LOOSE_FROM * best[BUDGET]:
            loose = True
            close_loosely(a, b, k, left, best, minima, room, counts)
        low = pairs[LEFT_REALS * k + 2]
        if low < goal_of(best) and best[MET] == 0.0:
            pair = (pair[0], pair[1], low, pair[3], pair[4])
            low = closed_pair(a, b, pair, best, minima, work, counts)
        if best[ABOVE] > 0.0:
            bound_minima(best, minima, pair[0], pair[1], low)


@kernel
def pair_left(pairs, k):
    """(leaves, bound, parameters and distance of the nearest points found) of the k-th pair."""
    o = LEFT_REALS * k
    q = (pairs[o + 4], pairs[o + 5], pairs[o + 6], pairs[o + 7])
    return int(pairs[o]), int(pairs[o + 1]), pairs[o + 2], q, pairs[o + 3]


@kernel
def closed_pair(a, b, pair, best, minima, work, counts):
    """The proven bound of a pair of leaves, which is closed as far as it can be."""
    counts[LEAF_PAIRS] += 1
    best[OF_LEAVES] = goal_of(best) - best[ROUNDING]
    close_leaves(a, b, pair, best, minima, work, counts)
    return best[OF_LEAVES]


@kernel
def close_loosely(a, b, first, left, best, minima, room, counts):
    """Of a hard search, prove of all pairs of leaves from `first` on that they are half of the
    least distance apart: an end of the evaluations then leaves that much of a bound. Of those that
    are closed at once nothing is left to prove."""
    pairs, _, work = room
    if best[ABOVE] > 0.0:
        return
    tolerance, open_, n_open, listed = best[TOLERANCE], best[OPEN], best[N_OPEN], best[MOST_OPEN]
    best[MOST_OPEN] = 0.0
    for k in range(first, left):
        best[TOLERANCE] = tolerance
        pair = pair_left(pairs, k)
        at_once = pair[2] < goal_of(best) <= pair[4] and evaluations(counts) <= best[BUDGET]
        if at_once and best[MET] == 0.0:
            pa = S.Part(a, pair[0], leaf_box(a, pair[0]))
            pb = S.Part(b, pair[1], leaf_box(b, pair[1]))
            if closed_by_any(pa, pb, (pair[3], pair[4]), best, minima, False, counts):
                pairs[LEFT_REALS * k + 2] = goal_of(best)
                continue
        best[TOLERANCE] = max(0.5 * best[LEAST], tolerance)
        if pair[2] < goal_of(best) and best[MET] == 0.0:
            low = closed_pair(a, b, pair, best, minima, work, counts)
            pairs[LEFT_REALS * k + 2] = max(pair[2], low)
    best[TOLERANCE], best[OPEN], best[N_OPEN], best[MOST_OPEN] = tolerance, open_, n_open, listed


@kernel
def visit(a, b, key, best, minima, room, left, counts):
    """Look for nearer points in a pair of leaves, and list it; how many are listed."""
    pairs, most, _ = room
    low, free, _ = no_pair(a, b, farthest(best), best[ROUNDING], 0.0)
    if free > 0.0 or left_out(a, b, farthest(best), MOST_VISITED, best, counts):
        return left
    q, distance = nearest_of(a, b, counts)
    keep_found(a, b, q, distance, best, minima)
    low = max(max(key, low), 0.0)
    if low >= goal_of(best):
        if best[ABOVE] > 0.0:
            bound_minima(best, minima, a.leaf, b.leaf, low)
        return left
    if left >= most:
        leave_open(best, a.leaf, b.leaf, a.box, b.box, low)
        return left
    o = LEFT_REALS * left
    pairs[o], pairs[o + 1], pairs[o + 2], pairs[o + 3] = a.leaf, b.leaf, low, distance
    pairs[o + 4], pairs[o + 5], pairs[o + 6], pairs[o + 7] = q
    return left + 1
