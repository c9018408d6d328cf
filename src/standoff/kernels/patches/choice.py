"""Which four of the corners of a region make the patch: those that reach farthest, and in motion
those of the frame before."""

from math import inf

from standoff.kernels.algebra.corners import CORNER_REALS, ROW, X, Y, outside, put_around
from standoff.kernels.algebra.rigid import read_vector
from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import norm, sub
from standoff.kernels.compiler.decorators import kernel, reals_on_stack
from standoff.kernels.patches.places import (
    MOST_PLACES,
    PLACE_REALS,
    POINT_A,
    POINT_B,
)
from standoff.kernels.patches.places import X as PLACE_X
from standoff.kernels.patches.places import Y as PLACE_Y
from standoff.kernels.patches.tolerances import EVEN, SAME_CORNER, WORTH_A_CORNER

MOST_CORNERS = 4
ALL_CORNERS = CORNER_REALS * (MOST_CORNERS + 1)
# Of a patch that is kept: how many pairs, and of each its point of A in A's frame and its point of
# B in B's.
PATCH_REALS = 1 + 6 * MOST_CORNERS


@kernel
def put_corner(corners, n, places, k):
    o, p = CORNER_REALS * n, PLACE_REALS * k
    corners[o + X], corners[o + Y], corners[o + ROW] = places[p + PLACE_X], places[p + PLACE_Y], k
    if n >= 2:
        put_around(corners, n + 1)
    return n + 1


@kernel
def drop_corner(corners, n, i):
    for k in range(CORNER_REALS * i, CORNER_REALS * (n - 1)):
        corners[k] = corners[k + CORNER_REALS]
    return n - 1


@kernel
def middle_of(places, n):
    """The mean of all places, across the normal."""
    mx, my = 0.0, 0.0
    for k in range(n):
        mx += places[PLACE_REALS * k + PLACE_X] / n
        my += places[PLACE_REALS * k + PLACE_Y] / n
    return mx, my


@kernel
def reach_of(corners, n, places, k, centre):
    """How far a place is outside of the corners; with none, from the centre."""
    x, y = places[PLACE_REALS * k + PLACE_X], places[PLACE_REALS * k + PLACE_Y]
    if n > 0:
        return outside(corners, n, x, y)
    dx, dy = x - centre[0], y - centre[1]
    return sqrt(dx * dx + dy * dy)


@kernel
def farthest(corners, n, places, count, centre):
    """(how far, which) of the places, the first of those that reach nearly as far as any."""
    most = -inf
    for k in range(count):
        most = max(most, reach_of(corners, n, places, k, centre))
    for k in range(count):
        reach = reach_of(corners, n, places, k, centre)
        if reach >= (1.0 - EVEN) * most:
            return reach, k
    return most, -1


@kernel
def area(corners, n):
    """Twice the area of corners in their order."""
    twice = 0.0
    for k in range(n):
        o, p = CORNER_REALS * k, CORNER_REALS * ((k + 1) % n)
        twice += corners[o + X] * corners[p + Y] - corners[p + X] * corners[o + Y]
    return twice


@kernel
def extent(corners, n):
    """The greatest distance of two corners."""
    most = 0.0
    for i in range(n):
        for k in range(i):
            o, p = CORNER_REALS * i, CORNER_REALS * k
            dx, dy = corners[o + X] - corners[p + X], corners[o + Y] - corners[p + Y]
            most = max(most, sqrt(dx * dx + dy * dy))
    return most


@kernel
def without(corners, n, i, rest):
    """Write the corners but one into `rest`; how many."""
    for k in range(CORNER_REALS * n):
        rest[k] = corners[k]
    return drop_corner(rest, n, i)


@kernel
def keep_outer(corners, n, one):
    """Drop the corners that do not reach beyond the others; how many are left."""
    rest = reals_on_stack(ALL_CORNERS)
    i = 0
    while i < n and n > 1:
        left = without(corners, n, i, rest)
        if left > 2:
            put_around(rest, left)
        if outside(rest, left, corners[CORNER_REALS * i + X], corners[CORNER_REALS * i + Y]) <= one:
            n = drop_corner(corners, n, i)
        else:
            i += 1
    return n


