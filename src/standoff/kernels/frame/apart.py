"""A frame of the predictor-corrector: apart, in contact, or by a global start."""

from math import inf

from standoff.kernels.algebra.vectors import dot, sub
from standoff.kernels.body import layout as L
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.depth.overlap import with_overlap
from standoff.kernels.depth.penetration import contact_scale
from standoff.kernels.frame.answer import is_least_depth
from standoff.kernels.frame.contact import NEAR, WARM, Asked, contact_query
from standoff.kernels.frame.prediction import apply_step, predict
from standoff.kernels.frame.restart import (
    cut_off,
    in_need_of_polish,
    polish_along,
    restart,
    start_due,
)
from standoff.kernels.frame.step import step_frame
from standoff.kernels.pair.certified import (
    CERTIFIED,
    PENETRATING,
    STAYED,
    UNCERTIFIED,
    Followed,
    settle_and_weigh,
)
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.events import KEEPING, exhausted
from standoff.kernels.state.arrays import DEPTH_GLOBAL
from standoff.kernels.state.tracked import (
    ANSWERED,
    TRY_CONTACT,
    TRY_RESTART,
    Shown,
    Tracked,
    without_rates,
)
from standoff.kernels.tolerances import CUT_TURN, SHIFTED_GAP
from standoff.kernels.values import NO_RATES, Found


@kernel
def follow(pair, motion, before, options, h, work):
    """(followed, apart): predict with the feedforward, then make one Newton correction (the
    paper's feedback under Euler with K h = 1), or more if a mode changes; if the certificate's gap
    stays above the tolerance, correct to roundoff. `apart` is False if the witness points have
    passed each other along the last normal.
    """
    tolerance = options.tolerance
    place = apply_step(pair, before.place, predict(before, options.predictor, h), work)
    if before.distance < SHIFTED_GAP * contact_scale(pair):
        jets = pair_jets(pair, motion.pose, place)
        if dot(before.normal, sub(jets[1][0], jets[0][0])) <= 0.0:
            passed = Found(UNCERTIFIED, place, 0.0, -inf, 0.0, before.normal)
            return Followed(passed, jets, False, NO_RATES), False
    followed = settle_and_weigh(pair, motion, place, 1.0, tolerance, tolerance, work)
    if followed.found.outcome == UNCERTIFIED:
        place = followed.found.place
        followed = settle_and_weigh(pair, motion, place, 1.0, 0.0, tolerance, work)
    return followed, True


@kernel
def apart(pair, motion, before, options, h, work):
    """(what next, tracked): one step of the law, outside contact."""
    pose = motion.pose
    followed, stay = follow(pair, motion, before, options, h, work)
    (found, jets, fresh, rates), kept = followed, before.integrated
    if found.outcome == CERTIFIED:
        if in_need_of_polish(pair, found, work):
            found = polish_along(pair, pose, found, options.tolerance, work)
            jets = pair_jets(pair, pose, found.place)
        return ANSWERED, Tracked(Shown(found, jets, False, fresh, rates), kept)
    if exhausted(work) and stay:
        found, inside = cut_off(pair, pose, found)
        cut = Found(
            UNCERTIFIED, found.place, found.distance, found.lower, found.upper, found.normal
        )
        jets = pair_jets(pair, pose, cut.place)
        return ANSWERED, Tracked(Shown(cut, jets, inside, fresh, rates), kept)
    near = before.distance < SHIFTED_GAP * contact_scale(pair)
    unanswered = Tracked(Shown(found, jets, False, False, NO_RATES), kept)
    return TRY_CONTACT if near or not stay else TRY_RESTART, unanswered


@kernel
def contact(pair, pose, before, options, work):
    """(what next, tracked): the local minimum of the depth, from the last frame's."""
    # when frames are cut off, Newton's method and the descent alternate
    newton = before.inside and (before.cut // CUT_TURN) % 2 == 0
    begin = NEAR if newton else WARM
    asked = Asked(options.depth == DEPTH_GLOBAL, not options.restarts)
    # the first frame in contact does not have a block in which to keep a polytope; a frame that
    # needs no proof would let it become slack
    work.counts[KEEPING] = 1 if before.inside and asked.everywhere else 0
    found = contact_query(
        pair, pose, before.place, before.normal, begin, asked, options.tolerance, work
    )
    answered = found.outcome != UNCERTIFIED or exhausted(work)
    tracked = without_rates(pair, pose, found, found.outcome != CERTIFIED, before.integrated)
    return ANSWERED if answered else TRY_RESTART, tracked


@kernel
def stayed(tracked):
    """The same answer with the outcome STAYED: a global start was due, but is not allowed."""
    shown, kept = tracked
    (_, place, d, lower, upper, n), jets, inside, fresh, rates = shown
    found = Found(STAYED, place, d, lower, upper, n)
    return Tracked(Shown(found, jets, inside, fresh, rates), kept)


@kernel
def may_be_less(pair, pose, found, options):
    """May another depth be smaller, if that matters, or is no overlap shown at all?"""
    radii = pair.reals_a[L.RADIUS] + pair.reals_b[L.RADIUS]
    asked = options.depth == DEPTH_GLOBAL or found.upper > radii
    return asked and found.outcome == PENETRATING and not is_least_depth(pair, pose.p, found)


@kernel
def track_alone(pair, motion, before, options, h, work):
    """A frame that follows its local minimum and makes no global start: outside contact, one step
    of the law; in contact, or if that certifies nothing, the local minimum of the depth.
    """
    pose = motion.pose
    if before.inside:
        then, tracked = contact(pair, pose, before, options, work)
    else:
        then, tracked = apart(pair, motion, before, options, h, work)
        if then == ANSWERED:
            return tracked
        then, touching = contact(pair, pose, before, options, work)
        if then == ANSWERED:
            tracked = touching
    due = then != ANSWERED or may_be_less(pair, pose, tracked.shown.found, options)
    return stayed(tracked) if due else tracked


@kernel
def track_predicted(pair, motion, before, options, h, work):
    """This frame from the last one: outside contact, one step of the law; in contact, or if the
    witness points pass each other, the local minimum of the depth; if neither certifies, a global
    start, and if that certifies nothing, a proof of overlap. Without restarts, `track_alone`.
    """
    pose = motion.pose
    if not options.restarts:
        return track_alone(pair, motion, before, options, h, work)
    due, first = start_due(before, work)
    if not before.lost:
        then = TRY_RESTART
        if before.inside:
            then = TRY_CONTACT
        elif not due:
            then, tracked = apart(pair, motion, before, options, h, work)
            if then == ANSWERED:
                return tracked
        if then == TRY_CONTACT:
            then, tracked = contact(pair, pose, before, options, work)
            if then == ANSWERED:
                return tracked
    shown, kept = restart(pair, pose, first, options.tolerance, before.integrated, work)
    found = with_overlap(pair, pose, shown.found, work)
    return Tracked(Shown(found, shown.jets, shown.inside, shown.fresh, shown.rates), kept)


@kernel
def predicted_frame(pair, inputs, h, options, state, out, work):
    """A frame of the predictor-corrector."""
    step_frame(track_predicted, pair, inputs, (h, h), options, state, out, work)
