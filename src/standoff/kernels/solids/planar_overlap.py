"""The largest ball found inside two planar solids that overlap, best first over squares."""

from math import inf
from typing import NamedTuple

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids.planar_pieces import frame_at
from standoff.kernels.solids.planar_points import nearest_boundary, winding
from standoff.kernels.solids.planar_search import N_FOUND, N_ROW, pop, rise

# Halvings of the steps of the last descent.
MOST_HALVINGS = 40
# Of the ball's radius: the last step.
FINE = 0.002
# Sides of the steps: the axes and the diagonals.
N_WAYS = 8
MOST_SEEDS = 12
MOST_DEEP_SEEDS = 3
N_DEPTHS = 9
# Of a square's half side: how well the distances at its middle are known.
LOOSE = 0.125


class Ball(NamedTuple):
    """A common point, and a radius that is proven to be free of both boundaries; below 0 where it
    is outside of one."""

    x: float
    y: float
    radius: float


@kernel
def ball_at(a, b, x, y, tolerance, extent):
    """The proven radius round a point: below 0, by how far it is outside."""
    one = nearest_boundary(a, x, y, tolerance, extent)
    two = nearest_boundary(b, x, y, tolerance, extent)
    in_a, in_b = winding(a, x, y, extent) > 0, winding(b, x, y, extent) > 0
    if in_a and in_b:
        return Ball(x, y, min(one.lower, two.lower))
    out_a, out_b = (-inf if in_a else one.distance), (-inf if in_b else two.distance)
    return Ball(x, y, -max(out_a, out_b))


@kernel
def better(a, b, best, x, y, tolerance, extent):
    ball = ball_at(a, b, x, y, tolerance, extent)
    return ball if ball.radius > best.radius else best


@kernel
def seeded(a, b, queue, n_found, tolerance, extent):
    """The best of points beside the pairs found, and half way between each two of them."""
    best, found = Ball(0.0, 0.0, -inf), queue.found
    n = min(n_found, MOST_SEEDS)
    for i in range(n):
        at = N_FOUND * i
        x, y = found[at + 2], found[at + 3]
        _, _, ux, uy, _ = frame_at(a, int(found[at + 10]), found[at + 8])
        _, _, vx, vy, _ = frame_at(b, int(found[at + 11]), found[at + 9])
        step = extent
        for _ in range(N_DEPTHS if i < MOST_DEEP_SEEDS else 0):
            step *= 0.1
            # to the left of both tangents
            to_x, to_y = x - step * (uy + vy), y + step * (ux + vx)
            best = better(a, b, best, to_x, to_y, tolerance, extent)
        for j in range(i):
            other_x, other_y = found[N_FOUND * j + 2], found[N_FOUND * j + 3]
            best = better(a, b, best, 0.5 * (x + other_x), 0.5 * (y + other_y), tolerance, extent)
    return best


@kernel
def put_square(rows, made, bound, x, y, half):
    at = N_ROW * made
    rows[at] = bound
    rows[at + 1] = x
    rows[at + 2] = y
    rows[at + 3] = half


@kernel
def largest_ball(a, b, square, best, queue, part, budget, lengths):
    """Squares in which the ball may be larger are cut in four, the most promising first, until none
    promises a `part` more, or the budget of squares is spent."""
    rows, heap = queue.rows, queue.heap
    tolerance, extent = lengths
    x, y, half = square
    put_square(rows, 0, -inf, x, y, half)
    rise(rows, heap, 0, 0)
    made, size = 1, 1
    while size > 0 and made + 4 <= min(budget, queue.capacity):
        at = N_ROW * pop(rows, heap, size)
        size -= 1
        if -rows[at] <= best.radius + max(tolerance, part * abs(best.radius)):
            break
        half = 0.5 * rows[at + 3]
        for k in range(4):
            x = rows[at + 1] + (half if k % 2 else -half)
            y = rows[at + 2] + (half if k // 2 else -half)
            loose = max(tolerance, LOOSE * half)
            ball = ball_at(a, b, x, y, loose, extent)
            if ball.radius > best.radius:
                best = ball
            put_square(rows, made, -(ball.radius + loose + sqrt(2.0) * half), x, y, half)
            rise(rows, heap, made, size)
            made, size = made + 1, size + 1
    return climbed(a, b, best, 0.1 * extent, tolerance, extent), made


@kernel
def climbed(a, b, best, step, tolerance, extent):
    """The ball moved to larger ones beside it, by steps that are halved."""
    for _ in range(MOST_HALVINGS):
        if step < max(tolerance, FINE * best.radius):
            break
        last = best
        for k in range(N_WAYS):
            x = last.x + step * (1.0 if k in (0, 4, 5) else (-1.0 if k in (1, 6, 7) else 0.0))
            y = last.y + step * (1.0 if k in (2, 4, 6) else (-1.0 if k in (3, 5, 7) else 0.0))
            best = better(a, b, best, x, y, tolerance, extent)
        if best.radius <= last.radius:
            step *= 0.5
    return best
