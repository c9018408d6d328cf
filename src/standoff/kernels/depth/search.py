"""The search of all depths: a proof that none is less, or the direction of one that is.

The nearest facet of a polytope inside A - B points where a lesser depth may hide. A step of the
descent of s(n) from its normal gives a point of A - B beyond it, or shows that it lies on the
boundary. The search ends when no facet is nearer than the least depth found.
"""

from math import inf, nan

from standoff.kernels.algebra.vectors import add, norm, rotate, scale, sub, unit
from standoff.kernels.body import layout as L
from standoff.kernels.compiler.decorators import kernel, shared
from standoff.kernels.depth.descent import descend
from standoff.kernels.depth.difference_hull import (
    BROKEN,
    CLOSED,
    GREW,
    begin_hull,
    empty_hull,
    facet_normal,
    grow_difference,
    nearest_facet,
)
from standoff.kernels.depth.penetration import (
    begin_along,
    box_depth,
    contact_scale,
    is_planar,
    shifted,
)
from standoff.kernels.pair.certificate import certify_along
from standoff.kernels.pair.cold_start import farthest_along, sample_point
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.events import SEARCHES, exhausted
from standoff.kernels.tolerances import (
    MAX_PROBES,
    PRISM,
    SAME_MINIMUM,
    SHIFTED_GAP,
    TOUCHING,
)
from standoff.kernels.values import Depth

# Seeds of the polytope: the axes, and for spatial bodies the cube's corners.
SEEDS = 14


@kernel
def seed_direction(planar, k):
    if planar:
        x = (1.0, 0.7, 0.0, -0.7, -1.0, -0.7, 0.0, 0.7)[k % 8]
        y = (0.0, 0.7, 1.0, 0.7, 0.0, -0.7, -1.0, -0.7)[k % 8]
        return unit((x, y, 0.0))
    if k < 6:
        sign = 1.0 if k % 2 == 0 else -1.0
        return (
            sign if k // 2 == 0 else 0.0,
            sign if k // 2 == 1 else 0.0,
            sign if k // 2 == 2 else 0.0,
        )
    m = k - 6
    return unit(
        (
            1.0 if m & 1 else -1.0,
            1.0 if m & 2 else -1.0,
            1.0 if m & 4 else -1.0,
        )
    )


@kernel
def seed(pair, pose, points, n, way, size):
    """Append the difference of the samples farthest along a direction; the number of points."""
    i, j = farthest_along(pair, pose, way)
    x = sample_point(pair.ints_a, pair.reals_a, i)
    y = sample_point(pair.ints_b, pair.reals_b, j)
    x = sub(x, add(rotate(pose.R, y), pose.p))
    if is_planar(pair):
        points[n, 0], points[n, 1], points[n, 2] = x[0], x[1], PRISM * size
        points[n + 1, 0], points[n + 1, 1], points[n + 1, 2] = x[0], x[1], -PRISM * size
        return n + 2
    points[n, 0], points[n, 1], points[n, 2] = x
    return n + 1


@kernel
def seed_hull(pair, pose, hull, size):
    """(solid, direction): facets over differences of samples; see `begin_hull`."""
    planar = is_planar(pair)
    points = hull[1]
    n = 0
    for k in range(8 if planar else SEEDS):
        n = seed(pair, pose, points, n, seed_direction(planar, k), size)
    solid, way = begin_hull(hull, n, size)
    for _ in range(3):
        # needles: all seeds in line or in a plane; those square to it are asked too
        if solid:
            break
        n = seed(pair, pose, points, n, way, size)
        n = seed(pair, pose, points, n, scale(-1.0, way), size)
        solid, way = begin_hull(hull, n, size)
    return solid, way


@shared
def overlap_shown(pair, pose):
    """(shown, n, least): is the origin inside the polytope of the seeds, which lies in A - B? n is
    the normal of its nearest facet, `least` how far that is. No evaluation is made.
    """
    hull = empty_hull(is_planar(pair))
    size = contact_scale(pair)
    solid, n = seed_hull(pair, pose, hull, size)
    if not solid:
        return False, n, 0.0
    at, least = nearest_facet(hull, True)
    if at < 0 or least <= TOUCHING * size:
        return False, n, 0.0
    return True, facet_normal(hull, at), least


