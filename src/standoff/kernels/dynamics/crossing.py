"""Whether a tick may have carried a body through another one, or deep into it and out again, while
no contact at its end tells of it.

Between its ends a tick is taken for what it stands for: each body's centre goes straight, and it
turns about one axis by less than half a turn. Two convex bodies that a plane parts, or parts but
for a contact's depth, stay on their sides of it while neither has gone far enough across it; so the
plane of either end is a proof for the whole tick. Solids that are apart have no such plane: what
either has moved counts, in any direction.
"""

from math import sqrt
from typing import Any, NamedTuple

from standoff.kernels.algebra.rigid import read_vector, relative_pose
from standoff.kernels.algebra.turns import turn_norm
from standoff.kernels.algebra.vectors import axpy, dot, norm, sub
from standoff.kernels.body.layout import UNBOUNDED
from standoff.kernels.compiler.decorators import ahead, kernel, shared
from standoff.kernels.dynamics.arrays import (
    B_REACH,
    N_BODY,
    P_UNSEEN,
    S_TIME,
    X_CENTRE,
    X_ROTATION,
    bodies_of,
    body_numbers,
    body_row,
    crossings_row,
    n_bodies,
    pair_numbers,
    pair_row,
)
from standoff.kernels.dynamics.pair_motion import packed_pair, write_motion
from standoff.kernels.pair.far import boxes_apart
from standoff.kernels.state.arrays import (
    DISTANCE,
    FAR,
    LOWER_BOUND,
    N_OPTIONS,
    N_STATE,
    NORMAL,
    NOT_CERTIFIED,
    O_WITHIN,
    POSE_A,
    POSE_B,
    STATUS,
)

# Of a body in a tick: how far any point of it has gone, and how much of that by its turn, length.
N_WAY = 2


class End(NamedTuple):
    """What a pair's answer tells at one end of a tick: by how much the bodies are apart, 0 in
    contact; whether its normal is that of a plane which parts them; and the normal, world."""

    gap: Any
    parted: Any
    normal: Any


UNSEEN_END = End(0.0, False, (0.0, 0.0, 0.0))


@kernel
def centre_gone(state, rows, body):
    """What a body's centre has moved in a tick."""
    o = body_row(body) + X_CENTRE
    return sub(read_vector(state, o), read_vector(rows, o))


@kernel
def exchange(rows, state, ways, system):
    """Put the bodies' rows of a tick's end into the state, those of its start in their place; and
    how far each has gone."""
    for body in range(n_bodies(system)):
        o, squares = body_row(body), 0.0
        for k in range(N_BODY):
            rows[o + k], state[o + k] = state[o + k], rows[o + k]
        for k in range(9):
            change = state[o + X_ROTATION + k] - rows[o + X_ROTATION + k]
            squares += change * change
        gone = centre_gone(state, rows, body)
        turn = turn_norm(squares) * system.numbers[body_numbers(body) + B_REACH]
        ways[N_WAY * body], ways[N_WAY * body + 1] = sqrt(dot(gone, gone)) + turn, turn


@kernel
def end_of(system, pair, state, of_solids):
    """What a pair's answer tells now."""
    o = pair_row(system, pair) + N_STATE
    far, apart = state[o + STATUS] == FAR, state[o + DISTANCE] > 0.0
    gap = 0.0
    if apart:
        gap = max(state[o + DISTANCE if of_solids else o + LOWER_BOUND], 0.0)
    parted = not far and not (of_solids and apart)
    return End(gap, parted, read_vector(state, o + NORMAL))


@kernel
def unseen(end, across, turns, way):
    """How deep the bodies may have been in a tick, by what one of its ends tells, length: B has
    moved so far `across` its plane towards A."""
    return (max(across, 0.0) + turns if end.parted else way) - end.gap


@kernel
def nearest_centres(rows, a, b, shift):
    """The least distance of two bodies' centres in a tick in which B moves by `shift` seen from
    A."""
    first = sub(
        read_vector(rows, body_row(b) + X_CENTRE), read_vector(rows, body_row(a) + X_CENTRE)
    )
    square = dot(shift, shift)
    t = min(max(-dot(first, shift) / square, 0.0), 1.0) if square > 0.0 else 0.0
    return norm(axpy(t, shift, first))


@kernel
def boxes_at(system, pair, rows, scratch):
    """How far the boxes of two bodies prove them apart where they were."""
    m = scratch.motion
    write_motion(system, pair, rows, body_row(0), m)
    return boxes_apart(packed_pair(system, pair), relative_pose(ahead(m, POSE_A), ahead(m, POSE_B)))


@kernel
def has_plane(system, pair):
    """Is one of two convex bodies a half-space?"""
    packed = packed_pair(system, pair)
    return packed.ints_a[UNBOUNDED] != 0 or packed.ints_b[UNBOUNDED] != 0


@kernel
def may_cross(system, pair, state, begun, of_solids, scratch):
    """May a tick have hidden a depth of two bodies beyond what is allowed? `begun` is the `End` at
    its start."""
    a, b = bodies_of(system, pair)
    ways, rows, o = scratch.ways, scratch.stage, pair_numbers(system, pair)
    way, most = ways[N_WAY * a] + ways[N_WAY * b], system.numbers[o + P_UNSEEN]
    ended = end_of(system, pair, state, of_solids)
    gap = begun.gap
    if way <= gap + ended.gap + 2.0 * most:
        return False
    if gap + ended.gap == 0.0 and dot(begun.normal, ended.normal) > 0.0:
        return False  # they touch all the time, from one side
    if not (of_solids or begun.parted):
        gap = max(gap, boxes_at(system, pair, rows, scratch))
    if way <= gap + ended.gap + 2.0 * most or (not of_solids and has_plane(system, pair)):
        return False  # or there is no other side
    begun = End(gap, begun.parted, begun.normal)
    shift = sub(centre_gone(state, rows, b), centre_gone(state, rows, a))
    turns = ways[N_WAY * a + 1] + ways[N_WAY * b + 1]
    if unseen(begun, -dot(begun.normal, shift), turns, way) <= most:
        return False
    if unseen(ended, dot(ended.normal, shift), turns, way) <= most:
        return False
    reach = system.numbers[body_numbers(a) + B_REACH] + system.numbers[body_numbers(b) + B_REACH]
    return not nearest_centres(rows, a, b, shift) > reach


@kernel
def begin_crossing(system, pair, state, of_solids):
    """The `End` at the start of a tick, from the answer before it: of a pair that was not visited
    its bound is an old one, but it is beyond its horizon."""
    begun = end_of(system, pair, state, of_solids)
    if begun.parted or of_solids:
        return begun
    within = ahead(system.options, N_OPTIONS * pair)[O_WITHIN]
    return End(min(begun.gap, within), False, begun.normal)


@kernel
def goes_far_enough(system, pair, scratch):
    """Could a pair have crossed by what its bodies have gone in a tick, however they stand?"""
    a, b = bodies_of(system, pair)
    most = system.numbers[pair_numbers(system, pair) + P_UNSEEN]
    return scratch.ways[N_WAY * a] + scratch.ways[N_WAY * b] > 2.0 * most


@shared
def book_crossing(system, pair, state, begun, of_solids, scratch):
    """Count a tick in which a pair's bodies may have crossed, and keep when the first one ended. An
    answer that is not sound is counted as that."""
    if state[pair_row(system, pair) + N_STATE + STATUS] == NOT_CERTIFIED:
        return
    if may_cross(system, pair, state, begun, of_solids, scratch):
        o = crossings_row(system, pair)
        if state[o] == 0.0:
            state[o + 1] = state[S_TIME]
        state[o] += 1.0
