"""A row of the front that is due: its bounds anew, or its parts in its place."""

from math import inf

from standoff.kernels.algebra.vectors import norm, scale, sub
from standoff.kernels.compiler.decorators import kernel, shared
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.crossing_planes import planes_apart
from standoff.kernels.solids.front_close import close_as_before, close_row, reach_of_part, tied
from standoff.kernels.solids.front_motion import (
    carry_row,
    mark_bound,
    mark_place,
    mark_shut,
)
from standoff.kernels.solids.front_rows import (
    CUT,
    FRAME,
    GONE_ROW,
    KEPT,
    KEY_REALS,
    NO_WAY,
    OPEN_ROW,
    ROW_A,
    ROW_AT,
    ROW_B,
    ROW_DISTANCE,
    ROW_FRAME,
    ROW_FREE,
    ROW_REALS,
    ROW_WAY,
    UNSEEN,
    add_row,
    bound_key,
    box_of_row,
    empty_row,
    is_due,
    keep_bound,
    keep_shut,
    open_up,
    put_part,
    share_proven,
    start_of_row,
)
from standoff.kernels.solids.over_plane import beside_by, feet_of, has_sides, not_over, plane_of
from standoff.kernels.solids.spatial_boxes import gap_along, node_centre, node_reach, shut_for
from standoff.kernels.solids.spatial_closing import (
    no_pair,
)
from standoff.kernels.solids.spatial_minimum import nearest
from standoff.kernels.solids.spatial_pieces import (
    OUTSIDE_TRIM,
    ZERO,
    leaf_box,
    trim_state,
)
from standoff.kernels.solids.spatial_progress import (
    BOXES,
    BUDGET,
    LEAF_PAIRS,
    MET,
    NODE_PAIRS,
    NOWHERE,
    ROUNDING,
    SIZE,
    evaluations,
    farthest,
    goal_of,
    keep_found,
    leave_open,
    middle,
)
from standoff.kernels.solids.spatial_search import node_ints

NO_START, NO_BOXES = (0.0, 0.0, 0.0, 0.0), (NOWHERE, NOWHERE)


@kernel
def look_at_nodes(a, b, front, k, travel, best, counts):
    """Bound a pair of nodes; one that may hold a nearest pair is cut, or becomes one of leaves."""
    o = ROW_REALS * k
    i, j = -1 - int(front.rows[o + ROW_A]), -1 - int(front.rows[o + ROW_B])
    counts[NODE_PAIRS] += 1
    gap, n = gap_along(a, i, b, j)
    gap -= best[ROUNDING]
    keep_bound(front, k, gap, travel)
    mark_place(front, k, node_centre(b, j), node_reach(b, j), 0.0, travel)
    mark_bound(front, k, gap, n, 0.0, inf)
    if gap >= farthest(best) + travel.ahead:
        return KEPT
    shut = shut_for(a, i, b, j, inf if travel.sure else gap, travel.radius)
    mark_shut(front, k, shut, inf)
    if shut > travel.ahead:
        keep_shut(front, k, shut, travel)
        return KEPT
    if shut > 0.0 and is_pair_of_leaves(a, i, b, j):
        keep_shut(front, k, shut, travel)
        return KEPT
    return CUT if cut_nodes(a, b, front, k) else KEPT


@kernel
def is_pair_of_leaves(a, i, b, j):
    return a.own[node_ints(a, i) + 2] >= 0 and b.own[node_ints(b, j) + 2] >= 0


@kernel
def cut_nodes(a, b, front, k):
    """Put the parts of a pair of nodes in its place, or the leaves; False: there is no room."""
    o, key = ROW_REALS * k, bound_key(front, k)
    i, j = -1 - int(front.rows[o + ROW_A]), -1 - int(front.rows[o + ROW_B])
    ra, rb = node_ints(a, i), node_ints(b, j)
    leaf_a, leaf_b = a.own[ra + 2], b.own[rb + 2]
    if leaf_a >= 0 and leaf_b >= 0:
        put_part(front, k, leaf_a, leaf_b, (leaf_box(a, leaf_a), leaf_box(b, leaf_b)))
        return True
    if leaf_b >= 0 or (leaf_a < 0 and node_reach(a, i) >= node_reach(b, j)):
        if not add_row(front, -1 - a.own[ra + 1], -1 - j, NO_BOXES, key, NO_START, False):
            return False
        put_part(front, k, -1 - a.own[ra], -1 - j, NO_BOXES)
    else:
        if not add_row(front, -1 - i, -1 - b.own[rb + 1], NO_BOXES, key, NO_START, False):
            return False
        put_part(front, k, -1 - i, -1 - b.own[rb], NO_BOXES)
    share_proven(front, k)
    return True


