"""The places of a contact from frame to frame, and the spots at which they push, in A's frame.

A place is a local minimum of the signed distance; it has a number. It is *felt* where its signed
distance has come from above 0 without a jump. In a frame two boundaries can only begin to overlap
as deep as they have moved; a place that is born deeper than that, and than any that is felt along
much the same normal, is another way out of a region that is felt already, and pushes nothing.

Spots are the places that are felt, and the vertices and edges that are pressed beside them, as
they too came from above 0: each has a spring of its own.
"""

from math import sqrt
from typing import Any, NamedTuple

from standoff.kernels.algebra.rigid import read_rotation, read_vector
from standoff.kernels.algebra.vectors import add, dot, norm, rotate, rotate_back, scale, sub
from standoff.kernels.compiler.decorators import ahead, kernel
from standoff.kernels.solids.contact_ends import is_straight
from standoff.kernels.solids.contact_front import CONTACT_REALS, MOST_RETRIED_IN
from standoff.kernels.solids.contact_search import is_face
from standoff.kernels.solids.contact_sets import NO_MINIMUM, gather_signed
from standoff.kernels.solids.front_branches import (
    BRANCH_REALS,
    branch_reach,
    number_sets,
    renew_branches,
)
from standoff.kernels.solids.front_motion import put_three
from standoff.kernels.solids.front_rows import FRAME, N_MERGED, STORE_REALS, Front
from standoff.kernels.solids.hollow import held_at_hollow, is_hollow
from standoff.kernels.solids.minima_sets import (
    MOST_SETS,
    SET_BRANCH,
    SET_REALS,
    SET_ROW,
    points_of,
)
from standoff.kernels.solids.patch import normal_of, span_all
from standoff.kernels.solids.spatial_progress import (
    BOUND,
    LOST,
    MINIMUM_REALS,
    N_MINIMA,
    POINTS,
    SIZE,
)
from standoff.kernels.solids.spatial_tolerances import (
    ALIKE,
    FELT_SPARE,
    NEARLY_OPPOSED,
    ONE_PLACE,
)
from standoff.kernels.solids.stationary import is_stationary

# What a place holds: its number; 1 where it is felt; signed distance, normal, and both points.
P_KEY, P_FELT, P_DISTANCE, P_NORMAL, P_A, P_B = 0, 1, 2, 3, 6, 9
PLACE_REALS = 12
MOST_PLACES = MOST_SETS
# What a spot holds: where it is, its normal, its depth, its share of a spring, how many springs
# there are along its normal, and 1 where it is a place or was one.
S_POINT, S_NORMAL, S_DEPTH, S_SHARE, S_SPRINGS, S_PLACE = 0, 3, 6, 7, 8, 9
SPOT_REALS = 10
MOST_SPOTS = 96
MOST_ROWS = 32768
# Of a common normal that is felt as a spot, once the places are told: this less the number of the
# minimum that it belongs to stands in that number's place.
SPOT = -3.0
# Springs that all spots along one normal are worth: those of a square's corners.
MOST_SPRINGS = 4.0
# What is kept of a pair: 1 once a frame was made; B's pose in A's frame in it; how many places;
# whether there was no room or time for some; how many that were felt ended in this frame without
# coming to 0; how many spots; how many of an earlier frame are kept, and for how many frames there
# were none since; what B moved in each of the last frames, in turn; up to which length places were
# looked for, where that grows; then the store of the front, its branches, the places, the spots,
# those of the last frame before that had some, and the front's rows with how long they rest.
F_MADE, F_POSE, F_PLACES, F_LOST, F_ENDED, F_SPOTS = 0, 1, 13, 14, 15, 16
F_EARLIER, F_NONE_FOR, F_STEPS = 17, 18, 19
F_ABOVE = F_STEPS + MOST_RETRIED_IN
F_STORE = F_ABOVE + 1
F_BRANCHES = F_STORE + STORE_REALS
F_AT = F_BRANCHES + BRANCH_REALS * MOST_PLACES
F_SPOT = F_AT + PLACE_REALS * MOST_PLACES
F_BEFORE = F_SPOT + SPOT_REALS * MOST_SPOTS
F_ROWS = F_BEFORE + SPOT_REALS * MOST_SPOTS
KEPT_REALS = F_ROWS + CONTACT_REALS * MOST_ROWS


class Asked(NamedTuple):
    """Of a frame, lengths: what B has moved in it and the last ones, at most, in which a place that
    is found now was not looked for; how deep a place may be that is felt though nobody knows where
    it has come from; within which distance spots share a spring; and how much of the length up to
    which places are looked for is for their patches alone. And B's pose."""

    step: Any
    deepest: Any
    span: Any
    wider: Any
    pose: Any


