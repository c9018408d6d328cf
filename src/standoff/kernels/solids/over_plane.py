"""What of a leaf is over a plane face: the only part that can be nearest to a point within it.

A nearest pair whose point a is within a plane face has its other point on the normal at a, so that
point's foot in the plane is on the face, and it is above it (``docs/closing.md``, rule 3).
"""

from typing import Any, NamedTuple

from standoff.kernels.algebra.vectors import axpy, dot, norm, scale
from standoff.kernels.compiler.decorators import kernel, reals_on_stack
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_bounds import greatest
from standoff.kernels.solids.spatial_heights import height_greatest
from standoff.kernels.solids.spatial_minimum import plane_between
from standoff.kernels.solids.spatial_pieces import (
    OUTSIDE_TRIM,
    is_plane_leaf,
    leaf_jet,
    leaf_reals,
    outward_normal,
    trim_state,
)
from standoff.kernels.solids.spatial_tolerances import SMOOTH_SPARE

# Boxes that wait; the stack holds 4 numbers of each, and 2 boxes more.
MOST_WAITING = 24


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


class Feet(NamedTuple):
    """Where a part is over a plane.

    Attributes
    ----------
    low, high : its heights, length.
    u, v : (least, greatest) parameter of its feet in the plane, from the middle of the face's box,
        over `lengths`, so that they are lengths.
    lengths : of the parameters' gradients in the plane, one over length.
    """

    low: Any
    high: Any
    u: Any
    v: Any
    lengths: Any


@kernel
def feet_of(jet, n, part):
    """Of a part over the plane of a face, from the face's jet and outward normal."""
    low, high = range_along(part, jet[0], n)
    xu, xv = jet[1], jet[2]
    uu, uv, vv = dot(xu, xu), dot(xu, xv), dot(xv, xv)
    det = uu * vv - uv * uv
    dual = axpy(-uv / det, xv, scale(vv / det, xu))
    lu = norm(dual)
    u = range_along(part, jet[0], scale(1.0 / lu, dual))
    dual = axpy(-uv / det, xu, scale(uu / det, xv))
    lv = norm(dual)
    v = range_along(part, jet[0], scale(1.0 / lv, dual))
    return Feet(low, high, u, v, (lu, lv))


@kernel
def not_over(face, feet, goal, rounding):
    """Is no point of a part over a face at a height from 0 to less than `goal`?"""
    if feet.low - rounding >= goal or feet.high < -rounding:
        return True
    spare = rounding + SMOOTH_SPARE * max(abs(feet.low), abs(feet.high))
    box, (lu, lv) = face.box, feet.lengths
    u, v = 0.5 * (box.u0 + box.u1), 0.5 * (box.v0 + box.v1)
    u0 = max(u + (feet.u[0] - spare) * lu, box.u0)
    u1 = min(u + (feet.u[1] + spare) * lu, box.u1)
    if u0 > u1:
        return True
    v0 = max(v + (feet.v[0] - spare) * lv, box.v0)
    v1 = min(v + (feet.v[1] + spare) * lv, box.v1)
    if v0 > v1:
        return True
    return trim_state(face.side, face.leaf, S.Box(u0, u1, v0, v1)) == OUTSIDE_TRIM


@kernel
def beside_by(face, feet, goal, rounding, share):
    """How far B may move before a part may be over a face's box at a height from 0 to less than
    `goal`, which may grow as much, length; below 0: it may be now. By that motion the part, as the
    plane sees it, moves by `share` as much, at most."""
    free = (feet.low - rounding - goal) / (1.0 + share)
    free = max(free, (-feet.high - rounding) / share)
    spare = rounding + SMOOTH_SPARE * max(abs(feet.low), abs(feet.high))
    box, (lu, lv) = face.box, feet.lengths
    half_u, half_v = 0.5 * (box.u1 - box.u0) / lu, 0.5 * (box.v1 - box.v0) / lv
    beside = max(max(feet.u[0], -feet.u[1]) - half_u, max(feet.v[0], -feet.v[1]) - half_v)
    return max(free, (beside - spare) / (share * (1.0 + SMOOTH_SPARE)))


@kernel
def has_sides(face, part):
    """Is one a plane's face, and does each of both look to one side?"""
    sided = face.side.sense != S.EITHER and part.side.sense != S.EITHER
    return sided and is_plane_leaf(face.side, face.leaf)


@kernel
def plane_of(face):
    """(jet, outward normal) in the middle of a plane's face."""
    box = face.box
    u, v = 0.5 * (box.u0 + box.u1), 0.5 * (box.v0 + box.v1)
    jet = leaf_jet(face.side, face.leaf, u, v)
    return jet, outward_normal(face.side, face.leaf, jet)


@kernel
def clear_of_plane(face, part, goal, rounding, most, counts):
    """Is it proven, of a plane face and a part of another solid, that they have no common point,
    and no nearest pair within the face that is nearer than `goal`? Looks at `most` boxes."""
    if not has_sides(face, part):
        return False
    jet, n = plane_of(face)
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
        if not_over(face, feet_of(jet, n, S.Part(side, leaf, b)), goal, rounding):
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
