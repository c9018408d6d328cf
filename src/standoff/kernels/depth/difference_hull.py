"""A polytope inside the Minkowski difference A - B, grown point by point.

Its vertices are differences x_a - x_b of points of both bodies, so it lies in A - B: a ball about
the origin inside it is inside A - B, and its radius bounds the depth from below. Facets are
triangles, counter-clockwise seen from outside; a facet that goes is replaced by the last one. For
planar bodies the polytope is a prism over their difference, long enough that its ends bound no
depth.

A facet is seen by a point that is above it, or in its plane to COPLANAR. That is no longer one
connected part of the surface where facets differ by about as much, as those of flush faces do, and
then the new facets may fold over. A polytope that is EXACT has no such width: which side of a plane
a point is on is found with twice the digits, so that the surface stays the hull of its points,
needles included, and their planes keep all their digits. It takes ten times as long, so it is made
only where the other one proves nothing (`search`).

Any closed surface of triangles about the origin bounds the depth, convex or not
(docs/penetration.md), so roundoff in which facets a point sees costs tightness only.

Of each vertex the points of both bodies are known, in their own frames: when the bodies move, the
vertex moves with them and stays inside A - B (`kept_polytope`).
"""

from math import inf
from typing import Any, NamedTuple

from standoff.kernels.algebra.doubled import (
    doubled,
    doubled_cross,
    doubled_dot,
    nearest_of_each,
    step_between,
)
from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import cross, dot, norm, scale, sub
from standoff.kernels.compiler.decorators import kernel, shared
from standoff.kernels.tolerances import COPLANAR, EPS, FACET_ROUNDINGS, MAX_PROBES, PRISM
from standoff.kernels.values import Vector

# Seeds, probes, minima; two points each for a planar pair.
MAX_POINTS = 2 * (MAX_PROBES + 64)
MAX_FACETS = 2 * MAX_POINTS
# A vertex's numbers: itself, in A's frame, and the points of A and of B that it is the difference
# of, each in its own body's frame.
OF_A, OF_B = 3, 6
POINT_REALS = 9
# A facet's numbers: unit normal, distance from the origin less its roundoff, and 1 where it is
# known to lie on the boundary of A - B.
NORMAL, OFFSET, CLOSED = 0, 3, 4
FACET_REALS = 5
# Sizes of a polytope, in one array.
POINTS, FACETS, PLANAR, EXACT = range(4)
N_SIZES = 4
# Sizes of the arrays that a hull is made in.
ALL_POINTS, ALL_FACETS = POINT_REALS * MAX_POINTS, FACET_REALS * MAX_FACETS
ALL_CORNERS, ALL_RIMS = 3 * MAX_FACETS, 2 * MAX_FACETS

GREW, NO_GAIN, BROKEN = range(3)


class Hull(NamedTuple):
    """A polytope, in flat arrays or pointers."""

    sizes: Any  # N_SIZES integers
    points: Any  # POINT_REALS numbers a vertex
    corners: Any  # three vertices a facet
    facets: Any  # FACET_REALS numbers a facet
    seen: Any  # of `grow`: the facets that a point sees
    rim: Any  # and their rim, from and to, for each of its sides


class Vertex(NamedTuple):
    """A point of A - B, and the points of both bodies that it is the difference of."""

    x: Vector  # in A's frame
    of_a: Vector
    of_b: Vector  # in B's frame


@kernel
def empty_hull(hull, planar, exact=False):
    """A polytope without points, in arrays that may hold anything."""
    sizes = hull.sizes
    sizes[POINTS], sizes[FACETS] = 0, 0
    sizes[PLANAR], sizes[EXACT] = 1 if planar else 0, 1 if exact else 0


@kernel
def coplanar(hull, size):
    """How far above a facet a point counts as in its plane."""
    return FACET_ROUNDINGS * EPS * size if hull.sizes[EXACT] else COPLANAR * size


@kernel
def point_of(points, k):
    o = POINT_REALS * k
    return (points[o], points[o + 1], points[o + 2])


@kernel
def put_vertex(points, k, vertex):
    o = POINT_REALS * k
    for i in range(3):
        points[o + i] = vertex.x[i]
        points[o + OF_A + i] = vertex.of_a[i]
        points[o + OF_B + i] = vertex.of_b[i]


@kernel
def vertex_of(points, k):
    o = POINT_REALS * k
    return Vertex(
        point_of(points, k),
        (points[o + OF_A], points[o + OF_A + 1], points[o + OF_A + 2]),
        (points[o + OF_B], points[o + OF_B + 1], points[o + OF_B + 2]),
    )


