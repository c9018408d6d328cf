"""What of a body is near its supporting plane: vertices, pieces of edges, places on rims."""

from math import atan2

from standoff.kernels.algebra.vectors import cross, dot, norm, rotate_back
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    best_coedge,
    chart_record,
    coedge_parameters,
    coedge_record,
    edge_jet,
    edge_record,
    vertex_point,
)
from standoff.kernels.compiler.decorators import kernel, reals_on_stack
from standoff.kernels.patches.seen import (
    BELOW,
    CHART,
    EDGE,
    FACE_REALS,
    FEATURE,
    FIRST,
    LAST,
    NEAR,
    NODE,
    PARTS,
    PEAK,
    POINT_REALS,
    SEGMENT_REALS,
    U,
    V,
    edge_place,
    laid,
    placed,
)
from standoff.kernels.patches.tolerances import AT_PEAK, LEVEL_TURN, PEAK_HALVINGS

# Of a node of a curve: its four numbers, and its tangent in A's frame.
TANGENT, NODE_REALS = 4, 7
ALL_NODES = NODE_REALS * (PARTS + 1)


@kernel
def put_point(room, feature, node, peak):
    o = POINT_REALS * room.counts[1]
    room.points[o + FEATURE], room.points[o + PEAK] = feature, peak
    for k in range(4):
        room.points[o + NODE + k] = node[k]
    room.counts[1] += 1


@kernel
def mark_face(room, face, chart, u, v):
    o = FACE_REALS * face
    if room.faces[o + NEAR] == 0.0:
        room.faces[o + NEAR], room.faces[o + CHART] = 1.0, chart
        room.faces[o + U], room.faces[o + V] = u, v


@kernel
def mark_beside(seen, room, feature, t):
    """Mark the faces beside an edge, each with its parameters there."""
    ints, reals = seen.ints, seen.reals
    e = edge_record(ints, feature)
    for side in range(2):
        coedge = ints[e + L.EDGE_COEDGE_0 + side]
        if coedge < 0:
            continue
        k = best_coedge(ints, reals, coedge, t)
        u, v, _, _, _ = coedge_parameters(ints, reals, k, t)
        chart = ints[coedge_record(ints, k) + L.COEDGE_CHART]
        mark_face(room, ints[chart_record(ints, chart) + L.CHART_FACE], chart, u, v)


@kernel
def put_reach(seen, room, feature, first, last, within):
    """Put a piece of an edge, if an end of it is near; mark the faces beside it."""
    if min(first[BELOW], last[BELOW]) > within:
        return
    o = SEGMENT_REALS * room.counts[0]
    room.segments[o + EDGE] = feature
    for k in range(4):
        room.segments[o + FIRST + k], room.segments[o + LAST + k] = first[k], last[k]
    room.counts[0] += 1
    mark_beside(seen, room, feature, first[0] if first[BELOW] <= last[BELOW] else last[0])


@kernel
def node_at(seen, feature, t):
    x, _ = edge_place(seen, feature, t)
    ex, fx, below = laid(seen, x)
    return t, ex, fx, below


@kernel
def peak_between(seen, feature, low, high):
    """The parameter of the highest place of a piece that rises at its start and falls at its end,
    by Newton's method, and by halving where that leaves the piece."""
    t, up = 0.5 * (low + high), rotate_back(seen.pose.R, seen.up)
    for _ in range(PEAK_HALVINGS):
        _, tangent, bend = edge_jet(seen.ints, seen.reals, feature, t)
        slope, turn = dot(tangent, up), dot(bend, up)
        if slope > 0.0:
            low = t
        else:
            high = t
        before, t = t, t - slope / turn
        if not low <= t <= high:
            t = 0.5 * (low + high)
        if abs(t - before) <= AT_PEAK * (1.0 + abs(t)):
            break
    return t


@kernel
def node_of(nodes, k):
    o = NODE_REALS * k
    return nodes[o], nodes[o + 1], nodes[o + 2], nodes[o + 3]


@kernel
def tangent_of(nodes, k):
    o = NODE_REALS * k + TANGENT
    return nodes[o], nodes[o + 1], nodes[o + 2]


