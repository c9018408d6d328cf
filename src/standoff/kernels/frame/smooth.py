"""A frame whose witness points stay well inside faces of kinds that are known when it is compiled.

It is the general frame of the predictor-corrector without anything that such a frame never meets:
no boundary, no other chart, no switch, no flat direction, no contact. It calls the same functions
in the same order, with fewer cases. It is tried first and writes nothing unless it answers.
"""

from typing import Any, NamedTuple

from standoff.kernels.algebra.vectors import norm, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    chart_record,
    dimension,
    has_collapsed,
    moved_jet,
    normal_of_kind,
    pair_span,
)
from standoff.kernels.body.jets import mapped_jet, surface_jet
from standoff.kernels.body.nurbs import net_at, net_jet_of, unrolled_basis
from standoff.kernels.body.trimming import well_inside
from standoff.kernels.compiler.decorators import small
from standoff.kernels.depth.penetration import contact_scale
from standoff.kernels.frame.answer import judge, write_answer
from standoff.kernels.frame.inputs import moving
from standoff.kernels.frame.prediction import feeds, kept_state, predict
from standoff.kernels.pair.certificate import SINGLE, Cones, NormalCone, certify_cones
from standoff.kernels.pair.certified import CERTIFIED, outcome_of
from standoff.kernels.pair.events import CORRECTIONS, EVALUATIONS, N_COUNTS
from standoff.kernels.pair.newton import (
    ldl,
    ldl_solve,
    metric_norm,
    negate,
    pair_metric,
    plainly_definite,
)
from standoff.kernels.pair.system import energy, feedforward, gradient, hessian, projection_errors
from standoff.kernels.state.arrays import OUT_COUNTS
from standoff.kernels.state.state import read_state, write_state
from standoff.kernels.state.tracked import Shown, Tracked
from standoff.kernels.tolerances import (
    ARMIJO,
    AT_REST,
    ENERGY_NOISE,
    EPS,
    POLISHED,
    SHIFTED_GAP,
    SMOOTH_CORRECTIONS,
    TOUCHING,
)
from standoff.kernels.values import NO_RATES, ORIGIN, STILL, Found, Vector, moved, of_origin

NO_JET = (ORIGIN, ORIGIN, ORIGIN, ORIGIN, ORIGIN, ORIGIN)


class Seen(NamedTuple):
    """A chart at its parameters, in its body's frame."""

    fits: bool  # is it of the kind, with both tangents nonzero?
    jet: Any
    normal: Vector  # unit, outward
    noise: float  # bound on how far roundoff turns it (chord)


class Looked(NamedTuple):
    """Both charts at a place."""

    fits: bool
    jets: Any  # in A's frame
    cones: Any  # input of the certificate


@small
def seen_as(kind, ints, reals, chart, u, v):
    """A chart, assumed to be of a kind, any except a NURBS."""
    c = chart_record(ints, chart)
    o = ints[c + L.CHART_REALS]
    if ints[c + L.CHART_KIND] != kind:
        return Seen(False, NO_JET, ORIGIN, 0.0)
    return seen_by(kind, reals, o, surface_jet(reals, kind, o, u, v))


@small
def seen_by(kind, reals, o, jet):
    """A chart whose reals begin at o, from its jet."""
    normal, noise = normal_of_kind(kind, reals, o, jet)
    collapsed = has_collapsed(reals, jet[1]) or has_collapsed(reals, jet[2])
    return Seen(not collapsed, jet, normal, noise)


@small
def seen_as_nurbs(degree, ints, reals, chart, u, v):
    """A chart, assumed to be a NURBS of the same degree along u and v."""
    c = chart_record(ints, chart)
    o = ints[c + L.CHART_REALS]
    data = o + L.SURFACE_DATA
    fits = ints[c + L.CHART_KIND] == L.NURBS
    if not (fits and reals[data] == degree and reals[data + 1] == degree):
        return Seen(False, NO_JET, ORIGIN, 0.0)
    net, at, rates = net_at(reals, data, u, v)
    jet = net_jet_of(unrolled_basis, reals, net, (degree, degree), at, rates)
    return seen_by(L.NURBS, reals, o, mapped_jet(reals, o, jet))


@small
def look(look_a, look_b, pair, pose, place):
    """Both charts at a place, by functions for their kinds."""
    a = look_a(pair.ints_a, pair.reals_a, place.chart_a, place.u, place.v)
    b = look_b(pair.ints_b, pair.reals_b, place.chart_b, place.r, place.s)
    jet_b = moved_jet(pose, b.jet)
    cones = Cones(
        NormalCone(SINGLE, a.normal, a.normal, ORIGIN, a.noise),
        NormalCone(SINGLE, b.normal, b.normal, ORIGIN, b.noise),
        a.jet[0],
        b.jet[0],
        sub(jet_b[0], a.jet[0]),
    )
    return Looked(a.fits and b.fits, (a.jet, jet_b), cones)