@kernel
def parts_of_row(a, b, front, k):
    o = ROW_REALS * k
    leaf_a, leaf_b = int(front.rows[o + ROW_A]), int(front.rows[o + ROW_B])
    pa = S.Part(a, leaf_a, box_of_row(front, k, 0))
    return pa, S.Part(b, leaf_b, box_of_row(front, k, 1))


@kernel
def middles(box_a, box_b):
    u, v = middle(box_a)
    s, t = middle(box_b)
    return (u, v, s, t)


@shared
def descend(a, b, front, k, best, minima, counts):
    """Newton's method in a row, once a frame, from where it came to last."""
    pa, pb = parts_of_row(a, b, front, k)
    o, r = ROW_REALS * k, front.rows
    if r[o + ROW_FRAME] != front.store[FRAME]:
        start = start_of_row(front, k)
        if r[o + ROW_DISTANCE] == inf:
            start = middles(pa.box, pb.box)
        q, distance = nearest(a, pa.leaf, pa.box, b, pb.leaf, pb.box, start, counts)
        for i in range(4):
            r[o + ROW_AT + i] = q[i]
        r[o + ROW_DISTANCE], r[o + ROW_FRAME] = distance, front.store[FRAME]
        keep_found(pa, pb, q, distance, best, minima)
    return start_of_row(front, k), r[o + ROW_DISTANCE]


@kernel
def beside_plane(face, part, share, goal, travel, best, counts):
    """(length that B may move in all before a plane's face and the other part may hold a nearest
    pair nearer than `goal`, the same of the row's own motion); -1: they may now. By a motion of B's
    the part, as the plane sees it, moves by `share` as much, at most."""
    if not has_sides(face, part):
        return -1.0, -1.0
    counts[BOXES] += 1
    jet, n = plane_of(face)
    feet, rounding = feet_of(jet, n, part), best[ROUNDING]
    own = beside_by(face, feet, goal, rounding, 1.0)
    if own > travel.ahead:
        return max(beside_by(face, feet, goal, rounding, share), 0.0), own
    # what the trims leave free is not told
    ahead = travel.ahead
    if not_over(face, feet, goal + ahead, rounding + share * ahead):
        return ahead, ahead
    if own >= 0.0:
        return 0.0, own
    return (0.0, 0.0) if not_over(face, feet, goal, rounding) else (-1.0, -1.0)


@kernel
def bound_leaves(a, b, front, k, goal, travel, best, counts):
    """(what became of a pair of leaves' parts, ball round B's part) by bounds alone: it is gone, it
    rests as it holds no nearest pair nearer than `goal`, or neither is known (`OPEN_ROW`)."""
    pa, pb = parts_of_row(a, b, front, k)
    counts[LEAF_PAIRS] += 1
    counts[BOXES] += 2  # their middles
    o = ROW_REALS * k
    if front.rows[o + ROW_WAY] == UNSEEN:
        if (
            trim_state(a, pa.leaf, pa.box) == OUTSIDE_TRIM
            or trim_state(b, pb.leaf, pb.box) == OUTSIDE_TRIM
        ):
            empty_row(front, k)
            return GONE_ROW, (ZERO, 0.0)
        front.rows[o + ROW_WAY] = NO_WAY
    low, free, middles = no_pair(pa, pb, goal, best[ROUNDING], travel.turn)
    ball = middles[1], reach_of_part(pb)
    # a greater bound that was proven before is kept, with the slope it was proven along
    weaker = free <= 0.0 and low + travel.gone < bound_key(front, k)
    keep_bound(front, k, low, travel)
    if weaker:
        front.rows[o + ROW_FREE] = -inf
    else:
        mark_middles(front, k, pa, middles, ball, low, travel)
    if free == inf:
        return KEPT, ball
    if free > 0.0:
        keep_shut(front, k, free, travel)
        mark_shut(front, k, free, inf)
        return KEPT, ball
    free = -1.0
    if front.rows[o + ROW_WAY] < 0.0:
        free, own = beside_plane(pa, pb, 1.0, goal, travel, best, counts)
        if own <= 0.0:
            free, own = beside_plane(pb, pa, travel.afar, goal, travel, best, counts)
        if own > 0.0:
            mark_middles(front, k, pa, middles, ball, low, travel)
            mark_shut(front, k, own, goal + own)
    if free < 0.0 and not travel.sure and planes_apart(pa, pb, best[SIZE]):
        free = 0.0
    if free < 0.0:
        return OPEN_ROW, ball
    keep_shut(front, k, free, travel)
    return KEPT, ball


