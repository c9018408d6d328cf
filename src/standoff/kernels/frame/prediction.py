"""The warm start: what a frame keeps for the next one, and the prediction from it."""

from standoff.kernels.algebra.vectors import axpy, dot, scale
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_jet, chart_record
from standoff.kernels.body.jets import chart_parameters
from standoff.kernels.body.trimming import NO_HIT
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.pair.descent import NO_EDGE, recentre, take_hit, walk_pair
from standoff.kernels.pair.newton import metric_inverse
from standoff.kernels.state.arrays import (
    DEADLINE,
    NOT_CERTIFIED,
    NOT_RESTARTED,
    OVERLAPPING,
    PREDICT_FEEDFORWARD,
    PREDICT_FEEDFORWARD_2,
    PREDICT_NONE,
)
from standoff.kernels.state.state import State
from standoff.kernels.values import (
    NO_RATES,
    Side,
    moved,
    side_of,
    together,
)


@kernel
def predict(before, predictor, h):
    """h w: the feedforward, its two-step Adams-Bashforth blend, or the secant of two frames."""
    if predictor == PREDICT_NONE or before.history == 0:
        return NO_RATES
    ratio = 0.0
    if predictor == PREDICT_FEEDFORWARD_2 and before.history == 2:
        ratio = 0.5 * h / before.last_step
    w, last = before.rates, before.last_rates
    return (
        h * ((1.0 + ratio) * w[0] - ratio * last[0]),
        h * ((1.0 + ratio) * w[1] - ratio * last[1]),
        h * ((1.0 + ratio) * w[2] - ratio * last[2]),
        h * ((1.0 + ratio) * w[3] - ratio * last[3]),
    )


@kernel
def apply_step(pair, place, step, work):
    """Take a step up to the first boundary, and stay on that boundary."""
    body, hit = walk_pair(pair, place, step)
    place = moved(place, hit.s, step)
    if hit.kind != NO_HIT:
        return take_hit(pair, place, body, hit, NO_EDGE, work)[0]
    return recentre(pair, place, work)[0]


@kernel
def in_chart(ints, reals, old, rates, chart):
    """(seen, side, rates): one body's last parameters and their rates in another chart."""
    if old.chart == chart:
        return True, old, rates
    jet = chart_jet(ints, reals, old.chart, old.p, old.q)
    velocity = axpy(rates[0], jet[1], scale(rates[1], jet[2]))
    r = chart_record(ints, chart)
    u, v, depth = chart_parameters(reals, ints[r + L.CHART_REALS], jet[0])
    if depth <= 0.0:
        return False, old, rates
    jet = chart_jet(ints, reals, chart, u, v)
    i = metric_inverse(jet[1], jet[2])
    a, b = i[0] * dot(jet[1], velocity), i[1] * dot(jet[1], velocity) + i[2] * dot(jet[2], velocity)
    return True, Side(old.feature, chart, u, v), (i[0] * a + i[1] * b, i[2] * b)


@kernel
def carry_over(pair, before, place):
    """(same, place, rates): the last frame's parameters and rates in this frame's charts. `same` is
    False if a feature has changed: then they say nothing about the new one."""
    old, w = before.place, before.rates
    if old.feature_a != place.feature_a or old.feature_b != place.feature_b:
        return False, old, w
    ia, ra, ib, rb = pair
    in_a, a, w_a = in_chart(ia, ra, side_of(old, 0), (w[0], w[1]), place.chart_a)
    in_b, b, w_b = in_chart(ib, rb, side_of(old, 1), (w[2], w[3]), place.chart_b)
    return in_a and in_b, together(a, b), (w_a[0], w_a[1], w_b[0], w_b[1])


@kernel
def secant(old, new, h):
    """The rates that lead from one place to another in the time h."""
    return (
        (new.u - old.u) / h,
        (new.v - old.v) / h,
        (new.r - old.r) / h,
        (new.s - old.s) / h,
    )


@kernel
def next_state(pair, before, motion, h, tracked, feed, status):
    """What is kept of a frame. `feed`: its rates are a feedforward, which predicts the next one."""
    carried = carry_over(pair, before, tracked.shown.found.place)
    return kept_state(carried, before, motion, h, tracked, feed, status)


@kernel
def kept_state(carried, before, motion, h, tracked, feed, status):
    """`next_state`, given the result of `carry_over`."""
    shown = tracked.shown
    found = shown.found
    same, old, old_rates = carried
    rates, last_rates, history = old_rates, before.last_rates, 0
    if feed:
        two = same and before.history >= 1 and before.fed
        rates, last_rates, history = shown.rates, old_rates, 2 if two else 1
    elif same and h > 0.0 and status != DEADLINE and status != NOT_RESTARTED:
        # points of a search that was cut off or not restarted do not have rates
        rates, history = secant(old, found.place, h), 1
    return State(
        found.place,
        rates,
        last_rates,
        h,
        history,
        motion,
        feed,
        before.time + h,
        status in (OVERLAPPING, NOT_CERTIFIED, NOT_RESTARTED),
        tracked.integrated,
        found.normal,
        found.distance,
        shown.inside,
        found.lower,
        before.cut + 1 if status == DEADLINE else 0,
    )


@kernel
def feeds(predictor, has_twist):
    """Does the prediction use this frame's feedforward?"""
    return has_twist and predictor >= PREDICT_FEEDFORWARD
