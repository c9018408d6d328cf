"""Whether a planar boundary meets itself, or turns back into itself at a vertex."""

from math import acos

from standoff.kernels.compiler.decorators import kernel, reals_on_stack
from standoff.kernels.solids.planar_closest import nearest_points
from standoff.kernels.solids.planar_layout import (
    AFTER,
    FROM,
    GREATEST_K,
    GREATEST_SPEED,
    LEAST_K,
    LEFT,
    N_NODE_INT,
    RIGHT,
    UNTIL,
)
from standoff.kernels.solids.planar_pieces import (
    apart,
    frame_at,
    halves,
    leaf_int,
    leaf_of,
    leaf_real,
    node_piece,
    width,
)
from standoff.kernels.solids.planar_search import put_piece, take_piece

N_PAIR = 16
MOST_PAIRS = 500
PAIR_NUMBERS = 8000
NONE, MEETS, TURNS_BACK, UNDECIDED = 0, 1, 2, 3


@kernel
def stacked_pair(stack, size, p, q):
    put_piece(stack, N_PAIR * size, p)
    put_piece(stack, N_PAIR * size + 8, q)
    return size + 1


@kernel
def swing(outline, piece):
    """How far the tangent turns over a piece, radians."""
    leaf = leaf_of(outline, piece.node)
    bend = max(abs(leaf_real(outline, leaf, LEAST_K)), abs(leaf_real(outline, leaf, GREATEST_K)))
    return bend * leaf_real(outline, leaf, GREATEST_SPEED) * abs(piece.last - piece.first)


@kernel
def follows(outline, p, q):
    """Does piece q begin where piece p ends?"""
    leaf_p, leaf_q = leaf_of(outline, p.node), leaf_of(outline, q.node)
    if leaf_p == leaf_q:
        return p.last == q.first
    return (
        leaf_int(outline, leaf_p, AFTER) == leaf_q
        and p.last == leaf_real(outline, leaf_p, UNTIL)
        and q.first == leaf_real(outline, leaf_q, FROM)
    )


@kernel
def fans_out(outline, p, q):
    """Do pieces that share p's end and q's start share nothing else? All chords from there lie in
    the cones of the tangents, which must be disjoint."""
    _, _, ux, uy, _ = frame_at(outline, leaf_of(outline, p.node), p.last)
    _, _, vx, vy, _ = frame_at(outline, leaf_of(outline, q.node), q.first)
    angle = acos(min(1.0, max(-1.0, -(ux * vx + uy * vy))))
    return angle > swing(outline, p) + swing(outline, q)


@kernel
def both_cut(outline, stack, size, p, q):
    one, two = halves(outline, p)
    three, four = halves(outline, q)
    size = stacked_pair(stack, size, one, three)
    size = stacked_pair(stack, size, one, four)
    size = stacked_pair(stack, size, two, three)
    return stacked_pair(stack, size, two, four)


@kernel
def look_at(outline, p, q, touch):
    """(what is known of a pair of leaves' pieces, x, y): -1 where it must be cut."""
    if follows(outline, p, q) or follows(outline, q, p):
        joined = fans_out(outline, p, q) if follows(outline, p, q) else fans_out(outline, q, p)
        if joined:
            return NONE, 0.0, 0.0
        if width(p) + width(q) > 4.0 * touch:
            return -1, 0.0, 0.0
        return TURNS_BACK, p.x1, p.y1
    near = nearest_points(outline, p, outline, q)
    if near.distance <= touch:
        return MEETS, near.ax, near.ay
    return -1, 0.0, 0.0


@kernel
def clash(outline, touch, budget):
    """(what was found, x, y, leaf, leaf) of parts of the boundary that are nearer than `touch`."""
    stack = reals_on_stack(PAIR_NUMBERS)
    root = node_piece(outline, 0)
    size, looked = stacked_pair(stack, 0, root, root), 0
    while size > 0:
        size -= 1
        looked += 1
        if looked > budget or size + 4 > MOST_PAIRS:
            return UNDECIDED, 0.0, 0.0, 0, 0
        p, q = take_piece(stack, N_PAIR * size), take_piece(stack, N_PAIR * size + 8)
        leaf_p, leaf_q = leaf_of(outline, p.node), leaf_of(outline, q.node)
        if p.node == q.node and p.first == q.first:
            if leaf_p < 0:
                at = N_NODE_INT * p.node
                left = node_piece(outline, outline.node_ints[at + LEFT])
                right = node_piece(outline, outline.node_ints[at + RIGHT])
                size = stacked_pair(stack, size, left, left)
                size = stacked_pair(stack, size, right, right)
                size = stacked_pair(stack, size, left, right)
            continue
        if apart(p, q) > touch:
            continue
        if leaf_p >= 0 and leaf_q >= 0:
            found, x, y = look_at(outline, p, q, touch)
            if found > 0:
                return found, x, y, leaf_p, leaf_q
            if found < 0:
                size = both_cut(outline, stack, size, p, q)
            continue
        if leaf_p < 0 and (leaf_q >= 0 or width(p) >= width(q)):
            one, two = halves(outline, p)
            size = stacked_pair(stack, stacked_pair(stack, size, one, q), two, q)
        else:
            one, two = halves(outline, q)
            size = stacked_pair(stack, stacked_pair(stack, size, p, one), p, two)
    return NONE, 0.0, 0.0, 0, 0