@kernel
def farthest_going(places, count, centre, one):
    """How far a corner of the frame before may have gone: a share of the region's extent."""
    most = 0.0
    for k in range(count):
        most = max(most, reach_of(places, 0, places, k, centre))
    return max(SAME_CORNER * most, one)


@kernel
def gone(places, k, last, turned, i):
    """How far a place is from where a corner of the frame before was, as A or as B sees it,
    whichever is less. `turned` has the points of B in A's frame."""
    p, q, o = PLACE_REALS * k + POINT_A, PLACE_REALS * k + POINT_B, 1 + 6 * i
    with_a = norm(sub(read_vector(places, p), read_vector(last, o)))
    return min(with_a, norm(sub(read_vector(places, q), turned[i])))


@kernel
def keep_last(corners, places, count, last, turned, limit):
    """Put the places that are corners of the frame before, each gone less far than `limit`; how
    many."""
    n = 0
    used = reals_on_stack(MOST_PLACES)
    for k in range(count):
        used[k] = 0.0
    for i in range(int(last[0])):
        least, at = limit, -1
        for k in range(count):
            way = gone(places, k, last, turned, i)
            if used[k] == 0.0 and way < least:
                least, at = way, k
        if at >= 0:
            used[at] = 1.0
            n = put_corner(corners, n, places, at)
    return n


@kernel
def begin_with(corners, n, first):
    """Let one of the corners, which stay in their order, come first."""
    rest = reals_on_stack(ALL_CORNERS)
    for k in range(CORNER_REALS * n):
        rest[k] = corners[k]
    for k in range(n):
        o, p = CORNER_REALS * k, CORNER_REALS * ((k + first) % n)
        for j in range(CORNER_REALS):
            corners[o + j] = rest[p + j]


@kernel
def put_in_turn(corners, n, places, last, turned):
    """Number the corners as in the frame before; without one, first the first of the places."""
    best, first = inf, 0
    shared = min(n, int(last[0]))
    for k in range(n):
        way = corners[CORNER_REALS * k + ROW] if shared == 0 else 0.0
        for i in range(shared):
            row = int(corners[CORNER_REALS * ((k + i) % n) + ROW])
            way += gone(places, row, last, turned, i)
        if way < best:
            best, first = way, k
    begin_with(corners, n, first)


@kernel
def exchange(corners, places, count, centre, one):
    """Exchange corners of a full patch while one that is left out makes it much larger."""
    rest = reals_on_stack(ALL_CORNERS)
    for _ in range(MOST_CORNERS):
        own = area(corners, MOST_CORNERS)
        far, k = farthest(corners, MOST_CORNERS, places, count, centre)
        if far <= one:
            return
        n = put_corner(corners, MOST_CORNERS, places, k)
        best, at = -inf, 0
        for i in range(n):
            without(corners, n, i, rest)
            if area(rest, MOST_CORNERS) > best:
                best, at = area(rest, MOST_CORNERS), i
        if best <= WORTH_A_CORNER * own:
            for i in range(n):
                if corners[CORNER_REALS * i + ROW] == k:
                    at = i
        drop_corner(corners, n, at)
        if best <= WORTH_A_CORNER * own:
            return


@kernel
def chosen(corners, places, count, last, turned, one):
    """Put the corners of the patch of `count` places, counterclockwise; how many. `last` is the
    patch of the frame before."""
    n = 0
    if count == 0:
        return n
    centre = middle_of(places, count)
    if last[0] > 0.0:
        limit = farthest_going(places, count, centre, one)
        n = keep_last(corners, places, count, last, turned, limit)
        n = keep_outer(corners, n, one)
    while n < MOST_CORNERS:
        far, k = farthest(corners, n, places, count, centre)
        if n > 0 and far <= one:
            break
        n = put_corner(corners, n, places, k)
    if n == MOST_CORNERS:
        exchange(corners, places, count, centre, one)
    return n
