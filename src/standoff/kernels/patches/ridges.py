"""Where an edge of one body is nearest to a curved face of the other, measured along the normal."""

from standoff.kernels.algebra.vectors import add, cross, dot, rotate, unit
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_jet, chart_record, edge_jet
from standoff.kernels.body.trimming import on_face
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.patches.over import Over, hit, nothing
from standoff.kernels.patches.rims import node_at
from standoff.kernels.patches.seen import (
    CHART,
    EDGE,
    FACE_REALS,
    FIRST,
    LAST,
    U,
    V,
    laid,
    placed,
)
from standoff.kernels.patches.tolerances import SPOT_STEPS


@kernel
def solved(c0, c1, c2, r):
    """(solution, can it be solved) of three equations by their columns."""
    c12 = cross(c1, c2)
    det = dot(c0, c12)
    if det == 0.0:
        return (0.0, 0.0, 0.0), False
    u, v, w = dot(r, c12) / det, dot(r, cross(c2, c0)) / det, dot(r, cross(c0, c1)) / det
    return (u, v, w), True


@kernel
def step_to_ridge(own, other, feature, t, chart, u, v):
    """(how far both points are apart across the normal, (dt, du, dv), can it be solved): a step of
    Newton's method towards where the edge is seen along the face's tangent plane."""
    x, xt, xtt = edge_jet(own.ints, own.reals, feature, t)
    x, xt, xtt = placed(own, x), rotate(own.pose.R, xt), rotate(own.pose.R, xtt)
    y, yu, yv, yuu, yuv, yvv = chart_jet(other.ints, other.reals, chart, u, v)
    R = other.pose.R
    y, yu, yv = placed(other, y), rotate(R, yu), rotate(R, yv)
    yuu, yuv, yvv = rotate(R, yuu), rotate(R, yuv), rotate(R, yvv)
    m = cross(yu, yv)
    mu, mv = add(cross(yuu, yv), cross(yu, yuv)), add(cross(yuv, yv), cross(yu, yvv))
    # laid from each body's own witness point, as all places are
    ax, ay, _ = laid(own, x)
    bx, by, _ = laid(other, y)
    ct = (-dot(xt, own.e), -dot(xt, own.f), dot(m, xtt))
    cu = (dot(yu, own.e), dot(yu, own.f), dot(mu, xt))
    cv = (dot(yv, own.e), dot(yv, own.f), dot(mv, xt))
    step, fine = solved(ct, cu, cv, (ax - bx, ay - by, -dot(m, xt)))
    return abs(ax - bx) + abs(ay - by), step, fine


@kernel
def seen_nearest(segment):
    """The parameter at which a piece, taken as straight, is seen nearest to the witness points."""
    x0, y0 = segment[FIRST + 1], segment[FIRST + 2]
    tx, ty = segment[LAST + 1] - x0, segment[LAST + 2] - y0
    square = tx * tx + ty * ty
    s = -(x0 * tx + y0 * ty) / square if square > 0.0 else 0.5
    return segment[FIRST] + min(max(s, 0.0), 1.0) * (segment[LAST] - segment[FIRST])


@kernel
def ridge(own, other, room, segment, face, near, facing):
    """(the place of a curved face, the edge's node under it) where a piece of an edge, a pointer to
    it, is nearest to the face, between its ends. `facing` as of `faces_over`."""
    ints, reals = other.ints, other.reals
    feature = int(segment[EDGE])
    low, high = min(segment[FIRST], segment[LAST]), max(segment[FIRST], segment[LAST])
    t = seen_nearest(segment)
    node = node_at(own, feature, t)
    o = FACE_REALS * face
    given = int(room.faces[o + CHART]), room.faces[o + U], room.faces[o + V]
    found, chart, u, v, _ = hit(other, given[0], given[1], given[2], node[1], node[2], near)
    if not found:
        return nothing(), node
    span, found = high - low, False
    for _ in range(SPOT_STEPS):
        off, step, fine = step_to_ridge(own, other, feature, t, chart, u, v)
        if not fine:
            return nothing(), node
        t, u, v = t + step[0], u + step[1], v + step[2]
        if t < low - span or t > high + span:
            return nothing(), node
        if off <= near and abs(step[0]) <= near * span:
            found = True
            break
    spare = near * span
    if not found or t < low - spare or t > high + spare or not on_face(ints, reals, chart, u, v):
        return nothing(), node
    node = node_at(own, feature, t)
    jet = chart_jet(ints, reals, chart, u, v)
    side = reals[ints[chart_record(ints, chart) + L.CHART_REALS] + L.OUTWARD]
    y, normal = placed(other, jet[0]), rotate(other.pose.R, unit(cross(jet[1], jet[2])))
    if side * dot(normal, other.up) <= facing:
        return nothing(), node
    return Over(True, laid(other, y)[2], 0.0, y, -1, chart, u, v), node
