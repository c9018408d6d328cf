"""Ends of the leaves of edges under plane faces: more spots of a contact that is pressed already.

A round rim that lies on a plane face has no corners. Where it is level its common normals are
anywhere on it, and where it is hardly tilted there is one, so that the rim would rock. The ends of
its leaves stay where they are on it, and each is as deep under the face as it is.
"""

from standoff.kernels.algebra.vectors import axpy, dot, norm, scale, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.contact_minimum import middles_of
from standoff.kernels.solids.contact_sets import NO_MINIMUM, put_normal
from standoff.kernels.solids.over_plane import is_plane_leaf
from standoff.kernels.solids.planar_tolerances import AT_OPTIMUM
from standoff.kernels.solids.spatial_minimum import jets_at, nearest
from standoff.kernels.solids.spatial_pieces import (
    leaf_box,
    leaf_ints,
    leaf_jet,
    on_solid,
    outward_normal,
)
from standoff.kernels.solids.spatial_progress import (
    ABOVE,
    MINIMUM_REALS,
    N_MINIMA,
    SIZE,
    ball_round,
)


@kernel
def dim_of(side, leaf):
    return side.own[leaf_ints(side, leaf) + S.DIM]


@kernel
def end_box(box):
    """The first end of an edge's leaf."""
    return S.Box(box.u0, box.u0, box.v0, box.v0)


@kernel
def is_straight(side, leaf):
    """Is a leaf one of a straight edge?"""
    box = leaf_box(side, leaf)
    return dim_of(side, leaf) == 1 and norm(leaf_jet(side, leaf, box.u0, box.v0)[3]) == 0.0


@kernel
def is_pressed(best, minima):
    """Does a common normal that was found tell an overlap?"""
    least = 0.0
    for i in range(int(best[N_MINIMA])):
        least = min(least, minima[MINIMUM_REALS * i])
    return least < 0.0


@kernel
def keep_end(both, leaves, best, minima, counts):
    """Keep the end of an edge's leaf under a plane face's, if it is there; of other leaves nothing:
    a curved edge is level with a curved face at single points, which are places."""
    dims = dim_of(both.a, leaves[0]), dim_of(both.b, leaves[1])
    if not ((dims[0] == 1 and dims[1] == 2) or (dims[0] == 2 and dims[1] == 1)):
        return
    if not (is_plane_leaf(both.a, leaves[0]) or is_plane_leaf(both.b, leaves[1])):
        return
    if is_straight(both.a, leaves[0]) or is_straight(both.b, leaves[1]):  # it has its vertices
        return
    a, b = leaf_box(both.a, leaves[0]), leaf_box(both.b, leaves[1])
    if dims[0] == 1:
        a = end_box(a)
    else:
        b = end_box(b)
    pa, pb = S.Part(both.a, leaves[0], a), S.Part(both.b, leaves[1], b)
    one, other = ball_round(pa), ball_round(pb)
    if norm(sub(one[0], other[0])) > one[1] + other[1] + best[ABOVE]:
        return
    start = middles_of(pa, pb)
    q = nearest(both.a, leaves[0], a, both.b, leaves[1], b, start, counts)[0]
    ja, jb = jets_at(both.a, leaves[0], both.b, leaves[1], q)
    n = (
        outward_normal(both.a, leaves[0], ja)
        if dims[0] == 2
        else outward_normal(both.b, leaves[1], jb)
    )
    if dims[0] == 1:
        n = scale(-1.0, n)
    delta = sub(jb[0], ja[0])
    d = dot(n, delta)
    across = norm(axpy(-d, n, delta))
    if d >= 0.0 or d < -best[ABOVE] or across > AT_OPTIMUM * best[SIZE]:
        return
    if not (on_solid(both.a, leaves[0], q[0], q[1]) and on_solid(both.b, leaves[1], q[2], q[3])):
        return
    put_normal(leaves, (q, n, d), (ja[0], jb[0]), NO_MINIMUM, best, minima)
