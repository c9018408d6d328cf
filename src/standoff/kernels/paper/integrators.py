"""Fixed-step integrators of the law: their tableaux are data, the step is one function.

All four have stages that use only the stage before: stage i is at time c_i h, with parameters
q + c_i h k_(i-1). Adding one is a row in each table, see CONTRIBUTING.
"""

from typing import NamedTuple

import numpy as np

from standoff.kernels.algebra.rigid import within_frame
from standoff.kernels.algebra.vectors import active, axpy, cross, dot, norm, scale, sub
from standoff.kernels.body.features import pair_span
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.frame.feedforward import solve_plain
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.events import EVALUATIONS, REGULARISED, SATURATIONS
from standoff.kernels.pair.newton import law, ldl, pair_metric, plainly_definite
from standoff.kernels.pair.system import (
    covariant_hessian,
    feedforward,
    gradient,
    hessian,
    projection_errors,
)
from standoff.kernels.paper.feedback import commanded_errors, gain_now
from standoff.kernels.state.arrays import (
    INTEGRATED,
    PREDICT_NONE,
    SOLVE_COVARIANT,
    SOLVE_PLAIN,
)
from standoff.kernels.state.state import Four, Integrated
from standoff.kernels.tolerances import MOST_BENT
from standoff.kernels.values import NO_RATES, STILL, moved, of_origin

