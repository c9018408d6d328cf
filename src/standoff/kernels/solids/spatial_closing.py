"""Closing a pair of leaves: no two of their points on the solids are nearer than a bound."""

from math import inf

from standoff.kernels.algebra.vectors import dot, norm, scale, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
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
    leaf_box,
    leaf_ints,
    leaf_jet,
    leaf_reals,
    natural,
    on_solid,
    outward_normal,
    reach_of,
    trim_state,
)
from standoff.kernels.solids.torus_potential import potential_jet

# What `best` holds: the least distance, how many minima, its leaves and parameters, the least bound
# of what stayed open, 1 where the boundaries meet, and the tolerance, the slack of rounding, the
# size, the tolerance of a tie, and how many boxes are allowed.
LEAST, N_MINIMA, LEAF_A, LEAF_B, AT, OPEN, MET, TOLERANCE, ROUNDING, SIZE, BUDGET = (
    0, 1, 2, 3, 4, 8, 9, 10, 11, 12, 13,
)  # fmt: skip
BEST_REALS = 16
# What a minimum holds: distance, leaves, parameters.
MINIMUM_REALS = 8
MOST_MINIMA = 256
# Pairs of boxes that wait, of 9 numbers each.
PAIR_REALS = 9
MOST_PAIRS = 200
# Radians: faces that join smoothly may differ in their normals by this.
SMOOTH_SPARE = 2e-7
# Shares of 1 / span: the least difference of curvature to both sides that is sought.
MARGINS = (1.0, 0.3, 3.0)


@kernel
def keep(best, minima, leaf_a, leaf_b, q, distance):
    """Keep a pair of points on both solids."""
    if distance < best[LEAST]:
        best[LEAST] = distance
        best[LEAF_A], best[LEAF_B] = leaf_a, leaf_b
        for k in range(4):
            best[AT + k] = q[k]
    most = best[LEAST] + best[TOLERANCE]
    if distance > most:
        return
    n = int(best[N_MINIMA])
    if n >= MOST_MINIMA:
        kept = 0
        for i in range(n):
            if minima[MINIMUM_REALS * i] <= most:
                for k in range(MINIMUM_REALS):
                    minima[MINIMUM_REALS * kept + k] = minima[MINIMUM_REALS * i + k]
                kept += 1
        n = kept
        best[N_MINIMA] = n
        if n >= MOST_MINIMA:
            return
    o = MINIMUM_REALS * n
    minima[o], minima[o + 1], minima[o + 2] = distance, leaf_a, leaf_b
    for k in range(4):
        minima[o + 3 + k] = q[k]
    best[N_MINIMA] = n + 1


@kernel
def held_along(side, leaf, box, jet, toward, u, v):
    """Second derivatives that a slope across the side of a box is worth there."""
    slope_u, slope_v = dot(toward, jet[1]), dot(toward, jet[2])
    wide_u, wide_v = box.u1 - box.u0, box.v1 - box.v0
    mu = 2.0 * abs(slope_u) / wide_u if wide_u > 0.0 and (u <= box.u0 or u >= box.u1) else 0.0
    mv = 2.0 * abs(slope_v) / wide_v if wide_v > 0.0 and (v <= box.v0 or v >= box.v1) else 0.0
    return mu, mv


@kernel
def by_potential(phi, goal, room, a, leaf_a, box_a, b, leaf_b, box_b, q, counts):
    """Does a potential prove that two boxes are `goal` apart? `room` is the part of it that the
    sides get beyond their values at q; below 0 none is left."""
    x, y = leaf_jet(a, leaf_a, q[0], q[1])[0], leaf_jet(b, leaf_b, q[2], q[3])[0]
    low, high = potential_jet(phi, x, 0.0)[0], potential_jet(phi, y, 0.0)[0]
    spare = high - low - goal
    if spare < 0.0:
        return False
    if not proven(phi, 1.0, low + 0.5 * spare, a, leaf_a, box_a, (q[0], q[1]), counts):
        return False
    return proven(phi, -1.0, 0.5 * spare - high, b, leaf_b, box_b, (q[2], q[3]), counts)


@kernel
def by_own_surface(goal, a, leaf_a, b, leaf_b, box_b, q, counts):
    """Does the potential of A's own kind prove that B's box is `goal` from all of A's surface?"""
    known, phi = natural(a, leaf_a)
    return known and proven(phi, -1.0, -goal, b, leaf_b, box_b, q, counts)


