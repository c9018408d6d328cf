"""The normals of a feature: the one nearest to a direction, along which its ball reaches out."""

from standoff.kernels.algebra.vectors import axpy, dot, rotate, rotate_back, unit
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    chart_normal,
    coedge_conormal,
    edge_jet,
    edge_record,
    vertex_record,
)
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.pair.switching import end_direction


@kernel
def along_edge(ints, reals, feature, t, way):
    """The unit normal of an edge that is nearest to a direction, body frame."""
    tangent = unit(edge_jet(ints, reals, feature, t)[1])
    across = unit(axpy(-dot(way, tangent), tangent, way))
    e = edge_record(ints, feature)
    for side in range(2):
        coedge = ints[e + L.EDGE_COEDGE_0 + side]
        if coedge >= 0:
            inward, normal, _ = coedge_conormal(ints, reals, coedge, tangent, t)
            if dot(across, inward) > 0.0:
                return normal
    return across


@kernel
def along_vertex(ints, reals, feature, way):
    """The unit normal of a vertex that is nearest to a direction, body frame."""
    record = vertex_record(ints, feature)
    fan = ints[record + L.VERTEX_FAN]
    worst, at, t = 0.0, -1, 0.0
    for k in range(ints[record + L.VERTEX_N_FAN]):
        edge, end = ints[L.N_FACES] + ints[fan + 2 * k], ints[fan + 2 * k + 1]
        rise = dot(way, end_direction(ints, reals, edge, end))
        if rise > worst:
            o = ints[edge_record(ints, edge) + L.EDGE_REALS]
            worst, at, t = rise, edge, reals[o + L.EDGE_T0 + end]
    return way if at < 0 else along_edge(ints, reals, at, t, way)


@kernel
def outward_of_point(seen, feature, t, way):
    """That of a vertex, or of a place on an edge; in A's frame."""
    inner = rotate_back(seen.pose.R, way)
    if feature >= seen.ints[L.N_FACES] + seen.ints[L.N_EDGES]:
        inner = along_vertex(seen.ints, seen.reals, feature, inner)
    else:
        inner = along_edge(seen.ints, seen.reals, feature, t, inner)
    return rotate(seen.pose.R, inner)


@kernel
def outward_of_face(seen, chart, u, v):
    return rotate(seen.pose.R, chart_normal(seen.ints, seen.reals, chart, u, v))