@kernel
def kept_front(kept, most, merged):
    """The front in a block of what is kept of a pair, with room for so many rows."""
    rows = ahead(kept, F_ROWS)
    return Front(ahead(kept, F_STORE), rows, rows, most, ahead(kept, F_BRANCHES), merged)


@kernel
def moved_lately(kept, step, retried):
    """What B has moved in the last `retried` frames, with a step of this one, length."""
    front, total = ahead(kept, F_STORE), 0.0
    kept[F_STEPS + int(front[FRAME]) % retried] = step
    for k in range(retried):
        total += kept[F_STEPS + k]
    return total


@kernel
def place_at(k):
    return F_AT + PLACE_REALS * k


@kernel
def middle_of_pair(rows, o):
    return scale(0.5, add(read_vector(rows, o), read_vector(rows, o + 3)))


@kernel
def goes_on(kept, at, n, d, step):
    """May a pair of points with a normal n, whose signed distance is d, go on from a place of the
    frame before: no deeper than it, along much the same normal? Where flat parts touch a place goes
    as far as they reach while they hardly turn, and another one begins."""
    alike = dot(read_vector(kept, at + P_NORMAL), n) >= ALIKE
    return alike and d >= kept[at + P_DISTANCE] - step


@kernel
def was_felt(kept, minima, o, d, reach, step):
    """Does a pair of points go on from a spot of the last frame that had some, which was as near as
    `reach`, or from a place that was felt?"""
    middle, n = middle_of_pair(minima, o + POINTS), normal_of(minima, o)
    for k in range(int(kept[F_EARLIER])):
        at = F_BEFORE + SPOT_REALS * k
        near = norm(sub(read_vector(kept, at), middle)) <= reach
        alike = dot(read_vector(kept, at + S_NORMAL), n) >= ALIKE
        if near and alike and abs(kept[at + S_DEPTH] + d) <= step:
            return True
    for p in range(int(kept[F_PLACES])):
        if kept[place_at(p) + P_FELT] > 0.0 and goes_on(kept, place_at(p), n, d, step):
            return True
    return False


@kernel
def jump_of(asked, size):
    """By how much the signed distance of a place may change in a frame, length."""
    return 2.0 * asked.step + FELT_SPARE * size


@kernel
def came_in(kept, minima, o, d, asked):
    """Was a pair of points in overlap hardly deeper than `asked.deepest`, or apart, along their
    normal in the frame before? In a long step B leaves the far side of what it comes to by as
    much, which no motion has pressed."""
    if d >= -asked.deepest:
        return True
    y = read_vector(minima, o + POINTS + 3)
    own = rotate_back(asked.pose.R, sub(y, asked.pose.p))
    before = add(rotate(read_rotation(kept, F_POSE), own), read_vector(kept, F_POSE + 9))
    return d - dot(normal_of(minima, o), sub(y, before)) >= -asked.deepest


@kernel
def is_felt(kept, minima, o, d, asked, size):
    """Is a minimum of the signed distance felt, by the places of the frame before?"""
    if kept[F_MADE] == 0.0:
        return d >= -asked.deepest
    step = jump_of(asked, size)
    if d >= -step and came_in(kept, minima, o, d, asked):
        return True
    return was_felt(kept, minima, o, d, branch_reach(size, asked.step), step)


@kernel
def goes_missing(kept, asked, best, minima):
    """Was a place felt that is deeper than anything can have moved, and is no common normal as deep
    among those that were found, along much the same direction?"""
    step = jump_of(asked, best[SIZE])
    for p in range(int(kept[F_PLACES])):
        o = place_at(p)
        if kept[o + P_FELT] == 0.0 or kept[o + P_DISTANCE] >= -step:
            continue
        missing, n = True, read_vector(kept, o + P_NORMAL)
        for i in range(int(best[N_MINIMA])):
            row = MINIMUM_REALS * i
            if minima[row + BOUND] != NO_MINIMUM and minima[row] <= kept[o + P_DISTANCE] + step:
                missing = missing and dot(n, normal_of(minima, row)) < ALIKE
        if missing:
            return True
    return False


@kernel
def put_place(minima, sets, k, felt, kept):
    s, o = SET_REALS * k, place_at(k)
    row = MINIMUM_REALS * int(sets[s + SET_ROW])
    kept[o + P_KEY], kept[o + P_FELT], kept[o + P_DISTANCE] = sets[s + SET_BRANCH], felt, sets[s]
    put_three(kept, o + P_NORMAL, normal_of(minima, row))
    x, y = points_of(minima, row)
    put_three(kept, o + P_A, x)
    put_three(kept, o + P_B, y)


