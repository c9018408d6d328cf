"""A tree of boxes over the pieces of a world, and the pairs whose boxes come near each other.

The boxes are padded: while each piece stays in its own, no pair is missed. The tree is complete and
binary, of nodes 1 .. 2 n_leaves - 1 with children 2 k and 2 k + 1; its leaves are in the order of
the Morton codes of the boxes' centres, the last ones empty.
"""

from math import inf
from typing import Any, NamedTuple

from standoff.kernels.compiler.decorators import ahead, ints_on_stack, kernel
from standoff.kernels.tolerances import BOUND_ROUNDINGS, EPS
from standoff.kernels.world.arrays import F_PLANE, P_HIGH, P_LOW
from standoff.kernels.world.filter import counts
from standoff.kernels.world.pairs import write_pair

N_BOX = 6
"""Of a padded box: low (3), high (3)."""

DEEPEST = 80
"""Nodes that a walk down the tree keeps: its depth and a few."""

GRID = 2097151.0
"""Cells of the Morton code along each axis, less one: 21 bits."""

PAD_PART = 0.05
"""Of the piece's own box (its greatest half): how far the padded one stands off at least."""
PAD_FRAMES = 6.0
"""And in ways of the last frame: it lasts as many frames at this speed."""

SOUGHT_PART = 0.25
"""Of the pieces: where more leave their boxes at once, the tree's leaves are put in order anew."""
MOST_REFITS = 200
"""Searches after which they are in any case: a tree that is only refitted grows loose."""


class Tree(NamedTuple):
    """Pointers, and the number of leaves, a power of two."""

    nodes: Any  # (2 n_leaves, N_BOX)
    order: Any  # the piece of each leaf
    leaf: Any  # of each piece, its leaf; -1 for a half-space, which is in no tree
    n_leaves: int
    n_filled: int


@kernel
def spread(x):
    """The 21 lowest bits of a number, two zeros after each."""
    x = (x | (x << 32)) & 0x1F00000000FFFF
    x = (x | (x << 16)) & 0x1F0000FF0000FF
    x = (x | (x << 8)) & 0x100F00F00F00F00F
    x = (x | (x << 4)) & 0x10C30C30C30C30C3
    return (x | (x << 2)) & 0x1249249249249249


@kernel
def morton(box, low, scale):
    """The code of a box's centre in the cube that begins at `low`."""
    code = 0
    for i in range(3):
        at = (0.5 * (box[i] + box[3 + i]) - low[i]) * scale
        code |= spread(int(min(max(at, 0.0), GRID))) << i
    return code


@kernel
def pad_box(row, fact, way, box):
    """A padded box about a piece that went so far (length) in the last frame."""
    if fact[F_PLANE] != 0.0:
        for k in range(3):
            box[k], box[3 + k] = -inf, inf
        return
    greatest = 0.0
    for k in range(3):
        greatest = max(greatest, 0.5 * (row[P_HIGH + k] - row[P_LOW + k]))
    pad = max(PAD_PART * greatest, min(PAD_FRAMES * way, 2.0 * greatest))
    for k in range(3):
        box[k], box[3 + k] = row[P_LOW + k] - pad, row[P_HIGH + k] + pad


@kernel
def in_box(row, box):
    """Is a piece within its padded box?"""
    inside = True
    for k in range(3):
        inside = inside and box[k] <= row[P_LOW + k] and row[P_HIGH + k] <= box[3 + k]
    return inside


@kernel
def fill_leaf(tree, piece, box):
    node = ahead(tree.nodes, N_BOX * (tree.n_leaves + tree.leaf[piece]))
    for k in range(N_BOX):
        node[k] = box[k]


@kernel
def empty_leaves(tree):
    for leaf in range(tree.n_filled, tree.n_leaves):
        node = ahead(tree.nodes, N_BOX * (tree.n_leaves + leaf))
        for k in range(3):
            node[k], node[3 + k] = inf, -inf


@kernel
def refit(tree):
    """Boxes of all nodes from those of the leaves."""
    for k in range(tree.n_leaves - 1, 0, -1):
        node, left = ahead(tree.nodes, N_BOX * k), ahead(tree.nodes, N_BOX * 2 * k)
        right = ahead(left, N_BOX)
        for i in range(3):
            node[i] = min(left[i], right[i])
            node[3 + i] = max(left[3 + i], right[3 + i])


@kernel
def near(node, box, reach):
    """Can boxes come within `reach` of each other?"""
    can = True
    for k in range(3):
        can = can and node[k] - box[3 + k] <= reach and box[k] - node[3 + k] <= reach
    return can


@kernel
def gap_of(node, box):
    """The square of the distance of two boxes, rounded down."""
    squares = 0.0
    for k in range(3):
        gap = max(node[k] - box[3 + k], box[k] - node[3 + k])
        squares += gap * gap if gap > 0.0 else 0.0
    return squares * (1.0 - BOUND_ROUNDINGS * EPS)


@kernel
def find(tree, rules, pieces, piece, box, reach, emit, n_found):
    """Write down each pair of a piece with another whose padded box comes within `reach` of this
    one's; of two that are both searched for, the one of the lesser number writes. Returns how many
    pairs there are by now: those beyond the room of `emit` are counted, not written.
    """
    stack = ints_on_stack(DEEPEST)
    stack[0] = 1
    height = 1
    squares = reach * reach
    while height > 0:
        height -= 1
        k = stack[height]
        node = ahead(tree.nodes, N_BOX * k)
        if not near(node, box, reach):
            continue
        if k < tree.n_leaves:
            stack[height], stack[height + 1] = 2 * k + 1, 2 * k
            height += 2
        elif k - tree.n_leaves < tree.n_filled and gap_of(node, box) <= squares:
            other = tree.order[k - tree.n_leaves]
            fresh = pieces.searched[other] == 0 or other > piece
            if fresh and counts(rules, pieces.owners[piece], pieces.owners[other]):
                n_found = write_pair(pieces, piece, other, emit, n_found)
    return n_found
