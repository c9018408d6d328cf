"""Local minima in a frame: Newton's method in all pairs of leaves that may hold one.

What is proven of a pair that is farther apart than the nearest points is no more than without them,
so that minima cost a frame little; each has the bound that its pair of pieces has.
"""

from standoff.kernels.algebra.vectors import dot, norm, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids.front_close import LEAVES_AHEAD, keep_proven
from standoff.kernels.solids.front_look import bound_leaves, descend, look_at_nodes, parts_of_row
from standoff.kernels.solids.front_motion import carry_row
from standoff.kernels.solids.front_rows import (
    KEPT,
    N_ROWS,
    OPEN_ROW,
    ROW_A,
    ROW_REALS,
    ROW_WAY,
    is_due,
    open_up,
)
from standoff.kernels.solids.spatial_closing import FEW_BOXES, aimed, closed_to
from standoff.kernels.solids.spatial_pieces import leaf_box, leaf_jet
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


@kernel
def find_minima(a, b, front, travel, best, minima, counts):
    """Keep the local minima below best[ABOVE], at most one of each pair of parts. What there
    is no time for counts as lost."""
    k = 0
    while k < int(front.store[N_ROWS]) and best[MET] == 0.0:
        told = KEPT
        if is_due(front, k, farthest(best), travel):
            carry_row(front, k, farthest(best) + best[ROUNDING], travel)
        if is_due(front, k, farthest(best), travel):
            if evaluations(counts) > best[BUDGET]:
                best[LOST] += 1.0
                return
            open_up(front, k)
            if front.rows[ROW_REALS * k + ROW_A] < 0.0:
                told = look_at_nodes(a, b, front, k, travel, best, counts)
            else:
                told = find_in_leaves(a, b, front, k, travel, best, minima, counts)
        if told == KEPT:
            k += 1


@kernel
def find_in_leaves(a, b, front, k, travel, best, minima, counts):
    """Newton's method in a pair of leaves' parts. What turns out to be farther apart than is asked
    rests, if a potential proves it."""
    told, ball = bound_leaves(a, b, front, k, farthest(best), travel, best, counts)
    if told != OPEN_ROW:
        return told
    pa, pb = parts_of_row(a, b, front, k)
    q, distance = descend(a, b, front, k, best, minima, counts)
    if distance <= farthest(best) and is_level_at_cut(pa, pb, q, distance) and on_both(pa, pb, q):
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
def is_level_at_cut(a, b, q, distance):
    """Is a pair at a side where a leaf was cut, and no nearer along any way across such a side? It
    is then a minimum of the parts on both sides, which `keep_found` leaves out."""
    if not (at_cut(a, q[0], q[1]) or at_cut(b, q[2], q[3])):
        return False
    ja, jb = leaf_jet(a.side, a.leaf, q[0], q[1]), leaf_jet(b.side, b.leaf, q[2], q[3])
    delta = sub(jb[0], ja[0])
    for i in range(4):
        part, jet = (a, ja) if i < 2 else (b, jb)
        u, v = (q[0], q[1]) if i < 2 else (q[2], q[3])
        box, whole = part.box, leaf_box(part.side, part.leaf)
        if i % 2 == 0:
            held = (u <= box.u0 and box.u0 > whole.u0) or (u >= box.u1 and box.u1 < whole.u1)
        else:
            held = (v <= box.v0 and box.v0 > whole.v0) or (v >= box.v1 and box.v1 < whole.v1)
        tangent = jet[1 + i % 2]
        if held and abs(dot(delta, tangent)) > HELD_SLOPE * norm(tangent) * distance:
            return False
    return True
