"""What of a leaf is over a plane face: the only part that can be nearest to a point within it.

A nearest pair whose point a is within a plane face has its other point on the normal at a, so that
point's foot in the plane is on the face, and it is above it (``docs/closing.md``, rule 3).
"""

from standoff.kernels.algebra.vectors import axpy, dot, norm, scale
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_record
from standoff.kernels.compiler.decorators import kernel, reals_on_stack
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_bounds import greatest
from standoff.kernels.solids.spatial_heights import height_greatest
from standoff.kernels.solids.spatial_minimum import plane_between
from standoff.kernels.solids.spatial_pieces import (
    OUTSIDE_TRIM,
    leaf_ints,
    leaf_jet,
    leaf_reals,
    outward_normal,
    trim_state,
)
from standoff.kernels.solids.spatial_tolerances import SMOOTH_SPARE
from standoff.kernels.solids.torus_potential import TORUS_THROUGH

# Boxes that wait; the stack holds 4 numbers of each, and 2 boxes more.
MOST_WAITING = 24


@kernel
def is_plane_leaf(side, leaf):
    """Of a chart with straight parameters: a turned line may be flat too."""
    r = leaf_ints(side, leaf)
    if side.own[r + S.DIM] != 2 or side.own[r + S.NATURAL] != TORUS_THROUGH:
        return False
    c = chart_record(side.ints, side.own[r + S.CHART])
    return side.ints[c + L.CHART_KIND] == L.PLANE


@kernel
def range_along(part, o, n):
    """The least and the greatest n . (x - o) of a part; trims are not looked at."""
    side, leaf, box = part.side, part.leaf, part.box
    phi = plane_between(o, o, n)
    known, high = height_greatest(phi, 1.0, side, leaf, box)
    if known:
        return -height_greatest(phi, -1.0, side, leaf, box)[1], high
    u, v = 0.5 * (box.u0 + box.u1), 0.5 * (box.v0 + box.v1)
    high = greatest(phi, 1.0, side, leaf, box, u, v)[0]
    return -greatest(phi, -1.0, side, leaf, box, u, v)[0], high


@kernel
def foot_range(part, o, dual, spare):
    """How far the feet of a part are from o along a parameter of a plane: dual . (x - o)."""
    length = norm(dual)
    low, high = range_along(part, o, scale(1.0 / length, dual))
    return (low - spare) * length, (high + spare) * length


@kernel
def not_over(face, jet, n, part, goal, rounding):
    """Is no point of a part over a face at a height from 0 to less than `goal`?"""
    low, high = range_along(part, jet[0], n)
    if low - rounding >= goal or high < -rounding:
        return True
    spare = rounding + SMOOTH_SPARE * max(abs(low), abs(high))
    xu, xv = jet[1], jet[2]
    uu, uv, vv = dot(xu, xu), dot(xu, xv), dot(xv, xv)
    det = uu * vv - uv * uv
    box = face.box
    u, v = 0.5 * (box.u0 + box.u1), 0.5 * (box.v0 + box.v1)
    dual = axpy(-uv / det, xv, scale(vv / det, xu))
    u0, u1 = foot_range(part, jet[0], dual, spare)
    u0, u1 = max(u + u0, box.u0), min(u + u1, box.u1)
    if u0 > u1:
        return True
    dual = axpy(-uv / det, xu, scale(uu / det, xv))
    v0, v1 = foot_range(part, jet[0], dual, spare)
    v0, v1 = max(v + v0, box.v0), min(v + v1, box.v1)
    if v0 > v1:
        return True
    return trim_state(face.side, face.leaf, S.Box(u0, u1, v0, v1)) == OUTSIDE_TRIM


@kernel
def clear_of_plane(face, part, goal, rounding, most, counts):
    """Is it proven, of a plane face and a part of another solid, that they have no common point,
    and no nearest pair within the face that is nearer than `goal`? Looks at `most` boxes."""
    sided = face.side.sense != S.EITHER and part.side.sense != S.EITHER
    if not sided or not is_plane_leaf(face.side, face.leaf):
        return False
    box = face.box
    u, v = 0.5 * (box.u0 + box.u1), 0.5 * (box.v0 + box.v1)
    jet = leaf_jet(face.side, face.leaf, u, v)
    n = outward_normal(face.side, face.leaf, jet)
    side, leaf, b = part.side, part.leaf, part.box
    o, m = leaf_reals(side, leaf), side.numbers
    stack = reals_on_stack(108)
    stack[0], stack[1], stack[2], stack[3] = b.u0, b.u1, b.v0, b.v1
    count, rounds = 1, 0
    while count > 0:
        count -= 1
        k = 4 * count
        b = S.Box(stack[k], stack[k + 1], stack[k + 2], stack[k + 3])
        rounds += 1
        counts[0] += 1
        if not_over(face, jet, n, S.Part(side, leaf, b), goal, rounding):
            continue
        wide_u = m[o + S.FIRST] * (b.u1 - b.u0)
        wide_v = m[o + S.FIRST + 1] * (b.v1 - b.v0)
        if rounds >= most or count >= MOST_WAITING or wide_u + wide_v <= 0.0:
            return False
        if rounds > 1 and trim_state(side, leaf, b) == OUTSIDE_TRIM:
            continue
        for i in range(2):
            k = 4 * (count + i)
            stack[k], stack[k + 1], stack[k + 2], stack[k + 3] = b.u0, b.u1, b.v0, b.v1
            if wide_u >= wide_v:
                stack[k + 1 - i] = 0.5 * (b.u0 + b.u1)
            else:
                stack[k + 3 - i] = 0.5 * (b.v0 + b.v1)
        count += 2
    return True