@kernel
def mark_middles(front, k, part, middles, ball, low, travel):
    """Write down where the parts of a row are, A's and the ball round B's, and their bound along
    the line between their middle points."""
    away = sub(middles[1], middles[0])
    length = norm(away)
    mark_place(front, k, middles[1], ball[1], length + reach_of_part(part), travel)
    if low > 0.0:
        mark_bound(front, k, low, scale(1.0 / length, away), 0.0, inf)


@kernel
def look_at_leaves(a, b, front, k, travel, best, minima, counts):
    """Bound a pair of leaves' parts, or cut it."""
    # what is as near as the nearest is to be gone through, not only bounded
    goal = max(tied(best), travel.above) + best[ROUNDING]
    told, ball = bound_leaves(a, b, front, k, goal, travel, best, counts)
    if told != OPEN_ROW:
        return told
    pa, pb = parts_of_row(a, b, front, k)
    before = front.rows[ROW_REALS * k + ROW_WAY] >= 0.0
    if before and close_as_before(front, k, (pa, pb), ball, travel, best, counts):
        return KEPT
    q, distance = descend(a, b, front, k, best, minima, counts)
    if best[MET] > 0.0 or evaluations(counts) > best[BUDGET]:
        return KEPT
    return close_row(front, k, (pa, pb, q, distance), ball, travel, best, minima, counts)


@kernel
def asked_of(front, k, best):
    """The bound that is to be proven of a row; of nodes more, so that no tie is among them."""
    if front.rows[ROW_REALS * k + ROW_A] < 0.0:
        return tied(best)
    return goal_of(best) - best[ROUNDING]


@kernel
def settle_row(a, b, front, k, travel, best, minima, counts):
    """Look at a row until it is no longer due, cutting it; whether there was time. What stays open
    lowers best[OPEN]."""
    told = CUT
    if is_due(front, k, asked_of(front, k, best), travel):
        carry_row(front, k, max(tied(best), travel.above) + best[ROUNDING], travel)
    while told == CUT and best[MET] == 0.0 and is_due(front, k, asked_of(front, k, best), travel):
        if evaluations(counts) > best[BUDGET]:
            tell_open(front, k, travel, best)
            return False
        open_up(front, k)
        if front.rows[ROW_REALS * k + ROW_A] < 0.0:
            told = look_at_nodes(a, b, front, k, travel, best, counts)
        else:
            told = look_at_leaves(a, b, front, k, travel, best, minima, counts)
        if told == KEPT and is_open(front, k, asked_of(front, k, best), travel):
            tell_open(front, k, travel, best)
            return evaluations(counts) <= best[BUDGET]
    return True


@kernel
def tell_open(front, k, travel, best):
    o = ROW_REALS * k
    first, other = int(front.rows[o + ROW_A]), int(front.rows[o + ROW_B])
    bound = max(front.keys[KEY_REALS * k] - travel.gone, 0.0)
    leave_open(best, first, other, box_of_row(front, k, 0), box_of_row(front, k, 1), bound)


@kernel
def is_open(front, k, goal, travel):
    """After a look: what is shut in this frame alone is not open."""
    bound, shut = front.keys[KEY_REALS * k], front.keys[KEY_REALS * k + 1]
    return bound < goal + travel.gone and shut < travel.gone
