"""Newton's method on the contact-regular form, y = (q, n, d).

Near contact H loses rank and the direction of dR its digits; this form keeps both, through d = 0
and in penetration. It is used there, and where an answer very near contact is not certified
otherwise; the feature pair is held.
"""

from typing import NamedTuple

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.symmetric import least_norm_solve
from standoff.kernels.algebra.vectors import cross, dot, norm, rotate, scale, sub, unit
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_normal, dimension, pair_span
from standoff.kernels.body.trimming import NO_HIT
from standoff.kernels.compiler.decorators import kernel, shared, small, stack_matrix, stack_reals
from standoff.kernels.pair.certificate import (
    CIRCLE,
    cones_at,
    into_b,
    nearest_normal,
)
from standoff.kernels.pair.descent import pair_jets, recentre, walk_pair
from standoff.kernels.pair.events import CORRECTIONS, EVALUATIONS, exhausted
from standoff.kernels.pair.system import contact_feedforward, contact_jacobian, contact_residual
from standoff.kernels.tolerances import CONTACT_STEPS, NEAR_CONTACT, PIVOT
from standoff.kernels.values import STILL, Place, Vector, moved, of_origin, side_of


@small
def nearest_of_a(pair, place, cones, n):
    """`nearest_normal` of A."""
    return nearest_normal(pair.ints_a, pair.reals_a, place.feature_a, cones.a, n)


@small
def nearest_of_b(pair, place, cones, m):
    """`nearest_normal` of B, in B's frame."""
    return nearest_normal(pair.ints_b, pair.reals_b, place.feature_b, cones.b, m)


@kernel
def facing(pair, pose, place, cones, n):
    """How nearly is n a normal of A and -n one of B? 2 where both are."""
    m = into_b(pose.R, n)
    of_a = dot(n, nearest_of_a(pair, place, cones, n)[0])
    return of_a + dot(m, nearest_of_b(pair, place, cones, m)[0])


@kernel
def outward(pair, pose, place, cones, n):
    """Of the two directions of two edges' common perpendicular the one from A to B: by their faces'
    normals, or by the gap where neither has any."""
    back = scale(-1.0, n)
    if cones.a.kind == CIRCLE and cones.b.kind == CIRCLE:
        return n if dot(n, cones.gap) >= 0.0 else back
    ahead, behind = facing(pair, pose, place, cones, n), facing(pair, pose, place, cones, back)
    return n if ahead >= behind else back


@kernel
def common_normal(pair, pose, place, jets):
    """(n, sharp): the normal from A to B that a feature pair itself gives, in A's frame.

    A face's normal, or the common perpendicular of two edges: both keep their digits at any
    distance. Else the direction between the witness points, which does not (`sharp` False).
    """
    ia, ra, ib, rb = pair
    jet_a, jet_b = jets
    a, b = side_of(place, 0), side_of(place, 1)
    if dimension(ia, a.feature) == 2:
        return chart_normal(ia, ra, a.chart, a.p, a.q), True
    if dimension(ib, b.feature) == 2:
        return scale(-1.0, rotate(pose.R, chart_normal(ib, rb, b.chart, b.p, b.q))), True
    gap = sub(jet_b[0], jet_a[0])
    perpendicular = cross(unit(jet_a[1]), unit(jet_b[1]))
    if ia[L.DIMENSION] == 3 and dot(perpendicular, perpendicular) > PIVOT:
        cones = cones_at(pair, pose, place, jets)
        return outward(pair, pose, place, cones, unit(perpendicular)), True
    if ia[L.DIMENSION] == 2 and dimension(ia, a.feature) == 1:
        return nearest_of_a(pair, place, cones_at(pair, pose, place, jets), unit(gap))[0], True
    if ib[L.DIMENSION] == 2 and dimension(ib, b.feature) == 1:
        m, _ = nearest_of_b(pair, place, cones_at(pair, pose, place, jets), unit(gap))
        return scale(-1.0, rotate(pose.R, m)), True
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
        if not abs(J[n * pivot + k]) > PIVOT:  # nor where it is not a number
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
    """J^-1 r in scaled columns into x; whether J is regular. Least squares of least norm serve
    parallel features, where J is singular and consistent; where its numbers are not finite, x is
    0."""
    J = stack_matrix()
    scaled_jacobian(jet_a, jet_b, n, d, span, scales, J)
    for k in range(8):
        x[k] = r[k]
    if factor_and_solve(J, x, 8):
        return True
    scaled_jacobian(jet_a, jet_b, n, d, span, scales, J)
    for k in range(8):
        x[k] = r[k]
    if not least_norm_solve(J, x, 8, PIVOT):
        for k in range(8):
            x[k] = 0.0
    return False


