"""Local minima of the distance of two solids, as Python calls what tells them."""

from numba import types

from standoff.kernels.compiler.decorators import entry, kernel, pointer
from standoff.kernels.compiler.entry import INT, INTS, READ, REAL, WRITE
from standoff.kernels.entries.solids import SOLIDS, STILL, side_at
from standoff.kernels.solids import minima_sets, patch
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_minimum import jets_at
from standoff.kernels.solids.stationary import Fans, is_bowl, is_stationary

# Of a solid, then of both.
FANS = types.Tuple((INTS, READ))
BOTH_FANS = types.Tuple((FANS, FANS))


@kernel
def fans_at(fans):
    ints, reals = fans
    return Fans(pointer(ints, 0), pointer(reals, 0))


@entry(SOLIDS, READ, BOTH_FANS, READ, READ, work="solids")
def stationary(solids, pose, fans, row, asked):
    """Is a row (distance, leaves, parameters) stationary along the normal asked[:3], A's frame, to
    the sine asked[3]; and, where asked[4] is above 0, no saddle, with that to spare?"""
    a, b = side_at(solids[0], STILL, S.OUTSIDE), side_at(solids[1], pose, S.OUTSIDE)
    q, leaves = (row[3], row[4], row[5], row[6]), (int(row[1]), int(row[2]))
    n = (asked[0], asked[1], asked[2])
    if not is_stationary(a, b, fans_at(fans[0]), fans_at(fans[1]), q, leaves, n, asked[3]):
        return False
    ja, jb = jets_at(a, leaves[0], b, leaves[1], q)
    return asked[4] == 0.0 or is_bowl(a, leaves[0], ja, b, leaves[1], jb, q, asked[4])


@entry(READ, READ, REAL, work="solids")
def one_place(pair, other, size):
    """Are two pairs (point of A, point of B, distance) one? As ``minima_sets`` has it."""
    x, y = (pair[0], pair[1], pair[2]), (pair[3], pair[4], pair[5])
    p, q = (other[0], other[1], other[2]), (other[3], other[4], other[5])
    return minima_sets.is_one_place(x, y, pair[6], p, q, other[6], size)


@entry(READ, WRITE, REAL, WRITE, INT, work="solids")
def span_patches(best, minima, wider, sets, n):
    """The patches of `n` sets of local minima, as ``patch`` writes them."""
    patch.span_all(pointer(best, 0), pointer(minima, 0), wider, pointer(sets, 0), n)
