"""Where the gap of two convex bodies is hardly wider than their distance: corners of that region.

Seen along the normal the region is convex, as the gap is a convex function. Its corners are
vertices and places on rims over a face of the other body, places of edges where these are nearest
to a curved face, and crossings of edges.
"""

from typing import Any, NamedTuple

from standoff.kernels.algebra.frames import frame_across
from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import axpy, cross, dot, scale, sub, unit
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    best_coedge,
    chart_record,
    coedge_parameters,
    coedge_record,
    edge_record,
)
from standoff.kernels.compiler.decorators import ahead, kernel
from standoff.kernels.patches.crossings import crossing
from standoff.kernels.patches.outward import outward_of_face, outward_of_point
from standoff.kernels.patches.over import edges_over, faces_over
from standoff.kernels.patches.places import put_place
from standoff.kernels.patches.ridges import ridge
from standoff.kernels.patches.rims import gather, node_at, point_place
from standoff.kernels.patches.seen import (
    BELOW,
    CHART,
    EDGE,
    FACE_REALS,
    FEATURE,
    NEAR,
    NODE,
    PEAK,
    POINT_REALS,
    SEGMENT_REALS,
    Seen,
    edge_place,
)
from standoff.kernels.patches.tolerances import FACING, ONE_SPOT, PAIR_LEAN, RIMS_MEET
from standoff.kernels.values import Pose

IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
ORIGIN = (0.0, 0.0, 0.0)


class Asked(NamedTuple):
    """What is asked of a pair."""

    distance: float  # of the cores
    wider: float  # by how much the gap may be wider
    one: float  # pairs nearer to each other than this are one
    near: float  # what misses by this meets
    facing: float  # least cosine of a face's normal with the direction along which it is seen


class Sides(NamedTuple):
    """Both bodies as they are seen, and where what is near of them is."""

    a: Any
    b: Any
    room_a: Any
    room_b: Any


@kernel
def smaller_size(pair):
    """Of the cores, length; a half-space has none, nor has a point."""
    a, b = pair.reals_a[L.SIZE], pair.reals_b[L.SIZE]
    if pair.ints_a[L.UNBOUNDED] or a == 0.0:
        return b
    return a if pair.ints_b[L.UNBOUNDED] or b == 0.0 else min(a, b)


@kernel
def seen_along(pair, pose, n, x, y):
    """A and B as seen along the normal n from their cores' witness points x and y, A's frame."""
    across = frame_across(n)
    e, f = across.e, across.f
    if pair.ints_a[L.DIMENSION] == 2 or pair.ints_b[L.DIMENSION] == 2:
        f = (0.0, 0.0, 1.0)
        e = unit(cross(f, n))
    a = Seen(pair.ints_a, pair.reals_a, Pose(IDENTITY, ORIGIN), n, x, e, f)
    return a, Seen(pair.ints_b, pair.reals_b, pose, scale(-1.0, n), y, e, f)


@kernel
def moved_out(seen, x, outward):
    return axpy(seen.reals[L.RADIUS], outward, x)


@kernel
def put_pair(places, n, first, spot, x, y, asked):
    """Put a pair of which `x` is of A if it is the `first`, else of B."""
    if first:
        return put_place(places, n, spot, x, y, asked.one)
    return put_place(places, n, spot, y, x, asked.one)


@kernel
def over_face(own, other, places, n, at, over, first, asked):
    """Put the pair of a point `at` (feature, node), and the face over it."""
    feature, t = at[0], at[1][0]
    x, y = point_place(own, feature, t), over.x
    if own.reals[L.RADIUS] > 0.0:
        x = moved_out(own, x, outward_of_point(own, feature, t, own.up))
    if other.reals[L.RADIUS] > 0.0:
        y = moved_out(other, y, outward_of_face(other, over.chart, over.u, over.v))
    spot = at[1][1], at[1][2], at[1][BELOW] + over.below
    return put_pair(places, n, first, spot, x, y, asked)


@kernel
def over_edge(own, other, places, n, point, over, first, asked):
    """Put the pair of a point and the edge over it or, where a ball rounds one of them, beside."""
    apart = asked.distance + point[NODE + BELOW] + over.below
    wider, leans = apart - asked.distance, over.aside > asked.near
    if leans:
        away = sqrt(apart * apart + over.aside * over.aside)
        rounded = own.reals[L.RADIUS] + other.reals[L.RADIUS] > 0.0
        if not rounded or apart < PAIR_LEAN * away:
            return n
        wider = away - asked.distance
    if wider > asked.wider + asked.near:
        return n
    feature, t = int(point[FEATURE]), point[NODE]
    x, y = point_place(own, feature, t), over.x
    way = unit(sub(y, x)) if leans else own.up
    if own.reals[L.RADIUS] > 0.0:
        x = moved_out(own, x, outward_of_point(own, feature, t, way))
    if other.reals[L.RADIUS] > 0.0:
        back = scale(-1.0, way)
        y = moved_out(other, y, outward_of_point(other, over.feature, over.u, back))
    spot = point[NODE + 1], point[NODE + 2], wider
    return put_pair(places, n, first, spot, x, y, asked)


@kernel
def node_in(point):
    return point[NODE], point[NODE + 1], point[NODE + 2], point[NODE + BELOW]


