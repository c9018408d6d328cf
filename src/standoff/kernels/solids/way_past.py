"""A move of B by which a plane is known to be between two solids: it parts them."""

from math import inf
from typing import Any, NamedTuple

from standoff.kernels.algebra.vectors import dot, scale
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_record
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_boxes import (
    half_along,
    node_axis,
    node_centre,
    node_reals,
)
from standoff.kernels.solids.spatial_heights import height_greatest
from standoff.kernels.solids.spatial_pieces import ZERO, leaf_box, leaf_ints
from standoff.kernels.solids.spatial_tolerances import WAY_ROUNDINGS


class Height(NamedTuple):
    """The height n . (x - o), as of a plane's potential."""

    n: Any
    o: Any


@kernel
def node_height(side, node, n):
    """How far a node's box reaches along a unit vector, at most."""
    axes = node_axis(side, node, 0), node_axis(side, node, 1), node_axis(side, node, 2)
    half = half_along(side.numbers, node_reals(side, node) + S.HALF, axes, n)
    return dot(node_centre(side, node), n) + half


@kernel
def is_within_edges(side, leaf):
    """Is it a piece of a plane that trims cut? Its own rectangle reaches too far, and nothing of
    the face farther than the edges, which have leaves."""
    r = leaf_ints(side, leaf)
    if side.own[r + S.DIM] != 2 or side.own[r + S.CUT] == 0:
        return False
    return side.ints[chart_record(side.ints, side.own[r + S.CHART]) + L.CHART_KIND] == L.PLANE


@kernel
def height_along(side, n, stack):
    """How far a solid reaches along a unit vector, at most: to the end of a leaf's box, or of its
    whole rectangle where that is known in closed form."""
    best, top, height = -inf, 1, Height(n, ZERO)
    stack[0] = 0
    while top > 0:
        top -= 1
        node = int(stack[top])
        reach = node_height(side, node, n)
        if reach <= best:
            continue
        row = side.own[S.NODES] + S.NODE_INTS * node
        leaf = side.own[row + 2]
        if leaf >= 0:
            if is_within_edges(side, leaf):
                continue
            known, exact = height_greatest(height, 1.0, side, leaf, leaf_box(side, leaf))
            best = max(best, min(reach, exact) if known else reach)
            continue
        one, other = side.own[row], side.own[row + 1]
        if node_height(side, one, n) > node_height(side, other, n):
            one, other = other, one
        stack[top], stack[top + 1] = one, other  # the higher one first
        top += 2
    return best


@kernel
def way_past(a, b, normal, least, rounding, stack):
    """A vector, A's frame: B, moved by it, is past a plane that A is below; the shortest along both
    ways of the axes of the boxes at both roots, and along the unit vector `normal`, but longer than
    `least`: what is moved further along it stays past.

    `stack` : room for integers, a few more than the trees are deep.
    """
    best, way = inf, ZERO
    for k in range(13):
        n = normal
        if k < 12:
            side = a if k < 6 else b
            n = scale(1.0 if k % 2 == 0 else -1.0, node_axis(side, 0, (k % 6) // 2))
        down = scale(-1.0, n)
        length = height_along(a, n, stack) + height_along(b, down, stack)
        length = max(length, least) + WAY_ROUNDINGS * rounding
        if length < best:
            best, way = length, scale(length, n)
    return way
