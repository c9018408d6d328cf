"""Which pairs of a system a tick visits: those whose bodies may be within their horizon.

A body is the ball about its box, so a pair that is not in the table is beyond the horizon by the
bound of the boxes along the line of their centres, the one that its own frame asks first
(``pair.far``): visited or not, it is FAR.
"""

from math import inf

import numpy as np

from standoff.kernels.compiler.decorators import ahead, kernel, reals_on_stack
from standoff.kernels.dynamics.arrays import body_row, n_bodies, n_pairs, pair_row
from standoff.kernels.dynamics.near_arrays import (
    G_LENGTH,
    G_MADE,
    G_REFITS,
    G_VISITED,
    G_WHICH,
    NEAR_HEADER,
    last_visit,
    near_of,
    table_of,
)
from standoff.kernels.dynamics.rigid_body import pose_and_twist, put
from standoff.kernels.state.arrays import SKIPPED, TIME, is_pose
from standoff.kernels.tolerances import FARTHEST
from standoff.kernels.world.arrays import (
    E_A,
    E_B,
    E_KEY,
    I_KEY,
    N_EMIT,
    N_FACT,
    N_INTS,
    N_PLACED,
    P_TRAVEL,
)
from standoff.kernels.world.filter import position
from standoff.kernels.world.pairs import Pairs, merge
from standoff.kernels.world.pieces import put_piece
from standoff.kernels.world.search import order_leaves, pad_sought, seek_pairs, sort_rows
from standoff.kernels.world.tree import MOST_REFITS, N_BOX, SOUGHT_PART, in_box


@kernel
def put_body(system, body, state, near, row):
    """Where a body is now; is its motion one that no frame refuses?"""
    R, p, v, w = pose_and_twist(system, body, state, body_row(body))
    flat = reals_on_stack(12)
    put(R, flat, 0)
    put(p, flat, 9)
    before = ahead(near.pieces.placed, N_PLACED * body)
    rests = put_piece(flat, ahead(near.pieces.facts, N_FACT * body), before, row)
    near.ways[body] = row[P_TRAVEL] - before[P_TRAVEL]
    for k in range(N_PLACED):
        before[k] = row[k]
    near.pieces.still[body] = 1 if rests else 0
    speeds = abs(v[0]) + abs(v[1]) + abs(v[2]) + abs(w[0]) + abs(w[1]) + abs(w[2])
    return is_pose(flat) and speeds < FARTHEST


@kernel
def put_bodies(system, state, near):
    """Where all bodies are: (are all motions sound, how many have left their padded boxes)."""
    row = reals_on_stack(N_PLACED)
    sound, n_left = True, 0
    for body in range(n_bodies(system)):
        sound = put_body(system, body, state, near, row) and sound
        left = near.planes[body] == 0 and near.pieces.still[body] == 0
        if left and in_box(row, ahead(near.boxes, N_BOX * body)):
            left = False
        near.pieces.searched[body] = 1 if left else 0
        n_left += near.pieces.searched[body]
    return sound, n_left


@kernel
def pairs_found(near, n_keys, n_found):
    """Key what is found by the numbers of the system's pairs, sorted; how many are such pairs."""
    n, rows = 0, near.found
    for f in range(n_found):
        key = rows[N_EMIT * f + E_KEY]
        at = position(near.keys, n_keys, key)
        if at < n_keys and near.keys[at] == key:
            row = ahead(rows, N_EMIT * n)
            a, b = rows[N_EMIT * f + E_A], rows[N_EMIT * f + E_B]
            row[E_KEY], row[E_A], row[E_B] = near.pairs[at], a, b
            n += 1
    sort_rows(rows, n)
    return n


@kernel
def search(system, near, scratch):
    """Find the pairs of the bodies that are sought; the tables of pairs before and now."""
    n, m = n_bodies(system), n_pairs(system)
    emit = near.found, n * (n - 1) // 2
    n_found = seek_pairs(
        near.pieces, near.planes, n, near.tree, near.rules, near.boxes, near.reach, emit
    )
    n_found = pairs_found(near, m, n_found)
    which = scratch.near[G_WHICH]
    old, room = table_of(system, scratch, which), table_of(system, scratch, 1 - which)
    horizons = (near.keys, near.ways, 0), near.reach
    length = merge(old, near.found, n_found, near.pieces, near.planes, horizons, room)
    scratch.near[G_WHICH], scratch.near[G_LENGTH] = 1 - which, length
    return old, Pairs(room.ints, room.known, length)


