"""The local minima among the pairs of points that were found, each once, the nearest first."""

from standoff.kernels.algebra.rigid import read_vector
from standoff.kernels.algebra.vectors import norm, sub
from standoff.kernels.compiler.decorators import kernel, small
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.planar_tolerances import AT_OPTIMUM
from standoff.kernels.solids.spatial_minimum import jets_at
from standoff.kernels.solids.spatial_pieces import leaf_ints
from standoff.kernels.solids.spatial_progress import (
    ABOVE,
    AT,
    BOUND,
    LEAF_A,
    LEAF_B,
    LEAST,
    MINIMUM_REALS,
    N_MINIMA,
    NORMAL,
    POINTS,
    SIZE,
    TOLERANCE,
    put_places,
)
from standoff.kernels.solids.spatial_tolerances import (
    FLAT_VALLEY,
    ONE_PLACE,
    SAME_BASIN,
    SURE_NORMAL,
    VALLEY,
)
from standoff.kernels.solids.stationary import is_bowl, is_stationary

# What is told of a local minimum: its nearest pair as a row of minima has it, with the best bound
# that any of its pieces has; the number of that row; the number of its branch, -1: not yet known;
# both points; and how many pairs of points its patch has, with room for four of them. All points
# are in A's frame.
SET_ROW, SET_BRANCH, SET_SPOT, SET_PAIRS, SET_POINTS = 8, 9, 10, 16, 17
SET_REALS = SET_POINTS + 4 * 6
# Of a frame so many are told without a search for ties; more are looked for one by one.
MOST_SETS = 128


@small
def is_one_place(x, y, distance, other_x, other_y, other_distance, size):
    """Is a pair another one again, or cut off its valley by the side of a leaf?"""
    away = max(norm(sub(x, other_x)), norm(sub(y, other_y)))
    farther = abs(distance - other_distance) > VALLEY * size
    return away <= (SAME_BASIN if farther else ONE_PLACE) * size


@kernel
def points_of(minima, o):
    return read_vector(minima, o + POINTS), read_vector(minima, o + POINTS + 3)


@small
def is_nearest(best, minima, o):
    """Is a row the one of the nearest points?"""
    same = minima[o + 1] == best[LEAF_A] and minima[o + 2] == best[LEAF_B]
    for k in range(4):
        same = same and minima[o + 3 + k] == best[AT + k]
    return same and minima[o] == best[LEAST]


@kernel
def is_minimum(a, b, fans, minima, o):
    n = read_vector(minima, o + NORMAL)
    q = (minima[o + 3], minima[o + 4], minima[o + 5], minima[o + 6])
    leaves = int(minima[o + 1]), int(minima[o + 2])
    if not is_stationary(a, b, fans[0], fans[1], q, leaves, n, AT_OPTIMUM):
        return False
    ja, jb = jets_at(a, leaves[0], b, leaves[1], q)
    return is_bowl(a, leaves[0], ja, b, leaves[1], jb, q, FLAT_VALLEY)


@kernel
def extent(a, b, rows, o):
    """Of how many parameters the features of a row are."""
    leaf_a, leaf_b = int(rows[o + 1]), int(rows[o + 2])
    return a.own[leaf_ints(a, leaf_a) + S.DIM] + b.own[leaf_ints(b, leaf_b) + S.DIM]


@kernel
def tells_better(a, b, minima, o, sets, s, size):
    """Is a row nearer than the one of a set; or as near up to rounding and on features with fewer
    parameters, as a point of an edge is one of its faces too?"""
    if abs(minima[o] - sets[s]) > VALLEY * size:
        return minima[o] < sets[s]
    return extent(a, b, minima, o) < extent(a, b, sets, s)


@kernel
def put_in_set(a, b, best, minima, i, sets, n):
    """Put row `i` into the set that it is one with, or into one of its own; how many sets there
    are, -1 where there is no room."""
    o = MINIMUM_REALS * i
    x, y = points_of(minima, o)
    distance, bound = minima[o], minima[o + BOUND]
    at, least = n, distance
    for k in range(n):
        s = SET_REALS * k
        p, q = points_of(minima, MINIMUM_REALS * int(sets[s + SET_ROW]))
        near = abs(distance - sets[s]) <= best[TOLERANCE]
        if near and is_one_place(x, y, distance, p, q, sets[s], best[SIZE]):
            at = k
            break
    s = SET_REALS * at
    if at == n:
        if n == MOST_SETS:
            return -1
    else:
        bound, least = max(bound, sets[s + BOUND]), min(distance, sets[s])
    if at == n or tells_better(a, b, minima, o, sets, s, best[SIZE]):
        for k in range(BOUND):
            sets[s + k] = minima[o + k]
        for k in range(6):
            sets[s + SET_SPOT + k] = minima[o + POINTS + k]
        sets[s + SET_ROW], sets[s + SET_PAIRS] = i, 0.0
    sets[s], sets[s + BOUND], sets[s + SET_BRANCH] = least, bound, -1.0
    return max(n, at + 1)


@kernel
def sort_sets(sets, n):
    """The nearest first."""
    for i in range(1, n):
        k = i
        while k > 0 and sets[SET_REALS * k] < sets[SET_REALS * (k - 1)]:
            for j in range(SET_PAIRS + 1):
                u, v = SET_REALS * k + j, SET_REALS * (k - 1) + j
                sets[u], sets[v] = sets[v], sets[u]
            k -= 1


@kernel
def gather(a, b, fans, best, minima, wider, sets):
    """Put the local minima below best[ABOVE] - `wider` among the rows of `minima` into the rows of
    `sets`; how many. -1 where this does not tell them: where some are as near as others, which may
    be one with them, where points are too near for a normal, or where they are many."""
    n, most = 0, max(best[LEAST] + best[TOLERANCE], best[ABOVE] - wider)
    for i in range(int(best[N_MINIMA])):
        o = MINIMUM_REALS * i
        put_places(a, b, minima, o)
        if minima[o] > most:
            continue
        if minima[o] <= SURE_NORMAL * best[SIZE]:
            return -1
        if is_nearest(best, minima, o) or is_minimum(a, b, fans, minima, o):
            n = put_in_set(a, b, best, minima, i, sets, n)
            if n < 0:
                return -1
    sort_sets(sets, n)
    if n == 0 or sets[0] != best[LEAST]:
        return -1
    for k in range(1, n):
        if sets[SET_REALS * k] - sets[SET_REALS * (k - 1)] <= best[TOLERANCE]:
            return -1
    return n
