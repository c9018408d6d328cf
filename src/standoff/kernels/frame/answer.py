"""From witness points in A's frame to the answer in world axes, with its status and rates."""

from math import inf

import numpy as np

from standoff.kernels.algebra.rigid import read_rotation, read_vector
from standoff.kernels.algebra.vectors import add, axpy, cross, dot, rotate, scale, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import pair_slack, pair_span
from standoff.kernels.compiler.decorators import kernel, small
from standoff.kernels.pair.certified import (
    CERTIFIED,
    OVERLAP,
    PENETRATING,
    STAYED,
    TOUCHING_OR_OVERLAPPING,
    UNCERTIFIED,
)
from standoff.kernels.pair.newton import gradient_norm
from standoff.kernels.pair.system import gradient, projection_errors
from standoff.kernels.state.arrays import (
    CONVERGED,
    DEADLINE,
    DISTANCE,
    GLOBAL,
    LOCAL,
    LOWER_BOUND,
    NORMAL,
    NOT_CERTIFIED,
    NOT_RESTARTED,
    OUT_MODE,
    OUT_Q,
    OUT_RATE,
    OVERLAPPING,
    POINT_A,
    POINT_B,
    RESIDUAL,
    STATUS,
    TRACKING,
    UPPER_BOUND,
    VELOCITY_A,
    VELOCITY_B,
)
from standoff.kernels.tolerances import DEPTH_PROOF, START_GAP, TOUCHING
from standoff.kernels.values import ORIGIN


@kernel
def is_least_depth(pair, p, found):
    """Do the bounds prove that no other depth is smaller?"""
    radii = pair.reals_a[L.RADIUS] + pair.reals_b[L.RADIUS]
    d, span = found.distance, pair_span(pair, p, abs(found.distance))
    proof = DEPTH_PROOF * (radii - d) + TOUCHING * span + pair_slack(pair)
    return found.upper - d <= proof


@kernel
def judge(pair, p, found, lenient, tolerance, cut):
    """The status of an answer, from its bounds. `lenient`: it is TRACKING if it still converges.
    `cut`: the evaluations ran out."""
    if found.outcome == STAYED:
        return NOT_RESTARTED
    outcome, d, lower = found.outcome, found.distance, found.lower
    radii = pair.reals_a[L.RADIUS] + pair.reals_b[L.RADIUS]
    goal = START_GAP if tolerance == inf else tolerance
    span = pair_span(pair, p, abs(d))
    near = d - lower <= goal * span + pair_slack(pair)
    # an infinite tolerance certifies nothing
    certified = near or (outcome == CERTIFIED and tolerance < inf)
    if cut and (outcome == UNCERTIFIED or (outcome == TOUCHING_OR_OVERLAPPING and not near)):
        return DEADLINE
    # within the tolerance of touching, the sign of the bound is not significant
    if d <= radii or outcome == PENETRATING or (near and lower <= radii):
        if certified or outcome == PENETRATING:
            return GLOBAL if is_least_depth(pair, p, found) else LOCAL
    elif lower > radii and certified:
        return CONVERGED
    if lenient or tolerance == inf:
        return TRACKING
    return OVERLAPPING if outcome == OVERLAP else NOT_CERTIFIED


@kernel
def write_vector(x, to, o):
    for k in range(3):
        to[o + k] = x[k]


@small
def swept_point(R, origin, x, radius, n):
    """A core's point x moved along n to the swept surface, in world axes."""
    return add(rotate(R, axpy(radius, n, x)), origin)


@kernel
def write_points(pair, inputs, jets, found, out):
    """Write distance, bounds, witness points on the swept surfaces, and normal."""
    jet_a, jet_b = jets
    Ra, origin = read_rotation(inputs.pose_a, 0), read_vector(inputs.pose_a, 9)
    radius_a, radius_b = pair.reals_a[L.RADIUS], pair.reals_b[L.RADIUS]
    n = found.normal
    out[DISTANCE] = found.distance - radius_a - radius_b
    out[LOWER_BOUND] = found.lower - radius_a - radius_b
    out[UPPER_BOUND] = found.upper - radius_a - radius_b
    write_vector(swept_point(Ra, origin, jet_a[0], radius_a, n), out, POINT_A)
    write_vector(swept_point(Ra, origin, jet_b[0], -radius_b, n), out, POINT_B)
    write_vector(rotate(Ra, n), out, NORMAL)
    out[RESIDUAL] = gradient_norm(jet_a, jet_b, gradient(projection_errors(jet_a, jet_b)))


@kernel
def normal_rate(turn, found):
    """The rate of the normal outside contact: the rate of the direction between the points."""
    n, d = found.normal, found.distance
    return scale(1.0 / d, axpy(-dot(turn, n), n, turn)) if d > 0.0 else ORIGIN


@kernel
def write_rates(pair, inputs, motion, shown, n_rate, out):
    """Write the rate of the distance and the witness points' velocities, from the feedforward.

    V_A is added in world axes. n_rate is the rate of n in contact, where it does not follow from
    the points' rates.
    """
    jet_a, jet_b = shown.jets
    n, rates = shown.found.normal, shown.rates
    carried = add(motion.v, cross(motion.w, sub(jet_b[0], motion.pose.p)))
    slide_a = axpy(rates[0], jet_a[1], scale(rates[1], jet_a[2]))
    move_b = add(carried, axpy(rates[2], jet_b[1], scale(rates[3], jet_b[2])))
    if not shown.inside:
        n_rate = normal_rate(sub(move_b, slide_a), shown.found)
    Ra, origin = read_rotation(inputs.pose_a, 0), read_vector(inputs.pose_a, 9)
    v_a, w_a = read_vector(inputs.twist_a, 0), read_vector(inputs.twist_a, 3)
    u_a = rotate(Ra, axpy(pair.reals_a[L.RADIUS], n_rate, slide_a))
    u_b = rotate(Ra, axpy(-pair.reals_b[L.RADIUS], n_rate, move_b))
    u_a = add(u_a, add(v_a, cross(w_a, sub(read_vector(out, POINT_A), origin))))
    u_b = add(u_b, add(v_a, cross(w_a, sub(read_vector(out, POINT_B), origin))))
    out[OUT_RATE] = dot(n, carried)
    write_vector(u_a, out, VELOCITY_A)
    write_vector(u_b, out, VELOCITY_B)


@kernel
def write_answer(pair, inputs, motion, shown, n_rate, status, out):
    """Write the whole answer."""
    place = shown.found.place
    write_points(pair, inputs, shown.jets, shown.found, out)
    if inputs.has_twist:
        write_rates(pair, inputs, motion, shown, n_rate, out)
    else:
        for k in range(OUT_RATE, RESIDUAL):
            out[k] = np.nan
    out[OUT_MODE], out[OUT_MODE + 1] = place.feature_a, place.chart_a
    out[OUT_MODE + 2], out[OUT_MODE + 3] = place.feature_b, place.chart_b
    out[OUT_Q], out[OUT_Q + 1] = place.u, place.v
    out[OUT_Q + 2], out[OUT_Q + 3] = place.r, place.s
    if status == OVERLAPPING:
        # if the bodies overlap, the distance between two of their points says nothing
        out[DISTANCE] = min(out[DISTANCE], 0.0)
        out[UPPER_BOUND] = min(out[UPPER_BOUND], 0.0)
    out[STATUS] = status
