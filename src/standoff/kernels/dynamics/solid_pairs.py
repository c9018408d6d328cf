"""A pair of solids in a tick: its places of contact at the end of one, and what they push.

Each spot carries a spring, as the corners of a body of flat faces do, so that a body that lies on
several goes on with the springs it has as it tips (``kernels.solids.contact_places``).
"""

from __future__ import annotations

from math import inf

from standoff.kernels.algebra.rigid import read_rotation, read_vector, relative_pose
from standoff.kernels.algebra.vectors import add, axpy, norm, rotate
from standoff.kernels.compiler.decorators import ahead, kernel
from standoff.kernels.dynamics.arrays import (
    B_SOLID,
    I_SOLIDS,
    P_DEPTH,
    P_ROUNDING,
    P_SIZE,
    P_SPAN,
    P_STIFFNESS,
    P_TOLERANCE,
    S_JUMPS,
    S_SHARED,
    bodies_of,
    body_ints,
    body_row,
    kept_rows,
    n_pairs,
    pair_numbers,
    pair_row,
    solid_pair,
)
from standoff.kernels.dynamics.forces import Spot, clear_touch, press
from standoff.kernels.dynamics.pair_motion import write_motion
from standoff.kernels.dynamics.rigid_body import put
from standoff.kernels.dynamics.shared_springs import shared_since
from standoff.kernels.pair.events import N_COUNT_SLOTS
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.contact_frame import MOST_NORMALS, Choices, contact_frame, pose_at
from standoff.kernels.solids.contact_front import C_REST, CONTACT_REALS, MOST_RETRIED_IN, Both
from standoff.kernels.solids.contact_places import (
    F_ABOVE,
    F_BEFORE,
    F_EARLIER,
    F_ENDED,
    F_LOST,
    F_MADE,
    F_PLACES,
    F_ROWS,
    F_SPOT,
    F_SPOTS,
    F_STORE,
    P_A,
    P_B,
    P_DISTANCE,
    P_FELT,
    P_NORMAL,
    S_DEPTH,
    S_NORMAL,
    S_SHARE,
    SPOT_REALS,
    place_at,
    spot_at,
)
from standoff.kernels.solids.front_frame import motion_between
from standoff.kernels.solids.front_rows import N_ROWS
from standoff.kernels.solids.spatial_progress import (
    ABOVE,
    BUDGET,
    MOST_MINIMA,
    ROUNDING,
    SIZE,
    TOLERANCE,
)
from standoff.kernels.solids.stationary import Fans
from standoff.kernels.state.arrays import (
    BAD_POSE_A,
    BAD_POSE_B,
    DISTANCE,
    FAR,
    FINE,
    LOCAL,
    LOWER_BOUND,
    N_OUT,
    N_STATE,
    NORMAL,
    NOT_CERTIFIED,
    POINT_A,
    POINT_B,
    POSE_A,
    POSE_B,
    STATUS,
    TRACKING,
    UPPER_BOUND,
    is_pose,
)
from standoff.kernels.values import Pose

