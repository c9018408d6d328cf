"""The front of a tracked search: pairs of nodes and of leaves' parts that hold all pairs of points,
each with how far B may move before it is to be looked at.

The motion of B in A's frame is a length that only grows: in each frame by what no point of B has
moved more than, and no turn times B's radius more than. A row is left alone while its bound, less
the motion since it was made, is beyond what is to be proven; or while the motion has not come to
where it may hold a nearest pair at all.
"""

from math import inf
from typing import Any, NamedTuple

from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S

# What a row holds: leaves (-1 - node where it is a node), both boxes, where Newton's method came
# to last, at which distance, and in which frame; by which way it was closed last.
ROW_REALS = 38
ROW_A, ROW_B, ROW_BOXES, ROW_AT, ROW_DISTANCE, ROW_FRAME, ROW_WAY = 0, 1, 2, 10, 14, 15, 16
# And how B was when a row was last looked at, so that the row's own motion since can be told: the
# bound proven then, the direction it was proven along (3), by how much the slope bends per length,
# and up to which shift; the length it was shut for, and up to which goal; the centre of a ball
# round B's piece in B's frame and in A's (3 each), its radius, and B's turn (4).
ROW_LOW, ROW_SLOPE, ROW_BEND, ROW_ROOM, ROW_FREE, ROW_GOAL = 17, 18, 21, 22, 23, 24
ROW_CENTRE, ROW_WAS, ROW_RADIUS, ROW_TURN = 25, 28, 31, 32
# Farthest that a point of A's piece is from that centre, for what is shut by planes.
ROW_FAR = 36
# Up to which motion a row is known, at every moment since the solids were last known to be apart,
# not to hold the points in which they come together (``front_held``).
ROW_HELD = 37
# Of a row: not yet known whether it is on both faces; not closed by any potential.
UNSEEN, NO_WAY = -2.0, -1.0
# What became of a row: it stays as it is, its parts are in its place, or it is gone; or more is to
# be done.
KEPT, CUT, GONE_ROW, OPEN_ROW = 0, 1, 2, 3
# Of each row three numbers: bound and shut, both plus the motion when they were proven; and up to
# which motion Newton's method is not run for local minima alone. And beside them an entry of the
# list of rows that are awake, and of those of them that may be due in this frame.
KEY_REALS, RESTS_TO, AWAKE, DUE = 5, 2, 3, 4
# What is kept from frame to frame beside the rows: how many rows there are, the motion, how many
# the front had when it was made, how many frames there were, 1 until a front that is being made
# has no open rows, and how many evaluations it took to make it; how many branches there are,
# what the next new one is called, and how many have come to the place of another one in this call.
# How many rows are awake; all others rest up to a motion, for goals up to a length; 1 if the
# last frame ran out of time; and up to which motion the solids are known to stay apart. How many
# rows may be due in this frame.
N_ROWS, GONE, N_MADE, FRAME, MAKING, COST, N_BRANCHES, NEXT_BRANCH = 0, 1, 2, 3, 4, 5, 6, 7
N_MERGED, N_AWAKE, RESTS_UP_TO, RESTS_BELOW, LATE, KNOWN, N_DUE = 8, 9, 10, 11, 12, 13, 14
STORE_REALS = 15


# Of `LATE`: while rows are looked at in which the solids may come together soon.
HURRIED = 2.0


class Front(NamedTuple):
    """The rows, and room for `most` of them; the branches, and those that have come to the place of
    another one (``front_branches``)."""

    store: Any
    keys: Any
    rows: Any
    most: Any
    branches: Any
    merged: Any


class Travel(NamedTuple):
    """How B moves.

    Attributes
    ----------
    gone : the motion so far, length.
    ahead : bounds are wanted that last for this much more of it, length.
    radius : of B, length, by which turns are counted.
    turn : radians by which B turns at most, per length of the motion.
    afar : how much more than the motion a point of A moves as B sees it.
    sure : do the solids count as apart, so that what is shut need not be looked at?
    pose : of B in A's frame.
    quaternion : of B's turn.
    spare : for the rounding of a shift, length.
    above : local minima are kept up to this distance, length; a plane's face shuts none out.
    wider : how much of that is for their patches alone, length.
    step : the motion of this frame alone, length.
    last : pose of B in the frame before.
    last_turn : quaternion of it.
    """

    gone: Any
    ahead: Any
    radius: Any
    turn: Any
    afar: Any
    sure: Any
    pose: Any
    quaternion: Any
    spare: Any
    above: Any
    wider: Any
    step: Any
    last: Any
    last_turn: Any


