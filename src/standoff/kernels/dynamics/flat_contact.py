"""Contact over a segment or an area: its corners as spots, each with a depth of its own.

One pair of witness points on parallel faces is any of many, and a box on it would rock. Here the
faces, edges and rulings that are level with a contact's normal are laid over each other along it,
and the corners of what they share carry the load. Between level and tilted the spots give way
to the witness points smoothly, over FLAT_TILT.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

from standoff.kernels.algebra.frames import Frame, frame_across
from standoff.kernels.algebra.rigid import read_vector
from standoff.kernels.algebra.vectors import dot, scale
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.dynamics.arrays import bodies_of
from standoff.kernels.dynamics.flat_parts import (
    AREA,
    MAX_SPOTS,
    NOTHING,
    PLANE,
    SEGMENT,
    Flat,
    Placed,
    flat_part,
)
from standoff.kernels.tolerances import FLAT_TILT

# Corners of a square carry a whole spring each, so one that tips onto an edge or a corner goes on
# with the springs it had; other areas share out as much by the lengths of their sides.
SHARES = 4.0
# Where the scratch has what: seen along the normal (two numbers a corner) A's part, B's, and a
# spare one; then in space (three) A's and B's.
SEEN_A, SEEN_B, SPARE = 0, 2 * MAX_SPOTS, 4 * MAX_SPOTS
SPACE_A, SPACE_B = 6 * MAX_SPOTS, 9 * MAX_SPOTS
N_SPOTS = 12 * MAX_SPOTS
IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


class Shared(NamedTuple):
    """What two flat parts share."""

    count: int  # of its corners
    at: int  # where they stand in the scratch, two numbers each
    even: float  # 1 level, 0 tilted
    a: Flat
    b: Flat
    frame: Frame
    cut: bool  # are they not all corners of one of the parts?


@kernel
def level(tilt):
    """1 where a tilt (radians) is none, 0 from FLAT_TILT on, smooth between."""
    t = min(max(2.0 * tilt / FLAT_TILT - 1.0, 0.0), 1.0)
    return 1.0 - t * t * (3.0 - 2.0 * t)


@kernel
def height(flat, frame, x, y):
    """Where the line along n through (x, y) meets a flat part's plane or segment."""
    n = frame.n
    if flat.kind == SEGMENT:
        way = (dot(flat.along, frame.e), dot(flat.along, frame.f))
        t = (x - dot(flat.point, frame.e)) * way[0] + (y - dot(flat.point, frame.f)) * way[1]
        t /= way[0] * way[0] + way[1] * way[1]
        return dot(flat.point, n) + t * dot(flat.along, n)
    m = flat.along
    across = x * dot(m, frame.e) + y * dot(m, frame.f)
    return (dot(m, flat.point) - across) / dot(m, n)


@kernel
def lay(flat, frame, points, o):
    """Corners of a flat part seen along n, two numbers each, at points[o]."""
    for k in range(flat.count):
        x = read_vector(points, flat.at + 3 * k)
        points[o + 2 * k] = dot(x, frame.e)
        points[o + 2 * k + 1] = dot(x, frame.f)


@kernel
def turned_left(points, o, count):
    """Twice the area of a polygon, above zero where it runs counterclockwise."""
    total = 0.0
    for k in range(count):
        i, j = o + 2 * k, o + 2 * ((k + 1) % count)
        total += points[i] * points[j + 1] - points[j] * points[i + 1]
    return total


@kernel
def cut(points, source, count, target, line, closed):
    """What of a polygon, or of a segment, lies left of a line: how many corners, at `target`."""
    ax, ay, dx, dy = line
    kept = 0
    last = count if closed else count - 1
    for k in range(count):
        i, j = source + 2 * k, source + 2 * ((k + 1) % count)
        s = dx * (points[i + 1] - ay) - dy * (points[i] - ax)
        if s >= 0.0 and kept < MAX_SPOTS:
            points[target + 2 * kept], points[target + 2 * kept + 1] = points[i], points[i + 1]
            kept += 1
        if k >= last:
            continue
        t = dx * (points[j + 1] - ay) - dy * (points[j] - ax)
        if s * t < 0.0 and kept < MAX_SPOTS:
            c = s / (s - t)
            points[target + 2 * kept] = points[i] + c * (points[j] - points[i])
            points[target + 2 * kept + 1] = points[i + 1] + c * (points[j + 1] - points[i + 1])
            kept += 1
    return kept


@kernel
def clip(points, source, count, other, n_other, closed):
    """What of a polygon or segment lies within a polygon: (where, how many corners)."""
    left = 1.0 if turned_left(points, other, n_other) >= 0.0 else -1.0
    spare = SPARE
    for k in range(n_other):
        i, j = other + 2 * k, other + 2 * ((k + 1) % n_other)
        dx, dy = left * (points[j] - points[i]), left * (points[j + 1] - points[i + 1])
        count = cut(points, source, count, spare, (points[i], points[i + 1], dx, dy), closed)
        source, spare = spare, source
        if count == 0:
            break
    return source, count


