"""Leaves of a solid: their jets, and which boxes of parameters a face's trimming curves meet."""

from math import inf

from standoff.kernels.algebra.vectors import cross, dot, norm, rotate, scale
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    chart_jet,
    chart_record,
    coedge_parameters,
    edge_jet,
    moved_jet,
    vertex_point,
)
from standoff.kernels.body.trimming import on_face
from standoff.kernels.compiler.decorators import kernel, reals_on_stack, shared
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_tolerances import PARAMETER_SPARE
from standoff.kernels.solids.torus_potential import TORUS_THROUGH, Potential

ZERO = (0.0, 0.0, 0.0)
OUTSIDE_TRIM, INSIDE_TRIM, CUT_BY_TRIM = 0, 1, 2
# Parts of a trimming curve that wait, each with the parameters and the points of both its ends: a
# stack has 144 numbers.
WAITING, TRIM_PART = 24, 6


@kernel
def leaf_ints(side, leaf):
    return side.own[S.LEAVES] + S.LEAF_INTS * leaf


@kernel
def leaf_reals(side, leaf):
    return side.own[S.R_LEAVES] + S.LEAF_STRIDE * leaf


@kernel
def leaf_box(side, leaf):
    o = leaf_reals(side, leaf)
    n = side.numbers
    return S.Box(n[o], n[o + 1], n[o + 2], n[o + 3])


@kernel
def own_jet(side, leaf, u, v):
    """Point and derivatives in the solid's own frame; zeros where a leaf has no parameter."""
    r = leaf_ints(side, leaf)
    dim = side.own[r + S.DIM]
    if dim == 2:
        return chart_jet(side.ints, side.reals, side.own[r + S.CHART], u, v)
    if dim == 1:
        x, xt, xtt = edge_jet(side.ints, side.reals, side.own[r + S.FEATURE], u)
        return x, xt, ZERO, xtt, ZERO, ZERO
    return (
        vertex_point(side.ints, side.reals, side.own[r + S.FEATURE]),
        ZERO,
        ZERO,
        ZERO,
        ZERO,
        ZERO,
    )


@shared
def leaf_jet(side, leaf, u, v):
    return moved_jet(side.pose, own_jet(side, leaf, u, v))


@kernel
def outward_normal(side, leaf, jet):
    """Of a face, from its jet, towards where the other solid is."""
    r = leaf_ints(side, leaf)
    c = chart_record(side.ints, side.own[r + S.CHART])
    sign = side.reals[side.ints[c + L.CHART_REALS] + L.OUTWARD]
    if side.sense == S.INSIDE:
        sign = -sign
    normal = cross(jet[1], jet[2])
    length = norm(normal)
    return scale(sign / length, normal) if length > 0.0 else ZERO


@kernel
def is_plane_leaf(side, leaf):
    """Of a chart with straight parameters: a turned line may be flat too."""
    r = leaf_ints(side, leaf)
    if side.own[r + S.DIM] != 2 or side.own[r + S.NATURAL] != TORUS_THROUGH:
        return False
    c = chart_record(side.ints, side.own[r + S.CHART])
    return side.ints[c + L.CHART_KIND] == L.PLANE


@kernel
def natural(side, leaf):
    """(known, potential) that is 0 on the face and grows towards the other solid, in A's frame."""
    r, o = leaf_ints(side, leaf), leaf_reals(side, leaf) + S.NATURAL_REALS
    kind = side.own[r + S.NATURAL]
    m = side.numbers
    known = kind >= 0
    sign = -m[o] if side.sense == S.INSIDE else m[o]
    point = rotate(side.pose.R, (m[o + 3], m[o + 4], m[o + 5]))
    p = side.pose.p
    point = (point[0] + p[0], point[1] + p[1], point[2] + p[2])
    axis = rotate(side.pose.R, (m[o + 6], m[o + 7], m[o + 8]))
    if kind == TORUS_THROUGH:
        axis, sign = scale(sign, axis), 1.0
    return known, Potential(kind, point, ZERO, ZERO, axis, m[o + 1], m[o + 2], sign)


@kernel
def meets(a, b):
    return a.u0 <= b.u1 and b.u0 <= a.u1 and a.v0 <= b.v1 and b.v0 <= a.v1


@kernel
def trim_point(side, piece, t):
    """A point (u, v) of a piece of a trimming curve, in the chart itself."""
    coedge = side.own[side.own[S.PIECES] + S.PIECE_INTS * piece]
    u, v, _, _, _ = coedge_parameters(side.ints, side.reals, coedge, t)
    return u, v


@kernel
def is_bent(side, piece):
    """Is there no bound of how much a piece of a trimming curve bends?"""
    o = side.own[S.R_PIECES] + S.PIECE_REALS * piece + S.P_BEND
    return side.numbers[o] == inf or side.numbers[o + 1] == inf


@kernel
def whole_box(side, piece):
    o = side.own[S.R_PIECES] + S.PIECE_REALS * piece + S.P_BOX
    m = side.numbers
    return S.Box(m[o], m[o + 1], m[o + 2], m[o + 3])


