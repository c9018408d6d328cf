"""The paper's feedback and what else can stand in its place: w = -M⁻¹(v(Psi) + b).

Every feedback is written as v = K e, with a gain K and *commanded errors* e of the size of Psi,
so that one solve of `law` serves all; for the paper's full-state linear law e is Psi.
"""

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import active
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.pair.events import SATURATIONS
from standoff.kernels.pair.newton import metric_inverse, whiten_gradient
from standoff.kernels.state.arrays import (
    FEEDBACK_MATRIX,
    FEEDBACK_MOTION,
    FEEDBACK_PI,
    FEEDBACK_POWER,
    PREDICT_NONE,
)
from standoff.kernels.state.options import feedback_number


@kernel
def row_times(options, i, psi):
    o = 4 * i
    return (
        feedback_number(options, o) * psi[0]
        + feedback_number(options, o + 1) * psi[1]
        + feedback_number(options, o + 2) * psi[2]
        + feedback_number(options, o + 3) * psi[3]
    )


@kernel
def powered(options, error):
    """error |error / reference|^(power - 1), its factor at most `cap`: the finite-time law."""
    power, reference = feedback_number(options, 0), feedback_number(options, 1)
    cap = feedback_number(options, 2)
    size = abs(error) / reference
    if size == 0.0:
        return 0.0
    return error * min(size ** (power - 1.0), cap)


@kernel
def commanded_errors(options, jet_a, jet_b, psi, integral):
    """e = v(Psi) / K; zero for parameters that do not exist."""
    kind = options.feedback
    if kind == FEEDBACK_MATRIX:
        return (
            active(jet_a[1]) * row_times(options, 0, psi),
            active(jet_a[2]) * row_times(options, 1, psi),
            active(jet_b[1]) * row_times(options, 2, psi),
            active(jet_b[2]) * row_times(options, 3, psi),
        )
    if kind == FEEDBACK_PI:
        ratio = feedback_number(options, 0)  # K_i / K_p, 1/s
        return (
            psi[0] + ratio * integral[0],
            psi[1] + ratio * integral[1],
            psi[2] + ratio * integral[2],
            psi[3] + ratio * integral[3],
        )
    if kind == FEEDBACK_POWER:
        return (
            powered(options, psi[0]),
            powered(options, psi[1]),
            powered(options, psi[2]),
            powered(options, psi[3]),
        )
    return psi


@kernel
def gain_now(options, jet_a, jet_b, b, work):
    """K; from the bodies' motion where it is to be computed online.

    Without feedforward the errors settle at b/K: in the metric D of the tangents, where both are
    lengths, K = |b| / error keeps them at `error`. A gain that is cut, so that it does not, counts
    as saturated.
    """
    if options.feedback != FEEDBACK_MOTION:
        return options.gain
    error, least = feedback_number(options, 0), feedback_number(options, 1)
    most = feedback_number(options, 2)
    ia = metric_inverse(jet_a[1], jet_a[2])
    ib = metric_inverse(jet_b[1], jet_b[2])
    b = whiten_gradient(ia, ib, b)
    size = sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2] + b[3] * b[3])
    needed = size / error
    work.counts[SATURATIONS] += needed > most and options.predictor == PREDICT_NONE
    return min(max(needed, least), most)
