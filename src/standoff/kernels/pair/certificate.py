"""The certificate: a lower bound of the true distance from supporting planes."""

from math import inf

from standoff.kernels.algebra.vectors import (
    axpy,
    cross,
    dot,
    norm,
    rotate,
    rotate_back,
    scale,
    sub,
    unit,
)
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    ZERO,
    chart_normal,
    coedge_conormal,
    dimension,
    edge_jet,
    edge_record,
    noisy_normal,
    planar_edge_normal,
    vertex_point,
    vertex_record,
)
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.pair.switching import apex_normal, end_direction, steepest_in_sector
from standoff.kernels.tolerances import BOUND_ROUNDINGS, EPS, FRONT
from standoff.kernels.values import side_of


@kernel
def between(n, a, b):
    """The unit vector of the cone spanned by unit vectors a and b that is nearest to n."""
    axis = cross(a, b)
    if dot(axis, axis) < EPS:
        return a if dot(n, a) > dot(n, b) else b
    flat = axpy(-dot(n, axis) / dot(axis, axis), axis, n)
    # inside the cone when the flat part is on the inner side of both generators
    if dot(cross(a, flat), axis) >= 0.0 and dot(cross(flat, b), axis) >= 0.0:
        return unit(flat)
    return a if dot(n, a) > dot(n, b) else b


@kernel
def edge_cone(ints, reals, feature, t, n):
    """(nearest unit outward normal to n at an edge's point, bound on its roundoff)."""
    e = edge_record(ints, feature)
    if ints[L.DIMENSION] == 2:
        return planar_edge_normal(ints, reals, feature, t), 0.0
    tangent = unit(edge_jet(ints, reals, feature, t)[1])
    if ints[e + L.EDGE_COEDGE_0] < 0:
        return unit(axpy(-dot(n, tangent), tangent, n)), 0.0
    _, a, noise_a = coedge_conormal(ints, reals, ints[e + L.EDGE_COEDGE_0], tangent, t)
    _, b, noise_b = coedge_conormal(ints, reals, ints[e + L.EDGE_COEDGE_1], tangent, t)
    noise = max(noise_a, noise_b)
    if noise > 0.0:
        # well within the cone the nearest normal is n less its part along the tangent, whose
        # digits are whole: the faces' normals need only be known to lie on either side
        flat = unit(axpy(-dot(n, tangent), tangent, n))
        axis = tangent if dot(cross(a, b), tangent) > 0.0 else scale(-1.0, tangent)
        if min(dot(cross(a, flat), axis), dot(cross(flat, b), axis)) > noise:
            return flat, 0.0
    return between(n, a, b), noise


@kernel
def behind(ints, reals, feature, n):
    """Do some points of the body lie behind the plane square to n at a vertex, as they must?

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
    """A unit outward normal near n at a vertex: n itself where no direction of the fan rises.

    Zero, which bounds nothing, where it is an inward one.
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
            return unit(axpy(-worst, direction, n))
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


@kernel
def cone_normal(ints, reals, feature, chart, p, q, n):
    """(unit vector of the normal cone at a witness point, as near to the unit vector n as found,
    bound on its roundoff).

    Any member of the cone gives a valid bound; the nearest gives the tightest.
    """
    dim = dimension(ints, feature)
    if dim == 2:
        return noisy_normal(ints, reals, chart, p, q)
    if dim == 1:
        return edge_cone(ints, reals, feature, p, n)
    return vertex_cone(ints, reals, feature, n), 0.0


@kernel
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


@kernel
def into_b(R, n):
    """A direction of A's frame seen from B, reversed: what is outward there."""
    return scale(-1.0, rotate_back(R, n))


@kernel
def cone_of_a(pair, place, n):
    """`cone_normal` of A at its witness point."""
    a = side_of(place, 0)
    return cone_normal(pair.ints_a, pair.reals_a, a.feature, a.chart, a.p, a.q, n)


@kernel
def cone_of_b(pair, place, m):
    """`cone_normal` of B at its witness point, in B's frame."""
    b = side_of(place, 1)
    return cone_normal(pair.ints_b, pair.reals_b, b.feature, b.chart, b.p, b.q, m)


@kernel
def plane_bound(pair, pose, place, x_a, y_b, gap, n):
    """(lower bound that the unit vector n gives, what roundoff in normals takes from it).

    gap is x_b - x_a, y_b the point in B's frame. It bounds the signed distance, so it holds in
    penetration too, where it is negative.
    """
    ia, ra, ib, rb = pair
    m = into_b(pose.R, n)
    cone_a, miss_a = cone_of_a(pair, place, n)
    cone_b, miss_b = cone_of_b(pair, place, m)
    bound = dot(n, gap) - overhang(ia, ra, x_a, sub(n, cone_a), miss_a)
    blur = overhang(ia, ra, x_a, ZERO, miss_a) + overhang(ib, rb, y_b, ZERO, miss_b)
    return bound - overhang(ib, rb, y_b, sub(m, cone_b), miss_b), blur


