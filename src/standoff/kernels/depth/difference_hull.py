"""A polytope inside the Minkowski difference A - B, grown point by point.

Its vertices are differences x_a - x_b of points of both bodies, so it lies in A - B: a ball about
the origin inside it is inside A - B, and its radius bounds the depth from below. Facets are
triangles, counter-clockwise seen from outside; a facet that goes is replaced by the last one. For
planar bodies the polytope is a prism over their difference, long enough that its ends bound no
depth.

Any closed surface of triangles about the origin bounds the depth, so roundoff in which facets a
point sees costs tightness only.
"""

from math import inf

import numpy as np

from standoff.kernels.algebra.vectors import cross, dot, norm, scale, sub
from standoff.kernels.compiler.decorators import kernel, shared
from standoff.kernels.tolerances import COPLANAR, EPS, FACET_ROUNDINGS, MAX_PROBES, PRISM

# Seeds, probes, minima; two points each for a planar pair.
MAX_POINTS = 2 * (MAX_PROBES + 64)
MAX_FACETS = 2 * MAX_POINTS
# A facet's numbers: unit normal, distance from the origin less its roundoff, and 1 where it is
# known to lie on the boundary of A - B.
NORMAL, OFFSET, CLOSED = 0, 3, 4
FACET_REALS = 5
# Sizes of a polytope, in one array.
POINTS, FACETS, PLANAR = range(3)

GREW, NO_GAIN, BROKEN = range(3)


@kernel
def empty_hull(planar):
    """(sizes, points, corners, facets) of a polytope without points."""
    sizes = np.empty(3, dtype=np.int64)
    sizes[POINTS], sizes[FACETS], sizes[PLANAR] = 0, 0, planar
    return (
        sizes,
        np.empty((MAX_POINTS, 3)),
        np.empty((MAX_FACETS, 3), dtype=np.int64),
        np.empty((MAX_FACETS, FACET_REALS)),
    )


@kernel
def point_of(points, k):
    return (points[k, 0], points[k, 1], points[k, 2])


@kernel
def add_facet(hull, i, j, k, size):
    """Append the facet of three points. False where they are in line, or no room is left."""
    sizes, points, corners, facets = hull
    m = sizes[FACETS]
    a, b, c = point_of(points, i), point_of(points, j), point_of(points, k)
    along, other, third = sub(b, a), sub(c, b), sub(a, c)
    normal = cross(along, sub(c, a))
    area = norm(normal)
    if norm(other) > norm(along):
        along = other
    if norm(third) > norm(along):
        along = third
    length = norm(along)
    if m >= MAX_FACETS or not area > EPS * size * length:
        return False
    normal = scale(1.0 / area, normal)
    # roundoff turns the plane about its longest side by eps size / height, and about the height
    # less
    along = scale(1.0 / length, along)
    lean = abs(dot(a, cross(normal, along))) * length / area + abs(dot(a, along)) / length
    noise = FACET_ROUNDINGS * EPS * size * (1.0 + lean)
    corners[m, 0], corners[m, 1], corners[m, 2] = i, j, k
    facets[m, 0], facets[m, 1], facets[m, 2] = normal
    facets[m, OFFSET] = dot(normal, a) - noise
    facets[m, CLOSED] = 0.0
    sizes[FACETS] = m + 1
    return True


@kernel
def remove_facet(hull, m):
    sizes, _, corners, facets = hull
    last = sizes[FACETS] - 1
    # by elements: a slice would compile Numba's messages about shapes
    for k in range(3):
        corners[m, k] = corners[last, k]
    for k in range(FACET_REALS):
        facets[m, k] = facets[last, k]
    sizes[FACETS] = last


@kernel
def has_edge(corners, facet, i, j):
    """Does a facet run from i to j?"""
    a, b, c = corners[facet, 0], corners[facet, 1], corners[facet, 2]
    return (a == i and b == j) or (b == i and c == j) or (c == i and a == j)


@kernel
def horizon(corners, seen, n_seen, rim):
    """The rim of the facets seen, in order, into rim (n, 2). Its length, 0 where it is no loop."""
    n = 0
    for s in range(n_seen):
        for e in range(3):
            i, j = corners[seen[s], e], corners[seen[s], (e + 1) % 3]
            shared = False
            for other in range(n_seen):
                shared = shared or has_edge(corners, seen[other], j, i)
            if not shared:
                rim[n, 0], rim[n, 1] = i, j
                n += 1
    for k in range(1, n):
        at = k
        while at < n and rim[at, 0] != rim[k - 1, 1]:
            at += 1
        if at == n:
            return 0
        i, j = rim[at, 0], rim[at, 1]
        rim[at, 0], rim[at, 1] = rim[k, 0], rim[k, 1]
        rim[k, 0], rim[k, 1] = i, j
    return n if n >= 3 and rim[n - 1, 1] == rim[0, 0] else 0