@kernel
def leaning(a, along, across, square, length):
    """How far the foot of the origin on a facet's plane is from the facet, over its height."""
    return abs(dot(a, cross(across, along))) / square + abs(dot(a, along)) / length


@kernel
def longest_side(a, b, c):
    """(the vector along it, the square of its length)."""
    along, other, third = sub(b, a), sub(c, b), sub(a, c)
    length = dot(along, along)
    if dot(other, other) > length:
        along, length = other, dot(other, other)
    if dot(third, third) > length:
        along, length = third, dot(third, third)
    return along, length


@kernel
def plane_of(a, b, c, size):
    """(are the points not in line, unit normal, the plane's distance from the origin less its
    roundoff)."""
    across = cross(sub(b, a), sub(c, a))  # the normal, twice the area long
    square = dot(across, across)
    along, length = longest_side(a, b, c)
    thin = EPS * size
    if not square > thin * thin * length:
        return False, across, 0.0
    normal = scale(1.0 / sqrt(square), across)
    # roundoff turns the plane about its longest side by eps size / height, and about the height
    # less
    lean = leaning(a, along, across, square, length)
    noise = FACET_ROUNDINGS * EPS * size * (1.0 + lean)
    return True, normal, dot(normal, a) - noise


@shared
def exact_plane(a, b, c, size):
    """`plane_of` with twice the digits: what is left is the roundoff of the points themselves,
    which moves the hull by no more than it moves them."""
    full = doubled_cross(step_between(a, b), step_between(a, c))
    across = nearest_of_each(full)
    square = dot(across, across)
    along, length = longest_side(a, b, c)
    thin = EPS * EPS * size
    if not square > thin * thin * length:
        return False, across, 0.0
    root = sqrt(square)
    lean = EPS * leaning(a, along, across, square, length)
    noise = FACET_ROUNDINGS * EPS * size * (1.0 + lean)
    return True, scale(1.0 / root, across), doubled_dot(full, doubled(a)) / root - noise


@shared
def exact_height(a, b, c, x):
    """How far a point is above the plane of a facet's three."""
    full = doubled_cross(step_between(a, b), step_between(a, c))
    return doubled_dot(full, step_between(a, x)) / norm(nearest_of_each(full))


@kernel
def add_facet(hull, i, j, k, size):
    """Append the facet of three points. False where they are in line, or no room is left."""
    sizes, points, corners, facets = hull.sizes, hull.points, hull.corners, hull.facets
    m = sizes[FACETS]
    if m >= MAX_FACETS:
        return False
    a, b, c = point_of(points, i), point_of(points, j), point_of(points, k)
    if sizes[EXACT]:
        wide, normal, offset = exact_plane(a, b, c, size)
    else:
        wide, normal, offset = plane_of(a, b, c, size)
    if not wide:
        return False
    corners[3 * m], corners[3 * m + 1], corners[3 * m + 2] = i, j, k
    o = FACET_REALS * m
    facets[o], facets[o + 1], facets[o + 2] = normal
    facets[o + OFFSET] = offset
    facets[o + CLOSED] = 0.0
    sizes[FACETS] = m + 1
    return True


@kernel
def remove_facet(hull, m):
    corners, facets = hull.corners, hull.facets
    last = hull.sizes[FACETS] - 1
    for k in range(3):
        corners[3 * m + k] = corners[3 * last + k]
    for k in range(FACET_REALS):
        facets[FACET_REALS * m + k] = facets[FACET_REALS * last + k]
    hull.sizes[FACETS] = last


@kernel
def has_edge(corners, facet, i, j):
    """Does a facet run from i to j?"""
    a, b, c = corners[3 * facet], corners[3 * facet + 1], corners[3 * facet + 2]
    return (a == i and b == j) or (b == i and c == j) or (c == i and a == j)


