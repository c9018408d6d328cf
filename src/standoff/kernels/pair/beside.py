"""Does a witness point lie where its feature gives way to another?

A face is C2: patches are cut where they are not, so the curvature jumps at edges alone, and not at
all of these: where two faces have one normal and one curvature, the surface goes on as if uncut.
"""

from math import inf

import numpy as np

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import add, axpy, cross, dot, scale, sub, unit
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    best_coedge,
    chart_jet,
    coedge_conormal,
    coedge_parameters,
    coedge_record,
    dimension,
    edge_jet,
    edge_record,
    has_collapsed,
    vertex_record,
)
from standoff.kernels.body.trimming import HIT_COEDGE, on_face, walk_face
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.pair.switching import end_direction, onto_face, steepest_in_sector
from standoff.kernels.tolerances import BEND_INSIDE, BESIDE_FEATURE, SAME_BEND
from standoff.kernels.values import NO_CHART, Side


@kernel
def beside_another(ints, reals, side, n):
    """Is a feature's point, to BESIDE_FEATURE, one of a neighbouring feature as well?

    n is the unit vector towards the other body, in this body's frame.
    """
    dim = dimension(ints, side.feature)
    if dim == 2:
        return beside_loop(ints, reals, side)
    if dim == 1:
        return beside_end(ints, reals, side, n) or beside_face(ints, reals, side, n)
    return beside_fan(ints, reals, side, n)


@kernel
def bend(jet, n, along, across):
    """(uu, uv, vv) of the second fundamental form in n, by two directions along the surface."""
    normal = cross(jet[1], jet[2])
    square = dot(normal, normal)
    of_u = scale(1.0 / square, cross(jet[2], normal))  # w is (w.of_u) x_u + (w.of_v) x_v
    of_v = scale(1.0 / square, cross(normal, jet[1]))
    a, b, c, d = dot(along, of_u), dot(along, of_v), dot(across, of_u), dot(across, of_v)
    uu, uv, vv = dot(n, jet[3]), dot(n, jet[4]), dot(n, jet[5])
    return (
        a * a * uu + 2.0 * a * b * uv + b * b * vv,
        a * c * uu + (a * d + b * c) * uv + b * d * vv,
        c * c * uu + 2.0 * c * d * uv + d * d * vv,
    )


@kernel
def inner_parameter(ints, reals, edge, t):
    """An edge's parameter, BEND_INSIDE of the size off its ends."""
    e = edge_record(ints, edge)
    o = ints[e + L.EDGE_REALS]
    tangent = edge_jet(ints, reals, edge, t)[1]
    step = BEND_INSIDE * reals[L.SIZE] / sqrt(dot(tangent, tangent))
    if ints[e + L.EDGE_FLAGS] & L.CLOSED:
        return t
    return min(max(t, reals[o + L.EDGE_T0] + step), reals[o + L.EDGE_T1] - step)


@kernel
def inner_jet(ints, reals, coedge, t):
    """The jet of a coedge's face beside its point at t, BEND_INSIDE of the size off it.

    At the edge itself patches that were one, cut at a knot, have the jet of the same span.
    """
    k = best_coedge(ints, reals, coedge, t)
    c = coedge_record(ints, k)
    u, v, tu, tv, _ = coedge_parameters(ints, reals, k, t)
    du, dv = -ints[c + L.COEDGE_SIDE] * tv, ints[c + L.COEDGE_SIDE] * tu
    jet = chart_jet(ints, reals, ints[c + L.COEDGE_CHART], u, v)
    way = axpy(du, jet[1], scale(dv, jet[2]))
    step = BEND_INSIDE * reals[L.SIZE] / sqrt(dot(way, way))
    return chart_jet(ints, reals, ints[c + L.COEDGE_CHART], u + step * du, v + step * dv)


@kernel
def bends_on(ints, reals, edge, t):
    """Do an edge's two faces go over into each other there, with one normal and one curvature?"""
    e = edge_record(ints, edge)
    one, other = ints[e + L.EDGE_COEDGE_0], ints[e + L.EDGE_COEDGE_1]
    if ints[e + L.EDGE_FLAGS] & (L.SMOOTH | L.CREASED) != L.SMOOTH or one < 0 or other < 0:
        return False
    t = inner_parameter(ints, reals, edge, t)
    jet, beyond = inner_jet(ints, reals, one, t), inner_jet(ints, reals, other, t)
    if has_collapsed(reals, jet[1]) or has_collapsed(reals, jet[2]):
        return False
    if has_collapsed(reals, beyond[1]) or has_collapsed(reals, beyond[2]):
        return False
    n, along = unit(cross(jet[1], jet[2])), unit(jet[1])
    across = cross(n, along)
    a, b = bend(jet, n, along, across), bend(beyond, n, along, across)
    most = max(abs(a[0]), abs(a[1]), abs(a[2])) + 1.0 / reals[L.SIZE]
    apart = max(abs(a[0] - b[0]), abs(a[1] - b[1]), abs(a[2] - b[2]))
    return most < inf and apart <= SAME_BEND * most