@shared
def grow(hull, x, size):
    """Take a point in: GREW, NO_GAIN where no facet is below it, or BROKEN (nothing changed)."""
    sizes, points, corners, facets = hull
    if sizes[POINTS] >= MAX_POINTS:
        return NO_GAIN
    seen, n_seen = np.empty(MAX_FACETS, dtype=np.int64), 0
    above = False
    a_point = sizes[POINTS]
    for m in range(sizes[FACETS]):
        corner = point_of(points, corners[m, 0])
        normal = (facets[m, 0], facets[m, 1], facets[m, 2])
        height = dot(normal, sub(x, corner))
        # a coplanar facet goes too: no new one is then in line with its edges
        if height > -COPLANAR * size:
            seen[n_seen] = m
            n_seen += 1
            above = above or height > COPLANAR * size
    if not above:
        return NO_GAIN
    rim = np.empty((3 * n_seen, 2), dtype=np.int64)
    n = horizon(corners, seen, n_seen, rim)
    if n == 0 or sizes[FACETS] - n_seen + n > MAX_FACETS:
        return BROKEN
    points[a_point, 0], points[a_point, 1], points[a_point, 2] = x
    first = sizes[FACETS]
    for k in range(n):
        if not add_facet(hull, rim[k, 0], rim[k, 1], a_point, size):
            sizes[FACETS] = first
            return BROKEN
    sizes[POINTS] = a_point + 1
    for k in range(n_seen - 1, -1, -1):
        remove_facet(hull, seen[k])
    return GREW


@kernel
def grow_difference(hull, x, size):
    """`grow` by a point of A - B: for planar bodies by both ends of the prism over it."""
    if hull[0][PLANAR] == 0:
        return grow(hull, x, size)
    high = grow(hull, (x[0], x[1], PRISM * size), size)
    low = grow(hull, (x[0], x[1], -PRISM * size), size)
    return min(high, low)


@kernel
def farthest_from(points, n, k, a, b, c):
    """Of n points the one farthest from point a, line a b or plane a b c (k = 1, 2, 3 of them):
    (index, distance)."""
    best, at = -1.0, 0
    u = sub(b, a)
    w = cross(u, sub(c, a))
    for i in range(n):
        d = sub(point_of(points, i), a)
        if k == 1:
            far = norm(d)
        elif k == 2:
            far = norm(cross(d, u)) / norm(u)
        else:
            far = abs(dot(d, w)) / norm(w)
        if far > best:
            best, at = far, i
    return at, best


@shared
def begin_hull(hull, n, size):
    """Facets over the first n points, which stand in the hull's array already.

    Returns (solid, direction): where they lie in a plane, or a line, `direction` is square to it.
    """
    sizes, points, _, _ = hull
    sizes[POINTS], sizes[FACETS] = n, 0
    origin = point_of(points, 0)
    tiny = COPLANAR * size
    i, far = farthest_from(points, n, 1, origin, origin, origin)
    a = point_of(points, i)
    j, far = farthest_from(points, n, 1, a, origin, origin)
    if far <= tiny:
        return False, (1.0, 0.0, 0.0)
    b = point_of(points, j)
    k, far = farthest_from(points, n, 2, a, b, origin)
    if far <= tiny:
        u = sub(b, a)
        axis = (1.0, 0.0, 0.0) if abs(u[0]) < 0.6 * norm(u) else (0.0, 1.0, 0.0)
        way = cross(u, axis)
        return False, scale(1.0 / norm(way), way)
    c = point_of(points, k)
    m, far = farthest_from(points, n, 3, a, b, c)
    w = cross(sub(b, a), sub(c, a))
    if far <= tiny:
        return False, scale(1.0 / norm(w), w)
    if dot(w, sub(point_of(points, m), a)) > 0.0:
        j, k = k, j
    solid = (
        add_facet(hull, i, j, k, size)
        and add_facet(hull, i, m, j, size)
        and add_facet(hull, j, m, k, size)
        and add_facet(hull, k, m, i, size)
    )
    for point in range(n):
        if point != i and point != j and point != k and point != m:
            x = point_of(points, point)
            if sizes[POINTS] < MAX_POINTS:
                grow(hull, x, size)
    return solid, scale(1.0 / norm(w), w)


@kernel
def nearest_facet(hull, skip_closed):
    """(facet, distance from the origin): the least; -1 and inf where there is none."""
    sizes, _, _, facets = hull
    best, at = inf, -1
    for m in range(sizes[FACETS]):
        if facets[m, OFFSET] < best and not (skip_closed and facets[m, CLOSED] != 0.0):
            best, at = facets[m, OFFSET], m
    return at, best


@kernel
def facet_normal(hull, m):
    facets = hull[3]
    return (facets[m, 0], facets[m, 1], facets[m, 2])
