"""The certificate: a lower bound of the true distance from supporting planes."""

from math import inf
from typing import NamedTuple

import numpy as np

from standoff.kernels.algebra.vectors import (
    add,
    axpy,
    cross,
    dot,
    norm,
    rotate,
    rotate_back,
    scale,
    sub,
    taxicab,
    unit,
)
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    ZERO,
    chart_normal,
    coedge_conormal,
    dimension,
    edge_record,
    face_normal,
    jet_moved_back,
    planar_edge_normal,
    vertex_point,
    vertex_record,
)
from standoff.kernels.compiler.decorators import kernel, small
from standoff.kernels.pair.switching import apex_normal, end_direction, steepest_in_sector
from standoff.kernels.tolerances import BOUND_ROUNDINGS, COINCIDENT, EPS, FLAT_PART, FRONT, OPPOSITE
from standoff.kernels.values import Vector, side_of

# What normals a cone has: one, those between two faces', all square to an edge without faces, or a
# vertex's, which are found when they are asked for.
SINGLE, ARC, CIRCLE, FAN = np.int64(0), np.int64(1), np.int64(2), np.int64(3)

ANY_DIRECTION = (1.0, 0.0, 0.0)  # in the plane of planar bodies too


@small
def nearer(n, a, b):
    """Of two unit vectors the one nearer to n."""
    return a if dot(n, a) > dot(n, b) else b


@small
def square_to(n, t):
    """A vector near n and perpendicular to the unit vector t, to a few roundings: n less its part
    along t.

    Its roundoff is eps whatever its length is, so it is made a unit vector only where it is long. A
    short one is roundoff where n lies along t, and as a unit vector would point anywhere. Unscaled,
    it still gives a bound: a normal cone also contains the zero vector and every shorter one.
    """
    flat = axpy(-dot(n, t), t, n)
    return unit(flat) if dot(flat, flat) > FLAT_PART else flat


@small
def turns_within(flat, axis, a, b):
    """Does a vector square to `axis` turn from a towards b and not past it?"""
    return dot(cross(a, flat), axis) >= 0.0 and dot(cross(flat, b), axis) >= 0.0


@kernel
def between(n, a, b):
    """A vector of the cone spanned by unit vectors a and b: the nearest to n where n is near it.

    a x b keeps a direction good to eps / |a x b|. What that does to n less its part along it is a
    few roundings, as long as that part (a sine) is no longer than a x b itself. Where it is longer,
    a or b bounds. That the turn from a and towards b is tested with roundoff lets a vector past
    either by an angle of a few roundings.
    """
    axis = cross(a, b)
    square, along = dot(axis, axis), dot(n, axis)
    if square < EPS or abs(along) > square:
        return nearer(n, a, b)
    flat = axpy(-along / square, axis, n)
    if turns_within(flat, axis, a, b):
        return unit(flat) if dot(flat, flat) > FLAT_PART else flat
    return nearer(n, a, b)


class NormalCone(NamedTuple):
    """The unit outward normals at a witness point, in its body's frame."""

    kind: int
    first: Vector  # the only one, or the first face's of an edge
    last: Vector  # the other face's
    tangent: Vector  # of an edge
    noise: float  # bound on what roundoff turns a face's normal by (chord)


@kernel
def edge_cone(ints, reals, feature, t, tangent):
    """The normal cone at an edge's point with the unit tangent given."""
    e = edge_record(ints, feature)
    if ints[L.DIMENSION] == 2:
        normal = planar_edge_normal(ints, feature, tangent)
        return NormalCone(SINGLE, normal, normal, tangent, 0.0)
    if ints[e + L.EDGE_COEDGE_0] < 0:
        return NormalCone(CIRCLE, ZERO, ZERO, tangent, 0.0)
    _, a, noise_a = coedge_conormal(ints, reals, ints[e + L.EDGE_COEDGE_0], tangent, t)
    _, b, noise_b = coedge_conormal(ints, reals, ints[e + L.EDGE_COEDGE_1], tangent, t)
    return NormalCone(ARC, a, b, tangent, max(noise_a, noise_b))


