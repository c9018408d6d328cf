"""A compiled loop that queries the certificate at any place and along any direction.

The kernels that compute bounds and statuses are called directly: no search has brought the witness
points there. A row of uniform numbers selects the features, places on them, and the direction.
"""

from math import inf

from standoff.kernels.algebra.rigid import relative_pose
from standoff.kernels.algebra.vectors import axpy, cross, dot, scale, sub, unit
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    chart_record,
    coedge_parameters,
    coedge_record,
    dimension,
    edge_record,
    pair_span,
)
from standoff.kernels.compiler.decorators import pointer
from standoff.kernels.depth.penetration import plane_normal
from standoff.kernels.frame.answer import judge
from standoff.kernels.pair.certificate import certify, certify_along, cones_at, nearest_normal
from standoff.kernels.pair.certified import UNCERTIFIED, on_feature, weigh
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.values import Found, Pair, Side, together
from standoff_studies.own_kernels import own_kernel

PER_SIDE = 8
"""Uniform numbers used by a side."""

PER_HINT = 7
"""Uniform numbers used by a direction."""

N_DRAWN = 2 * PER_SIDE + PER_HINT + 5
"""Uniform numbers of a case."""

D, LOWER, NORMAL, BLUR, OUTCOME, ON, PLACE, HINT, HOW, STATUS = 0, 1, 2, 5, 6, 7, 8, 16, 19, 20
TOLERANCE, LENIENT, CUT, SPAN, NEAREST, DIMENSIONS, N_ASKED = 21, 22, 23, 24, 25, 26, 27
"""Columns of an answer: distance of the points (cores), lower bound, normal (A's frame), blur,
outcome, whether both points lie on their features, the place (8), the direction given, what it was
made of and which kernel was asked, the status with the tolerance and the flags it was asked with,
the pair's span, by how much a cone's nearest normal misses the cone, and the dimensions of the two
features as 10 a + b."""

ALONG = 100.0
"""Added to HOW where `certify_along` was asked, not `weigh`, which asks `certify`."""

LEAST_POWER = 16.0
"""Small angles and parts go down to 1e-16, with equal shares of each order of magnitude."""

ULP = 2.220446049250313e-16


@own_kernel
def part_of(x):
    """A fraction of a range, 0 to 1: often an end, exactly or nearly."""
    if x < 0.12:
        return 0.0
    if x < 0.24:
        return 1.0
    if x < 0.3:
        return 0.5
    if x < 0.45:
        return 10.0 ** (-LEAST_POWER * (x - 0.3) / 0.15)
    if x < 0.6:
        return 1.0 - 10.0 ** (-LEAST_POWER * (x - 0.45) / 0.15)
    return (x - 0.6) / 0.4


@own_kernel
def beside(w, x):
    """A fraction, sometimes outside its range by roundoff, as after a step of a search."""
    if x < 0.9:
        return w
    outside = 10.0 ** (-12.0 - 8.0 * (x - 0.9) / 0.1)
    return -outside if w < 0.5 else 1.0 + outside


@own_kernel
def on_boundary(ints, reals, chart, x, y):
    """A point (u, v) on a chart's trimming loop; the chart's middle if there is none."""
    r = chart_record(ints, chart)
    count = ints[r + L.CHART_N_COEDGES]
    if count == 0:
        return 0.0, 0.0
    k = ints[r + L.CHART_COEDGE] + min(int(x * count), count - 1)
    o = ints[coedge_record(ints, k) + L.COEDGE_REALS]
    t0, t1 = reals[o + L.PCURVE_FIRST], reals[o + L.PCURVE_LAST]
    w = part_of(y)
    u, v, _, _, _ = coedge_parameters(ints, reals, k, t0 + w * (t1 - t0) if w < 1.0 else t1)
    return u, v