@kernel
def side_at(ints, reals, edge, t):
    """An edge's point at t on one of its faces."""
    coedge = ints[edge_record(ints, edge) + L.EDGE_COEDGE_0]
    feature, chart, u, v = onto_face(ints, reals, coedge, t)
    return Side(feature, chart, u, v)


@kernel
def fan_edge(ints, reals, vertex, k):
    """(edge, its parameter) of a vertex's k-th edge there."""
    fan = ints[vertex_record(ints, vertex) + L.VERTEX_FAN]
    edge = ints[L.N_FACES] + ints[fan + 2 * k]
    o = ints[edge_record(ints, edge) + L.EDGE_REALS]
    return edge, reals[o + L.EDGE_T0 + ints[fan + 2 * k + 1]]


@kernel
def all_bend_on(ints, reals, vertex):
    """Do a vertex's faces go over into each other, each into the next with one curvature?"""
    r = vertex_record(ints, vertex)
    for k in range(ints[r + L.VERTEX_N_FAN]):
        edge, t = fan_edge(ints, reals, vertex, k)
        if not bends_on(ints, reals, edge, t):
            return False
    return ints[r + L.VERTEX_N_FAN] > 0


@kernel
def continued(ints, reals, vertex, edge):
    """The edge that goes on from a vertex where an edge ends, with one tangent and one curvature;
    -1 where there is none."""
    r = vertex_record(ints, vertex)
    fan = ints[r + L.VERTEX_FAN]
    way, bent = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(ints[r + L.VERTEX_N_FAN]):
        if fan_edge(ints, reals, vertex, k)[0] == edge:
            way = end_direction(ints, reals, edge, ints[fan + 2 * k + 1])
            bent = curvature_at(ints, reals, edge, fan_edge(ints, reals, vertex, k)[1])
    for k in range(ints[r + L.VERTEX_N_FAN]):
        other, t = fan_edge(ints, reals, vertex, k)
        turned = add(way, end_direction(ints, reals, other, ints[fan + 2 * k + 1]))
        apart = sub(bent, curvature_at(ints, reals, other, t))
        most = sqrt(dot(bent, bent)) + 1.0 / reals[L.SIZE]
        straight = dot(turned, turned) <= BESIDE_FEATURE * BESIDE_FEATURE
        if other != edge and straight and sqrt(dot(apart, apart)) <= SAME_BEND * most:
            return other
    return np.int64(-1)


@kernel
def curvature_at(ints, reals, edge, t):
    """An edge's vector of curvature."""
    jet = edge_jet(ints, reals, edge, inner_parameter(ints, reals, edge, t))
    square = dot(jet[1], jet[1])
    return scale(1.0 / square, axpy(-dot(jet[2], jet[1]) / square, jet[1], jet[2]))


@kernel
def off_seams(ints, reals, side):
    """The same point on a face where an edge or a vertex lies amid what goes on as one surface, on
    an edge where a vertex lies amid what goes on as one edge; else as it is."""
    dim = dimension(ints, side.feature)
    if dim == 1 and bends_on(ints, reals, side.feature, side.p):
        return side_at(ints, reals, side.feature, side.p)
    if dim != 0:
        return side
    if all_bend_on(ints, reals, side.feature):
        edge, t = fan_edge(ints, reals, side.feature, 0)
        return side_at(ints, reals, edge, t)
    for k in range(ints[vertex_record(ints, side.feature) + L.VERTEX_N_FAN]):
        edge, t = fan_edge(ints, reals, side.feature, k)
        if not bends_on(ints, reals, edge, t):
            if continued(ints, reals, side.feature, edge) >= 0:
                return Side(edge, NO_CHART, t, 0.0)
            return side
    return side