@kernel
def normal_cone(ints, reals, side, jet):
    """The normal cone at a witness point; its jet in the body's frame."""
    dim = dimension(ints, side.feature)
    if dim == 2:
        normal, noise = face_normal(ints, reals, side, jet)
        return NormalCone(SINGLE, normal, normal, ZERO, noise)
    if dim == 1:
        return edge_cone(ints, reals, side.feature, side.p, unit(jet[1]))
    return NormalCone(FAN, ZERO, ZERO, ZERO, 0.0)


@kernel
def nearest_on_arc(cone, n):
    """`nearest_normal` of an edge with faces."""
    _, a, b, tangent, noise = cone
    flat, opening = square_to(n, tangent), cross(a, b)
    axis = tangent if dot(opening, tangent) > 0.0 else scale(-1.0, tangent)
    if noise > 0.0:
        # well within the cone the nearest normal is n less its part along the tangent, whose
        # digits are whole: the faces' normals need only be known to lie on either side
        least = min(dot(cross(a, flat), axis), dot(cross(flat, b), axis))
        if least > noise * norm(flat):
            return flat, 0.0
    else:
        # too far along the edge for `between`, which does not know the tangent?
        square = dot(opening, opening)
        far = dot(n, tangent) ** 2 > square >= EPS
        # or the rim of a plate so thin that it takes the faces' normals for one direction?
        thin = EPS > square > OPPOSITE * OPPOSITE and dot(a, b) < 0.0
        if (far or thin) and turns_within(flat, axis, a, b):
            return flat, 0.0
    return between(n, a, b), noise


@small
def nearest_known(ints, reals, feature, cone, n):
    """`nearest_normal` of a face, or of an edge with faces."""
    if cone.kind == SINGLE:
        return cone.first, cone.noise
    return nearest_on_arc(cone, n)


@small
def nearest_normal(ints, reals, feature, cone, n):
    """(vector of a normal cone as near to the unit vector n as found, bound on its roundoff).

    Any member of the cone gives a valid bound, whatever its length; the nearest the tightest. It is
    a unit vector where n is near the cone. Roundings of eps are in `lowered`.
    """
    if cone.kind == SINGLE or cone.kind == ARC:
        return nearest_known(ints, reals, feature, cone, n)
    if cone.kind == CIRCLE:
        return square_to(n, cone.tangent), 0.0
    return vertex_cone(ints, reals, feature, n), 0.0