@kernel
def is_level(nodes, within):
    """Does a curve lie within the region, all of it or as far as it turns by LEVEL_TURN?"""
    turn, whole = 0.0, nodes[BELOW] <= within
    for k in range(PARTS):
        if node_of(nodes, k + 1)[BELOW] > within:
            whole = False
        elif node_of(nodes, k)[BELOW] <= within:
            a, b = tangent_of(nodes, k), tangent_of(nodes, k + 1)
            turn += atan2(norm(cross(a, b)), dot(a, b))
    return whole or turn >= LEVEL_TURN


@kernel
def look_along(seen, room, feature, within):
    """Put what is near of a curved edge."""
    e = edge_record(seen.ints, feature)
    o = seen.ints[e + L.EDGE_REALS]
    t0, t1 = seen.reals[o + L.EDGE_T0], seen.reals[o + L.EDGE_T1]
    closed = seen.ints[e + L.EDGE_FLAGS] & L.CLOSED != 0
    nodes = reals_on_stack(ALL_NODES)
    for k in range(PARTS + 1):
        t = t0 + (t1 - t0) * k / PARTS
        x, tangent = edge_place(seen, feature, t)
        ex, fx, below = laid(seen, x)
        n = NODE_REALS * k
        nodes[n], nodes[n + 1], nodes[n + 2], nodes[n + 3] = t, ex, fx, below
        for j in range(3):
            # a closed curve's end rises just as its start does, or a peak there would be lost
            own = nodes[TANGENT + j] if closed and k == PARTS else tangent[j]
            nodes[n + TANGENT + j] = own
    level = is_level(nodes, within)
    for k in range(PARTS):
        first, last = node_of(nodes, k), node_of(nodes, k + 1)
        rises = dot(tangent_of(nodes, k), seen.up) > 0.0
        if rises and dot(tangent_of(nodes, k + 1), seen.up) <= 0.0:
            peak = node_at(seen, feature, peak_between(seen, feature, first[0], last[0]))
            put_reach(seen, room, feature, first, peak, within)
            put_reach(seen, room, feature, peak, last, within)
            if not level and peak[BELOW] <= within:
                put_point(room, feature, peak, 1.0)
        else:
            put_reach(seen, room, feature, first, last, within)
        if level and first[BELOW] <= within and (closed or k > 0):
            put_point(room, feature, first, 0.0)
            room.counts[2] = 1


@kernel
def gather(seen, room, side, within):
    """Write into a body's room what of it is at most `within` below its supporting plane, and the
    face of its own witness point, `side`."""
    ints, reals = seen.ints, seen.reals
    n_faces, n_edges = ints[L.N_FACES], ints[L.N_EDGES]
    room.counts[0], room.counts[1], room.counts[2] = 0, 0, 0
    for face in range(n_faces):
        room.faces[FACE_REALS * face + NEAR] = 0.0
    if side.feature < n_faces:
        mark_face(room, side.feature, side.chart, side.p, side.q)
    for feature in range(n_faces, n_faces + n_edges):
        e = edge_record(ints, feature)
        if ints[e + L.EDGE_KIND] != L.LINE:
            look_along(seen, room, feature, within)
            continue
        o = ints[e + L.EDGE_REALS]
        first = node_at(seen, feature, reals[o + L.EDGE_T0])
        last = node_at(seen, feature, reals[o + L.EDGE_T1])
        put_reach(seen, room, feature, first, last, within)
    for feature in range(n_faces + n_edges, n_faces + n_edges + ints[L.N_VERTICES]):
        ex, fx, below = laid(seen, placed(seen, vertex_point(ints, reals, feature)))
        if below <= within:
            put_point(room, feature, (0.0, ex, fx, below), 0.0)


@kernel
def point_place(seen, feature, t):
    """The point of a vertex, or of a place on an edge, in A's frame."""
    if feature >= seen.ints[L.N_FACES] + seen.ints[L.N_EDGES]:
        return placed(seen, vertex_point(seen.ints, seen.reals, feature))
    return edge_place(seen, feature, t)[0]
