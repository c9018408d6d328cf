"""How far rows are held: known to be no place where the solids come together.

Until they come together they are apart, and a nearest pair of theirs is in no row that is shut, nor
in one with a bound above its distance, which goes to 0. So they stay apart as long as each row is,
at every moment, either shut or bounded above 0. It need not be looked at in each frame: what is
proven lasts for a length of motion, back as well as on, so that a row that was not looked at for
some frames is held again by a proof that reaches back to where the last one ended.
"""

from math import asin, inf

from standoff.kernels.algebra.vectors import norm, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids.front_motion import half_sine, lost_along, moved_since
from standoff.kernels.solids.front_rows import (
    KNOWN,
    N_AWAKE,
    ROW_BEND,
    ROW_FAR,
    ROW_FREE,
    ROW_GOAL,
    ROW_HELD,
    ROW_LOW,
    ROW_RADIUS,
    ROW_REALS,
    ROW_ROOM,
    ROW_TURN,
    Travel,
    awake_row,
    held_to,
    hold,
)


@kernel
def counted_apart(t):
    """The same travel of solids that count as apart."""
    return Travel(
        t.gone, t.ahead, t.radius, t.turn, t.afar, True, t.pose, t.quaternion, t.spare, t.above,
        t.wider, t.step, t.last, t.last_turn,
    )  # fmt: skip


@kernel
def hold_on(front, k, first, last, travel):
    """A row is no place to come together in from a share `first` of this frame's way up to
    `last`: is it held up to there?"""
    o, begun = ROW_REALS * k + ROW_HELD, travel.gone - travel.step
    if begun + first * travel.step <= held_to(front, k):
        to = travel.gone if last >= 1.0 else begun + last * travel.step
        front.rows[o] = max(front.rows[o], to)


@kernel
def hold_where_above(front, k, low, high, travel):
    """By a bound that is `low` at the begin of this frame's way, `high` at its end, and in between
    at least what lies between them."""
    if low > 0.0 and high > 0.0:
        hold_on(front, k, 0.0, 1.0, travel)
    elif low > 0.0:
        hold_on(front, k, 0.0, low / (low - high), travel)
    elif high > 0.0:
        hold_on(front, k, -low / (high - low), 1.0, travel)


@kernel
def hold_on_the_way(front, k, travel):
    """Hold a row by what was proven of it last, and its own motion in this frame: B's middle goes
    straight, and it turns steadily."""
    o, r = ROW_REALS * k, front.rows
    low, free = r[o + ROW_LOW], r[o + ROW_FREE]
    if held_to(front, k) < travel.gone - travel.step or (low <= 0.0 and free <= 0.0):
        return
    first, sine = moved_since(front, k, travel.last, travel.last_turn)
    last, other = moved_since(front, k, travel.pose, travel.quaternion)
    # a point of B is off the straight way between where it was and is by no more
    arc = travel.step * travel.step / (8.0 * travel.radius)
    spare = 2.0 * arc * (1.0 + r[o + ROW_RADIUS] / travel.radius) + travel.spare
    if low > 0.0:
        radius = 2.0 * r[o + ROW_RADIUS]
        swing, turned = radius * sine + spare, radius * other + spare
        gone, further = norm(first) + swing, norm(last) + turned
        hold_where_above(front, k, low - gone, low - further, travel)
        if max(gone, further) <= r[o + ROW_ROOM]:
            bend = r[o + ROW_BEND] * (r[o + ROW_RADIUS] + max(gone, further))
            spread = (1.0 + bend) * spare
            begun = low - lost_along(front, k, first, swing) - spread
            high = low - lost_along(front, k, last, turned) - spread
            hold_where_above(front, k, begun, high, travel)
    if free > 0.0:
        between = norm(sub(last, first))
        angle = half_sine(r, o + ROW_TURN, travel.quaternion)
        hold_shut(front, k, (norm(first), sine), (norm(last), other), (between, angle), travel)


@kernel
def hold_shut(front, k, first, last, between, travel):
    """By normals and tangents, or by a plane, for which it was shut. `first`, `last` and `between`:
    the shift, and the sine of half the turn, before this frame, after it, and in it."""
    o, r = ROW_REALS * k, front.rows
    free, gone, further, step = r[o + ROW_FREE], 0.0, 0.0, 0.0
    arc = travel.step * travel.step / (8.0 * travel.radius)
    if r[o + ROW_GOAL] == inf:
        turn = 2.0 * travel.radius
        gone = max(first[0], turn * asin(first[1]))
        further = max(last[0], turn * asin(last[1]))
        step = max(between[0], turn * asin(between[1]))
    else:
        turn = 2.0 * max(r[o + ROW_RADIUS], r[o + ROW_FAR])
        gone, further = first[0] + turn * first[1], last[0] + turn * last[1]
        step = between[0] + turn * between[1]
        arc *= 1.0 + turn / travel.radius
    spare = travel.spare + 2.0 * arc
    before, after = free - gone - spare, free - further - spare
    if before > 0.0 and after > 0.0:
        hold_on(front, k, 0.0, 1.0, travel)
    elif before > 0.0 and step > 0.0:
        hold_on(front, k, 0.0, before / step, travel)
    elif after > 0.0 and step > 0.0:
        hold_on(front, k, max(1.0 - after / step, 0.0), 1.0, travel)


@kernel
def hold_rows(front, now, travel):
    """Hold all rows by what is proven of them at the motion `now`; are they held up to this
    frame?"""
    held = True
    for i in range(int(front.store[N_AWAKE])):
        k = awake_row(front, i)
        held = is_held(front, k, now, travel) and held
    return held


@kernel
def is_held(front, k, now, travel):
    """Is a row held up to this frame, by what is proven of it at the motion `now`?"""
    if held_to(front, k) < travel.gone:
        hold(front, k, now, travel.spare)
    if held_to(front, k) < travel.gone:
        hold_on_the_way(front, k, travel)
    return held_to(front, k) >= travel.gone


@kernel
def is_known_apart(front, travel):
    """Have the solids moved by less than they were apart?"""
    return front.store[KNOWN] >= travel.gone
