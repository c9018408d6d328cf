"""Descent of E over the hybrid automaton: safeguarded Newton steps, holds and releases.

A step that meets a boundary is cut there and the boundary is *held*: the pair is solved again
with fewer parameters until a full step fits or nothing is free. Only at such a stationary point
are the switching functions tested, and at most one feature, the steepest, is released. As E
falls between two releases, no stationary point is met twice.
"""

from typing import Any, NamedTuple

import numpy as np

from standoff.kernels.algebra.vectors import norm, rotate_back, scale, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import dimension, feature_jet, moved_jet, pair_span
from standoff.kernels.body.trimming import HIT_COEDGE, HIT_LIMIT, NO_HIT, walk
from standoff.kernels.compiler.decorators import kernel, shared
from standoff.kernels.pair.events import (
    CHART_CHANGES,
    CORRECTIONS,
    EVALUATIONS,
    REGULARISED,
    exhausted,
    log_event,
)
from standoff.kernels.pair.newton import law, metric_norm, pair_metric, stiff_step
from standoff.kernels.pair.switching import (
    NONE_TRIED,
    in_best_chart,
    is_smooth,
    normalised_parameter,
    off_crease,
    onto_boundary,
    steepest_untried,
)
from standoff.kernels.pair.switching import across as across_edge
from standoff.kernels.pair.system import energy, feedforward, gradient, hessian, projection_errors
from standoff.kernels.tolerances import (
    ARMIJO,
    AT_REST,
    ENERGY_NOISE,
    EPS,
    MAX_HALVINGS,
    MAX_ITERATIONS,
    MAX_POLISH,
    MAX_STALLS,
    POLISH_RATIO,
    RECHART,
    SHARP_POLISH,
    SLOPE,
    SLOPE_NOISE,
    TOUCHING,
    VALLEY_STEPS,
)
from standoff.kernels.values import (
    NO_RATES,
    STILL,
    Place,
    Side,
    body_of,
    moved,
    of_origin,
    side_of,
    together,
    with_side,
)

NO_EDGE = np.int64(-1)  # of the type of a feature's number: a literal would compile twice

STATIONARY = 0
EXHAUSTED = 1  # the iterations, or the frame's evaluations, ran out
CONTACT = 2  # the surfaces met: no direction is left


class Settled(NamedTuple):
    """Where a descent ended."""

    outcome: int  # STATIONARY, EXHAUSTED or CONTACT
    place: Place
    jets: Any  # both, of that place, in A's frame
    fresh: bool  # do the rates belong to the place's features and charts?
    rates: tuple[float, ...]  # feedforward of the last evaluation, 1/s; zero without one


class Step(NamedTuple):
    """A Newton step of E and what the line search asks of it."""

    change: tuple[float, ...]  # of the four parameters
    energy: float  # E before it, length²
    descent: float  # g.step, length²
    noise: float  # roundoff of E, length²
    flat: int  # 1 where H has a direction that is not stiff


class Advance(NamedTuple):
    """Where a step led."""

    ok: bool  # did E fall? else nothing has changed
    held: bool  # is the place on a boundary that was reached?
    changed: bool  # is it of another mode or chart?
    place: Place
    jets: Any
    last_smooth: int  # the smooth edge that was passed, or NO_EDGE


@kernel
def pair_jets(pair, pose, place):
    """Both jets at a place, in A's frame."""
    jet_a = feature_jet(pair.ints_a, pair.reals_a, place.feature_a, place.chart_a, place.u, place.v)
    jet_b = feature_jet(pair.ints_b, pair.reals_b, place.feature_b, place.chart_b, place.r, place.s)
    return jet_a, moved_jet(pose, jet_b)


@kernel
def walk_pair(pair, place, step):
    """(body, hit): how much of a step of both bodies fits, and who stops it."""
    a, b = side_of(place, 0), side_of(place, 1)
    of_a = walk(pair.ints_a, pair.reals_a, a.feature, a.chart, a.p, a.q, step[0], step[1])
    of_b = walk(pair.ints_b, pair.reals_b, b.feature, b.chart, b.p, b.q, step[2], step[3])
    if of_b.kind == NO_HIT or (of_a.kind != NO_HIT and of_a.s <= of_b.s):
        return 0, of_a
    return 1, of_b


@kernel
def take_hit(pair, place, body, hit, last_smooth, work):
    """(place, smooth edge passed or NO_EDGE): apply the reset of a boundary hit."""
    ints, reals = body_of(pair, body)
    source = side_of(place, body)
    side = onto_boundary(ints, reals, source, hit)
    if hit.kind == HIT_LIMIT:
        work.counts[CHART_CHANGES] += 1
        return with_side(place, body, side), NO_EDGE
    passed = NO_EDGE
    # Ping-pong over one smooth edge: held as an edge the second time, where E decides.
    if hit.kind == HIT_COEDGE and is_smooth(ints, side.feature) and side.feature != last_smooth:
        passed = side.feature
        feature, chart, p, q = across_edge(ints, reals, side.feature, hit.index, hit.t)
        side = Side(feature, chart, p, q)
    log_event(work, body, source.feature, side.feature, 1.0 - hit.s, 0.0)
    return with_side(place, body, side), passed