@kernel
def behind(ints, reals, feature, n):
    """Do some points of the body lie behind the plane perpendicular to n at a vertex, as they must?

    At a smooth vertex no direction rises along the inward normal either.
    """
    x = vertex_point(ints, reals, feature)
    count = ints[L.N_SAMPLES]
    for k in range(3):
        o = ints[L.SAMPLE_REALS] + L.SAMPLE_STRIDE * (k * count // 3)
        if dot(n, sub((reals[o], reals[o + 1], reals[o + 2]), x)) > FRONT * reals[L.SIZE]:
            return False
    return True


@kernel
def vertex_cone(ints, reals, feature, n):
    """An outward normal near n at a vertex: n itself where no direction of the fan rises.

    Zero, which bounds by the body's box alone, where it is an inward one.
    """
    r = vertex_record(ints, feature)
    fan, n_fan = ints[r + L.VERTEX_FAN], ints[r + L.VERTEX_N_FAN]
    worst, at = 0.0, -1
    direction = (0.0, 0.0, 0.0)
    for k in range(n_fan):
        t = end_direction(ints, reals, ints[L.N_FACES] + ints[fan + 2 * k], ints[fan + 2 * k + 1])
        if dot(n, t) > worst:
            worst, at, direction = dot(n, t), k, t
    best = n
    for k in range(ints[r + L.VERTEX_N_SECTORS]):
        sector = ints[r + L.VERTEX_SECTORS] + 2 * k
        slope, angle = steepest_in_sector(ints, reals, sector, n)
        if -slope > worst:
            worst, at = -slope, n_fan + k
            o = ints[sector + 1]
            chart = ints[sector]
            if reals[o] == L.SECTOR_APEX:
                best = apex_normal(ints, reals, sector, angle)
            else:
                best = chart_normal(ints, reals, chart, reals[o + 1], reals[o + 2])
    if at < 0:
        return n if behind(ints, reals, feature, n) else ZERO
    cone, count = ints[r + L.VERTEX_CONE], ints[r + L.VERTEX_N_CONE]
    if count == 0:
        if at < n_fan:  # a faceless end: its cone is the half-space of the edge's direction
            return square_to(n, direction)
        return best
    best_match = dot(n, best) if at >= n_fan else -inf
    for k in range(count):
        i, j = cone + 3 * k, cone + 3 * ((k + 1) % count)
        a = (reals[i], reals[i + 1], reals[i + 2])
        b = (reals[j], reals[j + 1], reals[j + 2])
        m = between(n, a, b)
        if dot(n, m) > best_match:
            best, best_match = m, dot(n, m)
    return best


@small
def overhang(ints, reals, x, e, noise):
    """A bound on e.(y - x) over the points y of the body: the support of its box.

    e is the small difference between a plane's normal and a normal of the body at x, and known
    but for a vector of the length `noise`.
    """
    if e[0] == 0.0 and e[1] == 0.0 and e[2] == 0.0 and noise == 0.0:
        return 0.0
    if ints[L.UNBOUNDED]:
        return inf
    total, reach = 0.0, 0.0
    for i in range(3):
        way = reals[L.BOX_CENTRE + i] - x[i]
        total += e[i] * way + abs(e[i]) * reals[L.BOX_HALF + i]
        reach += abs(way) + reals[L.BOX_HALF + i]
    return max(total, 0.0) + noise * reach


@small
def into_b(R, n):
    """A direction of A's frame seen from B, reversed: what is outward there."""
    return scale(-1.0, rotate_back(R, n))


class Cones(NamedTuple):
    """What the certificate asks of a pair's witness points."""

    a: NormalCone  # in A's frame
    b: NormalCone  # in B's
    x_a: Vector  # A's point
    y_b: Vector  # B's, in B's frame
    gap: Vector  # x_b - x_a, in A's frame


@kernel
def cones_at(pair, pose, place, jets):
    """The normal cones at both witness points, from the jets there."""
    jet_a, jet_b = jets
    own = jet_moved_back(pose, jet_b)
    return Cones(
        normal_cone(pair.ints_a, pair.reals_a, side_of(place, 0), jet_a),
        normal_cone(pair.ints_b, pair.reals_b, side_of(place, 1), own),
        jet_a[0],
        own[0],
        sub(jet_b[0], jet_a[0]),
    )


@small
def over_a(pair, cones, e, noise):
    """`overhang` of A from its witness point."""
    return overhang(pair.ints_a, pair.reals_a, cones.x_a, e, noise)


@small
def over_b(pair, cones, e, noise):
    """`overhang` of B from its witness point, in B's frame."""
    return overhang(pair.ints_b, pair.reals_b, cones.y_b, e, noise)


@small
def hangs_over_a(nearest, pair, place, cones, n):
    """(what hangs over A's side of the plane square to n, what roundoff may add)."""
    cone, miss = nearest(pair.ints_a, pair.reals_a, place.feature_a, cones.a, n)
    return over_a(pair, cones, sub(n, cone), miss), over_a(pair, cones, ZERO, miss)


@small
def hangs_over_b(nearest, pair, pose, place, cones, n):
    """`hangs_over_a` of B."""
    m = into_b(pose.R, n)
    cone, miss = nearest(pair.ints_b, pair.reals_b, place.feature_b, cones.b, m)
    return over_b(pair, cones, sub(m, cone), miss), over_b(pair, cones, ZERO, miss)


@small
def lowered(pair, pose, cones, bound):
    """A bound less both bodies' slack and what roundoff may have added to it.

    The bound is n.gap less what hangs over, of any n that is a unit vector to a rounding. In units
    of eps and of `reach`, the sum of all lengths that take part: each witness point has 3 from its
    surface's sums (those of a NURBS are convex combinations) and 4 from the pose; n's length and
    the product n.gap have 3; a member of a normal cone may be off the cone by 3, over which the
    body reaches at most its size; the support of the box has 3. As each length is in one of them
    only, BOUND_ROUNDINGS = 16 is more than all. The coordinates' taxicab lengths are at least their
    lengths, and cost no roots.
    """
    x_b = add(cones.x_a, cones.gap)
    reach = pair.reals_a[L.SIZE] + pair.reals_b[L.SIZE]
    reach += taxicab(cones.x_a) + taxicab(x_b) + taxicab(cones.y_b) + taxicab(pose.p)
    slack = pair.reals_a[L.SLACK] + pair.reals_b[L.SLACK]
    return bound - slack - BOUND_ROUNDINGS * EPS * reach


@kernel
def certify_along(pair, pose, place, jets, n):
    """(lower bound of the cores' signed distance from the plane square to n alone, blur).

    It holds in penetration too, where it is negative. n must be the plane's own normal where one
    body is a half-space: nothing hangs over that one. jets: those of the witness points.
    """
    cones = cones_at(pair, pose, place, jets)
    bound, blur = dot(n, cones.gap), 0.0
    if not pair.ints_a[L.UNBOUNDED]:
        hangs, miss = hangs_over_a(nearest_normal, pair, place, cones, n)
        bound -= hangs
        blur += miss
    if not pair.ints_b[L.UNBOUNDED]:
        hangs, miss = hangs_over_b(nearest_normal, pair, pose, place, cones, n)
        bound -= hangs
        blur += miss
    return lowered(pair, pose, cones, bound), blur


@kernel
def certify(pair, pose, place, jets, hint):
    """(distance of the cores, lower bound of it, best plane normal, blur) at witness points.

    The blur (length) is what roundoff in the bodies' own normals may take from the bound.

    jets: those of the witness points, in A's frame. The normal is the one of the candidates n_A,
    -n_B, the direction of x_b - x_a and the unit vector `hint` (zero: none) that gives the greatest
    bound: near contact the direction loses its digits.
    """
    cones = cones_at(pair, pose, place, jets)
    return certify_by(nearest_normal, pair, pose, place, cones, hint)


@small
def certify_cones(pair, pose, place, cones, hint):
    """`certify`, by the normal cones at witness points on faces, or on edges with faces.

    A compiler is not given the other cones: one for a GPU works on all before it leaves them out.
    """
    return certify_by(nearest_known, pair, pose, place, cones, hint)


@small
def certify_by(nearest, pair, pose, place, cones, hint):
    """`certify`, by the normal cones and a function that finds their vectors."""
    gap = cones.gap
    d = norm(gap)
    # bodies that may overlap are bounded by unit vectors only: by any, where points coincide
    direction = scale(1.0 / d, gap) if d > COINCIDENT else ANY_DIRECTION
    m_b = into_b(pose.R, direction)
    n_a, noise_a = nearest(pair.ints_a, pair.reals_a, place.feature_a, cones.a, direction)
    n_b, noise_b = nearest(pair.ints_b, pair.reals_b, place.feature_b, cones.b, m_b)
    hangs_a = over_a(pair, cones, sub(direction, n_a), noise_a)
    hangs_b = over_b(pair, cones, sub(m_b, n_b), noise_b)
    blur_a, blur_b = over_a(pair, cones, ZERO, noise_a), over_b(pair, cones, ZERO, noise_b)
    along = d if d > COINCIDENT else dot(direction, gap)
    best, normal = along - hangs_a - hangs_b, direction
    if dot(hint, hint) > 0.5:
        bound = dot(hint, gap) - hangs_over_a(nearest, pair, place, cones, hint)[0]
        bound -= hangs_over_b(nearest, pair, pose, place, cones, hint)[0]
        if bound > best:
            best, normal = bound, hint
    # A's own normal: nothing hangs over at A. A zero normal (collapsed chart) bounds nothing.
    if dot(n_a, n_a) > 0.5:
        bound = dot(n_a, gap) - hangs_over_b(nearest, pair, pose, place, cones, n_a)[0] - blur_a
        if bound > best:
            best, normal = bound, n_a
    if dot(n_b, n_b) > 0.5:
        n = scale(-1.0, rotate(pose.R, n_b))
        bound = dot(n, gap) - hangs_over_a(nearest, pair, place, cones, n)[0] - blur_b
        if bound > best:
            best, normal = bound, n
    return d, lowered(pair, pose, cones, best), normal, blur_a + blur_b
