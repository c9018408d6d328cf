"""What a row's own motion has left of its bounds, since B was as it was when they were proven.

A bound that a potential proved is lessened only by how far B's piece has moved against the
potential's slope, and by what the slope may differ from its value in the middle of the piece.
"""

from math import asin, inf

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import add, dot, norm, rotate, scale, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids.front_rows import (
    KEY_REALS,
    ROW_CENTRE,
    ROW_FAR,
    ROW_FREE,
    ROW_GOAL,
    ROW_LOW,
    ROW_RADIUS,
    ROW_REALS,
    ROW_ROOM,
    ROW_SLOPE,
    ROW_SPREAD,
    ROW_TURN,
    ROW_WAS,
)
from standoff.kernels.solids.spatial_pieces import ZERO
from standoff.kernels.solids.torus_potential import SCREW_OF, potential_jet


@kernel
def put_three(r, o, x):
    r[o], r[o + 1], r[o + 2] = x[0], x[1], x[2]


@kernel
def three_at(r, o):
    return (r[o], r[o + 1], r[o + 2])


@kernel
def mark_place(front, k, centre, radius, far, travel):
    """Write down where B's piece of a row is, in a ball, and how far A's reaches from its centre;
    nothing is proven of the row yet."""
    o, r = ROW_REALS * k, front.rows
    R, p = travel.pose.R, travel.pose.p
    d = sub(centre, p)
    own = (
        R[0] * d[0] + R[3] * d[1] + R[6] * d[2],
        R[1] * d[0] + R[4] * d[1] + R[7] * d[2],
        R[2] * d[0] + R[5] * d[1] + R[8] * d[2],
    )
    put_three(r, o + ROW_CENTRE, own)
    put_three(r, o + ROW_WAS, centre)
    r[o + ROW_RADIUS], r[o + ROW_FAR] = radius, far
    for i in range(4):
        r[o + ROW_TURN + i] = travel.quaternion[i]
    r[o + ROW_LOW], r[o + ROW_FREE] = -inf, -inf


@kernel
def mark_bound(front, k, low, slope, spread, room):
    """A bound of a row, and the slope it was proven along."""
    o, r = ROW_REALS * k, front.rows
    if low <= r[o + ROW_LOW]:
        return
    r[o + ROW_LOW], r[o + ROW_SPREAD], r[o + ROW_ROOM] = low, spread, room
    put_three(r, o + ROW_SLOPE, slope)


@kernel
def mark_shut(front, k, free, goal):
    """For how much motion a row was shut, and for goals up to which."""
    o, r = ROW_REALS * k, front.rows
    r[o + ROW_FREE], r[o + ROW_GOAL] = free, goal


@kernel
def slope_of(phi, sign, centre, radius, room):
    """(slope, by how much it may differ) of a potential in a ball of the radius and `room` more."""
    if phi.kind == SCREW_OF:  # it does not serve everywhere
        return ZERO, 1.0
    _, g, _, k1, k2 = potential_jet(phi, centre, radius + room)
    spread = (k1 + k2) * (radius + room)
    if not spread < 1.0:
        return ZERO, 1.0
    return scale(sign, g), spread


@kernel
def half_sine(r, o, q):
    """Of half the angle of B's turn since."""
    w, v = r[o], three_at(r, o + 1)
    x = q[0] * v[0] - w * q[1] + v[1] * q[3] - v[2] * q[2]
    y = q[0] * v[1] - w * q[2] + v[2] * q[1] - v[0] * q[3]
    z = q[0] * v[2] - w * q[3] + v[0] * q[2] - v[1] * q[1]
    return min(sqrt(x * x + y * y + z * z), 1.0)


@kernel
def carry_row(front, k, goal, travel):
    """Bound and shut of a row anew, by its own motion since it was looked at; shut for pairs up to
    `goal`."""
    o, r = ROW_REALS * k, front.rows
    low, free = r[o + ROW_LOW], r[o + ROW_FREE]
    if low == -inf and free == -inf:
        return
    centre = add(rotate(travel.pose.R, three_at(r, o + ROW_CENTRE)), travel.pose.p)
    shift = sub(centre, three_at(r, o + ROW_WAS))
    sine = half_sine(r, o + ROW_TURN, travel.quaternion)
    swing = 2.0 * sine * r[o + ROW_RADIUS] + travel.spare
    moved = norm(shift) + swing
    if low > -inf:
        against, spread = swing - dot(three_at(r, o + ROW_SLOPE), shift), r[o + ROW_SPREAD]
        lost = against + spread * moved if moved <= r[o + ROW_ROOM] else moved
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
