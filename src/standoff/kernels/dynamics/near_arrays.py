"""Where everything of a system's search for near pairs is.

Each body is one piece of a world: the ball about its box. What does not change stands among the
system's integers and numbers; what a tick writes, in two arrays of the scratch.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from standoff.kernels.compiler.decorators import ahead, kernel
from standoff.kernels.dynamics.arrays import I_NEAR, I_NEAR_NUMBERS, n_bodies, n_pairs
from standoff.kernels.world.arrays import N_EMIT, N_INTS, N_KNOWN, N_PLACED
from standoff.kernels.world.filter import Filter
from standoff.kernels.world.pairs import Pairs, Pieces
from standoff.kernels.world.tree import N_BOX, Tree

# Header of the integers of a tick: how many pairs it visits, -1 for all; was the table made; which
# of the two tables holds it, and its length; searches since the leaves were put in order.
G_VISITED, G_MADE, G_WHICH, G_LENGTH, G_REFITS = range(5)
NEAR_HEADER = 5

KINDS = 2
"""Of bodies: free ones, and others, which do not meet each other."""


class Near(NamedTuple):
    """Pointers to what a tick's search reads and writes, but for the tables."""

    pieces: Any
    planes: Any  # 1 for a half-space
    rules: Any
    tree: Any
    boxes: Any  # padded
    ways: Any  # of each body in the last tick, length
    reach: Any  # the greatest horizon, length
    keys: Any  # i n + j of the system's pairs of bodies i < j, sorted
    pairs: Any  # and their numbers
    found: Any


@kernel
def searches(system):
    """Does the system look for its near pairs by a tree?"""
    return system.layout[I_NEAR] > 0


@kernel
def n_visited(system, scratch):
    """How many pairs the tick visits."""
    n = scratch.near[G_VISITED]
    return n_pairs(system) if n < 0 else n


@kernel
def visited(scratch, k):
    """The k-th of them, in the order of the system's pairs."""
    return k if scratch.near[G_VISITED] < 0 else scratch.near[NEAR_HEADER + k]


@kernel
def last_visit(system, scratch):
    """Pointer: the tick in which each pair was visited last."""
    return ahead(scratch.near, NEAR_HEADER + n_pairs(system))


@kernel
def n_leaves(n):
    leaves = 1
    while leaves < n:
        leaves *= 2
    return leaves


@kernel
def most_found(n):
    """Pairs of n bodies, or the bodies themselves where those are more."""
    return max(n * (n - 1) // 2, n)


@kernel
def near_arrays(system):
    """(integers, numbers) of the scratch; of one row where nothing is searched for."""
    n, m = n_bodies(system), n_pairs(system)
    ints, reals = NEAR_HEADER, 1
    if searches(system):
        # one row behind what is found, which may be looked at, not read
        ints += 2 * m + 4 * n + N_EMIT * (most_found(n) + 1) + 2 * N_INTS * m
        reals = (N_PLACED + N_BOX + 1) * n + N_BOX * 2 * n_leaves(n) + 2 * N_KNOWN * m
    # pages that are never written take no memory
    found = np.empty(ints, dtype=np.int64), np.empty(reals)
    found[0][:NEAR_HEADER] = 0
    found[0][G_VISITED] = -1
    if searches(system):
        found[0][NEAR_HEADER + m : NEAR_HEADER + 2 * m] = -1
    return found


@kernel
def table_of(system, scratch, which):
    """One of the two tables of pairs, as long as the header says."""
    n, m = n_bodies(system), n_pairs(system)
    ints = NEAR_HEADER + 2 * m + 4 * n + N_EMIT * (most_found(n) + 1) + which * N_INTS * m
    reals = (N_PLACED + N_BOX + 1) * n + N_BOX * 2 * n_leaves(n) + which * N_KNOWN * m
    length = scratch.near[G_LENGTH]
    return Pairs(ahead(scratch.near, ints), ahead(scratch.near_numbers, reals), length)


@kernel
def near_of(system, scratch):
    """All but the tables."""
    n, m = n_bodies(system), n_pairs(system)
    fixed = ahead(system.layout, system.layout[I_NEAR])
    numbers = ahead(system.numbers, system.layout[I_NEAR_NUMBERS])
    ints, reals = ahead(scratch.near, NEAR_HEADER + 2 * m), scratch.near_numbers
    first = ahead(fixed, 1)  # each body is one piece, of its own number
    kinds = ahead(first, n + 1)
    planes = ahead(kinds, n)
    meets = ahead(planes, n)
    keys = ahead(meets, KINDS * KINDS)
    boxes = ahead(reals, N_PLACED * n)
    nodes = ahead(boxes, N_BOX * n)
    leaves = n_leaves(n)
    return Near(
        Pieces(first, first, ahead(numbers, 1), reals, ints, ahead(ints, n), n, 1),
        planes,
        Filter(kinds, KINDS, meets, keys, 0, n),
        Tree(nodes, ahead(ints, 2 * n), ahead(ints, 3 * n), leaves, fixed[0]),
        boxes,
        ahead(nodes, N_BOX * 2 * leaves),
        numbers[0],
        keys,
        ahead(keys, m),
        ahead(ints, 4 * n),
    )
