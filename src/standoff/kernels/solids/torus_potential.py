"""Functions of space that change by no more than the way gone, for bounds of distances.

The torus potential has any two curvatures, plane, cylinder and sphere included; its numbers keep
their digits for curvatures of either sign and zero. The others are distances from an axis, a
centre, a cone and a circle: constant on the analytic faces that they belong to. The last is
constant along screw lines: on the flanks of a thread.
"""

from math import atan2, inf
from typing import Any, NamedTuple

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import axpy, cross, dot, norm, scale, sub
from standoff.kernels.compiler.decorators import kernel

TORUS_THROUGH = 0
CONE_OF = 1
CIRCLE_OF = 2
AXIS_OF = 3
CENTRE_OF = 4
SCREW_OF = 5
# The greatest third derivative of a distance from a point, along any direction, times its square:
# 3 sin² cos is greatest at 2 / sqrt(3).
THIRD = 1.1548
THIRD_ROOT = 1.0 / 3.0


class Potential(NamedTuple):
    """One potential. TORUS_THROUGH: o on it, e1, e2, n a frame, k1 and k2 its curvatures along e1
    and e2. The others: o and n a point and the axis, k1 and k2 cosine and sine of a cone's half
    angle, radii of a torus, or the radius alone; `sign` is +1 or -1.

    SCREW_OF: o and n a point and the axis, e1 a direction across it, k1 the rise per radian, k2 a
    length above 0: where the coordinate along e1 is at least k2 it changes by no more than the way
    gone. e2 has its slopes along the axis and away from it, and a 0."""

    kind: Any
    o: Any
    e1: Any
    e2: Any
    n: Any
    k1: Any
    k2: Any
    sign: Any


@kernel
def outer(s, a, b):
    """s (a bᵀ + b aᵀ) / 2 as (xx, xy, xz, yy, yz, zz)."""
    h = 0.5 * s
    return (
        s * a[0] * b[0],
        h * (a[0] * b[1] + a[1] * b[0]),
        h * (a[0] * b[2] + a[2] * b[0]),
        s * a[1] * b[1],
        h * (a[1] * b[2] + a[2] * b[1]),
        s * a[2] * b[2],
    )


@kernel
def plus(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5])


@kernel
def form(H, a, b):
    """aᵀ H b."""
    return (
        H[0] * a[0] * b[0]
        + H[3] * a[1] * b[1]
        + H[5] * a[2] * b[2]
        + H[1] * (a[0] * b[1] + a[1] * b[0])
        + H[2] * (a[0] * b[2] + a[2] * b[0])
        + H[4] * (a[1] * b[2] + a[2] * b[1])
    )


@kernel
def from_circle(k, t, z):
    """The signed distance of (t, z) from the circle of curvature k through 0 with centre (0, -1/k),
    and 1 + k times it."""
    w = k * (t * t + z * z) + 2.0 * z
    r = sqrt(1.0 + k * w) if 1.0 + k * w > 0.0 else 0.0
    return w / (1.0 + r), r


@kernel
def curvature_within(k, r, reach):
    """The greatest |k| / (1 + k delta) where 1 + k delta is r at a point, up to `reach` from it."""
    left = r - abs(k) * reach
    return abs(k) / left if left > 0.0 else inf


@kernel
def torus_jet(phi, y, reach):
    t1, t2, z = dot(phi.e1, y), dot(phi.e2, y), dot(phi.n, y)
    psi, r2 = from_circle(phi.k2, t2, z)
    value, r1 = from_circle(phi.k1, t1, psi)
    c1 = curvature_within(phi.k1, r1, reach)
    c2 = curvature_within(phi.k2, r2, reach)
    if c1 == inf or c2 == inf:
        return value, phi.n, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), inf, inf
    slope = axpy(phi.k2 * t2 / r2, phi.e2, scale((phi.k2 * z + 1.0) / r2, phi.n))
    turn = axpy((phi.k2 * z + 1.0) / r2, phi.e2, scale(-phi.k2 * t2 / r2, phi.n))
    a, b = phi.k1 * t1 / r1, (phi.k1 * psi + 1.0) / r1
    gradient = axpy(a, phi.e1, scale(b, slope))
    along = axpy(b, phi.e1, scale(-a, slope))
    H = plus(outer(phi.k1 / r1, along, along), outer(b * phi.k2 / r2, turn, turn))
    return value, gradient, H, c1, c2


