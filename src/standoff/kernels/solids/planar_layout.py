"""How a planar solid is packed, and what kernels read of it.

Its boundary is cut into leaves: parts of its curves that turn little. Each has rigorous ranges,
made once by interval arithmetic. A binary tree stands over them; each of its nodes is covered by a
capsule, all points within a radius of a segment.
"""

from typing import Any, NamedTuple

# Numbers of a leaf. It runs from FROM to UNTIL with the solid on its left, so FROM may be greater.
FROM = 0
UNTIL = 1
BEND = 2  # least upper bound known of |x_tt|
GREATEST_SPEED = 3  # the same of |x_t|
LEAST_K = 4  # range of the curvature, positive where the solid bulges
GREATEST_K = 5
PAD = 6  # how far computed points may lie from the curve [length]
CENTRE = 7  # of an arc of a circle, 2 numbers
START = 9  # first point, 2 numbers; equal to the last of the leaf before it
END = 11
N_LEAF = 13

# Integers of a leaf.
KIND = 0  # of its curve
DATA = 1  # where its curve's numbers begin
CURVE = 2
FORM = 3
BEFORE = 4  # the leaf before it in its loop
AFTER = 5
VERTEX = 6  # index of the vertex it begins at, -1 inside of a curve
N_LEAF_INT = 7

LINE, ARC, GENERAL = 0, 1, 2  # forms

# Numbers of a node: the capsule.
N_NODE = 5
# Integers of a node: its two parts, or -1 and its leaf.
LEFT, RIGHT, LEAF = 0, 1, 2
N_NODE_INT = 3


class Outline(NamedTuple):
    """A packed planar solid at a place, as pointers; x -> (c x - s y + p, s x + c y + q)."""

    reals: Any
    leaves: Any
    leaf_ints: Any
    nodes: Any
    node_ints: Any
    c: float
    s: float
    p: float  # length
    q: float


class Piece(NamedTuple):
    """A node of the tree, or a part of a leaf, and the capsule that covers it."""

    node: int
    first: float  # parameters of a leaf's part
    last: float
    x0: float
    y0: float
    x1: float
    y1: float
    radius: float


class Potential(NamedTuple):
    """The signed distance from a circle of curvature k through o with the normal n there (a line if
    k is 0), or from the point o (`pointed`)."""

    pointed: bool
    x: float
    y: float
    nx: float
    ny: float
    k: float
