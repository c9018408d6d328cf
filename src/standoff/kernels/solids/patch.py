"""The patch of a local minimum: a few pairs of points that span where the gap is hardly wider."""

from math import inf, sqrt
from typing import Any, NamedTuple

from standoff.kernels.algebra.corners import CORNER_REALS, ROW, X, Y, outside, put_around
from standoff.kernels.algebra.frames import frame_across
from standoff.kernels.algebra.rigid import read_vector
from standoff.kernels.algebra.vectors import add, dot, norm, scale, sub
from standoff.kernels.compiler.decorators import kernel, reals_on_stack
from standoff.kernels.solids.minima_sets import (
    SET_PAIRS,
    SET_POINTS,
    SET_REALS,
    SET_ROW,
    points_of,
)
from standoff.kernels.solids.spatial_progress import (
    MINIMUM_REALS,
    N_MINIMA,
    NORMAL,
    POINTS,
    SIZE,
    TOLERANCE,
)
from standoff.kernels.solids.spatial_tolerances import ONE_PATCH, ONE_PLACE

# Of a patch: so many pairs at most, each a corner across the normal.
MOST_CORNERS = 4
ALL_CORNERS = CORNER_REALS * MOST_CORNERS


class Across(NamedTuple):
    """What pairs of points are laid on: the middle of a minimum, and axes across its normal."""

    middle: Any
    frame: Any


@kernel
def middle_of(minima, o):
    x, y = points_of(minima, o)
    return scale(0.5, add(x, y))


@kernel
def normal_of(minima, o):
    return read_vector(minima, o + NORMAL)


@kernel
def nearest_set(minima, o, sets, n):
    """The minimum that a pair is nearest to, of those with nearly the same normal; -1: none."""
    spot, normal = middle_of(minima, o), normal_of(minima, o)
    least, found = inf, -1
    for k in range(n):
        row = MINIMUM_REALS * int(sets[SET_REALS * k + SET_ROW])
        if dot(normal_of(minima, row), normal) < ONE_PATCH:
            continue
        away = norm(sub(middle_of(minima, row), spot))
        if away < least:
            least, found = away, k
    return found


@kernel
def laid(across, minima, o):
    """Where a pair is across the normal."""
    away = sub(middle_of(minima, o), across.middle)
    return dot(away, across.frame.e), dot(away, across.frame.f)


@kernel
def farthest_of_patch(best, minima, sets, which, limits, across, corners, n):
    """(how far, row) of the pair that is farthest outside of the corners, and belongs to the
    minimum; with no corner, from its middle."""
    k, n_sets = which
    most, found = 0.0, -1
    for i in range(int(best[N_MINIMA])):
        o = MINIMUM_REALS * i
        if (
            minima[o] < limits[0]
            or minima[o] > limits[1]
            or nearest_set(minima, o, sets, n_sets) != k
        ):
            continue
        x, y = laid(across, minima, o)
        far = outside(corners, n, x, y) if n > 0 else sqrt(x * x + y * y)
        if far > most:
            most, found = far, i
    return most, found


@kernel
def span(best, minima, wider, sets, k, n_sets):
    """Write the patch of set `k`: up to four pairs out of those that were found, whose distance is
    from its own to `wider` more, along nearly the same normal, and nearer to it than to any other
    minimum, each farthest outside of those taken before. Its own is one of them, unless others
    are as near and span the rest."""
    s = SET_REALS * k
    own = int(sets[s + SET_ROW])
    o = MINIMUM_REALS * own
    across = Across(middle_of(minima, o), frame_across(normal_of(minima, o)))
    corners = reals_on_stack(ALL_CORNERS)
    least, tie = ONE_PLACE * best[SIZE], best[TOLERANCE]
    limits = sets[s] - tie, sets[s] + tie
    far, row = farthest_of_patch(best, minima, sets, (k, n_sets), limits, across, corners, 0)
    if far <= least:
        row = own
    limits = sets[s] - tie, sets[s] + wider
    n = 0
    while row >= 0 and n < MOST_CORNERS:
        x, y = laid(across, minima, MINIMUM_REALS * row)
        at = CORNER_REALS * n
        corners[at + X], corners[at + Y], corners[at + ROW] = x, y, row
        n += 1
        if n > 2:
            put_around(corners, n)
        far, row = farthest_of_patch(best, minima, sets, (k, n_sets), limits, across, corners, n)
        if far <= least:
            break
    sets[s + SET_PAIRS] = n
    for i in range(n):
        at = MINIMUM_REALS * int(corners[CORNER_REALS * i + ROW]) + POINTS
        for j in range(6):
            sets[s + SET_POINTS + 6 * i + j] = minima[at + j]


@kernel
def span_all(best, minima, wider, sets, n):
    """Write the patches of all sets."""
    for k in range(n):
        span(best, minima, wider, sets, k, n)
