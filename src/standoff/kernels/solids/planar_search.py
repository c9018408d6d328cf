"""The nearest points of two planar boundaries, best first over both trees, and closed by
potentials."""

from math import inf
from typing import Any, NamedTuple

from standoff.kernels.compiler.decorators import kernel, small
from standoff.kernels.solids.planar_closest import (
    bend_toward,
    between,
    direction,
    is_stationary,
    nearest_points,
    potential_of,
)
from standoff.kernels.solids.planar_layout import Piece
from standoff.kernels.solids.planar_pieces import apart, halves, leaf_of, node_piece, width
from standoff.kernels.solids.planar_ranges import greatest
from standoff.kernels.solids.planar_tolerances import SPLIT_LENGTH

# A row of the queue: the bound, then both pieces.
N_ROW = 17
# A row of what was found: distance, bound, both points, normal, parameters, leaves.
N_FOUND = 12

CLOSED, SPENT, BEYOND, MET = 0, 1, 2, 3  # how a search ended
JETS, NODE_PAIRS, LEAF_PAIRS, BOXES, BISECTIONS, OPEN = 0, 1, 2, 3, 4, 5
N_COUNT = 6
# About how many jets a pair of leaves takes.
JETS_OF_PAIR = 40


class Sought(NamedTuple):
    """What is asked of a search; lengths."""

    tolerance: float  # of the proof
    roundoff: float  # of each bound
    extent: float  # greatest number that is computed with
    above: float  # local minima up to this distance are kept
    horizon: float  # a greater bound ends the search
    meeting: float  # points that are nearer than this end it too


class Queue(NamedTuple):
    """The open pairs: rows, and a heap of their numbers; and what was found."""

    rows: Any
    heap: Any
    capacity: int
    found: Any
    most_found: int


@small
def evaluations(counts):
    """Of points and of bounds."""
    return counts[JETS] + counts[NODE_PAIRS] + counts[BOXES]


@kernel
def put_piece(rows, at, piece):
    rows[at] = float(piece.node)
    rows[at + 1] = piece.first
    rows[at + 2] = piece.last
    rows[at + 3] = piece.x0
    rows[at + 4] = piece.y0
    rows[at + 5] = piece.x1
    rows[at + 6] = piece.y1
    rows[at + 7] = piece.radius


@kernel
def take_piece(rows, at):
    return Piece(
        int(rows[at]),
        rows[at + 1],
        rows[at + 2],
        rows[at + 3],
        rows[at + 4],
        rows[at + 5],
        rows[at + 6],
        rows[at + 7],
    )


@kernel
def push(queue, made, size, bound, p, q):
    """A new row, number `made`, for the heap of `size`."""
    at = N_ROW * made
    queue.rows[at] = bound
    put_piece(queue.rows, at + 1, p)
    put_piece(queue.rows, at + 9, q)
    rise(queue.rows, queue.heap, made, size)


@kernel
def rise(rows, heap, made, size):
    """Row `made` onto the heap of `size`."""
    bound, place = rows[N_ROW * made], size
    while place > 0:
        above = (place - 1) // 2
        if rows[N_ROW * heap[above]] <= bound:
            break
        heap[place] = heap[above]
        place = above
    heap[place] = made


@kernel
def pop(rows, heap, size):
    """The number of the row with the least bound, taken from the heap of `size`."""
    least, moved = heap[0], heap[size - 1]
    bound, place, left = rows[N_ROW * moved], 0, size - 1
    while True:
        below = 2 * place + 1
        if below >= left:
            break
        if below + 1 < left and rows[N_ROW * heap[below + 1]] < rows[N_ROW * heap[below]]:
            below += 1
        if rows[N_ROW * heap[below]] >= bound:
            break
        heap[place] = heap[below]
        place = below
    heap[place] = moved
    return least


class Pieces(NamedTuple):
    """A piece of each outline, and the outlines."""

    a: Any
    p: Piece
    b: Any
    q: Piece


class Progress(NamedTuple):
    """How far a search has come: lengths, and numbers of rows."""

    made: int
    size: int
    upper: float
    proven: float
    n_found: int


@kernel
def bound_by(pieces, phi, near):
    """No points of two pieces are nearer: the least of φ on B less the greatest on A."""
    a, p, b, q = pieces
    return -greatest(b, q, phi, -1.0, near.s) - greatest(a, p, phi, 1.0, near.t)


@kernel
def bound_pair(pieces, near, n, goal, sought, counts):
    """The best bound of a few potentials, which ends at the first that reaches the goal."""
    nx, ny = n
    a, p, b, q = pieces
    half = 0.5 * near.distance
    high = bend_toward(a, p, near.t, nx, ny, half)
    low = -bend_toward(b, q, near.s, -nx, -ny, half)
    best = -inf
    middle = between(low, high, width(p) + width(q))
    for trial in range(3):
        k = middle if trial == 0 else (high if trial == 1 else low)
        if trial > 0 and k == middle:
            continue
        counts[BOXES] += 2
        bound = bound_by(pieces, potential_of(near, nx, ny, k, sought.extent), near)
        best = max(best, bound)
        if best >= goal:
            break
    return best


