"""Newton's method on the contact-regular form, y = (q, n, d).

Near contact H loses rank and the direction of dR its digits; this form keeps both. It is used
where an answer very near contact is not certified otherwise; the feature pair is held.
"""

from math import sqrt

import numpy as np

from standoff.kernels import layout as L
from standoff.kernels.certificate import cone_normal
from standoff.kernels.compiling import kernel
from standoff.kernels.descent import pair_jets, recentre, walk_pair
from standoff.kernels.events import CORRECTIONS, EVALUATIONS
from standoff.kernels.features import chart_normal, dimension, pair_span
from standoff.kernels.system import contact_jacobian, contact_residual
from standoff.kernels.tolerances import CONTACT_STEPS, NEAR_CONTACT, PIVOT
from standoff.kernels.trimming import NO_HIT
from standoff.kernels.vectors import add, cross, dot, norm, rotate, scale, sub, unit


@kernel
def common_normal(pair, R, mode, q, jet_a, jet_b):
    """(n, sharp): the normal from A to B that a feature pair itself gives, in A's frame.

    A face's normal, or the common perpendicular of two edges: both keep their digits at any
    distance. Else the direction between the witness points, which does not (`sharp` False).
    """
    ia, ra, ib, rb = pair
    if dimension(ia, mode[0]) == 2:
        return chart_normal(ia, ra, mode[1], q[0], q[1]), True
    if dimension(ib, mode[2]) == 2:
        return scale(-1.0, rotate(R, chart_normal(ib, rb, mode[3], q[2], q[3]))), True
    gap = sub(jet_b[0], jet_a[0])
    perpendicular = cross(unit(jet_a[1]), unit(jet_b[1]))
    if ia[L.DIMENSION] == 3 and dot(perpendicular, perpendicular) > PIVOT:
        n = unit(perpendicular)
        m, _ = cone_normal(ia, ra, mode[0], mode[1], q[0], q[1], n)
        return n if dot(n, m) >= 0.0 else scale(-1.0, n), True
    if ia[L.DIMENSION] == 2 and dimension(ia, mode[0]) == 1:
        return cone_normal(ia, ra, mode[0], mode[1], q[0], q[1], unit(gap))[0], True
    if ib[L.DIMENSION] == 2 and dimension(ib, mode[2]) == 1:
        m, _ = cone_normal(ib, rb, mode[2], mode[3], q[2], q[3], unit(gap))
        return scale(-1.0, rotate(R, m)), True
    return unit(gap), False


@kernel
def contact_scales(jet_a, jet_b, span, scales):
    """Lengths of tangents and the span make J dimensionless: columns q, n, d."""
    for k in range(4):
        tangent = jet_a[1 + k] if k < 2 else jet_b[k - 1]
        length = norm(tangent)
        scales[k] = span / length if length > 0.0 else 1.0
    for k in range(4, 7):
        scales[k] = 1.0
    scales[7] = span


@kernel
def scaled_residual(jet_a, jet_b, n, d, span, scales, r):
    residual = contact_residual(jet_a, jet_b, n, d)
    total = 0.0
    for k in range(8):
        r[k] = residual[k] * scales[k] / span
        total += r[k] * r[k]
    return sqrt(total)


@kernel
def polish(pair, R, p, mode, q, counts):
    """(sharp, n): Newton steps on r(y) = 0 in the present mode, q changed in place.

    n is the common normal found, where the feature pair gives one (`sharp`).

    Least squares of least norm serve parallel features, where J is singular and consistent.
    A step that would leave a feature ends it: the caller's switching functions decide then.
    """
    jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    gap = sub(jet_b[0], jet_a[0])
    span = pair_span(pair, p, norm(gap))
    n, sharp = common_normal(pair, R, mode, q, jet_a, jet_b)
    if not sharp or norm(gap) > NEAR_CONTACT * span:
        return False, n
    J, r, scales = np.empty((8, 8)), np.empty(8), np.empty(8)
    contact_scales(jet_a, jet_b, span, scales)
    d = dot(n, gap)
    error = scaled_residual(jet_a, jet_b, n, d, span, scales, r)
    for _ in range(CONTACT_STEPS):
        contact_jacobian(jet_a, jet_b, n, d, J)
        for i in range(8):
            for j in range(8):
                J[i, j] *= scales[i] * scales[j] / span
        y = np.linalg.lstsq(J, -r, PIVOT)[0]
        counts[EVALUATIONS] += 1
        step = (y[0] * scales[0], y[1] * scales[1], y[2] * scales[2], y[3] * scales[3])
        if walk_pair(pair, mode, q, step)[2] != NO_HIT:
            break
        old = (q[0], q[1], q[2], q[3])
        for k in range(4):
            q[k] += step[k]
        jet_a, jet_b = pair_jets(pair, R, p, mode, q)
        new_n = unit(add(n, (y[4], y[5], y[6])))
        new_d = dot(new_n, sub(jet_b[0], jet_a[0]))
        contact_scales(jet_a, jet_b, span, scales)
        new_error = scaled_residual(jet_a, jet_b, new_n, new_d, span, scales, r)
        if not new_error < error:
            q[0], q[1], q[2], q[3] = old
            break
        n, d, error = new_n, new_d, new_error
        counts[CORRECTIONS] += 1
    recentre(pair, mode, q, counts)
    return True, n
