"""One frame of the hybrid tracker, whatever its law; and the first one, a cold query."""

from __future__ import annotations

from math import inf

import numpy as np

from standoff.kernels.algebra.rigid import read_rotation, read_vector, relative_pose
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import dimension, edge_record
from standoff.kernels.compiler.calls import CAN_CALL
from standoff.kernels.compiler.decorators import kernel, shared
from standoff.kernels.frame.answer import judge
from standoff.kernels.frame.inputs import twisted
from standoff.kernels.frame.prediction import feeds, next_state
from standoff.kernels.frame.record import call_at
from standoff.kernels.frame.step import answer_frame, copy_counts
from standoff.kernels.pair.certified import (
    CERTIFIED,
    NOT_APART,
    UNCERTIFIED,
    settle_and_weigh,
    weigh,
)
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.events import (
    EVENTS,
    GENERAL_FRAMES,
    KEEPING,
    KEPT,
    LIMIT,
    N_COUNTS,
    NO_LIMIT,
    RESTARTS,
)
from standoff.kernels.pair.far import boxes_apart, way_between
from standoff.kernels.pair.polytope_layout import N_VERTICES
from standoff.kernels.state.arrays import (
    DISTANCE,
    FAR,
    FINE,
    LAST_BOUND,
    LOWER_BOUND,
    NOT_KNOWN_APART,
    OUT_COUNTS,
    OUT_MODE,
    OUT_Q,
    POSE,
    SKIPPED,
    START_ANYWHERE,
    START_HERE,
    STATUS,
    TIME,
    UPPER_BOUND,
)
from standoff.kernels.state.state import (
    Integrated,
    fresh_state,
    read_place,
    write_state,
)
from standoff.kernels.state.tracked import Shown, Tracked, begun, without_rates
from standoff.kernels.tolerances import BOUND_ROUNDINGS, EPS, FARTHEST, START_GAP
from standoff.kernels.values import NO_RATES, ORIGIN, Found, Pose

if not CAN_CALL:
    from standoff.kernels.frame.apart import predicted_frame
    from standoff.kernels.paper.frame import paper_frame

NOT_INTEGRATED = Integrated(NO_RATES, NO_RATES, 0.0)


@kernel
def begin_at(pair, motion, place, given, goal, work):
    """What is found at a place that is given: there, or by descent from it."""
    pose = motion.pose
    if given == START_HERE:
        jets = pair_jets(pair, pose, place)
        outcome, d, lower, normal = weigh(pair, pose, place, jets, ORIGIN, goal)
        return Found(outcome, place, d, lower, d, normal)
    return settle_and_weigh(pair, motion, place, 0.0, 0.0, goal, work).found


@kernel
def write_far(bound, out):
    """The answer of a pair beyond its horizon: a lower bound, and nothing else."""
    for k in range(OUT_COUNTS):
        out[k] = np.nan
    out[DISTANCE], out[UPPER_BOUND], out[LOWER_BOUND] = inf, inf, bound
    for k in range(OUT_MODE, OUT_Q):
        out[k] = -1.0
    out[STATUS] = FAR


@kernel
def beyond(options, out):
    """Leave of an answer beyond the horizon its bound, whichever way it was found."""
    if options.within < inf and out[LOWER_BOUND] > options.within:
        write_far(out[LOWER_BOUND], out)


@kernel
def bound_without(pair, inputs, state):
    """A lower bound of the distance from the last frame's and the way since, or from the boxes."""
    pose = relative_pose(inputs.pose_a, inputs.pose_b)
    before = Pose(read_rotation(state, POSE), read_vector(state, POSE + 9))
    radii = pair.reals_a[L.RADIUS] + pair.reals_b[L.RADIUS]
    way = way_between(pair, before, pose)
    by_way = state[LAST_BOUND] - radii - way
    by_way -= BOUND_ROUNDINGS * EPS * (abs(state[LAST_BOUND]) + radii + min(way, FARTHEST))
    return max(by_way, boxes_apart(pair, pose))