@kernel
def bound_roundoff(pair, pose, x_a, x_b, y_b):
    reach = (
        pair.reals_a[L.SIZE]
        + pair.reals_b[L.SIZE]
        + norm(x_a)
        + norm(x_b)
        + norm(y_b)
        + norm(pose.p)
    )
    return BOUND_ROUNDINGS * EPS * reach


@kernel
def certify_along(pair, pose, place, x_a, x_b, n):
    """(lower bound of the cores' signed distance from the plane square to n alone, blur).

    n must be the plane's own normal where one body is a half-space: nothing hangs over that one.
    """
    ia, ra, ib, rb = pair
    y_b = rotate_back(pose.R, sub(x_b, pose.p))
    if ia[L.UNBOUNDED] or ib[L.UNBOUNDED]:
        bound, blur = dot(n, sub(x_b, x_a)), 0.0
        if not ia[L.UNBOUNDED]:
            cone, miss = cone_of_a(pair, place, n)
            bound -= overhang(ia, ra, x_a, sub(n, cone), miss)
            blur = overhang(ia, ra, x_a, ZERO, miss)
        if not ib[L.UNBOUNDED]:
            m = into_b(pose.R, n)
            cone, miss = cone_of_b(pair, place, m)
            bound -= overhang(ib, rb, y_b, sub(m, cone), miss)
            blur = overhang(ib, rb, y_b, ZERO, miss)
        slack = ra[L.SLACK] + rb[L.SLACK]
        return bound - slack - bound_roundoff(pair, pose, x_a, x_b, y_b), blur
    bound, blur = plane_bound(pair, pose, place, x_a, y_b, sub(x_b, x_a), n)
    slack = pair.reals_a[L.SLACK] + pair.reals_b[L.SLACK]
    return bound - slack - bound_roundoff(pair, pose, x_a, x_b, y_b), blur


@kernel
def certify(pair, pose, place, x_a, x_b, hint):
    """(distance of the cores, lower bound of it, best plane normal, blur) at witness points.

    The blur (length) is what roundoff in the bodies' own normals may take from the bound.

    x_a and x_b in A's frame. The normal is the one of the candidates n_A, -n_B, the direction of
    x_b - x_a and the unit vector `hint` (zero: none) that gives the greatest bound: near contact
    the direction loses its digits.
    """
    ia, ra, ib, rb = pair
    gap = sub(x_b, x_a)
    d = norm(gap)
    direction = unit(gap)
    y_b = rotate_back(pose.R, sub(x_b, pose.p))
    m_b = into_b(pose.R, direction)
    n_a, noise_a = cone_of_a(pair, place, direction)
    n_b, noise_b = cone_of_b(pair, place, m_b)
    over_a = overhang(ia, ra, x_a, sub(direction, n_a), noise_a)
    over_b = overhang(ib, rb, y_b, sub(m_b, n_b), noise_b)
    best, normal = d - over_a - over_b, direction
    if dot(hint, hint) > 0.5:
        bound, _ = plane_bound(pair, pose, place, x_a, y_b, gap, hint)
        if bound > best:
            best, normal = bound, hint
    # A's own normal: nothing hangs over at A. A zero normal (collapsed chart) bounds nothing.
    if dot(n_a, n_a) > 0.5:
        m = into_b(pose.R, n_a)
        cone, miss = cone_of_b(pair, place, m)
        bound = dot(n_a, gap) - overhang(ib, rb, y_b, sub(m, cone), miss)
        bound -= overhang(ia, ra, x_a, ZERO, noise_a)
        if bound > best:
            best, normal = bound, n_a
    if dot(n_b, n_b) > 0.5:
        n = scale(-1.0, rotate(pose.R, n_b))
        cone, miss = cone_of_a(pair, place, n)
        bound = dot(n, gap) - overhang(ia, ra, x_a, sub(n, cone), miss)
        bound -= overhang(ib, rb, y_b, ZERO, noise_b)
        if bound > best:
            best, normal = bound, n
    best -= ra[L.SLACK] + rb[L.SLACK] + bound_roundoff(pair, pose, x_a, x_b, y_b)
    blur = overhang(ia, ra, x_a, ZERO, noise_a) + overhang(ib, rb, y_b, ZERO, noise_b)
    return d, best, normal, blur
