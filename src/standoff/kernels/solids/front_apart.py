"""Rows that are not held after a frame's looks: what else shows that the solids do not come
together in them."""

from standoff.kernels.algebra.vectors import add, norm, rotate, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids.front_close import cut_of_b, cut_row
from standoff.kernels.solids.front_held import hold_on, is_held
from standoff.kernels.solids.front_look import (
    cut_nodes,
    look_at_leaves,
    look_at_nodes,
    parts_of_row,
)
from standoff.kernels.solids.front_motion import half_sine_between, own_of
from standoff.kernels.solids.front_rows import (
    CUT,
    FRAME,
    N_AWAKE,
    ROW_A,
    ROW_FRAME,
    ROW_REALS,
    ROW_WAY,
    awake_row,
    start_of_row,
)
from standoff.kernels.solids.over_plane import feet_of, has_sides, not_over, plane_of
from standoff.kernels.solids.spatial_progress import (
    BOXES,
    BUDGET,
    MET,
    ROUNDING,
    ball_round,
    evaluations,
)

# Looks at a row that is not held, in one frame, each after a cut of B's part; and at all such rows.
MOST_LOOKS, MOST_REPAIRS = 16, 128


@kernel
def not_reached(face, part, moved, best, counts):
    """Does a part not come to a plane's face from above while it moves by so much, as the plane
    sees it?"""
    if not has_sides(face, part):
        return False
    counts[BOXES] += 1
    jet, n = plane_of(face)
    return not_over(face, feet_of(jet, n, part), 0.0, best[ROUNDING] + moved)


@kernel
def hold_off_planes(pa, pb, front, k, travel, best, counts):
    """Hold a pair of leaves' parts by a plane's face that the other part does not come to; how far
    B's part moves in this frame, length."""
    x, reach = ball_round(pa)
    y, radius = ball_round(pb)
    was = add(rotate(travel.last.R, own_of(travel.pose, y)), travel.last.p)
    shift, far = norm(sub(y, was)), norm(sub(y, x)) + reach
    turn = 2.0 * half_sine_between(travel.last_turn, travel.quaternion)
    # the way bends a little
    arc = travel.step * travel.step / (8.0 * travel.radius)
    spare = travel.spare + 2.0 * arc * (1.0 + far / travel.radius)
    moved = shift + turn * radius + spare
    reached = not not_reached(pa, pb, moved, best, counts)
    if reached and not_reached(pb, pa, shift + turn * far + spare, best, counts):
        reached = False
    if not reached:
        hold_on(front, k, 0.0, 1.0, travel)
    return moved, radius


@kernel
def hold_leaves(a, b, front, row, travel, best, minima, counts):
    """Look at a pair of leaves' parts, or cut it; may more be known after it? row: which, and
    whether it was looked at."""
    k, looked = row
    pa, pb = parts_of_row(a, b, front, k)
    moved, radius = hold_off_planes(pa, pb, front, k, travel, best, counts)
    if is_held(front, k, travel.gone, travel):
        return False
    if not looked:
        look_at_leaves(a, b, front, k, travel, best, minima, counts)
        return True
    q = start_of_row(front, k)
    if front.rows[ROW_REALS * k + ROW_WAY] < 0.0:
        return cut_row(front, k, (pa, pb, q, 0.0), best)
    # the shorter B's part is, the less the slope of a potential differs over it
    return radius > 0.5 * moved and cut_of_b(front, k, pa, pb, q)


@kernel
def hold_row(a, b, front, k, travel, best, minima, counts):
    """Look at a row until it is held; is it?"""
    looked = front.rows[ROW_REALS * k + ROW_FRAME] == front.store[FRAME]
    for _ in range(MOST_LOOKS):
        if is_held(front, k, travel.gone, travel):
            return True
        if best[MET] > 0.0 or evaluations(counts) > best[BUDGET]:
            return False
        if front.rows[ROW_REALS * k + ROW_A] < 0.0:
            if looked and not cut_nodes(a, b, front, k):
                break
            looked = not looked and look_at_nodes(a, b, front, k, travel, best, counts) != CUT
        elif hold_leaves(a, b, front, (k, looked), travel, best, minima, counts):
            looked = not looked
        else:
            break
    return is_held(front, k, travel.gone, travel)


@kernel
def hold_all(a, b, front, travel, best, minima, counts):
    """Look at all rows that are not held, and their parts, until they are; are they?"""
    i, looks = 0, 0
    while i < int(front.store[N_AWAKE]):
        k = awake_row(front, i)
        i += 1
        if not is_held(front, k, travel.gone, travel):
            looks += 1
            if looks > MOST_REPAIRS or not hold_row(a, b, front, k, travel, best, minima, counts):
                return False
    return True
