"""Cones of normals of polynomial Bezier patches, from their control nets.

The normal x_u × x_v is a polynomial of degrees (2 p - 1, 2 q - 1). Its Bernstein coefficients span
all normals (Farouki and Rajan, CAGD 1988), so a cone around them holds these.
"""

import math

from standoff.kernels.algebra.vectors import cross, dot
from standoff.kernels.compiler.decorators import kernel

# Steps of a cone's axis towards the vector farthest from it.
AXIS_STEPS = 40


@kernel
def binomial(n, k):
    found = 1.0
    for i in range(k):
        found = found * (n - i) / (i + 1)
    return found


@kernel
def edge_of(net, row, q, i, j, along_u):
    """A control point's difference from the next one along u, or along v."""
    k = 3 * (i * (q + 1) + j)
    m = k + 3 * (q + 1) if along_u else k + 3
    return (
        net[row, m] - net[row, k],
        net[row, m + 1] - net[row, k + 1],
        net[row, m + 2] - net[row, k + 2],
    )


@kernel
def normal_coefficient(net, row, degrees, a, b, off, rounding):
    """A coefficient of x_u × x_v up to a scale, and by how much it may be wrong, if control points
    are by `off`, length, and a sum is by a fraction `rounding` of its terms."""
    p, q = degrees
    x = y = z = wrong = 0.0
    whole = binomial(2 * p - 1, a) * binomial(2 * q - 1, b)
    for i in range(max(0, a - p), min(p - 1, a) + 1):
        for j in range(max(0, b - q + 1), min(q, b) + 1):
            k, m = a - i, b - j
            share = binomial(p - 1, i) * binomial(p, k) * binomial(q, j) * binomial(q - 1, m)
            du, dv = edge_of(net, row, q, i, j, True), edge_of(net, row, q, k, m, False)
            n = cross(du, dv)
            x, y, z = x + share * n[0], y + share * n[1], z + share * n[2]
            su, sv = math.sqrt(dot(du, du)), math.sqrt(dot(dv, dv))
            wrong += share * (2.0 * off * (su + sv + 2.0 * off) + rounding * su * sv)
    return (x / whole, y / whole, z / whole), wrong / whole


@kernel
def net_cone(net, row, degrees, off, collapsed, rounding, units, out):
    """(axis, half angle) of a cone around the normals of one patch, pi where none is known.

    On a side that is a single point (`collapsed`, of u = 0, u = 1, v = 0 and v = 1) the normal
    vanishes, and the next coefficients are those of its quotient by the distance from the side.
    """
    p, q = degrees
    count = 0
    lean = x = y = z = 0.0
    for a in range(2 * p):
        for b in range(2 * q):
            ends = (a == 0, a == 2 * p - 1, b == 0, b == 2 * q - 1)
            left_out = False
            for k in range(4):
                left_out = left_out or (ends[k] and collapsed[row, k] != 0.0)
            if left_out:
                continue
            n, wrong = normal_coefficient(net, row, degrees, a, b, off, rounding)
            size = math.sqrt(dot(n, n))
            if size == 0.0 and wrong == 0.0:
                continue
            if not size > 2.0 * wrong:
                out[row, 0], out[row, 1], out[row, 2], out[row, 3] = 0.0, 0.0, 1.0, math.pi
                return
            lean = max(lean, wrong / size)
            for m in range(3):
                units[count, m] = n[m] / size
            x, y, z = x + units[count, 0], y + units[count, 1], z + units[count, 2]
            count += 1
    axis, angle = centred(units, count, (x, y, z))
    angle += math.asin(min(lean, 1.0))
    if count == 0 or not angle < 0.5 * math.pi:
        angle = math.pi
    out[row, 0], out[row, 1], out[row, 2], out[row, 3] = axis[0], axis[1], axis[2], angle


@kernel
def centred(units, count, start):
    """The axis of a nearly smallest cone around unit vectors, and its half angle (Badoiu and
    Clarkson, SODA 2003)."""
    axis, best, least = start, (0.0, 0.0, 1.0), -2.0
    for step in range(AXIS_STEPS):
        size = math.sqrt(dot(axis, axis))
        if not size > 0.0:
            break
        axis = (axis[0] / size, axis[1] / size, axis[2] / size)
        far, most = 0, 2.0
        for k in range(count):
            cosine = axis[0] * units[k, 0] + axis[1] * units[k, 1] + axis[2] * units[k, 2]
            if cosine < most:
                far, most = k, cosine
        if most > least:
            best, least = axis, most
        share = 1.0 / (step + 2.0)
        axis = (
            axis[0] + share * (units[far, 0] - axis[0]),
            axis[1] + share * (units[far, 1] - axis[1]),
            axis[2] + share * (units[far, 2] - axis[2]),
        )
    angle = 0.0
    for k in range(count):
        unit = (units[k, 0], units[k, 1], units[k, 2])
        n = cross(best, unit)
        angle = max(angle, math.atan2(math.sqrt(dot(n, n)), dot(best, unit)))
    return best, angle
