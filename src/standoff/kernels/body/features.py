"""Reading a packed body: the jet, normal and neighbours of a feature.

A body in the kernels is the pair (ints, reals) of ``layout``. A *mode* of one body is
(feature, chart); the chart matters for faces only and is an absolute chart number.
"""

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import (
    active,
    add,
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
from standoff.kernels.body.jets import chart_parameters, curve_jet, pcurve_jet, surface_jet
from standoff.kernels.compiler.decorators import kernel, shared, small
from standoff.kernels.tolerances import COLLAPSED, EPS, NORMAL_NOISE, PCURVE_OVERLAP

ZERO = (0.0, 0.0, 0.0)


@kernel
def pair_span(pair, p, d):
    """The length that roundoff and tolerances are measured by: both cores' sizes, the distance, and
    how far their boxes' centres are from their own origins, which costs digits.

    p is B's origin in A's frame. A half-space has no size: the distance of the other body from its
    origin counts instead.
    """
    ra, rb = pair.reals_a, pair.reals_b
    span = ra[L.SIZE] + rb[L.SIZE] + d + ra[L.OFFSET] + rb[L.OFFSET]
    if pair.ints_a[L.UNBOUNDED] or pair.ints_b[L.UNBOUNDED]:
        span += norm(p)
    return span


@kernel
def pair_slack(pair):
    """What the certificate subtracts for both bodies, wherever the witness points are: length."""
    return pair.reals_a[L.SLACK] + pair.reals_b[L.SLACK]


noisy = small(L.noisy)
# Where the records of features stand is plain Python in `layout`, for the layers above too.
dimension = kernel(L.dimension)
chart_record = kernel(L.chart_record)
edge_record = kernel(L.edge_record)
vertex_record = kernel(L.vertex_record)
coedge_record = kernel(L.coedge_record)


@shared
def chart_jet(ints, reals, chart, u, v):
    c = chart_record(ints, chart)
    return surface_jet(reals, ints[c + L.CHART_KIND], ints[c + L.CHART_REALS], u, v)


@kernel
def edge_jet(ints, reals, feature, t):
    e = edge_record(ints, feature)
    if ints[e + L.EDGE_KIND] == L.ON_SURFACE:
        return coedge_jet(ints, reals, ints[e + L.EDGE_COEDGE_0], t)
    return curve_jet(reals, ints[e + L.EDGE_KIND], ints[e + L.EDGE_REALS] + L.CURVE_DATA, t)


@kernel
def coedge_jet(ints, reals, coedge, t):
    """Jet of the pcurve's image on its surface, by the chain rule."""
    k = best_coedge(ints, reals, coedge, t)
    c = coedge_record(ints, k)
    o = ints[c + L.COEDGE_REALS] + L.PCURVE_DATA
    h, ht, htt = pcurve_jet(reals, ints[c + L.COEDGE_KIND], o, t)
    u, v = h[0] / h[2], h[1] / h[2]
    ut, vt = (ht[0] - u * ht[2]) / h[2], (ht[1] - v * ht[2]) / h[2]
    utt = (htt[0] - 2.0 * ut * ht[2] - u * htt[2]) / h[2]
    vtt = (htt[1] - 2.0 * vt * ht[2] - v * htt[2]) / h[2]
    x, xu, xv, xuu, xuv, xvv = chart_jet(ints, reals, ints[c + L.COEDGE_CHART], u, v)
    xtt = axpy(ut * ut, xuu, axpy(2.0 * ut * vt, xuv, scale(vt * vt, xvv)))
    return x, axpy(ut, xu, scale(vt, xv)), add(xtt, axpy(utt, xu, scale(vtt, xv)))


@kernel
def is_creased(ints, feature):
    """Is the curvature across an edge unbounded?"""
    return (
        dimension(ints, feature) == 1
        and ints[edge_record(ints, feature) + L.EDGE_FLAGS] & L.CREASED != 0
    )


@kernel
def vertex_point(ints, reals, feature):
    o = ints[vertex_record(ints, feature) + L.VERTEX_REALS]
    return (reals[o], reals[o + 1], reals[o + 2])


@small
def has_collapsed(reals, tangent):
    """Is a chart's tangent too short to be one?"""
    tiny = COLLAPSED * reals[L.SIZE]
    return dot(tangent, tangent) <= tiny * tiny


@kernel
def feature_jet(ints, reals, feature, chart, p, q):
    """Jet of any feature at its parameters (p, q); columns that it lacks are zero."""
    dim = dimension(ints, feature)
    if dim == 2:
        x, xu, xv, xuu, xuv, xvv = chart_jet(ints, reals, chart, p, q)
        if has_collapsed(reals, xu):
            return x, ZERO, xv, ZERO, ZERO, xvv
        if has_collapsed(reals, xv):
            return x, xu, ZERO, xuu, ZERO, ZERO
        return x, xu, xv, xuu, xuv, xvv
    if dim == 1:
        x, xt, xtt = edge_jet(ints, reals, feature, p)
        return x, xt, ZERO, xtt, ZERO, ZERO
    return vertex_point(ints, reals, feature), ZERO, ZERO, ZERO, ZERO, ZERO


@kernel
def moved_jet(pose, jet):
    """The jet seen in another frame: x -> R x + p."""
    R = pose.R
    return (
        add(rotate(R, jet[0]), pose.p),
        rotate(R, jet[1]),
        rotate(R, jet[2]),
        rotate(R, jet[3]),
        rotate(R, jet[4]),
        rotate(R, jet[5]),
    )


@kernel
def jet_moved_back(pose, jet):
    """The jet that `moved_jet` has moved, up to roundoff."""
    R = pose.R
    return (
        rotate_back(R, sub(jet[0], pose.p)),
        rotate_back(R, jet[1]),
        rotate_back(R, jet[2]),
        rotate_back(R, jet[3]),
        rotate_back(R, jet[4]),
        rotate_back(R, jet[5]),
    )


@kernel
def chart_normal(ints, reals, chart, u, v):
    """Outward unit normal; zero where the chart has collapsed."""
    jet = chart_jet(ints, reals, chart, u, v)
    o = ints[chart_record(ints, chart) + L.CHART_REALS]
    return scale(reals[o + L.OUTWARD], unit(cross(jet[1], jet[2])))


@small
def normal_noise(kind, reals, jet):
    """A bound on how far (chord of the unit sphere, at most 2) roundoff turns the chart's normal.

    Beside a collapsed side one tangent is a small difference of greater numbers: its direction
    loses its digits, and its roundoff is that of the mixed derivative times a parameter's. A point
    past the side, as far as PCURVE_OVERLAP allows, has its normal turned round.
    """
    if not noisy(kind):
        return 0.0
    uu, vv = dot(jet[1], jet[1]), dot(jet[2], jet[2])
    past = 2.0 * PCURVE_OVERLAP
    if min(uu, vv) <= past * past * dot(jet[4], jet[4]):
        return 2.0
    product = sqrt(uu * vv)
    lost = NORMAL_NOISE * EPS * (reals[L.SIZE] + norm(jet[0])) * norm(jet[4])
    return lost / product if lost < 2.0 * product else 2.0


@small
def normal_of_kind(kind, reals, o, jet):
    """(outward unit normal, bound on its roundoff) of a jet, in the body's frame, of the chart
    whose reals begin at o."""
    return outward(reals[o + L.OUTWARD], jet), normal_noise(kind, reals, jet)


@small
def outward(sign, jet):
    """The outward unit normal of a jet; the sign is its chart's."""
    return scale(sign, unit(cross(jet[1], jet[2])))


@kernel
def noisy_normal(ints, reals, chart, jet):
    """`normal_of_kind` of any chart."""
    c = chart_record(ints, chart)
    return normal_of_kind(ints[c + L.CHART_KIND], reals, ints[c + L.CHART_REALS], jet)


@kernel
def face_normal(ints, reals, side, jet):
    """`noisy_normal` at a witness point; its jet, in the body's frame, is `feature_jet`'s."""
    if active(jet[1]) == 0.0 or active(jet[2]) == 0.0:
        # left out there as collapsed; what is left of it still has a direction, of great noise
        jet = chart_jet(ints, reals, side.chart, side.p, side.q)
        if ints[chart_record(ints, side.chart) + L.CHART_KIND] == L.CONE:
            # past the apex by roundoff x_u points the other way; x_uv is one along a ruling
            jet = (jet[0], jet[4], jet[2], jet[3], jet[4], jet[5])
    return noisy_normal(ints, reals, side.chart, jet)


@kernel
def planar_edge_normal(ints, feature, tangent):
    """Outward in-plane unit normal of a planar body's edge with the unit tangent given."""
    flags = ints[edge_record(ints, feature) + L.EDGE_FLAGS]
    if flags & L.OUTWARD_RIGHT:
        return (tangent[1], -tangent[0], 0.0)
    return (-tangent[1], tangent[0], 0.0)


@kernel
def coedge_parameters(ints, reals, coedge, t):
    """(u, v, du, dv, depth) of the pcurve at t; depth <= 0 where its chart does not see it."""
    c = coedge_record(ints, coedge)
    o = ints[c + L.COEDGE_REALS] + L.PCURVE_DATA
    h, ht, _ = pcurve_jet(reals, ints[c + L.COEDGE_KIND], o, t)
    if h[2] <= 0.0:
        return 0.0, 0.0, 0.0, 0.0, h[2]
    u, v = h[0] / h[2], h[1] / h[2]
    return u, v, (ht[0] - u * ht[2]) / h[2], (ht[1] - v * ht[2]) / h[2], h[2]


@kernel
def best_coedge(ints, reals, coedge, t):
    """The coedge of the same edge and face that sees the point at t most centrally.

    A face with one chart and a plain pcurve has one coedge; in an atlas every chart that meets
    the edge has its own, and a NURBS pcurve has one for each piece.
    """
    c = coedge_record(ints, coedge)
    edge = ints[c + L.COEDGE_EDGE]
    face = ints[chart_record(ints, ints[c + L.COEDGE_CHART]) + L.CHART_FACE]
    f = ints[L.FACES] + L.FACE_STRIDE * face
    if ints[f + 1] == 1 and ints[c + L.COEDGE_KIND] != L.BEZIER:
        return coedge
    best = coedge
    best_miss, best_reach = 1e300, 1e300
    for chart in range(ints[f], ints[f] + ints[f + 1]):
        r = chart_record(ints, chart)
        first = ints[r + L.CHART_COEDGE]
        for k in range(first, first + ints[r + L.CHART_N_COEDGES]):
            row = coedge_record(ints, k)
            if ints[row + L.COEDGE_EDGE] != edge:
                continue
            miss = 0.0
            if ints[row + L.COEDGE_KIND] == L.BEZIER:
                o = ints[row + L.COEDGE_REALS]
                miss = max(max(reals[o] - t, t - reals[o + 1]), 0.0)
            u, v, _, _, depth = coedge_parameters(ints, reals, k, t)
            reach = max(abs(u), abs(v)) if ints[f + 1] > 1 else 0.0
            if depth > 0.0 and (miss < best_miss or (miss == best_miss and reach < best_reach)):
                best_miss, best_reach, best = miss, reach, k
    return best


@kernel
def best_chart(ints, reals, chart, x):
    """(chart, u, v) of the atlas's chart that sees the surface point x most centrally."""
    face = ints[chart_record(ints, chart) + L.CHART_FACE]
    f = ints[L.FACES] + L.FACE_STRIDE * face
    best, best_u, best_v, best_reach = chart, 0.0, 0.0, 1e300
    for k in range(ints[f], ints[f] + ints[f + 1]):
        r = chart_record(ints, k)
        u, v, depth = chart_parameters(reals, ints[r + L.CHART_REALS], x)
        if depth > 0.0 and max(abs(u), abs(v)) < best_reach:
            best, best_u, best_v, best_reach = k, u, v, max(abs(u), abs(v))
    return best, best_u, best_v


@small
def conormal_along(ints, reals, coedge, o, tangent, normal):
    """The inward unit conormal at a coedge of a chart whose reals begin at o, by its normal."""
    # left in (u, v) is left on the surface where f_u x f_v points outward
    side = ints[coedge_record(ints, coedge) + L.COEDGE_SIDE] * reals[o + L.OUTWARD]
    return scale(side, cross(normal, tangent))


@small
def plane_conormal(ints, reals, coedge, tangent):
    """(conormal, normal) of a plane at its coedge: one normal everywhere, and no other chart."""
    c = coedge_record(ints, coedge)
    o = ints[chart_record(ints, ints[c + L.COEDGE_CHART]) + L.CHART_REALS]
    normal, _ = normal_of_kind(L.PLANE, reals, o, surface_jet(reals, L.PLANE, o, 0.0, 0.0))
    return conormal_along(ints, reals, coedge, o, tangent, normal), normal


@kernel
def coedge_conormal(ints, reals, coedge, tangent, t):
    """(conormal, normal, noise) at edge parameter t: the inward unit conormal of the coedge's face,
    its normal there, and a bound on the roundoff of both.

    tangent is the edge's unit tangent, in the body's frame.
    """
    chart = ints[coedge_record(ints, coedge) + L.COEDGE_CHART]
    if ints[chart_record(ints, chart) + L.CHART_KIND] == L.PLANE:
        conormal, normal = plane_conormal(ints, reals, coedge, tangent)
        return conormal, normal, 0.0
    k = best_coedge(ints, reals, coedge, t)
    u, v, _, _, _ = coedge_parameters(ints, reals, k, t)
    chart = ints[coedge_record(ints, k) + L.COEDGE_CHART]
    o = ints[chart_record(ints, chart) + L.CHART_REALS]
    normal, noise = noisy_normal(ints, reals, chart, chart_jet(ints, reals, chart, u, v))
    return conormal_along(ints, reals, k, o, tangent, normal), normal, noise