@kernel
def keep(queue, n_found, near, n, bound, leaves):
    """Write down a pair of points; returns how many there are."""
    if n_found >= queue.most_found:
        return n_found
    found, at = queue.found, N_FOUND * n_found
    found[at] = near.distance
    found[at + 1] = bound
    found[at + 2] = near.ax
    found[at + 3] = near.ay
    found[at + 4] = near.bx
    found[at + 5] = near.by
    found[at + 6] = n[0]
    found[at + 7] = n[1]
    found[at + 8] = near.t
    found[at + 9] = near.s
    found[at + 10] = float(leaves[0])
    found[at + 11] = float(leaves[1])
    return n_found + 1


@small
def reach_of(sought, upper):
    """Pairs with a greater bound are of no interest."""
    return max(upper + sought.tolerance, sought.above)


@kernel
def close(pieces, bound, sought, queue, counts, progress):
    """(is a pair of leaves' pieces done with, its bound, the progress)."""
    a, p, b, q = pieces
    made, size, upper, proven, n_found = progress
    counts[LEAF_PAIRS] += 1
    counts[JETS] += JETS_OF_PAIR
    near = nearest_points(a, p, b, q)
    n = direction(a, p, b, q, near, sought.extent)
    leaves = leaf_of(a, p.node), leaf_of(b, q.node)
    if near.distance < upper:
        upper = near.distance
        keep(queue, 0, near, n, bound, leaves)
    goal = min(near.distance, max(upper, sought.above)) - sought.tolerance
    if n[0] != 0.0 or n[1] != 0.0:
        bound = max(bound, bound_pair(pieces, near, n, goal, sought, counts) - sought.roundoff)
    bound = min(bound, near.distance)
    alike = width(p) + width(q) < SPLIT_LENGTH * sought.extent
    done = bound >= goal or alike or upper <= sought.meeting
    if done:
        proven = min(proven, bound)
        touching = near.distance <= max(sought.tolerance, sought.meeting)
        if near.distance <= reach_of(sought, upper) and (
            touching or is_stationary(a, p, b, q, near, n[0], n[1])
        ):
            n_found = keep(queue, n_found, near, n, bound, leaves)
    return done, bound, Progress(made, size, upper, proven, n_found)


@small
def cut(a, p, b, q):
    """Is A's piece the one to be cut?"""
    open_a, open_b = leaf_of(a, p.node) < 0, leaf_of(b, q.node) < 0
    if open_a != open_b:
        return open_a
    return width(p) >= width(q)


@kernel
def put_part(pieces, floor, sought, queue, progress):
    """A part of a pair into the queue, or only its bound to what is proven."""
    made, size, upper, proven, n_found = progress
    bound = max(apart(pieces.p, pieces.q) - sought.roundoff, floor)
    if bound > reach_of(sought, upper):
        return Progress(made, size, upper, min(proven, bound), n_found)
    push(queue, made, size, bound, pieces.p, pieces.q)
    return Progress(made + 1, size + 1, upper, proven, n_found)


@kernel
def split(pieces, floor, sought, queue, progress):
    """The larger piece of a pair is cut, and both parts are put into the queue."""
    a, p, b, q = pieces
    if cut(a, p, b, q):
        one, two = halves(a, p)
        progress = put_part(Pieces(a, one, b, q), floor, sought, queue, progress)
        return put_part(Pieces(a, two, b, q), floor, sought, queue, progress)
    one, two = halves(b, q)
    progress = put_part(Pieces(a, p, b, one), floor, sought, queue, progress)
    return put_part(Pieces(a, p, b, two), floor, sought, queue, progress)


@kernel
def seek(a, b, sought, queue, counts, budget):
    """(how it ended, least proven, least found, how many pairs were kept).

    Every pair of pieces ends with a bound: dropped with a bound above what is sought, closed by a
    potential, or open in the queue. The least of these bounds is what is proven. The first of the
    pairs that are kept is the nearest.
    """
    p, q = node_piece(a, 0), node_piece(b, 0)
    push(queue, 0, 0, apart(p, q) - sought.roundoff, p, q)
    progress = Progress(1, 1, inf, inf, 1)
    while progress.size > 0:
        made, size, upper, proven, n_found = progress
        row = N_ROW * pop(queue.rows, queue.heap, size)
        bound = queue.rows[row]
        ended = -1
        if bound > reach_of(sought, upper):
            ended = CLOSED
        elif bound > sought.horizon:
            ended = BEYOND
        elif upper <= sought.meeting:
            ended = MET
        elif made + 4 > queue.capacity or evaluations(counts) > budget:
            ended = SPENT
        if ended >= 0:
            queue.heap[size - 1] = row // N_ROW  # of those that stay open
            counts[OPEN] = size
            return ended, min(proven, bound), upper, n_found if upper < inf else 0
        progress = Progress(made, size - 1, upper, proven, n_found)
        pieces = Pieces(a, take_piece(queue.rows, row + 1), b, take_piece(queue.rows, row + 9))
        floor = -inf
        if leaf_of(a, pieces.p.node) >= 0 and leaf_of(b, pieces.q.node) >= 0:
            done, floor, progress = close(pieces, bound, sought, queue, counts, progress)
            if done:
                continue
            counts[BISECTIONS] += 1
        counts[NODE_PAIRS] += 2
        progress = split(pieces, floor, sought, queue, progress)
    ended = MET if progress.upper <= sought.meeting else CLOSED
    return ended, progress.proven, progress.upper, progress.n_found
