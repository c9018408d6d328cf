"""Cells of boundaries, and the least distance of two boundaries, compiled.

The signed distance from the other solid is a closed form and changes by no more than the length of
a move, so its value at the middle of a cell, less the cell's radius, bounds it over the cell. The
cell with the least bound is cut in four, until no cell may be nearer than what was found, or there
are too many: the least bound that is left then bounds the distance from below. A walk downhill from
the best cells bounds it from above.
"""

from __future__ import annotations

from math import cos, hypot, inf, pi, sin
from typing import Any, NamedTuple

import numpy as np

from standoff_studies.soak.solid_forms import (
    ROW,
    Array,
    Form,
    compiled,
    holds,
    nearest,
    place,
    signed,
)

TURNED_PATCH, WALL, LEVEL, EGG_PATCH = 0.0, 1.0, 2.0, 3.0
PATCH = 24 + ROW
"""Numbers of a patch: its kind; first and last angle or height; greatest speed of its curve; axes,
row by row; origin; which outline; a box; the curve."""
SPEED, AXES, ORIGIN, WHICH, BOX, CURVE = 3, 4, 13, 16, 17, 24
MOST = 700
"""Cells of a pose that are cut."""
FIRST_WALKS, WALKS, LAST_WALKS = 3, 8, 4
"""Walks downhill of a pose: from the best patches, from cells that are nearer than any before, and
from the best that are left."""
STEPS = 70
"""Of a walk."""
STRIDE, LEAST_STRIDE = 0.02, 1e-13
"""Of a patch: the first step, and the last."""
WAYS = (
    (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0),
    (1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0),
)  # fmt: skip
CLEAR = 1e-9
"""Of the size: a point is on one side of a boundary if it is farther from it."""
CLOSED = 1e-5
"""Of the size: cells that may be nearer by less are not cut."""


class Boundary(NamedTuple):
    """A solid with its cells, as the compiled functions read it.

    Attributes
    ----------
    form : Form
    patches : (p, PATCH) array
    cells : (m, 9) array
        Of the start: patch; middle and half widths in (u, v); point; radius.
    size : float
        Length.
    """

    form: Form
    patches: Array
    cells: Array
    size: float


@compiled
def level_cell(patch, rows, u, v, du, dv):
    """Of what an outline holds, at a height."""
    wide, deep = patch[BOX + 2] - patch[BOX], patch[BOX + 3] - patch[BOX + 1]
    x, y = patch[BOX] + u * wide, patch[BOX + 1] + v * deep
    radius = hypot(du * wide, dv * deep)
    if not holds(rows, x, y):
        away, x, y = nearest(rows, x, y)
        radius = radius + away if away <= radius else -1.0
    return x, y, patch[1], radius


@compiled
def egg_cell(semiaxes, u, v, du, dv):
    """Of an ellipsoid, by longitude and latitude."""
    angle, height = 2.0 * pi * u, pi * (v - 0.5)
    a, b, c = semiaxes[0], semiaxes[1], semiaxes[2]
    along = pi * dv
    across = 2.0 * pi * du * min(1.0, cos(height) + along)
    x, y, z = a * cos(height) * cos(angle), b * cos(height) * sin(angle), c * sin(height)
    return x, y, z, max(a, b, c) * hypot(along, across)


@compiled
def cell(form, patch, u, v, du, dv):
    """(x, y, z, radius): a point of the boundary, and how far all of it in a cell is from that at
    most; a radius below 0 where there is none of it."""
    if patch[0] == LEVEL:
        return level_cell(patch, form.rows if patch[WHICH] == 0.0 else form.cavity, u, v, du, dv)
    if patch[0] == EGG_PATCH:
        return egg_cell(form.numbers, u, v, du, dv)
    wide = patch[2] - patch[1]
    row = patch[CURVE:]
    if patch[0] == WALL:
        x, y = place(row, u)
        return x, y, patch[1] + v * wide, hypot(patch[SPEED] * du, wide * dv)
    angle = patch[1] + u * wide
    rho, height = place(row, v)
    along = patch[SPEED] * dv
    # chords: (rho' - rho)² + 2 rho rho' (1 - cos) + (z' - z)²
    across = (abs(rho) + along) * du * wide
    p, q = rho * cos(angle), rho * sin(angle)
    m, o = AXES, ORIGIN
    x = patch[m] * p + patch[m + 1] * q + patch[m + 2] * height + patch[o]
    y = patch[m + 3] * p + patch[m + 4] * q + patch[m + 5] * height + patch[o + 1]
    z = patch[m + 6] * p + patch[m + 7] * q + patch[m + 8] * height + patch[o + 2]
    return x, y, z, hypot(along, across)


