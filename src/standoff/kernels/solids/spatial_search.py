"""The least distance of two solids' boundaries: best first over their trees, then each pair of
leaves that is left is closed."""

from math import inf

from standoff.kernels.algebra.vectors import norm
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_boxes import admits, gap_of, node_reach, push, take
from standoff.kernels.solids.spatial_closing import (
    BUDGET,
    LEAST,
    MET,
    N_MINIMA,
    OPEN,
    ROUNDING,
    TOLERANCE,
    close_leaves,
    keep,
    no_pair,
)
from standoff.kernels.solids.spatial_minimum import nearest
from standoff.kernels.solids.spatial_pieces import leaf_box, on_solid


@kernel
def node_ints(side, node):
    return side.own[S.NODES] + S.NODE_INTS * node


@kernel
def offer(a, i, b, j, best, heap, count, limit, counts):
    """Put a pair of nodes into the heap unless it cannot hold a nearest pair."""
    keys, firsts, others = heap
    counts[2] += 1
    gap = gap_of(a, i, b, j) - best[ROUNDING]
    if gap > best[LEAST] + best[TOLERANCE] or not admits(a, i, b, j, gap):
        return count
    if count >= limit:
        best[OPEN] = min(best[OPEN], max(gap, 0.0))
        return count
    return push(keys, firsts, others, count, gap, i, j)


@kernel
def search(a, b, best, minima, heap, limit, pairs, most_pairs, work, counts):
    """Fill `best` and `minima`; best[OPEN] is then a proven lower bound of what was not closed."""
    keys, firsts, others = heap
    count = offer(a, 0, b, 0, best, heap, 0, limit, counts)
    left = 0
    while count > 0:
        key, i, j, count = take(keys, firsts, others, count)
        if key > best[LEAST] + best[TOLERANCE]:
            break
        if best[LEAST] <= best[TOLERANCE]:
            best[MET] = 1.0
            break
        ra, rb = node_ints(a, i), node_ints(b, j)
        leaf_a, leaf_b = a.own[ra + 2], b.own[rb + 2]
        if leaf_a >= 0 and leaf_b >= 0:
            left = visit(a, leaf_a, b, leaf_b, key, best, minima, pairs, left, most_pairs, counts)
            continue
        if leaf_b >= 0 or (leaf_a < 0 and node_reach(a, i) >= node_reach(b, j)):
            count = offer(a, a.own[ra], b, j, best, heap, count, limit, counts)
            count = offer(a, a.own[ra + 1], b, j, best, heap, count, limit, counts)
        else:
            count = offer(a, i, b, b.own[rb], best, heap, count, limit, counts)
            count = offer(a, i, b, b.own[rb + 1], best, heap, count, limit, counts)
    for k in range(left):
        goal = best[LEAST] - best[TOLERANCE] + best[ROUNDING]
        if pairs[3 * k + 2] < goal and best[MET] == 0.0:
            counts[3] += 1
            close_leaves(a, int(pairs[3 * k]), b, int(pairs[3 * k + 1]), best, minima, work, counts)


@kernel
def visit(a, leaf_a, b, leaf_b, key, best, minima, pairs, left, most, counts):
    """Look for nearer points in a pair of leaves, and list it."""
    box_a, box_b = leaf_box(a, leaf_a), leaf_box(b, leaf_b)
    goal = best[LEAST] - best[TOLERANCE] + best[ROUNDING]
    done, low = no_pair(
        a, leaf_a, box_a, b, leaf_b, box_b, best[LEAST] + best[TOLERANCE], best[ROUNDING]
    )
    if done:
        return left
    start = (
        0.5 * (box_a.u0 + box_a.u1),
        0.5 * (box_a.v0 + box_a.v1),
        0.5 * (box_b.u0 + box_b.u1),
        0.5 * (box_b.v0 + box_b.v1),
    )
    q, distance = nearest(a, leaf_a, box_a, b, leaf_b, box_b, start, counts)
    if distance <= best[LEAST] + best[TOLERANCE] and (
        on_solid(a, leaf_a, q[0], q[1]) and on_solid(b, leaf_b, q[2], q[3])
    ):
        keep(best, minima, leaf_a, leaf_b, q, distance)
    if max(key, low) >= goal:
        return left
    if left >= most:
        best[OPEN] = min(best[OPEN], max(max(key, low), 0.0))
        return left
    pairs[3 * left], pairs[3 * left + 1], pairs[3 * left + 2] = leaf_a, leaf_b, max(key, low)
    return left + 1
