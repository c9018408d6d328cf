"""Superellipsoids ((|x|^m2 + |y|^m2)^(m1/m2) + |z|^m1 = 1) in gnomonic charts: no pole.

m1 = 2/e1 and m2 = 2/e2 are both 1 or more. The point of direction y = (u, v, 1) is y F(y)^(-1/m1);
z is the chart's axis (pole) or v (side, about the x axis: u along the equator). Exponents below 2
make the curvature infinite on the coordinate planes; the charts resolve it by the relative
precision of u and v near 0.
"""

from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.tolerances import CREASE_FLOOR


@kernel
def power_jet(x, m):
    """|x|^m with its first and second derivative by x."""
    a = abs(x)
    sign = 1.0 if x >= 0.0 else -1.0
    if m < 2.0:
        a = max(a, CREASE_FLOOR)
        if x == 0.0:
            sign = 0.0
    if a == 0.0:
        return 0.0, 0.0, (2.0 if m == 2.0 else 0.0)
    second = a ** (m - 2.0)
    return second * a * a, m * sign * second * a, m * (m - 1.0) * second


@kernel
def pole_form(m1, m2, u, v):
    """F = (|u|^m2 + |v|^m2)^(m1/m2) + 1 and its partials, scaled by max(|u|, |v|)."""
    size = max(abs(u), abs(v))
    if size < CREASE_FLOOR:
        if size == 0.0:
            u = v = CREASE_FLOOR
        size = CREASE_FLOOR
    a, au, auu = power_jet(u / size, m2)
    b, bv, bvv = power_jet(v / size, m2)
    k = m1 / m2
    p = a + b
    p2 = k * p ** (k - 2.0)
    p1 = p2 * p
    top = size ** (m1 - 2.0)
    return (
        top * size * size * p**k + 1.0,
        top * size * p1 * au,
        top * size * p1 * bv,
        top * ((k - 1.0) * p2 * au * au + p1 * auu),
        top * (k - 1.0) * p2 * au * bv,
        top * ((k - 1.0) * p2 * bv * bv + p1 * bvv),
    )


@kernel
def side_form(m1, m2, u, v):
    """F = (1 + |u|^m2)^(m1/m2) + |v|^m1 and its partials."""
    a, au, auu = power_jet(u, m2)
    b, bv, bvv = power_jet(v, m1)
    k = m1 / m2
    p = 1.0 + a
    p2 = k * p ** (k - 2.0)
    p1 = p2 * p
    return p**k + b, p1 * au, bv, (k - 1.0) * p2 * au * au + p1 * auu, 0.0, bvv


@kernel
def superellipsoid_jet(m1, m2, pole, u, v):
    F, fu, fv, fuu, fuv, fvv = pole_form(m1, m2, u, v) if pole else side_form(m1, m2, u, v)
    n = -1.0 / m1
    s = F**n
    d1 = n * s / F
    d2 = (n - 1.0) * d1 / F
    su, sv = d1 * fu, d1 * fv
    suu = d2 * fu * fu + d1 * fuu
    suv = d2 * fu * fv + d1 * fuv
    svv = d2 * fv * fv + d1 * fvv
    return (
        (u * s, v * s, s),
        (s + u * su, v * su, su),
        (u * sv, s + v * sv, sv),
        (2.0 * su + u * suu, v * suu, suu),
        (sv + u * suv, su + v * suv, suv),
        (u * svv, 2.0 * sv + v * svv, svv),
    )
