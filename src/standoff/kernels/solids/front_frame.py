"""One frame of a tracked search: the witness points go on by Newton's method, and the rows of the
front that are due are looked at."""

from math import asin, inf

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import norm, sub
from standoff.kernels.compiler.decorators import kernel, small
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.front_apart import hold_all
from standoff.kernels.solids.front_branches import follow_branches
from standoff.kernels.solids.front_close import holds, tied
from standoff.kernels.solids.front_held import counted_apart, hold_rows, is_known_apart
from standoff.kernels.solids.front_look import asked_of, descend, settle_row, tell_open
from standoff.kernels.solids.front_minima import find_minima
from standoff.kernels.solids.front_rows import (
    COST,
    HURRIED,
    KNOWN,
    LATE,
    MAKING,
    N_AWAKE,
    N_DUE,
    N_MADE,
    N_ROWS,
    RESTS_UP_TO,
    ROW_A,
    ROW_B,
    ROW_REALS,
    add_row,
    apart_to,
    awake_row,
    bound_key,
    box_of_row,
    due_row,
    is_due,
    is_passed_over,
    is_shut,
    put_due,
)
from standoff.kernels.solids.spatial_boxes import node_centre, node_reach
from standoff.kernels.solids.spatial_pieces import leaf_box, leaf_jet
from standoff.kernels.solids.spatial_progress import (
    ABOVE,
    AT,
    BOUND,
    BUDGET,
    LEAF_A,
    LEAF_B,
    LEAST,
    MET,
    MINIMUM_REALS,
    N_MINIMA,
    N_OPEN,
    NOWHERE,
    OPEN,
    SIZE,
    TOLERANCE,
    evaluations,
    farthest,
    keep_found,
)
from standoff.kernels.solids.spatial_tolerances import (
    FLAT_SPAN,
    FLAT_VALLEY,
    LEAST_REST,
    MOTION_SPARE,
    ONE_PLACE,
)
from standoff.kernels.solids.stationary import is_bowl

# A front that has this many times its first rows, and some, is made anew.
GROWN, GROWN_BY = 2.0, 256.0
# Of what making a front takes: how much more where its rows are to be held at once.
UNHELD = 8.0
# Sizes of a motion after which it counts from 0 again, so that its rounding stays below that of a
# query; and times these and `MOTION_SPARE` the size, for the rounding of what was kept beside it.
FARTHEST_GONE = 16.0
# Bounds are wanted that last for so many frames like this one, and for so many sizes at most.
FRAMES_AHEAD, FARTHEST_AHEAD = 4.0, 0.02
# Frames for which rows have been open, those that come first for it; 0: rows in which the solids
# may come together within `FRAMES_AHEAD`.
LONG_OPEN = (0.0, 8.0, 4.0, 2.0, 1.0)
# Rows are not looked up again for so many frames' motion, and for `LEAST_REST` at least.
FRAMES_AT_REST = 8.0


@kernel
def motion_between(before, now, size):
    """(motion, radius): what no point of B has moved more than, and no turn times its radius;
    lengths. `before` and `now` are B at both poses."""
    centre, radius = node_centre(now, 0), node_reach(now, 0)
    shift = norm(sub(centre, node_centre(before, 0)))
    R, Q = before.pose.R, now.pose.R
    square = 0.0
    for k in range(9):
        square += (R[k] - Q[k]) * (R[k] - Q[k])
    # of two rotations the root of the sum of squares is 2 sqrt(2) sin(angle / 2)
    angle = 2.0 * asin(min(sqrt(square / 8.0), 1.0))
    spare = MOTION_SPARE * (size + norm(now.pose.p) + norm(before.pose.p))
    return (shift + angle * radius) * (1.0 + MOTION_SPARE) + spare, radius


@kernel
def rounding_of(now, size):
    """Of a shift from any pose to one like this, length."""
    return 2.0 * MOTION_SPARE * (size + norm(now.pose.p))


@small
def rest_for(step, size):
    """Motion for which the list of rows that are awake serves, length."""
    return min(max(FRAMES_AT_REST * step, LEAST_REST * size), FARTHEST_AHEAD * size)


@kernel
def far_side(a, b, radius):
    """How much more than B's motion a point of A moves as B sees it, at most."""
    length = norm(sub(node_centre(b, 0), node_centre(a, 0))) + node_reach(a, 0)
    return 1.0 + length / radius


