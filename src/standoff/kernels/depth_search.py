"""The search of all depths: a proof that none is less, or the direction of one that is.

The nearest facet of a polytope inside A - B points where a lesser depth may hide. A step of the
descent of s(n) from its normal gives a point of A - B beyond it, or shows that it lies on the
boundary. The search ends when no facet is nearer than the least depth found.
"""

from math import inf, nan

from standoff.kernels import layout as L
from standoff.kernels.certificate import certify_along
from standoff.kernels.cold_start import sample_point, support_sample
from standoff.kernels.compiling import kernel, shared
from standoff.kernels.descent import pair_jets
from standoff.kernels.difference_hull import (
    BROKEN,
    CLOSED,
    GREW,
    begin_hull,
    empty_hull,
    facet_normal,
    grow_difference,
    nearest_facet,
)
from standoff.kernels.events import EVALUATIONS, LIMIT, SEARCHES
from standoff.kernels.penetration import (
    begin_along,
    box_depth,
    contact_scale,
    descend,
    shifted,
)
from standoff.kernels.tolerances import (
    MAX_PROBES,
    PRISM,
    SHIFTED_GAP,
    TOUCHING,
)
from standoff.kernels.vectors import add, norm, rotate, rotate_back, scale, sub, unit

# Seeds of the polytope: the axes, and for spatial bodies the cube's corners.
SEEDS = 14
# Minima nearer to each other than this (chord) are one.
SAME_MINIMUM = 0.06


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
def seed(pair, R, p, points, n, way, planar, size):
    """Append the difference of the samples farthest along a direction; the number of points."""
    ia, ra, ib, rb = pair
    x = sample_point(ia, ra, support_sample(ia, ra, way))
    y = sample_point(ib, rb, support_sample(ib, rb, scale(-1.0, rotate_back(R, way))))
    x = sub(x, add(rotate(R, y), p))
    if planar:
        points[n, 0], points[n, 1], points[n, 2] = x[0], x[1], PRISM * size
        points[n + 1, 0], points[n + 1, 1], points[n + 1, 2] = x[0], x[1], -PRISM * size
        return n + 2
    points[n, 0], points[n, 1], points[n, 2] = x
    return n + 1


@kernel
def seed_hull(pair, R, p, hull, size):
    """(solid, direction): facets over differences of samples; see `begin_hull`."""
    planar = pair[0][L.DIMENSION] == 2 or pair[2][L.DIMENSION] == 2
    points = hull[1]
    n = 0
    for k in range(8 if planar else SEEDS):
        n = seed(pair, R, p, points, n, seed_direction(planar, k), planar, size)
    solid, way = begin_hull(hull, n, size)
    for _ in range(3):
        # needles: all seeds in line or in a plane; those square to it are asked too
        if solid:
            break
        n = seed(pair, R, p, points, n, way, planar, size)
        n = seed(pair, R, p, points, n, scale(-1.0, way), planar, size)
        solid, way = begin_hull(hull, n, size)
    return solid, way


@shared
def overlap_shown(pair, R, p):
    """(shown, n, least): is the origin inside the polytope of the seeds, which lies in A - B? n is
    the normal of its nearest facet, `least` how far that is. No evaluation is made.
    """
    hull = empty_hull(pair[0][L.DIMENSION] == 2 or pair[2][L.DIMENSION] == 2)
    size = contact_scale(pair)
    solid, n = seed_hull(pair, R, p, hull, size)
    if not solid:
        return False, n, 0.0
    at, least = nearest_facet(hull, True)
    if at < 0 or least <= TOUCHING * size:
        return False, n, 0.0
    return True, facet_normal(hull, at), least


@kernel
def witness_points(pair, R, p, mode, q):
    jet_a, jet_b = pair_jets(pair, R, p, mode, q)
    return jet_a[0], jet_b[0]


@kernel
def difference(pair, R, p, mode, q):
    """x_a - x_b of the present witness points, a point of A - B."""
    x_a, x_b = witness_points(pair, R, p, mode, q)
    return sub(x_a, x_b)


@kernel
def save(mode, q, best_mode, best_q):
    for k in range(4):
        best_mode[k], best_q[k] = mode[k], q[k]


