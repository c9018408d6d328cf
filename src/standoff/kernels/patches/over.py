"""What of a body lies over a place, along the normal: a face, or beside none an edge."""

from math import inf
from typing import Any, NamedTuple

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import cross, dot, rotate, unit
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import best_chart, chart_jet, chart_record, edge_record
from standoff.kernels.body.trimming import on_face
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.patches.rims import node_at
from standoff.kernels.patches.seen import (
    ACROSS_E,
    ACROSS_F,
    BELOW,
    CHART,
    EDGE,
    FACE_REALS,
    FIRST,
    LAST,
    NEAR,
    SEGMENT_REALS,
    U,
    V,
    edge_place,
    laid,
    placed,
)
from standoff.kernels.patches.tolerances import SPOT_STEPS


class Over(NamedTuple):
    """A place of a body: how far below its supporting plane, and how far aside."""

    found: bool
    below: float
    aside: float
    x: Any  # A's frame
    feature: int  # an edge, or -1
    chart: int
    u: float  # of the chart, or of the edge
    v: float


@kernel
def nothing():
    return Over(False, inf, inf, (0.0, 0.0, 0.0), -1, -1, 0.0, 0.0)


@kernel
def hit(seen, chart, u, v, ex, fx, near):
    """(found, chart, u, v, point) of the place of a face that is seen at (ex, fx) to within `near`,
    from parameters near it; its sides are not looked at."""
    ints, reals = seen.ints, seen.reals
    x = seen.base
    for _ in range(SPOT_STEPS):
        jet = chart_jet(ints, reals, chart, u, v)
        x = placed(seen, jet[0])
        ax, ay, _ = laid(seen, x)
        if abs(ax - ex) + abs(ay - fx) <= near:
            return True, chart, u, v, x
        xu, xv = rotate(seen.pose.R, jet[1]), rotate(seen.pose.R, jet[2])
        a, b, c, d = dot(xu, seen.e), dot(xv, seen.e), dot(xu, seen.f), dot(xv, seen.f)
        det = a * d - b * c
        if det == 0.0:
            break
        u += ((ex - ax) * d - b * (fx - ay)) / det
        v += (a * (fx - ay) - c * (ex - ax)) / det
        limit = reals[ints[chart_record(ints, chart) + L.CHART_REALS] + L.LIMIT]
        if abs(u) > limit or abs(v) > limit:
            chart, u, v = best_chart(ints, reals, chart, chart_jet(ints, reals, chart, u, v)[0])
    return False, chart, u, v, x


@kernel
def faces_over(seen, room, ex, fx, within, near, facing):
    """The near face that is seen at (ex, fx) from outside, at most `within` below, whose normal's
    cosine with the direction is above `facing`."""
    ints, reals = seen.ints, seen.reals
    best = nothing()
    for face in range(ints[L.N_FACES]):
        o = FACE_REALS * face
        if room.faces[o + NEAR] == 0.0:
            continue
        given = int(room.faces[o + CHART]), room.faces[o + U], room.faces[o + V]
        found, chart, u, v, x = hit(seen, given[0], given[1], given[2], ex, fx, near)
        below = laid(seen, x)[2]
        if not found or below > within or below >= best.below:
            continue
        jet = chart_jet(ints, reals, chart, u, v)
        side = reals[ints[chart_record(ints, chart) + L.CHART_REALS] + L.OUTWARD]
        normal = rotate(seen.pose.R, unit(cross(jet[1], jet[2])))
        if side * dot(normal, seen.up) > facing and on_face(ints, reals, chart, u, v):
            best = Over(True, below, 0.0, x, -1, chart, u, v)
    return best


@kernel
def nearest_part(room, ex, fx, near):
    """(which piece, how far along it) is seen nearest to (ex, fx), between its ends; -1: none."""
    least, at, share = inf, -1, 0.0
    for k in range(room.counts[0]):
        o = SEGMENT_REALS * k
        x0, y0 = room.segments[o + FIRST + ACROSS_E], room.segments[o + FIRST + ACROSS_F]
        tx = room.segments[o + LAST + ACROSS_E] - x0
        ty = room.segments[o + LAST + ACROSS_F] - y0
        square = tx * tx + ty * ty
        if square <= near * near:
            continue
        s = ((ex - x0) * tx + (fx - y0) * ty) / square
        spare = near / sqrt(square)
        if s < -spare or s > 1.0 + spare:
            continue
        s = min(max(s, 0.0), 1.0)
        dx, dy = ex - x0 - s * tx, fx - y0 - s * ty
        away = dx * dx + dy * dy
        if away < least:
            least, at, share = away, k, s
    return at, share


@kernel
def edges_over(seen, room, ex, fx, near):
    """The place of the near edges that is seen nearest to (ex, fx), but for their ends."""
    at, share = nearest_part(room, ex, fx, near)
    if at < 0:
        return nothing()
    o = SEGMENT_REALS * at
    feature = int(room.segments[o + EDGE])
    t0, t1 = room.segments[o + FIRST], room.segments[o + LAST]
    t = t0 + share * (t1 - t0)
    if seen.ints[edge_record(seen.ints, feature) + L.EDGE_KIND] != L.LINE:
        for _ in range(SPOT_STEPS):
            _, ax, ay, _ = node_at(seen, feature, t)
            _, tangent = edge_place(seen, feature, t)
            tx, ty = dot(tangent, seen.e), dot(tangent, seen.f)
            step = ((ex - ax) * tx + (fx - ay) * ty) / (tx * tx + ty * ty)
            t = min(max(t + step, min(t0, t1)), max(t0, t1))
    node = node_at(seen, feature, t)
    dx, dy = ex - node[ACROSS_E], fx - node[ACROSS_F]
    x, _ = edge_place(seen, feature, t)
    return Over(True, node[BELOW], sqrt(dx * dx + dy * dy), x, feature, -1, t, 0.0)
