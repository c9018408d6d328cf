"""A frame of the paper's law: integrate, saturate, switch; contact and global starts are as for the
predictor-corrector."""

from standoff.kernels.algebra.vectors import dot, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.depth.penetration import contact_scale
from standoff.kernels.depth.search import overlap_shown
from standoff.kernels.frame.apart import contact
from standoff.kernels.frame.inputs import CHANGE, FIRST_CHANGE
from standoff.kernels.frame.restart import cut_off, restart, start_due
from standoff.kernels.frame.step import step_frame
from standoff.kernels.pair.certified import CERTIFIED, PENETRATING, UNCERTIFIED, weigh
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.events import exhausted
from standoff.kernels.paper.integrators import Change
from standoff.kernels.paper.law import carry_and_switch, integrate_and_switch
from standoff.kernels.state.arrays import SWITCH_NONE
from standoff.kernels.state.state import read_four
from standoff.kernels.state.tracked import (
    ANSWERED,
    TRY_CONTACT,
    TRY_RESTART,
    Tracked,
    begun,
    without_rates,
)
from standoff.kernels.tolerances import SHIFTED_GAP
from standoff.kernels.values import NO_RATES, ORIGIN, Found


@kernel
def left_alone(options):
    """May only the law move the witness points?"""
    return options.switching == SWITCH_NONE or not options.restarts


@kernel
def follow_paper(advance, pair, motion, before, options, step, work):
    """(found, apart, integrated) of one step of the law."""
    pose = motion.pose
    place, integrated = advance(pair, motion, before, options, step, work)
    jets = pair_jets(pair, pose, place)
    outcome, d, lower, normal = weigh(pair, pose, place, jets, ORIGIN, options.tolerance)
    # while it still converges from a wrong start the normal tells nothing
    settled = before.lower > 0.5 * before.distance
    apart = dot(before.normal, sub(jets[1][0], jets[0][0])) > 0.0 or not settled
    return Found(outcome, place, d, lower, d, normal), apart, integrated


@kernel
def outside(advance, pair, motion, before, options, step, work):
    """(what next, doubted, tracked): one step of the law, outside contact. Doubted where the law
    lags behind the motion, and the bodies may have met."""
    pose = motion.pose
    alone = left_alone(options)
    found, apart, integrated = follow_paper(advance, pair, motion, before, options, step, work)
    near = before.distance < SHIFTED_GAP * contact_scale(pair)
    lags = apart and found.outcome == UNCERTIFIED
    # behind the motion, or no longer apart?
    doubted = lags and found.lower <= 0.0 and (near or overlap_shown(pair, pose)[0])
    tracked = without_rates(pair, pose, found, False, integrated)
    if found.outcome == CERTIFIED or alone or (lags and not doubted):
        return ANSWERED, False, tracked
    if exhausted(work) and apart:
        found, inside = cut_off(pair, pose, found)
        cut = Found(
            UNCERTIFIED, found.place, found.distance, found.lower, found.upper, found.normal
        )
        return ANSWERED, False, without_rates(pair, pose, cut, inside, integrated)
    return TRY_CONTACT if near or not apart or doubted else TRY_RESTART, doubted, tracked


@kernel
def anew(pair, pose, tracked, gain):
    """The law begins again: its integrated errors are those of the witness points."""
    return Tracked(tracked.shown, begun(pair, pose, tracked.shown.found.place, gain))


@kernel
def track_paper(pair, motion, before, options, h, work):
    """`track_predicted`, of the paper's law."""
    return track_by(integrate_and_switch, pair, motion, before, options, h, work)


@kernel
def track_carried(pair, motion, before, options, change, work):
    """`track_paper`, of a change that was integrated together with the bodies' motion."""
    return track_by(carry_and_switch, pair, motion, before, options, change, work)


@kernel
def track_by(advance, pair, motion, before, options, step, work):
    """A frame of the paper's law, whose parameters `advance` takes on by a step."""
    pose = motion.pose
    due, first = start_due(before, work)
    alone = left_alone(options)
    inside = before.inside and not alone
    kept = before.integrated
    if alone or (not before.lost and (inside or not due)):
        then, doubted = TRY_CONTACT, False
        outside_contact = without_rates(
            pair,
            pose,
            Found(UNCERTIFIED, before.place, 0.0, 0.0, 0.0, before.normal),
            False,
            kept,
        )
        if not inside:
            then, doubted, outside_contact = outside(
                advance, pair, motion, before, options, step, work
            )
            kept = outside_contact.integrated
            if then == ANSWERED:
                return outside_contact
        if then == TRY_CONTACT:
            then, touching = contact(pair, pose, before, options.depth, options.tolerance, work)
            if doubted and touching.shown.found.outcome != PENETRATING:
                found = outside_contact.shown.found
                lagging = Found(
                    UNCERTIFIED,
                    found.place,
                    found.distance,
                    found.lower,
                    found.distance,
                    found.normal,
                )
                return without_rates(pair, pose, lagging, False, kept)
            if then == ANSWERED:
                return anew(pair, pose, touching, kept.gain)
    tracked = restart(pair, pose, first, options.tolerance, kept, work)
    return anew(pair, pose, tracked, kept.gain)


@kernel
def carried_change(inputs, options):
    """What the bodies' own method has integrated."""
    change, first = read_four(inputs.change, CHANGE), read_four(inputs.change, FIRST_CHANGE)
    return Change(change, NO_RATES, NO_RATES, options.gain, first)


@kernel
def integrated_frame(pair, inputs, h, options, state, out, work):
    """A frame of the paper's law, which integrates its parameters by itself."""
    step_frame(track_paper, pair, inputs, (h, h), options, state, out, work)


@kernel
def carried_frame(pair, inputs, h, options, state, out, work):
    """A frame of the paper's law, whose parameters were integrated with the bodies' motion."""
    steps = h, carried_change(inputs, options)
    step_frame(track_carried, pair, inputs, steps, options, state, out, work)


@kernel
def paper_frame(pair, inputs, h, options, state, out, work):
    """Either, as the options name it."""
    if options.carried:
        carried_frame(pair, inputs, h, options, state, out, work)
    else:
        integrated_frame(pair, inputs, h, options, state, out, work)