@own_kernel
def any_side(ints, reals, drawn):
    """A feature of a body and parameters on it, or, sometimes, next to it."""
    counts = (ints[L.N_FACES], ints[L.N_EDGES], ints[L.N_VERTICES])
    kinds = (counts[0] > 0) + (counts[1] > 0) + (counts[2] > 0)
    which = min(int(drawn[0] * kinds), kinds - 1)
    kind = 0
    for k in range(3):
        if counts[k] > 0:
            if which == 0:
                kind = k
            which -= 1
    index = min(int(drawn[1] * counts[kind]), counts[kind] - 1)
    if kind == 2:
        return Side(counts[0] + counts[1] + index, -1, 0.0, 0.0)
    if kind == 1:
        feature = counts[0] + index
        o = ints[edge_record(ints, feature) + L.EDGE_REALS]
        t0, t1 = reals[o + L.EDGE_T0], reals[o + L.EDGE_T1]
        w = part_of(drawn[2])
        return Side(feature, -1, t0 + w * (t1 - t0) if w < 1.0 else t1, 0.0)
    f = ints[L.FACES] + L.FACE_STRIDE * index
    chart = ints[f] + min(int(drawn[2] * ints[f + 1]), ints[f + 1] - 1)
    o = ints[chart_record(ints, chart) + L.CHART_REALS]
    limit = reals[o + L.LIMIT]
    if limit < inf and (drawn[3] < 0.5 or ints[chart_record(ints, chart) + L.CHART_N_COEDGES] == 0):
        u, v = 2.0 * part_of(drawn[4]) - 1.0, 2.0 * part_of(drawn[5]) - 1.0
        return Side(index, chart, u * limit, v * limit)
    u, v = on_boundary(ints, reals, chart, drawn[4], drawn[5])
    x, y = on_boundary(ints, reals, chart, drawn[6], drawn[7])
    w = beside(part_of((2.0 * drawn[3]) % 1.0), (100.0 * drawn[3]) % 1.0)
    return Side(index, chart, u + w * (x - u), v + w * (y - v))


@own_kernel
def on_sphere(x, y):
    """The unit vector for two uniform numbers; often an axis."""
    if x < 0.15:
        sign = 1.0 if x < 0.075 else -1.0
        k = min(int(3.0 * y), 2)
        return (sign if k == 0 else 0.0, sign if k == 1 else 0.0, sign if k == 2 else 0.0)
    z = 2.0 * (x - 0.15) / 0.85 - 1.0
    r = max(1.0 - z * z, 0.0) ** 0.5
    # by the tangent of the half angle, without cos and sin
    t = 2.0 * y - 1.0
    return unit((r * (1.0 - t * t), r * 2.0 * t, z * (1.0 + t * t)))


@own_kernel
def turned(n, towards, angle):
    """A unit vector turned towards another by an angle (its tangent)."""
    aside = unit(axpy(-dot(n, towards), n, towards))
    return unit(axpy(angle, aside, n))


@own_kernel
def upright(jet):
    """The normal of a face's jet, an edge's tangent, zero at a vertex."""
    return unit(cross(jet[1], jet[2])) if dot(jet[2], jet[2]) > 0.0 else unit(jet[1])


@own_kernel
def made_of(what, jet_a, jet_b, known, x):
    """The vector from which a direction is made: between the points, a tangent, a normal, or one
    perpendicular to two."""
    gap = unit(sub(jet_b[0], jet_a[0]))
    if what == 1:
        return gap
    if what == 2 or what == 3:
        return unit(jet_a[1] if what == 2 else jet_b[1])
    if what == 4 or what == 5:
        return upright(jet_a if what == 4 else jet_b)
    if what == 6:
        return known
    if what == 7:
        return unit(cross(jet_a[1], jet_b[1]))
    return unit(cross(gap, jet_b[1] if x < 0.5 else jet_a[1]))


@own_kernel
def some_direction(jets, known, drawn):
    """(what it was made from, a direction): random, or along, perpendicular to or near the vector.

    `known`: the normal by which the pair was built.
    """
    what = min(int(drawn[0] * 10.0), 9)
    n = made_of(what, jets[0], jets[1], known, drawn[2])
    if what == 0 or what == 9 or dot(n, n) < 0.5:
        what, n = 0, on_sphere(drawn[1], drawn[2])
    if drawn[3] < 0.6:
        angle = 10.0 ** (1.0 - (LEAST_POWER + 1.0) * drawn[3] / 0.6)
        n = turned(n, on_sphere(drawn[4], drawn[1]), angle)
    if drawn[5] < 0.3:
        n = scale(-1.0, n)
    if drawn[6] < 0.25:  # not of unit length, by roundoff
        n = scale(1.0 + (int(drawn[6] * 36.0) - 4) * ULP, n)
    return what, n