@kernel
def recentred(ints, reals, side, work):
    """(side, changed): in the most central chart where a witness point nears its own's rim."""
    changed = False
    if (
        dimension(ints, side.feature) == 2
        and ints[ints[L.FACES] + L.FACE_STRIDE * side.feature + 1] > 1
        and max(abs(side.p), abs(side.q)) > RECHART
    ):
        central = in_best_chart(ints, reals, side)
        if central.chart != side.chart:
            work.counts[CHART_CHANGES] += 1
            changed = True
            side = central
    p = normalised_parameter(ints, reals, side.feature, side.p)
    return Side(side.feature, side.chart, p, side.q), changed


@kernel
def recentre(pair, place, work):
    """(place, changed): `recentred`, of both bodies."""
    a, of_a = recentred(pair.ints_a, pair.reals_a, side_of(place, 0), work)
    b, of_b = recentred(pair.ints_b, pair.reals_b, side_of(place, 1), work)
    return together(a, b), of_a or of_b


@kernel
def release_along(pair, pose, place, n, d, slope_floor, work):
    """(released, place): test the switching functions with the unit vector n from A to B; release
    the steepest. None where none falls faster than `slope_floor`.
    """
    tried = NONE_TRIED, NONE_TRIED
    body, place = release_untried(pair, pose, place, (n, d), slope_floor, tried, work)
    return body >= 0, place


@kernel
def release_untried(pair, pose, place, gap, slope_floor, tried, work):
    """(body, place): `release_along` without the features tried, of A and of B; the body of the
    one released, or -1. gap is (n, d).
    """
    n, d = gap
    a, b = side_of(place, 0), side_of(place, 1)
    back = scale(-1.0, rotate_back(pose.R, n))
    slope_a, fa, ca, ua, va = steepest_untried(
        pair.ints_a, pair.reals_a, a.feature, a.p, n, tried[0]
    )
    slope_b, fb, cb, ub, vb = steepest_untried(
        pair.ints_b, pair.reals_b, b.feature, b.p, back, tried[1]
    )
    if min(slope_a, slope_b) >= -slope_floor:
        return -1, place
    if slope_a <= slope_b:
        log_event(work, 0, a.feature, fa, slope_a * d, slope_a)
        ua, va = off_crease(pair.ints_a, pair.reals_a, a.feature, fa, ca, ua, va, scale(d, n))
        return 0, with_side(place, 0, Side(fa, ca, ua, va))
    log_event(work, 1, b.feature, fb, slope_b * d, slope_b)
    ub, vb = off_crease(pair.ints_b, pair.reals_b, b.feature, fb, cb, ub, vb, scale(d, back))
    return 1, with_side(place, 1, Side(fb, cb, ub, vb))


@kernel
def release_next(pair, pose, place, gap, slope_floor, tried, work):
    """(released, place, tried): of the features not yet tried in vain the steepest, or, where none
    of them falls, the steepest of all.

    A step into a wide sector may leave the face at its vertex, over the wrong one of its edges,
    and come back for ever, while another edge of the vertex falls.
    """
    body, place = release_untried(pair, pose, place, gap, slope_floor, tried, work)
    of_a, of_b = tried
    if body < 0 and max(of_a[0], of_b[0]) >= 0:
        none = NONE_TRIED, NONE_TRIED
        body, place = release_untried(pair, pose, place, gap, slope_floor, none, work)
    if body == 0:
        of_a = (place.feature_a, of_a[0], of_a[1])
    elif body == 1:
        of_b = (place.feature_b, of_b[0], of_b[1])
    return body >= 0, place, (of_a, of_b)


@kernel
def to_valley_floor(pair, pose, trial):
    """A trial corrected in the stiff directions, and its jets."""
    jet_a, jet_b = pair_jets(pair, pose, trial)
    for _ in range(VALLEY_STEPS):
        g = gradient(projection_errors(jet_a, jet_b))
        step = stiff_step(jet_a, jet_b, g, hessian(jet_a, jet_b))
        trial = moved(trial, walk_pair(pair, trial, step)[1].s, step)
        jet_a, jet_b = pair_jets(pair, pose, trial)
    return trial, jet_a, jet_b


@kernel
def line_search(pair, pose, place, step, s):
    """Halve s until Armijo's rule holds: (s, ok, on_step, place, jets).

    Where H has a flat direction a trial that fails may have left a valley's floor, and is brought
    back to it before it is judged again (on_step False).
    """
    for halving in range(MAX_HALVINGS + 1):
        trial = moved(place, s, step.change)
        jet_a, jet_b = pair_jets(pair, pose, trial)
        enough = step.energy + ARMIJO * s * step.descent + step.noise
        if energy(jet_a, jet_b) <= enough:
            return s, True, True, trial, (jet_a, jet_b)
        if step.flat:
            trial, jet_a, jet_b = to_valley_floor(pair, pose, trial)
            if energy(jet_a, jet_b) <= enough:
                return s, True, False, trial, (jet_a, jet_b)
        if halving < MAX_HALVINGS:
            s *= 0.5
    return s, False, True, trial, (jet_a, jet_b)


