"""A whole frame of two solids that may overlap: their places, and what is proven at one of them; as
Python calls it, and as a block of memory has it."""

from math import inf
from typing import Any, NamedTuple

from standoff.kernels.algebra.vectors import norm
from standoff.kernels.compiler.decorators import ahead, kernel
from standoff.kernels.entries import solid_blocks as B
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.contact_frame import (
    AT_NORMALS,
    AT_SETS,
    MOST_NORMALS,
    Choices,
    contact_frame,
)
from standoff.kernels.solids.contact_front import Both
from standoff.kernels.solids.contact_places import (
    F_BRANCHES,
    F_STORE,
    MOST_ROWS,
    P_FELT,
    SPOT,
    place_at,
)
from standoff.kernels.solids.contact_sets import NO_MINIMUM
from standoff.kernels.solids.front_branches import BRANCH_REALS
from standoff.kernels.solids.front_rows import N_BRANCHES, NEXT_BRANCH
from standoff.kernels.solids.minima_sets import SET_REALS, SET_ROW
from standoff.kernels.solids.overlap_depth import PLENTY, ball_depth, depth_at, middle_of
from standoff.kernels.solids.patch import normal_of
from standoff.kernels.solids.point_depth import ask_search
from standoff.kernels.solids.spatial_pieces import ZERO
from standoff.kernels.solids.spatial_progress import (
    ABOVE,
    BOUND,
    LEAF_A,
    MINIMUM_REALS,
    MOST_MINIMA,
    N_MINIMA,
    ROUNDING,
    TOLERANCE,
)
from standoff.kernels.solids.way_past import way_past


class Met(NamedTuple):
    """What a frame comes to.

    Attributes
    ----------
    n : how many places there are.
    first : the deepest that is felt; -1 where it is not proven that the solids overlap.
    depth : no translation shorter than this parts the solids.
    way : one that does, B's, A's frame.
    """

    n: Any
    first: Any
    depth: Any
    way: Any


@kernel
def ask_places(asked, size, away, best):
    """What is asked of a frame of a contact, at how far the solids' frames are from each other; of
    both their size."""
    rounding = asked[B.Q_FRAME + 1]
    tolerance = max(asked[B.Q_FRAME], 4.0 * rounding * (size + away))
    ask_search(best, size, away, rounding, tolerance, asked[B.Q_DEADLINE])
    best[ABOVE] = max(asked[B.Q_FRAME + 2], asked[B.Q_DEEP] * size + asked[B.Q_FRAME + 3])
    best[MOST_MINIMA] = MOST_NORMALS


@kernel
def pressed(two, fans):
    """Both boundaries as their places are looked for."""
    a, b = B.seen_at(two.a, B.unmoved(), S.PRESSED), B.seen_at(two.b, two.pose, S.PRESSED)
    return Both(a, b, fans)


@kernel
def unmark(best, minima):
    """Common normals that are felt as spots have their minimum's number again."""
    for k in range(int(best[N_MINIMA])):
        o = MINIMUM_REALS * k + BOUND
        if minima[o] < NO_MINIMUM:
            minima[o] = SPOT - minima[o]


@kernel
def meet_at(two, both, kept, asked, room, counts):
    """The next frame of what is kept of a contact. It is proven at one place; of more it is left
    open."""
    size = two.a.size + two.b.size
    ask_places(asked, size, norm(two.pose.p), room)
    for k in range(8):
        counts[k] = 0
        two.probe.counts[k] = 0  # or what it may take would be that of all frames together
    choices = Choices(inf, asked[B.Q_FRAME + 3], 1, MOST_ROWS, room[ABOVE])
    n = contact_frame(both, kept, choices, room, counts)
    minima, sets = ahead(room, AT_NORMALS), ahead(room, AT_SETS)
    unmark(room, minima)
    first, depth, enough = -1, -inf, room[TOLERANCE]
    for k in range(n):
        if sets[SET_REALS * k] < 0.0 and kept[place_at(k) + P_FELT] > 0.0:
            first = k if first < 0 else first
            if depth <= enough:
                depth = depth_at(two, (room, minima, sets), k, enough)
    if first < 0 or depth <= enough:
        return Met(n, -1, depth, ZERO)
    o = SET_REALS * first
    if depth < PLENTY * -sets[o]:
        middle = middle_of(minima, int(room[N_MINIMA]), sets[o + BOUND])
        depth = max(depth, ball_depth(two, middle, -0.5 * sets[o]))
    normal = normal_of(minima, MINIMUM_REALS * int(sets[o + SET_ROW]))
    stack = two.probe.heap[1]
    way = way_past(both.a, both.b, normal, -sets[o], room[ROUNDING], stack)
    return Met(n, first, depth, way)


@kernel
def go_on_from(kept, row, front):
    """The front (best, store, branches) after a frame of contact: its rows stay as they are, the
    branches are those of the contact, and the witness points those of a set of minima."""
    best, store, branches = front
    for k in range(6):
        best[LEAF_A + k] = row[1 + k]
    store[N_BRANCHES] = kept[F_STORE + N_BRANCHES]
    store[NEXT_BRANCH] = kept[F_STORE + NEXT_BRANCH]
    for k in range(BRANCH_REALS * int(kept[F_STORE + N_BRANCHES])):
        branches[k] = kept[F_BRANCHES + k]
