"""A bound of the distance from an axis over what turns about nearly the same one."""

from math import cos, inf, sin

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import axpy, cross, dot, norm, rotate, scale, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_record, edge_record
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.quadratic_max import quadratic_max, widened
from standoff.kernels.solids.spatial_pieces import ZERO, leaf_ints
from standoff.kernels.solids.spatial_tolerances import ROUND_CONIC
from standoff.kernels.solids.torus_potential import AXIS_OF


@kernel
def axis_data(side, leaf):
    """(known, c, E1, E2, b): a cylinder or an arc as c + E1 cos u + E2 sin u + v b, in A's frame,
    E1 and E2 of one length and normal to each other and to b."""
    r = leaf_ints(side, leaf)
    dim = side.own[r + S.DIM]
    o = -1
    straight = 0.0
    if dim == 2 and side.own[r + S.NATURAL] == AXIS_OF:
        c = chart_record(side.ints, side.own[r + S.CHART])
        o, straight = side.ints[c + L.CHART_REALS], 1.0
    elif dim == 1 and side.own[r + S.NATURAL] == S.ROUND_ARC:
        e = edge_record(side.ints, side.own[r + S.FEATURE])
        o = side.ints[e + L.EDGE_REALS] + L.CURVE_DATA
    if o < 0:
        return False, ZERO, ZERO, ZERO, ZERO
    m, R, p = side.reals, side.pose.R, side.pose.p
    c = rotate(R, (m[o + 9], m[o + 10], m[o + 11]))
    c = (c[0] + p[0], c[1] + p[1], c[2] + p[2])
    first = rotate(R, (m[o], m[o + 3], m[o + 6]))
    other = rotate(R, (m[o + 1], m[o + 4], m[o + 7]))
    along = scale(straight, rotate(R, (m[o + 2], m[o + 5], m[o + 8])))
    return True, c, first, other, along


@kernel
def arc_offset(side, feature):
    """Where the affine map of a conic edge stands in reals; -1: it is none."""
    first = side.ints[L.N_FACES]
    if not first <= feature < first + side.ints[L.N_EDGES]:
        return -1
    e = edge_record(side.ints, feature)
    if side.ints[e + L.EDGE_KIND] != L.CONIC:
        return -1
    return side.ints[e + L.EDGE_REALS] + L.CURVE_DATA


@kernel
def arc_data(side, arc):
    """The same of a conic edge, whose affine map is at reals[arc:]: known if it is a circle's."""
    m, R, p = side.reals, side.pose.R, side.pose.p
    first = rotate(R, (m[arc], m[arc + 3], m[arc + 6]))
    other = rotate(R, (m[arc + 1], m[arc + 4], m[arc + 7]))
    c = rotate(R, (m[arc + 9], m[arc + 10], m[arc + 11]))
    c = (c[0] + p[0], c[1] + p[1], c[2] + p[2])
    square = dot(first, first)
    known = abs(dot(first, other)) <= ROUND_CONIC * square
    known = known and abs(dot(other, other) - square) <= ROUND_CONIC * square
    return known, c, first, other, ZERO


@kernel
def arc_axis(side, arc):
    """(known, point, axis) about which a conic edge turns, if it is a circle's."""
    known, c, first, other, _ = arc_data(side, arc)
    axis = cross(first, other)
    size = norm(axis)
    return known and size > 0.0, c, scale(1.0 / size, axis) if size > 0.0 else ZERO


@kernel
def round_axis_greatest(phi, sign, data, box, u, v):
    """The same bound for the distance from an axis over a cylinder or an arc, which stays sharp
    where both nearly share their axis: only the small quantities are expanded."""
    _, centre, first, other, along = data
    a = phi.n
    offset = sub(centre, phi.o)
    offset = axpy(-dot(a, offset), a, offset)
    lean = axpy(-dot(a, along), a, along)
    p, q = dot(a, first), dot(a, other)
    r2 = dot(first, first)
    cu, su = cos(u), sin(u)
    E, Eu = axpy(cu, first, scale(su, other)), axpy(-su, first, scale(cu, other))
    tilt, tilt_u = p * cu + q * su, q * cu - p * su
    both = axpy(2.0 * v, lean, scale(2.0, offset))
    # |offset + v lean + E|² - |E|², less what is along the axis
    eta = dot(offset, offset) + 2.0 * v * dot(offset, lean) + v * v * dot(lean, lean)
    eta += dot(both, E) - tilt * tilt
    gu = dot(both, Eu) - 2.0 * tilt * tilt_u
    gv = 2.0 * dot(offset, lean) + 2.0 * v * dot(lean, lean) + 2.0 * dot(lean, E)
    huu = -dot(both, E) - 2.0 * (tilt_u * tilt_u - tilt * tilt)
    huv = 2.0 * dot(lean, Eu)
    hvv = 2.0 * dot(lean, lean)
    mu, mv = max(box.u1 - u, u - box.u0), max(box.v1 - v, v - box.v0)
    r = sqrt(r2)
    far = norm(both) + 2.0 * norm(lean) * mv
    thirds = (far * r + 8.0 * (p * p + q * q), 2.0 * norm(lean) * r, 0.0, 0.0)
    s = sign * phi.sign
    wide = widened((s * huu, s * huv, s * hvv), thirds, (0.0, 0.0, 0.0), mu, mv)
    e = (box.u0 - u, box.u1 - u, box.v0 - v, box.v1 - v)
    most = eta + s * quadratic_max((s * gu, s * gv), wide, e)
    if r2 + most <= 0.0:
        return inf
    return s * ((r - phi.k1) + most / (sqrt(r2 + most) + r))