@compiled
def cells_of(form, patch, boxes):
    """(n, 4) points and radii of cells (u, v, du, dv)."""
    found = np.empty((len(boxes), 4))
    for k in range(len(boxes)):
        b = boxes[k]
        found[k, 0], found[k, 1], found[k, 2], found[k, 3] = cell(
            form, patch, b[0], b[1], b[2], b[3]
        )
    return found


@compiled
def seen(other, R, t, x, y, z):
    """The signed distance of a point, moved by R and t, from the other solid."""
    return signed(
        other,
        R[0, 0] * x + R[0, 1] * y + R[0, 2] * z + t[0],
        R[1, 0] * x + R[1, 1] * y + R[1, 2] * z + t[1],
        R[2, 0] * x + R[2, 1] * y + R[2, 2] * z + t[2],
    )


@compiled
def walked(form, patch, other, R, t, u, v, least):
    """The least distance that a compass search finds on a patch from (u, v)."""
    stride = STRIDE
    for _ in range(STEPS):
        best, bu, bv = least, u, v
        for k in range(8):
            if k == 4 and best < least:
                break  # along the parameters first
            tu = min(1.0, max(0.0, u + WAYS[k][0] * stride))
            tv = min(1.0, max(0.0, v + WAYS[k][1] * stride))
            x, y, z, radius = cell(form, patch, tu, tv, 0.0, 0.0)
            found = abs(seen(other, R, t, x, y, z))
            if radius >= 0.0 and found < best:
                best, bu, bv = found, tu, tv
        if best < least:
            least, u, v = best, bu, bv
            stride *= 1.5
        else:
            stride *= 0.3
            if stride < LEAST_STRIDE:
                break
    return least