@kernel
def box_between(side, piece, length, p, q):
    """A box in (u, v) round a part of a piece of a trimming curve, of so much of its parameter
    between two points."""
    box = whole_box(side, piece)
    m, o = side.numbers, side.own[S.R_PIECES] + S.PIECE_REALS * piece
    (ua, va), (ub, vb) = p, q
    h2 = 0.125 * length * length
    shift = m[o + S.P_SHIFT]
    spare_u = m[o + S.P_BEND] * h2 + PARAMETER_SPARE * (abs(ua) + abs(ub) + abs(shift))
    spare_v = m[o + S.P_BEND + 1] * h2 + PARAMETER_SPARE * (abs(va) + abs(vb))
    return S.Box(
        max(box.u0, min(ua, ub) + shift - spare_u),
        min(box.u1, max(ua, ub) + shift + spare_u),
        max(box.v0, min(va, vb) - spare_v),
        min(box.v1, max(va, vb) + spare_v),
    )


@kernel
def part_box(side, piece, ta, tb):
    """A box in (u, v) round a part of a piece of a trimming curve."""
    if is_bent(side, piece):
        return whole_box(side, piece)
    p, q = trim_point(side, piece, ta), trim_point(side, piece, tb)
    return box_between(side, piece, tb - ta, p, q)


@kernel
def put_part(stack, k, ends, p, q):
    """Put a part of a trimming curve, with its points at both ends, in the k-th place."""
    o = TRIM_PART * k
    stack[o], stack[o + 1] = ends
    stack[o + 2], stack[o + 3] = p
    stack[o + 4], stack[o + 5] = q


@kernel
def put_whole(side, piece, stack):
    """Put the whole of a piece in the first place."""
    o = side.own[S.R_PIECES] + S.PIECE_REALS * piece
    ta, tb = side.numbers[o + S.T0], side.numbers[o + S.T1]
    put_part(stack, 0, (ta, tb), trim_point(side, piece, ta), trim_point(side, piece, tb))


@kernel
def part_in_place(stack, k):
    """(parameters at both ends, the points there) of the k-th part."""
    o = TRIM_PART * k
    ends, p = (stack[o], stack[o + 1]), (stack[o + 2], stack[o + 3])
    return ends, p, (stack[o + 4], stack[o + 5])


@kernel
def put_both_halves(side, piece, stack, k, part):
    """Put both halves of a part in the k-th place and the next; one point is all that is new."""
    (ta, tb), p, q = part
    t = 0.5 * (ta + tb)
    r = trim_point(side, piece, t)
    put_part(stack, k, (ta, t), p, r)
    put_part(stack, k + 1, (t, tb), r, q)


@kernel
def piece_meets(side, piece, box):
    """May a piece of a trimming curve meet a box? False is proven."""
    if not meets(whole_box(side, piece), box):
        return False
    if is_bent(side, piece):
        return True
    stack = reals_on_stack(144)
    put_whole(side, piece, stack)
    count, rounds = 1, 0
    while count > 0:
        count -= 1
        ends, p, q = part_in_place(stack, count)
        part = box_between(side, piece, ends[1] - ends[0], p, q)
        if not meets(part, box):
            continue
        rounds += 1
        small = part.u1 - part.u0 <= 0.25 * (box.u1 - box.u0) or (
            part.v1 - part.v0 <= 0.25 * (box.v1 - box.v0)
        )
        inside = box.u0 <= part.u0 and part.u1 <= box.u1 and box.v0 <= part.v0 and part.v1 <= box.v1
        if inside or rounds > 40 or count >= WAITING - 2 or (small and rounds > 20):
            return True
        put_both_halves(side, piece, stack, count, (ends, p, q))
        count += 2
    return False


@shared
def trim_state(side, leaf, box):
    """Is a box of a face's parameters outside the face, on it, or cut by its trimming curves?"""
    r = leaf_ints(side, leaf)
    own = side.own
    if own[r + S.DIM] != 2 or own[r + S.CUT] == 0:
        return INSIDE_TRIM
    first = own[S.LISTS] + own[r + S.LIST]
    for k in range(own[r + S.N_LIST]):
        if piece_meets(side, own[first + k], box):
            return CUT_BY_TRIM
    chart = own[r + S.CHART]
    u, v = 0.5 * (box.u0 + box.u1), 0.5 * (box.v0 + box.v1)
    if on_face(side.ints, side.reals, chart, u, v):
        return INSIDE_TRIM
    return OUTSIDE_TRIM


@kernel
def on_solid(side, leaf, u, v):
    """Is a leaf's point on the solid?"""
    r = leaf_ints(side, leaf)
    if side.own[r + S.DIM] != 2 or side.own[r + S.CUT] == 0:
        return True
    return on_face(side.ints, side.reals, side.own[r + S.CHART], u, v)


@kernel
def reach_of(side, leaf, du, dv):
    """A bound on the distance of a leaf's points whose parameters differ by (du, dv)."""
    o = leaf_reals(side, leaf) + S.FIRST
    return side.numbers[o] * du + side.numbers[o + 1] * dv


@kernel
def along(side, leaf, jet, n, h):
    """How far a leaf reaches along n from a point with this jet, over half widths h of its
    parameters, at most."""
    o, m = leaf_reals(side, leaf), side.numbers
    second = m[o + S.SECOND] * h[0] * h[0] + m[o + S.SECOND + 2] * h[1] * h[1]
    second += 2.0 * m[o + S.SECOND + 1] * h[0] * h[1]
    return abs(dot(n, jet[1])) * h[0] + abs(dot(n, jet[2])) * h[1] + 0.5 * second
