"""A row of the front that is due: its bounds anew, or its parts in its place."""

from math import inf

from standoff.kernels.algebra.vectors import norm, sub
from standoff.kernels.compiler.decorators import kernel, shared
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.crossing_planes import planes_apart
from standoff.kernels.solids.front_rows import (
    FRAME,
    KEY_REALS,
    NO_WAY,
    ROW_A,
    ROW_AT,
    ROW_B,
    ROW_DISTANCE,
    ROW_FRAME,
    ROW_REALS,
    ROW_WAY,
    UNSEEN,
    add_row,
    bound_key,
    box_of_row,
    drop_row,
    is_due,
    keep_bound,
    keep_shut,
    open_up,
    put_row,
    start_of_row,
)
from standoff.kernels.solids.over_plane import clear_of_plane
from standoff.kernels.solids.spatial_boxes import gap_of, node_reach, shut_for
from standoff.kernels.solids.spatial_closing import (
    FEW_BOXES,
    MOST_BOXES,
    THERE,
    aimed,
    closed_again,
    closed_off_trim,
    closed_to,
    no_pair,
    split,
    widths,
)
from standoff.kernels.solids.spatial_minimum import nearest
from standoff.kernels.solids.spatial_pieces import OUTSIDE_TRIM, leaf_box, leaf_jet, trim_state
from standoff.kernels.solids.spatial_progress import (
    BISECTIONS,
    BUDGET,
    LEAF_PAIRS,
    LEAST,
    MET,
    NODE_PAIRS,
    NOWHERE,
    ROUNDING,
    SIZE,
    TOLERANCE,
    evaluations,
    farthest,
    goal_of,
    keep_found,
    leave_open,
    middle,
)
from standoff.kernels.solids.spatial_search import node_ints
from standoff.kernels.solids.spatial_tolerances import SHORTEST_PART

# Boxes that a pair with a plane is looked at with.
PLANE_BOXES = 1
NO_START, NO_BOXES = (0.0, 0.0, 0.0, 0.0), (NOWHERE, NOWHERE)
# Of a pair of leaves' parts bounds are wanted that last for so many times more motion.
LEAVES_AHEAD = 8.0
# Of a row that is proven to be no farther than is asked, another way is sought in one frame of so
# many.
RETRIED = 16
# What became of a row: it stays as it is, its parts are in its place, or it is gone.
KEPT, CUT, GONE_ROW = 0, 1, 2


@kernel
def look_at_nodes(a, b, front, k, travel, best, counts):
    """Bound a pair of nodes; one that may hold a nearest pair is cut, or becomes one of leaves."""
    o = ROW_REALS * k
    i, j = -1 - int(front.rows[o + ROW_A]), -1 - int(front.rows[o + ROW_B])
    counts[NODE_PAIRS] += 1
    gap = gap_of(a, i, b, j) - best[ROUNDING]
    keep_bound(front, k, gap, travel)
    if gap >= farthest(best) + travel.ahead:
        return KEPT
    shut = shut_for(a, i, b, j, inf if travel.sure else gap, travel.radius)
    if shut > travel.ahead:
        keep_shut(front, k, shut, travel)
        return KEPT
    key = bound_key(front, k)
    ra, rb = node_ints(a, i), node_ints(b, j)
    leaf_a, leaf_b = a.own[ra + 2], b.own[rb + 2]
    if leaf_a >= 0 and leaf_b >= 0:
        if shut > 0.0:
            keep_shut(front, k, shut, travel)
            return KEPT
        put_row(front, k, leaf_a, leaf_b, leaf_box(a, leaf_a), leaf_box(b, leaf_b), key)
        return CUT
    if leaf_b >= 0 or (leaf_a < 0 and node_reach(a, i) >= node_reach(b, j)):
        if not add_row(front, -1 - a.own[ra + 1], -1 - j, NO_BOXES, key, NO_START, False):
            return KEPT
        put_row(front, k, -1 - a.own[ra], -1 - j, NOWHERE, NOWHERE, key)
        return CUT
    if not add_row(front, -1 - i, -1 - b.own[rb + 1], NO_BOXES, key, NO_START, False):
        return KEPT
    put_row(front, k, -1 - i, -1 - b.own[rb], NOWHERE, NOWHERE, key)
    return CUT


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
def beside_plane(pa, pb, goal, travel, best, counts):
    """How much B may move before a plane's face and the other part may hold a nearest pair nearer
    than `goal`, length; -1: they may now."""
    for i in range(2):
        ahead = travel.ahead if i == 0 else 0.0
        # the goal grows with the motion as well
        spare = best[ROUNDING] + ahead
        if clear_of_plane(pa, pb, goal + ahead, spare, PLANE_BOXES, counts):
            return ahead
        spare = best[ROUNDING] + travel.afar * ahead
        if clear_of_plane(pb, pa, goal + ahead, spare, PLANE_BOXES, counts):
            return ahead
        if ahead == 0.0:
            break
    return -1.0