@kernel
def by_witness(goal, a, leaf_a, box_a, b, leaf_b, box_b, at, best, counts):
    """Do potentials through a pair of points (leaves and parameters `at`) prove it?"""
    wa, wb, q = at
    ja, jb = leaf_jet(a, wa, q[0], q[1]), leaf_jet(b, wb, q[2], q[3])
    size = best[SIZE]
    n = direction(a, wa, ja, b, wb, jb, 1e-9 * size)
    if norm(n) < 0.5:
        return False
    x, y = ja[0], jb[0]
    here = wa == leaf_a and wb == leaf_b
    plane = plane_between(x, y, n)
    if try_at(plane, goal, a, leaf_a, box_a, b, leaf_b, box_b, q, here, x, y, counts):
        return True
    span = reach_of(a, leaf_a, box_a.u1 - box_a.u0, box_a.v1 - box_a.v0)
    span = max(span, reach_of(b, leaf_b, box_b.u1 - box_b.u0, box_b.v1 - box_b.v0))
    span = max(min(span, size), 1e-6 * size)
    frame = across(n)
    held_a = held_along(a, leaf_a, box_a, ja, n, q[0], q[1]) if here else (0.0, 0.0)
    held_b = held_along(b, leaf_b, box_b, jb, n, q[2], q[3]) if here else (0.0, 0.0)
    sa = shape(a, wa, ja, n, frame, held_a, span)
    sb = shape(b, wb, jb, scale(-1.0, n), frame, held_b, span)
    for k in range(3):
        phi = torus_between(x, y, n, frame, sa, sb, MARGINS[k] / span)
        if try_at(phi, goal, a, leaf_a, box_a, b, leaf_b, box_b, q, here, x, y, counts):
            return True
    return False


@kernel
def try_at(phi, goal, a, leaf_a, box_a, b, leaf_b, box_b, q, here, x, y, counts):
    """By one potential through x and y, whose parameters q are those of the boxes if `here`."""
    low, high = potential_jet(phi, x, 0.0)[0], potential_jet(phi, y, 0.0)[0]
    spare = 0.5 * (high - low - goal)
    if spare < 0.0:
        return False
    pa, pb = (q[0], q[1]), (q[2], q[3])
    if not here:
        pa = (0.5 * (box_a.u0 + box_a.u1), 0.5 * (box_a.v0 + box_a.v1))
        pb = (0.5 * (box_b.u0 + box_b.u1), 0.5 * (box_b.v0 + box_b.v1))
    if not proven(phi, 1.0, low + spare, a, leaf_a, box_a, pa, counts):
        return False
    return proven(phi, -1.0, spare - high, b, leaf_b, box_b, pb, counts)


@kernel
def slanted(side, leaf, box, jet, delta, length, reach):
    """Is no direction from one box to the other normal to a leaf, by its tangents?"""
    o, m = leaf_reals(side, leaf), side.numbers
    hu, hv = 0.5 * (box.u1 - box.u0), 0.5 * (box.v1 - box.v0)
    far = length + reach
    uu, uv, vv = m[o + S.SECOND], m[o + S.SECOND + 1], m[o + S.SECOND + 2]
    for k in range(2):
        tangent = jet[1 + k]
        change = uu * hu + uv * hv if k == 0 else uv * hu + vv * hv
        size = norm(tangent)
        spare = size * reach + (change + SMOOTH_SPARE * size) * far
        if size > 0.0 and abs(dot(tangent, delta)) > spare:
            return True
    return False


@kernel
def no_pair(a, leaf_a, box_a, b, leaf_b, box_b, goal, rounding):
    """(closed, lower bound of the distance) of two boxes by their tangent planes' bounds."""
    qa = (0.5 * (box_a.u0 + box_a.u1), 0.5 * (box_a.v0 + box_a.v1))
    qb = (0.5 * (box_b.u0 + box_b.u1), 0.5 * (box_b.v0 + box_b.v1))
    ja, jb = leaf_jet(a, leaf_a, qa[0], qa[1]), leaf_jet(b, leaf_b, qb[0], qb[1])
    delta = sub(jb[0], ja[0])
    length = norm(delta)
    ha = (0.5 * (box_a.u1 - box_a.u0), 0.5 * (box_a.v1 - box_a.v0))
    hb = (0.5 * (box_b.u1 - box_b.u0), 0.5 * (box_b.v1 - box_b.v0))
    reach = reach_of(a, leaf_a, ha[0], ha[1]) + reach_of(b, leaf_b, hb[0], hb[1])
    if length == 0.0:
        return False, 0.0
    n = scale(1.0 / length, delta)
    low = max(length - reach, 0.0)
    flat = length - along(a, leaf_a, ja, n, ha) - along(b, leaf_b, jb, n, hb)
    low = max(low, flat) - rounding
    if low >= goal:
        return True, low
    if length > reach + rounding and (
        slanted(a, leaf_a, box_a, ja, delta, length, reach)
        or slanted(b, leaf_b, box_b, jb, delta, length, reach)
    ):
        return True, low
    return False, max(low, 0.0)