class Stationary(NamedTuple):
    """Where Newton's method on the contact-regular form ended."""

    fits: bool  # no step would have left a feature: else the caller's descent decides
    error: float  # the residual, relative to the span
    normal: Vector
    distance: float  # signed, along the normal
    place: Place


@shared
def newton(pair, pose, place, n, d, span, work):
    """Newton's method on r(y) = 0 with the features held.

    It ends where the residual no longer falls.
    """
    jet_a, jet_b = pair_jets(pair, pose, place)
    r, y, scales = stack_reals(), stack_reals(), stack_reals()
    contact_scales(jet_a, jet_b, span, scales)
    error = scaled_residual(jet_a, jet_b, n, d, span, scales, r)
    fits = True
    for _ in range(CONTACT_STEPS):
        if exhausted(work):
            break
        solve_contact(jet_a, jet_b, n, d, span, scales, r, y)
        work.counts[EVALUATIONS] += 1
        step = (-y[0] * scales[0], -y[1] * scales[1], -y[2] * scales[2], -y[3] * scales[3])
        if walk_pair(pair, place, step)[1].kind != NO_HIT:
            fits = False
            break
        trial = moved(place, 1.0, step)
        jet_a, jet_b = pair_jets(pair, pose, trial)
        new_n = unit(sub(n, (y[4], y[5], y[6])))
        new_d = dot(new_n, sub(jet_b[0], jet_a[0]))
        contact_scales(jet_a, jet_b, span, scales)
        new_error = scaled_residual(jet_a, jet_b, new_n, new_d, span, scales, r)
        if not new_error < error:
            break
        place, n, d, error = trial, new_n, new_d, new_error
        work.counts[CORRECTIONS] += 1
    place, _ = recentre(pair, place, work)
    return Stationary(fits, error, n, d, place)


@kernel
def polish(pair, pose, place, work):
    """(sharp, n, place): Newton steps on r(y) = 0 in the present mode.

    n is the common normal found, where the feature pair gives one (`sharp`).
    """
    jets = pair_jets(pair, pose, place)
    gap = sub(jets[1][0], jets[0][0])
    span = pair_span(pair, pose.p, norm(gap))
    n, sharp = common_normal(pair, pose, place, jets)
    if not sharp or norm(gap) > NEAR_CONTACT * span:
        return False, n, place
    ended = newton(pair, pose, place, n, dot(n, gap), span, work)
    return True, ended.normal, ended.place


@kernel
def contact_rates(pair, motion, jets, n, d, work):
    """(rate of n, rates of the parameters): y' = -J^-1 r_t, at the witness points."""
    jet_a, jet_b = jets
    p = motion.pose.p
    span = pair_span(pair, p, abs(d))
    if span == 0.0:
        span = 1.0  # a point that touches a half-space or a point: any length will do
    r, y, scales = stack_reals(), stack_reals(), stack_reals()
    contact_scales(jet_a, jet_b, span, scales)
    r_t = contact_feedforward(jet_a, jet_b, n, STILL, of_origin(motion))
    for k in range(8):
        r[k] = -r_t[k] * scales[k] / span
    solve_contact(jet_a, jet_b, n, d, span, scales, r, y)
    work.counts[EVALUATIONS] += 1
    rates = (y[0] * scales[0], y[1] * scales[1], y[2] * scales[2], y[3] * scales[3])
    return (y[4], y[5], y[6]), rates