@kernel
def keep(candidate, found, d, n, mode, q, best):
    """(found, d, n): the candidate (found, d, n) where it is less deep, its features saved."""
    if candidate[0] and (not found or candidate[1] > d):
        save(mode, q, best[0], best[1])
        return candidate
    return found, d, n


@kernel
def search_flat(pair, R, p, way, found, d, n, mode, q, best, w_ff, tolerance, counts, events):
    """What `search` returns where A - B has no inside: two segments, say. The origin is on one
    side of it, square to `way`, or on it.
    """
    for side in (1.0, -1.0):
        nu = scale(side, way)
        begin_along(pair, R, nu, mode, q)
        ok, n_new, d_new = descend(pair, R, p, nu, nan, mode, q, w_ff, tolerance, counts, events)
        found, d, n = keep((ok, d_new, n_new), found, d, n, mode, q, best)
    touching = found and abs(d) <= TOUCHING * contact_scale(pair)
    return found, d, n, 0.0 if touching else -inf


@kernel
def deepest_below(pair, R, p, n, d, mode, q, w_ff, tolerance, counts, events):
    """(parts, d, n): the local minimum of s below a step along n, or what that step itself parts
    the bodies by, where the descent ends uncertified.
    """
    ok, n, d = descend(pair, R, p, n, d, mode, q, w_ff, tolerance, counts, events)
    if not ok:
        x_a, x_b = witness_points(pair, R, p, mode, q)
        d, _ = certify_along(pair, R, p, mode, q, x_a, x_b, n)
    return d > -inf, d, n


@shared
def search(pair, R, p, found, d, n, mode, q, best, w_ff, tolerance, proof, rivals, counts, events):
    """(found, d, n, least): the least depth of the cores, from the local minimum given (if found).

    best = (mode, q) are those of the minimum given and get those of the answer; mode and q
    are scratch. `least` bounds every depth from below: -inf where the origin is not known to lie
    in A - B. `proof` is the part of the depth that another one may be less by: 1 asks only
    whether the bodies overlap. `rivals` is how many other minima a proven search still tries, as
    a float. A descent that ends uncertified still gives a depth that parts the bodies: its bound.
    """
    size = contact_scale(pair)
    radius = pair[1][L.RADIUS] + pair[3][L.RADIUS]
    counts[SEARCHES] += 1
    hull = empty_hull(pair[0][L.DIMENSION] == 2 or pair[2][L.DIMENSION] == 2)
    solid, way = seed_hull(pair, R, p, hull, size)
    if not solid:
        return search_flat(
            pair, R, p, way, found, d, n, mode, q, best, w_ff, tolerance, counts, events
        )
    if found:
        grow_difference(hull, difference(pair, R, p, best[0], best[1]), size)
    facets = hull[3]
    tried = 0.0
    for _ in range(MAX_PROBES):
        if counts[EVALUATIONS] >= counts[LIMIT]:
            break
        at, least = nearest_facet(hull, True)
        if at < 0:
            break
        nu = facet_normal(hull, at)
        proven = found and least + radius >= (1.0 - proof) * (radius - d) - TOUCHING * size
        if proven:
            # another minimum may still be less by DEPTH_PROOF, away from this one
            if least >= -d - TOUCHING * size or tried >= rivals:
                break
            if norm(sub(nu, n)) <= SAME_MINIMUM:
                facets[at, CLOSED] = 1.0
                continue
            tried += 1.0
        begin_along(pair, R, nu, mode, q)
        outer = -box_depth(pair, R, p, nu)
        apart, n_new, d_new = shifted(
            pair, R, p, nu, outer, SHIFTED_GAP, mode, q, w_ff, counts, events
        )
        if not apart:
            facets[at, CLOSED] = 1.0
            continue
        grown = grow_difference(hull, difference(pair, R, p, mode, q), size)
        if grown != GREW:
            facets[at, CLOSED] = 1.0
        if proven or not found or d_new > d + TOUCHING * size:
            end = deepest_below(pair, R, p, n_new, d_new, mode, q, w_ff, tolerance, counts, events)
            found, d, n = keep(end, found, d, n, mode, q, best)
            grow_difference(hull, difference(pair, R, p, mode, q), size)
        if grown == BROKEN:
            break
    return found, d, n, nearest_facet(hull, False)[1]