@kernel
def beside_loop(ints, reals, side):
    """Of a face: is a point around this one off it, and off what goes on from it?"""
    if ints[L.UNBOUNDED]:
        return False
    jet = chart_jet(ints, reals, side.chart, side.p, side.q)
    along_u, along_v = sqrt(dot(jet[1], jet[1])), sqrt(dot(jet[2], jet[2]))
    reach = BESIDE_FEATURE * reals[L.SIZE]
    if along_u <= reach or along_v <= reach:
        return True  # a pole: other parameters name the same point
    du, dv = reach / along_u, reach / along_v
    for i in range(-1, 2):
        for j in range(-1, 2):
            inside = on_face(ints, reals, side.chart, side.p + i * du, side.q + j * dv)
            if not (inside or goes_on(ints, reals, side, 2.0 * i * du, 2.0 * j * dv)):
                return True
    return False


@kernel
def goes_on(ints, reals, side, du, dv):
    """Does a step that leaves a face cross an edge behind which the surface goes on?"""
    _, hit, coedge, t = walk_face(ints, reals, side.chart, side.p, side.q, du, dv)
    edge = ints[coedge_record(ints, coedge) + L.COEDGE_EDGE] if hit == HIT_COEDGE else -1
    if edge < 0:
        return False
    at = Side(ints[L.N_FACES] + edge, NO_CHART, t, 0.0)
    end = near_end(ints, reals, at)
    if end >= 0:
        return all_bend_on(ints, reals, end_vertex(ints, at.feature, end))
    return bends_on(ints, reals, at.feature, t)


@kernel
def near_end(ints, reals, side):
    """The end of an edge, 0 or 1, that a point of it is near; -1 if none."""
    e = edge_record(ints, side.feature)
    if ints[e + L.EDGE_FLAGS] & L.CLOSED:
        return -1
    o = ints[e + L.EDGE_REALS]
    tangent = edge_jet(ints, reals, side.feature, side.p)[1]
    first, last = side.p - reals[o + L.EDGE_T0], reals[o + L.EDGE_T1] - side.p
    near = min(first, last) * sqrt(dot(tangent, tangent)) <= BESIDE_FEATURE * reals[L.SIZE]
    return (0 if first < last else 1) if near else -1


@kernel
def end_vertex(ints, edge, end):
    """The vertex at an edge's end, as a feature."""
    return ints[L.N_FACES] + ints[L.N_EDGES] + ints[edge_record(ints, edge) + L.EDGE_FIRST + end]


@kernel
def beside_end(ints, reals, side, n):
    """Of an edge: is an end near, from which no edge goes on, or another does not rise?"""
    end = near_end(ints, reals, side)
    if end < 0:
        return False
    vertex = end_vertex(ints, side.feature, end)
    other = continued(ints, reals, vertex, side.feature)
    r = vertex_record(ints, vertex)
    fan = ints[r + L.VERTEX_FAN]
    for k in range(ints[r + L.VERTEX_N_FAN]):
        edge = fan_edge(ints, reals, vertex, k)[0]
        way = end_direction(ints, reals, edge, ints[fan + 2 * k + 1])
        if edge != side.feature and edge != other and dot(n, way) > -BESIDE_FEATURE:
            return True
    return other < 0


@kernel
def beside_face(ints, reals, side, n):
    """Of an edge: does the distance not rise along a face's inward conormal?"""
    e = edge_record(ints, side.feature)
    tangent = unit(edge_jet(ints, reals, side.feature, side.p)[1])
    for k in range(2):
        coedge = ints[e + L.EDGE_COEDGE_0 + k]
        if coedge >= 0:
            inward = coedge_conormal(ints, reals, coedge, tangent, side.p)[0]
            if dot(n, inward) > -BESIDE_FEATURE:
                return True
    return False


@kernel
def beside_fan(ints, reals, side, n):
    """Of a vertex: does the distance not rise along one of its edges, or into a face's sector?"""
    r = vertex_record(ints, side.feature)
    fan = ints[r + L.VERTEX_FAN]
    for k in range(ints[r + L.VERTEX_N_FAN]):
        edge = ints[L.N_FACES] + ints[fan + 2 * k]
        if dot(n, end_direction(ints, reals, edge, ints[fan + 2 * k + 1])) > -BESIDE_FEATURE:
            return True
    sectors = ints[r + L.VERTEX_SECTORS]
    for k in range(ints[r + L.VERTEX_N_SECTORS]):
        if steepest_in_sector(ints, reals, sectors + 2 * k, n)[0] < BESIDE_FEATURE:
            return True
    return False