@compiled
def pushed(heap, n, bound, k):
    """Put (bound, k) into a heap of n."""
    heap[n, 0], heap[n, 1] = bound, k
    while n > 0 and heap[(n - 1) // 2, 0] > heap[n, 0]:
        up = (n - 1) // 2
        for c in range(2):
            heap[n, c], heap[up, c] = heap[up, c], heap[n, c]
        n = up


@compiled
def popped(heap, n):
    """Take the least out of a heap of n."""
    bound, k = heap[0, 0], heap[0, 1]
    last = n - 1
    heap[0, 0], heap[0, 1] = heap[last, 0], heap[last, 1]
    at = 0
    while True:
        low = at
        for child in (2 * at + 1, 2 * at + 2):
            if child < last and heap[child, 0] < heap[low, 0]:
                low = child
        if low == at:
            return bound, int(k)
        for c in range(2):
            heap[at, c], heap[low, c] = heap[low, c], heap[at, c]
        at = low


@compiled
def begun(own, other, R, t, cells, first):
    """(upper, below, above) of the cells of the start; fills these, and each patch's best one."""
    below, above, upper = inf, -inf, inf
    for k in range(len(own.cells)):
        c = own.cells[k]
        s = seen(other, R, t, c[5], c[6], c[7])
        below, above, upper = min(below, s), max(above, s), min(upper, abs(s))
        for i in range(5):
            cells[k, i] = c[i]
        cells[k, 5] = abs(s)
        p = int(c[0])
        if first[p] < 0 or abs(s) < cells[first[p], 5]:
            first[p] = k
    return upper, below, above


@compiled
def least_distance(own, other, R, t):
    """(lower, upper, below, above): bounds of the distance of two boundaries, and the least and
    the greatest signed distance seen of points of the first from the other solid.

    R and t lead from the first solid's frame into the other's. Boundaries that cross for sure have
    both bounds 0.
    """
    m, count, clear = len(own.cells), 0, CLEAR * own.size
    cells, heap = np.empty((m + 4 * MOST, 6)), np.empty((m + 4 * MOST, 2))
    first = np.full(len(own.patches), -1)
    upper, below, above = begun(own, other, R, t, cells, first)
    if below < -clear and above > clear:
        return 0.0, 0.0, below, above
    upper = walk_from(own, other, R, t, cells, first, upper)
    for k in range(m):
        bound = cells[k, 5] - own.cells[k, 8]
        if bound < upper:
            pushed(heap, count, bound, k)
            count += 1
    used, rounds, walks = m, 0, 0
    while count > 0 and rounds < MOST and heap[0, 0] < upper - CLOSED * own.size:
        _, k = popped(heap, count)
        count -= 1
        rounds += 1
        for i in range(4):
            s, radius = quarter(own, other, R, t, cells, k, used, i)
            if radius < 0.0:
                continue
            below, above = min(below, s), max(above, s)
            if abs(s) < upper:
                upper = abs(s)
                if walks < WALKS:
                    walks += 1
                    upper = walk(own, other, R, t, cells, used, upper)
            if abs(s) - radius < upper:
                pushed(heap, count, abs(s) - radius, used)
                count, used = count + 1, used + 1
        if below < -clear and above > clear:
            return 0.0, 0.0, below, above
    lower = heap[0, 0] if count > 0 else upper
    for _ in range(min(LAST_WALKS, count)):
        _, k = popped(heap, count)
        count -= 1
        upper = walk(own, other, R, t, cells, k, upper)
    return max(0.0, min(lower, upper)), upper, below, above


@compiled
def quarter(own, other, R, t, cells, k, at, i):
    """(signed distance, radius) of a quarter of cell k, which is written at `at`."""
    patch = own.patches[int(cells[k, 0])]
    du, dv = 0.5 * cells[k, 3], 0.5 * cells[k, 4]
    u = cells[k, 1] + (du if i % 2 else -du)
    v = cells[k, 2] + (dv if i // 2 else -dv)
    x, y, z, radius = cell(own.form, patch, u, v, du, dv)
    s = seen(other, R, t, x, y, z)
    cells[at, 0], cells[at, 1], cells[at, 2] = cells[k, 0], u, v
    cells[at, 3], cells[at, 4], cells[at, 5] = du, dv, abs(s)
    return s, radius


@compiled
def walk(own, other, R, t, cells, k, upper):
    """The least of a distance and of what is downhill from a cell."""
    patch = own.patches[int(cells[k, 0])]
    found = walked(own.form, patch, other, R, t, cells[k, 1], cells[k, 2], cells[k, 5])
    return min(upper, found)


@compiled
def walk_from(own, other, R, t, cells, first, upper):
    """The least distance downhill from the best cells, each of another patch."""
    value = np.full(len(first), inf)
    for p in range(len(first)):
        if first[p] >= 0:
            value[p] = cells[first[p], 5]
    for p in np.argsort(value)[:FIRST_WALKS]:
        k = first[p]
        if k >= 0 and cells[k, 5] - own.cells[k, 8] < upper:
            upper = walk(own, other, R, t, cells, k, upper)
    return upper


@compiled
def least_distances(own, other, turns, shifts):
    """(n, 4) rows of `least_distance`."""
    found = np.empty((len(turns), 4))
    for k in range(len(turns)):
        found[k, 0], found[k, 1], found[k, 2], found[k, 3] = least_distance(
            own, other, turns[k], shifts[k]
        )
    return found


def patch_row(kind: float, first: float, last: float, **more: Any) -> Array:
    """A patch as a row of numbers: speed, axes, origin, which, box and curve, where it has them."""
    row = np.zeros(PATCH)
    row[:3] = kind, first, last
    row[SPEED] = more.get("speed", 0.0)
    row[AXES : AXES + 9] = np.asarray(more.get("axes", np.eye(3))).ravel()
    row[ORIGIN : ORIGIN + 3] = more.get("origin", 0.0)
    row[WHICH] = more.get("which", 0.0)
    row[BOX : BOX + 4] = more.get("box", 0.0)
    row[CURVE:] = more.get("curve", 0.0)
    return row
