"""A whole frame of two solids on a block of memory, without Python: apart, in overlap, or from
nothing.

It goes the way of ``standoff.solids.tracked.run``: a contact goes on by its places, solids that
were apart by their front; where that does not answer the frame, the places do, of which only
those are felt that have come from above 0; and else a start from nothing.
"""

from standoff.kernels.algebra.vectors import norm
from standoff.kernels.compiler.decorators import ahead, kernel, shared
from standoff.kernels.entries import solid_blocks as B
from standoff.kernels.entries import tracked_solids as T
from standoff.kernels.entries.solid_answers import tell_apart, tell_overlap, tell_unproven
from standoff.kernels.entries.solid_meeting import ask_places, go_on_from, meet_at, pressed
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.contact_frame import (
    AT_SETS,
)
from standoff.kernels.solids.contact_places import (
    F_BRANCHES,
    F_MADE,
    F_POSE,
    F_ROWS,
    F_STORE,
    MOST_PLACES,
)
from standoff.kernels.solids.front_branches import BRANCH_REALS
from standoff.kernels.solids.front_rows import (
    N_BRANCHES,
    N_MERGED,
    NEXT_BRANCH,
    STORE_REALS,
    Front,
)
from standoff.kernels.solids.minima_sets import SET_REALS
from standoff.kernels.solids.overlap_depth import Two
from standoff.kernels.solids.point_depth import MOST_TIES, which_is_inside
from standoff.kernels.solids.spatial_progress import (
    ABOVE,
    BUDGET,
    LEAF_A,
    LEAST,
    MET,
    MOST_MINIMA,
    OPEN,
    TOLERANCE,
)
from standoff.kernels.solids.spatial_search import search
from standoff.kernels.state.arrays import BAD_POSE_A, BAD_POSE_B, FINE, is_pose


@kernel
def put_pose(pose, s, o):
    for k in range(9):
        s[o + k] = pose.R[k]
    for k in range(3):
        s[o + 9 + k] = pose.p[k]


@kernel
def inside_told(s):
    """Which solid is inside the other, by from where the boundaries are seen: 1, 2, 0: neither."""
    if s[B.SEEN + 1] == S.INSIDE:
        return 1
    return 2 if s[B.SEEN] == S.INSIDE else 0


@kernel
def put_inside(s, inside):
    s[B.SEEN] = S.INSIDE if inside == 2 else S.OUTSIDE
    s[B.SEEN + 1] = S.INSIDE if inside == 1 else S.OUTSIDE


@kernel
def boundaries(g, pose):
    """A and B, at a pose in A's frame, each seen from where the other one is."""
    s = g.block
    a = B.seen_at(g.a, B.unmoved(), int(s[B.SEEN]))
    return a, B.seen_at(g.b, pose, int(s[B.SEEN + 1]))


@kernel
def go_apart(g, deadline):
    """A frame from the front, with so many evaluations; is it answered?"""
    s = g.block
    a, now = boundaries(g, g.pose)
    last = boundaries(g, B.pose_kept(s, B.LAST))[1]
    lists = ahead(s, B.BRANCHES), ahead(s, B.W_MERGED)
    front = Front(
        ahead(s, B.STORE), ahead(s, B.KEYS), ahead(s, B.ROWS), B.MOST_FRONT, lists[0], lists[1]
    )
    front.store[N_MERGED] = 0.0
    best, minima, told = ahead(s, B.BEST), ahead(s, B.W_MINIMA), ahead(s, B.W_TOLD)
    best[BUDGET] = deadline
    asked = ahead(g.asked, B.Q_FRAME)
    travel = T.apart_frame(
        (a, last, now), s[B.LAST_LOW], asked, front, (best, minima), g.counts, told
    )
    put_pose(g.pose, s, B.LAST)
    s[B.LAST_LEAST], s[B.LAST_LOW] = told[T.DISTANCE], told[T.BOUND]
    if told[T.ENDED] == T.TO_ASK:
        return False
    inside = inside_told(s)
    if told[T.SURE] == 0.0 and which_is_inside(g.a, g.b, g.pose, g.probe) != inside:
        s[B.LAST_LOW] = 0.0  # what is proven of the boundaries does not hold the solids apart
        return False
    n = 0
    if best[ABOVE] > 0.0:
        fans, sets = g.fans, ahead(s, B.W_SETS)
        n = T.told_minima(a, now, fans, front, travel, best, minima, (sets, 0))
    tell_apart(g, (a, now), n, inside)
    s[B.MODE], s[B.OVERLAPPED] = B.APART, 0.0
    return True


@kernel
def begin_contact(s, kept):
    """A contact before its first frame. Of solids that did not overlap in the frame before no place
    is felt that is deeper than B has moved since; its branches are those of the front, as many as
    there is room for. Of solids of which nothing is known, or that overlapped, all places are."""
    for k in range(F_ROWS):
        kept[k] = 0.0
    kept[F_STORE + NEXT_BRANCH] = s[B.STORE + NEXT_BRANCH]
    if s[B.OVERLAPPED] > 0.0:
        return
    kept[F_MADE] = 1.0
    for k in range(12):
        kept[F_POSE + k] = s[B.BEFORE + k]
    n = min(int(s[B.STORE + N_BRANCHES]), MOST_PLACES)
    kept[F_STORE + N_BRANCHES] = n
    for k in range(BRANCH_REALS * n):
        kept[F_BRANCHES + k] = s[B.BRANCHES + k]


