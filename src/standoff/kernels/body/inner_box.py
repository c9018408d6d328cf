"""A rectangle of parameters that lies on a trimmed face: inside it nothing needs to be asked.

Found once, when a body is made, by the same walks along the boundary that a frame makes.
"""

from math import inf

import numpy as np

from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_record, coedge_parameters, coedge_record
from standoff.kernels.body.trimming import NO_HIT, on_face, walk_face
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.tolerances import (
    INNER_GRID,
    INNER_HALVINGS,
    INNER_SAMPLES,
)


@kernel
def fits(ints, reals, chart, box):
    """Does a rectangle (u0, u1, v0, v1) lie on the face?

    No side meets the boundary and a corner lies on the face: so does all of the rectangle, as a
    face has one loop, and if that lay inside, the corner would be outside.
    """
    u0, u1, v0, v1 = box
    return (
        walk_face(ints, reals, chart, u0, v0, u1 - u0, 0.0)[1] == NO_HIT
        and walk_face(ints, reals, chart, u1, v0, 0.0, v1 - v0)[1] == NO_HIT
        and walk_face(ints, reals, chart, u1, v1, u0 - u1, 0.0)[1] == NO_HIT
        and walk_face(ints, reals, chart, u0, v1, 0.0, v0 - v1)[1] == NO_HIT
        and on_face(ints, reals, chart, u0, v0)
    )


@kernel
def loop_points(ints, reals, chart):
    """Points (u, v) of the trimming loop, in one array."""
    r = chart_record(ints, chart)
    first, n = ints[r + L.CHART_COEDGE], ints[r + L.CHART_N_COEDGES]
    points, count = np.empty((n * INNER_SAMPLES, 2)), 0
    for k in range(first, first + n):
        o = ints[coedge_record(ints, k) + L.COEDGE_REALS]
        t0, t1 = reals[o + L.PCURVE_FIRST], reals[o + L.PCURVE_LAST]
        for i in range(INNER_SAMPLES):
            t = t0 + (t1 - t0) * i / (INNER_SAMPLES - 1)
            u, v, _, _, depth = coedge_parameters(ints, reals, k, t)
            if depth > 0.0:
                points[count, 0], points[count, 1] = u, v
                count += 1
    return points, count


@kernel
def bounds(points, count, reach):
    """(u0, u1, v0, v1) of some points, each within the reach."""
    u0, u1, v0, v1 = inf, -inf, inf, -inf
    for k in range(count):
        u0, u1 = min(u0, points[k, 0]), max(u1, points[k, 0])
        v0, v1 = min(v0, points[k, 1]), max(v1, points[k, 1])
    return max(u0, -reach), min(u1, reach), max(v0, -reach), min(v1, reach)


@kernel
def middle(ints, reals, chart, points, count, box):
    """(found, u, v): of a grid over a rectangle the point on the face farthest from its loop."""
    u0, u1, v0, v1 = box
    best, at_u, at_v = 0.0, 0.0, 0.0
    for k in range(INNER_GRID * INNER_GRID):
        u = u0 + (u1 - u0) * (k % INNER_GRID + 0.5) / INNER_GRID
        v = v0 + (v1 - v0) * (k // INNER_GRID + 0.5) / INNER_GRID
        least = inf
        for m in range(count):
            a, b = (points[m, 0] - u) / (u1 - u0), (points[m, 1] - v) / (v1 - v0)
            least = min(least, a * a + b * b)
        if least > best and on_face(ints, reals, chart, u, v):
            best, at_u, at_v = least, u, v
    return best > 0.0, at_u, at_v


@kernel
def mixed(s, a, b):
    """(1 - s) a + s b of two rectangles."""
    return (
        a[0] + s * (b[0] - a[0]),
        a[1] + s * (b[1] - a[1]),
        a[2] + s * (b[2] - a[2]),
        a[3] + s * (b[3] - a[3]),
    )


@kernel
def grown(ints, reals, chart, least, most):
    """The largest of the rectangles between two that was seen to fit; the lesser one fits."""
    low, high = 0.0, 1.0
    for _ in range(INNER_HALVINGS):
        s = 0.5 * (low + high)
        if fits(ints, reals, chart, mixed(s, least, most)):
            low = s
        else:
            high = s
    return mixed(low, least, most)


@kernel
def inner_box(ints, reals, chart, reach):
    """(u0, u1, v0, v1): parameters on a chart's face, |u| and |v| at most `reach`; u0 > u1 where
    none was found."""
    r = chart_record(ints, chart)
    reach = min(reach, reals[ints[r + L.CHART_REALS] + L.LIMIT])
    if ints[r + L.CHART_N_COEDGES] == 0:
        return -reach, reach, -reach, reach
    points, count = loop_points(ints, reals, chart)
    most = bounds(points, count, reach)
    if not (most[0] < most[1] and most[2] < most[3]):
        return L.NO_INNER
    found, u, v = middle(ints, reals, chart, points, count, most)
    if not found:
        return L.NO_INNER
    box = grown(ints, reals, chart, (u, u, v, v), most)
    if not fits(ints, reals, chart, box):
        return L.NO_INNER
    # each side by itself, as far as the others let it
    box = grown(ints, reals, chart, box, (most[0], box[1], box[2], box[3]))
    box = grown(ints, reals, chart, box, (box[0], most[1], box[2], box[3]))
    box = grown(ints, reals, chart, box, (box[0], box[1], most[2], box[3]))
    return grown(ints, reals, chart, box, (box[0], box[1], box[2], most[3]))