@kernel
def begin(a, b, best, minima):
    """Where the witness points were, they are still on the solids: an upper bound."""
    leaf_a, leaf_b = int(best[LEAF_A]), int(best[LEAF_B])
    q = (best[AT], best[AT + 1], best[AT + 2], best[AT + 3])
    x = leaf_jet(a, leaf_a, q[0], q[1])[0]
    y = leaf_jet(b, leaf_b, q[2], q[3])[0]
    pa, pb = S.Part(a, leaf_a, leaf_box(a, leaf_a)), S.Part(b, leaf_b, leaf_box(b, leaf_b))
    keep_found(pa, pb, q, norm(sub(y, x)), best, minima)


@kernel
def follow(a, b, front, goal, travel, best, minima, counts):
    """List the rows that may be due in this frame, for goals up to `goal`, and go on by Newton's
    method in those that hold the witness points."""
    q = (best[AT], best[AT + 1], best[AT + 2], best[AT + 3])
    leaf_a, leaf_b = best[LEAF_A], best[LEAF_B]
    most, farther = best[LEAST] + travel.gone, goal + travel.gone
    front.store[N_DUE] = 0.0
    for i in range(int(front.store[N_AWAKE])):
        k = awake_row(front, i)
        bound = bound_key(front, k)
        if bound >= farther:
            continue
        if is_due(front, k, goal, travel):
            put_due(front, k)
        if bound > most:
            continue
        o = ROW_REALS * k
        if front.rows[o + ROW_A] == leaf_a and front.rows[o + ROW_B] == leaf_b:
            box_a, box_b = box_of_row(front, k, 0), box_of_row(front, k, 1)
            if holds(box_a, q[0], q[1]) and holds(box_b, q[2], q[3]):
                descend(a, b, front, k, best, minima, counts)


@kernel
def make_front(front):
    """One row, of both roots."""
    front.store[N_ROWS], front.store[MAKING], front.store[COST] = 0.0, 1.0, 0.0
    front.store[N_AWAKE], front.store[N_DUE] = 0.0, 0.0
    front.store[RESTS_UP_TO], front.store[LATE] = -inf, 0.0
    add_row(front, -1, -1, (NOWHERE, NOWHERE), -inf, (0.0, 0.0, 0.0, 0.0), False)


@kernel
def has_grown(front, travel, best):
    """Is a front to be made anew, and is there time for it?"""
    store = front.store
    grown = store[MAKING] == 0.0 and store[N_ROWS] > GROWN * store[N_MADE] + GROWN_BY
    # new rows are not held: where the solids are not known to stay apart, they take more
    more = GROWN if is_known_apart(front, travel) else UNHELD * GROWN
    return grown and best[BUDGET] > more * store[COST]


@kernel
def settle_oldest(a, b, front, age, travel, best, minima, counts):
    """Look at rows while there is time: those in which the solids may come together soon, and of
    these first at so much that they are known not to (`age` 0); or those whose bounds have sunk by
    `age` frames' motion since they were asked for."""
    store = front.store
    low = min(tied(best), travel.step)
    if age > 0.0:
        low = tied(best) - age * travel.ahead / FRAMES_AHEAD
    store[LATE], i = HURRIED if age == 0.0 else 1.0, 0
    while i < int(store[N_DUE]) and evaluations(counts) <= best[BUDGET]:
        k = due_row(front, i)
        i += 1
        key = apart_to(front, k) if age == 0.0 else bound_key(front, k)
        if key - travel.gone < low and best[MET] == 0.0:
            settle_row(a, b, front, k, travel, best, minima, counts)


@kernel
def settle_rows(a, b, front, travel, best, minima, counts):
    """Look at all rows that are due. If the last frame ran out of time, those come first that have
    been open for longest."""
    store = front.store
    if store[LATE] > 0.0:
        for age in LONG_OPEN:
            settle_oldest(a, b, front, age, travel, best, minima, counts)
    best[OPEN], best[N_OPEN], store[LATE] = inf, 0.0, 0.0
    i = 0
    while i < int(store[N_DUE]) and best[MET] == 0.0:
        k = due_row(front, i)
        i += 1
        # most rows rest, by their keys alone: nothing more is asked of any
        if not is_due(front, k, tied(best), travel):
            continue
        if not settle_row(a, b, front, k, travel, best, minima, counts):
            store[LATE] = 1.0


