"""Derivatives of the signed distance, the normal and the witness points by both bodies' poses.

By the 12 unit twists (v_A, w_A, v_B, w_B) in world axes, R <- exp(w) R, p <- p + v. An optimum is
a root of the contact-regular form r(y) = 0, y = (q, n, d), and stays one while the bodies move:
dy = -J^-1 r_t, once for each unit twist. This is regular apart, in contact and in penetration.

Where J is singular, as in flat and line contact, its null directions are those in which the witness
points may go with n and d held. All optimal pairs (x, y) share n; along any motion, the derivative
of d is the least of n . (y' - x') over them. So the gradient (-n, -a x n, n, c x n) keeps its
components by translation, and those by turns about axes e with e . (delta x n) = 0 for all ways
delta that the points may go: there all pairs agree.

All vectors are in world axes, from A's origin. Lengths are those of the cores.
"""

from math import nan
from typing import Any, NamedTuple

from standoff.kernels.algebra.full_pivoting import factor_fully, solve_factored
from standoff.kernels.algebra.symmetric import least_norm_solve, symmetric_eigen
from standoff.kernels.algebra.vectors import add, axpy, cross, rotate_back, scale, sub, unit
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import moved_jet, pair_span
from standoff.kernels.compiler.decorators import (
    ahead,
    ints_on_stack,
    kernel,
    reals_on_stack,
    stack_matrix,
    stack_reals,
)
from standoff.kernels.pair.beside import beside_another, off_seams
from standoff.kernels.pair.contact_newton import (
    contact_scales,
    scaled_jacobian,
    scaled_residual,
)
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.system import contact_feedforward
from standoff.kernels.tolerances import (
    NEWTON_ROUNDS,
    SETTLED,
    SETTLED_STEP,
    SINGULAR_SYSTEM,
    SQUARE_AXIS,
    TURNING_NORMAL,
)
from standoff.kernels.values import ORIGIN, Place, Pose, Vector, moved, side_of, with_side

# What derivatives are written, one after the other, each by rows.
GRADIENT, NORMAL_JACOBIAN, POINT_JACOBIAN_A, POINT_JACOBIAN_B, HESSIAN = 0, 12, 48, 84, 120
N_DERIVATIVES = 264

# What came of it. All but SMOOTH and the BESIDEs leave the gradient alone at most: SINGULAR the
# components that exist, and nan; SINGULAR_BESIDE those of the answer's own pair of points, of which
# the set of all pairs tells which exist; the others nothing.
SMOOTH, BESIDE_A, BESIDE_B, SINGULAR, SINGULAR_BESIDE = range(5)
UNDETERMINED, NOT_AT_REST, NO_DISTANCE, EQUALLY_DEEP = range(5, 9)

# Columns of the rates, one a unit twist, 8 numbers each.
N_TWISTS, N_SYSTEM = 12, 8
N_RATES, N_ORDER = N_TWISTS * N_SYSTEM, 2 * N_SYSTEM
UNIT = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
NORMAL_Z = 6  # of y: planar bodies have none


class Optimum(NamedTuple):
    """An optimum of two features, brought to roundoff."""

    kind: int  # SMOOTH where all is regular, SINGULAR, UNDETERMINED or NOT_AT_REST
    place: Place
    jets: Any  # both, world axes from A's origin
    normal: Vector
    distance: float
    span: float


class Factor(NamedTuple):
    """The factor of the scaled J and what it was scaled by, as pointers."""

    J: Any
    order: Any
    scales: Any


@kernel
def planar(pair):
    return pair.ints_a[L.DIMENSION] == 2 or pair.ints_b[L.DIMENSION] == 2


@kernel
def world_jets(pair, pose, turn, place):
    """Both jets in world axes from A's origin."""
    jet_a, jet_b = pair_jets(pair, pose, place)
    return moved_jet(turn, jet_a), moved_jet(turn, jet_b)


@kernel
def build_system(jets, n, d, span, flat, factor):
    """The scaled J, not factored. `flat`: of planar bodies, whose normal has no third component."""
    J = factor.J
    scaled_jacobian(jets[0], jets[1], n, d, span, factor.scales, J)
    if flat:
        for k in range(N_SYSTEM):
            J[N_SYSTEM * NORMAL_Z + k] = J[N_SYSTEM * k + NORMAL_Z] = 0.0
        J[N_SYSTEM * NORMAL_Z + NORMAL_Z] = 1.0


@kernel
def solved(jets, n, d, span, flat, r, factor):
    """r becomes J^-1 r, J its factor; what J is. Where it is singular r becomes the least x that
    serves, which is 0 along the null directions."""
    build_system(jets, n, d, span, flat, factor)
    if flat:
        r[NORMAL_Z] = 0.0
    if factor_fully(factor.J, factor.order, N_SYSTEM) > SINGULAR_SYSTEM:
        solve_factored(factor.J, factor.order, r, stack_reals(), N_SYSTEM)
        return SMOOTH
    build_system(jets, n, d, span, flat, factor)
    finite = least_norm_solve(factor.J, r, N_SYSTEM, SINGULAR_SYSTEM)
    return SINGULAR if finite else UNDETERMINED


