"""The minima of the signed distance among the pairs of points that were found, each once: what was
found twice is one, and so are pairs that are level with each other on features that touch, as the
corners of a face that lies on another."""

from standoff.kernels.algebra.rigid import read_vector
from standoff.kernels.algebra.vectors import dot, norm, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_record, coedge_record, edge_record
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.front_motion import put_three
from standoff.kernels.solids.minima_sets import (
    MOST_SETS,
    SET_BRANCH,
    SET_PAIRS,
    SET_REALS,
    SET_ROW,
    SET_SPOT,
    points_of,
    sort_sets,
    tells_better,
)
from standoff.kernels.solids.planar_tolerances import AT_OPTIMUM
from standoff.kernels.solids.spatial_pieces import leaf_ints
from standoff.kernels.solids.spatial_progress import (
    ABOVE,
    BOUND,
    LOST,
    MINIMUM_REALS,
    MOST_MINIMA,
    N_MINIMA,
    NORMAL,
    POINTS,
    SIZE,
    TOLERANCE,
)
from standoff.kernels.solids.spatial_tolerances import ONE_PLACE

# In the place of a row's bound stands which minimum it belongs to; of what is none:
NO_MINIMUM = -1.0


@kernel
def put_normal(leaves, spot, points, number, best, minima):
    """Add a common normal to the rows, if there is room. spot: parameters, normal, signed distance;
    `number` stands in the place of its bound."""
    if best[N_MINIMA] >= best[MOST_MINIMA]:
        best[LOST] += 1.0
        return
    q, n, d = spot
    o = MINIMUM_REALS * int(best[N_MINIMA])
    minima[o], minima[o + 1], minima[o + 2] = d, leaves[0], leaves[1]
    for k in range(4):
        minima[o + 3 + k] = q[k]
    put_three(minima, o + POINTS, points[0])
    put_three(minima, o + POINTS + 3, points[1])
    put_three(minima, o + NORMAL, n)
    minima[o + BOUND] = number
    best[N_MINIMA] += 1.0


@kernel
def is_end(side, edge, vertex):
    """Is a vertex an end of an edge? Both by their features."""
    row = edge_record(side.ints, edge)
    number = vertex - side.ints[L.N_FACES] - side.ints[L.N_EDGES]
    return side.ints[row + L.EDGE_FIRST] == number or side.ints[row + L.EDGE_LAST] == number


@kernel
def is_side(side, face, edge):
    """Is an edge one of a face's? Both by their features."""
    row = edge_record(side.ints, edge)
    for k in (L.EDGE_COEDGE_0, L.EDGE_COEDGE_1):
        coedge = side.ints[row + k]
        if coedge >= 0:
            chart = side.ints[coedge_record(side.ints, coedge) + L.COEDGE_CHART]
            if side.ints[chart_record(side.ints, chart) + L.CHART_FACE] == face:
                return True
    return False


@kernel
def are_adjacent(side, leaf, other):
    """Are two leaves of one feature, or of two of which one is at the border of the other?"""
    r, s = leaf_ints(side, leaf), leaf_ints(side, other)
    if side.own[r + S.FEATURE] == side.own[s + S.FEATURE]:
        return True
    if side.own[r + S.DIM] < side.own[s + S.DIM]:
        r, s = s, r
    above, below = side.own[r + S.FEATURE], side.own[s + S.FEATURE]
    if side.own[r + S.DIM] == 2 and side.own[s + S.DIM] == 1:
        return is_side(side, above, below)
    return side.own[r + S.DIM] == 1 and side.own[s + S.DIM] == 0 and is_end(side, above, below)


@kernel
def is_one_minimum(a, b, best, minima, o, p):
    """Are two minima one?"""
    if abs(minima[o] - minima[p]) > best[TOLERANCE]:
        return False
    if dot(read_vector(minima, o + NORMAL), read_vector(minima, p + NORMAL)) < 1.0 - AT_OPTIMUM:
        return False
    x, y = points_of(minima, o)
    q, r = points_of(minima, p)
    if max(norm(sub(x, q)), norm(sub(y, r))) <= ONE_PLACE * best[SIZE]:
        return True
    if not are_adjacent(a, int(minima[o + 1]), int(minima[p + 1])):
        return False
    return are_adjacent(b, int(minima[o + 2]), int(minima[p + 2]))


@kernel
def join_signed(a, b, best, minima):
    """Give all rows of one minimum its number: that of its first row."""
    n = int(best[N_MINIMA])
    for i in range(n):
        o = MINIMUM_REALS * i
        if minima[o + BOUND] == NO_MINIMUM:
            continue
        minima[o + BOUND] = i
        for j in range(i):
            p = MINIMUM_REALS * j
            own, other = minima[o + BOUND], minima[p + BOUND]
            if other == NO_MINIMUM or own == other or not is_one_minimum(a, b, best, minima, o, p):
                continue
            least = min(own, other)
            for k in range(i + 1):
                q = MINIMUM_REALS * k + BOUND
                if minima[q] == own or minima[q] == other:
                    minima[q] = least


@kernel
def gather_signed(a, b, best, minima, wider, sets):
    """Put each minimum among the rows into a set, the deepest first; how many, -1 where there is no
    room."""
    join_signed(a, b, best, minima)
    n = 0
    for i in range(int(best[N_MINIMA])):
        o = MINIMUM_REALS * i
        if minima[o + BOUND] == NO_MINIMUM or minima[o] > best[ABOVE] - wider:
            continue
        at = n
        for k in range(n):
            if sets[SET_REALS * k + BOUND] == minima[o + BOUND]:
                at = k
                break
        s = SET_REALS * at
        if at == MOST_SETS:
            return -1
        if at == n or tells_better(a, b, minima, o, sets, s, best[SIZE]):
            for k in range(BOUND + 1):
                sets[s + k] = minima[o + k]
            for k in range(6):
                sets[s + SET_SPOT + k] = minima[o + POINTS + k]
            sets[s + SET_ROW], sets[s + SET_PAIRS], sets[s + SET_BRANCH] = i, 0.0, -1.0
        n = max(n, at + 1)
    sort_sets(sets, n)
    return n
