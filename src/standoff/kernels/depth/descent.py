"""The descent of s(n) to a local minimum of the depth: steps, starts ahead, saddles, restarts."""

from math import inf
from typing import NamedTuple

from standoff.kernels.algebra.vectors import axpy, dot, norm, sub, unit
from standoff.kernels.body.features import pair_span
from standoff.kernels.compiler.decorators import kernel, shared
from standoff.kernels.depth.penetration import (
    MINIMUM,
    NOTHING,
    SADDLE,
    begin_along,
    box_depth,
    contact_scale,
    minimum_along,
    principal_radii,
    shifted,
)
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.events import RESTARTS, exhausted
from standoff.kernels.tolerances import (
    CONTACT_RESIDUAL,
    LEAST_GAP,
    LESS_REACH,
    MAX_LEAP,
    MAX_SHIFTS,
    MOVE_IN,
    NEWTON_TURN,
    NUDGE,
    ROUNDED_RADIUS,
    SADDLE_SHIFTS,
    SHIFTED_GAP,
)
from standoff.kernels.values import Depth, Place, Vector


@kernel
def newton_start(pair, pose, at, reach):
    """(defined, start): Newton's step of s(n) from a depth's direction, no farther than `reach`;
    along directions in which s is concave, where the focal depth is passed, as far downhill. Not
    defined where a corner makes s(n) linear.
    """
    n = at.normal
    jet_a, jet_b = pair_jets(pair, pose, at.place)
    between = sub(jet_a[0], jet_b[0])
    s = dot(n, between)
    least, way, most, other = principal_radii(pair, jet_a, jet_b, n, contact_scale(pair))
    # beside a flat direction the lesser radius keeps that one's roundings
    noise = ROUNDED_RADIUS * most if most < inf else 0.0
    if least <= CONTACT_RESIDUAL * contact_scale(pair) + noise:
        return False, n
    g_1, g_2 = dot(way, between), dot(other, between)
    h_1, h_2 = abs(least - s), abs(most - s)
    step_1 = -g_1 / h_1 if abs(g_1) < reach * h_1 else (-reach if g_1 > 0.0 else reach)
    step_2 = -g_2 / h_2 if abs(g_2) < reach * h_2 else (-reach if g_2 > 0.0 else reach)
    return True, unit(axpy(step_1, way, axpy(step_2, other, n)))


@kernel
def next_start(n, start, n_new, turn, ahead):
    """(start, ahead) of the next step at corners, after one from `start` to n_new; n was the last.

    Steps may shrink by little, so the next one starts ahead, farther each time. A long step back
    had leapt past.
    """
    step = sub(n_new, start)
    if turn == 0.0 or (turn > NEWTON_TURN and dot(step, sub(start, n)) < 0.0):
        return n_new, 0.0
    ahead = min(2.0 * ahead, MAX_LEAP) if ahead > 0.0 else 1.0
    return unit(axpy(min(ahead, NEWTON_TURN / turn), step, n_new)), ahead


class Way(NamedTuple):
    """Where the descent's next step starts."""

    start: Vector  # the direction
    guess: float  # at most the signed distance along it
    warm: Place
    ahead: float  # in steps, how far the start lies beyond the last one's end
    reach: float  # how far Newton's step of s(n) may go (chord)
    gap: float  # what the pair is shifted out to, in contact scales


# What a step of the descent comes to.
TAKEN, AGAIN, STUCK = range(3)


@kernel
def retried(pair, pose, last, apart, new, way):
    """(TAKEN, AGAIN or STUCK, way): of a step that led to `new`, or did not part the bodies."""
    if way.ahead > 0.0 and (not apart or new.distance < way.guess):
        # leapt too far
        shorter = way.reach / LESS_REACH
        return AGAIN, Way(last.normal, way.guess, new.place, 0.0, shorter, way.gap)
    if not apart:  # the guess was too near
        farther = -box_depth(pair, pose, way.start)
        if way.guess <= farther:
            return STUCK, way
        return AGAIN, Way(way.start, farther, new.place, way.ahead, way.reach, way.gap)
    return TAKEN, way


