"""Jets: a point of a surface or curve with its first and second partial derivatives.

Canonical forms stand behind an affine map, so an affine image of a body is exact. Adding a kind
is one function here, one number in ``layout`` and one line in the chain of ``surface_jet``.
"""

from math import cos, sin, sqrt

from standoff.kernels.compiling import small
from standoff.kernels.layout import (
    AFFINE,
    BEZIER,
    CONE,
    CONIC,
    CYLINDER,
    PLANE,
    SPHERE,
)

ZERO = (0.0, 0.0, 0.0)


@small
def plane_jet(u, v):
    return (u, v, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), ZERO, ZERO, ZERO


@small
def sphere_jet(u, v):
    """Unit sphere in the gnomonic chart (u, v, 1)/sqrt(1 + u² + v²): no pole, no trigonometry."""
    s = 1.0 / sqrt(1.0 + u * u + v * v)
    s3 = s * s * s
    s5 = s3 * s * s
    # s = (1 + u² + v²)^(-1/2) and its partials
    su = -u * s3
    sv = -v * s3
    suu = 3.0 * u * u * s5 - s3
    suv = 3.0 * u * v * s5
    svv = 3.0 * v * v * s5 - s3
    return (
        (u * s, v * s, s),
        (s + u * su, v * su, su),
        (u * sv, s + v * sv, sv),
        (2.0 * su + u * suu, v * suu, suu),
        (sv + u * suv, su + v * suv, suv),
        (u * svv, 2.0 * sv + v * svv, svv),
    )


@small
def cylinder_jet(u, v):
    c, s = cos(u), sin(u)
    return (c, s, v), (-s, c, 0.0), (0.0, 0.0, 1.0), (-c, -s, 0.0), ZERO, ZERO


@small
def cone_jet(u, v):
    """Apex at the origin, v = 0; v grows along the generators."""
    c, s = cos(u), sin(u)
    return (
        (v * c, v * s, v),
        (-v * s, v * c, 0.0),
        (c, s, 1.0),
        (-v * c, -v * s, 0.0),
        (-s, c, 0.0),
        ZERO,
    )


@small
def linear_map(reals, o, a):
    """The 3x3 at reals[o:o+9] applied to a."""
    return (
        reals[o] * a[0] + reals[o + 1] * a[1] + reals[o + 2] * a[2],
        reals[o + 3] * a[0] + reals[o + 4] * a[1] + reals[o + 5] * a[2],
        reals[o + 6] * a[0] + reals[o + 7] * a[1] + reals[o + 8] * a[2],
    )


@small
def affine_map(reals, o, a):
    x = linear_map(reals, o, a)
    return (x[0] + reals[o + 9], x[1] + reals[o + 10], x[2] + reals[o + 11])


@small
def canonical_jet(kind, u, v):
    if kind == PLANE:
        return plane_jet(u, v)
    if kind == SPHERE:
        return sphere_jet(u, v)
    if kind == CYLINDER:
        return cylinder_jet(u, v)
    if kind == CONE:
        return cone_jet(u, v)
    return ZERO, ZERO, ZERO, ZERO, ZERO, ZERO


@small
def surface_jet(reals, kind, o, u, v):
    """(x, x_u, x_v, x_uu, x_uv, x_vv) of the chart whose reals begin at o."""
    x, xu, xv, xuu, xuv, xvv = canonical_jet(kind, u, v)
    m = o + AFFINE
    return (
        affine_map(reals, m, x),
        linear_map(reals, m, xu),
        linear_map(reals, m, xv),
        linear_map(reals, m, xuu),
        linear_map(reals, m, xuv),
        linear_map(reals, m, xvv),
    )


@small
def chart_parameters(reals, o, x):
    """(u, v, depth) of a point of a gnomonic chart's surface; depth > 0 where the chart sees it."""
    m = o + AFFINE
    shift = (reals[m + 9], reals[m + 10], reals[m + 11])
    y = linear_map(reals, o + 12, (x[0] - shift[0], x[1] - shift[1], x[2] - shift[2]))
    if y[2] <= 0.0:
        return 0.0, 0.0, y[2]
    return y[0] / y[2], y[1] / y[2], y[2]


@small
def bezier_jet(reals, o, t):
    """Rational Bezier curve of any degree, by Bernstein sums over homogeneous control points.

    reals[o] is the degree n, then n + 1 points (w x, w y, w z, w).
    """
    n = int(reals[o])
    s = 1.0 - t
    # h, d, e: value, first and second derivative of each homogeneous coordinate
    hx = hy = hz = hw = 0.0
    dx = dy = dz = dw = 0.0
    ex = ey = ez = ew = 0.0
    for i in range(n + 1):
        b0 = bernstein(n, i, s, t)
        b1 = n * (bernstein(n - 1, i - 1, s, t) - bernstein(n - 1, i, s, t))
        b2 = (
            n
            * (n - 1)
            * (
                bernstein(n - 2, i - 2, s, t)
                - 2.0 * bernstein(n - 2, i - 1, s, t)
                + bernstein(n - 2, i, s, t)
            )
        )
        k = o + 1 + 4 * i
        hx += b0 * reals[k]
        hy += b0 * reals[k + 1]
        hz += b0 * reals[k + 2]
        hw += b0 * reals[k + 3]
        dx += b1 * reals[k]
        dy += b1 * reals[k + 1]
        dz += b1 * reals[k + 2]
        dw += b1 * reals[k + 3]
        ex += b2 * reals[k]
        ey += b2 * reals[k + 1]
        ez += b2 * reals[k + 2]
        ew += b2 * reals[k + 3]
    x = (hx / hw, hy / hw, hz / hw)
    xt = ((dx - dw * x[0]) / hw, (dy - dw * x[1]) / hw, (dz - dw * x[2]) / hw)
    xtt = (
        (ex - 2.0 * dw * xt[0] - ew * x[0]) / hw,
        (ey - 2.0 * dw * xt[1] - ew * x[1]) / hw,
        (ez - 2.0 * dw * xt[2] - ew * x[2]) / hw,
    )
    return x, xt, xtt


@small
def bernstein(n, i, s, t):
    if n < 0 or i < 0 or i > n:
        return 0.0
    c = 1.0
    for k in range(i):
        c = c * (n - k) / (k + 1)
    return c * s ** (n - i) * t**i


@small
def curve_jet(reals, kind, o, t):
    """(x, x_t, x_tt) of the curve whose data begin at o."""
    if kind == BEZIER:
        return bezier_jet(reals, o, t)
    if kind == CONIC:
        c, s = cos(t), sin(t)
        y, yt, ytt = (c, s, 0.0), (-s, c, 0.0), (-c, -s, 0.0)
    else:
        y, yt, ytt = (t, 0.0, 0.0), (1.0, 0.0, 0.0), ZERO
    return affine_map(reals, o, y), linear_map(reals, o, yt), linear_map(reals, o, ytt)


@small
def pcurve_point(reals, kind, o, t):
    """Homogeneous (u, v) and its derivative by t of the pcurve whose matrix begins at o."""
    if kind == CONIC:
        y, yt = (cos(t), sin(t), 1.0), (-sin(t), cos(t), 0.0)
    else:
        y, yt = (t, 0.0, 1.0), (1.0, 0.0, 0.0)
    return linear_map(reals, o, y), linear_map(reals, o, yt)
