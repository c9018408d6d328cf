"""From witness points in A's frame to the answer in world axes, with its status and rates."""

from math import inf

import numpy as np

from standoff.kernels import layout as L
from standoff.kernels.certified import (
    CERTIFIED,
    PENETRATING,
    TOUCHING_OR_OVERLAPPING,
    UNCERTIFIED,
)
from standoff.kernels.compiling import kernel
from standoff.kernels.features import pair_slack, pair_span
from standoff.kernels.feedback import gradient_norm
from standoff.kernels.frame import (
    CONVERGED,
    DEADLINE,
    DISTANCE,
    GLOBAL,
    LAW_PAPER,
    LOCAL,
    LOWER_BOUND,
    NORMAL,
    NOT_CERTIFIED,
    OUT_MODE,
    OUT_Q,
    OUT_RATE,
    POINT_A,
    POINT_B,
    RESIDUAL,
    STATUS,
    TRACKING,
    UPPER_BOUND,
    VELOCITY_A,
    VELOCITY_B,
)
from standoff.kernels.rigid import read_rotation, read_vector
from standoff.kernels.system import gradient, projection_errors
from standoff.kernels.tolerances import DEPTH_PROOF, START_GAP, TOUCHING
from standoff.kernels.vectors import add, axpy, cross, dot, rotate, scale, sub


@kernel
def judge(pair, law_kind, outcome, p, d, bound, upper, tolerance, exhausted):
    """Status of an answer by its bounds; d, bound and upper are those of the cores."""
    radii = pair[1][L.RADIUS] + pair[3][L.RADIUS]
    goal = START_GAP if tolerance == inf else tolerance
    span = pair_span(pair, p, abs(d))
    near = d - bound <= goal * span + pair_slack(pair)
    if exhausted and (outcome == UNCERTIFIED or (outcome == TOUCHING_OR_OVERLAPPING and not near)):
        return DEADLINE
    # within the tolerance of touching the bound's sign says nothing
    if d <= radii or outcome == PENETRATING or (near and bound <= radii):
        if near or outcome in (CERTIFIED, PENETRATING):
            proof = DEPTH_PROOF * (radii - d) + TOUCHING * span + pair_slack(pair)
            return GLOBAL if upper - d <= proof else LOCAL
    elif bound > radii and (near or (outcome == CERTIFIED and tolerance < inf)):
        return CONVERGED
    if law_kind == LAW_PAPER or tolerance == inf:
        return TRACKING
    return NOT_CERTIFIED


@kernel
def write_points(pair, Ta, jets, d, bound, upper, n, out):
    """Distance, bounds, witness points on the swept surfaces and normal."""
    jet_a, jet_b = jets
    Ra, origin = read_rotation(Ta, 0), read_vector(Ta, 9)
    radius_a, radius_b = pair[1][L.RADIUS], pair[3][L.RADIUS]
    x_a = add(rotate(Ra, axpy(radius_a, n, jet_a[0])), origin)
    x_b = add(rotate(Ra, axpy(-radius_b, n, jet_b[0])), origin)
    n_w = rotate(Ra, n)
    out[DISTANCE] = d - radius_a - radius_b
    out[LOWER_BOUND] = bound - radius_a - radius_b
    out[UPPER_BOUND] = upper - radius_a - radius_b
    for k in range(3):
        out[POINT_A + k] = x_a[k]
        out[POINT_B + k] = x_b[k]
        out[NORMAL + k] = n_w[k]
    out[RESIDUAL] = gradient_norm(jet_a, jet_b, gradient(projection_errors(jet_a, jet_b)))


@kernel
def write_rates(pair, Ta, xi_a, motion, jets, w_ff, d, n, inside, n_rate, out):
    """Rate of the distance and velocities of the witness points, from the feedforward.

    motion is (R, p, v, w) of B in A's frame, where A is at rest; V_A is added in world. n_rate is
    that of n in contact (`inside`), where it does not follow from the points' rates.
    """
    jet_a, jet_b = jets
    _, p, v, w = motion
    carried = add(v, cross(w, sub(jet_b[0], p)))
    slide_a = axpy(w_ff[0], jet_a[1], scale(w_ff[1], jet_a[2]))
    move_b = add(carried, axpy(w_ff[2], jet_b[1], scale(w_ff[3], jet_b[2])))
    turn = sub(move_b, slide_a)
    if not inside:
        n_rate = scale(1.0 / d, axpy(-dot(turn, n), n, turn)) if d > 0.0 else (0.0, 0.0, 0.0)
    Ra, origin = read_rotation(Ta, 0), read_vector(Ta, 9)
    v_a, w_a = read_vector(xi_a, 0), read_vector(xi_a, 3)
    u_a = rotate(Ra, axpy(pair[1][L.RADIUS], n_rate, slide_a))
    u_b = rotate(Ra, axpy(-pair[3][L.RADIUS], n_rate, move_b))
    u_a = add(u_a, add(v_a, cross(w_a, sub(read_vector(out, POINT_A), origin))))
    u_b = add(u_b, add(v_a, cross(w_a, sub(read_vector(out, POINT_B), origin))))
    out[OUT_RATE] = dot(n, carried)
    for k in range(3):
        out[VELOCITY_A + k] = u_a[k]
        out[VELOCITY_B + k] = u_b[k]


@kernel
def write_answer(
    pair, Ta, xi_a, has_twist, motion, mode, q, w_ff, jets, query, inside, n_rate, status, out
):
    """The whole answer; query is (d, bound, upper, normal) of the cores."""
    d, bound, upper, n = query
    write_points(pair, Ta, jets, d, bound, upper, n, out)
    if has_twist:
        write_rates(pair, Ta, xi_a, motion, jets, w_ff, d, n, inside, n_rate, out)
    else:
        for k in range(OUT_RATE, RESIDUAL):
            out[k] = np.nan
    for k in range(4):
        out[OUT_MODE + k] = mode[k]
        out[OUT_Q + k] = q[k]
    out[STATUS] = status