@small
def inside_faces(pair, place):
    """Are both points well inside their faces, and central in their charts?"""
    ia, ra, ib, rb = pair
    o_a = ia[chart_record(ia, place.chart_a) + L.CHART_REALS]
    o_b = ib[chart_record(ib, place.chart_b) + L.CHART_REALS]
    return well_inside(ra, o_a, place.u, place.v) and well_inside(rb, o_b, place.r, place.s)


@small
def may_be_smooth(pair, before):
    """Were both points on faces, and the bodies far enough apart for the law without contact?"""
    place = before.place
    return (
        not before.lost
        and not before.inside
        and before.cut == 0
        and dimension(pair.ints_a, place.feature_a) == 2
        and dimension(pair.ints_b, place.feature_b) == 2
        and before.distance >= SHIFTED_GAP * contact_scale(pair)
    )


@small
def descended(look_a, look_b, pair, motion, place, tolerance, most):
    """(done, corrections, place, looked, rates): `settle` for a pair away from all boundaries."""
    pose, corrections, rates = motion.pose, 0, NO_RATES
    looked = look(look_a, look_b, pair, pose, place)
    done = looked.fits
    while done:
        jet_a, jet_b = looked.jets
        d = norm(looked.cones.gap)
        span = pair_span(pair, pose.p, d)
        g = gradient(projection_errors(jet_a, jet_b))
        metrics = pair_metric(jet_a, jet_b)
        slope = metric_norm(metrics, g)
        if corrections > 0 and slope <= max(AT_REST * EPS * span, tolerance * d):
            break
        H = hessian(jet_a, jet_b)
        factors = ldl(H)
        safe, _ = plainly_definite(metrics, H, factors[0])
        done = d > TOUCHING * span and slope > 0.0 and safe and corrections < most
        if not done:
            break
        b = feedforward(jet_a, jet_b, STILL, of_origin(motion))
        step, rates = negate(ldl_solve(factors, g)), negate(ldl_solve(factors, gradient(b)))
        descent = g[0] * step[0] + g[1] * step[1] + g[2] * step[2] + g[3] * step[3]
        enough = 0.5 * d * d + ARMIJO * descent + ENERGY_NOISE * EPS * span * d
        place = moved(place, 1.0, step)
        looked = look(look_a, look_b, pair, pose, place)
        corrections += 1
        done = looked.fits and inside_faces(pair, place)
        done = done and energy(looked.jets[0], looked.jets[1]) <= enough
    return done, corrections, place, looked, rates


@small
def smooth_frame(look_a, look_b, pair, inputs, h, options, state, out):
    """Write the answer and the next state of a frame, and return 1; or write nothing and return 0.

    look_a and look_b evaluate the charts of A and of B, each for one kind.
    """
    before = read_state(state)
    if not may_be_smooth(pair, before):
        return 0
    motion = moving(inputs, before, h)
    pose = motion.pose
    place = moved(before.place, 1.0, predict(before, options.predictor, h))
    if not inside_faces(pair, place):
        return 0
    most = min(options.deadline, SMOOTH_CORRECTIONS)
    done, corrections, place, looked, rates = descended(
        look_a, look_b, pair, motion, place, options.tolerance, most
    )
    if not done:
        return 0
    d, lower, normal, blur = certify_cones(pair, pose, place, looked.cones, ORIGIN)
    outcome = outcome_of(pair, pose, d, lower, blur, options.tolerance)
    if outcome != CERTIFIED or d <= POLISHED * contact_scale(pair):
        return 0
    found = Found(outcome, place, d, lower, d, normal)
    status = judge(pair, pose.p, found, False, options.tolerance, False)
    known = Tracked(Shown(found, looked.jets, False, True, rates), before.integrated)
    write_answer(pair, inputs, motion, known.shown, ORIGIN, status, out)
    feed = feeds(options.predictor, inputs.has_twist)
    carried = True, before.place, before.rates
    write_state(kept_state(carried, before, motion, h, known, feed, status), state)
    for k in range(N_COUNTS):
        out[OUT_COUNTS + k] = 0.0
    out[OUT_COUNTS + EVALUATIONS] = corrections
    out[OUT_COUNTS + CORRECTIONS] = corrections
    return 1
