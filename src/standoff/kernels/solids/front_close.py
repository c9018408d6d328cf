"""Closing a row of the front by a potential: as before, or by another one; or cutting it."""

from math import inf

from standoff.kernels.algebra.vectors import norm, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.coaxial import NO_POTENTIAL
from standoff.kernels.solids.front_motion import (
    mark_bound,
    mark_place,
    slope_of,
)
from standoff.kernels.solids.front_rows import (
    CUT,
    FRAME,
    HURRIED,
    KEPT,
    LATE,
    ROW_DISTANCE,
    ROW_FRAME,
    ROW_REALS,
    ROW_WAY,
    keep_bound,
    put_parts,
    start_of_row,
)
from standoff.kernels.solids.spatial_closing import (
    FEW_BOXES,
    HERE,
    MOST_BOXES,
    OWN_A,
    OWN_B,
    THERE,
    aimed,
    by_own_surface,
    by_witness,
    closed_off_trim,
    closed_to,
    own_toward,
    split,
    widths,
)
from standoff.kernels.solids.spatial_minimum import nearest
from standoff.kernels.solids.spatial_pieces import (
    leaf_ints,
    leaf_jet,
    reach_of,
)
from standoff.kernels.solids.spatial_progress import (
    AT,
    BISECTIONS,
    BOXES,
    LEAF_A,
    LEAF_B,
    LEAST,
    ROUNDING,
    SIZE,
    STOP,
    TOLERANCE,
    evaluations,
    goal_of,
    is_stopped,
)
from standoff.kernels.solids.spatial_tolerances import SHORTEST_PART

# Boxes of a potential that did before: of points that were found just now, for more than is asked
# and for what is, as to try all others takes more; and where others can be.
AGAIN_BOXES, SLOW_BOXES, ONCE_BOXES = 8, 100, 2
# Of a pair of leaves' parts bounds are wanted that last for so many times more motion.
LEAVES_AHEAD = 8.0
# A pair of parts at the least distance that takes more boxes than this in each frame is cut, if one
# half is farther apart, and while it is longer than so many times what B moves.
MANY_BOXES, WIDE = 8, 4.0
# The same, of parts that trimming curves may cut, with the parts of those.
MANY_ON_TRIMS = 40
# Of how far parts are apart: what is proven first where time is short.
SOME = 0.5
# Of a row that is proven to be no farther than is asked, another way is sought in one frame of so
# many.
RETRIED = 16


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
def reach_of_part(part):
    """From its middle point, at most, length."""
    box = part.box
    return reach_of(part.side, part.leaf, 0.5 * (box.u1 - box.u0), 0.5 * (box.v1 - box.v0))


@kernel
def keep_proven(front, k, low, way, phi, ball, travel, best):
    """Keep the bound that a potential proved of a row, by `way` of `closed_to`, with its slope in
    the ball (centre, radius) round B's part."""
    low -= best[ROUNDING]
    keep_bound(front, k, low, travel)
    mark_place(front, k, ball[0], ball[1], 0.0, travel)
    room = LEAVES_AHEAD * travel.ahead
    sign = -1.0 if way == OWN_B else 1.0
    slope, bend, room = slope_of(phi, sign, ball[0], ball[1], room)
    mark_bound(front, k, low, slope, bend, room)


@kernel
def closed_again(way, goal, pair, limit, best, counts):
    """(whether the way that `closed_to` told of a pair at another time proves a goal of it,
    potential)."""
    a, b, q, _ = pair
    if way == OWN_A:
        closed = by_own_surface(goal, a, b, (q[2], q[3]), limit, counts)
        return closed, own_toward(a, b, (q[2], q[3]))[1]
    if way == OWN_B:
        closed = by_own_surface(goal, b, a, (q[0], q[1]), limit, counts)
        return closed, own_toward(b, a, (q[0], q[1]))[1]
    if way < THERE:
        at, one = (a.leaf, b.leaf, q), way - HERE
    else:
        q = (best[AT], best[AT + 1], best[AT + 2], best[AT + 3])
        at, one = (int(best[LEAF_A]), int(best[LEAF_B]), q), way - THERE
    told, phi = by_witness(goal, a, b, at, (one, one), limit, best, counts)
    return told >= 0, phi


@kernel
def close_as_before(front, k, parts, ball, travel, best, counts):
    """Is a row closed by the way that closed it last, through the points where Newton's method came
    to last, which need not be the nearest now? Beyond what is tied; or, if those points were off
    a trim, by the potential of the nearest ones."""
    pa, pb = parts
    o, r = ROW_REALS * k, front.rows
    way, goal = int(r[o + ROW_WAY]), lasting_goal(best)
    if way >= THERE and r[o + ROW_DISTANCE] >= goal:
        return False
    q = start_of_row(front, k)
    distance = r[o + ROW_DISTANCE]
    if way < THERE:
        x = leaf_jet(pa.side, pa.leaf, q[0], q[1])[0]
        y = leaf_jet(pb.side, pb.leaf, q[2], q[3])[0]
        distance = norm(sub(y, x))
        goal = aimed(goal_of(best), distance, LEAVES_AHEAD * travel.ahead)
        # from where they were last, nearest points are farther apart than they need be
        if goal <= tied(best) + best[ROUNDING] + 0.25 * travel.ahead:
            return False
    closed, phi = closed_again(way, goal, (pa, pb, q, distance), ONCE_BOXES, best, counts)
    if closed:
        keep_proven(front, k, goal, way, phi, ball, travel, best)
        if way >= THERE:
            # what ties with the nearest is on the trim, which is an edge of its own
            r[o + ROW_FRAME] = front.store[FRAME]
    return closed


