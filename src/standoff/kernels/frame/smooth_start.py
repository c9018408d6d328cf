"""A cold query of two bodies that are apart, whose witness points lie well inside smooth faces of
kinds that are known when it is compiled.

It descends from samples of which either is the nearest to the other, as the general query begins,
by the smooth frame's own steps. A witness point that leaves its chart goes on from the nearest
sample of another. It makes no other start and knows no boundary: what it ends at is an answer only
where the certificate proves it.
"""

from math import inf
from typing import Any, NamedTuple

import numpy as np

from standoff.kernels.algebra.rigid import relative_pose
from standoff.kernels.algebra.vectors import rotate_back, sub
from standoff.kernels.compiler.decorators import small
from standoff.kernels.frame.answer import write_answer
from standoff.kernels.frame.smooth import (
    FACES,
    inside_feature,
    inside_features,
    look,
    proven,
    write_counts,
)
from standoff.kernels.frame.smooth_steps import (
    NO_FALL,
    Fall,
    is_enough,
    newton_at,
    newton_by,
    slope_at,
)
from standoff.kernels.pair.cold_start import (
    alternating_of,
    at_sample,
    at_samples,
    nearest_of,
    on_other_face,
)
from standoff.kernels.pair.system import covariant_hessian
from standoff.kernels.state.arrays import CONVERGED
from standoff.kernels.state.tracked import Shown
from standoff.kernels.tolerances import AT_REST, EPS, SMOOTH_LOOKS, STAYING
from standoff.kernels.values import (
    NO_CHART,
    NO_RATES,
    ORIGIN,
    Place,
    Side,
    moved,
    resting,
    side_of,
    together,
)

SIDELESS = Side(np.int64(0), NO_CHART, 0.0, 0.0)


class Ended(NamedTuple):
    """Where a descent ended."""

    done: bool  # at rest, well inside both faces
    looks: int  # how often both surfaces were evaluated
    place: Place
    looked: Any


@small
def part_inside(pair, place, step, halvings):
    """The part of a step that ends well inside both faces, halved so often at most; 0 if it does
    not."""
    s = 1.0
    for _ in range(halvings + 1):
        if inside_features(FACES, pair, moved(place, s, step)):
            return s
        s *= 0.5
    return 0.0


@small
def beside(ints, reals, side, dp, dq, y):
    """A side after a step or, where that leaves its chart, the sample of another chart nearest to
    the other body's point y, in the body's frame; `SIDELESS` if none faces it."""
    ahead = Side(side.feature, side.chart, side.p + dp, side.q + dq)
    if inside_feature(2, ints, reals, ahead):
        return ahead
    k = nearest_of(on_other_face, ints, reals, y, ORIGIN, side.chart)
    return at_sample(ints, reals, k) if k >= 0 else SIDELESS


@small
def in_other_chart(pair, pose, place, jets, step):
    """`beside` of both bodies."""
    ia, ra, ib, rb = pair
    x_a, x_b = jets[0][0], jets[1][0]
    a = beside(ia, ra, side_of(place, 0), step[0], step[1], x_b)
    opposite = rotate_back(pose.R, sub(x_a, pose.p))
    return together(a, beside(ib, rb, side_of(place, 1), step[2], step[3], opposite))


@small
def has_charts(place):
    """Are both points in charts?"""
    return min(place.chart_a, place.chart_b) >= 0


@small
def descended_from(look_a, look_b, pair, pose, place):
    """The end of a descent from a place in charts.

    Steps are halved until they lower E, but for those after which a point goes on in another chart:
    E may be greater there. The next step from there is first halved so that it stays: it may be too
    long, as the last one was, and lead back for ever.
    """
    done, looks, halvings = False, 0, 0
    trial, s, fall = place, 1.0, NO_FALL
    while True:
        looked = look(look_a, look_b, pair, pose, trial)
        looks += 1
        if not looked.fits or looks == SMOOTH_LOOKS:
            break
        if not is_enough(fall, s, looked):
            s *= 0.5
            trial = moved(place, s, fall.step)
            continue
        place, at = trial, slope_at(pair, pose, looked)
        done = at.slope <= AT_REST * EPS * at.span
        newton = newton_at(looked, at)
        if not newton.safe:
            newton = newton_by(covariant_hessian(looked.jets[0], looked.jets[1]), at)
        if done or not newton.safe:
            break
        fall = newton.fall
        s = part_inside(pair, place, fall.step, halvings)
        if s > 0.0:
            halvings, trial = 0, moved(place, s, fall.step)
        else:
            halvings, trial = STAYING, in_other_chart(pair, pose, place, looked.jets, fall.step)
            fall = Fall(fall.step, inf, fall.descent)
            if not has_charts(trial):
                break
    return Ended(done, looks, place, looked)


@small
def smooth_start(look_a, look_b, pair, inputs, goal, out):
    """Make the answer of a cold query: True; or write nothing: False. `goal` (relative to the
    pair's size) is the gap between distance and bound at which it is one."""
    pose = relative_pose(inputs.pose_a, inputs.pose_b)
    i, j = alternating_of(on_other_face, pair, pose)
    start = at_samples(pair, i, j)
    if not has_charts(start):
        return False
    ended = descended_from(look_a, look_b, pair, pose, start)
    if not ended.done:
        return False
    place, looked = ended.place, ended.looked
    good, found, status = proven(FACES, pair, pose, place, looked, goal)
    if not good or status != CONVERGED:
        return False
    shown = Shown(found, looked.jets, False, False, NO_RATES)
    write_answer(pair, inputs, resting(pose), shown, ORIGIN, status, out)
    write_counts(ended.looks, out)
    return True