@kernel
def spot_at(k):
    return F_SPOT + SPOT_REALS * k


@kernel
def keep_spot(best, minima, o, place, kept):
    """Keep a common normal as a spot, once; `place` is 1 for a place."""
    x, n, count = middle_of_pair(minima, o + POINTS), normal_of(minima, o), int(kept[F_SPOTS])
    for k in range(count):
        at = spot_at(k)
        same = dot(read_vector(kept, at + S_NORMAL), n) >= ALIKE
        if same and norm(sub(read_vector(kept, at), x)) <= ONE_PLACE * best[SIZE]:
            kept[at + S_DEPTH] = max(kept[at + S_DEPTH], -minima[o])
            return
    if count == MOST_SPOTS:
        best[LOST] += 1.0
        return
    at = spot_at(count)
    put_three(kept, at, x)
    put_three(kept, at + S_NORMAL, n)
    kept[at + S_DEPTH], kept[at + S_PLACE] = -minima[o], place
    kept[F_SPOTS] += 1.0


@kernel
def is_of_a_line(both, leaves):
    """Is a common normal of two faces, or of a face and a straight edge? Where they are level it is
    anywhere on a line of them, whose ends tell more."""
    faces = is_face(both.a, leaves[0]), is_face(both.b, leaves[1])
    if faces[0] and faces[1]:
        return True
    if faces[0]:
        return is_straight(both.b, leaves[1])
    return faces[1] and is_straight(both.a, leaves[0])


@kernel
def is_opposed(both, leaves, minima, o):
    """Are a common normal's features turned to each other, nearly? A vertex that is under the plane
    of a face may have come there past its side, pressed by another one."""
    q = (minima[o + 3], minima[o + 4], minima[o + 5], minima[o + 6])
    a, b, fans, n = both.a, both.b, both.fans, normal_of(minima, o)
    sharp = not (is_hollow(a, leaves[0]) or is_hollow(b, leaves[1]))
    if sharp and is_stationary(a, b, fans[0], fans[1], q, leaves, n, NEARLY_OPPOSED):
        return True
    return held_at_hollow(a, b, fans, q, leaves, n, NEARLY_OPPOSED) > 0


@kernel
def mark_felt(both, kept, minima, asked, best):
    """Mark each common normal in overlap that is felt as a spot: at vertices, and at edges that
    cross or are curved, which are turned to what presses them."""
    for i in range(int(best[N_MINIMA])):
        o = MINIMUM_REALS * i
        leaves, d = (int(minima[o + 1]), int(minima[o + 2])), minima[o]
        spot = d < 0.0 and not is_of_a_line(both, leaves) and is_opposed(both, leaves, minima, o)
        if spot and is_felt(kept, minima, o, d, asked, best[SIZE]):
            minima[o + BOUND] = SPOT - minima[o + BOUND]


@kernel
def put_spots(best, minima, sets, kept):
    """The spots: all places that are felt, and what is marked."""
    kept[F_SPOTS] = 0.0
    for k in range(int(kept[F_PLACES])):
        if kept[place_at(k) + P_FELT] > 0.0 and kept[place_at(k) + P_DISTANCE] < 0.0:
            row = MINIMUM_REALS * int(sets[SET_REALS * k + SET_ROW])
            keep_spot(best, minima, row, 1.0, kept)
    for i in range(int(best[N_MINIMA])):
        if minima[MINIMUM_REALS * i + BOUND] < NO_MINIMUM:
            keep_spot(best, minima, MINIMUM_REALS * i, 0.0, kept)


@kernel
def in_its_stead(kept, at, step):
    """Is a place felt that is as deep as a spot of the frame before, along much the same normal?"""
    n, depth = read_vector(kept, at + S_NORMAL), kept[at + S_DEPTH]
    for k in range(int(kept[F_PLACES])):
        o = place_at(k)
        alike = dot(n, read_vector(kept, o + P_NORMAL)) >= ALIKE
        if alike and kept[o + P_FELT] > 0.0 and kept[o + P_DISTANCE] <= step - depth:
            return True
    return False


@kernel
def hand_on(kept, at, reach, step):
    """Let a spot that is where one of the frame before was, and pushes as that did, stand for its
    place: places that merge push on, each at its own side. Is there one?"""
    x, n = read_vector(kept, at), read_vector(kept, at + S_NORMAL)
    for k in range(int(kept[F_SPOTS])):
        o = spot_at(k)
        alike = dot(n, read_vector(kept, o + S_NORMAL)) >= ALIKE
        near = norm(sub(read_vector(kept, o), x)) <= reach
        if alike and near and kept[o + S_DEPTH] >= kept[at + S_DEPTH] - step:
            kept[o + S_PLACE] = 1.0
            return True
    return False