@kernel
def along(side, leaf, jet, n, h):
    """How far a box reaches from its middle along n, at most."""
    o, m = leaf_reals(side, leaf), side.numbers
    second = m[o + S.SECOND] * h[0] * h[0] + m[o + S.SECOND + 2] * h[1] * h[1]
    second += 2.0 * m[o + S.SECOND + 1] * h[0] * h[1]
    return abs(dot(n, jet[1])) * h[0] + abs(dot(n, jet[2])) * h[1] + 0.5 * second


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
def closed_by_any(a, leaf_a, box_a, b, leaf_b, box_b, best, minima, counts):
    """Is a pair of boxes closed? Nearer points that are found are kept."""
    goal = best[LEAST] - best[TOLERANCE] + best[ROUNDING]
    start = (
        0.5 * (box_a.u0 + box_a.u1),
        0.5 * (box_a.v0 + box_a.v1),
        0.5 * (box_b.u0 + box_b.u1),
        0.5 * (box_b.v0 + box_b.v1),
    )
    q, distance = nearest(a, leaf_a, box_a, b, leaf_b, box_b, start, counts)
    if distance < best[LEAST] + best[TOLERANCE] and (
        on_solid(a, leaf_a, q[0], q[1]) and on_solid(b, leaf_b, q[2], q[3])
    ):
        keep(best, minima, leaf_a, leaf_b, q, distance)
        goal = best[LEAST] - best[TOLERANCE] + best[ROUNDING]
    if best[LEAST] <= best[TOLERANCE]:
        best[MET] = 1.0
        return True
    if by_own_surface(goal, a, leaf_a, b, leaf_b, box_b, (q[2], q[3]), counts):
        return True
    if by_own_surface(goal, b, leaf_b, a, leaf_a, box_a, (q[0], q[1]), counts):
        return True
    if distance >= goal and by_witness(
        goal, a, leaf_a, box_a, b, leaf_b, box_b, (leaf_a, leaf_b, q), best, counts
    ):
        return True
    wa, wb = int(best[LEAF_A]), int(best[LEAF_B])
    if wa == leaf_a and wb == leaf_b and distance >= goal:
        return False
    at = (best[AT], best[AT + 1], best[AT + 2], best[AT + 3])
    return by_witness(goal, a, leaf_a, box_a, b, leaf_b, box_b, (wa, wb, at), best, counts)


@kernel
def close_leaves(a, leaf_a, b, leaf_b, best, minima, work, counts):
    """Close a pair of leaves, cutting it where it has to be; what stays open lowers best[OPEN]."""
    put_pair(work, 0, leaf_box(a, leaf_a), leaf_box(b, leaf_b), 0.0)
    count = 1
    while count > 0 and best[MET] == 0.0:
        count -= 1
        o = PAIR_REALS * count
        box_a = S.Box(work[o], work[o + 1], work[o + 2], work[o + 3])
        box_b = S.Box(work[o + 4], work[o + 5], work[o + 6], work[o + 7])
        goal = best[LEAST] - best[TOLERANCE] + best[ROUNDING]
        done, low = no_pair(a, leaf_a, box_a, b, leaf_b, box_b, goal, best[ROUNDING])
        low = max(low, work[o + 8])
        if done:
            continue
        if counts[0] > best[BUDGET] or count >= MOST_PAIRS - 2:
            best[OPEN] = min(best[OPEN], low)
            continue
        if (
            trim_state(a, leaf_a, box_a) == OUTSIDE_TRIM
            or trim_state(b, leaf_b, box_b) == OUTSIDE_TRIM
        ):
            continue
        if closed_by_any(a, leaf_a, box_a, b, leaf_b, box_b, best, minima, counts):
            continue
        counts[4] += 1
        au, av = widths(a, leaf_a, box_a)
        bu, bv = widths(b, leaf_b, box_b)
        if max(max(au, av), max(bu, bv)) <= 1e-9 * best[SIZE]:
            best[OPEN] = min(best[OPEN], low)
        elif max(au, av) >= max(bu, bv):
            first, second = split(box_a, au >= av)
            put_pair(work, count, first, box_b, low)
            put_pair(work, count + 1, second, box_b, low)
            count += 2
        else:
            first, second = split(box_b, bu >= bv)
            put_pair(work, count, box_a, first, low)
            put_pair(work, count + 1, box_a, second, low)
            count += 2