@kernel
def at_optimum(pair, pose, turn, place, n, d, factor):
    """The optimum that Newton's method on r(y) = 0 ends at, with the features held; J, where it is
    regular, is left factored there."""
    span = pair_span(pair, pose.p, abs(d)) + pair.reals_a[L.RADIUS] + pair.reals_b[L.RADIUS]
    span = span if span > 0.0 else 1.0  # a point that touches a half-space or a point: any length
    flat = planar(pair)
    r, scales = stack_reals(), factor.scales
    jets = world_jets(pair, pose, turn, place)
    kind = SMOOTH
    for k in range(NEWTON_ROUNDS + 1):
        contact_scales(jets[0], jets[1], span, scales)
        if not scaled_residual(jets[0], jets[1], n, d, span, scales, r) <= SETTLED:
            return Optimum(NOT_AT_REST, place, jets, n, d, span)
        kind = solved(jets, n, d, span, flat, r, factor)
        if kind == UNDETERMINED:
            return Optimum(UNDETERMINED, place, jets, n, d, span)
        most = 0.0
        for i in range(N_SYSTEM):
            most = max(most, abs(r[i]))
        if most <= SETTLED_STEP or k == NEWTON_ROUNDS:
            break
        step = (-r[0] * scales[0], -r[1] * scales[1], -r[2] * scales[2], -r[3] * scales[3])
        place = moved(place, 1.0, step)
        n, d = unit(sub(n, (r[4], r[5], r[6]))), d - span * r[7]
        jets = world_jets(pair, pose, turn, place)
    return Optimum(kind, place, jets, n, d, span)


@kernel
def unit_motions(k, p):
    """The motions (p, v, w) of A and B, B's origin at p, by unit twist k."""
    e = UNIT[k % 3]
    still_b = (p, ORIGIN, ORIGIN)
    if k < 3:
        return (ORIGIN, e, ORIGIN), still_b
    if k < 6:
        return (ORIGIN, ORIGIN, e), still_b
    if k < 9:
        return (ORIGIN, ORIGIN, ORIGIN), (p, e, ORIGIN)
    return (ORIGIN, ORIGIN, ORIGIN), (p, ORIGIN, e)


@kernel
def off_plane(k):
    """Does unit twist k lead out of the plane z = 0?"""
    of_body = k % 6
    return 2 <= of_body <= 4


@kernel
def rates_of(optimum, p, flat, factor, rates):
    """dy by each unit twist into `rates` (12 x 8): -J^-1 r_t."""
    y, scales = stack_reals(), factor.scales
    jets, n, span = optimum.jets, optimum.normal, optimum.span
    for k in range(N_TWISTS):
        column = ahead(rates, N_SYSTEM * k)
        if flat and off_plane(k):
            for i in range(N_SYSTEM):
                column[i] = 0.0
            continue
        if 6 <= k < 9:  # B's translation is A's the other way
            for i in range(N_SYSTEM):
                column[i] = -rates[N_SYSTEM * (k - 6) + i]
            continue
        motion_a, motion_b = unit_motions(k, p)
        r_t = contact_feedforward(jets[0], jets[1], n, motion_a, motion_b)
        for i in range(N_SYSTEM):
            column[i] = -r_t[i] * scales[i] / span
        if flat:
            column[NORMAL_Z] = 0.0
        solve_factored(factor.J, factor.order, column, y, N_SYSTEM)
        for i in range(N_SYSTEM):
            column[i] *= scales[i]


@kernel
def write_column(x, to, k):
    """A vector as column k of three rows."""
    to[k], to[N_TWISTS + k], to[2 * N_TWISTS + k] = x[0], x[1], x[2]


@kernel
def write_side(side, optimum, arm, radius, flat, rates, to):
    """One body's rows of dn, of its witness point and of the gradient's change.

    Its part of the gradient is (s n, s arm x n), s = -1 of A and 1 of B. Its witness point has the
    velocity F q' + w x arm + v, and on the swept surface -s radius n' more.
    """
    s, n, jet = (-1.0, 1.0)[side], optimum.normal, optimum.jets[side]
    points = ahead(to, POINT_JACOBIAN_A if side == 0 else POINT_JACOBIAN_B)
    of_v, of_w = ahead(to, HESSIAN + 72 * side), ahead(to, HESSIAN + 72 * side + 36)
    for k in range(N_TWISTS):
        rate = ahead(rates, N_SYSTEM * k)
        dn = (rate[4], rate[5], rate[6])
        along = axpy(rate[2 * side], jet[1], scale(rate[2 * side + 1], jet[2]))
        own = k // 6 == side and not (flat and off_plane(k))
        if own and k % 6 >= 3:
            along = add(along, cross(UNIT[k % 3], arm))
        write_column(scale(s, dn), of_v, k)
        write_column(scale(s, sub(cross(arm, dn), cross(n, along))), of_w, k)
        point = axpy(-s * radius, dn, along)
        if own and k % 6 < 3:
            point = add(point, UNIT[k % 3])
        write_column(point, points, k)
        write_column(dn, ahead(to, NORMAL_JACOBIAN), k)


