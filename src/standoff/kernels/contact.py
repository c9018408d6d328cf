"""Newton's method on the contact-regular form, y = (q, n, d).

Near contact H loses rank and the direction of dR its digits; this form keeps both, through d = 0
and in penetration. It is used there, and where an answer very near contact is not certified
otherwise; the feature pair is held.
"""

from math import sqrt

from standoff.kernels import layout as L
from standoff.kernels.certificate import cone_normal
from standoff.kernels.compiling import kernel, shared, stack_matrix, stack_reals
from standoff.kernels.descent import ORIGIN, pair_jets, recentre, walk_pair
from standoff.kernels.events import CORRECTIONS, EVALUATIONS, LIMIT
from standoff.kernels.features import chart_normal, dimension, pair_span
from standoff.kernels.lapack import least_squares
from standoff.kernels.system import contact_feedforward, contact_jacobian, contact_residual
from standoff.kernels.tolerances import CONTACT_STEPS, NEAR_CONTACT, PIVOT
from standoff.kernels.trimming import NO_HIT
from standoff.kernels.vectors import cross, dot, norm, rotate, scale, sub, unit


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
        scales[k] = span / length if length > 0.0 else sqrt(span)
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
def factor_and_solve(J, r, n):
    """Solve J x = r in place (Gauss, partial pivoting; J by rows): r becomes x. False where J is
    singular to PIVOT; J is lost."""
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(J[n * i + k]) > abs(J[n * pivot + k]):
                pivot = i
        if abs(J[n * pivot + k]) <= PIVOT:
            return False
        if pivot != k:
            for j in range(k, n):
                J[n * k + j], J[n * pivot + j] = J[n * pivot + j], J[n * k + j]
            r[k], r[pivot] = r[pivot], r[k]
        for i in range(k + 1, n):
            factor = J[n * i + k] / J[n * k + k]
            if factor != 0.0:
                for j in range(k + 1, n):
                    J[n * i + j] -= factor * J[n * k + j]
                r[i] -= factor * r[k]
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            r[k] -= J[n * k + j] * r[j]
        r[k] /= J[n * k + k]
    return True


@kernel
def scaled_jacobian(jet_a, jet_b, n, d, span, scales, J):
    contact_jacobian(jet_a, jet_b, n, d, J)
    for i in range(8):
        for j in range(8):
            J[8 * i + j] *= scales[i] * scales[j] / span


@kernel
def solve_contact(jet_a, jet_b, n, d, span, scales, r, x):
    """J^-1 r in scaled columns into x. Least squares of least norm serve parallel features, where
    J is singular and consistent; where its numbers are not finite, x is 0."""
    J = stack_matrix()
    scaled_jacobian(jet_a, jet_b, n, d, span, scales, J)
    for k in range(8):
        x[k] = r[k]
    if factor_and_solve(J, x, 8):
        return
    scaled_jacobian(jet_a, jet_b, n, d, span, scales, J)
    for i in range(8):
        x[i] = r[i]
        for j in range(i):
            J[8 * i + j], J[8 * j + i] = J[8 * j + i], J[8 * i + j]
    if not least_squares(J, x, 8, PIVOT):
        for k in range(8):
            x[k] = 0.0


@shared
def newton(pair, R, p, mode, q, n, d, span, counts):
    """(fits, error, n, d): Newton's method on r(y) = 0 with the features held; q in place.

    It ends where the residual (relative to the span) falls no more. A step that would leave a
    feature ends it (`fits` False): the caller's descent decides then.
    """
    jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    r, y, scales = stack_reals(), stack_reals(), stack_reals()
    contact_scales(jet_a, jet_b, span, scales)
    error = scaled_residual(jet_a, jet_b, n, d, span, scales, r)
    fits = True
    for _ in range(CONTACT_STEPS):
        if counts[EVALUATIONS] >= counts[LIMIT]:
            break
        solve_contact(jet_a, jet_b, n, d, span, scales, r, y)
        counts[EVALUATIONS] += 1
        step = (-y[0] * scales[0], -y[1] * scales[1], -y[2] * scales[2], -y[3] * scales[3])
        if walk_pair(pair, mode, q, step)[2] != NO_HIT:
            fits = False
            break
        old = (q[0], q[1], q[2], q[3])
        for k in range(4):
            q[k] += step[k]
        jet_a, jet_b = pair_jets(pair, R, p, mode, q)
        new_n = unit(sub(n, (y[4], y[5], y[6])))
        new_d = dot(new_n, sub(jet_b[0], jet_a[0]))
        contact_scales(jet_a, jet_b, span, scales)
        new_error = scaled_residual(jet_a, jet_b, new_n, new_d, span, scales, r)
        if not new_error < error:
            q[0], q[1], q[2], q[3] = old
            break
        n, d, error = new_n, new_d, new_error
        counts[CORRECTIONS] += 1
    recentre(pair, mode, q, counts)
    return fits, error, n, d


@kernel
def polish(pair, R, p, mode, q, counts):
    """(sharp, n): Newton steps on r(y) = 0 in the present mode, q changed in place.

    n is the common normal found, where the feature pair gives one (`sharp`).
    """
    jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    gap = sub(jet_b[0], jet_a[0])
    span = pair_span(pair, p, norm(gap))
    n, sharp = common_normal(pair, R, mode, q, jet_a, jet_b)
    if not sharp or norm(gap) > NEAR_CONTACT * span:
        return False, n
    _, _, n, _ = newton(pair, R, p, mode, q, n, dot(n, gap), span, counts)
    return True, n


@kernel
def contact_rates(pair, motion, jets, n, d, w_ff, counts):
    """The rate of n, and into w_ff those of the parameters: y' = -J^-1 r_t, at the witness points.

    motion is (R, p, v, w) of B in A's frame, where A is at rest.
    """
    jet_a, jet_b = jets
    _, p, v, w = motion
    span = pair_span(pair, p, abs(d))
    if span == 0.0:
        span = 1.0  # a point that touches a half-space or a point: any length will do
    r, y, scales = stack_reals(), stack_reals(), stack_reals()
    contact_scales(jet_a, jet_b, span, scales)
    r_t = contact_feedforward(jet_a, jet_b, n, ORIGIN, ORIGIN, ORIGIN, p, v, w)
    for k in range(8):
        r[k] = -r_t[k] * scales[k] / span
    solve_contact(jet_a, jet_b, n, d, span, scales, r, y)
    counts[EVALUATIONS] += 1
    for k in range(4):
        w_ff[k] = y[k] * scales[k]
    return (y[4], y[5], y[6])
