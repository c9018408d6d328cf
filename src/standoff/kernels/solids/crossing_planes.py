"""Trimmed pieces of two planes that cross: apart, if no point of the line common to both planes is
in both pieces."""

from math import inf

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import axpy, cross, dot, norm, scale, sub
from standoff.kernels.compiler.decorators import kernel, reals_on_stack, shared
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_pieces import (
    OUTSIDE_TRIM,
    is_plane_leaf,
    leaf_jet,
    trim_state,
)
from standoff.kernels.solids.spatial_tolerances import CROSSING_SPARE, LEAST_CROSSING

# Parts of the line that are looked at, and that wait.
MOST_PARTS, PARTS_WAITING = 64, 20


@kernel
def line_in(jet, box, point, along, spare):
    """(u, v, du, dv, spare_u, spare_v, s0, s1): a line in a plane by its parameters, what they may
    be wrong by, and the part of it over a box."""
    _, xu, xv, _, _, _ = jet
    uu, uv, vv = dot(xu, xu), dot(xu, xv), dot(xv, xv)
    det = uu * vv - uv * uv
    off = sub(point, jet[0])
    pu, pv, wu, wv = dot(off, xu), dot(off, xv), dot(along, xu), dot(along, xv)
    u = 0.5 * (box.u0 + box.u1) + (pu * vv - pv * uv) / det
    v = 0.5 * (box.v0 + box.v1) + (pv * uu - pu * uv) / det
    du, dv = (wu * vv - wv * uv) / det, (wv * uu - wu * uv) / det
    spare_u, spare_v = spare * sqrt(vv / det), spare * sqrt(uu / det)
    s0, s1 = clipped(u, du, box.u0 - spare_u, box.u1 + spare_u, -inf, inf)
    s0, s1 = clipped(v, dv, box.v0 - spare_v, box.v1 + spare_v, s0, s1)
    return u, v, du, dv, spare_u, spare_v, s0, s1


@kernel
def clipped(x, dx, low, high, s0, s1):
    """The part of s0 to s1 where x + s dx is between two numbers; empty: s0 > s1."""
    if dx == 0.0:
        return (s0, s1) if low <= x <= high else (1.0, -1.0)
    first, last = (low - x) / dx, (high - x) / dx
    return max(s0, min(first, last)), min(s1, max(first, last))


@kernel
def off_the_face(part, line, s0, s1):
    """Is a part of a line proven to hold no point of the face in a box?"""
    u, v, du, dv, spare_u, spare_v, _, _ = line
    box = part.box
    ua, ub, va, vb = u + s0 * du, u + s1 * du, v + s0 * dv, v + s1 * dv
    near = S.Box(
        max(min(ua, ub) - spare_u, box.u0),
        min(max(ua, ub) + spare_u, box.u1),
        max(min(va, vb) - spare_v, box.v0),
        min(max(va, vb) + spare_v, box.v1),
    )
    if near.u0 > near.u1 or near.v0 > near.v1:
        return True
    return trim_state(part.side, part.leaf, near) == OUTSIDE_TRIM


@shared
def planes_apart(a, b, size):
    """Are two pieces of planes, whose normals are not opposite, proven to have no common point?

    Then they hold no nearest pair either: ``docs/closing.md``, rule 3.
    """
    sided = a.side.sense != S.EITHER and b.side.sense != S.EITHER
    if not (sided and is_plane_leaf(a.side, a.leaf) and is_plane_leaf(b.side, b.leaf)):
        return False
    qa, qb = a.box, b.box
    ja = leaf_jet(a.side, a.leaf, 0.5 * (qa.u0 + qa.u1), 0.5 * (qa.v0 + qa.v1))
    jb = leaf_jet(b.side, b.leaf, 0.5 * (qb.u0 + qb.u1), 0.5 * (qb.v0 + qb.v1))
    na, nb = cross(ja[1], ja[2]), cross(jb[1], jb[2])
    na, nb = scale(1.0 / norm(na), na), scale(1.0 / norm(nb), nb)
    along = cross(na, nb)
    sine = norm(along)
    if sine < LEAST_CROSSING:
        return False
    along = scale(1.0 / sine, along)
    toward = cross(na, along)
    point = axpy(dot(sub(jb[0], ja[0]), nb) / dot(toward, nb), toward, ja[0])
    spare = CROSSING_SPARE * (size + norm(sub(jb[0], ja[0])) + norm(jb[0]))
    line_a, line_b = line_in(ja, qa, point, along, spare), line_in(jb, qb, point, along, spare)
    stack = reals_on_stack(44)
    stack[0], stack[1] = max(line_a[6], line_b[6]), min(line_a[7], line_b[7])
    count, rounds = 1, 0
    while count > 0:
        count -= 1
        s0, s1 = stack[2 * count], stack[2 * count + 1]
        if s0 > s1 or off_the_face(a, line_a, s0, s1) or off_the_face(b, line_b, s0, s1):
            continue
        rounds += 1
        if rounds > MOST_PARTS or count >= PARTS_WAITING:
            return False
        s = 0.5 * (s0 + s1)
        stack[2 * count], stack[2 * count + 1] = s0, s
        stack[2 * count + 2], stack[2 * count + 3] = s, s1
        count += 2
    return True
