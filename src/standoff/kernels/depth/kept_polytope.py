"""The polytope inside A - B, kept from one frame in penetration for the next.

A vertex is a difference x_a - x_b of points that move with their bodies, so it stays in A - B
however these move. What holds for its facets is checked again: the surface is still closed, and if
all its facets have the origin below them, it goes round the origin once or more, so each ray from
there meets one of them. No facet is nearer than the least of their distances, nor then is the
boundary of A - B (docs/penetration.md).
"""

from standoff.kernels.algebra.vectors import add, rotate, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.depth.difference_hull import (
    FACET_REALS,
    FACETS,
    OF_A,
    OFFSET,
    POINT_REALS,
    POINTS,
    Vertex,
    add_facet,
    empty_hull,
    put_vertex,
)
from standoff.kernels.pair.polytope_layout import (
    FIRST_FACET,
    FIRST_VERTEX,
    KEPT_FACETS,
    KEPT_POINTS,
    KEPT_REALS,
    N_FACETS,
    N_POLYTOPE,
    N_VERTICES,
)

CORNER_BITS = 6
CORNER_MASK = KEPT_POINTS - 1


@kernel
def read_three(numbers, o):
    return (numbers[o], numbers[o + 1], numbers[o + 2])


@kernel
def recall(hull, pose, planar, kept, size):
    """Set up the polytope that was kept, at the bodies' new pose. False where none was, or where
    the origin is no longer below all its facets.
    """
    some = 0.0 < kept[N_VERTICES] <= KEPT_POINTS and 0.0 < kept[N_FACETS] <= KEPT_FACETS
    if not some:
        return False
    empty_hull(hull, planar)
    n = int(kept[N_VERTICES])
    for k in range(n):
        o = FIRST_VERTEX + KEPT_REALS * k
        of_a, of_b = read_three(kept, o), read_three(kept, o + 3)
        x = sub(of_a, add(rotate(pose.R, of_b), pose.p))
        put_vertex(hull.points, k, Vertex(x, of_a, of_b))
    hull.sizes[POINTS] = n
    for m in range(int(kept[N_FACETS])):
        code = int(kept[FIRST_FACET + m])
        i, j = code & CORNER_MASK, (code >> CORNER_BITS) & CORNER_MASK
        k = (code >> (2 * CORNER_BITS)) & CORNER_MASK
        if not add_facet(hull, i, j, k, size) or hull.facets[FACET_REALS * m + OFFSET] <= 0.0:
            return False
    return True


@kernel
def keep(hull, kept):
    """Keep the polytope for the next frame, the vertices of its facets alone; nothing where they
    are too many.
    """
    kept[N_VERTICES] = 0.0
    length = hull.sizes[FACETS]
    if length > KEPT_FACETS:
        return
    number, n = hull.seen, 0  # of each vertex its new one
    for k in range(hull.sizes[POINTS]):
        number[k] = -1
    for m in range(length):
        code = 0
        for corner in range(3):
            k = hull.corners[3 * m + corner]
            if number[k] < 0:
                if n == KEPT_POINTS:
                    return
                number[k] = n
                for i in range(KEPT_REALS):
                    at = FIRST_VERTEX + KEPT_REALS * n + i
                    kept[at] = hull.points[POINT_REALS * k + OF_A + i]
                n += 1
            code |= number[k] << (CORNER_BITS * corner)
        kept[FIRST_FACET + m] = code
    for at in range(FIRST_VERTEX + KEPT_REALS * n, FIRST_FACET):
        kept[at] = 0.0
    for at in range(FIRST_FACET + length, N_POLYTOPE):
        kept[at] = 0.0
    kept[N_FACETS], kept[N_VERTICES] = length, n
