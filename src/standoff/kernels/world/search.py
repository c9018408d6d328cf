"""The search of a world: new padded boxes, the order of the tree's leaves, and the pairs found."""

from math import inf

from standoff.kernels.compiler.decorators import ahead, kernel, reals_on_stack
from standoff.kernels.world.arrays import E_A, E_KEY, N_EMIT, N_FACT, N_PLACED
from standoff.kernels.world.filter import counts
from standoff.kernels.world.pairs import write_pair
from standoff.kernels.world.tree import (
    GRID,
    N_BOX,
    empty_leaves,
    fill_leaf,
    find,
    morton,
    pad_box,
    refit,
)


@kernel
def pad_sought(pieces, n, boxes, ways, tree):
    """New padded boxes of those of n pieces that are searched for, and the tree of them; `ways` are
    how far the pieces went in the last frame."""
    for p in range(n):
        if pieces.searched[p] != 0:
            box = ahead(boxes, N_BOX * p)
            pad_box(
                ahead(pieces.placed, N_PLACED * p), ahead(pieces.facts, N_FACT * p), ways[p], box
            )
            if tree.leaf[p] >= 0 and tree.n_filled > 0:
                fill_leaf(tree, p, box)
    if tree.n_filled > 0:
        empty_leaves(tree)
        refit(tree)


@kernel
def seek_pairs(pieces, planes, n, tree, rules, boxes, reach, emit):
    """Pairs of the pieces that are searched for with all whose padded boxes come within `reach`;
    how many there are. `planes` is 1 for a half-space."""
    n_found = 0
    for p in range(n):
        if pieces.searched[p] == 0:
            continue
        if planes[p] == 0:
            box = ahead(boxes, N_BOX * p)
            n_found = find(tree, rules, pieces, p, box, reach, emit, n_found)
        else:  # of a half-space once: its pairs last
            for q in range(n):
                if planes[q] == 0 and counts(rules, pieces.owners[p], pieces.owners[q]):
                    n_found = write_pair(pieces, p, q, emit, n_found)
    return n_found


@kernel
def put_codes(boxes, n, found, step):
    """The Morton codes of the centres of n boxes, every `step` integers."""
    low, high = reals_on_stack(3), reals_on_stack(3)
    for i in range(3):
        low[i], high[i] = inf, -inf
    for k in range(n):
        box = ahead(boxes, N_BOX * k)
        for i in range(3):
            centre = 0.5 * (box[i] + box[3 + i])
            low[i], high[i] = min(low[i], centre), max(high[i], centre)
    widest = max(max(high[0] - low[0], high[1] - low[1]), high[2] - low[2])
    scale = GRID / widest if widest > 0.0 else 0.0
    for k in range(n):
        found[step * k] = morton(ahead(boxes, N_BOX * k), low, scale)


@kernel
def sift(rows, root, n):
    """Let a row sink until none below it has a greater key."""
    while 2 * root + 1 < n:
        below = 2 * root + 1
        if below + 1 < n and rows[N_EMIT * below + E_KEY] < rows[N_EMIT * (below + 1) + E_KEY]:
            below += 1
        if rows[N_EMIT * below + E_KEY] <= rows[N_EMIT * root + E_KEY]:
            return
        for i in range(N_EMIT):
            at, to = N_EMIT * root + i, N_EMIT * below + i
            rows[at], rows[to] = rows[to], rows[at]
        root = below


@kernel
def sort_rows(rows, n):
    """Sort n rows of N_EMIT integers by their keys, in place and without more memory."""
    for root in range(n // 2 - 1, -1, -1):
        sift(rows, root, n)
    for end in range(n - 1, 0, -1):
        for i in range(N_EMIT):
            rows[i], rows[N_EMIT * end + i] = rows[N_EMIT * end + i], rows[i]
        sift(rows, 0, end)


@kernel
def order_leaves(tree, boxes, rows):
    """Put the tree's leaves in the order of their boxes' Morton codes, and make the tree anew;
    `rows` has room for n_filled rows of N_EMIT integers."""
    leaves = ahead(tree.nodes, N_BOX * tree.n_leaves)
    for k in range(tree.n_filled):
        fill_leaf(tree, tree.order[k], ahead(boxes, N_BOX * tree.order[k]))
        rows[N_EMIT * k + E_A] = tree.order[k]
    put_codes(leaves, tree.n_filled, rows, N_EMIT)
    sort_rows(rows, tree.n_filled)
    for k in range(tree.n_filled):
        piece = rows[N_EMIT * k + E_A]
        tree.order[k], tree.leaf[piece] = piece, k
        fill_leaf(tree, piece, ahead(boxes, N_BOX * piece))
    empty_leaves(tree)
    refit(tree)