@own_kernel
def misses_cone(ints, reals, feature, cone, n):
    """How far the result of `nearest_normal` is from perpendicular to the edge."""
    near, _ = nearest_normal(ints, reals, feature, cone, n)
    if dimension(ints, feature) != 1 or dot(near, near) < 0.5:
        return 0.0
    return abs(dot(near, cone.tangent))


@own_kernel
def ask(ints_a, reals_a, ints_b, reals_b, motion, known, drawn, asked):
    """Query the certificate in every case of `drawn` (n, N_DRAWN), into `asked` (n, N_ASKED).

    motion: poses of both as the kernels read them; known (3,): the normal by which the pair was
    built, in world axes.
    """
    pair = Pair(pointer(ints_a, 0), pointer(reals_a, 0), pointer(ints_b, 0), pointer(reals_b, 0))
    numbers = pointer(motion, 0)
    pose = relative_pose(pointer(motion, 0), pointer(motion, 12))
    square_to = (
        motion[0] * known[0] + motion[3] * known[1] + motion[6] * known[2],
        motion[1] * known[0] + motion[4] * known[1] + motion[7] * known[2],
        motion[2] * known[0] + motion[5] * known[1] + motion[8] * known[2],
    )
    plane, own = plane_normal(pair, pose)
    planar = ints_a[L.DIMENSION] == 2 or ints_b[L.DIMENSION] == 2
    for k in range(len(drawn)):
        row, to = drawn[k], asked[k]
        a = any_side(pair.ints_a, pair.reals_a, row)
        b = any_side(pair.ints_b, pair.reals_b, row[PER_SIDE:])
        place = together(a, b)
        jets = pair_jets(pair, pose, place)
        rest = row[2 * PER_SIDE + PER_HINT :]
        what, n = some_direction(jets, square_to, row[2 * PER_SIDE :])
        if planar:  # everything of a planar pair is in its plane
            n = unit((n[0], n[1], 0.0)) if n[0] != 0.0 or n[1] != 0.0 else (1.0, 0.0, 0.0)
        how = float(what)
        tolerance = inf if rest[0] < 0.1 else 10.0 ** (-11.0 + 7.0 * rest[1])
        on = on_feature(pair, place)
        along = rest[2] < 0.35
        if along:
            n = own if plane else n
            lower, blur = certify_along(pair, pose, place, jets, n)
            d = dot(n, sub(jets[1][0], jets[0][0]))
            normal, how, outcome, status = n, how + ALONG, UNCERTIFIED, -1
        else:
            if rest[2] < 0.5:
                n = (0.0, 0.0, 0.0)
            elif rest[2] < 0.55:
                n = scale(0.5 * 10.0 ** (-300.0 * rest[1]), n)  # no direction, but not quite 0
            _, _, _, blur = certify(pair, pose, place, jets, n)
            outcome, d, lower, normal = weigh(pair, pose, place, jets, n, tolerance)
            found = Found(outcome, place, d, lower, d, normal)
            status = judge(pair, pose.p, found, rest[3] < 0.5, tolerance, rest[4] < 0.2)
        cones = cones_at(pair, pose, place, jets)
        missed = misses_cone(pair.ints_a, pair.reals_a, a.feature, cones.a, n)
        to[D], to[LOWER], to[BLUR], to[OUTCOME] = d, lower, blur, outcome
        to[ON] = 1.0 if on else 0.0
        to[PLACE], to[PLACE + 1], to[PLACE + 2], to[PLACE + 3] = a.feature, a.chart, a.p, a.q
        to[PLACE + 4], to[PLACE + 5], to[PLACE + 6], to[PLACE + 7] = b.feature, b.chart, b.p, b.q
        for i in range(3):
            to[NORMAL + i], to[HINT + i] = normal[i], n[i]
        to[HOW], to[STATUS], to[TOLERANCE] = how, status, tolerance
        to[LENIENT], to[CUT] = 1.0 if rest[3] < 0.5 else 0.0, 1.0 if rest[4] < 0.2 else 0.0
        to[SPAN], to[NEAREST] = pair_span(pair, pose.p, abs(d)), missed
        to[DIMENSIONS] = 10.0 * dimension(pair.ints_a, a.feature) + dimension(
            pair.ints_b, b.feature
        )
    numbers[0] = motion[0]  # alive until here, see `pointer`
