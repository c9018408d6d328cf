"""The search of all depths: a proof that none is less, or the direction of one that is.

The nearest facet of a polytope inside A - B points where a lesser depth may hide. A step of the
descent of s(n) from its normal gives a point of A - B beyond it, or shows that it lies on the
boundary. The search ends when no facet is nearer than the least depth found.
"""

from math import inf, nan

from standoff.kernels.algebra.vectors import add, norm, rotate, rotate_back, scale, sub, unit
from standoff.kernels.body import layout as L
from standoff.kernels.compiler.decorators import ints_on_stack, kernel, reals_on_stack, shared
from standoff.kernels.depth.descent import descend
from standoff.kernels.depth.difference_hull import (
    ALL_CORNERS,
    ALL_FACETS,
    ALL_POINTS,
    ALL_RIMS,
    BROKEN,
    EXACT,
    GREW,
    MAX_FACETS,
    N_SIZES,
    Hull,
    Vertex,
    begin_hull,
    close_facet,
    empty_hull,
    facet_normal,
    grow_difference,
    lifted,
    nearest_facet,
    put_vertex,
)
from standoff.kernels.depth.kept_polytope import keep, recall
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
from standoff.kernels.pair.events import KEEPING, KEPT, SEARCHES, exhausted
from standoff.kernels.tolerances import (
    KEPT_RIVALS,
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
    vertex = Vertex(sub(x, add(rotate(pose.R, y), pose.p)), x, y)
    if is_planar(pair):
        put_vertex(points, n, lifted(vertex, PRISM * size))
        put_vertex(points, n + 1, lifted(vertex, -PRISM * size))
        return n + 2
    put_vertex(points, n, vertex)
    return n + 1


@shared
def seed_hull(pair, pose, hull, size, exact):
    """(solid, direction): facets over differences of samples; see `begin_hull`."""
    planar = is_planar(pair)
    empty_hull(hull, planar, exact)
    points = hull.points
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
    hull = Hull(
        ints_on_stack(N_SIZES),
        reals_on_stack(ALL_POINTS),
        ints_on_stack(ALL_CORNERS),
        reals_on_stack(ALL_FACETS),
        ints_on_stack(MAX_FACETS),
        ints_on_stack(ALL_RIMS),
    )
    size = contact_scale(pair)
    solid, n = seed_hull(pair, pose, hull, size, False)
    if not solid:
        return False, n, 0.0
    at, least = nearest_facet(hull, True)
    if at < 0 or least <= TOUCHING * size:
        return False, n, 0.0
    return True, facet_normal(hull, at), least


@kernel
def difference(pair, pose, place):
    """The witness points' difference x_a - x_b, a point of A - B."""
    jet_a, jet_b = pair_jets(pair, pose, place)
    of_b = rotate_back(pose.R, sub(jet_b[0], pose.p))
    return Vertex(sub(jet_a[0], jet_b[0]), jet_a[0], of_b)


@kernel
def taken_beyond(pair, pose, hull, nu, probe, size):
    """`grow_difference` by a probe beyond a facet with the normal nu. An exact polytope also takes
    in the samples farthest along nu, among which are a polytope's own vertices: a probe may end
    beside one by what counts as no slope.
    """
    grown = grow_difference(hull, difference(pair, pose, probe.place), size)
    if hull.sizes[EXACT] == 0:
        return grown
    farthest = difference(pair, pose, begin_along(pair, pose, nu))
    return min(grown, grow_difference(hull, farthest, size))


@kernel
def less_deep(candidate, best):
    """Of two depths the lesser; one that was not found is none."""
    if candidate.found and (not best.found or candidate.distance > best.distance):
        return candidate
    return best


@kernel
def search_flat(pair, pose, way, best, tolerance, work):
    """What `search` returns if A - B has no interior: for two segments, say. It is perpendicular to
    `way`, with the origin on one side of it or on it.
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


@kernel
def narrow(pair, pose, hull, best, how, work):
    """(depth, least, stuck): those of `search`, by probes beyond the nearest facets of a polytope
    about the origin; stuck where none of them makes it grow, though it proves nothing. `how` is
    (tolerance, proof, rivals).

    It is no `standoff.best_first`: no facet is split. Each probe makes the one polytope grow, which
    takes away facets and makes others, and the least of those that are left is found in passing;
    nor may a frame call Python.
    """
    tolerance, proof, rivals = how
    size = contact_scale(pair)
    tried, ended = 0, False
    for _ in range(MAX_PROBES):
        if exhausted(work):
            break
        at, least = nearest_facet(hull, True)
        if at < 0:
            ended = True
            break
        nu = facet_normal(hull, at)
        proven = settles(pair, best, least, proof)
        # another minimum may still be less by DEPTH_PROOF, away from this one
        if proven and (least >= -best.distance - TOUCHING * size or tried >= rivals):
            ended = True
            break
        if proven and norm(sub(nu, best.normal)) <= SAME_MINIMUM:
            close_facet(hull, at)
            continue
        tried += 1 if proven else 0
        outer = Depth(False, -box_depth(pair, pose, nu), nu, begin_along(pair, pose, nu))
        apart, probe = shifted(pair, pose, outer, SHIFTED_GAP, work)
        if not apart:
            close_facet(hull, at)
            continue
        grown = taken_beyond(pair, pose, hull, nu, probe, size)
        if grown != GREW:
            close_facet(hull, at)
        if proven or not best.found or probe.distance > best.distance + TOUCHING * size:
            end = deepest_below(pair, pose, probe, tolerance, work)
            best = less_deep(end, best)
            grow_difference(hull, difference(pair, pose, end.place), size)
        if grown == BROKEN:
            ended = True
            break
    least = nearest_facet(hull, False)[1]
    return best, least, ended and not settles(pair, best, least, proof)


@kernel
def narrow_kept(pair, pose, hull, best, how, work):
    """`narrow`, of the polytope that the frame before has kept: it is asked first whether it proves
    the depth as it is, or with the witness points' own difference taken in.
    """
    tolerance, proof, rivals = how
    if best.found and not settles(pair, best, nearest_facet(hull, False)[1], proof):
        grow_difference(hull, difference(pair, pose, best.place), contact_scale(pair))
    return narrow(pair, pose, hull, best, (tolerance, proof, min(rivals, KEPT_RIVALS)), work)


@shared
def search(pair, pose, best, tolerance, proof, rivals, work):
    """(depth, least): the least depth of the cores, from the local minimum given (if found).

    `least` bounds every depth from below: -inf where the origin is not known to lie in A - B.
    `proof` is the part of the depth that another one may be less by: 1 asks only whether the
    bodies overlap. `rivals` is how many other minima a proven search still tries. A descent that
    ends uncertified still gives a depth that parts the bodies: its bound.

    In a frame that is KEEPING its polytope the one of the frame before, moved with the bodies, is
    tried first. If that proves no depth, the polytope is built again, and an EXACT one where that
    one got stuck too.
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
    how = tolerance, proof, rivals
    keeping = work.counts[KEEPING] != 0
    least, settled = -inf, False
    if keeping and recall(hull, pose, is_planar(pair), work.last_polytope, size):
        best, least, _ = narrow_kept(pair, pose, hull, best, how, work)
        settled = settles(pair, best, least, proof) or (exhausted(work) and least > 0.0)
    stuck = not settled
    for exact in (False, True):
        if not stuck:
            break
        work.counts[SEARCHES] += 1
        solid, way = seed_hull(pair, pose, hull, size, exact)
        if not solid:
            return search_flat(pair, pose, way, best, tolerance, work)
        if best.found:
            grow_difference(hull, difference(pair, pose, best.place), size)
        best, least, stuck = narrow(pair, pose, hull, best, how, work)
    if keeping and least > 0.0:
        keep(hull, work.polytope)
        work.counts[KEPT] = 1
    return best, least