@kernel
def meet(g):
    """A frame of a contact; is it proven that the solids overlap?"""
    s = g.block
    kept, room = ahead(s, B.CONTACT), ahead(s, B.W_ROOM)
    if s[B.MODE] != B.IN_CONTACT:
        begin_contact(s, kept)
    two = Two(g.a, g.b, g.pose, g.probe)
    both = pressed(two, g.fans)
    met = meet_at(two, both, kept, g.asked, room, g.counts)
    if met.first < 0:
        return False
    tell_overlap(g, both, met)
    front = ahead(s, B.BEST), ahead(s, B.STORE), ahead(s, B.BRANCHES)
    go_on_from(kept, ahead(room, AT_SETS + SET_REALS * met.first), front)
    s[B.MODE], s[B.OVERLAPPED] = B.IN_CONTACT, 1.0
    return True


@kernel
def ask_nearest(g, best):
    """What is asked of a search from nothing, but for its evaluations and minima."""
    ask_places(g.asked, g.a.size + g.b.size, norm(g.pose.p), best)


@kernel
def new_front(g, found):
    """A front that is yet to be made, of solids whose nearest points a search has found."""
    s, best = g.block, ahead(g.block, B.BEST)
    least, low = found[LEAST], min(found[LEAST] - found[TOLERANCE], found[OPEN])
    for k in range(6):
        s[B.ANSWER + k] = found[LEAF_A + k]
    ask_nearest(g, best)
    best[ABOVE] = g.asked[B.Q_FRAME + 2]
    best[MOST_MINIMA] = B.MOST_LOCAL if best[ABOVE] > 0.0 else MOST_TIES
    for k in range(6):
        best[LEAF_A + k] = s[B.ANSWER + k]
    born = s[B.STORE + NEXT_BRANCH]
    for k in range(STORE_REALS):
        s[B.STORE + k] = 0.0
    s[B.STORE + NEXT_BRANCH] = born
    put_pose(g.pose, s, B.LAST)
    s[B.LAST_LEAST], s[B.LAST_LOW] = least, low
    return low


@kernel
def from_nothing(g, deadline):
    """A frame whatever was before, with so many evaluations for a search."""
    s = g.block
    inside = which_is_inside(g.a, g.b, g.pose, g.probe)
    put_inside(s, inside)
    a, b = boundaries(g, g.pose)
    best, ties = g.probe.lists
    ask_nearest(g, best)
    best[ABOVE], best[BUDGET], best[MOST_MINIMA] = 0.0, deadline, MOST_TIES
    for k in range(8):
        g.counts[k] = 0
    search(a, b, best, ties, g.probe.heap, g.probe.space, g.counts)
    met, low = best[MET] > 0.0, new_front(g, best)
    if not met and low > 0.0:
        if inside >= 0 and go_apart(g, deadline):
            return
        tell_unproven(g, best, a, b)
        s[B.MODE], s[B.OVERLAPPED] = B.UNKNOWN, 0.0
        return
    put_inside(s, 0)
    s[B.MODE], s[B.OVERLAPPED] = B.STARTING, 1.0
    if meet(g):
        return
    # the proof has written over what the search has found
    ask_nearest(g, best)
    best[ABOVE], best[BUDGET], best[MOST_MINIMA] = 0.0, deadline, MOST_TIES
    search(a, b, best, ties, g.probe.heap, g.probe.space, g.counts)
    tell_unproven(g, best, a, b)
    s[B.MODE], s[B.OVERLAPPED] = B.UNKNOWN, 0.0


@kernel
def told_from_nothing(g, deadline):
    from_nothing(g, deadline)
    g.block[B.ANSWER + B.A_RESTARTS] = 1.0


@kernel
def whole_frame(g):
    """The next frame."""
    s = g.block
    if s[B.MODE] != B.APART:
        in_contact = s[B.MODE] == B.IN_CONTACT
        if meet(g):
            return
        if not in_contact:
            told_from_nothing(g, g.asked[B.Q_DEADLINE])
            return
        s[B.MODE] = B.APART
    if go_apart(g, g.asked[B.Q_DEADLINE]) or meet(g):
        return
    told_from_nothing(g, g.asked[B.Q_DEADLINE])


@kernel
def refused_at(block):
    if not is_pose(ahead(block, B.POSES)):
        return BAD_POSE_A
    return FINE if is_pose(ahead(block, B.POSES + 12)) else BAD_POSE_B


@kernel
def begin_anywhere(g):
    s = g.block
    for k in range(STORE_REALS):
        s[B.STORE + k] = 0.0
    s[B.MODE], s[B.OVERLAPPED] = B.STARTING, 1.0
    told_from_nothing(g, g.asked[B.Q_IN_TIME])


@shared
def frame_of_solids(table, address):
    """The next frame at the poses in a block, or one that begins anywhere: FINE or, with nothing
    changed, which of the poses is refused."""
    g = B.given_at(table, address)
    why = refused_at(g.block)
    if why == FINE:
        if g.block[B.FRESH] > 0.0:
            begin_anywhere(g)
        else:
            whole_frame(g)
        put_pose(g.pose, g.block, B.BEFORE)
    return why
