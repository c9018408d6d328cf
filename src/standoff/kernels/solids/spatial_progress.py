"""What a search of two solids in space has come to: the pairs of points that were found, and the
pairs of boxes that stay open."""

from standoff.kernels.compiler.decorators import kernel, small
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_pieces import leaf_box, leaf_jet, on_solid, reach_of

# What `best` holds: the least distance, how many minima, its leaves and parameters, the least bound
# of what stayed open, 1 where the boundaries meet, and what is asked: the tolerance, the slack of
# rounding, the size, how many evaluations are allowed, up to which distance local minima are kept,
# below which distance the boundaries meet. Then how many minima have room and how many were left
# out, how many pairs of boxes stayed open and how many of them have room, the least bound of the
# pair of leaves at hand, and after how many evaluations no further potential is tried for a pair of
# parts, 0: each is. Then how far the place (leaves and parameters) is if it is beyond what is asked
# for, inf: there is none yet, 0: it is not beyond; from OPEN_ROWS on the open pairs.
LEAST, N_MINIMA, LEAF_A, LEAF_B, AT, OPEN, MET, TOLERANCE, ROUNDING, SIZE, BUDGET = (
    0, 1, 2, 3, 4, 8, 9, 10, 11, 12, 13,
)  # fmt: skip
ABOVE, MEETING, MOST_MINIMA, LOST, N_OPEN, MOST_OPEN, OF_LEAVES, STOP, BEYOND = (
    14, 15, 16, 17, 18, 19, 20, 21, 22,
)  # fmt: skip
BEST_REALS = OPEN_ROWS = 23
# What an open pair holds: leaves (-1 - node where it is a node), both boxes, its bound.
OPEN_REALS = 11
# What a minimum holds: distance, leaves, parameters, bound; where local ones are kept both points
# and the normal from A to B, 0 where the points are one.
MINIMUM_REALS = 17
BOUND, POINTS, NORMAL = 7, 8, 14
# What a pair of leaves that is left holds: both, its bound, the distance of its nearest points that
# were found and their parameters.
LEFT_REALS = 8
# What is counted: boxes that potentials are bounded over, steps of Newton's method, pairs of nodes,
# pairs of leaves, bisections.
BOXES, STEPS, NODE_PAIRS, LEAF_PAIRS, BISECTIONS = 0, 1, 2, 3, 4


@small
def evaluations(counts):
    """Of points and of bounds: a step of Newton's method takes a point of both solids."""
    return counts[BOXES] + 2 * counts[STEPS] + counts[NODE_PAIRS]


@small
def is_stopped(best, counts):
    """Is there no time for another potential?"""
    return best[STOP] > 0.0 and evaluations(counts) > best[STOP]


@small
def goal_of(best):
    """What is to be proven where no local minimum is nearer."""
    return max(best[LEAST], best[ABOVE]) - best[TOLERANCE] + best[ROUNDING]


@small
def farthest(best):
    """Pairs that are farther apart are of no interest; never less than the goal."""
    return max(max(best[LEAST] + best[TOLERANCE], best[ABOVE]), goal_of(best))


@kernel
def make_room(best, minima):
    """Whether there is room for one more minimum; those that are too far are dropped for it."""
    n, most = int(best[N_MINIMA]), int(best[MOST_MINIMA])
    if n < most:
        return True
    kept = 0
    for i in range(n):
        if minima[MINIMUM_REALS * i] <= farthest(best):
            for k in range(MINIMUM_REALS):
                minima[MINIMUM_REALS * kept + k] = minima[MINIMUM_REALS * i + k]
            kept += 1
    best[N_MINIMA] = kept
    return kept < most


@kernel
def put_places(a, b, minima, o):
    """Both points of a row, in A's frame, and their normal into it."""
    x = leaf_jet(a, int(minima[o + 1]), minima[o + 3], minima[o + 4])[0]
    y = leaf_jet(b, int(minima[o + 2]), minima[o + 5], minima[o + 6])[0]
    share = 1.0 / minima[o] if minima[o] > 0.0 else 0.0
    for k in range(3):
        minima[o + POINTS + k], minima[o + POINTS + 3 + k] = x[k], y[k]
        minima[o + NORMAL + k] = share * (y[k] - x[k])


@kernel
def put_place(best, a, b, q):
    best[LEAF_A], best[LEAF_B] = a.leaf, b.leaf
    for k in range(4):
        best[AT + k] = q[k]


@kernel
def keep(best, minima, a, b, q, distance):
    """Keep a pair of points of two parts, which are on both solids."""
    if distance < best[LEAST]:
        best[LEAST], best[BEYOND] = distance, 0.0
        put_place(best, a, b, q)
    if distance > farthest(best):
        return
    if not make_room(best, minima):
        best[LOST] += 1.0
        return
    o = MINIMUM_REALS * int(best[N_MINIMA])
    minima[o], minima[o + 1], minima[o + 2] = distance, a.leaf, b.leaf
    for k in range(4):
        minima[o + 3 + k] = q[k]
    minima[o + BOUND] = 0.0
    if best[ABOVE] > 0.0:
        put_places(a.side, b.side, minima, o)
    best[N_MINIMA] += 1.0