@kernel
def write_gradient(n, arm_a, arm_b, flat, to):
    """(-n, -a x n, n, c x n), with the arms a and c of the witness points."""
    parts = (scale(-1.0, n), scale(-1.0, cross(arm_a, n)), n, cross(arm_b, n))
    for i in range(4):
        for j in range(3):
            k = 3 * i + j
            to[GRADIENT + k] = 0.0 if flat and off_plane(k) else parts[i][j]


@kernel
def symmetrise(hessian, flat):
    """The chart's Hessian is the symmetric part of the gradient's change."""
    for i in range(N_TWISTS):
        for j in range(i + 1):
            mean = 0.5 * (hessian[N_TWISTS * i + j] + hessian[N_TWISTS * j + i])
            if flat and (off_plane(i) or off_plane(j)):
                mean = 0.0
            hessian[N_TWISTS * i + j] = hessian[N_TWISTS * j + i] = mean


@kernel
def clear_turns(optimum, flat, factor, to):
    """NaN in the gradient's components by turns that the null directions of J change; whether n is
    held along all of them."""
    J, values, scales = factor.J, stack_reals(), factor.scales
    build_system(optimum.jets, optimum.normal, optimum.distance, optimum.span, flat, factor)
    symmetric_eigen(J, values, N_SYSTEM)
    least = greatest = abs(values[0])
    for i in range(1, N_SYSTEM):
        least, greatest = min(least, abs(values[i])), max(greatest, abs(values[i]))
    # pivots called J singular: the least eigenvalue is null whatever its size
    null = max(least, SINGULAR_SYSTEM * greatest)
    for i in range(N_SYSTEM):
        if abs(values[i]) > null:
            continue
        y = ahead(J, N_SYSTEM * i)
        if max(abs(y[4]), abs(y[5]), abs(y[6])) > TURNING_NORMAL:
            return False
        for side in range(2):
            jet = optimum.jets[side]
            along_p = scale(y[2 * side] * scales[2 * side], jet[1])
            way = axpy(y[2 * side + 1] * scales[2 * side + 1], jet[2], along_p)
            change = cross(way, optimum.normal)
            for j in range(3):
                k = 6 * side + 3 + j
                if abs(change[j]) > SQUARE_AXIS * optimum.span:
                    to[GRADIENT + k] = nan
    return True


@kernel
def beside(pair, Ra, pose, optimum):
    """BESIDE_A or BESIDE_B where a witness point lies on another feature too, else SMOOTH."""
    inward = rotate_back(Ra, optimum.normal)
    if beside_another(pair.ints_a, pair.reals_a, side_of(optimum.place, 0), inward):
        return BESIDE_A
    back = scale(-1.0, rotate_back(pose.R, inward))
    if beside_another(pair.ints_b, pair.reals_b, side_of(optimum.place, 1), back):
        return BESIDE_B
    return SMOOTH


@kernel
def differentiate(pair, Ra, pose, place, n, d, everything, to):
    """Derivatives of an answer into `to`, N_DERIVATIVES numbers, the gradient alone where not
    `everything`; what came of it.

    Ra turns A's axes into the world's; pose is B's in A's frame; n, in world axes, and d are the
    answer's.
    """
    factor = Factor(stack_matrix(), ints_on_stack(N_ORDER), stack_reals())
    turn = Pose(Ra, ORIGIN)
    place = with_side(place, 0, off_seams(pair.ints_a, pair.reals_a, side_of(place, 0)))
    place = with_side(place, 1, off_seams(pair.ints_b, pair.reals_b, side_of(place, 1)))
    found = at_optimum(pair, pose, turn, place, n, d, factor)
    if found.kind == UNDETERMINED or found.kind == NOT_AT_REST:
        return found.kind
    flat = planar(pair)
    p = moved_jet(turn, (pose.p, ORIGIN, ORIGIN, ORIGIN, ORIGIN, ORIGIN))[0]
    arm_a, arm_b = found.jets[0][0], sub(found.jets[1][0], p)
    write_gradient(found.normal, arm_a, arm_b, flat, to)
    boundary = beside(pair, Ra, pose, found)
    if found.kind == SINGULAR:
        if boundary != SMOOTH:
            return SINGULAR_BESIDE
        return SINGULAR if clear_turns(found, flat, factor, to) else UNDETERMINED
    if everything:
        rates = reals_on_stack(N_RATES)
        rates_of(found, p, flat, factor, rates)
        write_side(0, found, arm_a, pair.reals_a[L.RADIUS], flat, rates, to)
        write_side(1, found, arm_b, pair.reals_b[L.RADIUS], flat, rates, to)
        symmetrise(ahead(to, HESSIAN), flat)
    return boundary
