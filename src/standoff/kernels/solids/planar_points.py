"""Points and a planar solid: inside or outside, and the signed distance, proven."""

from math import inf
from typing import NamedTuple

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.compiler.decorators import kernel, reals_on_stack, small
from standoff.kernels.solids.planar_closest import along, foot
from standoff.kernels.solids.planar_layout import FORM, GENERAL, Potential
from standoff.kernels.solids.planar_pieces import (
    halves,
    jet_at,
    leaf_int,
    leaf_of,
    node_piece,
    to_segment,
    width,
)
from standoff.kernels.solids.planar_ranges import covers, greatest
from standoff.kernels.solids.planar_search import put_piece, take_piece
from standoff.kernels.solids.planar_tolerances import SPLIT_LENGTH

# A row of a stack: the bound and the piece. A tree is at most some 60 deep, a leaf cut 50 times.
N_STACKED = 9
MOST_STACKED = 160
STACK_NUMBERS = 1440


class Foot(NamedTuple):
    """The boundary point that is nearest to a point."""

    distance: float
    lower: float  # proven: no boundary point is nearer
    x: float
    y: float
    leaf: int
    t: float


@small
def stacked(stack, size, bound, piece):
    stack[N_STACKED * size] = bound
    put_piece(stack, N_STACKED * size + 1, piece)
    return size + 1


@kernel
def away(piece, x, y):
    return to_segment(x, y, piece.x0, piece.y0, piece.x1, piece.y1) - piece.radius


@kernel
def nearest_boundary(outline, x, y, tolerance, extent):
    """The nearest boundary point, depth first, the nearer part first; proven to the tolerance."""
    stack = reals_on_stack(STACK_NUMBERS)
    root = node_piece(outline, 0)
    size = stacked(stack, 0, away(root, x, y), root)
    best, proven = Foot(inf, inf, x, y, -1, 0.0), inf
    while size > 0:
        size -= 1
        bound = stack[N_STACKED * size]
        if bound >= best.distance - tolerance:
            proven = min(proven, bound)
            continue
        piece = take_piece(stack, N_STACKED * size + 1)
        leaf = leaf_of(outline, piece.node)
        if leaf >= 0:
            t = foot(outline, piece, x, y, along(piece, x, y))
            px, py, _, _, _, _ = jet_at(outline, leaf, t)
            d = sqrt((px - x) * (px - x) + (py - y) * (py - y))
            if d < best.distance:
                best = Foot(d, 0.0, px, py, leaf, t)
            bound = max(bound, leaf_bound(outline, leaf, piece, x, y, t, d))
            stuck = width(piece) < SPLIT_LENGTH * extent or size + 2 >= MOST_STACKED
            if bound >= best.distance - tolerance or stuck:
                proven = min(proven, bound)
                continue
        one, two = halves(outline, piece)
        bound_1, bound_2 = max(bound, away(one, x, y)), max(bound, away(two, x, y))
        if bound_1 < bound_2:
            one, two, bound_1, bound_2 = two, one, bound_2, bound_1
        size = stacked(stack, size, bound_1, one)
        size = stacked(stack, size, bound_2, two)
    lower = max(0.0, min(proven, best.distance))
    return Foot(best.distance, lower, best.x, best.y, best.leaf, best.t)


@kernel
def leaf_bound(outline, leaf, piece, x, y, t, d):
    """No point of the piece is nearer: exact on lines and arcs, else by the distance from the
    point as the potential."""
    if leaf_int(outline, leaf, FORM) != GENERAL:
        return d
    return -greatest(outline, piece, Potential(True, x, y, 0.0, 0.0, 0.0), -1.0, t)


@kernel
def winding(outline, x, y, extent):
    """How often the boundary turns round a point: 1 inside, 0 outside. A piece whose capsule does
    not hold the point turns round it as its chord does."""
    stack = reals_on_stack(STACK_NUMBERS)
    size, turns = stacked(stack, 0, 0.0, node_piece(outline, 0)), 0
    while size > 0:
        size -= 1
        piece = take_piece(stack, N_STACKED * size + 1)
        straight = leaf_of(outline, piece.node) >= 0 and (
            leaf_int(outline, leaf_of(outline, piece.node), FORM) == 0
            or width(piece) < SPLIT_LENGTH * extent
            or size + 2 >= MOST_STACKED
        )
        if straight or not covers(piece, x, y, SPLIT_LENGTH * extent):
            turns += crossed(piece, x, y)
            continue
        one, two = halves(outline, piece)
        size = stacked(stack, size, 0.0, one)
        size = stacked(stack, size, 0.0, two)
    return turns


@small
def crossed(piece, x, y):
    """1 or -1 where the chord crosses the ray from a point to the right, upward or downward."""
    if (piece.y0 <= y) == (piece.y1 <= y):
        return 0
    area = (piece.x1 - piece.x0) * (y - piece.y0) - (x - piece.x0) * (piece.y1 - piece.y0)
    if piece.y1 > piece.y0:
        return 1 if area > 0.0 else 0
    return -1 if area < 0.0 else 0