@kernel
def at_cut(part, u, v):
    """Is a point at a side of a part that is none of its leaf?"""
    box, whole = part.box, leaf_box(part.side, part.leaf)
    return (
        (u <= box.u0 and box.u0 > whole.u0)
        or (u >= box.u1 and box.u1 < whole.u1)
        or (v <= box.v0 and box.v0 > whole.v0)
        or (v >= box.v1 and box.v1 < whole.v1)
    )


@kernel
def on_both(a, b, q):
    return on_solid(a.side, a.leaf, q[0], q[1]) and on_solid(b.side, b.leaf, q[2], q[3])


@kernel
def keep_found(a, b, q, distance, best, minima):
    """Keep a pair that is as near as is of interest, if both points are on the solids; beyond that
    the nearest, through which potentials prove that none is nearer."""
    if distance <= max(farthest(best), best[BEYOND]) and on_both(a, b, q):
        tie = distance <= best[LEAST] + best[TOLERANCE]
        if tie or not (at_cut(a, q[0], q[1]) or at_cut(b, q[2], q[3])):
            if distance < best[BEYOND]:
                best[BEYOND] = distance
                put_place(best, a, b, q)
            keep(best, minima, a, b, q, distance)
    if best[LEAST] <= best[MEETING]:
        best[MET] = 1.0


@kernel
def leave_open(best, first, other, box_a, box_b, low):
    """A pair that is not closed: its bound counts, and it is listed if it is among the nearest."""
    best[OPEN] = min(best[OPEN], low)
    n, most = int(best[N_OPEN]), int(best[MOST_OPEN])
    best[N_OPEN] += 1.0
    if most == 0:
        return
    at = n
    if n >= most:
        at = 0
        for k in range(1, most):
            if best[OPEN_ROWS + OPEN_REALS * k + 10] > best[OPEN_ROWS + OPEN_REALS * at + 10]:
                at = k
        if best[OPEN_ROWS + OPEN_REALS * at + 10] <= low:
            return
    o = OPEN_ROWS + OPEN_REALS * at
    best[o], best[o + 1], best[o + 10] = first, other, low
    best[o + 2], best[o + 3], best[o + 4], best[o + 5] = box_a.u0, box_a.u1, box_a.v0, box_a.v1
    best[o + 6], best[o + 7], best[o + 8], best[o + 9] = box_b.u0, box_b.u1, box_b.v0, box_b.v1


@kernel
def middle(box):
    return 0.5 * (box.u0 + box.u1), 0.5 * (box.v0 + box.v1)


@kernel
def ball_round(part):
    """(middle point, radius) of a ball that holds a part, in A's frame."""
    box = part.box
    q = middle(box)
    x = leaf_jet(part.side, part.leaf, q[0], q[1])[0]
    hu, hv = 0.5 * (box.u1 - box.u0), 0.5 * (box.v1 - box.v0)
    return x, reach_of(part.side, part.leaf, hu, hv)


@kernel
def inside_ball(minima, o, x, radius):
    dx, dy, dz = minima[o] - x[0], minima[o + 1] - x[1], minima[o + 2] - x[2]
    return dx * dx + dy * dy + dz * dz <= radius * radius


@kernel
def local_goal(a, b, q, distance, best, minima):
    """(what is to be proven of two parts, the minimum it comes from or -1), where local minima are
    kept: no points of theirs are nearer than the nearest that were found in or beside them."""
    least, row = best[ABOVE], -1
    if distance < least and on_both(a, b, q):
        least = distance
    x, radius_x = ball_round(a)
    y, radius_y = ball_round(b)
    spare = best[TOLERANCE]
    for k in range(int(best[N_MINIMA])):
        o = MINIMUM_REALS * k
        if (
            minima[o] < least
            and inside_ball(minima, o + POINTS, x, radius_x + spare)
            and inside_ball(minima, o + POINTS + 3, y, radius_y + spare)
        ):
            least, row = minima[o], k
    return max(least, best[LEAST]) - best[TOLERANCE] + best[ROUNDING], row


@kernel
def bound_minima(best, minima, leaf_a, leaf_b, bound):
    """Write down what is proven of the minima in a pair of leaves."""
    for k in range(int(best[N_MINIMA])):
        o = MINIMUM_REALS * k
        if minima[o + 1] == leaf_a and minima[o + 2] == leaf_b:
            minima[o + BOUND] = bound


NOWHERE = S.Box(0.0, 0.0, 0.0, 0.0)
