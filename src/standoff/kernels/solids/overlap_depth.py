"""A length that no translation is less than which parts two solids, by one place of overlap."""

from typing import Any, NamedTuple

from standoff.kernels.algebra.vectors import add, norm, rotate, rotate_back, scale, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids.minima_sets import SET_REALS, SET_ROW, points_of
from standoff.kernels.solids.point_depth import depth_beside
from standoff.kernels.solids.spatial_pieces import ZERO
from standoff.kernels.solids.spatial_progress import BOUND, MINIMUM_REALS, N_MINIMA

# Places that are tried for a ball.
MOST_PUSHES = 2
# Pairs of points of one minimum that are tried for a depth.
MOST_TRIED = 8
# Of what is the most that can be proven: no more is looked for.
ENOUGH = 0.5
# And of that, as depths are proven to a tenth: where a place's points prove so much, a ball can
# hardly prove more.
PLENTY = 0.85
# Of half the depth: a larger ball is not looked for.
BALL = 0.1


class Two(NamedTuple):
    """Two solids as they are known, B's pose in A's frame, and what asks of points."""

    a: Any
    b: Any
    pose: Any
    probe: Any


@kernel
def in_b(two, x):
    """A point of A's frame in B's."""
    return rotate_back(two.pose.R, sub(x, two.pose.p))


@kernel
def least_depth(two, x, y, about):
    """By points of A and of B, in A's frame, that are so deep; 0 or less: nothing is proven.

    A point of one boundary is as deep as that inside the other solid, and stays inside it.
    """
    side, low, _ = depth_beside(two.a, y, about, two.probe)
    depth = -side * low
    if depth >= ENOUGH * about:
        return depth
    side, low, _ = depth_beside(two.b, in_b(two, x), about, two.probe)
    return max(depth, -side * low)


@kernel
def away_from(x, nearest, depth):
    """The way from the nearest point of a boundary into the solid, from outside to that point."""
    way = sub(x, nearest) if depth > 0.0 else sub(nearest, x)
    length = norm(way)
    return scale(1.0 / length, way) if length > 0.0 else ZERO


@kernel
def ball_depth(two, middle, about):
    """The same by a ball that is proven to be inside both solids, around a point in A's frame, or
    one that both boundaries are farther from; 0: none was found."""
    radius, depth = 0.0, 0.0
    for _ in range(MOST_PUSHES):
        side, low, nearest = depth_beside(two.a, middle, about, two.probe)
        in_a, way_a = -side * low, away_from(middle, nearest, -side * low)
        own = in_b(two, middle)
        side, low, nearest = depth_beside(two.b, own, about, two.probe)
        deep, way = -side * low, rotate(two.pose.R, away_from(own, nearest, -side * low))
        least = min(in_a, deep)
        if least > radius:
            radius, depth = least, in_a + deep
        if least >= BALL * about:
            break
        middle = add(middle, scale(max(about - in_a, 0.0), way_a))
        middle = add(middle, scale(max(about - deep, 0.0), way))
    return depth


@kernel
def middle_of(minima, count, number):
    """The middle of all points of a minimum with a number."""
    total, n = ZERO, 0.0
    for k in range(count):
        o = MINIMUM_REALS * k
        if minima[o + BOUND] == number:
            x, y = points_of(minima, o)
            total, n = add(total, add(x, y)), n + 2.0
    return scale(1.0 / n, total) if n > 0.0 else total


@kernel
def depth_at(two, found, k, enough):
    """By the k-th of the minima that were found; where that is at the side of what overlaps, as of
    faces that lie on each other, by a ball or by other pairs of points of the same minimum."""
    best, minima, sets = found
    s = SET_REALS * k
    about, number, count = -sets[s], sets[s + BOUND], int(best[N_MINIMA])
    x, y = points_of(minima, MINIMUM_REALS * int(sets[s + SET_ROW]))
    depth = least_depth(two, x, y, about)
    if depth <= enough:
        depth = max(depth, ball_depth(two, middle_of(minima, count, number), 0.5 * about))
    tried = 0
    for i in range(count):
        o = MINIMUM_REALS * i
        if depth > enough or tried == MOST_TRIED:
            break
        if minima[o + BOUND] == number and minima[o] < 0.0:
            x, y = points_of(minima, o)
            depth, tried = max(depth, least_depth(two, x, y, -minima[o])), tried + 1
    return depth
