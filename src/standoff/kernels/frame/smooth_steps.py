"""A step of a smooth frame: how steep the distance is, and Newton's step from there, Eq. (12)."""

from math import inf
from typing import Any, NamedTuple

from standoff.kernels.algebra.vectors import norm
from standoff.kernels.body.features import pair_span
from standoff.kernels.compiler.decorators import small
from standoff.kernels.pair.newton import (
    ldl,
    ldl_solve,
    metric_norm,
    negate,
    pair_metric,
    plainly_definite,
)
from standoff.kernels.pair.system import energy, feedforward, gradient, hessian, projection_errors
from standoff.kernels.tolerances import ARMIJO, AT_REST, ENERGY_NOISE, EPS, TOUCHING
from standoff.kernels.values import NO_RATES, STILL, of_origin


class Slope(NamedTuple):
    """How E = |dR|²/2 changes at a place."""

    distance: float  # |dR|
    span: float  # what its roundoff is measured by
    g: Any  # gradient
    metrics: Any
    slope: float  # |g| in the bodies' metric


class Fall(NamedTuple):
    """A step of the four parameters, and what Armijo's rule asks of it."""

    step: Any
    energy: float  # E before it, with its roundoff; inf: nothing is asked
    descent: float  # g.step


class Newton(NamedTuple):
    """Newton's step at a place."""

    safe: bool  # is E plainly convex there, and not yet at rest nor in contact?
    factors: Any  # of the Hessian
    fall: Fall


NO_FALL = Fall(NO_RATES, inf, 0.0)


@small
def slope_at(pair, pose, looked):
    """What is known of E from the jets of a place."""
    jet_a, jet_b = looked.jets
    d = norm(looked.cones.gap)
    g = gradient(projection_errors(jet_a, jet_b))
    metrics = pair_metric(jet_a, jet_b)
    return Slope(d, pair_span(pair, pose.p, d), g, metrics, metric_norm(metrics, g))


@small
def at_rest(at, tolerance):
    """Is the slope as good as zero?"""
    return at.slope <= max(AT_REST * EPS * at.span, tolerance * at.distance)


@small
def newton_at(looked, at):
    """Newton's step, of any use only if it is safe."""
    return newton_by(hessian(looked.jets[0], looked.jets[1]), at)


@small
def newton_by(H, at):
    """`newton_at`, by a Hessian."""
    factors = ldl(H)
    safe, _ = plainly_definite(at.metrics, H, factors[0])
    safe = at.distance > TOUCHING * at.span and at.slope > 0.0 and safe
    g, step, d = at.g, negate(ldl_solve(factors, at.g)), at.distance
    descent = g[0] * step[0] + g[1] * step[1] + g[2] * step[2] + g[3] * step[3]
    before = 0.5 * d * d + ENERGY_NOISE * EPS * at.span * d
    return Newton(safe, factors, Fall(step, before, descent))


@small
def rates_at(motion, jets, newton):
    """The feedforward: rates of the parameters by the bodies' motion."""
    b = feedforward(jets[0], jets[1], STILL, of_origin(motion))
    return negate(ldl_solve(newton.factors, gradient(b)))


@small
def is_enough(fall, s, looked):
    """Is E as low as Armijo's rule asks after a part s of a step?"""
    return energy(looked.jets[0], looked.jets[1]) <= fall.energy + ARMIJO * s * fall.descent
