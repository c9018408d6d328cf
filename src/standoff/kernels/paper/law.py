"""The paper's law over one frame: integrate, saturate, switch; with the variants that it prints."""

from standoff.kernels.algebra.vectors import (
    add,
    axpy,
    dot,
    norm,
    rotate,
    rotate_back,
    scale,
    sub,
)
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_jet, coedge_record, pair_span
from standoff.kernels.body.trimming import HIT_COEDGE, HIT_LIMIT, NO_HIT, walk
from standoff.kernels.compiler.decorators import kernel, shared
from standoff.kernels.frame.prediction import apply_step
from standoff.kernels.pair.certified import on_feature
from standoff.kernels.pair.descent import (
    NO_EDGE,
    pair_jets,
    recentre,
    release_along,
    take_hit,
    walk_pair,
)
from standoff.kernels.pair.events import CHART_CHANGES, CORRECTIONS, EVENTS, SATURATIONS
from standoff.kernels.pair.newton import gradient_norm, metric_inverse
from standoff.kernels.pair.system import gradient, projection_errors
from standoff.kernels.paper.integrators import Change, integrate
from standoff.kernels.paper.voronoi import voronoi_switch
from standoff.kernels.state.arrays import (
    FEEDBACK_PI,
    SATURATE_ZERO,
    SOLVE_COVARIANT,
    SWITCH_MULTIPLIERS,
    SWITCH_VORONOI,
)
from standoff.kernels.state.options import feedback_number
from standoff.kernels.state.state import Integrated, moved_to
from standoff.kernels.state.tracked import begun, errors_at
from standoff.kernels.tolerances import (
    EPS,
    FOOT_REACH,
    LONGEST_CHANGE,
    MAX_VORONOI_PASSES,
    MOST_HELD,
    SLOPE,
    SLOPE_NOISE,
    STANDSTILL,
    TOUCHING,
    WOUND_UP,
)
from standoff.kernels.values import NO_RATES, Side, body_of, side_of, together, with_side


@kernel
def at_collapsed_side(ints, hit):
    """Has a walk met a side of its face that has collapsed into a vertex?"""
    return hit.kind == HIT_COEDGE and ints[coedge_record(ints, hit.index) + L.COEDGE_EDGE] < 0


@kernel
def zeroed_step(pair, place, step, solve, work):
    """The paper's saturation: a component that leads out of its feature is zeroed after the solve.

    Each parameter goes by itself as far as its feature lets it; no feature is left. By the
    covariant solve a point on a collapsed side is at its vertex: the parameter along that side
    moves nothing, and the face would be left by the directions of one value of it alone.
    """
    for k in range(4):
        body = k // 2
        ints, reals = body_of(pair, body)
        side = side_of(place, body)
        da, db = (step[k], 0.0) if k % 2 == 0 else (0.0, step[k])
        hit = walk(ints, reals, side.feature, side.chart, side.p, side.q, da, db)
        there = Side(side.feature, side.chart, side.p + hit.s * da, side.q + hit.s * db)
        place = with_side(place, body, there)
        if hit.kind == HIT_LIMIT:
            return take_hit(pair, place, body, hit, NO_EDGE, work)[0]
        work.counts[SATURATIONS] += hit.kind != NO_HIT
        if solve == SOLVE_COVARIANT and at_collapsed_side(ints, hit):
            place = take_hit(pair, place, body, hit, NO_EDGE, work)[0]
            step = (0.0, 0.0, step[2], step[3]) if body == 0 else NO_RATES
    return recentre(pair, place, work)[0]


@kernel
def voronoi_passes(pair, pose, place, span, options, work):
    """Test both bodies' features against each other's witness points until none switches."""
    for _ in range(MAX_VORONOI_PASSES):
        jet_a, jet_b = pair_jets(pair, pose, place)
        switched, place = voronoi_switch(pair, 0, jet_b[0], span, place, options, work)
        if switched:
            continue
        x = rotate_back(pose.R, sub(jet_a[0], pose.p))
        switched, place = voronoi_switch(pair, 1, x, span, place, options, work)
        if not switched:
            break
    return place


@kernel
def saturate_integral(pair, pose, options, place, integral, work):
    """Keep each part of the integral within what WOUND_UP spans of error would command; those that
    are cut are counted as saturations."""
    if options.feedback != FEEDBACK_PI:
        return integral
    jet_a, jet_b = pair_jets(pair, pose, place)
    span = pair_span(pair, pose.p, norm(sub(jet_a[0], jet_b[0])))
    return (
        within(integral[0], most_integral(options, span, jet_a[1]), work),
        within(integral[1], most_integral(options, span, jet_a[2]), work),
        within(integral[2], most_integral(options, span, jet_b[1]), work),
        within(integral[3], most_integral(options, span, jet_b[2]), work),
    )