@kernel
def order_anew(near, scratch):
    order_leaves(near.tree, near.boxes, near.found)
    scratch.near[G_REFITS] = 0


@kernel
def make_table(system, near, scratch):
    """The first boxes, tree and table; or new ones, where bodies have been anywhere."""
    k = 0
    for body in range(n_bodies(system)):
        near.pieces.searched[body] = 1
        near.ways[body] = 0.0
        near.tree.leaf[body] = -1
        if near.planes[body] == 0:
            near.tree.order[k], near.tree.leaf[body] = body, k
            k += 1
    pad_sought(near.pieces, n_bodies(system), near.boxes, near.ways, near.tree)
    order_anew(near, scratch)
    scratch.near[G_LENGTH] = 0
    now = search(system, near, scratch)[1]
    scratch.near[G_MADE] = 1
    visit_both(Pairs(now.ints, now.known, 0), now, scratch)


@kernel
def visit_both(old, now, scratch):
    """Visit the pairs of both tables, in their order: those that have gone once more, so that they
    too become FAR."""
    a, b, n = 0, 0, 0
    while a < old.n or b < now.n:
        one = old.ints[N_INTS * a + I_KEY] if a < old.n else now.ints[N_INTS * b + I_KEY]
        other = now.ints[N_INTS * b + I_KEY] if b < now.n else one
        pair = min(one, other)
        if a < old.n and one == pair:
            a += 1
        if b < now.n and other == pair:
            b += 1
        scratch.near[NEAR_HEADER + n] = pair
        n += 1
    scratch.near[G_VISITED] = n


@kernel
def goes_far(system, near):
    """Has a body gone farther than all horizons? It may have crossed one that is beyond them at
    both ends of the tick."""
    for body in range(n_bodies(system)):
        if near.planes[body] == 0 and near.ways[body] > near.reach:
            return True
    return False


@kernel
def find_near(system, state, scratch):
    """Which pairs this tick visits, where bodies are at its end: into the scratch. True where it
    must visit all, in the first tick, where a motion is one that a frame may refuse, and where a
    body goes far."""
    near = near_of(system, scratch)
    if scratch.near[G_MADE] == 0:
        for body in range(n_bodies(system)):
            for k in range(N_PLACED):
                near.pieces.placed[N_PLACED * body + k] = np.nan
            near.pieces.placed[N_PLACED * body + P_TRAVEL] = 0.0
            for k in range(3):  # nothing is within its box before the first
                near.boxes[N_BOX * body + k], near.boxes[N_BOX * body + 3 + k] = inf, -inf
    sound, n_left = put_bodies(system, state, near)
    if not sound:
        scratch.near[G_MADE], scratch.near[G_VISITED] = 0, -1
        return True
    if scratch.near[G_MADE] == 0:
        make_table(system, near, scratch)
        return True
    now = table_of(system, scratch, scratch.near[G_WHICH])
    old = Pairs(now.ints, now.known, 0)
    if n_left > 0:
        pad_sought(near.pieces, n_bodies(system), near.boxes, near.ways, near.tree)
        scratch.near[G_REFITS] += 1
        many = n_left > SOUGHT_PART * n_bodies(system)
        if many or scratch.near[G_REFITS] > MOST_REFITS:
            order_anew(near, scratch)
        old, now = search(system, near, scratch)
    visit_both(old, now, scratch)
    return goes_far(system, near)


@kernel
def catch_up(system, pair, state, h, tick, scratch):
    """Give a pair the time of the ticks that did not visit it, added as `far_frame` adds it."""
    last = last_visit(system, scratch)
    o = pair_row(system, pair)
    for _ in range(tick - last[pair] - 1):
        state[o + TIME] += h
        state[o + SKIPPED] += h
    last[pair] = tick