@kernel
def ended_deep(kept, count, asked, size):
    """How many places that were felt have ended without coming to 0, and without one that is felt,
    as deep as they were, in their stead, or a spot where they were; `count` spots were before."""
    step, reach, ended = jump_of(asked, size), branch_reach(size, asked.step), 0
    for k in range(count):
        at = F_BEFORE + SPOT_REALS * k
        deep = kept[at + S_PLACE] > 0.0 and kept[at + S_DEPTH] > step
        if deep and not in_its_stead(kept, at, step) and not hand_on(kept, at, reach, step):
            ended += 1
    return ended


@kernel
def force_of(kept, at):
    """Of a whole spring, in parts of its stiffness."""
    return kept[at + S_DEPTH] * sqrt(kept[at + S_DEPTH])


@kernel
def nearness(kept, at, other, span):
    """1 where two spots are one, 0 where they are `span` apart, or their normals across."""
    off = norm(sub(read_vector(kept, at), read_vector(kept, other))) / span
    left = max(1.0 - off * off, 0.0)
    return likeness(kept, at, other) * left * left


@kernel
def likeness(kept, at, other):
    n, m = read_vector(kept, at + S_NORMAL), read_vector(kept, other + S_NORMAL)
    return max(dot(n, m), 0.0)


@kernel
def share_springs(kept, span):
    """Each spot has a whole spring, but for what others have that are nearer than `span`, and all
    along one normal have `MOST_SPRINGS` at most: so the force does not depend on how many spots
    were found, nor does it jump where two come together, or where one begins or ends."""
    count = int(kept[F_SPOTS])
    for i in range(count):
        at, total = spot_at(i), 0.0
        for j in range(count):
            total += nearness(kept, at, spot_at(j), span) * force_of(kept, spot_at(j))
        kept[at + S_SHARE] = force_of(kept, at) / total
    for i in range(count):
        at, springs = spot_at(i), 0.0
        for j in range(count):
            other = spot_at(j)
            part = min(1.0, force_of(kept, other) / force_of(kept, at))
            springs += likeness(kept, at, other) * kept[other + S_SHARE] * part
        kept[at + S_SPRINGS] = springs
    for i in range(count):
        at = spot_at(i)
        kept[at + S_SHARE] *= min(1.0, MOST_SPRINGS / kept[at + S_SPRINGS])


@kernel
def recall_spots(kept, count):
    """Keep the spots of the frame before as earlier ones. Where it had none, those before it stay
    for as many frames as may pass before Newton's method is tried again: what was missed in one
    must not be new in the next."""
    if count > 0:
        for k in range(SPOT_REALS * count):
            kept[F_BEFORE + k] = kept[F_SPOT + k]
        kept[F_EARLIER], kept[F_NONE_FOR] = count, 0.0
        return
    kept[F_NONE_FOR] += 1.0
    if kept[F_NONE_FOR] >= MOST_RETRIED_IN:
        kept[F_EARLIER] = 0.0


@kernel
def tell_places(both, front, asked, best, minima, sets, kept):
    """The places of a frame and their spots into what is kept, of the common normals that were
    found; how many places."""
    n = gather_signed(both.a, both.b, best, minima, asked.wider, sets)
    if n < 0:
        best[LOST] += 1.0
        n = 0
    if asked.wider > 0.0:
        span_all(best, minima, asked.wider, sets, n)
    front.store[N_MERGED] = 0.0
    number_sets(front, minima, sets, n, branch_reach(best[SIZE], asked.step), 0)
    renew_branches(front, minima, sets, n)
    count = int(kept[F_SPOTS])
    recall_spots(kept, count)
    felt = ahead(sets, SET_REALS * n)  # behind them there is room
    for k in range(n):
        row = MINIMUM_REALS * int(sets[SET_REALS * k + SET_ROW])
        known = is_felt(kept, minima, row, sets[SET_REALS * k], asked, best[SIZE])
        felt[k] = 1.0 if known else 0.0
    mark_felt(both, kept, minima, asked, best)
    for k in range(n):
        put_place(minima, sets, k, felt[k], kept)
    kept[F_PLACES], kept[F_MADE] = n, 1.0
    put_spots(best, minima, sets, kept)
    kept[F_ENDED] = ended_deep(kept, count, asked, best[SIZE])
    share_springs(kept, asked.span)
    kept[F_LOST] = best[LOST]
    return n
