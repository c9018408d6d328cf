"""The potential between two pieces that turn about one axis: it is constant along their circles, so
that a whole circle of nearest pairs is closed at once."""

from math import inf
from typing import Any, NamedTuple

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import add, axpy, dot, norm, scale, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_likeness import (
    moved_line,
    off_axis,
    own_kind,
    turning,
)
from standoff.kernels.solids.spatial_pieces import ZERO, leaf_ints, leaf_reals
from standoff.kernels.solids.spatial_tolerances import (
    ALONG_OWN,
    NEARLY_COAXIAL,
    NEARLY_STRAIGHT,
)
from standoff.kernels.solids.torus_potential import (
    AXIS_OF,
    CIRCLE_OF,
    CONE_OF,
    TORUS_THROUGH,
    Potential,
)

NO_POTENTIAL = Potential(CONE_OF, ZERO, ZERO, ZERO, ZERO, 0.0, 0.0, 1.0)
# Radii over the size from which on a circle counts as a line: its potential would lose digits.
LARGEST_RADIUS = 30.0
# Where the point of a leaf's own kind stands in its reals; its axis comes next.
OWN_POINT = S.NATURAL_REALS + 3


@kernel
def is_flat(side, leaf):
    r = leaf_ints(side, leaf)
    return side.own[r + S.DIM] == 2 and side.own[r + S.NATURAL] == TORUS_THROUGH


@kernel
def is_one_line(point, axis, other_point, other_axis, size):
    near = abs(dot(axis, other_axis)) >= 1.0 - NEARLY_COAXIAL
    return near and off_axis(other_point, point, axis) <= NEARLY_COAXIAL * size


@kernel
def turning_along(part):
    """(known, axis) along a line about which a part turns, as a flat face does about its normal."""
    if is_flat(part.side, part.leaf):
        return True, moved_line(part.side, leaf_reals(part.side, part.leaf) + OWN_POINT)[1]
    known, _, axis = turning(part.side, part.leaf)
    return known, axis


@kernel
def turns_along(part, axis):
    """Does a part turn about a line that is nearly parallel to an axis?"""
    known, own = turning_along(part)
    return known and abs(dot(axis, own)) >= 1.0 - NEARLY_COAXIAL


@kernel
def turn_alike(a, b):
    """Do two parts turn about lines that are nearly parallel?"""
    known, axis = turning_along(a)
    return known and turns_along(b, axis)


@kernel
def turns_about(part, point, axis, size):
    """Does a part turn about nearly a line? A plane turns about each of its normals."""
    known, own_point, own_axis = turning(part.side, part.leaf)
    if known:
        return is_one_line(point, axis, own_point, own_axis, size)
    return turns_along(part, axis)


@kernel
def common_axis(a, b, leaves, size):
    """(known, point, axis) about which both of two parts nearly turn: of theirs, or of two leaves
    of the same solids."""
    for k in range(4):
        side = a.side if k % 2 == 0 else b.side
        leaf = (a.leaf if k == 0 else b.leaf) if k < 2 else leaves[k - 2]
        known, point, axis = turning(side, leaf)
        if known:
            both = turns_about(a, point, axis, size) and turns_about(b, point, axis, size)
            return both, point, axis
    return False, ZERO, ZERO


@kernel
def across_meridian(S3, frame, e):
    """The curvature of a shape (S11, S12, S22) on a frame along e."""
    c, s = dot(e, frame[0]), dot(e, frame[1])
    return S3[0] * c * c + 2.0 * S3[1] * c * s + S3[2] * s * s


@kernel
def snapped(nr, nz):
    """A direction in a meridian plane that is nearly along the axis or across it, made so: of axes
    a little apart the normal turns along the circle, and its mean does not."""
    if abs(nr) <= NEARLY_STRAIGHT:
        return 0.0, (1.0 if nz > 0.0 else -1.0)
    if abs(nz) <= NEARLY_STRAIGHT:
        return (1.0 if nr > 0.0 else -1.0), 0.0
    return nr, nz


