"""Closing a pair of leaves: no two of their points on the solids are nearer than a bound."""

from math import inf

from standoff.kernels.algebra.vectors import dot, norm, scale, sub
from standoff.kernels.compiler.decorators import kernel, shared, small
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.coaxial import (
    NO_POTENTIAL,
    coaxial_between,
    common_axis,
    in_meridian,
    is_flat,
    own_straight,
    straight_about,
    turn_alike,
    turns_along,
)
from standoff.kernels.solids.crossing_planes import planes_apart
from standoff.kernels.solids.over_plane import clear_of_plane
from standoff.kernels.solids.screw import common_screw, own_screw, screw_between
from standoff.kernels.solids.spatial_bounds import proven
from standoff.kernels.solids.spatial_minimum import (
    across,
    direction,
    nearest,
    plane_between,
    shape,
    torus_between,
)
from standoff.kernels.solids.spatial_pieces import (
    OUTSIDE_TRIM,
    along,
    leaf_box,
    leaf_ints,
    leaf_jet,
    leaf_reals,
    natural,
    reach_of,
    trim_state,
)
from standoff.kernels.solids.spatial_progress import (
    ABOVE,
    AT,
    BEYOND,
    BISECTIONS,
    BUDGET,
    LEAF_A,
    LEAF_B,
    LEAST,
    MET,
    MINIMUM_REALS,
    OF_LEAVES,
    ROUNDING,
    SIZE,
    TOLERANCE,
    evaluations,
    goal_of,
    is_stopped,
    keep_found,
    leave_open,
    local_goal,
    middle,
)
from standoff.kernels.solids.spatial_tolerances import (
    LEAST_SPAN,
    SHORTEST_PART,
    SMOOTH_SPARE,
    SURE_NORMAL,
)
from standoff.kernels.solids.torus_potential import (
    TORUS_THROUGH,
    Potential,
    potential_jet,
)
from standoff.kernels.solids.trim_witness import nearest_on_trim

# Pairs of boxes that wait, of 9 numbers each.
PAIR_REALS = 9
MOST_PAIRS = 200
# Boxes that a potential is bounded over, of one piece: few at first, for another may do.
FEW_BOXES, MOST_BOXES = 20, 400
# Cuts of a pair of leaves after which it counts as hard.
EASY_CUTS = 16
# Boxes that a whole leaf is looked at with over a plane.
MOST_CLOSING = 100
# The same, of a potential that does for whole pieces of a thread, and of a flat end in its bore.
SCREW_BOXES, AXIS_BOXES = 800, 150
# Potentials through a pair of points, from the first to the last; and the ways of `closed_to`.
SCREWED = 7
ALL_WAYS = (0, SCREWED)
OWN_A, OWN_B, HERE, THERE = 0, 1, 2, 10
# Of how much farther parts are apart than is asked: what of it is tried to be proven too.
SHARE_AHEAD = 0.8
# Shares of 1 / span: the least difference of curvature to both sides that is sought.
MARGINS = (1.0, 0.3, 3.0)


@kernel
def held_along(part, jet, toward, u, v):
    """Second derivatives that a slope across the side of a box is worth there."""
    box = part.box
    slope_u, slope_v = dot(toward, jet[1]), dot(toward, jet[2])
    wide_u, wide_v = box.u1 - box.u0, box.v1 - box.v0
    mu = 2.0 * abs(slope_u) / wide_u if wide_u > 0.0 and (u <= box.u0 or u >= box.u1) else 0.0
    mv = 2.0 * abs(slope_v) / wide_v if wide_v > 0.0 and (v <= box.v0 or v >= box.v1) else 0.0
    return mu, mv


@kernel
def own_toward(a, b, q):
    """(known, potential) of A's own kind; of a face that is seen from both sides the one that grows
    to where B's place is."""
    known, phi = natural(a.side, a.leaf)
    if not known or a.side.sense != S.EITHER:
        return known, phi
    if potential_jet(phi, leaf_jet(b.side, b.leaf, q[0], q[1])[0], 0.0)[0] >= 0.0:
        return known, phi
    n, sign = phi.n, -phi.sign
    if phi.kind == TORUS_THROUGH:
        n, sign = scale(-1.0, phi.n), 1.0
    return known, Potential(phi.kind, phi.o, phi.e1, phi.e2, n, phi.k1, phi.k2, sign)


@shared
def by_own_surface(goal, a, b, q, limit, counts):
    """Does the potential of A's own kind prove that B's part is `goal` from all of A's surface?"""
    known, phi = own_toward(a, b, q)
    return known and proven(phi, -1.0, -goal, b, q, limit, counts)


