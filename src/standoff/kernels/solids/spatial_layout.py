"""Where everything is in the leaves and the tree of a packed solid: one array of integers and one
of reals, beside the two of its boundary.

A leaf is a rectangle of parameters of a face, an interval of an edge, or a vertex. Of a leaf's
derivatives there are bounds: of the first ones, the second, the third (analytic kinds), and of how
far the second ones are from those at any point of the leaf (all other kinds).
"""

from typing import Any, NamedTuple

# Integers, header: counts, then offsets in ints and in reals.
N_LEAVES, N_NODES, LEAVES, NODES, PIECES, LISTS, R_LEAVES, R_NODES, R_PIECES = range(9)
INT_HEADER = 9
R_SIZE, R_SLACK, R_ROUNDING = range(3)
REAL_HEADER = 3

LEAF_INTS = 8
DIM, FEATURE, CHART, CUT, SENSES, LIST, N_LIST, NATURAL = range(8)
# NATURAL: a kind of potential; none; or what has an axis all the same: an arc of a circle, and a
# face or an edge that is made by turning, or a face along which a screw motion moves nearly itself.
NO_KIND, ROUND_ARC, TURNED, SCREWED = -1, -2, -3, -4
# SENSES: where a minimum may lie, seen from outside the material, from inside, or both.
OUTSIDE, INSIDE, EITHER = 1, 2, 3
# Of a side alone: seen from outside, with the edges and vertices besides that what has gone into
# the material may be nearest to.
PRESSED = 4

LEAF_REALS = 32
RECT = 0  # u0, u1, v0, v1
FIRST = 4  # |x_u|, |x_v|
SECOND = 6  # |x_uu|, |x_uv|, |x_vv|
THIRDS = 9  # |x_uuu|, |x_uuv|, |x_uvv|, |x_vvv|
SPREAD = 13  # of x_uu, x_uv, x_vv over the leaf
CONE_OUT = 16  # axis (3), half angle: of normals seen from outside; then from inside
CONE_IN = 20
NATURAL_REALS = 24  # sign, k1, k2, point (3), and the axis in 3 more after LEAF_REALS
LEAF_STRIDE = 36

NODE_INTS = 3  # left, right, leaf (-1 inside the tree)
NODE_REALS = 23
CENTRE, AXES, HALF, N_OUT, N_IN = 0, 3, 12, 15, 19

PIECE_INTS = 2  # coedge, edge feature
PIECE_REALS = 14
# t0, t1, box in (u, v), greatest u_tt and v_tt, shift of u, then |x_t|, |x_tt|, |x_ttt|, spread
T0, T1, P_BOX, P_BEND, P_SHIFT, P_FIRST = 0, 1, 2, 6, 8, 9


class Side(NamedTuple):
    """A solid as kernels see it: its packed boundary, its leaves, and its pose in A's frame."""

    ints: Any
    reals: Any
    own: Any
    numbers: Any
    pose: Any
    sense: Any


class Box(NamedTuple):
    u0: Any
    u1: Any
    v0: Any
    v1: Any


class Part(NamedTuple):
    """A leaf of a solid over a box of its parameters."""

    side: Any
    leaf: Any
    box: Any