@kernel
def look_at_leaves(a, b, front, k, travel, best, minima, counts):
    """Bound a pair of leaves' parts, or cut it."""
    pa, pb = parts_of_row(a, b, front, k)
    counts[LEAF_PAIRS] += 1
    # what is as near as the nearest is to be gone through, not only bounded
    goal, o = tied(best) + best[ROUNDING], ROW_REALS * k
    if front.rows[o + ROW_WAY] == UNSEEN:
        if (
            trim_state(a, pa.leaf, pa.box) == OUTSIDE_TRIM
            or trim_state(b, pb.leaf, pb.box) == OUTSIDE_TRIM
        ):
            drop_row(front, k)
            return GONE_ROW
        front.rows[o + ROW_WAY] = NO_WAY
    low, free = no_pair(pa, pb, goal, best[ROUNDING], travel.turn)
    keep_bound(front, k, low, travel)
    if free == inf:
        return KEPT
    if free > 0.0:
        keep_shut(front, k, free, travel)
        return KEPT
    if front.rows[o + ROW_WAY] >= 0.0:
        low = close_as_before(front, k, pa, pb, travel, best, counts)
        if low > -inf:
            keep_bound(front, k, low - best[ROUNDING], travel)
            return KEPT
    free = -1.0
    if front.rows[o + ROW_WAY] < 0.0:
        free = beside_plane(pa, pb, goal, travel, best, counts)
    if free < 0.0 and not travel.sure and planes_apart(pa, pb, best[SIZE]):
        free = 0.0
    if free >= 0.0:
        keep_shut(front, k, free, travel)
        return KEPT
    q, distance = descend(a, b, front, k, best, minima, counts)
    if best[MET] > 0.0:
        return KEPT
    return close_row(front, k, (pa, pb, q, distance), travel, best, minima, counts)


@kernel
def lasting_goal(best):
    """What is proven of parts at the least distance: half of the tolerance more than is asked, so
    that it lasts while the solids are nearly at rest."""
    return goal_of(best) + 0.5 * best[TOLERANCE]


@kernel
def tied(best):
    """Pairs of points up to this distance are as near as the nearest, as far as is proven."""
    return best[LEAST] + best[TOLERANCE]


@kernel
def close_as_before(front, k, pa, pb, travel, best, counts):
    """A bound beyond what is tied, by the way that closed a row last, through the points where
    Newton's method came to last, which need not be the nearest now; -inf: none."""
    way = int(front.rows[ROW_REALS * k + ROW_WAY])
    q = start_of_row(front, k)
    x = leaf_jet(pa.side, pa.leaf, q[0], q[1])[0]
    y = leaf_jet(pb.side, pb.leaf, q[2], q[3])[0]
    distance = norm(sub(y, x))
    aim = aimed(goal_of(best), distance, LEAVES_AHEAD * travel.ahead)
    if way >= THERE or aim <= tied(best) + best[ROUNDING]:
        return -inf
    return aim if closed_again(way, aim, (pa, pb, q, distance), best, counts) else -inf


@kernel
def close_again(front, k, pair, aim, best, counts):
    """A bound by the way that closed a row last, of parts whose nearest points are known: `aim`, or
    the least that lasts; -inf: none."""
    way, goal = int(front.rows[ROW_REALS * k + ROW_WAY]), lasting_goal(best)
    if way < 0:
        return -inf
    if aim > tied(best):
        if closed_again(way, aim, pair, best, counts):
            return aim
        if int(front.store[FRAME]) % RETRIED == 0:  # another way may prove more
            return -inf
    return goal if closed_again(way, goal, pair, best, counts) else -inf


@kernel
def close_row(front, k, pair, travel, best, minima, counts):
    """Prove of two parts that they are as far apart as the nearest points, and more where they are;
    what no potential proves is cut."""
    pa, pb, _, distance = pair
    goal, ahead = lasting_goal(best), LEAVES_AHEAD * travel.ahead
    aim = aimed(goal, distance, ahead)
    low = close_again(front, k, pair, aim, best, counts)
    if low < goal:
        way = -1
        if aim > tied(best):
            way = closed_to(aim, -1, pair, FEW_BOXES, best, minima, counts)
        if way < 0:
            aim = goal
            way = closed_to(goal, -1, pair, FEW_BOXES, best, minima, counts)
        if way < 0 and distance >= goal:
            way = closed_to(goal, -1, pair, MOST_BOXES, best, minima, counts)
        front.rows[ROW_REALS * k + ROW_WAY] = way
        low = aim if way >= 0 else -inf
    if low < goal and distance < goal:
        low = closed_off_trim(goal, ahead, pa, pb, best, counts)
    if low >= goal:
        keep_bound(front, k, low - best[ROUNDING], travel)
        return KEPT
    counts[BISECTIONS] += 1
    return CUT if cut_row(front, k, pair, best) else KEPT


@kernel
def cut_row(front, k, pair, best):
    """Cut the longer part in two; False: it is too short, or there is no room."""
    pa, pb, q, _ = pair
    key = bound_key(front, k)
    au, av = widths(pa.side, pa.leaf, pa.box)
    bu, bv = widths(pb.side, pb.leaf, pb.box)
    if max(max(au, av), max(bu, bv)) <= SHORTEST_PART * best[SIZE]:
        return False
    if max(au, av) >= max(bu, bv):
        first, second = split(pa.box, au >= av)
        if not add_row(front, pa.leaf, pb.leaf, (second, pb.box), key, q, True):
            return False
        put_row(front, k, pa.leaf, pb.leaf, first, pb.box, key)
        return True
    first, second = split(pb.box, bu >= bv)
    if not add_row(front, pa.leaf, pb.leaf, (pa.box, second), key, q, True):
        return False
    put_row(front, k, pa.leaf, pb.leaf, pa.box, first, key)
    return True


@kernel
def asked_of(front, k, best):
    """The bound that is to be proven of a row; of nodes more, so that no tie is among them."""
    if front.rows[ROW_REALS * k + ROW_A] < 0.0:
        return tied(best)
    return goal_of(best) - best[ROUNDING]


@kernel
def settle_row(a, b, front, k, travel, best, minima, counts):
    """Look at a row until it is no longer due, cutting it; whether it is gone. What stays open
    lowers best[OPEN]."""
    told = CUT
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
    return told == GONE_ROW


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
