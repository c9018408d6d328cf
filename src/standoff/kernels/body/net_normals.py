"""Cones of normals of Bezier patches, from their control nets.

The normal x_u × x_v of a polynomial patch is a polynomial of degrees (2 p - 1, 2 q - 1). Its
Bernstein coefficients span all normals (Farouki and Rajan, CAGD 1988), so a cone around them holds
these. Of a rational one, x = X / w, it is w X_u × X_v + w_v X × X_u - w_u X × X_v over w^3, the
former of degrees (3 p - 1, 3 q - 1).

Each row of a net has, of one coefficient after the other, X, by how much it may be wrong, w, and
the same of it: enough for the rounding of sums too. A *field* is a part of it times binomials, of
which products are plain convolutions.
"""

import math

import numpy as np

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
def part_of(field, i, j):
    """A vector of a field, its length, and by how much it may be wrong."""
    v = (field[i, j, 0], field[i, j, 1], field[i, j, 2])
    return v, math.sqrt(dot(v, v)), field[i, j, 3]


@kernel
def fields_of(net, row, p, q):
    """(vectors, weights) of a net of degrees (p, q): fields."""
    vectors, weights = np.empty((p + 1, q + 1, 4)), np.empty((p + 1, q + 1, 2))
    for i in range(p + 1):
        for j in range(q + 1):
            k = 6 * (i * (q + 1) + j)
            share = binomial(p, i) * binomial(q, j)
            for m in range(4):
                vectors[i, j, m] = share * net[row, k + m]
            weights[i, j, 0], weights[i, j, 1] = share * net[row, k + 4], share * net[row, k + 5]
    return vectors, weights


@kernel
def crossed(a, b):
    """The field a × b."""
    found = np.zeros((a.shape[0] + b.shape[0] - 1, a.shape[1] + b.shape[1] - 1, 4))
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            u, long_u, off_u = part_of(a, i, j)
            for k in range(b.shape[0]):
                for m in range(b.shape[1]):
                    v, long_v, off_v = part_of(b, k, m)
                    n = cross(u, v)
                    for axis in range(3):
                        found[i + k, j + m, axis] += n[axis]
                    found[i + k, j + m, 3] += (long_u + off_u) * off_v + off_u * long_v
    return found


@kernel
def add_weighted(weights, field, sign, found):
    """`found` plus a sign times weights times a field."""
    for i in range(weights.shape[0]):
        for j in range(weights.shape[1]):
            w, off_w = sign * weights[i, j, 0], weights[i, j, 1]
            for k in range(field.shape[0]):
                for m in range(field.shape[1]):
                    v, long, off = part_of(field, k, m)
                    for axis in range(3):
                        found[i + k, j + m, axis] += w * v[axis]
                    found[i + k, j + m, 3] += abs(w) * off + off_w * (long + off)


@kernel
def normals_of(nets, row, p, q, rational):
    """The field that spans the normals of one patch."""
    net, along_u, along_v = nets
    xu, wu = fields_of(along_u, row, p - 1, q)
    xv, wv = fields_of(along_v, row, p, q - 1)
    across = crossed(xu, xv)
    if not rational:
        return across
    x, w = fields_of(net, row, p, q)
    found = np.zeros((3 * p, 3 * q, 4))
    add_weighted(w, across, 1.0, found)
    add_weighted(wv, crossed(x, xu), 1.0, found)
    add_weighted(wu, crossed(x, xv), -1.0, found)
    return found


@kernel
def net_cone(normals, row, collapsed, out):
    """(axis, half angle) of a cone around the normals of one patch, pi where none is known.

    On a side that is a single point (`collapsed`, of u = 0, u = 1, v = 0 and v = 1) the normal
    vanishes, and the next coefficients are those of its quotient by the distance from the side.
    """
    last_u, last_v = normals.shape[0] - 1, normals.shape[1] - 1
    units = np.empty((normals.shape[0] * normals.shape[1], 3))
    count = 0
    lean = x = y = z = 0.0
    for a in range(last_u + 1):
        for b in range(last_v + 1):
            ends = (a == 0, a == last_u, b == 0, b == last_v)
            left_out = False
            for k in range(4):
                left_out = left_out or (ends[k] and collapsed[row, k] != 0.0)
            n, size, wrong = part_of(normals, a, b)
            if left_out or (size == 0.0 and wrong == 0.0):
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
