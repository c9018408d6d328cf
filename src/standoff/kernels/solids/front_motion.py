"""What a row's own motion has left of its bounds, since B was as it was when they were proven.

A bound that a potential proved is lessened only by how far B's piece has moved against the
potential's slope, and by what the slope bends away from its value in the middle of the piece.
"""

from math import asin, inf

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import add, dot, norm, rotate, scale, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids.front_rows import (
    KEY_REALS,
    ROW_BEND,
    ROW_CENTRE,
    ROW_FAR,
    ROW_FREE,
    ROW_GOAL,
    ROW_LOW,
    ROW_RADIUS,
    ROW_REALS,
    ROW_ROOM,
    ROW_SLOPE,
    ROW_TURN,
    ROW_WAS,
)
from standoff.kernels.solids.spatial_pieces import ZERO
from standoff.kernels.solids.torus_potential import SCREW_OF, potential_jet

# Shifts for which a potential's slope is told: the greatest of so many, each this part of the one
# before, up to which it does not bend too much.
MOST_ROOMS, LESS_ROOM = 3, 0.25


@kernel
def put_three(r, o, x):
    r[o], r[o + 1], r[o + 2] = x[0], x[1], x[2]


@kernel
def three_at(r, o):
    return (r[o], r[o + 1], r[o + 2])


@kernel
def own_of(pose, x):
    """A point of B, in B's frame."""
    R, d = pose.R, sub(x, pose.p)
    return (
        R[0] * d[0] + R[3] * d[1] + R[6] * d[2],
        R[1] * d[0] + R[4] * d[1] + R[7] * d[2],
        R[2] * d[0] + R[5] * d[1] + R[8] * d[2],
    )


@kernel
def mark_place(front, k, centre, radius, far, travel):
    """Write down where B's piece of a row is, in a ball, and how far A's reaches from its centre;
    nothing is proven of the row yet."""
    o, r = ROW_REALS * k, front.rows
    put_three(r, o + ROW_CENTRE, own_of(travel.pose, centre))
    put_three(r, o + ROW_WAS, centre)
    r[o + ROW_RADIUS], r[o + ROW_FAR] = radius, far
    for i in range(4):
        r[o + ROW_TURN + i] = travel.quaternion[i]
    r[o + ROW_LOW], r[o + ROW_FREE] = -inf, -inf


@kernel
def mark_bound(front, k, low, slope, bend, room):
    """A bound of a row, the slope it was proven along, and how much that bends per length."""
    o, r = ROW_REALS * k, front.rows
    if low <= r[o + ROW_LOW]:
        return
    r[o + ROW_LOW], r[o + ROW_BEND], r[o + ROW_ROOM] = low, bend, room
    put_three(r, o + ROW_SLOPE, slope)


@kernel
def mark_shut(front, k, free, goal):
    """For how much motion a row was shut, and for goals up to which."""
    o, r = ROW_REALS * k, front.rows
    r[o + ROW_FREE], r[o + ROW_GOAL] = free, goal


@kernel
def slope_of(phi, sign, centre, radius, room):
    """(slope, by how much it bends per length, for which shift) of a potential in a ball of the
    radius, and `room` more; less where that bends too much."""
    if phi.kind == SCREW_OF:  # it does not serve everywhere
        return ZERO, inf, 0.0
    for _ in range(MOST_ROOMS):
        _, g, _, k1, k2 = potential_jet(phi, centre, radius + room)
        if (k1 + k2) * (radius + 0.5 * room) < 1.0:
            return scale(sign, g), k1 + k2, room
        room *= LESS_ROOM
    return ZERO, inf, 0.0


@kernel
def half_sine(r, o, q):
    """Of half the angle of B's turn since."""
    return half_sine_between((r[o], r[o + 1], r[o + 2], r[o + 3]), q)


@kernel
def half_sine_between(p, q):
    """Of half the angle from one turn to another one, both as quaternions."""
    w, v = p[0], (p[1], p[2], p[3])
    x = q[0] * v[0] - w * q[1] + v[1] * q[3] - v[2] * q[2]
    y = q[0] * v[1] - w * q[2] + v[2] * q[1] - v[0] * q[3]
    z = q[0] * v[2] - w * q[3] + v[0] * q[2] - v[1] * q[1]
    return min(sqrt(x * x + y * y + z * z), 1.0)


@kernel
def moved_since(front, k, pose, quaternion):
    """(shift of the middle of B's piece since a row was looked at, sine of half the turn), with B
    at a pose."""
    o, r = ROW_REALS * k, front.rows
    centre = add(rotate(pose.R, three_at(r, o + ROW_CENTRE)), pose.p)
    return sub(centre, three_at(r, o + ROW_WAS)), half_sine(r, o + ROW_TURN, quaternion)


@kernel
def lost_along(front, k, shift, swing):
    """What a bound has lost by a motion against the slope it was proven along; `swing`: what the
    turn moves points of B's piece by, at most."""
    o, r = ROW_REALS * k, front.rows
    against, moved = swing - dot(three_at(r, o + ROW_SLOPE), shift), norm(shift) + swing
    return against + r[o + ROW_BEND] * (r[o + ROW_RADIUS] + 0.5 * moved) * moved


@kernel
def carry_row(front, k, goal, travel):
    """Bound and shut of a row anew, by its own motion since it was looked at; shut for pairs up to
    `goal`."""
    o, r = ROW_REALS * k, front.rows
    low, free = r[o + ROW_LOW], r[o + ROW_FREE]
    if low == -inf and free == -inf:
        return
    shift, sine = moved_since(front, k, travel.pose, travel.quaternion)
    swing = 2.0 * sine * r[o + ROW_RADIUS] + travel.spare
    moved = norm(shift) + swing
    if low > -inf:
        lost = lost_along(front, k, shift, swing) if moved <= r[o + ROW_ROOM] else moved
        key = low - min(lost, moved) + travel.gone
        front.keys[KEY_REALS * k] = max(front.keys[KEY_REALS * k], key)
    left = r[o + ROW_GOAL] - goal
    if free <= 0.0 or left < 0.0:
        return
    if left == inf:  # by normals and tangents: the middle's shift and the turn count
        free -= max(norm(shift) + travel.spare, 2.0 * asin(sine) * travel.radius)
    else:  # by a plane, which may be B's and then sees A's piece move
        far = norm(shift) + 2.0 * sine * r[o + ROW_FAR] + travel.spare
        free = min((free - max(moved, far)) / travel.afar, left)
    front.keys[KEY_REALS * k + 1] = max(front.keys[KEY_REALS * k + 1], free + travel.gone)
