"""A frame of a world as Python calls it, in parts: where the pieces are, which pairs are sought,
which are due, and their answers.
"""

from math import inf

from numba import types

from standoff.kernels.compiler.decorators import (
    entry,
    kernel,
    pointer,
    reals_on_stack,
)
from standoff.kernels.compiler.entry import (
    INT,
    INTS,
    READ,
    READ_BLOCKS,
    REAL,
    ROWS,
    WRITE_INTS,
)
from standoff.kernels.state.arrays import is_pose
from standoff.kernels.world.arrays import F_PLACED, N_FACT, N_PLACED
from standoff.kernels.world.filter import Filter, counts
from standoff.kernels.world.pairs import (
    Pairs,
    Pieces,
    look,
    look_again,
    merge,
    write_pair,
)
from standoff.kernels.world.pieces import apart, flat_pose, put_piece
from standoff.kernels.world.search import pad_sought, put_codes, seek_pairs
from standoff.kernels.world.tree import N_BOX, Tree, in_box

ROWS_OF_INTS = types.Array(INT, 2, "C")
READ_INTS_2 = types.Array(INT, 2, "C", readonly=True)
READ_2 = types.Array(REAL, 2, "C", readonly=True)

# What does not change of a world's pieces: owners; first piece of each body, then how many pieces
# there are and how many a body has at most; half-spaces (1); facts.
PIECES = types.Tuple((INTS, INTS, INTS, READ_2))
# And what a frame writes of them: placed, searched, still.
PLACED = types.Tuple((ROWS, WRITE_INTS, WRITE_INTS))
# Which pairs count: kinds, meets, pairs left out.
RULES = types.Tuple((INTS, READ_INTS_2, INTS))
# Margins: numbers of pairs of bodies, and their margins.
MARGINS = types.Tuple((INTS, READ))
# The tree: nodes, order, leaf; and one of a state.
TREE = types.Tuple((ROWS, INTS, INTS))
OLD_TREE = types.Tuple((READ_2, INTS, INTS))
# A table of pairs, and one of a state.
PAIRS = types.Tuple((ROWS_OF_INTS, ROWS))
OLD_PAIRS = types.Tuple((READ_INTS_2, READ_2))


@kernel
def pieces_at(fixed, frame):
    owners, first, _, facts = fixed
    placed, searched, still = frame
    n = len(first) - 2
    most = first[n + 1]
    return Pieces(
        pointer(owners, 0),
        pointer(first, 0),
        pointer(facts, 0),
        pointer(placed, 0),
        pointer(searched, 0),
        pointer(still, 0),
        n,
        most,
    )


@kernel
def rules_at(rules, n_bodies):
    kinds, meets, left_out = rules
    return Filter(
        pointer(kinds, 0),
        meets.shape[0],
        pointer(meets, 0),
        pointer(left_out, 0),
        len(left_out),
        n_bodies,
    )


@kernel
def tree_at(tree, n_filled):
    nodes, order, leaf = tree
    return Tree(
        pointer(nodes, 0), pointer(order, 0), pointer(leaf, 0), nodes.shape[0] // 2, n_filled
    )


@kernel
def pairs_at(table, n):
    ints, known = table
    return Pairs(pointer(ints, 0), pointer(known, 0), n)


@entry(PIECES, READ_BLOCKS, READ_2, READ_2, PLACED, work="world")
def place(fixed, poses, boxes, before, frame):
    """Where all pieces are at the bodies' poses (n, 4, 4).

    Fills in the rows of `frame` from those `before`, marks the pieces that have left their padded
    boxes, and those that are still. Returns (-1, how many have left, how many are still), or the
    first body whose pose is none, or makes none of a piece's.
    """
    _, first, planes, facts = fixed
    placed, searched, still = frame
    n_left, n_still = 0, 0
    flat = reals_on_stack(12)
    for body in range(len(first) - 2):
        if not flat_pose(pointer(poses, 16 * body), flat):
            return body, 0, 0
        for p in range(first[body], first[body + 1]):
            row = pointer(placed, N_PLACED * p)
            fact, last = pointer(facts, N_FACT * p), pointer(before, N_PLACED * p)
            rests = put_piece(flat, fact, last, row)
            # a pose that is only just let pass may be none where it is composed with a placement
            if fact[F_PLACED] != 0.0 and not rests and not is_pose(row):
                return body, 0, 0
            left = planes[p] == 0 and not rests and not in_box(row, pointer(boxes, N_BOX * p))
            still[p], searched[p] = 1 if rests else 0, 1 if left else 0
            n_still += still[p]
            n_left += searched[p]
    return -1, n_left, n_still


