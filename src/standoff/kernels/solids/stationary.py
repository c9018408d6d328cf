"""Which pairs of points are local minima of the distance of two boundaries, to first order, and no
saddles of two of their leaves.

At one no direction into a boundary leads towards the other point. The directions are those of a
face's tangents, of an edge and into its faces, of the corners and edges of a vertex: its fan.
"""

from math import atan2, cos, pi, sin, sqrt
from typing import Any, NamedTuple

from standoff.kernels.algebra.rigid import read_vector
from standoff.kernels.algebra.vectors import add, cross, dot, norm, rotate_back, scale, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import coedge_conormal, edge_record
from standoff.kernels.compiler.decorators import kernel, reals_on_stack
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_minimum import fill_system, solved
from standoff.kernels.solids.spatial_pieces import leaf_box, leaf_ints, leaf_jet
from standoff.kernels.solids.spatial_tolerances import HELD_SLOPE

# Of each vertex four integers: where its directions stand, and how many; where its corners, and how
# many. A direction is a unit vector; a corner the edge that leaves it, what is a quarter turn
# from there, and the angle to the edge that arrives.
FAN_INTS = 4
CORNER_REALS = 7


class Fans(NamedTuple):
    """The directions into a boundary from its vertices, own frame."""

    ints: Any
    reals: Any


@kernel
def steepest(side, fans, leaf, u, v, n):
    """The greatest component along n, A's frame, of a unit direction into the boundary from a
    leaf's point."""
    r = leaf_ints(side, leaf)
    dim, feature = side.own[r + S.DIM], side.own[r + S.FEATURE]
    own = rotate_back(side.pose.R, n)
    if dim == 0:
        return steepest_at_vertex(fans, feature - side.ints[L.N_FACES] - side.ints[L.N_EDGES], own)
    jet = leaf_jet(side, leaf, u, v)
    if dim == 2:
        normal = cross(jet[1], jet[2])
        size = norm(normal)
        return norm(cross(n, normal)) / size if size > 0.0 else 1.0
    size = norm(jet[1])
    if size == 0.0:
        return 1.0
    along = scale(1.0 / size, rotate_back(side.pose.R, jet[1]))
    most = abs(dot(along, own))
    row = edge_record(side.ints, feature)
    for k in (L.EDGE_COEDGE_0, L.EDGE_COEDGE_1):
        way = coedge_conormal(side.ints, side.reals, side.ints[row + k], along, u)[0]
        most = max(most, dot(way, own))
    return most


@kernel
def steepest_at_vertex(fans, vertex, n):
    row = FAN_INTS * vertex
    first, n_ways = fans.ints[row], fans.ints[row + 1]
    corner, n_corners = fans.ints[row + 2], fans.ints[row + 3]
    most = -1.0
    for k in range(n_ways):
        most = max(most, dot(read_vector(fans.reals, first + 3 * k), n))
    for k in range(n_corners):
        o = corner + CORNER_REALS * k
        along = dot(read_vector(fans.reals, o), n)
        across = dot(read_vector(fans.reals, o + 3), n)
        turned = atan2(across, along)
        if turned < 0.0:
            turned += 2.0 * pi
        if turned <= fans.reals[o + 6]:
            most = max(most, sqrt(along * along + across * across))
    return most


@kernel
def arriving_at(fans, o):
    """The unit vector along the edge that arrives at a vertex in a face's corner."""
    leaving, across, angle = (
        read_vector(fans.reals, o),
        read_vector(fans.reals, o + 3),
        fans.reals[o + 6],
    )
    return add(scale(cos(angle), leaving), scale(sin(angle), across))


@kernel
def is_stationary(a, b, fans_a, fans_b, q, leaves, n, sine):
    """Can no small step on either boundary make a pair nearer along its normal, to first order?
    `sine`: of the angle by which one may."""
    if steepest(a, fans_a, leaves[0], q[0], q[1], n) > sine:
        return False
    return steepest(b, fans_b, leaves[1], q[2], q[3], scale(-1.0, n)) <= sine


@kernel
def bends_up(ja, jb, spare):
    """Does the square of the distance of two surfaces or curves bend upwards along all parameters,
    where `spare` times the squared tangents is added to its second derivatives?"""
    g, H, free, scales = reals_on_stack(4), reals_on_stack(16), reals_on_stack(4), reals_on_stack(4)
    out = reals_on_stack(4)
    fill_system(ja, jb, g, H)
    for i in range(4):
        tangent = ja[1 + i] if i < 2 else jb[i - 1]
        scales[i] = dot(tangent, tangent)
        free[i] = 1.0 if scales[i] > 0.0 else 0.0
    return solved(H, g, free, spare, scales, out)


@kernel
def is_bowl(a, leaf_a, ja, b, leaf_b, jb, q, spare):
    """Does the square of the distance bend upwards along all parameters that no side holds, where
    `spare` times the squared tangents is added to its second derivatives? Below 0 it then grows
    away from the pair of points in any case; above 0, if not, the pair is a saddle."""
    g, H, free, scales = reals_on_stack(4), reals_on_stack(16), reals_on_stack(4), reals_on_stack(4)
    out = reals_on_stack(4)
    box_a, box_b = leaf_box(a, leaf_a), leaf_box(b, leaf_b)
    lo = (box_a.u0, box_a.v0, box_b.u0, box_b.v0)
    hi = (box_a.u1, box_a.v1, box_b.u1, box_b.v1)
    fill_system(ja, jb, g, H)
    distance = norm(sub(jb[0], ja[0]))
    for i in range(4):
        tangent = ja[1 + i] if i < 2 else jb[i - 1]
        length = norm(tangent)
        scales[i] = length * length
        at_side = q[i] <= lo[i] or q[i] >= hi[i]
        held = at_side and abs(g[i]) > HELD_SLOPE * length * distance
        free[i] = 0.0 if held or length == 0.0 or hi[i] <= lo[i] else 1.0
    return solved(H, g, free, spare, scales, out)
