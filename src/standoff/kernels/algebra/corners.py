"""Corners of a convex polygon in a plane, few of them: how far outside points are, their order."""

from math import atan2, inf

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.compiler.decorators import kernel

# Of a corner: where it is, and the number of its row.
X, Y, ROW, CORNER_REALS = 0, 1, 2, 3


@kernel
def outside(corners, n, x, y):
    """How far a point is from a point, from a segment, or outside of a convex polygon whose corners
    run counterclockwise; below 0: inside."""
    dx, dy = x - corners[X], y - corners[Y]
    if n == 1:
        return sqrt(dx * dx + dy * dy)
    most, across = -inf, 0.0
    for k in range(n):
        o, p = CORNER_REALS * k, CORNER_REALS * ((k + 1) % n)
        tx, ty = corners[p + X] - corners[o + X], corners[p + Y] - corners[o + Y]
        length = sqrt(tx * tx + ty * ty)
        dx, dy = x - corners[o + X], y - corners[o + Y]
        off = (dx * ty - dy * tx) / length
        if n == 2:
            across = max(across, abs(off))
            off = -(dx * tx + dy * ty) / length
        most = max(most, off)
    return max(most, across) if n == 2 else most


@kernel
def put_around(corners, n):
    """Corners in their order around their middle, counterclockwise."""
    mx, my = 0.0, 0.0
    for k in range(n):
        mx, my = mx + corners[CORNER_REALS * k + X] / n, my + corners[CORNER_REALS * k + Y] / n
    for i in range(1, n):
        k = i
        while k > 0:
            o, p = CORNER_REALS * k, CORNER_REALS * (k - 1)
            later = atan2(corners[o + Y] - my, corners[o + X] - mx)
            if later >= atan2(corners[p + Y] - my, corners[p + X] - mx):
                break
            for j in range(CORNER_REALS):
                corners[o + j], corners[p + j] = corners[p + j], corners[o + j]
            k -= 1
