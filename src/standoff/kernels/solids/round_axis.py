"""Bounds of the distance from an axis, a cone or a circle over what goes round in circles: straight
faces that turn about an axis, arcs, and tori, which are within their tube's radius of an arc.

Along a circle each of these distances, or its square, is bounded by a wave (c, a, b, d, e), which
is c + a cos t + b sin t + d cos 2t + e sin 2t at the angle t from a place on the circle. Where the
circle goes nearly round the axis all but c are small.
"""

from math import inf

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import axpy, cross, dot, norm, scale, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import edge_record
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.quadratic_max import line_max
from standoff.kernels.solids.spatial_likeness import moved_line
from standoff.kernels.solids.spatial_pieces import (
    ZERO,
    is_plane_leaf,
    leaf_ints,
    leaf_jet,
    leaf_reals,
)
from standoff.kernels.solids.spatial_tolerances import CIRCLE_ROUNDING, ROUND_CONIC
from standoff.kernels.solids.torus_potential import AXIS_OF, CIRCLE_OF, CONE_OF, TORUS_THROUGH


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
def is_circle(first, other):
    """Are two half axes of one length, and normal to each other?"""
    square = dot(first, first)
    known = abs(dot(first, other)) <= ROUND_CONIC * square
    return known and abs(dot(other, other) - square) <= ROUND_CONIC * square


@kernel
def own_circle(jet):
    """(known, centre, first, other) of the circle along u through a place, if u is its angle:
    centre + first cos t + other sin t."""
    first = scale(-1.0, jet[3])
    return is_circle(first, jet[1]), sub(jet[0], first), first, jet[1]


@kernel
def is_straight_round(side, leaf):
    """Is it of a straight line that is turned by u: a cylinder, a cone, or a flat ring?"""
    r = leaf_ints(side, leaf)
    if side.own[r + S.DIM] != 2:
        return False
    kind = side.own[r + S.NATURAL]
    flat = kind == TORUS_THROUGH and not is_plane_leaf(side, leaf)
    return flat or kind in (AXIS_OF, CONE_OF)


@kernel
def round_at(side, leaf, u, v):
    """(known, centre, first, other, tube): the circle along u of a straight face that turns, or of
    an arc; of a torus the circle within, `tube` away from it."""
    r = leaf_ints(side, leaf)
    dim, kind = side.own[r + S.DIM], side.own[r + S.NATURAL]
    if is_straight_round(side, leaf) or (dim == 1 and kind in (S.ROUND_ARC, S.TURNED)):
        known, centre, first, other = own_circle(leaf_jet(side, leaf, u, v))
        return known, centre, first, other, 0.0
    if dim != 2 or kind != CIRCLE_OF:
        return False, ZERO, ZERO, ZERO, 0.0
    jet = leaf_jet(side, leaf, u, v)
    o, m = leaf_reals(side, leaf) + S.NATURAL_REALS, side.numbers
    point, axis = moved_line(side, o + 3)
    first = sub(jet[0], point)
    first = axpy(-dot(first, axis), axis, first)
    far, fast = norm(first), norm(jet[1])
    if far == 0.0 or fast == 0.0:
        return False, ZERO, ZERO, ZERO, 0.0
    return True, point, scale(m[o + 1] / far, first), scale(m[o + 1] / fast, jet[1]), m[o + 2]


@kernel
def wave_most(wave, first, last):
    """A bound of a wave over first <= t <= last; exact at 0."""
    c, a, b, d, e = wave
    third = sqrt(a * a + b * b) + 8.0 * sqrt(d * d + e * e)
    bend = -a - 4.0 * d + third * max(abs(first), abs(last)) / 3.0
    return c + a + d + line_max(b + 2.0 * e, bend, first, last)


@kernel
def square_wave(c, a, b):
    """The square of c + a cos t + b sin t."""
    return c * c + 0.5 * (a * a + b * b), 2.0 * c * a, 2.0 * c * b, 0.5 * (a * a - b * b), a * b


@kernel
def plus_wave(one, s, other):
    return (
        one[0] + s * other[0],
        one[1] + s * other[1],
        one[2] + s * other[2],
        one[3] + s * other[3],
        one[4] + s * other[4],
    )


@kernel
def straight_wave(phi, s, circle, out):
    """(known, wave) that s times the distance from an axis or a cone does not exceed on a circle.

    The distance rho from the axis is at most (rho² / m + m) / 2 for any m, exactly so where m is
    rho, and at least what it has along a direction across the axis: one that turns with t, from
    `out` on."""
    centre, first, other = circle
    k1, k2, k0 = (phi.k1, phi.k2, 0.0) if phi.kind == CONE_OF else (1.0, 0.0, phi.k1)
    w = sub(centre, phi.o)
    high, pa, pb = dot(phi.n, w), dot(phi.n, first), dot(phi.n, other)
    w = axpy(-high, phi.n, w)
    low = (-s * (k2 * high + k0), -s * k2 * pa, -s * k2 * pb, 0.0, 0.0)
    k1 = s * k1
    if k1 >= 0.0:
        square, r2 = dot(w, w) + dot(first, first), dot(first, first)
        wave = (
            square - 0.5 * (pa * pa + pb * pb),
            2.0 * dot(w, first),
            2.0 * dot(w, other),
            0.5 * (pb * pb - pa * pa),
            -pa * pb,
        )
        m2 = wave[0] + wave[1] + wave[3]
        if m2 <= CIRCLE_ROUNDING * (square + r2):
            return False, low
        m = sqrt(m2)
        low = (low[0] + 0.5 * k1 * m, low[1], low[2], low[3], low[4])
        return True, plus_wave(low, 0.5 * k1 / m, wave)
    turn = cross(phi.n, out)
    if dot(turn, other) < 0.0:
        turn = scale(-1.0, turn)
    aa, bb, ab = dot(first, out), dot(other, turn), dot(first, turn) + dot(other, out)
    wave = 0.5 * (aa + bb), dot(w, out), dot(w, turn), 0.5 * (aa - bb), 0.5 * ab
    return True, plus_wave(low, k1, wave)


