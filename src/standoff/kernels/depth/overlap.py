"""A proof that two bodies overlap, where no depth of theirs could be certified.

Their cores share a point where the origin lies in A - B, and so where it lies in a polytope of
points of it. Each vertex is a difference of points that were computed on the bodies, so it lies
within some length, `proof_margin`, of a point of A - B. Let a ball of a greater radius about the
origin be in the polytope of the vertices as they were computed: then along every direction some
vertex reaches that radius, the point of A - B beside it reaches more than 0, and no plane parts the
origin from A - B. What roundoff does to the facets is taken off their distances (`add_facet`).

The polytope grows where it is nearest to the origin. With the origin outside, let c be its nearest
point and n = -c / |c|; with it inside, let c be the foot on its nearest facet and n the facet's
normal. c is in A - B and on the line of n, so the point of A - B that is nearest to one beyond it
on this line, which is what a step of the descent of s(n) finds, is no nearer to c's own side than
c: it is above it, or c is on the boundary of A - B.

Bodies whose cores are apart overlap by their swept radii where two points are nearer than these.
Nothing is proven where neither holds with a margin: of bodies that touch, of cores whose A - B has
no inside, such as two segments, and of those within COPLANAR of touching, where the polytope does
not grow.
"""

from math import inf

from standoff.kernels.algebra.vectors import axpy, cross, dot, norm, scale, sub, unit
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import pair_slack, pair_span
from standoff.kernels.compiler.decorators import ints_on_stack, kernel, reals_on_stack, shared
from standoff.kernels.depth.difference_hull import (
    ALL_CORNERS,
    ALL_FACETS,
    ALL_POINTS,
    ALL_RIMS,
    FACET_REALS,
    FACETS,
    GREW,
    MAX_FACETS,
    N_SIZES,
    OFFSET,
    PLANAR,
    Hull,
    facet_normal,
    grow_difference,
    nearest_facet,
    point_of,
)
from standoff.kernels.depth.penetration import (
    begin_along,
    box_depth,
    contact_scale,
    plane_normal,
    shifted,
)
from standoff.kernels.depth.search import difference, seed_hull
from standoff.kernels.pair.certified import OVERLAP, UNCERTIFIED, on_feature
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.events import EVENTS, SEARCHES, exhausted
from standoff.kernels.tolerances import (
    COPLANAR,
    LEAST_DIVISOR,
    OVERLAP_NOISE,
    OVERLAP_ROUNDS,
    SHIFTED_GAP,
)
from standoff.kernels.values import Depth, Found


@kernel
def proof_margin(pair, pose):
    """How far a point of A - B may be from the difference of witness points that was computed for
    it: by their roundoff, and by the bodies' own slack."""
    return OVERLAP_NOISE * pair_span(pair, pose.p, 0.0) + pair_slack(pair)


@kernel
def nearest_on_side(a, b):
    """The point of a segment that is nearest to the origin."""
    way = sub(b, a)
    part = -dot(a, way) / max(dot(way, way), LEAST_DIVISOR)
    return axpy(min(max(part, 0.0), 1.0), way, a)


@kernel
def is_left(normal, a, b, x):
    """Seen from outside, is x on the left of the side from a to b?"""
    return dot(normal, cross(sub(b, a), sub(x, a))) >= 0.0


@kernel
def nearest_on_facet(hull, m):
    """(is it the foot of the origin on the facet's plane, the facet's point nearest to the
    origin)."""
    normal = facet_normal(hull, m)
    a = point_of(hull.points, hull.corners[3 * m])
    b = point_of(hull.points, hull.corners[3 * m + 1])
    c = point_of(hull.points, hull.corners[3 * m + 2])
    foot = scale(dot(normal, a), normal)
    if is_left(normal, a, b, foot) and is_left(normal, b, c, foot) and is_left(normal, c, a, foot):
        return True, foot
    best = nearest_on_side(a, b)
    for x in (nearest_on_side(b, c), nearest_on_side(c, a)):
        if dot(x, x) < dot(best, best):
            best = x
    return False, best