@entry(READ_2, WRITE_INTS, work="world")
def codes(boxes, found):
    """The Morton codes of the centres of boxes (n, N_BOX)."""
    put_codes(pointer(boxes, 0), len(boxes), pointer(found, 0), 1)
    return 0


@entry(PIECES, PLACED, ROWS, READ, TREE, INT, work="world")
def pad(fixed, frame, boxes, ways, tree, n_filled):
    """New padded boxes of the pieces that are searched for, and the tree of them; `ways` are how
    far the pieces went in the last frame."""
    at = tree_at(tree, n_filled)
    pad_sought(pieces_at(fixed, frame), len(fixed[0]), pointer(boxes, 0), pointer(ways, 0), at)
    return 0


@entry(PIECES, PLACED, READ_2, OLD_TREE, INT, RULES, REAL, ROWS_OF_INTS, work="world")
def seek(fixed, frame, boxes, tree, n_filled, rules, reach, found):
    """Pairs of the pieces that are searched for with all whose padded boxes come within `reach`.

    Returns how many there are: more than len(found), and only these are written.
    """
    pieces, at = pieces_at(fixed, frame), tree_at(tree, n_filled)
    filter, emit = rules_at(rules, pieces.n_bodies), (pointer(found, 0), len(found))
    planes, n = pointer(fixed[2], 0), len(fixed[2])
    return seek_pairs(pieces, planes, n, at, filter, pointer(boxes, 0), reach, emit)


@entry(PIECES, PLACED, RULES, ROWS_OF_INTS, work="world")
def all_pairs(fixed, frame, rules, found):
    """All pairs of pieces that count; returns how many there are."""
    pieces = pieces_at(fixed, frame)
    filter, emit, n = rules_at(rules, pieces.n_bodies), (pointer(found, 0), len(found)), 0
    planes = fixed[2]
    for p in range(len(planes)):
        for q in range(p + 1, len(planes)):
            both = planes[p] != 0 and planes[q] != 0
            if not both and counts(filter, pieces.owners[p], pieces.owners[q]):
                n = write_pair(pieces, p, q, emit, n)
    return n


@entry(PIECES, PLACED, OLD_PAIRS, ROWS_OF_INTS, MARGINS, REAL, PAIRS, work="world")
def merged(fixed, frame, old, found, margins, within, new):
    """The table of pairs after a search, into `new`, which has room for all; how many there are."""
    pieces = pieces_at(fixed, frame)
    before = pairs_at(old, len(old[0]))
    room = pairs_at(new, len(new[0]))
    lasting, (numbers, values) = pointer(fixed[2], 0), margins
    horizons = (pointer(numbers, 0), pointer(values, 0), len(numbers)), within
    return merge(before, pointer(found, 0), len(found), pieces, lasting, horizons, room)


@entry(PIECES, PLACED, PAIRS, REAL, INT, WRITE_INTS, work="world")
def due(fixed, frame, table, minima, last, fates):
    """What becomes of each pair in this frame; see `pairs.look`."""
    look(pieces_at(fixed, frame), pairs_at(table, len(fates)), minima, last, pointer(fates, 0))
    return 0


@entry(PIECES, PLACED, PAIRS, REAL, WRITE_INTS, WRITE_INTS, work="world")
def due_again(fixed, frame, table, minima, fates, again):
    """Of bodies of several pieces, pairs of pieces that may be nearer than those asked."""
    pairs = pairs_at(table, len(fates))
    return look_again(pieces_at(fixed, frame), pairs, minima, pointer(fates, 0), pointer(again, 0))


@entry(PIECES, READ_2, INT, INT, work="world")
def apart_by_boxes(fixed, placed, i, j):
    """A lower bound of two bodies' signed distance, from the boxes of their pieces."""
    first, facts = fixed[1], fixed[3]
    least = inf
    for p in range(first[i], first[i + 1]):
        for q in range(first[j], first[j + 1]):
            a, fact_a = pointer(placed, N_PLACED * p), pointer(facts, N_FACT * p)
            b, fact_b = pointer(placed, N_PLACED * q), pointer(facts, N_FACT * q)
            least = min(least, apart(a, fact_a, b, fact_b))
    return least