@kernel
def horizon(corners, seen, n_seen, rim):
    """The rim of the facets seen, in order, into `rim`. Its length, 0 where it is no loop."""
    n = 0
    for s in range(n_seen):
        for e in range(3):
            i, j = corners[3 * seen[s] + e], corners[3 * seen[s] + (e + 1) % 3]
            shared = False
            for other in range(n_seen):
                shared = shared or has_edge(corners, seen[other], j, i)
            if not shared:
                if n == MAX_FACETS:
                    return 0
                rim[2 * n], rim[2 * n + 1] = i, j
                n += 1
    for k in range(1, n):
        at = k
        while at < n and rim[2 * at] != rim[2 * k - 1]:
            at += 1
        if at == n:
            return 0
        i, j = rim[2 * at], rim[2 * at + 1]
        rim[2 * at], rim[2 * at + 1] = rim[2 * k], rim[2 * k + 1]
        rim[2 * k], rim[2 * k + 1] = i, j
    return n if n >= 3 and rim[2 * n - 1] == rim[0] else 0


@kernel
def height_over(hull, m, x):
    """How far a point is above a facet."""
    points, corners, facets = hull.points, hull.corners, hull.facets
    a = point_of(points, corners[3 * m])
    if hull.sizes[EXACT]:
        b, c = point_of(points, corners[3 * m + 1]), point_of(points, corners[3 * m + 2])
        return exact_height(a, b, c, x)
    o = FACET_REALS * m
    return dot((facets[o], facets[o + 1], facets[o + 2]), sub(x, a))


@kernel
def look_from(hull, x, size):
    """(how many facets a point sees, is it above any); they are listed in `hull.seen`."""
    n_seen, above = 0, False
    width = coplanar(hull, size)
    # a coplanar facet goes too: no new one is then in line with its edges
    least = 0.0 if hull.sizes[EXACT] else -width
    for m in range(hull.sizes[FACETS]):
        height = height_over(hull, m, x)
        if height > least:
            hull.seen[n_seen] = m
            n_seen += 1
            above = above or height > width
    return n_seen, above


@shared
def grow(hull, vertex, size):
    """Take a point in: GREW, NO_GAIN where no facet is below it, or BROKEN (nothing changed)."""
    sizes, points, corners, _, seen, rim = hull
    a_point = sizes[POINTS]
    if a_point >= MAX_POINTS:
        return NO_GAIN
    n_seen, above = look_from(hull, vertex.x, size)
    if not above:
        return NO_GAIN
    n = horizon(corners, seen, n_seen, rim)
    if n == 0 or sizes[FACETS] - n_seen + n > MAX_FACETS:
        return BROKEN
    put_vertex(points, a_point, vertex)
    first = sizes[FACETS]
    for k in range(n):
        if not add_facet(hull, rim[2 * k], rim[2 * k + 1], a_point, size):
            sizes[FACETS] = first
            return BROKEN
    sizes[POINTS] = a_point + 1
    for k in range(n_seen - 1, -1, -1):
        remove_facet(hull, seen[k])
    return GREW


@kernel
def lifted(vertex, height):
    """A vertex of a planar pair at a height of the prism over it."""
    x, a = vertex.x, vertex.of_a
    return Vertex((x[0], x[1], height), (a[0], a[1], height), vertex.of_b)


@kernel
def grow_difference(hull, vertex, size):
    """`grow` by a point of A - B: for planar bodies by both ends of the prism over it."""
    if hull.sizes[PLANAR] == 0:
        return grow(hull, vertex, size)
    high = grow(hull, lifted(vertex, PRISM * size), size)
    low = grow(hull, lifted(vertex, -PRISM * size), size)
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

    Returns (solid, direction): if they lie in a plane, or on a line, `direction` is perpendicular
    to it.
    """
    sizes, points = hull.sizes, hull.points
    sizes[POINTS], sizes[FACETS] = n, 0
    origin = point_of(points, 0)
    tiny = coplanar(hull, size)
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
        taken = point in (i, j, k, m)
        if not taken and sizes[POINTS] < MAX_POINTS:
            grow(hull, vertex_of(points, point), size)
    return solid, scale(1.0 / norm(w), w)


@kernel
def nearest_facet(hull, skip_closed):
    """(facet, distance from the origin): the least; -1 and inf where there is none."""
    facets = hull.facets
    best, at = inf, -1
    for m in range(hull.sizes[FACETS]):
        o = FACET_REALS * m
        if facets[o + OFFSET] < best and not (skip_closed and facets[o + CLOSED] != 0.0):
            best, at = facets[o + OFFSET], m
    return at, best


@kernel
def facet_normal(hull, m):
    o = FACET_REALS * m
    return (hull.facets[o], hull.facets[o + 1], hull.facets[o + 2])


@kernel
def close_facet(hull, m):
    """Mark a facet as known to lie on the boundary of A - B."""
    hull.facets[FACET_REALS * m + CLOSED] = 1.0