@kernel
def dim_of(side, leaf):
    return side.own[leaf_ints(side, leaf) + S.DIM]


@kernel
def ends_sharply(part):
    """Does a part end at a rim, as an edge or a flat face does, so that a potential about its axis
    may have any curvature across the rim?"""
    return dim_of(part.side, part.leaf) == 1 or is_flat(part.side, part.leaf)


@shared
def by_witness(goal, a, b, at, ways, limit, best, counts):
    """(way, potential): which potential through a pair of points (leaves and parameters `at`)
    proves it: a plane (0), one of three margins about a common axis (1, 3, 5) or a torus (2, 4, 6),
    or along a screw (7, which is tried first); -1: none. Of `ways` all from the first to the last
    are tried."""
    wa, wb, q = at
    ja, jb = leaf_jet(a.side, wa, q[0], q[1]), leaf_jet(b.side, wb, q[2], q[3])
    size = best[SIZE]
    n = direction(a.side, wa, ja, b.side, wb, jb, SURE_NORMAL * size)
    if norm(n) < 0.5:
        return -1, NO_POTENTIAL
    x, y = ja[0], jb[0]
    here = wa == a.leaf and wb == b.leaf
    place = (here, q, x, y, limit)
    first, last = ways
    # of more boxes it would have as many
    tried = last == SCREWED and limit < MOST_BOXES
    screw = common_screw(a, b, (wa, wb), (ja, jb))
    closed, phi = by_screw(goal, a, b, n, (here, q, x, y, SCREW_BOXES), (tried, screw), counts)
    if closed:
        return SCREWED, phi
    phi = plane_between(x, y, n)
    if first == 0 and by_one(phi, goal, a, b, place, counts):
        return 0, phi
    if last == 0:
        return -1, NO_POTENTIAL
    span = reach_of(a.side, a.leaf, a.box.u1 - a.box.u0, a.box.v1 - a.box.v0)
    span = max(span, reach_of(b.side, b.leaf, b.box.u1 - b.box.u0, b.box.v1 - b.box.v0))
    span = max(min(span, size), LEAST_SPAN * size)
    frame = across(n)
    held_a = held_along(a, ja, n, q[0], q[1]) if here else (0.0, 0.0)
    held_b = held_along(b, jb, n, q[2], q[3]) if here else (0.0, 0.0)
    sa = shape(a.side, wa, ja, n, frame, held_a, span)
    sb = shape(b.side, wb, jb, scale(-1.0, n), frame, held_b, span)
    turned, point, axis = common_axis(a, b, (wa, wb), size)
    known, meridian = in_meridian(x, y, n, point, axis)
    turned = turned and known
    # of rims, and of parts that go on about the axis from those whose points these are
    if first <= 1 and (not here or ends_sharply(a) or ends_sharply(b)):
        place = (here, q, x, y, max(limit, AXIS_BOXES))
        closed, phi = by_straight(goal, a, b, (wa, wb, n), (turned, meridian), place, counts)
        if closed:
            return 1, phi
        place = (here, q, x, y, limit)
    for way in range(max(first, 1), min(last, SCREWED - 1) + 1):
        if is_stopped(best, counts):
            break
        if way % 2 == 1 and not turned:
            continue
        margin = MARGINS[(way - 1) // 2] / span
        if way % 2 == 1:
            phi = coaxial_between(meridian, frame, (sa, sb), margin, size)
        else:
            phi = torus_between(x, y, n, frame, sa, sb, margin)
        if by_one(phi, goal, a, b, place, counts):
            return way, phi
    return -1, NO_POTENTIAL


@kernel
def by_straight(goal, a, b, at, common, place, counts):
    """(whether a potential that is constant along lines about an axis proves it, potential): of the
    cylinder or the cone that one of two points lies on, where both parts turn about its axis or one
    beside it; where there is none, of one about a common axis."""
    wa, wb, n = at
    none = True
    for k in range(2):
        side, leaf, x = (a.side, wa, place[2]) if k == 0 else (b.side, wb, place[3])
        known, phi = own_straight(side, leaf, x, n)
        none = none and not known
        known = known and turns_along(a, phi.n) and turns_along(b, phi.n)
        if known and by_one(phi, goal, a, b, place, counts):
            return True, phi
    if none and common[0]:
        phi = straight_about(common[1])
        return by_one(phi, goal, a, b, place, counts), phi
    return False, NO_POTENTIAL


@kernel
def by_screw(goal, a, b, n, place, screw, counts):
    """(whether a potential along a common screw proves it, potential); screw: whether to try it,
    and the screw."""
    if not (screw[0] and screw[1][0]):
        return False, NO_POTENTIAL
    known, phi = screw_between(a, b, place[2], place[3], n, screw[1])
    return known and by_one(phi, goal, a, b, place, counts), phi


@kernel
def by_one(phi, goal, a, b, place, counts):
    """By one potential through points x and y, whose parameters q are those of the parts if `here`;
    each part gets half of what the potential gains beyond the goal."""
    here, q, x, y, limit = place
    low, high = potential_jet(phi, x, 0.0)[0], potential_jet(phi, y, 0.0)[0]
    spare = 0.5 * (high - low - goal)
    if spare < 0.0:
        return False
    pa, pb = (q[0], q[1]), (q[2], q[3])
    if not here:
        pa, pb = middle(a.box), middle(b.box)
    # what has fewer parameters fails after fewer boxes
    b_first = dim_of(b.side, b.leaf) < dim_of(a.side, a.leaf)
    if b_first and not proven(phi, -1.0, spare - high, b, pb, limit, counts):
        return False
    if not proven(phi, 1.0, low + spare, a, pa, limit, counts):
        return False
    return b_first or proven(phi, -1.0, spare - high, b, pb, limit, counts)


@kernel
def slanted(part, jet, delta, length, reach, turn):
    """How far B may move before a direction from one box to the other is normal to a leaf, by its
    tangents, length; 0 or less where one may be now.

    `turn` is by how much the leaf turns as B moves, radians per length."""
    side, leaf, box = part.side, part.leaf, part.box
    o, m = leaf_reals(side, leaf), side.numbers
    hu, hv = 0.5 * (box.u1 - box.u0), 0.5 * (box.v1 - box.v0)
    far = length + reach
    uu, uv, vv = m[o + S.SECOND], m[o + S.SECOND + 1], m[o + S.SECOND + 2]
    free = 0.0
    for k in range(2):
        tangent = jet[1 + k]
        change = uu * hu + uv * hv if k == 0 else uv * hu + vv * hv
        size = norm(tangent)
        spread = change + SMOOTH_SPARE * size
        spare = size * reach + spread * far
        slope = abs(dot(tangent, delta))
        if size > 0.0 and slope > spare:
            # by a motion up to `length`, which the shift and the turn may each take
            free = max(free, (slope - spare) / (size * (1.0 + 2.0 * turn * length) + spread))
    return min(free, length)


@kernel
def no_pair(a, b, goal, rounding, turn):
    """(lower bound of the distance of two parts, length that B may move before they may hold a
    nearest pair, their middle points), by their tangent planes' bounds; 0 or less: they may now,
    and are nearer than `goal`. `turn`: of B as it moves, radians per length.

    A bound above 0 is one along the line between the middle points."""
    qa, qb = middle(a.box), middle(b.box)
    ja, jb = leaf_jet(a.side, a.leaf, qa[0], qa[1]), leaf_jet(b.side, b.leaf, qb[0], qb[1])
    middles = ja[0], jb[0]
    delta = sub(jb[0], ja[0])
    length = norm(delta)
    ha = (0.5 * (a.box.u1 - a.box.u0), 0.5 * (a.box.v1 - a.box.v0))
    hb = (0.5 * (b.box.u1 - b.box.u0), 0.5 * (b.box.v1 - b.box.v0))
    reach = reach_of(a.side, a.leaf, ha[0], ha[1]) + reach_of(b.side, b.leaf, hb[0], hb[1])
    if length == 0.0:
        return 0.0, 0.0, middles
    n = scale(1.0 / length, delta)
    low = max(length - reach, 0.0)
    flat = length - along(a.side, a.leaf, ja, n, ha) - along(b.side, b.leaf, jb, n, hb)
    low = max(low, flat) - rounding
    if low >= goal:
        return low, inf, middles
    apart = length - reach - rounding
    if apart > 0.0:
        free = slanted(a, ja, delta, length, reach, 0.0)
        free = max(free, slanted(b, jb, delta, length, reach, turn))
        if free > 0.0:
            return low, min(free, apart), middles
    return max(low, 0.0), 0.0, middles


@kernel
def put_pair(work, n, box_a, box_b, low):
    o = PAIR_REALS * n
    work[o], work[o + 1], work[o + 2], work[o + 3] = box_a.u0, box_a.u1, box_a.v0, box_a.v1
    work[o + 4], work[o + 5], work[o + 6], work[o + 7] = box_b.u0, box_b.u1, box_b.v0, box_b.v1
    work[o + 8] = low


@kernel
def split(box, by_u):
    if by_u:
        m = 0.5 * (box.u0 + box.u1)
        return S.Box(box.u0, m, box.v0, box.v1), S.Box(m, box.u1, box.v0, box.v1)
    m = 0.5 * (box.v0 + box.v1)
    return S.Box(box.u0, box.u1, box.v0, m), S.Box(box.u0, box.u1, m, box.v1)


@kernel
def widths(side, leaf, box):
    o, m = leaf_reals(side, leaf), side.numbers
    return m[o + S.FIRST] * (box.u1 - box.u0), m[o + S.FIRST + 1] * (box.v1 - box.v0)


@kernel
def nearest_of(a, b, counts):
    """(parameters, distance) of a local minimum over two parts, from their middles."""
    start = (*middle(a.box), *middle(b.box))
    return nearest(a.side, a.leaf, a.box, b.side, b.leaf, b.box, start, counts)


@kernel
def closed_by_any(a, b, found, best, minima, hard, counts):
    """Is a pair of parts closed, with the nearest points found in it? Of a `hard` pair of leaves
    more boxes of a potential are looked at."""
    q, distance = found
    goal, row = best[LEAST] - best[TOLERANCE] + best[ROUNDING], -1
    if best[ABOVE] > best[LEAST]:
        goal, row = local_goal(a, b, q, distance, best, minima)
    pair = (a, b, q, distance)
    closed = closed_to(goal, row, pair, FEW_BOXES, best, minima, counts)[0] >= 0
    # a nearer place off a trim is cut away sooner than bounded
    if not closed and distance >= goal:
        closed = hard and closed_to(goal, row, pair, MOST_BOXES, best, minima, counts)[0] >= 0
    elif not closed:
        closed = closed_off_trim(goal, 0.0, a, b, best, counts)[0] >= goal
    if closed:
        best[OF_LEAVES] = min(best[OF_LEAVES], goal - best[ROUNDING])
    return closed


@small
def aimed(goal, distance, ahead):
    """What to prove of parts that are farther apart than the goal: up to `ahead` more."""
    return goal + max(0.0, min(ahead, SHARE_AHEAD * (distance - goal)))


@kernel
def closed_off_trim(goal, ahead, a, b, best, counts):
    """(bound, potential) of two parts that are nearer off their trims, through the nearest points
    on the trimming curves of one: from `goal` on, up to `ahead` more; -inf: none."""
    q, distance = nearest_on_trim(a, b, counts)
    aim = aimed(goal, distance, ahead)
    if goal <= distance < inf:
        at = (a.leaf, b.leaf, q)
        way, phi = by_witness(aim, a, b, at, ALL_WAYS, FEW_BOXES, best, counts)
        if way >= 0:
            return aim, phi
    if is_stopped(best, counts):
        return -inf, NO_POTENTIAL
    q, distance = nearest_on_trim(b, a, counts)
    if not goal <= distance < inf:
        return -inf, NO_POTENTIAL
    aim = aimed(goal, distance, ahead)
    at = (a.leaf, b.leaf, (q[2], q[3], q[0], q[1]))
    way, phi = by_witness(aim, a, b, at, ALL_WAYS, FEW_BOXES, best, counts)
    return aim if way >= 0 else -inf, phi


@kernel
def closed_to(goal, row, pair, limit, best, minima, counts):
    """(way, potential) by which a goal is proven of two parts: of the surfaces themselves (`OWN_A`,
    `OWN_B`), through the nearest points found in the pair (from `HERE` on), or through those that
    the goal comes from (from `THERE` on); -1: by none."""
    a, b, q, distance = pair
    # what has fewer parameters has fewer boxes
    b_first = dim_of(a.side, a.leaf) < dim_of(b.side, b.leaf)
    if b_first and by_own_surface(goal, b, a, (q[0], q[1]), limit, counts):
        return OWN_B, own_toward(b, a, (q[0], q[1]))[1]
    if by_own_surface(goal, a, b, (q[2], q[3]), limit, counts):
        return OWN_A, own_toward(a, b, (q[2], q[3]))[1]
    if not b_first and by_own_surface(goal, b, a, (q[0], q[1]), limit, counts):
        return OWN_B, own_toward(b, a, (q[0], q[1]))[1]
    if is_stopped(best, counts):
        return -1, NO_POTENTIAL
    if distance >= goal:
        way, phi = by_witness(goal, a, b, (a.leaf, b.leaf, q), ALL_WAYS, limit, best, counts)
        if way >= 0:
            return HERE + way, phi
    wa, wb = int(best[LEAF_A]), int(best[LEAF_B])
    at = (best[AT], best[AT + 1], best[AT + 2], best[AT + 3])
    if row >= 0:
        o = MINIMUM_REALS * row
        wa, wb = int(minima[o + 1]), int(minima[o + 2])
        at = (minima[o + 3], minima[o + 4], minima[o + 5], minima[o + 6])
    here = wa == a.leaf and wb == b.leaf and distance >= goal
    if here or (row < 0 and best[BEYOND] == inf):
        return -1, NO_POTENTIAL
    way, phi = by_witness(goal, a, b, (wa, wb, at), ALL_WAYS, limit, best, counts)
    return THERE + way if way >= 0 else -1, phi


@kernel
def put_halves(a, b, best, work, count, low):
    """Cut the longer part in two; the new count of pairs. One too short to cut stays open."""
    au, av = widths(a.side, a.leaf, a.box)
    bu, bv = widths(b.side, b.leaf, b.box)
    if max(max(au, av), max(bu, bv)) <= SHORTEST_PART * best[SIZE]:
        leave_open(best, a.leaf, b.leaf, a.box, b.box, low)
        return count
    if max(au, av) >= max(bu, bv):
        first, second = split(a.box, au >= av)
        put_pair(work, count, first, b.box, low)
        put_pair(work, count + 1, second, b.box, low)
    else:
        first, second = split(b.box, bu >= bv)
        put_pair(work, count, a.box, first, low)
        put_pair(work, count + 1, a.box, second, low)
    return count + 2


@kernel
def left_out(a, b, goal, most, best, counts):
    """Do two parts, one or both of a plane, hold no nearest pair nearer than `goal`?"""
    if planes_apart(a, b, best[SIZE]):
        return True
    if clear_of_plane(a, b, goal, best[ROUNDING], most, counts):
        return True
    return clear_of_plane(b, a, goal, best[ROUNDING], most, counts)


@kernel
def along_thread(a, b):
    """Are both parts of faces of threads? Many such are as near to each other; to cut them takes
    less than more boxes of each."""
    both = dim_of(a.side, a.leaf) + dim_of(b.side, b.leaf) == 4
    return both and own_screw(a.side, a.leaf)[0] and own_screw(b.side, b.leaf)[0]


@kernel
def close_leaves(a, b, pair, best, minima, work, counts):
    """Close a pair (leaf of A, leaf of B, bound, parameters and distance of the nearest points
    found in it), cutting it where it has to be; what stays open lowers best[OPEN], and nearer
    points that are found are kept."""
    leaf_a, leaf_b, low, q, distance = pair
    put_pair(work, 0, leaf_box(a, leaf_a), leaf_box(b, leaf_b), low)
    count, cuts = 1, 0
    # two edges have few boxes
    most_easy = EASY_CUTS if dim_of(a, leaf_a) + dim_of(b, leaf_b) > 2 else 0
    while count > 0 and best[MET] == 0.0:
        count -= 1
        o = PAIR_REALS * count
        pa = S.Part(a, leaf_a, S.Box(work[o], work[o + 1], work[o + 2], work[o + 3]))
        pb = S.Part(b, leaf_b, S.Box(work[o + 4], work[o + 5], work[o + 6], work[o + 7]))
        low, free, _ = no_pair(pa, pb, goal_of(best), best[ROUNDING], 0.0)
        low = max(low, work[o + 8])
        if free > 0.0:
            continue
        if evaluations(counts) > best[BUDGET] or count >= MOST_PAIRS - 2:
            best[OF_LEAVES] = min(best[OF_LEAVES], low)
            leave_open(best, leaf_a, leaf_b, pa.box, pb.box, low)
            continue
        if (
            trim_state(a, leaf_a, pa.box) == OUTSIDE_TRIM
            or trim_state(b, leaf_b, pb.box) == OUTSIDE_TRIM
        ):
            continue
        # of a flush fit there are potentials, and feet that lie beside a face too closely
        flush = cuts == 0 and turn_alike(pa, pb)
        out = cuts == 0 and not flush
        if out and left_out(pa, pb, goal_of(best), MOST_CLOSING, best, counts):
            continue
        if cuts > 0:
            q, distance = nearest_of(pa, pb, counts)
            keep_found(pa, pb, q, distance, best, minima)
            if best[MET] > 0.0:
                break
        hard = cuts >= most_easy and not along_thread(pa, pb)
        if closed_by_any(pa, pb, (q, distance), best, minima, hard, counts):
            continue
        if flush and left_out(pa, pb, goal_of(best), MOST_CLOSING, best, counts):
            continue
        counts[BISECTIONS] += 1
        cuts += 1
        count = put_halves(pa, pb, best, work, count, low)