@kernel
def difference(pair, pose, place):
    """x_a - x_b of witness points, a point of A - B."""
    jet_a, jet_b = pair_jets(pair, pose, place)
    return sub(jet_a[0], jet_b[0])


@kernel
def less_deep(candidate, best):
    """Of two depths the lesser; one that was not found is none."""
    if candidate.found and (not best.found or candidate.distance > best.distance):
        return candidate
    return best


@kernel
def search_flat(pair, pose, way, best, tolerance, work):
    """What `search` returns where A - B has no inside: two segments, say. The origin is on one
    side of it, square to `way`, or on it.
    """
    for side in (1.0, -1.0):
        nu = scale(side, way)
        start = Depth(False, nan, nu, begin_along(pair, pose, nu))
        best = less_deep(descend(pair, pose, start, tolerance, work), best)
    touching = best.found and abs(best.distance) <= TOUCHING * contact_scale(pair)
    return best, 0.0 if touching else -inf


@kernel
def deepest_below(pair, pose, start, tolerance, work):
    """The local minimum of s below a step of the descent, or what that step itself parts the
    bodies by, where the descent ends uncertified.
    """
    end = descend(pair, pose, start, tolerance, work)
    if end.found:
        return Depth(end.distance > -inf, end.distance, end.normal, end.place)
    jets = pair_jets(pair, pose, end.place)
    d, _ = certify_along(pair, pose, end.place, jets, end.normal)
    return Depth(d > -inf, d, end.normal, end.place)


@kernel
def settles(pair, best, least, proof):
    """Does the bound `least` of all depths prove that none is less than the best by more than the
    part `proof` of it?"""
    radius = pair.reals_a[L.RADIUS] + pair.reals_b[L.RADIUS]
    scale_of = contact_scale(pair)
    return (
        best.found
        and least + radius >= (1.0 - proof) * (radius - best.distance) - TOUCHING * scale_of
    )


@shared
def search(pair, pose, best, tolerance, proof, rivals, work):
    """(depth, least): the least depth of the cores, from the local minimum given (if found).

    `least` bounds every depth from below: -inf where the origin is not known to lie in A - B.
    `proof` is the part of the depth that another one may be less by: 1 asks only whether the
    bodies overlap. `rivals` is how many other minima a proven search still tries. A descent that
    ends uncertified still gives a depth that parts the bodies: its bound.
    """
    size = contact_scale(pair)
    work.counts[SEARCHES] += 1
    hull = empty_hull(is_planar(pair))
    solid, way = seed_hull(pair, pose, hull, size)
    if not solid:
        return search_flat(pair, pose, way, best, tolerance, work)
    if best.found:
        grow_difference(hull, difference(pair, pose, best.place), size)
    facets = hull[3]
    tried = 0
    for _ in range(MAX_PROBES):
        if exhausted(work):
            break
        at, least = nearest_facet(hull, True)
        if at < 0:
            break
        nu = facet_normal(hull, at)
        proven = settles(pair, best, least, proof)
        # another minimum may still be less by DEPTH_PROOF, away from this one
        if proven and (least >= -best.distance - TOUCHING * size or tried >= rivals):
            break
        if proven and norm(sub(nu, best.normal)) <= SAME_MINIMUM:
            facets[at, CLOSED] = 1.0
            continue
        tried += 1 if proven else 0
        outer = Depth(False, -box_depth(pair, pose, nu), nu, begin_along(pair, pose, nu))
        apart, probe = shifted(pair, pose, outer, SHIFTED_GAP, work)
        if not apart:
            facets[at, CLOSED] = 1.0
            continue
        grown = grow_difference(hull, difference(pair, pose, probe.place), size)
        if grown != GREW:
            facets[at, CLOSED] = 1.0
        if proven or not best.found or probe.distance > best.distance + TOUCHING * size:
            end = deepest_below(pair, pose, probe, tolerance, work)
            best = less_deep(end, best)
            grow_difference(hull, difference(pair, pose, end.place), size)
        if grown == BROKEN:
            break
    return best, nearest_facet(hull, False)[1]