@kernel
def round_axis_jet(phi, y, reach):
    """Of the kinds with an axis."""
    z = dot(phi.n, y)
    radial = axpy(-z, phi.n, y)
    rho = norm(radial)
    flat = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if rho <= reach:
        radial = (0.0, 0.0, 0.0) if rho == 0.0 else scale(1.0 / rho, radial)
        value = rho - phi.k1
        if phi.kind == CONE_OF:
            value = rho * phi.k1 - z * phi.k2
        elif phi.kind == CIRCLE_OF:
            value = sqrt((rho - phi.k1) * (rho - phi.k1) + z * z) - phi.k2
        return value, radial, flat, inf, inf
    out = scale(1.0 / rho, radial)
    around = cross(phi.n, out)
    c = 1.0 / (rho - reach)
    if phi.kind == AXIS_OF:
        return rho - phi.k1, out, outer(1.0 / rho, around, around), c, 0.0
    if phi.kind == CONE_OF:
        value = rho * phi.k1 - z * phi.k2
        gradient = axpy(phi.k1, out, scale(-phi.k2, phi.n))
        # so that c, its square and its cube times numbers bound derivatives that have one k1 each
        c = abs(phi.k1) ** THIRD_ROOT * c
        return value, gradient, outer(phi.k1 / rho, around, around), c, 0.0
    m = rho - phi.k1
    s = sqrt(m * m + z * z)
    if s <= reach:
        return s - phi.k2, out, flat, inf, inf
    gradient = axpy(m / s, out, scale(z / s, phi.n))
    along = axpy(-z / s, out, scale(m / s, phi.n))
    H = plus(outer(1.0 / s, along, along), outer(m / (s * rho), around, around))
    return s - phi.k2, gradient, H, 1.0 / (s - reach), c


@kernel
def centre_jet(phi, y, reach):
    s = norm(y)
    if s <= reach:
        return s - phi.k1, phi.n, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), inf, inf
    g = scale(1.0 / s, y)
    c = 1.0 / s
    H = plus((c, 0.0, 0.0, c, 0.0, c), outer(-c, g, g))
    return s - phi.k1, g, H, 1.0 / (s - reach), 0.0


@kernel
def screw_jet(phi, y, reach):
    """s (z - h angle) + t rho, of slopes (s, t) = e2 and the rise h."""
    z, h = dot(phi.n, y), phi.k1
    s, t = phi.e2[0], phi.e2[1]
    radial = axpy(-z, phi.n, y)
    rho = norm(radial)
    least = max(rho - reach, phi.k2)  # no point that is asked of is nearer to the axis
    if rho < phi.k2:
        return 0.0, phi.n, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), inf, inf
    out = scale(1.0 / rho, radial)
    around = cross(phi.n, out)
    angle = atan2(dot(cross(phi.n, phi.e1), y), dot(phi.e1, y))
    gradient = axpy(t, out, axpy(s, phi.n, scale(-s * h / rho, around)))
    H = plus(outer(2.0 * s * h / (rho * rho), out, around), outer(t / rho, around, around))
    # the angle's k-th derivative is at most (k - 1)! / rho^k
    second = abs(s * h) / (least * least) + abs(t) / least
    third = (2.0 * abs(s * h) / least + THIRD * abs(t)) / (least * least)
    return s * (z - h * angle) + t * rho, gradient, H, max(second, sqrt(third / THIRD)), 0.0


@kernel
def serves(phi, x, reach):
    """Is a potential 1-Lipschitz in the ball of radius `reach` round x?"""
    return phi.kind != SCREW_OF or dot(phi.e1, sub(x, phi.o)) - reach >= phi.k2


@kernel
def potential_jet(phi, x, reach):
    """(value, gradient, second derivatives, K1, K2) at x; within `reach` of x the second
    derivative is at most K1 + K2 and the third THIRD (K1² + K2²) + 3 K1 K2; inf: not known."""
    y = sub(x, phi.o)
    if phi.kind == TORUS_THROUGH:
        return torus_jet(phi, y, reach)
    if phi.kind == CENTRE_OF:
        value, g, H, c1, c2 = centre_jet(phi, y, reach)
    elif phi.kind == SCREW_OF:
        value, g, H, c1, c2 = screw_jet(phi, y, reach)
    else:
        value, g, H, c1, c2 = round_axis_jet(phi, y, reach)
    s = phi.sign
    return (
        s * value,
        scale(s, g),
        (s * H[0], s * H[1], s * H[2], s * H[3], s * H[4], s * H[5]),
        c1,
        c2,
    )