@kernel
def is_plane(seen, chart):
    return seen.ints[chart_record(seen.ints, chart) + L.CHART_KIND] == L.PLANE


@kernel
def points_over(own, other, rooms, places, n, first, asked):
    """Put the pairs of the near points of a body with what of the other is over them."""
    for k in range(rooms[0].counts[1]):
        point = ahead(rooms[0].points, POINT_REALS * k)
        ex, fx = point[NODE + 1], point[NODE + 2]
        left = asked.wider + asked.near - point[NODE + BELOW]
        over = faces_over(other, rooms[1], ex, fx, left, asked.near, asked.facing)
        if over.found:
            # over a curved face the edge is nearest elsewhere: `put_ridges`
            if point[PEAK] == 0.0 or is_plane(other, over.chart):
                at = int(point[FEATURE]), node_in(point)
                n = over_face(own, other, places, n, at, over, first, asked)
            continue
        over = edges_over(other, rooms[1], ex, fx, asked.near)
        if over.found:
            n = over_edge(own, other, places, n, point, over, first, asked)
    return n


@kernel
def put_ridges(own, other, rooms, places, n, first, asked):
    """Put the pairs where an edge of a body is nearest to a curved face of the other."""
    for face in range(other.ints[L.N_FACES]):
        o = FACE_REALS * face
        if rooms[1].faces[o + NEAR] == 0.0 or is_plane(other, int(rooms[1].faces[o + CHART])):
            continue
        for k in range(rooms[0].counts[0]):
            segment = ahead(rooms[0].segments, SEGMENT_REALS * k)
            over, node = ridge(own, other, rooms[1], segment, face, asked.near, asked.facing)
            if over.found and node[BELOW] + over.below <= asked.wider + asked.near:
                at = int(segment[EDGE]), node
                n = over_face(own, other, places, n, at, over, first, asked)
    return n


@kernel
def is_rim(seen, feature, t):
    """Is a face beside an edge nearly square to the normal? Else the edge is a crest."""
    e = edge_record(seen.ints, feature)
    for side in range(2):
        coedge = seen.ints[e + L.EDGE_COEDGE_0 + side]
        if coedge >= 0:
            k = best_coedge(seen.ints, seen.reals, coedge, t)
            u, v, _, _, _ = coedge_parameters(seen.ints, seen.reals, k, t)
            chart = seen.ints[coedge_record(seen.ints, k) + L.COEDGE_CHART]
            if dot(outward_of_face(seen, chart, u, v), seen.up) >= PAIR_LEAN:
                return True
    return False


@kernel
def put_crossings(sides, own, places, n, asked):
    """Put the pairs where an edge of A crosses one of B; but for that of the witness points where
    crests cross, which runs along them as they turn."""
    a, b = sides.a, sides.b
    for i in range(sides.room_a.counts[0]):
        p = ahead(sides.room_a.segments, SEGMENT_REALS * i)
        for j in range(sides.room_b.counts[0]):
            q = ahead(sides.room_b.segments, SEGMENT_REALS * j)
            found, s, t = crossing(a, b, p, q, asked.near)
            if not found:
                continue
            edge_a, edge_b = int(p[EDGE]), int(q[EDGE])
            ours = edge_a == own[0].feature and edge_b == own[1].feature
            if ours and not (is_rim(a, edge_a, s) and is_rim(b, edge_b, t)):
                continue
            node, other = node_at(a, edge_a, s), node_at(b, edge_b, t)
            wider = node[BELOW] + other[BELOW]
            if wider > asked.wider + asked.near:
                continue
            x, y = edge_place(a, edge_a, s)[0], edge_place(b, edge_b, t)[0]
            if a.reals[L.RADIUS] > 0.0:
                x = moved_out(a, x, outward_of_point(a, edge_a, s, a.up))
            if b.reals[L.RADIUS] > 0.0:
                y = moved_out(b, y, outward_of_point(b, edge_b, t, b.up))
            n = put_place(places, n, (node[1], node[2], wider), x, y, asked.one)
    return n


@kernel
def spots(sides, own, places, asked):
    """Write the corners of the region; how many. `own` are the sides of the witness points."""
    gather(sides.a, sides.room_a, own[0], asked.wider + asked.near)
    gather(sides.b, sides.room_b, own[1], asked.wider + asked.near)
    rooms = sides.room_a, sides.room_b
    n = points_over(sides.a, sides.b, rooms, places, 0, True, asked)
    n = points_over(sides.b, sides.a, (rooms[1], rooms[0]), places, n, False, asked)
    n = put_ridges(sides.a, sides.b, rooms, places, n, True, asked)
    n = put_ridges(sides.b, sides.a, (rooms[1], rooms[0]), places, n, False, asked)
    return put_crossings(sides, own, places, n, asked)


@kernel
def asked_of(pair, distance, wider):
    """`distance` is the signed one of the bodies, radii included."""
    size = smaller_size(pair)
    radii = pair.reals_a[L.RADIUS] + pair.reals_b[L.RADIUS]
    one = ONE_SPOT * (size if size > 0.0 else radii)
    # beside a face that leans more a rounded edge is nearer
    facing = PAIR_LEAN if radii > 0.0 else FACING
    return Asked(distance + radii, wider, one, RIMS_MEET * size, facing)