@kernel
def most_integral(options, span, tangent):
    return WOUND_UP * span * norm(tangent) / feedback_number(options, 0)


@kernel
def within(value, most, work):
    """A number cut to its bound, and counted as saturated."""
    if abs(value) <= most:
        return value
    work.counts[SATURATIONS] += 1
    return most if value > 0.0 else -most


@kernel
def total(four):
    """NaN where one of four numbers is infinite or none, else 0."""
    return 0.0 * four[0] + 0.0 * four[1] + 0.0 * four[2] + 0.0 * four[3]


@kernel
def longest(four):
    """The greatest magnitude of four numbers."""
    return max(max(abs(four[0]), abs(four[1])), max(abs(four[2]), abs(four[3])))


@kernel
def drop_unbounded(change, work):
    """A frame whose integration overflows changes nothing, and counts as saturated."""
    numbers = total(change.parameters) + total(change.errors) + total(change.integral)
    finite = numbers + total(change.first) == 0.0
    if finite and max(longest(change.parameters), longest(change.first)) <= LONGEST_CHANGE:
        return change
    work.counts[SATURATIONS] += 1
    return Change(NO_RATES, NO_RATES, NO_RATES, change.gain, NO_RATES)


@kernel
def plus(a, b):
    return a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]


@kernel
def remember(pair, pose, options, before, place, change, moved, work):
    """The integrated errors and their integral, carried over the frame.

    Where a switch, a change of chart or a saturation has `moved` them the errors are read anew
    from Eqs. (1)-(4). The integral waits in a frame that is saturated, or it would wind up; that
    of a body whose feature or chart has changed begins again.
    """
    errors = plus(before.integrated.errors, change.errors)
    integral = before.integrated.integral
    if work.counts[SATURATIONS] == 0:
        integral = plus(integral, change.integral)
    old = before.place
    if old.feature_a != place.feature_a or old.chart_a != place.chart_a:
        moved, integral = True, (0.0, 0.0, integral[2], integral[3])
    if old.feature_b != place.feature_b or old.chart_b != place.chart_b:
        moved, integral = True, (integral[0], integral[1], 0.0, 0.0)
    integral = saturate_integral(pair, pose, options, place, integral, work)
    if moved:
        errors = errors_at(pair, pose, place)
    return Integrated(errors, integral, change.gain)


@kernel
def held_step(pair, place, change):
    """The step of a frame that holds what it meets.

    From a boundary a trial stage may go so far that the sum of the stages leads out of the patch
    which the first one enters: then the first stage alone is taken, as Euler's method does.
    """
    hit = walk_pair(pair, place, change.parameters)[1]
    if hit.kind == NO_HIT or hit.s > STANDSTILL:
        return change.parameters
    within_patch = walk_pair(pair, place, change.first)[1].s > hit.s
    return change.first if within_patch else change.parameters


@kernel
def as_before(before, place):
    """Is a place the one before it, up to roundoff?"""
    most = max(
        max(abs(place.u - before.u), abs(place.v - before.v)),
        max(abs(place.r - before.r), abs(place.s - before.s)),
    )
    same_a = place.feature_a == before.feature_a and place.chart_a == before.chart_a
    same_b = place.feature_b == before.feature_b and place.chart_b == before.chart_b
    return same_a and same_b and most <= STANDSTILL


@kernel
def released(pair, pose, before, place, gap, work):
    """The place after the test of the multipliers; gap is (n, d, least slope).

    A frame may hold a boundary that its step leads out of at once, and the test release it again:
    nothing has moved, and the next frame would do the same for ever. Then the boundary is kept, so
    that the next frame solves on it, and moves.
    """
    n, d, floor = gap
    switches = work.counts[EVENTS]
    free, found = release_along(pair, pose, place, n, d, floor, work)
    if free and switches > 0 and as_before(before, found):
        work.counts[EVENTS] = switches
        return place
    return found


@kernel
def held_at_once(pair, motion, before, options, h, work):
    """(before, change): a boundary that the rates lead out of where they begin is held, and the law
    solved again on it, until they lead along it or nothing is free.

    The Voronoi tests let a boundary go in the same frame, wherever the opposing point is not beyond
    it: held after the step, it would stop every frame anew, and nothing would move along it.
    """
    change = integrate(pair, before, motion, h, options, work)
    for _ in range(MOST_HELD):
        body, hit = walk_pair(pair, before.place, change.first)
        if hit.kind == NO_HIT or hit.kind == HIT_LIMIT or hit.s > STANDSTILL:
            break
        place = take_hit(pair, before.place, body, hit, NO_EDGE, work)[0]
        errors = begun(pair, before.motion.pose, place, before.integrated.gain)
        before = moved_to(before, place, errors)
        change = integrate(pair, before, motion, h, options, work)
    return before, change


