"""Sharper bounds where a potential is nearly constant along a piece, as of a peg in its hole.

Let psi be a potential moved by a small rigid motion, so that psi is constant over a piece, as it is
the piece's own, or along it, as both turn about one axis. Then derivatives of phi over the piece
are those of phi - psi, which are small: a motion that moves points by e and turns by w changes the
k-th derivative by at most e |D^(k+1) phi| + k w |D^k phi|.
"""

from math import inf

from standoff.kernels.algebra.vectors import axpy, cross, dot, norm, rotate, scale, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import edge_record
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_pieces import ZERO, leaf_ints, leaf_reals
from standoff.kernels.solids.spatial_tolerances import SAME_NUMBER
from standoff.kernels.solids.torus_potential import (
    AXIS_OF,
    CENTRE_OF,
    CIRCLE_OF,
    CONE_OF,
    SCREW_OF,
    THIRD,
    potential_jet,
)

# An angle below a quarter turn is at most this times its sine.
OVER_SINE = 1.5708


@kernel
def moved_line(side, o):
    """(point, axis) of numbers[o:] in A's frame."""
    m, R, p = side.numbers, side.pose.R, side.pose.p
    point = rotate(R, (m[o], m[o + 1], m[o + 2]))
    axis = rotate(R, (m[o + 3], m[o + 4], m[o + 5]))
    return (point[0] + p[0], point[1] + p[1], point[2] + p[2]), axis


@kernel
def own_kind(side, leaf):
    """The kind of a face's own potential; of an edge, of a round face that it bounds."""
    r = leaf_ints(side, leaf)
    dim = side.own[r + S.DIM]
    if dim == 2:
        return side.own[r + S.NATURAL]
    return side.own[r + S.LIST] if dim == 1 else -1


@kernel
def turning(side, leaf):
    """(known, point, axis) of the axis about which a leaf's parameter u turns it."""
    r = leaf_ints(side, leaf)
    dim, kind = side.own[r + S.DIM], own_kind(side, leaf)
    made = side.own[r + S.NATURAL]
    if made == S.TURNED or (dim == 2 and kind in (AXIS_OF, CONE_OF, CIRCLE_OF)):
        point, axis = moved_line(side, leaf_reals(side, leaf) + S.NATURAL_REALS + 3)
        return True, point, axis
    if made == S.ROUND_ARC:
        e = edge_record(side.ints, side.own[r + S.FEATURE])
        o = side.ints[e + L.EDGE_REALS] + L.CURVE_DATA
        m, R, p = side.reals, side.pose.R, side.pose.p
        point = rotate(R, (m[o + 9], m[o + 10], m[o + 11]))
        first = rotate(R, (m[o], m[o + 3], m[o + 6]))
        other = rotate(R, (m[o + 1], m[o + 4], m[o + 7]))
        axis = cross(first, other)
        point = (point[0] + p[0], point[1] + p[1], point[2] + p[2])
        return True, point, scale(1.0 / norm(axis), axis)
    return False, ZERO, ZERO


@kernel
def off_axis(x, point, axis):
    """How far x is from a line."""
    y = sub(x, point)
    return norm(axpy(-dot(y, axis), axis, y))


@kernel
def to_axis(phi, point, axis, x, reach):
    """(e, w): how far points within `reach` of x go, and the turn, where phi is moved to turn about
    an axis."""
    if phi.kind == CENTRE_OF:
        return off_axis(phi.o, point, axis), 0.0
    if phi.kind == SCREW_OF:
        return inf, inf
    sine = norm(cross(phi.n, axis))
    if abs(dot(phi.n, axis)) < 0.5:
        return inf, inf
    w = OVER_SINE * sine
    base = phi.o
    if phi.kind == AXIS_OF:
        base = axpy(dot(phi.n, sub(x, phi.o)), phi.n, phi.o)
    return off_axis(base, point, axis) + w * (norm(sub(x, base)) + reach), w


@kernel
def to_own(phi, side, leaf, x, reach):
    """The same where phi is moved to be the potential of a leaf itself; inf where it is not one."""
    o = leaf_reals(side, leaf) + S.NATURAL_REALS
    m = side.numbers
    if own_kind(side, leaf) != phi.kind:
        return inf, inf
    same = True
    if phi.kind == CONE_OF:
        same = abs(m[o + 1] - phi.k1) + abs(m[o + 2] - phi.k2) <= SAME_NUMBER
    elif phi.kind == CIRCLE_OF:
        same = abs(m[o + 1] - phi.k1) <= SAME_NUMBER * phi.k1
    point, axis = moved_line(side, o + 3)
    if not same or (phi.kind == CONE_OF and dot(axis, phi.n) < 0.5):
        return inf, inf
    if phi.kind == CENTRE_OF:
        return norm(sub(point, phi.o)), 0.0
    if phi.kind == AXIS_OF:
        return to_axis(phi, point, axis, x, reach)
    if abs(dot(phi.n, axis)) < 0.5:
        return inf, inf
    w = OVER_SINE * norm(cross(phi.n, axis))
    return norm(sub(point, phi.o)) + w * (norm(sub(x, phi.o)) + reach), w


@kernel
def differences(phi, x, reach, e, w):
    """Bounds of the first, second and third derivatives of phi less phi moved by (e, w)."""
    if e == inf:
        return inf, inf, inf
    _, _, _, c1, c2 = potential_jet(phi, x, reach + e)
    if c1 == inf or c2 == inf:
        return inf, inf, inf
    d2 = c1 + c2
    d3 = THIRD * (c1 * c1 + c2 * c2) + 3.0 * c1 * c2
    d4 = 3.0 * (c1 * c1 * c1 + c2 * c2 * c2) + c1 * c2 * (6.0 * THIRD * c1 + 8.0 * c2)
    return e * d2 + w, e * d3 + 2.0 * w * d2, e * d4 + 3.0 * w * d3