class Meridian(NamedTuple):
    """Half way between two points, in the half plane from an axis through there.

    Attributes
    ----------
    point, axis : of the line about which both parts turn.
    z, rho, out : the place: along the axis, away from it, and the direction away from it.
    nr, nz : the normal there, away from the axis and along it.
    half : of the way from one point to the other.
    """

    point: Any
    axis: Any
    z: Any
    rho: Any
    out: Any
    nr: Any
    nz: Any
    half: Any


@kernel
def in_meridian(x, y, n, point, axis):
    """(known, meridian): half way from x to y, with a normal that lies nearly in its plane."""
    middle = sub(scale(0.5, add(x, y)), point)
    z = dot(middle, axis)
    radial = axpy(-z, axis, middle)
    rho = norm(radial)
    out = scale(1.0 / rho, radial) if rho > 0.0 else ZERO
    nr, nz = dot(n, out), dot(n, axis)
    length = sqrt(nr * nr + nz * nz)
    known = rho > 0.0 and length >= 1.0 - NEARLY_COAXIAL
    if known:
        nr, nz = snapped(nr / length, nz / length)
    half = 0.5 * max(dot(sub(y, x), n), 0.0)
    return known, Meridian(point, axis, z, rho, out, nr, nz, half)


@kernel
def own_straight(side, leaf, x, n):
    """(known, potential) of the cylinder or the cone that a leaf lies on, if it grows along n at
    x: exact, where a normal between two points has as few digits as they are near."""
    kind = own_kind(side, leaf)
    if kind not in (AXIS_OF, CONE_OF):
        return False, NO_POTENTIAL
    o, m = leaf_reals(side, leaf) + S.NATURAL_REALS, side.numbers
    point, axis = moved_line(side, o + 3)
    radial = sub(x, point)
    radial = axpy(-dot(radial, axis), axis, radial)
    rho = norm(radial)
    slope = dot(radial, n) / rho if rho > 0.0 else 0.0
    if kind == CONE_OF:
        slope = m[o + 1] * slope - m[o + 2] * dot(axis, n)
    sign = 1.0 if slope > 0.0 else -1.0
    phi = Potential(kind, point, ZERO, ZERO, axis, m[o + 1], m[o + 2], sign)
    return abs(slope) >= 1.0 - ALONG_OWN, phi


@kernel
def straight_about(at):
    """A potential that is constant on a cone about a line, or on a cylinder."""
    if at.nz == 0.0:
        return Potential(AXIS_OF, at.point, ZERO, ZERO, at.axis, 0.0, 0.0, at.nr)
    foot = axpy(at.z, at.axis, at.point)
    return Potential(CONE_OF, foot, ZERO, ZERO, at.axis, at.nr, -at.nz, 1.0)


@kernel
def coaxial_between(at, frame, shapes, limit, size):
    """The potential there: a cone or a ring about the axis, whose curvature in the meridian plane
    lies between those of both shapes."""
    e = axpy(-at.nz, at.out, scale(at.nr, at.axis))
    sa, sb = across_meridian(shapes[0], frame, e), across_meridian(shapes[1], frame, e)
    d = at.half
    sa = sa / (1.0 + d * sa) if 1.0 + d * sa > 0.1 else sa
    sb = sb / (1.0 + d * sb) if 1.0 + d * sb > 0.1 else sb
    spare = min(0.5 * (sa + sb), limit)
    k = sa - spare if abs(sa) <= abs(sb) else spare - sb
    radius = 1.0 / abs(k) if k != 0.0 else inf
    if radius > LARGEST_RADIUS * size:
        return straight_about(at)
    foot = axpy(at.z - at.nz / k, at.axis, at.point)
    sign = 1.0 if k > 0.0 else -1.0
    return Potential(CIRCLE_OF, foot, ZERO, ZERO, at.axis, at.rho - at.nr / k, radius, sign)