@kernel
def settle_all(a, b, front, travel, best, minima, counts):
    """Look at all rows that are due if the solids are apart; whether they are known to be. If not,
    and there is time, at those in which they may have a common point."""
    known = is_known_apart(front, travel)
    trusting = counted_apart(travel)
    if not known and front.store[LATE] > 0.0:
        # where there may be no time for both, the solids are to be known apart first
        settle_oldest(a, b, front, LONG_OPEN[0], trusting, best, minima, counts)
        known = hold_all(a, b, front, trusting, best, minima, counts)
    settle_rows(a, b, front, trusting, best, minima, counts)
    if known or hold_all(a, b, front, trusting, best, minima, counts):
        front.store[KNOWN] = max(front.store[KNOWN], travel.gone)
        return True
    if best[MET] == 0.0 and front.store[LATE] == 0.0:
        settle_rows(a, b, front, travel, best, minima, counts)
    else:
        best[OPEN] = min(best[OPEN], 0.0)
    return False


@kernel
def frame(a, b, front, travel, best, minima, counts):
    """Fill `best` and `minima` as a search does; whether the front was made anew, and whether the
    solids are known to have stayed apart."""
    store = front.store
    anew = store[N_ROWS] == 0.0 or has_grown(front, travel, best)
    if anew:
        make_front(front)
    # by what was proven before, so before anything is proven of this frame
    if not is_known_apart(front, travel):
        hold_rows(front, travel.gone - travel.step, travel)
    above = best[ABOVE]
    if above > 0.0:
        follow_branches(a, b, front, best, minima, counts)
        find_minima(a, b, front, counted_apart(travel), best, minima, counts)
        best[ABOVE] = 0.0  # what is to be proven does not depend on it
    sure = settle_all(a, b, front, travel, best, minima, counts)
    if sure:
        travel = counted_apart(travel)
    if store[MAKING] > 0.0:
        store[COST] += evaluations(counts)
        if best[N_OPEN] == 0.0:
            store[N_MADE], store[MAKING] = store[N_ROWS], 0.0
    # what rests, and may be as near as the nearest, is gone through all the same
    for i in range(int(store[N_DUE])):
        k = due_row(front, i)
        if best[MET] == 0.0 and is_passed_over(front, k, tied(best), travel):
            if evaluations(counts) <= best[BUDGET]:
                descend(a, b, front, k, best, minima, counts)
            elif not is_due(front, k, asked_of(front, k, best), travel):
                tell_open(front, k, travel, best)  # all others are told
    if above > 0.0:
        best[ABOVE] = above
        bound_found(front, travel, best, minima)
    return anew, sure


@kernel
def bound_found(front, travel, best, minima):
    """Write down what is proven of each minimum, of all parts of its leaves."""
    n = int(best[N_MINIMA])
    for i in range(n):
        minima[MINIMUM_REALS * i + BOUND] = minima[MINIMUM_REALS * i]
    for j in range(int(front.store[N_DUE])):
        k = due_row(front, j)
        low = bound_key(front, k) - travel.gone
        if low >= farthest(best) or is_shut(front, k, travel):
            continue
        o = ROW_REALS * k
        for i in range(n):
            m = MINIMUM_REALS * i
            same = minima[m + 1] == front.rows[o + ROW_A]
            if same and minima[m + 2] == front.rows[o + ROW_B]:
                minima[m + BOUND] = min(minima[m + BOUND], max(low, 0.0))


@small
def apart_by(minima, k, a, b, x, y):
    """How far the points of a minimum are from two others, at most."""
    o = MINIMUM_REALS * k
    p = leaf_jet(a, int(minima[o + 1]), minima[o + 3], minima[o + 4])[0]
    q = leaf_jet(b, int(minima[o + 2]), minima[o + 5], minima[o + 6])[0]
    return max(norm(sub(p, x)), norm(sub(q, y)))


@kernel
def is_single(a, b, best, minima):
    """Are the nearest points the only ones, as far as is known, and do all others grow away from
    them?"""
    leaf_a, leaf_b = int(best[LEAF_A]), int(best[LEAF_B])
    q = (best[AT], best[AT + 1], best[AT + 2], best[AT + 3])
    ja, jb = leaf_jet(a, leaf_a, q[0], q[1]), leaf_jet(b, leaf_b, q[2], q[3])
    for k in range(int(best[N_MINIMA])):
        near = minima[MINIMUM_REALS * k] <= tied(best)
        if near and apart_by(minima, k, a, b, ja[0], jb[0]) > ONE_PLACE * best[SIZE]:
            return False
    return is_bowl(a, leaf_a, ja, b, leaf_b, jb, q, -flat_valley(best))


@small
def flat_valley(best):
    """How little the square of the distance may bend where the nearest pairs may be a continuum: a
    peg in its hole bends it little too, by its play."""
    size = best[SIZE]
    return min(FLAT_VALLEY, FLAT_SPAN * best[LEAST] * best[TOLERANCE] / (size * size))