@kernel
def add_row(front, i, j, boxes, bound, q, known):
    """Put a row, which is then to be looked at; whether there was room. bound: its key, of what it
    is a part of."""
    box_a, box_b = boxes
    n = int(front.store[N_ROWS])
    if n >= front.most:
        return False
    put_row(front, n, i, j, box_a, box_b, bound)
    o = ROW_REALS * n
    front.rows[o + ROW_DISTANCE], front.rows[o + ROW_HELD] = 0.0 if known else inf, -inf
    for k in range(4):
        front.rows[o + ROW_AT + k] = q[k]
    front.store[N_ROWS] += 1.0
    awaken(front, n)
    put_due(front, n)
    return True


@kernel
def awaken(front, k):
    front.keys[KEY_REALS * int(front.store[N_AWAKE]) + AWAKE] = k
    front.store[N_AWAKE] += 1.0


@kernel
def awake_row(front, i):
    """The i-th row that is awake; they ascend."""
    return int(front.keys[KEY_REALS * i + AWAKE])


@kernel
def put_due(front, k):
    front.keys[KEY_REALS * int(front.store[N_DUE]) + DUE] = k
    front.store[N_DUE] += 1.0


@kernel
def due_row(front, i):
    """The i-th row that may be due in this frame; all that come up in it are among them."""
    return int(front.keys[KEY_REALS * i + DUE])


@kernel
def is_at_rest(front, k, goal, motion):
    """Is a row due in no frame up to a motion, for goals up to `goal`, even where the solids may
    have a common point?"""
    bound, shut = front.keys[KEY_REALS * k], front.keys[KEY_REALS * k + 1]
    return bound >= goal + motion or (shut > motion and bound > motion)


@kernel
def list_awake(front, goal, rest, travel):
    """List the rows that may be due while the motion, and the goal, grow by no more than `rest`,
    where the list that there is does not serve any more; what is empty is taken out."""
    store = front.store
    if travel.gone <= store[RESTS_UP_TO] and goal <= store[RESTS_BELOW]:
        return
    store[RESTS_UP_TO], store[RESTS_BELOW] = travel.gone + rest, goal + rest
    store[N_AWAKE] = 0.0
    k = 0
    while k < int(store[N_ROWS]):
        if bound_key(front, k) == inf:
            drop_row(front, k)
            continue
        hold(front, k, travel.gone - travel.step, travel.spare)
        at_rest = is_at_rest(front, k, store[RESTS_BELOW], store[RESTS_UP_TO])
        if not at_rest or held_to(front, k) < store[RESTS_UP_TO]:
            awaken(front, k)
        k += 1


@kernel
def apart_to(front, k):
    """Up to which motion a row cannot hold the points in which the solids come together.

    Until they do a nearest pair has opposite normals, and its distance goes to 0: a row that is
    shut holds none, and one with a bound above 0 none that is so near.
    """
    return max(front.keys[KEY_REALS * k], front.keys[KEY_REALS * k + 1])


@kernel
def held_to(front, k):
    """Up to which motion a row is held: at no moment up to then do the solids come together in
    it."""
    return max(front.rows[ROW_REALS * k + ROW_HELD], front.store[KNOWN])


@kernel
def hold(front, k, now, spare):
    """What is proven of a row at the motion `now` lasts as far back as on: if it goes back to where
    the row is held up to, it is held on."""
    to = apart_to(front, k) - spare
    if 2.0 * now - to <= held_to(front, k):
        o = ROW_REALS * k + ROW_HELD
        front.rows[o] = max(front.rows[o], to)


@kernel
def put_row(front, k, i, j, box_a, box_b, bound):
    o, r = ROW_REALS * k, front.rows
    r[o + ROW_A], r[o + ROW_B] = i, j
    b = o + ROW_BOXES
    r[b], r[b + 1], r[b + 2], r[b + 3] = box_a.u0, box_a.u1, box_a.v0, box_a.v1
    r[b + 4], r[b + 5], r[b + 6], r[b + 7] = box_b.u0, box_b.u1, box_b.v0, box_b.v1
    r[o + ROW_FRAME], r[o + ROW_WAY] = -1.0, UNSEEN
    r[o + ROW_LOW], r[o + ROW_FREE] = -inf, -inf
    front.keys[KEY_REALS * k], front.keys[KEY_REALS * k + 1] = bound, -inf
    front.keys[KEY_REALS * k + RESTS_TO] = -inf


