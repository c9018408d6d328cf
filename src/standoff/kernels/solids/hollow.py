"""Pairs of points in an overlap that are held at a hollow edge or vertex, or at a vertex where one
ends.

At a hollow edge the material reaches more than half way round, as at the foot of a wall. It is as
a fillet of no radius: what has gone past it is held between the faces beside it, and a hollow
vertex is as a hollow ball. Where a hollow edge ends at two convex ones, these are one edge with a
fillet of no radius as seen along an edge of the other solid that lies across both.
"""

from math import sin

from standoff.kernels.algebra.rigid import read_vector
from standoff.kernels.algebra.vectors import add, cross, dot, norm, rotate_back, scale
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import coedge_conormal, edge_record
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_pieces import ZERO, leaf_ints, leaf_jet
from standoff.kernels.solids.spatial_tolerances import NEARLY_OPPOSED
from standoff.kernels.solids.stationary import (
    CORNER_REALS,
    FAN_INTS,
    arriving_at,
    steepest,
)


@kernel
def is_hollow(side, leaf):
    """Is it of an edge at which the material reaches more than half way round?"""
    r = leaf_ints(side, leaf)
    return side.own[r + S.DIM] == 1 and side.own[r + S.SENSES] == S.INSIDE


@kernel
def leads_inside(side, fans, leaf, u, n):
    """Does n, A's frame, lead from an edge's or a vertex's point into the material, where no
    direction of the boundary leads along it: against the normals of the faces that meet there, of a
    vertex each by the area of its corner?"""
    r, total = leaf_ints(side, leaf), 0.0
    feature, own = side.own[r + S.FEATURE], rotate_back(side.pose.R, n)
    if side.own[r + S.DIM] == 0:
        row = FAN_INTS * (feature - side.ints[L.N_FACES] - side.ints[L.N_EDGES])
        for k in range(fans.ints[row + 3]):
            o = fans.ints[row + 2] + CORNER_REALS * k
            total += sin(fans.reals[o + 6]) * dot(corner_normal(fans, o), own)
        return total < 0.0
    for k in range(2):
        total += dot(beside_edge(side, leaf, u, k), own)
    return total < 0.0


@kernel
def corner_normal(fans, o):
    """Of a face's corner at a vertex, outward, own frame."""
    return cross(read_vector(fans.reals, o), read_vector(fans.reals, o + 3))


@kernel
def beside_edge(side, leaf, u, k):
    """The outward normal of one of the two faces beside an edge, own frame; 0 where the edge has no
    tangent."""
    tangent = rotate_back(side.pose.R, leaf_jet(side, leaf, u, 0.0)[1])
    size, row = norm(tangent), edge_record(side.ints, side.own[leaf_ints(side, leaf) + S.FEATURE])
    if size == 0.0:
        return ZERO
    coedge = side.ints[row + (L.EDGE_COEDGE_0 if k == 0 else L.EDGE_COEDGE_1)]
    return coedge_conormal(side.ints, side.reals, coedge, scale(1.0 / size, tangent), u)[1]


@kernel
def corner_beside(fans, row, o):
    """Of the corner at a vertex of which the edge arrives that leaves it in another one."""
    leaving, most, beside = read_vector(fans.reals, o), -1.0, o
    for k in range(fans.ints[row + 3]):
        p = fans.ints[row + 2] + CORNER_REALS * k
        near = dot(arriving_at(fans, p), leaving)
        if near > most:
            most, beside = near, p
    return beside


@kernel
def outline_at(fans, o, beside, along):
    """Of the edge that leaves a vertex in a corner: a unit normal of the solid's outline there, as
    seen along a unit vector, own frame; 0 where it is not of the outline, or not convex. `beside`:
    the corner in which it arrives. An edge that is tilted a little is of the outline."""
    one, two = corner_normal(fans, o), corner_normal(fans, beside)
    s, t = dot(one, along), dot(two, along)
    if s * t > 0.0 and min(abs(s), abs(t)) > NEARLY_OPPOSED:
        return ZERO
    n = add(scale(abs(t), one), scale(abs(s), two))
    size = norm(n)
    return scale(1.0 / size, n) if size > NEARLY_OPPOSED else ZERO


@kernel
def is_between(side, fans, leaf, along, n, sine):
    """Seen along a unit vector, is a vertex the end of a gap of less than half a turn that two
    convex edges bound, and is it of both the nearest to what is ahead along n, A's frame, and of
    hollow edges the farthest?"""
    feature = side.own[leaf_ints(side, leaf) + S.FEATURE]
    row = FAN_INTS * (feature - side.ints[L.N_FACES] - side.ints[L.N_EDGES])
    e, m = rotate_back(side.pose.R, along), rotate_back(side.pose.R, n)
    first, ahead, found = fans.ints[row + 2], ZERO, False
    for i in range(fans.ints[row + 3]):
        o = first + CORNER_REALS * i
        u, beside = read_vector(fans.reals, o), corner_beside(fans, row, o)
        if dot(corner_normal(fans, beside), read_vector(fans.reals, o + 3)) >= 0.0:
            if dot(u, m) < -sine:
                return False
            continue
        out = outline_at(fans, o, beside, e)
        if norm(out) == 0.0 or dot(u, m) > sine:
            continue
        for j in range(i):
            p = first + CORNER_REALS * j
            v, other = read_vector(fans.reals, p), corner_beside(fans, row, p)
            if dot(corner_normal(fans, other), read_vector(fans.reals, p + 3)) >= 0.0:
                continue
            ahead = outline_at(fans, p, other, e)
            if (
                dot(v, m) <= sine
                and dot(out, v) > NEARLY_OPPOSED
                and dot(ahead, u) > NEARLY_OPPOSED
            ):
                found = True
    return found


@kernel
def held_by(side, other, fans, q, leaves, n, sine):
    """What `held_at_hollow` tells, of a vertex or an edge of one solid that has gone into the
    other; all but `n`, from the one to the other, in the order of these two."""
    dims = (
        side.own[leaf_ints(side, leaves[0]) + S.DIM],
        other.own[leaf_ints(other, leaves[1]) + S.DIM],
    )
    if max(dims[0], dims[1]) == 2 or steepest(side, fans[0], leaves[0], q[0], q[1], n) > sine:
        return 0
    if dims[0] == 1 and dims[1] == 0:
        tangent = leaf_jet(side, leaves[0], q[0], q[1])[1]
        size = norm(tangent)
        if size == 0.0:
            return 0
        along = scale(1.0 / size, tangent)
        return 1 if is_between(other, fans[1], leaves[1], along, n, sine) else 0
    if steepest(other, fans[1], leaves[1], q[2], q[3], n) > sine:
        return 0
    return 2 - dims[1] if leads_inside(other, fans[1], leaves[1], q[2], n) else 0


@kernel
def held_at_hollow(a, b, fans, q, leaves, n, sine):
    """How many parameters, of a fillet of no radius, does a pair of points in an overlap have that
    is held at a hollow edge or vertex, or between two edges; 0 where it is not. n is from A to B;
    `sine`: of the angle by which a small step may lead along it."""
    count = held_by(a, b, fans, q, leaves, n, sine)
    if count > 0:
        return count
    around, at = (fans[1], fans[0]), (q[2], q[3], q[0], q[1])
    return held_by(b, a, around, at, (leaves[1], leaves[0]), scale(-1.0, n), sine)