@kernel
def onward(pair, pose, last, new, way, move_in):
    """Where to go on from a step taken. `move_in`: features that meet beside the normal turn it
    by their offset over the gap, which is to be less."""
    reach = min(2.0 * way.reach, NEWTON_TURN) if way.ahead > 0.0 else way.reach
    curved, start = newton_start(pair, pose, new, reach)
    ahead = 1.0
    if not curved:
        turn = norm(sub(new.normal, way.start))
        start, ahead = next_start(last.normal, way.start, new.normal, turn, way.ahead)
    gap = max(way.gap / MAX_LEAP, LEAST_GAP) if move_in else way.gap
    return Way(start, new.distance, new.place, ahead, reach, gap)


@kernel
def fallen(saddle, falls, d, span):
    """(saddle, falls): steps in which s has not fallen below a saddle's; forgotten once it has."""
    if not saddle.found:
        return saddle, falls
    if d > saddle.distance + CONTACT_RESIDUAL * span:
        return Depth(False, -inf, saddle.normal, saddle.place), 0
    return saddle, falls + 1


@kernel
def least_of(pair, pose, saddle, guess, last):
    """What a descent that found no minimum ends at."""
    span = pair_span(pair, pose.p, abs(saddle.distance))
    if saddle.found and not guess > saddle.distance + CONTACT_RESIDUAL * span:
        return saddle
    return Depth(False, guess, last.normal, last.place)


@kernel
def with_guess(pair, pose, depth):
    """The depth, with a distance where it has none."""
    if depth.distance == depth.distance:
        return depth
    return Depth(False, -box_depth(pair, pose, depth.normal), depth.normal, depth.place)


@kernel
def minimum_near(pair, pose, at, turn, tolerance, work):
    """`minimum_along`, tried only after a step that has turned the normal by little."""
    if turn > NEWTON_TURN:
        return NOTHING, at, at.normal
    return minimum_along(pair, pose, at, tolerance, work)


@shared
def descend(pair, pose, last, tolerance, work):
    """The local minimum of s reached from a depth's direction and place.

    The depth's distance is a guess, nan for none. Not found: the last of the descent. A saddle is
    left along its steepest way; where s does not fall there by more than roundoff (across a
    crease, whose radius of curvature is 0 on a line only), it is the minimum.
    """
    last = with_guess(pair, pose, last)
    way = Way(last.normal, last.distance, last.place, 0.0, NEWTON_TURN, SHIFTED_GAP)
    restarted, falls, before = False, 0, -inf
    saddle = Depth(False, -inf, last.normal, last.place)
    for k in range(1, MAX_SHIFTS + 1):
        if exhausted(work):
            break
        at = Depth(False, way.guess, way.start, way.warm)
        apart, new = shifted(pair, pose, at, way.gap, work)
        if not apart and exhausted(work):
            return Depth(False, way.guess, last.normal, new.place)
        came_to, way = retried(pair, pose, last, apart, new, way)
        if came_to == STUCK:
            break
        if came_to == AGAIN:
            continue
        turn = norm(sub(new.normal, way.start))
        way = onward(pair, pose, last, new, way, k % MOVE_IN == 0)
        last, d = new, new.distance
        saddle, falls = fallen(saddle, falls, d, pair_span(pair, pose.p, abs(d)))
        if falls > SADDLE_SHIFTS:
            return saddle
        kind, ended, down = minimum_near(pair, pose, last, turn, tolerance, work)
        if kind == MINIMUM:
            return ended
        if kind == SADDLE:
            if not saddle.found:
                saddle, falls = Depth(True, ended.distance, ended.normal, ended.place), 0
                start = unit(axpy(NUDGE, down, ended.normal))
                guess = -box_depth(pair, pose, start)
                way, before = Way(start, guess, ended.place, 0.0, way.reach, way.gap), -inf
                continue
            way = Way(way.start, d, ended.place, way.ahead, way.reach, way.gap)
        if turn <= CONTACT_RESIDUAL or d <= before:
            # at rest, yet not certified: witness points on a far side start from the samples
            if restarted:
                break
            restarted, before = True, -inf
            work.counts[RESTARTS] += 1
            place = begin_along(pair, pose, last.normal)
            way = Way(last.normal, d, place, 0.0, way.reach, way.gap)
            continue
        before = d
    return least_of(pair, pose, saddle, way.guess, last)
