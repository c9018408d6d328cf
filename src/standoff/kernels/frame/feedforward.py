"""The feedforward at the witness points of an answer, solved as its law does."""

from standoff.kernels.algebra.vectors import norm, sub
from standoff.kernels.body.features import pair_span
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.events import EVALUATIONS, REGULARISED
from standoff.kernels.pair.newton import law, pair_metric, plain_law
from standoff.kernels.pair.system import feedforward, gradient, hessian
from standoff.kernels.state.arrays import SOLVE_PLAIN
from standoff.kernels.values import NO_RATES, STILL, of_origin


@kernel
def solve_plain(jet_a, jet_b, g, H, fed, work):
    """(p, w_ff) with H as it is."""
    step, w_ff, solved = plain_law(jet_a, jet_b, g, H, fed)
    work.counts[REGULARISED] += 1 - solved
    return step, w_ff


@kernel
def feedforward_now(pair, motion, place, solve, work):
    """w_ff at witness points at which the frame made no evaluation. It uses H, whose covariant part
    differs from it only away from them."""
    jet_a, jet_b = pair_jets(pair, motion.pose, place)
    H = hessian(jet_a, jet_b)
    fed = gradient(feedforward(jet_a, jet_b, STILL, of_origin(motion)))
    work.counts[EVALUATIONS] += 1
    if solve == SOLVE_PLAIN:
        return solve_plain(jet_a, jet_b, NO_RATES, H, fed, work)[1]
    span = pair_span(pair, motion.pose.p, norm(sub(jet_a[0], jet_b[0])))
    metrics = pair_metric(jet_a, jet_b)
    _, w_ff, regularised, _, _ = law(metrics, jet_a, jet_b, NO_RATES, H, fed, span)
    work.counts[REGULARISED] += regularised
    return w_ff
