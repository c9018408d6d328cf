"""The tracker's parameters at a stage whose poses were not known in advance: places, normals and
rates.

Apart the rates are the paper's, w = -M⁻¹(K Psi + b); at contact, where M loses its rank, those of
the contact-regular form, y' = -J⁻¹(K r + r_t), of which the parameters are the first four.
"""

from standoff.kernels.algebra.vectors import dot, norm, scale, sub
from standoff.kernels.body.features import pair_span
from standoff.kernels.body.trimming import HIT_LIMIT
from standoff.kernels.compiler.decorators import kernel, shared, stack_reals
from standoff.kernels.pair.contact_newton import common_normal, contact_scales, solve_contact
from standoff.kernels.pair.descent import pair_jets, walk_pair
from standoff.kernels.pair.events import EVALUATIONS
from standoff.kernels.pair.system import contact_feedforward, contact_residual
from standoff.kernels.paper.integrators import rates_at
from standoff.kernels.tolerances import NEAR_CONTACT
from standoff.kernels.values import STILL, moved, of_origin


@kernel
def place_ahead(pair, place, s, rates):
    """A place a time s along its rates, no farther than its features go: a stage beyond them would
    read a surface where the body has none. A chart's limit is none, as charts overlap.
    """
    step = (s * rates[0], s * rates[1], s * rates[2], s * rates[3])
    hit = walk_pair(pair, place, step)[1]
    return moved(place, 1.0 if hit.kind == HIT_LIMIT else hit.s, step)


@kernel
def near_contact(pair, before):
    """Is a pair so near at the start of a tick that its stages go by the contact-regular form?"""
    span = pair_span(pair, before.motion.pose.p, abs(before.distance))
    return before.inside or before.distance < NEAR_CONTACT * span


@kernel
def normal_at(pair, pose, place, known):
    """(n, sharp) in A's frame: what the features give, else the one of the tick's start."""
    n, sharp = common_normal(pair, pose, place, pair_jets(pair, pose, place))
    if not sharp:
        return known, False
    return (n if dot(n, known) >= 0.0 else (-n[0], -n[1], -n[2])), True


@kernel
def stage_normal(pair, pose, place, near, known):
    """The normal of a contact at a place that the law has come to: near contact what the features
    give; else the direction between the witness points, as swept bodies touch by it. A certificate
    has its own, which says nothing about the points while the law lags behind them.
    """
    if near:
        return normal_at(pair, pose, place, known)[0]
    jet_a, jet_b = pair_jets(pair, pose, place)
    gap = sub(jet_b[0], jet_a[0])
    d = norm(gap)
    return scale(1.0 / d, gap) if d > 0.0 else known


@kernel
def contact_law(pair, motion, place, n, gain, work):
    """The four rates of the contact-regular law at a place."""
    jet_a, jet_b = pair_jets(pair, motion.pose, place)
    d = dot(n, sub(jet_b[0], jet_a[0]))
    span = pair_span(pair, motion.pose.p, abs(d))
    r, y, scales = stack_reals(), stack_reals(), stack_reals()
    contact_scales(jet_a, jet_b, span, scales)
    residual = contact_residual(jet_a, jet_b, n, d)
    moving = contact_feedforward(jet_a, jet_b, n, STILL, of_origin(motion))
    for k in range(8):
        r[k] = -(gain * residual[k] + moving[k]) * scales[k] / span
    solve_contact(jet_a, jet_b, n, d, span, scales, r, y)
    work.counts[EVALUATIONS] += 1
    return (y[0] * scales[0], y[1] * scales[1], y[2] * scales[2], y[3] * scales[3])


@shared
def stage_rates(pair, motion, place, n, near, options, integrated, work):
    """The parameters' rates at a stage."""
    jets = pair_jets(pair, motion.pose, place)
    if near or norm(sub(jets[1][0], jets[0][0])) == 0.0:
        return contact_law(pair, motion, place, n, options.gain, work)
    # no frame's step is taken: the bodies' own integrator chooses it
    return rates_at(pair, motion, place, options, integrated, 0.0, work)[0]
