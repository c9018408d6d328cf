"""The potential between two pieces that turn about one axis: it is constant along their circles, so
that a whole circle of nearest pairs is closed at once."""

from math import inf

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import add, axpy, dot, norm, scale, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_likeness import off_axis, turning
from standoff.kernels.solids.spatial_pieces import ZERO, leaf_ints
from standoff.kernels.solids.spatial_tolerances import NEARLY_COAXIAL, NEARLY_STRAIGHT
from standoff.kernels.solids.torus_potential import CIRCLE_OF, CONE_OF, TORUS_THROUGH, Potential

NO_POTENTIAL = Potential(CONE_OF, ZERO, ZERO, ZERO, ZERO, 0.0, 0.0, 1.0)
# Radii over the size from which on a circle counts as a line: its potential would lose digits.
LARGEST_RADIUS = 30.0


@kernel
def is_flat(side, leaf):
    r = leaf_ints(side, leaf)
    return side.own[r + S.DIM] == 2 and side.own[r + S.NATURAL] == TORUS_THROUGH


@kernel
def common_axis(a, b, n, size):
    """(known, point, axis) about which both of two parts nearly turn; a plane turns about each of
    its normals, which here is n."""
    known_a, point_a, axis_a = turning(a.side, a.leaf)
    known_b, point_b, axis_b = turning(b.side, b.leaf)
    if known_a and known_b:
        near = abs(dot(axis_a, axis_b)) >= 1.0 - NEARLY_COAXIAL
        near = near and off_axis(point_b, point_a, axis_a) <= NEARLY_COAXIAL * size
        return near, point_a, axis_a
    if known_a and is_flat(b.side, b.leaf):
        return abs(dot(axis_a, n)) >= 1.0 - NEARLY_COAXIAL, point_a, axis_a
    if known_b and is_flat(a.side, a.leaf):
        return abs(dot(axis_b, n)) >= 1.0 - NEARLY_COAXIAL, point_b, axis_b
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


@kernel
def coaxial_between(x, y, n, frame, shapes, line, limit, size):
    """(known, potential) half way from x to y: a cone or a ring about a line (point, axis), whose
    curvature in the meridian plane lies between those of both shapes."""
    point, axis = line
    middle = sub(scale(0.5, add(x, y)), point)
    z = dot(middle, axis)
    radial = axpy(-z, axis, middle)
    rho = norm(radial)
    if rho <= 0.0:
        return False, NO_POTENTIAL
    out = scale(1.0 / rho, radial)
    nr, nz = dot(n, out), dot(n, axis)
    length = sqrt(nr * nr + nz * nz)
    if length < 1.0 - NEARLY_COAXIAL:
        return False, NO_POTENTIAL
    nr, nz = snapped(nr / length, nz / length)
    e = axpy(-nz, out, scale(nr, axis))
    sa, sb = across_meridian(shapes[0], frame, e), across_meridian(shapes[1], frame, e)
    d = 0.5 * max(dot(sub(y, x), n), 0.0)
    sa = sa / (1.0 + d * sa) if 1.0 + d * sa > 0.1 else sa
    sb = sb / (1.0 + d * sb) if 1.0 + d * sb > 0.1 else sb
    spare = min(0.5 * (sa + sb), limit)
    k = sa - spare if abs(sa) <= abs(sb) else spare - sb
    radius = 1.0 / abs(k) if k != 0.0 else inf
    if radius > LARGEST_RADIUS * size:
        foot = axpy(z, axis, point)
        return True, Potential(CONE_OF, foot, ZERO, ZERO, axis, nr, -nz, 1.0)
    foot = axpy(z - nz / k, axis, point)
    sign = 1.0 if k > 0.0 else -1.0
    return True, Potential(CIRCLE_OF, foot, ZERO, ZERO, axis, rho - nr / k, radius, sign)