@kernel
def put_part(front, k, i, j, boxes):
    """Put a part of what a row holds in its place: what was proven of the whole, and along which
    slope, is true of it."""
    o, low = ROW_REALS * k + ROW_LOW, front.rows[ROW_REALS * k + ROW_LOW]
    shut = front.keys[KEY_REALS * k + 1]
    put_row(front, k, i, j, boxes[0], boxes[1], bound_key(front, k))
    front.rows[o], front.keys[KEY_REALS * k + 1] = low, shut


@kernel
def share_proven(front, k):
    """The last row is another part of what row `k` held."""
    o, n, r = ROW_REALS * k, ROW_REALS * (int(front.store[N_ROWS]) - 1), front.rows
    for i in range(ROW_LOW, ROW_REALS):
        if i != ROW_FREE:
            r[n + i] = r[o + i]
    front.keys[KEY_REALS * (int(front.store[N_ROWS]) - 1) + 1] = front.keys[KEY_REALS * k + 1]


@kernel
def put_parts(front, k, leaves, parts, q):
    """Put both parts (boxes of A, of B) of a pair of leaves' parts in its place: what was proven of
    the whole, and along which slope, is true of them. False: there is no room."""
    first, second = parts
    if not add_row(front, leaves[0], leaves[1], second, bound_key(front, k), q, True):
        return False
    put_part(front, k, leaves[0], leaves[1], first)
    share_proven(front, k)
    return True


@kernel
def empty_row(front, k):
    """What a row holds is on no face: it is taken out when rows are listed again."""
    front.keys[KEY_REALS * k] = inf


@kernel
def drop_row(front, k):
    """Take a row out: the last takes its place."""
    last = int(front.store[N_ROWS]) - 1
    for i in range(ROW_REALS):
        front.rows[ROW_REALS * k + i] = front.rows[ROW_REALS * last + i]
    for i in range(AWAKE):
        front.keys[KEY_REALS * k + i] = front.keys[KEY_REALS * last + i]
    front.store[N_ROWS] = last


@kernel
def box_of_row(front, k, which):
    o = ROW_REALS * k + ROW_BOXES + 4 * which
    r = front.rows
    return S.Box(r[o], r[o + 1], r[o + 2], r[o + 3])


@kernel
def start_of_row(front, k):
    o, r = ROW_REALS * k + ROW_AT, front.rows
    return (r[o], r[o + 1], r[o + 2], r[o + 3])


@kernel
def bound_key(front, k):
    return front.keys[KEY_REALS * k]


@kernel
def is_due(front, k, goal, travel):
    """Is a row to be looked at: may it hold points nearer than `goal`?"""
    bound, shut = front.keys[KEY_REALS * k], front.keys[KEY_REALS * k + 1]
    if bound >= goal + travel.gone:
        return False
    # what cannot hold a nearest pair may still hold a common point, if the solids may have one
    return shut <= travel.gone or (not travel.sure and bound <= travel.gone)


@kernel
def begin_motion(front, spare):
    """The motion counts from 0 again; `spare` is for the rounding of what was kept beside it."""
    gone = front.store[GONE]
    for k in range(int(front.store[N_ROWS])):
        for i in range(AWAKE):
            front.keys[KEY_REALS * k + i] -= gone + spare
        front.rows[ROW_REALS * k + ROW_HELD] -= gone + spare
    front.store[GONE], front.store[RESTS_UP_TO] = 0.0, -inf
    front.store[KNOWN] -= gone + spare


@kernel
def is_shut(front, k, travel):
    """Is a row known to hold no nearest pair now?"""
    return front.keys[KEY_REALS * k + 1] >= travel.gone


@kernel
def open_up(front, k):
    """What a row was shut by no longer counts."""
    front.keys[KEY_REALS * k + 1] = -inf


@kernel
def keep_bound(front, k, low, travel):
    front.keys[KEY_REALS * k] = max(front.keys[KEY_REALS * k], low + travel.gone)


@kernel
def keep_shut(front, k, free, travel):
    front.keys[KEY_REALS * k + 1] = max(front.keys[KEY_REALS * k + 1], free + travel.gone)


@kernel
def is_passed_over(front, k, most, travel):
    """Was a pair of leaves that may hold points as near as `most` left alone in this frame?"""
    bound, shut = front.keys[KEY_REALS * k], front.keys[KEY_REALS * k + 1]
    if bound >= most + travel.gone or shut >= travel.gone:
        return False
    o = ROW_REALS * k
    return front.rows[o + ROW_A] >= 0.0 and front.rows[o + ROW_FRAME] != front.store[FRAME]
