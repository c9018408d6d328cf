"""The greatest height over a plane of a piece of an analytic face or of an arc, in closed form.

A height is linear on a plane, and a wave in the angle on cylinders, cones, tori and arcs. So a
whole line or circle of nearest points to a plane is closed at once, where Taylor's formula would
have to cut it into many parts.
"""

from math import atan2, ceil, cos, pi, sin

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import dot, rotate_back, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_record, edge_record
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_pieces import leaf_ints

TURN = 2.0 * pi


@kernel
def wave_max(a, b, first, last):
    """The greatest a cos t + b sin t for first <= t <= last."""
    top = atan2(b, a)
    if last - first >= TURN or top + TURN * ceil((first - top) / TURN) <= last:
        return sqrt(a * a + b * b)
    return max(a * cos(first) + b * sin(first), a * cos(last) + b * sin(last))


@kernel
def wave_rise(b, c, wide):
    """The greatest b sin t + c (1 - cos t) for -wide <= t <= wide: as exact as it is small, though
    c is a radius that may be far longer than what is left of an arc."""
    half = sin(0.5 * min(wide, pi))
    most = abs(b) * sin(wide) + 2.0 * c * half * half if wide < pi else 2.0 * c
    if abs(atan2(b, -c)) > wide:
        return most
    root = sqrt(b * b + c * c)
    return max(most, b * b / (root - c) if c < 0.0 else c + root)


@kernel
def amplitudes(side, o, n):
    """(n . shift, n . columns) of the affine map at reals[o:]; n in the solid's frame."""
    m = side.reals
    return (
        dot(n, (m[o + 9], m[o + 10], m[o + 11])),
        dot(n, (m[o], m[o + 3], m[o + 6])),
        dot(n, (m[o + 1], m[o + 4], m[o + 7])),
        dot(n, (m[o + 2], m[o + 5], m[o + 8])),
    )


@kernel
def over_face(kind, side, o, n, box):
    """(known, the greatest n . x) over a rectangle of a face whose map is at reals[o:]."""
    base, p, q, s = amplitudes(side, o, n)
    if kind == L.PLANE:
        return True, base + max(p * box.u0, p * box.u1) + max(q * box.v0, q * box.v1)
    if kind == L.CYLINDER:
        return True, base + wave_max(p, q, box.u0, box.u1) + max(s * box.v0, s * box.v1)
    if kind == L.CONE:
        high = wave_max(p, q, box.u0, box.u1) + s
        low = s - wave_max(-p, -q, box.u0, box.u1)
        most = max(max(high * box.v0, high * box.v1), max(low * box.v0, low * box.v1))
        return True, base + most
    if kind == L.TORUS:
        # what is farther from the axis than 0 is highest at the angle of the highest spoke
        major, minor = side.reals[o + L.SURFACE_DATA], side.reals[o + L.SURFACE_DATA + 1]
        spoke = wave_max(p, q, box.u0, box.u1)
        return True, base + major * spoke + minor * wave_max(spoke, s, box.v0, box.v1)
    return False, 0.0


@kernel
def height_greatest(phi, sign, side, leaf, box):
    """(known, the greatest value) of sign n . (x - o) over a box of a leaf: for a plane's potential
    on planes, cylinders, cones, tori and arcs. Trims are not looked at."""
    r = leaf_ints(side, leaf)
    along = rotate_back(side.pose.R, phi.n)
    n = (sign * along[0], sign * along[1], sign * along[2])
    shift = sign * dot(phi.n, sub(side.pose.p, phi.o))
    if side.own[r + S.DIM] == 2:
        c = chart_record(side.ints, side.own[r + S.CHART])
        o = side.ints[c + L.CHART_REALS]
        known, most = over_face(side.ints[c + L.CHART_KIND], side, o, n, box)
        return known, most + shift
    if side.own[r + S.DIM] == 1:
        e = edge_record(side.ints, side.own[r + S.FEATURE])
        if side.ints[e + L.EDGE_KIND] == L.CONIC:
            o = side.ints[e + L.EDGE_REALS] + L.CURVE_DATA
            base, p, q, _ = amplitudes(side, o, n)
            return True, base + wave_max(p, q, box.u0, box.u1) + shift
    return False, 0.0
