"""Local minima of the distance of two solids, as Python calls what tells them."""

from math import inf

from numba import types

from standoff.kernels.algebra.vectors import norm, sub
from standoff.kernels.body.trimming import on_face
from standoff.kernels.compiler.decorators import entry, kernel, pointer
from standoff.kernels.compiler.entry import INT, INTS, READ, READ_ROWS, REAL, WRITE
from standoff.kernels.entries.solids import SOLIDS, STILL, side_at
from standoff.kernels.solids import minima_sets, patch
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_minimum import jets_at
from standoff.kernels.solids.spatial_pieces import leaf_ints, leaf_jet
from standoff.kernels.solids.stationary import Fans, is_bowl, is_stationary

# Of a solid, then of both.
FANS = types.Tuple((INTS, READ))
BOTH_FANS = types.Tuple((FANS, FANS))


@kernel
def fans_at(fans):
    ints, reals = fans
    return Fans(pointer(ints, 0), pointer(reals, 0))


@kernel
def is_on_face(side, leaf, u, v):
    r = leaf_ints(side, leaf)
    chart = side.own[r + S.CHART]
    return side.own[r + S.DIM] < 2 or on_face(side.ints, side.reals, chart, u, v)


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


@entry(READ_ROWS, INT, REAL, WRITE, work="solids")
def one_place(pairs, k, size, out):
    """Which pairs (point of A, point of B, distance) are one with the k-th, as ``minima_sets`` has
    it: 1 where it is."""
    x, y = (pairs[k, 0], pairs[k, 1], pairs[k, 2]), (pairs[k, 3], pairs[k, 4], pairs[k, 5])
    for i in range(len(pairs)):
        p, q = (pairs[i, 0], pairs[i, 1], pairs[i, 2]), (pairs[i, 3], pairs[i, 4], pairs[i, 5])
        same = minima_sets.is_one_place(x, y, pairs[k, 6], p, q, pairs[i, 6], size)
        out[i] = 1.0 if same else 0.0


@entry(SOLIDS, READ, READ_ROWS, READ, work="solids")
def greatest_gap(solids, pose, rows, shares):
    """How far points are apart at most that are shares of the way from the parameters of one row
    (distance, leaves, parameters) to those of another of the same faces and edges; infinity where
    one is off its face."""
    a, b, most = side_at(solids[0], STILL, S.OUTSIDE), side_at(solids[1], pose, S.OUTSIDE), 0.0
    m, n = int(rows[0, 1]), int(rows[0, 2])
    for i in range(len(shares)):
        t = shares[i]
        u, v = (1.0 - t) * rows[0, 3] + t * rows[1, 3], (1.0 - t) * rows[0, 4] + t * rows[1, 4]
        p, q = (1.0 - t) * rows[0, 5] + t * rows[1, 5], (1.0 - t) * rows[0, 6] + t * rows[1, 6]
        if not (is_on_face(a, m, u, v) and is_on_face(b, n, p, q)):
            return inf
        most = max(most, norm(sub(leaf_jet(b, n, p, q)[0], leaf_jet(a, m, u, v)[0])))
    return most


@entry(READ, WRITE, REAL, WRITE, INT, work="solids")
def span_patches(best, minima, wider, sets, n):
    """The patches of `n` sets of local minima, as ``patch`` writes them."""
    patch.span_all(pointer(best, 0), pointer(minima, 0), wider, pointer(sets, 0), n)