@kernel
def shared_length(points, a, b):
    """(where, how many, tilt) of what two segments share, seen along the normal."""
    ux, uy = points[a + 2] - points[a], points[a + 3] - points[a + 1]
    vx, vy = points[b + 2] - points[b], points[b + 3] - points[b + 1]
    length, other = sqrt(ux * ux + uy * uy), sqrt(vx * vx + vy * vy)
    if length == 0.0 or other == 0.0:
        return a, 0, 1.0
    tilt = abs(ux * vy - uy * vx) / (length * other)
    ux, uy = ux / length, uy / length
    s = (points[b] - points[a]) * ux + (points[b + 1] - points[a + 1]) * uy
    t = (points[b + 2] - points[a]) * ux + (points[b + 3] - points[a + 1]) * uy
    low, high = max(0.0, min(s, t)), min(length, max(s, t))
    if high <= low:
        return a, 0, tilt
    at = SPARE
    for k, way in ((0, low), (1, high)):
        points[at + 2 * k] = points[a] + way * ux
        points[at + 2 * k + 1] = points[a + 1] + way * uy
    return at, 2, tilt


@kernel
def lies_within(points, flat, at, other, o):
    """Does all of a flat part that is laid at points[at] lie within another one, at points[o]?"""
    if other.kind == PLANE:
        return True
    if flat.kind == PLANE or other.kind == SEGMENT:
        return False
    left = 1.0 if turned_left(points, o, other.count) >= 0.0 else -1.0
    for k in range(other.count):
        i, j = o + 2 * k, o + 2 * ((k + 1) % other.count)
        dx, dy = left * (points[j] - points[i]), left * (points[j + 1] - points[i + 1])
        for c in range(flat.count):
            x, y = points[at + 2 * c], points[at + 2 * c + 1]
            if dx * (y - points[i + 1]) - dy * (x - points[i]) < 0.0:
                return False
    return True


@kernel
def laid_over(a, b, points):
    """(where, how many, how level) of the corners that two flat parts share, which are laid."""
    at_a, at_b = SEEN_A, SEEN_B
    even = level(a.tilt) * level(b.tilt)
    if a.kind == PLANE and b.kind == PLANE:
        return at_a, 0, 0.0
    if a.kind == PLANE:
        return at_b, b.count, even
    if b.kind == PLANE:
        return at_a, a.count, even
    if a.kind == SEGMENT and b.kind == SEGMENT:
        where, count, askew = shared_length(points, at_a, at_b)
        return where, count, even * level(askew)
    if b.kind == SEGMENT:
        where, count = clip(points, at_b, b.count, at_a, a.count, False)
        return where, count, even
    where, count = clip(points, at_a, a.count, at_b, b.count, a.kind == AREA)
    return where, count, even


@kernel
def share(points, where, count, k):
    """What part of a spring corner k carries."""
    if count == 2:
        return 1.0
    total, own = 0.0, 0.0
    for i in range(count):
        p, q = where + 2 * i, where + 2 * ((i + 1) % count)
        dx, dy = points[q] - points[p], points[q + 1] - points[p + 1]
        side = sqrt(dx * dx + dy * dy)
        total += side
        if i == k or (i + 1) % count == k:
            own += side
    return 0.5 * SHARES * own / total if total > 0.0 else 0.0


@kernel
def flat_spots(system, pair, pose, n, heights, points):
    """The corners of a flat contact, in A's frame: none where either body is not flat there.

    `heights` are those of the witness points of A along n, and of B along -n.
    """
    frame = frame_across(n)
    first, second = bodies_of(system, pair)
    a = flat_part(system, Placed(first, IDENTITY, (0.0, 0.0, 0.0)), n, heights[0], points, SPACE_A)
    if a.kind == NOTHING:
        return Shared(0, SEEN_A, 0.0, a, a, frame, False)
    placed = Placed(second, pose.R, pose.p)
    b = flat_part(system, placed, scale(-1.0, n), heights[1], points, SPACE_B)
    if b.kind == NOTHING:
        return Shared(0, SEEN_A, 0.0, a, b, frame, False)
    lay(a, frame, points, SEEN_A)
    lay(b, frame, points, SEEN_B)
    # before they are laid over each other, which writes over them
    whole = lies_within(points, b, SEEN_B, a, SEEN_A) or lies_within(points, a, SEEN_A, b, SEEN_B)
    at, count, even = laid_over(a, b, points)
    return Shared(count, at, even, a, b, frame, not whole)