@kernel
def across_axis(phi, x):
    """(length, unit vector) from a potential's axis to a point."""
    out = sub(x, phi.o)
    out = axpy(-dot(out, phi.n), phi.n, out)
    rho = norm(out)
    return rho, scale(1.0 / rho, out) if rho > 0.0 else ZERO


@kernel
def around_circle(phi, sign, most, circle, begin, end):
    """Is sign phi, a distance d from a circle of radius R, proven to be at most `most` on an arc,
    which is then within, or beyond, a distance D? Let e be the greatest distance from the circle's
    points, q the square of that from its centre, and z the height over its plane. Then
    (d² - D²) (e² - D²) = (q - R² - D²)² + 4 R² (z² - D²), a wave."""
    centre, first, other = circle
    s, R4 = sign * phi.sign, 4.0 * phi.k1 * phi.k1
    D = s * most + phi.k2
    if D <= 0.0:
        return s < 0.0
    w = sub(centre, phi.o)
    w2 = dot(w, w) + dot(first, first)
    f = (w2 - 0.25 * R4 - D * D, 2.0 * dot(w, first), 2.0 * dot(w, other))
    z = (dot(phi.n, w), dot(phi.n, first), dot(phi.n, other))
    if s < 0.0 and wave_most((-f[0] - 0.5 * R4, -f[1], -f[2], 0.0, 0.0), begin, end) > 0.0:
        return False  # e may be less than D too
    both = plus_wave(square_wave(f[0], f[1], f[2]), R4, square_wave(z[0], z[1], z[2]))
    both = plus_wave(both, R4 * D * D, (-1.0, 0.0, 0.0, 0.0, 0.0))
    wide_f, wide_z = abs(f[0]) + norm(f), norm(z)
    lengths = (w2 + R4 + D * D) * wide_f + R4 * (wide_z * wide_z + D * D)
    spare = CIRCLE_ROUNDING * lengths
    wave = (s * both[0], s * both[1], s * both[2], s * both[3], s * both[4])
    return wave_most(wave, begin, end) + spare <= 0.0


@kernel
def arc_at_most(phi, sign, most, jet, first, last):
    """Is sign phi, a distance from an axis, a cone or a circle, proven to be at most `most` on an
    arc of a circle, from the angle `first` to `last` of a place with that jet?"""
    known, centre, one, other = own_circle(jet)
    if not known:
        return False
    if phi.kind == CIRCLE_OF:
        return around_circle(phi, sign, most, (centre, one, other), first, last)
    rho, out = across_axis(phi, jet[0])
    known, wave = straight_wave(phi, sign * phi.sign, (centre, one, other), out)
    return known and rho > 0.0 and wave_most(wave, first, last) <= most


@kernel
def round_greatest(phi, sign, side, leaf, box, u, v):
    """The same on a leaf over a box; it is sharp where the greatest value is at (u, v). Along a
    straight line the bound is convex or linear, and greatest at an end."""
    known, centre, first, other, tube = round_at(side, leaf, u, v)
    if not known:
        return inf
    rho, out = across_axis(phi, (centre[0] + first[0], centre[1] + first[1], centre[2] + first[2]))
    if rho == 0.0:
        return inf
    most, ends = -inf, is_straight_round(side, leaf)
    for k in range(2 if ends else 1):
        if ends:
            _, centre, first, other, _ = round_at(side, leaf, u, box.v0 if k == 0 else box.v1)
        known, wave = straight_wave(phi, sign * phi.sign, (centre, first, other), out)
        if not known:
            return inf
        most = max(most, wave_most(wave, box.u0 - u, box.u1 - u))
    return most + tube


@kernel
def round_at_most(phi, sign, most, side, leaf, box, u, v):
    """Is sign phi proven to be at most `most` over a box of what goes round? (u, v): where it may
    be greatest."""
    if phi.kind == CIRCLE_OF:
        known, centre, first, other, tube = round_at(side, leaf, u, v)
        circle = (centre, first, other)
        known = known and not is_straight_round(side, leaf)
        return known and around_circle(phi, sign, most - tube, circle, box.u0 - u, box.u1 - u)
    if phi.kind not in (AXIS_OF, CONE_OF):
        return False
    return round_greatest(phi, sign, side, leaf, box, u, v) <= most
