"""Fixed-step integrators of the law: their tableaux are data, the step is one function.

All four have stages that use only the stage before: stage i is at time c_i h, with parameters
q + c_i h k_(i-1). Adding one is a row in each table, see CONTRIBUTING.
"""

import numpy as np

from standoff.kernels.compiling import kernel
from standoff.kernels.descent import pair_jets
from standoff.kernels.events import EVALUATIONS, REGULARISED
from standoff.kernels.features import pair_span
from standoff.kernels.feedback import law
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

ORIGIN = (0.0, 0.0, 0.0)


@kernel
def law_at(pair, R, p, v, w, mode, q, forward, counts):
    """(p, w_ff, slope, d): Newton direction and feedforward at one stage.

    (v, w) is B's twist in A's frame; `forward` is 0 to leave the feedforward out.
    """
    jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    d = norm(sub(jet_a[0], jet_b[0]))
    span = pair_span(pair, p, d)
    g = gradient(projection_errors(jet_a, jet_b))
    H = hessian(jet_a, jet_b)
    b = feedforward(jet_a, jet_b, ORIGIN, ORIGIN, ORIGIN, p, v, w)
    g_t = gradient((forward * b[0], forward * b[1], forward * b[2], forward * b[3]))
    step, w_ff, slope, regularised, _, _ = law(jet_a, jet_b, g, H, g_t, span)
    counts[EVALUATIONS] += 1
    counts[REGULARISED] += regularised
    return step, w_ff, slope, d


@kernel
def integrate(pair, before, after, h, gain, forward, integrator, mode, q, counts, dq):
    """The change dq of the parameters over one frame under w = K p + w_ff.  Eqs. (12)-(14)

    before and after are (R, p, v, w) of B in A's frame at both ends of the frame.
    """
    k = (0.0, 0.0, 0.0, 0.0)
    for j in range(4):
        dq[j] = 0.0
    for i in range(STAGES[integrator]):
        c = NODES[integrator, i]
        stage = (
            q[0] + c * h * k[0],
            q[1] + c * h * k[1],
            q[2] + c * h * k[2],
            q[3] + c * h * k[3],
        )
        if c == 0.0:
            R, p, v, w = before
        elif c == 1.0:
            R, p, v, w = after
        else:
            R, p, v, w = within_frame(c, before, after, h)
        step, w_ff, _, _ = law_at(pair, R, p, v, w, mode, stage, forward, counts)
        k = (
            gain * step[0] + w_ff[0],
            gain * step[1] + w_ff[1],
            gain * step[2] + w_ff[2],
            gain * step[3] + w_ff[3],
        )
        for j in range(4):
            dq[j] += h * WEIGHTS[integrator, i] * k[j]