STILL = Pose((1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
# Depths, for which a contact is meant, up to which places are looked for, at least; and times what
# was pressed deepest, and has moved since, where that is more.
LOOKED_FOR, DEEPER = 8.0, 2.0
# Evaluations that a frame may take.
MOST_EVALUATIONS = 200_000.0


@kernel
def is_of_solids(system, pair):
    return solid_pair(system, pair) >= 0


@kernel
def kept_row(system, pair):
    """Where in the state stands what a pair of solids has kept."""
    return system.layout[I_SOLIDS] + solid_pair(system, pair)


@kernel
def side_of(system, body, pose):
    """A body's boundary at a pose, and its directions from vertices."""
    at = ahead(system.layout, system.layout[body_ints(body) + B_SOLID])
    x = system.solids
    side = S.Side(
        ahead(x.ints, at[0]),
        ahead(x.reals, at[1]),
        ahead(x.own, at[2]),
        ahead(x.numbers, at[3]),
        pose,
        S.PRESSED,
    )
    return side, Fans(ahead(x.fan_ints, at[4]), ahead(x.fan_reals, at[5]))


@kernel
def both_of(system, pair, pose):
    first, second = bodies_of(system, pair)
    a, fans_a = side_of(system, first, STILL)
    b, fans_b = side_of(system, second, pose)
    return Both(a, b, (fans_a, fans_b))


@kernel
def ask_contacts(system, pair, pose, best):
    """What is asked of a frame of two solids."""
    o, x = pair_numbers(system, pair), system.numbers
    best[SIZE] = x[o + P_SIZE]
    best[ROUNDING] = x[o + P_ROUNDING] * (best[SIZE] + norm(pose.p))
    best[TOLERANCE] = max(x[o + P_TOLERANCE], 4.0 * best[ROUNDING])
    best[ABOVE] = LOOKED_FOR * x[o + P_DEPTH]
    best[BUDGET], best[MOST_MINIMA] = MOST_EVALUATIONS, MOST_NORMALS


@kernel
def deepest_lately(kept):
    """The depth of the deepest spot of the last frame that had some, length; 0: of none lately."""
    count, at, deepest = int(kept[F_SPOTS]), F_SPOT, 0.0
    if count == 0:
        count, at = int(kept[F_EARLIER]), F_BEFORE
    for k in range(count):
        deepest = max(deepest, kept[at + SPOT_REALS * k + S_DEPTH])
    return deepest


@kernel
def look_deeper(b, kept, best):
    """Let the length up to which places are looked for grow with what is pressed, for as long as
    there is something: what a vertex hands on to an edge or to another face is found there only if
    it is looked for as deep as it is. What rests is looked at so much earlier."""
    above, deepest, wanted = best[ABOVE], 0.0, 0.0
    if kept[F_MADE] > 0.0:
        deepest = deepest_lately(kept)
        last = S.Side(b.ints, b.reals, b.own, b.numbers, pose_at(kept), b.sense)
        wanted = DEEPER * (deepest + motion_between(last, b, best[SIZE])[0])
    if deepest > 0.0:
        above = max(above, kept[F_ABOVE])
    while above < wanted:
        above *= 2.0
    more, rows = above - kept[F_ABOVE], ahead(kept, F_ROWS)
    for k in range(int(kept[F_STORE + N_ROWS]) if more > 0.0 else 0):
        rows[CONTACT_REALS * k + C_REST] -= more
    best[ABOVE] = kept[F_ABOVE] = above


@kernel
def find_places(system, pair, state, counts, scratch):
    """The places of a pair of solids where its bodies are now; their poses are in the motion."""
    m, kept = scratch.motion, ahead(state, kept_row(system, pair))
    pose = relative_pose(ahead(m, POSE_A), ahead(m, POSE_B))
    best = scratch.contact
    ask_contacts(system, pair, pose, best)
    for k in range(N_COUNT_SLOTS):
        counts[k] = 0
    span = system.numbers[pair_numbers(system, pair) + P_SPAN]
    choices = Choices(span, 0.0, MOST_RETRIED_IN, kept_rows(system, pair), best[ABOVE])
    both = both_of(system, pair, pose)
    look_deeper(both.b, kept, best)
    contact_frame(both, kept, choices, best, counts)


@kernel
def track_solids(system, pair, state, counts, scratch):
    """The places of a pair of solids at the end of a tick, and its answer; FINE, or what is
    refused."""
    m = scratch.motion
    write_motion(system, pair, state, body_row(0), m)
    for side, why in ((POSE_A, BAD_POSE_A), (POSE_B, BAD_POSE_B)):
        if not is_pose(ahead(m, side)):
            return why
    kept = ahead(state, kept_row(system, pair))
    made, count, before = kept[F_MADE], int(kept[F_SPOTS]), pose_at(kept)
    find_places(system, pair, state, counts, scratch)
    out = ahead(state, pair_row(system, pair) + N_STATE)
    tell_pair(kept, scratch.contact, ahead(m, POSE_A), out)
    state[S_JUMPS] += kept[F_ENDED]
    if made > 0.0:
        stiffness = system.numbers[pair_numbers(system, pair) + P_STIFFNESS]
        state[S_SHARED] += shared_since(stiffness, kept, count, before)
    return FINE


@kernel
def begin_solids(system, state, counts, scratch):
    """The places of all pairs of solids that have kept none."""
    for pair in range(n_pairs(system)):
        if is_of_solids(system, pair) and state[kept_row(system, pair) + F_MADE] == 0.0:
            write_motion(system, pair, state, body_row(0), scratch.motion)
            find_places(system, pair, state, counts, scratch)


@kernel
def tell_spots(kept, pose_a, out):
    """The row of a pair's answer where spots push and no place is known: of the deepest one."""
    at = spot_at(0)
    for k in range(1, int(kept[F_SPOTS])):
        if kept[spot_at(k) + S_DEPTH] > kept[at + S_DEPTH]:
            at = spot_at(k)
    R, depth = read_rotation(pose_a, 0), kept[at + S_DEPTH]
    n, x = rotate(R, read_vector(kept, at + S_NORMAL)), rotate(R, read_vector(kept, at))
    middle = add(x, read_vector(pose_a, 9))
    out[DISTANCE], out[LOWER_BOUND], out[UPPER_BOUND] = -depth, -inf, -depth
    put(axpy(0.5 * depth, n, middle), out, POINT_A)
    put(axpy(-0.5 * depth, n, middle), out, POINT_B)
    put(n, out, NORMAL)


@kernel
def tell_pair(kept, best, pose_a, out):
    """The row of a pair's answer: of the deepest place that is felt, or the nearest."""
    for k in range(N_OUT):
        out[k] = 0.0
    at, least = -1, inf
    for k in range(int(kept[F_PLACES])):
        o = place_at(k)
        if kept[o + P_FELT] > 0.0 and kept[o + P_DISTANCE] < least:
            at, least = o, kept[o + P_DISTANCE]
    if at < 0 and kept[F_SPOTS] > 0.0:
        tell_spots(kept, pose_a, out)
    elif at < 0:
        # beyond it there is no place, so that none begins a contact
        out[DISTANCE], out[LOWER_BOUND], out[UPPER_BOUND] = best[ABOVE], -inf, inf
        out[STATUS] = FAR
    else:
        R, p = read_rotation(pose_a, 0), read_vector(pose_a, 9)
        out[DISTANCE], out[LOWER_BOUND], out[UPPER_BOUND] = least, -inf, least
        put(add(rotate(R, read_vector(kept, at + P_A)), p), out, POINT_A)
        put(add(rotate(R, read_vector(kept, at + P_B)), p), out, POINT_B)
        put(rotate(R, read_vector(kept, at + P_NORMAL)), out, NORMAL)
        out[STATUS] = LOCAL if least < 0.0 else TRACKING
    # an overlap of which nothing is felt is no contact that is known, nor are spots beside no place
    unknown = at < 0 and (kept[F_PLACES] > 0.0 or kept[F_SPOTS] > 0.0)
    if kept[F_LOST] > 0.0 or unknown:
        out[STATUS] = NOT_CERTIFIED


@kernel
def touch_solids(system, pair, state, rows, first, scratch):
    """Add what the places of a pair of solids push to its bodies' loads; the power that they
    lose."""
    clear_touch(scratch, pair)
    write_motion(system, pair, rows, first, scratch.motion)
    motion, kept = scratch.motion, ahead(state, kept_row(system, pair))
    R, origin = read_rotation(motion, POSE_A), read_vector(motion, POSE_A + 9)
    lost = 0.0
    for k in range(int(kept[F_SPOTS])):
        at = spot_at(k)
        n = rotate(R, read_vector(kept, at + S_NORMAL))
        point = add(rotate(R, read_vector(kept, at)), origin)
        spot = Spot(point, kept[at + S_DEPTH], kept[at + S_SHARE])
        lost += press(system, pair, rows, first, motion, n, spot, scratch)
    return lost
