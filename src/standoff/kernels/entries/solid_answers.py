"""What a frame of two solids on a block of memory tells: its answer, and its local minima."""

from math import inf

from standoff.kernels.algebra.rigid import read_rotation, read_vector
from standoff.kernels.algebra.vectors import add, norm, rotate, scale, sub
from standoff.kernels.compiler.decorators import ahead, kernel
from standoff.kernels.entries import solid_blocks as B
from standoff.kernels.entries import tracked_solids as T
from standoff.kernels.solids.contact_frame import AT_NORMALS, AT_SETS
from standoff.kernels.solids.contact_places import P_FELT, place_at
from standoff.kernels.solids.contact_proof import parts_pieces
from standoff.kernels.solids.front_motion import put_three
from standoff.kernels.solids.minima_sets import SET_BRANCH, SET_REALS, SET_ROW, points_of
from standoff.kernels.solids.patch import normal_of
from standoff.kernels.solids.point_depth import ask_search
from standoff.kernels.solids.spatial_pieces import ZERO, leaf_jet
from standoff.kernels.solids.spatial_progress import (
    ABOVE,
    AT,
    BOUND,
    LEAF_A,
    LEAF_B,
    LEAST,
    LOST,
    MINIMUM_REALS,
    MOST_MINIMA,
    TOLERANCE,
    evaluations,
)
from standoff.kernels.state.arrays import CONVERGED, DEADLINE, OVERLAPPING


@kernel
def minimum_at(k):
    return B.MINIMA + B.M_REALS * k


@kernel
def put_minimum(g, k, row, o, x, y, n):
    """The k-th local minimum, of a row with distance, leaves and parameters, and points of A's
    frame."""
    s, m = g.block, minimum_at(k)
    R, p = read_rotation(s, B.POSES), read_vector(s, B.POSES + 9)
    s[m + B.M_DISTANCE], s[m + B.M_KEY], s[m + B.M_FELT] = row[o], -1.0, 1.0
    s[m + B.M_LEAVES], s[m + B.M_LEAVES + 1] = row[o + 1], row[o + 2]
    for i in range(4):
        s[m + B.M_PARAMETERS + i] = row[o + 3 + i]
    put_three(s, m + B.M_A, add(rotate(R, x), p))
    put_three(s, m + B.M_B, add(rotate(R, y), p))
    put_three(s, m + B.M_NORMAL, rotate(R, n))


@kernel
def way_between(x, y):
    away = sub(y, x)
    length = norm(away)
    return scale(1.0 / length, away) if length > 0.0 else ZERO


@kernel
def put_answer(g, status, lower, upper):
    out = ahead(g.block, B.ANSWER)
    for k in range(B.A_REALS):
        out[k] = 0.0
    out[B.A_STATUS] = status
    out[B.A_LOWER], out[B.A_UPPER] = lower - g.asked[B.Q_SLACK], upper + g.asked[B.Q_SLACK]
    out[B.A_EVALUATIONS], out[B.A_N_MINIMA] = evaluations(g.counts), 1.0
    return out


@kernel
def tell_nearest(g, best, a, b):
    """The nearest points that a search has found, as the only minimum."""
    row, leaves = ahead(g.block, B.W_TOLD), (int(best[LEAF_A]), int(best[LEAF_B]))
    x = leaf_jet(a, leaves[0], best[AT], best[AT + 1])[0]
    y = leaf_jet(b, leaves[1], best[AT + 2], best[AT + 3])[0]
    row[0], row[1], row[2] = best[LEAST], leaves[0], leaves[1]
    for k in range(4):
        row[3 + k] = best[AT + k]
    put_minimum(g, 0, row, 0, x, y, way_between(x, y))


@kernel
def tell_sets(g, n, lower):
    """The local minima of a frame in which the solids are apart."""
    minima, sets = ahead(g.block, B.W_MINIMA), ahead(g.block, B.W_SETS)
    slack = g.asked[B.Q_SLACK]
    for k in range(n):
        s, m = SET_REALS * k, minimum_at(k)
        x, y = points_of(minima, MINIMUM_REALS * int(sets[s + SET_ROW]))
        put_minimum(g, k, sets, s, x, y, way_between(x, y))
        g.block[m + B.M_LOWER] = min(max(lower, sets[s + BOUND]), sets[s]) - slack
        g.block[m + B.M_KEY] = sets[s + SET_BRANCH]