@kernel
def correction(jets, metrics, motion, g, span, work):
    """(step, g.step, flat, sharp, rates): the Newton step, and the feedforward of the same
    factorisation.

    flat is 1 where H has a flat direction, sharp tells one that is curved as beside a crease.
    """
    jet_a, jet_b = jets
    H = hessian(jet_a, jet_b)
    b = feedforward(jet_a, jet_b, STILL, of_origin(motion))
    step, rates, regularised, flat, sharp = law(metrics, jet_a, jet_b, g, H, gradient(b), span)
    work.counts[EVALUATIONS] += 1
    work.counts[REGULARISED] += regularised
    descent = g[0] * step[0] + g[1] * step[1] + g[2] * step[2] + g[3] * step[3]
    return step, descent, flat, sharp, rates


@kernel
def advance(pair, pose, place, step, last_smooth, work):
    """Walk a step as far as the boundaries and Armijo's rule let it; hold a boundary reached."""
    body, hit = walk_pair(pair, place, step.change)
    s, ok, on_step, trial, jets = line_search(pair, pose, place, step, hit.s)
    if not ok:
        return Advance(False, False, False, place, jets, last_smooth)
    work.counts[CORRECTIONS] += 1
    held = hit.kind != NO_HIT and s == hit.s and on_step
    if held:
        trial, last_smooth = take_hit(pair, trial, body, hit, last_smooth, work)
        changed = True
    else:
        last_smooth = NO_EDGE
        trial, changed = recentre(pair, trial, work)
    if changed:
        jets = pair_jets(pair, pose, trial)
    return Advance(True, held, changed, trial, jets, last_smooth)


@shared
def settle(pair, motion, place, least, tolerance, work):
    """Descend to a stationary point of the automaton.

    At least `least` corrections are made; after that a slope of E below tolerance |dR| (or
    roundoff) is stationary.
    """
    pose = motion.pose
    corrections, stalls, polish = 0, 0, 0
    last_slope, last_release = 1e300, 1e300
    last_smooth = NO_EDGE
    tried = NONE_TRIED, NONE_TRIED
    fresh, rates = False, NO_RATES
    jets = pair_jets(pair, pose, place)
    for _ in range(MAX_ITERATIONS):
        jet_a, jet_b = jets
        dR = sub(jet_a[0], jet_b[0])
        d = norm(dR)
        span = pair_span(pair, pose.p, d)
        if d <= TOUCHING * span:
            return Settled(CONTACT, place, jets, fresh, rates)
        if exhausted(work):
            return Settled(EXHAUSTED, place, jets, fresh, rates)
        E = 0.5 * d * d
        noise = ENERGY_NOISE * EPS * span * d
        g = gradient(projection_errors(jet_a, jet_b))
        metrics = pair_metric(jet_a, jet_b)
        slope = metric_norm(metrics, g)
        floor = max(AT_REST * EPS * span, tolerance * d)
        if slope > 0.0 and (slope > floor or corrections < least):
            change, descent, flat, sharp, rates = correction(jets, metrics, motion, g, span, work)
            fresh = True
            in_noise = -0.5 * descent <= noise
            polish += in_noise
            # beside a crease E is noise for orders of magnitude, and the slope is not
            most = SHARP_POLISH if sharp and slope > SLOPE * d else MAX_POLISH
            if not (in_noise and polish > most and slope > POLISH_RATIO * last_slope):
                step = Step(change, E, descent, noise, flat)
                made = advance(pair, pose, place, step, last_smooth, work)
                last_slope, last_smooth = slope, made.last_smooth
                if made.ok:
                    place, jets = made.place, made.jets
                    corrections += 1
                    fresh = not made.changed
                    if made.held:
                        polish, last_slope = 0, 1e300
                    continue
        # Stationary, or no step lowers E: test the switching functions.
        if last_release - noise < E:
            stalls += 1
            if stalls > MAX_STALLS:
                return Settled(STATIONARY, place, jets, fresh, rates)
        else:
            tried = NONE_TRIED, NONE_TRIED
        last_release = E
        # a slope below the residual's own is not known to be one
        slope_floor = max(SLOPE, max(SLOPE_NOISE * EPS * span, slope) / d)
        gap = scale(-1.0 / d, dR), d
        released, place, tried = release_next(pair, pose, place, gap, slope_floor, tried, work)
        if not released:
            return Settled(STATIONARY, place, jets, fresh, rates)
        polish, last_slope, fresh = 0, 1e300, False
        jets = pair_jets(pair, pose, place)
    return Settled(EXHAUSTED, place, jets, fresh, rates)