@shared
def integrate_and_switch(pair, motion, before, options, h, work):
    """(place, integrated): w = -M⁻¹(v(Psi) + b) over one frame, then a switch."""
    if options.saturation == SATURATE_ZERO or options.switching != SWITCH_VORONOI:
        change = integrate(pair, before, motion, h, options, work)
        return carry_and_switch(pair, motion, before, options, change, work)
    held, change = held_at_once(pair, motion, before, options, h, work)
    place, integrated = carry_and_switch(pair, motion, held, options, change, work)
    if place.feature_a == before.place.feature_a and place.feature_b == before.place.feature_b:
        work.counts[EVENTS] = 0  # what was held for the frame alone is no switch
    return place, integrated


@kernel
def beside_foot(ints, reals, side, x, reach):
    """(cut, side): a half-space's witness point, no farther than `reach` (length) from the foot of
    x, in its frame. The plane has no boundary to saturate at.
    """
    jet = chart_jet(ints, reals, side.chart, 0.0, 0.0)
    i = metric_inverse(jet[1], jet[2])
    way = sub(x, jet[0])
    a, b = i[0] * dot(jet[1], way), i[1] * dot(jet[1], way) + i[2] * dot(jet[2], way)
    u, v = i[0] * a + i[1] * b, i[2] * b
    du, dv = side.p - u, side.q - v
    far = norm(axpy(du, jet[1], scale(dv, jet[2])))
    if far <= reach:
        return 0, side
    s = reach / far
    return 1, Side(side.feature, side.chart, u + s * du, v + s * dv)


@kernel
def box_centre(reals):
    o = L.BOX_CENTRE
    return reals[o], reals[o + 1], reals[o + 2]


@kernel
def within_reach(pair, pose, place, work):
    """The place, kept beside the other body where one is a half-space; counted as saturated."""
    ia, ra, ib, rb = pair
    if not (ia[L.UNBOUNDED] or ib[L.UNBOUNDED]):
        return place
    reach = FOOT_REACH * pair_span(pair, pose.p, 0.0)
    cut_a, cut_b = 0, 0
    side_a, side_b = side_of(place, 0), side_of(place, 1)
    if ia[L.UNBOUNDED]:
        x = add(rotate(pose.R, box_centre(rb)), pose.p)
        cut_a, side_a = beside_foot(ia, ra, side_a, x, reach)
    if ib[L.UNBOUNDED]:
        x = rotate_back(pose.R, sub(box_centre(ra), pose.p))
        cut_b, side_b = beside_foot(ib, rb, side_b, x, reach)
    work.counts[SATURATIONS] += cut_a + cut_b
    return together(side_a, side_b)


@kernel
def stepped(pair, pose, before, options, change, work):
    """The place after the step and its saturation: on both bodies, or else where it was."""
    if options.saturation == SATURATE_ZERO:
        place = zeroed_step(pair, before, change.parameters, options.solve, work)
    else:
        place = apply_step(pair, before, held_step(pair, before, change), work)
    place = within_reach(pair, pose, place, work)
    if on_feature(pair, place):
        return place
    work.counts[SATURATIONS] += 1
    return before


@kernel
def carry_and_switch(pair, motion, before, options, change, work):
    """(place, integrated): a change that was integrated, then a switch."""
    change = drop_unbounded(change, work)
    work.counts[CORRECTIONS] += 1
    pose = motion.pose
    place = stepped(pair, pose, before.place, options, change, work)
    jet_a, jet_b = pair_jets(pair, pose, place)
    dR = sub(jet_a[0], jet_b[0])
    d = norm(dR)
    span = pair_span(pair, pose.p, d)
    if d > TOUCHING * span and options.switching == SWITCH_MULTIPLIERS:
        # released before it is at rest, a feature is taken back and given up for ever: a slope
        # must exceed the residual's own
        slope = gradient_norm(jet_a, jet_b, gradient(projection_errors(jet_a, jet_b)))
        floor = max(SLOPE, max(SLOPE_NOISE * EPS * span, slope) / d)
        place = released(pair, pose, before.place, place, (scale(-1.0 / d, dR), d, floor), work)
    elif options.switching == SWITCH_VORONOI:
        place = voronoi_passes(pair, pose, place, span, options, work)
    counts = work.counts
    moved = counts[SATURATIONS] + counts[CHART_CHANGES] + counts[EVENTS] > 0
    return place, remember(pair, pose, options, before, place, change, moved, work)