@kernel
def start_frame(query_from, pair, inputs, options, state, given, out, work):
    """The first frame: anywhere by the query given, by descent from the state's place, or there."""
    motion = twisted(inputs, relative_pose(inputs.pose_a, inputs.pose_b))
    if options.within < inf and not has_frame(options):  # no tracker goes on from here
        bound = boxes_apart(pair, motion.pose)
        if bound > options.within:
            write_far(bound, out)
            copy_counts(work, out)
            return FINE
    goal = min(options.tolerance, START_GAP)
    place = read_place(state)
    found = Found(UNCERTIFIED, place, 0.0, -1.0, 0.0, ORIGIN)
    inside = False
    work.counts[LIMIT] = NO_LIMIT  # a start has no deadline
    if given != START_ANYWHERE:
        found = begin_at(pair, motion, place, given, goal, work)
    if found.outcome != CERTIFIED and given != START_HERE:
        work.counts[RESTARTS] += 0 if given == START_ANYWHERE else 1
        found, inside = query_from(pair, motion.pose, goal, work)
        if found.outcome == NOT_APART:
            return NOT_KNOWN_APART
    status = judge(pair, motion.pose.p, found, given == START_HERE, goal, False)
    shown = without_rates(pair, motion.pose, found, inside, NOT_INTEGRATED).shown
    rates = answer_frame(pair, inputs, motion, shown, options.solve, status, out, work)
    integrated = NOT_INTEGRATED
    if options.paper:
        integrated = begun(pair, motion.pose, found.place, 0.0)
    work.counts[EVENTS] = 0
    known = Tracked(Shown(found, shown.jets, inside, False, rates), integrated)
    before = fresh_state(found.place, integrated)
    feed = feeds(options.predictor, inputs.has_twist)
    write_state(next_state(pair, before, motion, 0.0, known, feed, status), state)
    state[SKIPPED] = 0.0
    copy_counts(work, out)
    beyond(options, out)
    return FINE


@kernel
def clear_counts(work):
    for k in range(N_COUNTS):
        work.counts[k] = 0
    work.counts[KEEPING], work.counts[KEPT] = 0, 0


@kernel
def forget_polytope(work):
    """Leave the next frame no polytope where this one has kept none."""
    if work.counts[KEPT] == 0:
        work.polytope[N_VERTICES] = 0.0


@kernel
def on_line(ints, feature):
    """Is a feature a straight edge?"""
    edge = dimension(ints, feature) == 1
    return edge and ints[edge_record(ints, feature) + L.EDGE_KIND] == L.LINE


@kernel
def may_be_smooth(pair, state):
    """Were both witness points on faces, or one on a straight edge? Elsewhere the smooth frame need
    not be asked."""
    place = read_place(state)
    a = dimension(pair.ints_a, place.feature_a) == 2
    b = dimension(pair.ints_b, place.feature_b) == 2
    if a and b:
        return True
    if a:
        return on_line(pair.ints_b, place.feature_b)
    return b and on_line(pair.ints_a, place.feature_a)


if CAN_CALL:

    @kernel
    def law_frame(pair, inputs, h, options, state, out, work):
        """A frame of the law: compiled apart, called by its address among the options."""
        call_at(options.frame, pair, inputs, h, options, state, out, work)

else:

    @kernel
    def law_frame(pair, inputs, h, options, state, out, work):
        """A frame of the law that the options name."""
        if options.paper:
            paper_frame(pair, inputs, h, options, state, out, work)
        else:
            predicted_frame(pair, inputs, h, options, state, out, work)


@kernel
def has_frame(options):
    """Is the law's frame known? Starts need none."""
    return not CAN_CALL or options.frame != 0


@kernel
def far_frame(pair, inputs, h, options, state, out, work):
    """Answer a frame by a bound where that exceeds the horizon; did it? The state stays that of the
    last frame that was made, but for the time.

    The paper's law integrates from frame to frame, so none of its frames is left out.
    """
    if options.paper:
        return False
    bound = bound_without(pair, inputs, state)
    if not bound > options.within:
        return False
    write_far(bound, out)
    copy_counts(work, out)
    state[TIME] += h
    state[SKIPPED] += h
    return True


@kernel
def full_frame(pair, inputs, h, options, state, out, work):
    """A frame that is made, h seconds after the last that was."""
    if options.smooth != 0:
        asked = may_be_smooth(pair, state)
        if asked and call_at(options.smooth, pair, inputs, h, options, state, out, work) != 0:
            forget_polytope(work)
            return
        work.counts[GENERAL_FRAMES] = 1
    law_frame(pair, inputs, h, options, state, out, work)
    forget_polytope(work)


@shared
def frame(pair, inputs, h, options, state, out, work):
    """One frame of the law that the options name, on every route: the state is changed in place,
    the answer written.

    A module of its own: within the caller's, whose stack the counts stand on, LLVM has left them
    uncleared for the law's frame, to which it sees no pointer go.
    """
    clear_counts(work)
    if options.within < inf:
        if far_frame(pair, inputs, h, options, state, out, work):
            forget_polytope(work)
            return
        time, skipped = state[TIME], state[SKIPPED]
        full_frame(pair, inputs, h + skipped, options, state, out, work)
        state[TIME], state[SKIPPED] = time + h, 0.0
        beyond(options, out)
        return
    full_frame(pair, inputs, h, options, state, out, work)