NAMES = ("euler", "heun", "midpoint", "rk4")
STAGES = np.array([1, 2, 2, 4])
NODES = np.array(
    [[0.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [0.0, 0.5, 0.5, 1.0]]
)
WEIGHTS = np.array(
    [
        [1.0, 0.0, 0.0, 0.0],
        [0.5, 0.5, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
    ]
)
# Largest stable K h on the real axis: where the growth factor's magnitude reaches 1 again.
STABILITY_LIMITS = (2.0, 2.0, 2.0, 2.785293563405282)


class Change(NamedTuple):
    """What is integrated together over a frame."""

    parameters: Four
    errors: Four  # Fig. 3, length² per parameter
    integral: Four  # PI, length² s per parameter
    gain: float  # of the last stage, 1/s
    first: Four  # what the first stage alone would change the parameters by


@kernel
def times_hessian(H, w):
    """H w, with H's upper triangle by rows."""
    return (
        H[0] * w[0] + H[1] * w[1] + H[2] * w[2] + H[3] * w[3],
        H[1] * w[0] + H[4] * w[1] + H[5] * w[2] + H[6] * w[3],
        H[2] * w[0] + H[5] * w[1] + H[7] * w[2] + H[8] * w[3],
        H[3] * w[0] + H[6] * w[1] + H[8] * w[2] + H[9] * w[3],
    )


@kernel
def part_unbent(jet, du, dv):
    """The part, at most 1, of a step of one body's parameters whose second-order term along the
    surface is at most MOST_BENT of its first-order one: that term belongs to the parametrisation.
    """
    xu, xv = jet[1], jet[2]
    first = axpy(du, xu, scale(dv, xv))
    second = axpy(du * du, jet[3], axpy(2.0 * du * dv, jet[4], scale(dv * dv, jet[5])))
    way, n = norm(first), cross(xu, xv)
    if active(n) == 0.0:
        off = abs(dot(second, first)) / way if way > 0.0 else 0.0
    else:
        off = norm(axpy(-dot(second, n) / dot(n, n), n, second))
    most = 2.0 * MOST_BENT * way
    return most / off if off > most else 1.0


@kernel
def gain_unbent(jet_a, jet_b, gain, step, h, work):
    """K, lowered so that neither body's chart bends what it adds to the frame's step; counted as
    saturated. Away from collapsed sides and large errors it is K."""
    s = gain * h
    kept = min(
        part_unbent(jet_a, s * step[0], s * step[1]),
        part_unbent(jet_b, s * step[2], s * step[3]),
    )
    work.counts[SATURATIONS] += kept < 1.0
    return kept * gain


@kernel
def solved(jet_a, jet_b, g, fed, solve, span, work):
    """(p, w_ff, covariant) by one of the solves; the last tells that H was taken without what
    depends on the parametrisation: always, or by the rank rule where H is not definite.
    """
    H = hessian(jet_a, jet_b)
    if solve == SOLVE_PLAIN:
        step, w_ff = solve_plain(jet_a, jet_b, g, H, fed, work)
        return step, w_ff, False
    metrics = pair_metric(jet_a, jet_b)
    covariant = solve == SOLVE_COVARIANT or not plainly_definite(metrics, H, ldl(H)[0])[0]
    if covariant:
        H = covariant_hessian(jet_a, jet_b)
    step, w_ff, regularised, _, _ = law(metrics, jet_a, jet_b, g, H, fed, span)
    work.counts[REGULARISED] += regularised
    return step, w_ff, covariant


@kernel
def rates_at(pair, motion, place, options, integrated, h, work):
    """(w, Psi, Psi', K): rates of the parameters at one stage, the errors used and their own rate,
    the gain used: w = -M⁻¹(v(Psi) + b).  Eqs. (12)-(14)

    h is the frame's time step, 0 where none is taken.
    """
    p = motion.pose.p
    jet_a, jet_b = pair_jets(pair, motion.pose, place)
    span = pair_span(pair, p, norm(sub(jet_a[0], jet_b[0])))
    evaluated = options.realisation != INTEGRATED
    psi = projection_errors(jet_a, jet_b) if evaluated else integrated.errors
    b = feedforward(jet_a, jet_b, STILL, of_origin(motion))
    gain = gain_now(options, jet_a, jet_b, b, work)
    # what the law leaves out still moves the errors
    fed = gradient(b) if options.predictor != PREDICT_NONE else NO_RATES
    g = gradient(commanded_errors(options, jet_a, jet_b, psi, integrated.integral))
    step, w_ff, covariant = solved(jet_a, jet_b, g, fed, options.solve, span, work)
    work.counts[EVALUATIONS] += 1
    if covariant:
        gain = gain_unbent(jet_a, jet_b, gain, step, h, work)
    w = (
        gain * step[0] + w_ff[0],
        gain * step[1] + w_ff[1],
        gain * step[2] + w_ff[2],
        gain * step[3] + w_ff[3],
    )
    # however the rates were solved for, the errors move by M as it is
    Mw = gradient(times_hessian(hessian(jet_a, jet_b), w))
    # a parameter that does not exist has 1 in H and no rate
    return w, psi, (Mw[0] + b[0], Mw[1] + b[1], Mw[2] + b[2], Mw[3] + b[3]), gain


@kernel
def along(start, s, rate):
    return (
        start[0] + s * rate[0],
        start[1] + s * rate[1],
        start[2] + s * rate[2],
        start[3] + s * rate[3],
    )


@kernel
def integrate(pair, before, after, h, options, work):
    """The change of parameters, errors and integral from the frame before to the motion after."""
    integrator = options.integrator
    start = before.integrated
    w, psi, psi_rate, gain = NO_RATES, NO_RATES, NO_RATES, start.gain
    dq, errors, integral = NO_RATES, NO_RATES, NO_RATES
    first = NO_RATES
    for i in range(STAGES[integrator]):
        c = NODES[integrator, i]
        motion = before.motion if c == 0.0 else after
        if c != 0.0 and c != 1.0:
            motion = within_frame(c, before.motion, after, h)
        stage = Integrated(
            along(start.errors, c * h, psi_rate), along(start.integral, c * h, psi), gain
        )
        place = moved(before.place, c * h, w)
        w, psi, psi_rate, gain = rates_at(pair, motion, place, options, stage, h, work)
        if i == 0:
            first = along(NO_RATES, h, w)
        weight = h * WEIGHTS[integrator, i]
        dq = along(dq, weight, w)
        errors = along(errors, weight, psi_rate)
        integral = along(integral, weight, psi)
    return Change(dq, errors, integral, gain, first)
