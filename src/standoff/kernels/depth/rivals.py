"""Other directions in which an overlap is as thin: a ball in the middle of a slab has two."""

from math import nan

from standoff.kernels.algebra.vectors import norm, rotate, scale, sub, unit
from standoff.kernels.body import layout as L
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.depth.descent import descend
from standoff.kernels.depth.penetration import begin_along, contact_scale
from standoff.kernels.tolerances import AROUND, SAME_WIDTH, START_GAP
from standoff.kernels.values import Depth

# Descents start against the normal, and along each of a cube's faces, edges and corners (and from
# its middle, which is skipped) in both bodies' frames.
CUBE = 27
N_STARTS = 1 + 2 * CUBE


@kernel
def start_direction(pair, pose, n, k):
    """Direction k to start from, in A's frame; of planar bodies in their plane. Not of length 1."""
    if k == 0:
        return scale(-1.0, n)
    m = (k - 1) % CUBE
    way = (float(m % 3) - 1.0, float(m // 3 % 3) - 1.0, float(m // 9) - 1.0)
    if k > CUBE:
        way = rotate(pose.R, way)
    if pair.ints_a[L.DIMENSION] == 2 or pair.ints_b[L.DIMENSION] == 2:
        way = (way[0], way[1], 0.0)
    return way


@kernel
def is_new(n, found, count):
    """Is a normal none of those found?"""
    for k in range(count):
        if norm(sub(n, (found[3 * k], found[3 * k + 1], found[3 * k + 2]))) <= AROUND:
            return False
    return True


@kernel
def equally_deep(pair, pose, n, d, most, found, work):
    """How many normals there are along which the cores are as deep in each other, and they into
    `found` (3 numbers each): n itself, and others until `most`. All in A's frame; d is the signed
    distance of the cores.
    """
    found[0], found[1], found[2] = n
    count = 1
    if pair.ints_a[L.UNBOUNDED] or pair.ints_b[L.UNBOUNDED]:
        return count
    same = SAME_WIDTH * contact_scale(pair)
    for k in range(N_STARTS):
        way = start_direction(pair, pose, n, k)
        if count >= most or norm(way) < AROUND:
            continue
        way = unit(way)
        at = Depth(False, nan, way, begin_along(pair, pose, way))
        ended = descend(pair, pose, at, START_GAP, work)
        if ended.found and abs(ended.distance - d) <= same and is_new(ended.normal, found, count):
            o = 3 * count
            found[o], found[o + 1], found[o + 2] = ended.normal
            count += 1
    return count