@kernel
def way_out(hull, size):
    """The direction, from the polytope's point nearest to the origin, in which it is to grow."""
    at, offset = nearest_facet(hull, False)
    n = facet_normal(hull, at)
    if offset <= 0.0:
        least = inf
        for m in range(hull.sizes[FACETS]):
            if hull.facets[FACET_REALS * m + OFFSET] > 0.0:
                continue
            foot, x = nearest_on_facet(hull, m)
            far = dot(x, x)
            if far < least:
                least = far
                # so near to the origin the direction to it has no digits
                near = far <= (COPLANAR * size) ** 2
                n = facet_normal(hull, m) if foot or near else unit(scale(-1.0, x))
    return unit((n[0], n[1], 0.0)) if hull.sizes[PLANAR] else n


@kernel
def farthest_place(pair, pose, n, work):
    """(is it one of both bodies, the place, the signed distance along its normal) by a step of the
    descent of s(n) from a direction and the samples farthest along it."""
    start = Depth(False, -box_depth(pair, pose, n), n, begin_along(pair, pose, n))
    apart, found = shifted(pair, pose, start, SHIFTED_GAP, work)
    return apart and on_feature(pair, found.place), found.place, found.distance


@kernel
def grows_about(pair, pose, hull, margin, work):
    """Does the polytope grow to contain a ball about the origin whose radius is the margin?"""
    size = contact_scale(pair)
    for _ in range(OVERLAP_ROUNDS):
        if nearest_facet(hull, False)[1] > margin:
            return True
        on_both, place, distance = farthest_place(pair, pose, way_out(hull, size), work)
        if not on_both or distance > 0.0 or exhausted(work):
            return False
        if grow_difference(hull, difference(pair, pose, place), size) != GREW:
            return False
    return nearest_facet(hull, False)[1] > margin


@kernel
def swept_radii(pair):
    return pair.reals_a[L.RADIUS] + pair.reals_b[L.RADIUS]


@kernel
def within_radii(pair, pose, place, margin):
    """Are the points of a place nearer to each other than the bodies are swept?"""
    if swept_radii(pair) <= margin or not on_feature(pair, place):
        return False
    jets = pair_jets(pair, pose, place)
    return norm(sub(jets[1][0], jets[0][0])) < swept_radii(pair) - margin


@kernel
def below_plane(pair, pose, n, margin, work):
    """Is a point of the other body below a half-space's plane by more than the margin, or so little
    above it that the swept body is below? n is the plane's normal from A to B."""
    for seed in (True, False):
        on_both, place = True, begin_along(pair, pose, n)
        if not seed:
            on_both, place, _ = farthest_place(pair, pose, n, work)
        jets = pair_jets(pair, pose, place)
        if on_both and dot(n, sub(jets[1][0], jets[0][0])) < swept_radii(pair) - margin:
            return True
    return False


@kernel
def cores_meet(pair, pose, margin, work):
    """Is it proven that the cores of two bounded bodies share a point?"""
    work.counts[SEARCHES] += 1
    hull = Hull(
        ints_on_stack(N_SIZES),
        reals_on_stack(ALL_POINTS),
        ints_on_stack(ALL_CORNERS),
        reals_on_stack(ALL_FACETS),
        ints_on_stack(MAX_FACETS),
        ints_on_stack(ALL_RIMS),
    )
    solid, _ = seed_hull(pair, pose, hull, contact_scale(pair), False)
    return solid and grows_about(pair, pose, hull, margin, work)


@shared
def overlap_proven(pair, pose, place, work):
    """Is it proven that the bodies overlap? The place is any; its points may be near each other.

    Evaluations are counted, switches are not.
    """
    margin = proof_margin(pair, pose)
    if within_radii(pair, pose, place, margin):
        return True
    logged = work.counts[EVENTS]
    plane, n = plane_normal(pair, pose)
    if plane:
        shown = below_plane(pair, pose, n, margin, work)
    else:
        shown = cores_meet(pair, pose, margin, work)
    work.counts[EVENTS] = logged
    return shown


@kernel
def with_overlap(pair, pose, found, work):
    """What a query has found, its outcome OVERLAP where nothing of it is certified, not even that
    the bodies are apart, and an overlap is proven."""
    if found.outcome != UNCERTIFIED or found.lower > swept_radii(pair) or exhausted(work):
        return found
    if not overlap_proven(pair, pose, found.place, work):
        return found
    return Found(OVERLAP, found.place, found.distance, found.lower, found.upper, found.normal)
