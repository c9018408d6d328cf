"""The greatest value of a potential over a piece of a planar boundary, bounded.

On lines and arcs of circles in closed form. On other curves by the length s of the arc from a base
point: with n the outward normal, g the gradient and c = n . g, the second derivative is
c (k c - curvature), k being the curvature of the level curve; the ranges of the angle, of k and of
the curvature over the piece bound it.
"""

from math import acos, asin, cos, pi

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.compiler.decorators import kernel, small
from standoff.kernels.solids.planar_layout import (
    ARC,
    CENTRE,
    FORM,
    GREATEST_K,
    GREATEST_SPEED,
    LEAST_K,
    LINE,
)
from standoff.kernels.solids.planar_pieces import (
    arc_parameter,
    frame_at,
    jet_at,
    leaf_int,
    leaf_of,
    leaf_real,
    placed,
    to_segment,
    turned_into,
)
from standoff.kernels.solids.planar_tolerances import SAME_ANGLE
from standoff.kernels.solids.torus_potential import from_circle


@small
def value_at(phi, x, y):
    dx, dy = x - phi.x, y - phi.y
    if phi.pointed:
        return sqrt(dx * dx + dy * dy)
    z = phi.nx * dx + phi.ny * dy
    t = phi.nx * dy - phi.ny * dx
    return from_circle(phi.k, t, z)[0]


@small
def centre_of(phi):
    if phi.pointed:
        return phi.x, phi.y
    return phi.x - phi.nx / phi.k, phi.y - phi.ny / phi.k


@kernel
def greatest(outline, piece, phi, sign, witness):
    """An upper bound of sign φ over a piece of a leaf; `witness` is a parameter where it may be
    greatest."""
    leaf = leaf_of(outline, piece.node)
    form = leaf_int(outline, leaf, FORM)
    curved = phi.pointed or phi.k != 0.0
    if form == LINE:
        return greatest_on_line(piece, phi, sign, curved)
    if form == ARC:
        return greatest_on_arc(outline, leaf, piece, phi, sign, curved)
    low, high = min(piece.first, piece.last), max(piece.first, piece.last)
    at = min(high, max(low, witness))
    found = greatest_from(outline, leaf, piece, phi, sign, at)
    return min(found, greatest_from(outline, leaf, piece, phi, sign, 0.5 * (low + high)))


@kernel
def greatest_on_line(piece, phi, sign, curved):
    """The distance from a centre is convex: its extremes are at the ends and at the foot point."""
    found = max(
        sign * value_at(phi, piece.x0, piece.y0),
        sign * value_at(phi, piece.x1, piece.y1),
    )
    if curved:
        cx, cy = centre_of(phi)
        dx, dy = piece.x1 - piece.x0, piece.y1 - piece.y0
        size = dx * dx + dy * dy
        s = ((cx - piece.x0) * dx + (cy - piece.y0) * dy) / size if size > 0.0 else 0.0
        if 0.0 < s < 1.0:
            found = max(found, sign * value_at(phi, piece.x0 + s * dx, piece.y0 + s * dy))
    return found


@kernel
def greatest_on_arc(outline, leaf, piece, phi, sign, curved):
    """The extremes are at the ends, and where the normal goes through φ's centre."""
    x, y = leaf_real(outline, leaf, CENTRE), leaf_real(outline, leaf, CENTRE + 1)
    x, y = placed(outline, x, y)
    ux, uy = phi.nx, phi.ny
    if curved:
        cx, cy = centre_of(phi)
        ux, uy = x - cx, y - cy
    low, high = min(piece.first, piece.last), max(piece.first, piece.last)
    found = max(
        sign * value_at(phi, piece.x0, piece.y0),
        sign * value_at(phi, piece.x1, piece.y1),
    )
    for way in (1.0, -1.0):
        t = turned_into(arc_parameter(outline, leaf, way * ux, way * uy), low - SAME_ANGLE)
        if t <= high + SAME_ANGLE:
            px, py, _, _, _, _ = jet_at(outline, leaf, t)
            found = max(found, sign * value_at(phi, px, py))
    return found


@small
def times(a, b, c, d):
    """[a, b] [c, d]."""
    p, q, r, s = a * c, a * d, b * c, b * d
    return min(min(p, q), min(r, s)), max(max(p, q), max(r, s))


@kernel
def greatest_from(outline, leaf, piece, phi, sign, t):
    """The bound by Taylor's formula from the point at t."""
    x, y, tx, ty, _ = frame_at(outline, leaf, t)
    value = sign * value_at(phi, x, y)
    fastest = leaf_real(outline, leaf, GREATEST_SPEED)
    back, ahead = fastest * abs(t - piece.first), fastest * abs(piece.last - t)
    reach = max(back, ahead)
    gx, gy, least_k, greatest_k, swing = phi.nx, phi.ny, 0.0, 0.0, 0.0
    if phi.pointed or phi.k != 0.0:
        cx, cy = centre_of(phi)
        gx, gy = x - cx, y - cy
        far = sqrt(gx * gx + gy * gy)
        if reach >= far:
            return value + reach
        side = 1.0 if phi.pointed or phi.k > 0.0 else -1.0
        gx *= side / far
        gy *= side / far
        swing = asin(reach / far)
        least_k = side / (far + side * reach)
        greatest_k = side / (far - side * reach)
    bends = leaf_real(outline, leaf, LEAST_K), leaf_real(outline, leaf, GREATEST_K)
    swing += max(abs(bends[0]), abs(bends[1])) * reach
    angle = acos(min(1.0, max(-1.0, gx * ty - gy * tx)))
    c_low, c_high = cos(min(pi, angle + swing)), cos(max(0.0, angle - swing))
    level = times(least_k, greatest_k, c_low, c_high)
    second = times(level[0] - bends[1], level[1] - bends[0], c_low, c_high)
    most = second[1] if sign > 0.0 else -second[0]
    slope = sign * (gx * tx + gy * ty)
    found = max(
        value,
        max(
            value + ahead * (slope + 0.5 * most * ahead),
            value + back * (0.5 * most * back - slope),
        ),
    )
    if most < 0.0:
        top = min(ahead, max(-back, -slope / most))
        found = max(found, value + top * (slope + 0.5 * most * top))
    return min(found, value + reach)


@small
def covers(piece, x, y, extra):
    """Is a point in a piece's capsule, or nearer to it than `extra`?"""
    away = to_segment(x, y, piece.x0, piece.y0, piece.x1, piece.y1)
    return away <= piece.radius + extra
