"""Other directions in which an overlap is as thin: a ball in the middle of a slab has two."""

from math import nan

from standoff.kernels.algebra.vectors import norm, rotate, scale, sub, unit
from standoff.kernels.body import layout as L
from standoff.kernels.compiler.decorators import ints_on_stack, kernel, reals_on_stack, shared
from standoff.kernels.depth.descent import descend
from standoff.kernels.depth.difference_hull import (
    ALL_CORNERS,
    ALL_FACETS,
    ALL_POINTS,
    ALL_RIMS,
    BROKEN,
    GREW,
    MAX_FACETS,
    N_SIZES,
    Hull,
    close_facet,
    facet_normal,
    grow_difference,
    nearest_facet,
)
from standoff.kernels.depth.kept_polytope import recall
from standoff.kernels.depth.penetration import (
    begin_along,
    box_depth,
    contact_scale,
    is_planar,
    shifted,
)
from standoff.kernels.depth.search import difference, seed_hull
from standoff.kernels.pair.events import KEEPING
from standoff.kernels.tolerances import (
    AROUND,
    MAX_PROBES,
    SAME_MINIMUM,
    SAME_WIDTH,
    SHIFTED_GAP,
    START_GAP,
)
from standoff.kernels.values import Depth

# Descents start against the normal, and along each of a cube's faces, edges and corners (and from
# its middle, which is skipped) in both bodies' frames.
CUBE = 27
N_STARTS = 1 + 2 * CUBE


@kernel
def start_direction(pair, pose, n, k):
    """Direction k to start from, in A's frame; of planar bodies in their plane. Not of length 1."""
    if k == 0:
        return scale(-1.0, n)
    m = (k - 1) % CUBE
    way = (float(m % 3) - 1.0, float(m // 3 % 3) - 1.0, float(m // 9) - 1.0)
    if k > CUBE:
        way = rotate(pose.R, way)
    if pair.ints_a[L.DIMENSION] == 2 or pair.ints_b[L.DIMENSION] == 2:
        way = (way[0], way[1], 0.0)
    return way


@kernel
def is_new(n, found, count):
    """Is a normal not among those found?"""
    for k in range(count):
        if norm(sub(n, (found[3 * k], found[3 * k + 1], found[3 * k + 2]))) <= AROUND:
            return False
    return True


@kernel
def least_below(pair, pose, way, work):
    """The local minimum of the depth below a direction."""
    at = Depth(False, nan, way, begin_along(pair, pose, way))
    return descend(pair, pose, at, START_GAP, work)


@kernel
def equally_deep(pair, pose, n, d, found, work):
    """How many normals there are along which the cores are as deep in each other, and they into
    `found` (3 numbers each), n first. All in A's frame; d is the signed distance of the cores.
    """
    found[0], found[1], found[2] = n
    count = 1
    if pair.ints_a[L.UNBOUNDED] or pair.ints_b[L.UNBOUNDED]:
        return count
    same = SAME_WIDTH * contact_scale(pair)
    for k in range(N_STARTS):
        way = start_direction(pair, pose, n, k)
        if norm(way) < AROUND:
            continue
        ended = least_below(pair, pose, unit(way), work)
        if ended.found and abs(ended.distance - d) <= same and is_new(ended.normal, found, count):
            o = 3 * count
            found[o], found[o + 1], found[o + 2] = ended.normal
            count += 1
    return count


# Is a least depth the only one?
ALONE, NOT_ALONE, NOT_KNOWN = range(3)


@kernel
def alone(pair, pose, best, work):
    """Whether no other direction is as little deep: by a polytope within A - B, whose facets are
    farther from the origin than the depth, but for those around its normal.

    A facet that is not, and on whose other side there is nothing of A - B, points along a direction
    that is as little deep. Minima nearer to each other than SAME_MINIMUM are not distinguished.
    Where the work is KEEPING a polytope, that of the frame that found the depth, it is asked first.
    """
    hull = Hull(
        ints_on_stack(N_SIZES),
        reals_on_stack(ALL_POINTS),
        ints_on_stack(ALL_CORNERS),
        reals_on_stack(ALL_FACETS),
        ints_on_stack(MAX_FACETS),
        ints_on_stack(ALL_RIMS),
    )
    size = contact_scale(pair)
    keeping = work.counts[KEEPING] != 0
    if keeping and recall(hull, pose, is_planar(pair), work.last_polytope, size):
        known = alone_in(pair, pose, hull, best, work)
        if known != NOT_KNOWN:
            return known
    if not seed_hull(pair, pose, hull, size, False)[0]:
        return NOT_KNOWN
    grow_difference(hull, difference(pair, pose, best.place), size)
    return alone_in(pair, pose, hull, best, work)


@shared
def alone_in(pair, pose, hull, best, work):
    """`alone` by a polytope about the origin, which grows where it does not tell."""
    size = contact_scale(pair)
    same = SAME_WIDTH * size
    for _ in range(MAX_PROBES):
        at, least = nearest_facet(hull, True)
        if at < 0 or least > same - best.distance:
            return ALONE
        nu = facet_normal(hull, at)
        if norm(sub(nu, best.normal)) <= SAME_MINIMUM:
            close_facet(hull, at)
            continue
        outer = Depth(False, -box_depth(pair, pose, nu), nu, begin_along(pair, pose, nu))
        apart, probe = shifted(pair, pose, outer, SHIFTED_GAP, work)
        grown = (
            grow_difference(hull, difference(pair, pose, probe.place), size) if apart else BROKEN
        )
        if grown == GREW:
            continue
        ended = least_below(pair, pose, nu, work)
        other = norm(sub(ended.normal, best.normal)) > AROUND
        if ended.found and other and abs(ended.distance - best.distance) <= same:
            return NOT_ALONE
        if not ended.found or (apart and grown == BROKEN):
            return NOT_KNOWN
        close_facet(hull, at)
    return NOT_KNOWN