@kernel
def close_again(front, k, pair, aim, best, counts):
    """(bound, way, potential) by the way that closed a row last, of parts whose nearest points are
    known: `aim`, or the least that lasts; -inf: none."""
    way, goal = int(front.rows[ROW_REALS * k + ROW_WAY]), lasting_goal(best)
    if way < 0:
        return -inf, way, NO_POTENTIAL
    if aim > tied(best):
        closed, phi = closed_again(way, aim, pair, AGAIN_BOXES, best, counts)
        if closed:
            return aim, way, phi
        if int(front.store[FRAME]) % RETRIED == 0:  # another way may prove more
            return -inf, way, phi
    closed, phi = closed_again(way, goal, pair, SLOW_BOXES, best, counts)
    return goal if closed else -inf, way, phi


@kernel
def is_wide(pair, travel):
    """Is a part much longer than B moves in a frame?"""
    pa, pb, _, _ = pair
    au, av = widths(pa.side, pa.leaf, pa.box)
    bu, bv = widths(pb.side, pb.leaf, pb.box)
    return max(max(au, av), max(bu, bv)) > WIDE * travel.ahead


@kernel
def many_boxes(pair):
    """Of a potential over two parts, some along trimming curves."""
    pa, pb, _, _ = pair
    cut = pa.side.own[leaf_ints(pa.side, pa.leaf) + S.CUT]
    cut += pb.side.own[leaf_ints(pb.side, pb.leaf) + S.CUT]
    return MANY_BOXES if cut == 0 else MANY_ON_TRIMS


@kernel
def close_row(front, k, pair, ball, travel, best, minima, counts):
    """Prove of two parts that they are as far apart as the nearest points, and more where they are;
    what no potential proves is cut."""
    pa, pb, _, distance = pair
    goal, ahead, boxes = lasting_goal(best), LEAVES_AHEAD * travel.ahead, counts[BOXES]
    begun = evaluations(counts)
    aim = aimed(goal, distance, ahead)
    low, way, phi = close_again(front, k, pair, aim, best, counts)
    if low < goal and front.store[LATE] == HURRIED:
        if is_stopped(best, counts):
            return KEPT
        # first of all such rows so much that the solids are known not to come together there
        some = min(SOME * distance, goal)
        way, phi = closed_to(some, -1, pair, FEW_BOXES, best, minima, counts)
        if way >= 0:
            keep_proven(front, k, some, way, phi, ball, travel, best)
            return KEPT
    if low < goal:
        way = -1
        if aim > tied(best):
            way, phi = closed_to(aim, -1, pair, FEW_BOXES, best, minima, counts)
        if way < 0:
            aim = goal
            way, phi = closed_to(goal, -1, pair, FEW_BOXES, best, minima, counts)
        if way < 0 and distance >= goal and not is_stopped(best, counts):
            way, phi = closed_to(goal, -1, pair, MOST_BOXES, best, minima, counts)
        front.rows[ROW_REALS * k + ROW_WAY] = way
        low = aim if way >= 0 else -inf
    if low < goal and distance < goal and not is_stopped(best, counts):
        low, phi = closed_off_trim(goal, ahead, pa, pb, best, counts)
    if low >= goal:
        keep_proven(front, k, low, way, phi, ball, travel, best)
        many = counts[BOXES] - boxes > many_boxes(pair)
        if many and distance < goal + ahead and pays_to_cut(pair, goal, travel, counts):
            cut_row(front, k, pair, best)
        return KEPT
    # what needs more than half of a frame's time is cut, all else is looked at in the next frame
    if is_stopped(best, counts) and begun > 0.5 * best[STOP]:
        return KEPT
    counts[BISECTIONS] += 1
    return CUT if cut_row(front, k, pair, best) else KEPT


@kernel
def cut_row(front, k, pair, best):
    """Cut the longer part in two; False: it is too short, or there is no room."""
    pa, pb, q, _ = pair
    parts, longest = halves_of(pa, pb)
    if longest <= SHORTEST_PART * best[SIZE]:
        return False
    return put_parts(front, k, (pa.leaf, pb.leaf), parts, q)


@kernel
def halves_of(pa, pb):
    """(boxes of A and B of both halves, with the longer of two parts cut, its length)."""
    au, av = widths(pa.side, pa.leaf, pa.box)
    bu, bv = widths(pb.side, pb.leaf, pb.box)
    if max(au, av) >= max(bu, bv):
        first, second = split(pa.box, au >= av)
        return ((first, pb.box), (second, pb.box)), max(au, av)
    first, second = split(pb.box, bu >= bv)
    return ((pa.box, first), (pa.box, second)), max(bu, bv)


@kernel
def holds(box, u, v):
    return box.u0 <= u <= box.u1 and box.v0 <= v <= box.v1


@kernel
def pays_to_cut(pair, goal, travel, counts):
    """Would one half of a part that is wide rest for some frames? Of a valley that goes on through
    both halves each would take as many boxes as the whole."""
    if not is_wide(pair, travel):
        return False
    pa, pb, q, _ = pair
    first, second = halves_of(pa, pb)[0]
    here = holds(first[0], q[0], q[1]) and holds(first[1], q[2], q[3])
    box_a, box_b = second if here else first
    distance = nearest(pa.side, pa.leaf, box_a, pb.side, pb.leaf, box_b, q, counts)[1]
    return distance >= goal + travel.ahead


@kernel
def cut_of_b(front, k, pa, pb, q):
    """Cut B's part of a row in two; False: there is no room."""
    bu, bv = widths(pb.side, pb.leaf, pb.box)
    first, second = split(pb.box, bu >= bv)
    parts = (pa.box, first), (pa.box, second)
    return put_parts(front, k, (pa.leaf, pb.leaf), parts, q)
