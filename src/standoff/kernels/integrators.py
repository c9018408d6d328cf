"""Fixed-step integrators of the law: their tableaux are data, the step is one function.

All four have stages that use only the stage before: stage i is at time c_i h, with parameters
q + c_i h k_(i-1). Adding one is a row in each table, see CONTRIBUTING.
"""

import numpy as np

from standoff.kernels.compiling import kernel
from standoff.kernels.descent import ORIGIN, pair_jets
from standoff.kernels.events import EVALUATIONS, REGULARISED
from standoff.kernels.features import pair_span
from standoff.kernels.feedback import law, plain_law
from standoff.kernels.frame import (
    ERRORS,
    GAIN,
    INTEGRAL,
    INTEGRATED,
    O_INTEGRATOR,
    O_PREDICTOR,
    O_REALISATION,
    O_SOLVE,
    PREDICT_NONE,
    SOLVE_PLAIN,
)
from standoff.kernels.paper_feedback import commanded_errors, gain_now
from standoff.kernels.rigid import within_frame
from standoff.kernels.system import feedforward, gradient, hessian, projection_errors
from standoff.kernels.vectors import norm, sub

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

# What is integrated together: the parameters, the errors (Fig. 3) and their integral (PI).
N_CHANGES = 12
NONE = (0.0, 0.0, 0.0, 0.0)


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
def rates_at(pair, options, motion, mode, q, errors, integral, feedback, forward, counts):
    """(w, Psi, Psi', K): rates of the parameters at one stage, the errors used and their own rate,
    the gain used.

    motion is (R, p, v, w) of B in A's frame. `feedback` and `forward` are 1, or 0 to leave that
    part of w = -M⁻¹(v(Psi) + b) out.  Eqs. (12)-(14)
    """
    R, p, v, omega = motion
    jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    span = pair_span(pair, p, norm(sub(jet_a[0], jet_b[0])))
    psi = errors if options[O_REALISATION] == INTEGRATED else projection_errors(jet_a, jet_b)
    H = hessian(jet_a, jet_b)
    b = feedforward(jet_a, jet_b, ORIGIN, ORIGIN, ORIGIN, p, v, omega)
    gain = feedback * gain_now(options, jet_a, jet_b, b)
    # what the law leaves out still moves the errors
    fed = gradient((forward * b[0], forward * b[1], forward * b[2], forward * b[3]))
    g = gradient(commanded_errors(options, jet_a, jet_b, psi, integral))
    if options[O_SOLVE] == SOLVE_PLAIN:
        step, w_ff, solved = plain_law(jet_a, jet_b, g, H, fed)
        counts[REGULARISED] += 1 - solved
    else:
        step, w_ff, _, regularised, _, _ = law(jet_a, jet_b, g, H, fed, span)
        counts[REGULARISED] += regularised
    counts[EVALUATIONS] += 1
    w = (
        gain * step[0] + w_ff[0],
        gain * step[1] + w_ff[1],
        gain * step[2] + w_ff[2],
        gain * step[3] + w_ff[3],
    )
    Mw = gradient(times_hessian(H, w))
    # a parameter that does not exist has 1 in H and no rate
    return w, psi, (Mw[0] + b[0], Mw[1] + b[1], Mw[2] + b[2], Mw[3] + b[3]), gain


@kernel
def along(start, o, s, rate):
    return (
        start[o] + s * rate[0],
        start[o + 1] + s * rate[1],
        start[o + 2] + s * rate[2],
        start[o + 3] + s * rate[3],
    )


@kernel
def integrate(pair, before, after, h, options, state, mode, q, counts, change):
    """The change of parameters, errors and integral over one frame, N_CHANGES numbers.

    The state keeps the last stage's gain.

    before and after are (R, p, v, w) of B in A's frame at both ends of the frame.
    """
    forward = 0.0 if options[O_PREDICTOR] == PREDICT_NONE else 1.0
    integrator = int(options[O_INTEGRATOR])
    w, psi, psi_rate = NONE, NONE, NONE
    for j in range(N_CHANGES):
        change[j] = 0.0
    for i in range(STAGES[integrator]):
        c = NODES[integrator, i]
        motion = before if c == 0.0 else after
        if c != 0.0 and c != 1.0:
            motion = within_frame(c, before, after, h)
        w, psi, psi_rate, state[GAIN] = rates_at(
            pair,
            options,
            motion,
            mode,
            along(q, 0, c * h, w),
            along(state, ERRORS, c * h, psi_rate),
            along(state, INTEGRAL, c * h, psi),
            1.0,
            forward,
            counts,
        )
        for j in range(4):
            change[j] += h * WEIGHTS[integrator, i] * w[j]
            change[4 + j] += h * WEIGHTS[integrator, i] * psi_rate[j]
            change[8 + j] += h * WEIGHTS[integrator, i] * psi[j]
