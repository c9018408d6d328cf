"""Local minima in a frame: Newton's method in all pairs of leaves that may hold one.

What is proven of a pair that is farther apart than the nearest points is no more than without them,
so that minima cost a frame little; each has the bound that its pair of pieces has.
"""

from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids.front_branches import steepest_side
from standoff.kernels.solids.front_close import LEAVES_AHEAD, keep_proven
from standoff.kernels.solids.front_look import bound_leaves, descend, look_at_nodes, parts_of_row
from standoff.kernels.solids.front_motion import carry_row
from standoff.kernels.solids.front_rows import (
    CUT,
    KEPT,
    KEY_REALS,
    N_DUE,
    OPEN_ROW,
    RESTS_TO,
    ROW_A,
    ROW_REALS,
    ROW_WAY,
    due_row,
    is_due,
    open_up,
)
from standoff.kernels.solids.spatial_closing import FEW_BOXES, aimed, closed_to
from standoff.kernels.solids.spatial_progress import (
    ABOVE,
    BUDGET,
    LOST,
    MET,
    ROUNDING,
    at_cut,
    evaluations,
    farthest,
    keep,
    on_both,
)
from standoff.kernels.solids.spatial_tolerances import HELD_SLOPE

# Of the motion that could level a slope.
RESTS = 0.25


@kernel
def find_minima(a, b, front, travel, best, minima, counts):
    """Keep the local minima below best[ABOVE], at most one of each pair of parts. What there
    is no time for counts as lost."""
    i = 0
    while i < int(front.store[N_DUE]) and best[MET] == 0.0:
        told, k = KEPT, due_row(front, i)
        rests = front.keys[KEY_REALS * k + RESTS_TO] > travel.gone
        if not rests and is_due(front, k, farthest(best), travel):
            carry_row(front, k, farthest(best) + best[ROUNDING], travel)
        if not rests and is_due(front, k, farthest(best), travel):
            if evaluations(counts) > best[BUDGET]:
                best[LOST] += 1.0
                return
            open_up(front, k)
            if front.rows[ROW_REALS * k + ROW_A] < 0.0:
                told = look_at_nodes(a, b, front, k, travel, best, counts)
            else:
                told = find_in_leaves(a, b, front, k, travel, best, minima, counts)
        if told != CUT:
            i += 1


@kernel
def find_in_leaves(a, b, front, k, travel, best, minima, counts):
    """Newton's method in a pair of leaves' parts. What turns out to be farther apart than is asked
    rests, if a potential proves it."""
    told, ball = bound_leaves(a, b, front, k, farthest(best), travel, best, counts)
    if told != OPEN_ROW:
        return told
    pa, pb = parts_of_row(a, b, front, k)
    q, distance = descend(a, b, front, k, best, minima, counts)
    rest_at_side(front, k, pa, pb, q, distance, travel)
    if distance <= farthest(best) and is_level_at_cut(pa, pb, q) and on_both(pa, pb, q):
        keep(best, minima, pa, pb, q, distance)
    goal = best[ABOVE] + best[ROUNDING]
    if best[MET] > 0.0 or distance <= goal:
        return KEPT
    aim = aimed(goal, distance, LEAVES_AHEAD * travel.ahead)
    pair = (pa, pb, q, distance)
    way, phi = closed_to(aim, -1, pair, FEW_BOXES, best, minima, counts)
    if way >= 0:
        keep_proven(front, k, aim, way, phi, ball, travel, best)
        front.rows[ROW_REALS * k + ROW_WAY] = way
    return KEPT


@kernel
def rest_at_side(front, k, a, b, q, distance, travel):
    """A row where Newton's method came to a side beyond which the points are nearer rests for a
    part of the motion that could level the slope there: by a motion m the direction between two
    points turns by m over their distance, and B's tangents by m over B's radius. Branches are
    followed all the same; with patches no row rests, as its points may be one's corner."""
    sine = steepest_side(a, b, q, False)[0]
    if travel.wider == 0.0 and sine > HELD_SLOPE and distance > 0.0:
        far = RESTS * sine / (1.0 / distance + travel.turn)
        front.keys[KEY_REALS * k + RESTS_TO] = travel.gone + far


@kernel
def is_level_at_cut(a, b, q):
    """Is a pair at a side where a leaf was cut, and no nearer along any way across such a side? It
    is then a minimum of the parts on both sides, which `keep_found` leaves out."""
    if not (at_cut(a, q[0], q[1]) or at_cut(b, q[2], q[3])):
        return False
    return steepest_side(a, b, q, True)[0] <= HELD_SLOPE