@kernel
def tell_apart(g, sides, n, inside):
    """The answer of the last frame of the front, with n local minima; -1: not known."""
    s = g.block
    best, told = ahead(s, B.BEST), ahead(s, B.W_TOLD)
    ended, low, distance = told[T.ENDED], told[T.BOUND], told[T.DISTANCE]
    anew = told[T.ANEW]
    if low <= 0.0:  # what stays open may be that the boundaries meet
        low = -inf
    proven = ended != T.INTERVAL and not (best[ABOVE] > 0.0 and best[LOST] > 0.0)
    if proven:
        status = B.CONTAINED if inside > 0 else CONVERGED
    else:
        late = evaluations(g.counts) > g.asked[B.Q_DEADLINE]
        status = DEADLINE if late else B.WITHIN
    out = put_answer(g, status, low, distance)
    out[B.A_INSIDE], out[B.A_ANEW] = inside, anew
    out[B.A_SINGLE] = 1.0 if proven and ended == T.SINGLE else 0.0
    out[B.A_COMPLETE] = 1.0 if proven and n >= 0 else 0.0
    if n > 0:
        tell_sets(g, n, low)
        out[B.A_N_MINIMA] = n
    else:
        tell_nearest(g, best, sides[0], sides[1])
        s[minimum_at(0) + B.M_LOWER] = out[B.A_LOWER]
    s[minimum_at(0) + B.M_DISTANCE] = distance


@kernel
def tell_unproven(g, best, a, b):
    """The answer where neither is proven: the distance of the boundaries is an upper bound."""
    out = put_answer(g, B.WITHIN, -inf, best[LEAST])
    if best[LEAST] < inf:
        tell_nearest(g, best, a, b)
    else:
        out[B.A_N_MINIMA] = 0.0
    g.block[minimum_at(0) + B.M_LOWER] = -inf


@kernel
def bound_of_place(g, both, k):
    """A lower bound of the signed distance of both leaves at a minimum: B, moved by as much along
    the normal, is proven not to meet A there; -inf: not proven."""
    room, s = ahead(g.block, B.W_ROOM), SET_REALS * k
    asked, sets = room, ahead(room, AT_SETS)
    best, minima = ahead(g.block, B.W_BEST), ahead(g.block, B.W_MINIMA)
    size = g.a.size + g.b.size
    ask_search(
        best, size, norm(g.pose.p), g.asked[B.Q_FRAME + 1], asked[TOLERANCE], g.asked[B.Q_IN_TIME]
    )
    best[ABOVE], best[MOST_MINIMA] = asked[ABOVE], B.MOST_LOCAL
    o = AT_NORMALS + MINIMUM_REALS * int(sets[s + SET_ROW])
    q = (room[o + 3], room[o + 4], room[o + 5], room[o + 6])
    leaves, n = (int(room[o + 1]), int(room[o + 2])), normal_of(room, o)
    by = parts_pieces(both.a, both.b, leaves, (q, n, room[o]), best, minima, g.probe.counts)
    return -by if by > 0.0 else -inf


@kernel
def tell_place(g, both, k, at, felt):
    """A place of a contact as the minimum of a number."""
    room, s = ahead(g.block, B.W_ROOM), SET_REALS * k
    sets, m = ahead(room, AT_SETS), minimum_at(at)
    o = AT_NORMALS + MINIMUM_REALS * int(sets[s + SET_ROW])
    x, y = points_of(room, o)
    put_minimum(g, at, sets, s, x, y, normal_of(room, o))
    low = bound_of_place(g, both, k) if sets[s] < 0.0 else -inf
    g.block[m + B.M_LOWER] = min(low, sets[s]) - g.asked[B.Q_SLACK]
    g.block[m + B.M_KEY] = sets[s + SET_BRANCH]
    g.block[m + B.M_FELT] = 1.0 if felt else 0.0


@kernel
def tell_overlap(g, both, met):
    """The answer of a frame of a contact in which a depth is proven: the deepest place that is
    felt; where local minima are asked, all that are, those that are no overlap, and the other ways
    out."""
    n, first = met.n, met.first
    room = ahead(g.block, B.W_ROOM)
    sets, kept = ahead(room, AT_SETS), ahead(g.block, B.CONTACT)
    out = put_answer(g, OVERLAPPING, -norm(met.way), -met.depth)
    tell_place(g, both, first, 0, True)
    distance = min(-met.depth, sets[SET_REALS * first])
    count, most = 1, g.asked[B.Q_FRAME + 2] - g.asked[B.Q_FRAME + 3]
    if g.asked[B.Q_FRAME + 2] > 0.0:
        out[B.A_COMPLETE] = 1.0 if room[LOST] == 0.0 else 0.0
        for turn in range(3):
            for k in range(n):
                d, felt = sets[SET_REALS * k], kept[place_at(k) + P_FELT] > 0.0
                kind = 1 if 0.0 <= d <= most else (3 if d >= 0.0 else (0 if felt else 2))
                if kind == turn and k != first:
                    tell_place(g, both, k, count, felt or kind == 1)
                    count += 1
    out[B.A_N_MINIMA] = count
    g.block[minimum_at(0) + B.M_DISTANCE] = distance
