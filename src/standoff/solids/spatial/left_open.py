"""What a search left open, as an answer tells it: pieces of both boundaries in boxes."""

from __future__ import annotations

import numpy as np

from standoff.bodies.features import NO_FEATURE, Feature
from standoff.kernels.entries.solids import part_extents
from standoff.kernels.solids import spatial_layout as S
from standoff.solids.answer import MOST_OPEN, OpenPair
from standoff.solids.spatial.minimum import Found
from standoff.solids.spatial.pair import Place, PlacedPair
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.tree import CORNERS
from standoff.typing import Array


def open_pairs(pair: PlacedPair, found: Found) -> tuple[tuple[OpenPair, ...], int]:
    """Those of a search that ended before all was closed, and how many there are; if more than are
    listed, with those that were closed by what was found later."""
    rows = found.left[found.left[:, -1] < found.upper - found.tolerance]
    count = len(rows) if found.n_open <= MOST_OPEN else found.n_open
    return tuple(_of_row(pair, row) for row in rows), count


def around(pair: PlacedPair, places: list[Place]) -> tuple[OpenPair, ...]:
    """The leaves of places at which boundaries meet."""
    rows = {tuple(place.row[1:3]): place for place in places[:MOST_OPEN]}
    found = []
    for leaf_a, leaf_b in rows:
        boxes = [s.leaves[int(k)].reals[:4] for s, k in ((pair.a, leaf_a), (pair.b, leaf_b))]
        row = np.concatenate([[leaf_a, leaf_b], *boxes, [-np.inf]])
        found.append(_of_row(pair, row))
    return tuple(found)


def _of_row(pair: PlacedPair, row: Array) -> OpenPair:
    feature_a, corners_a = _piece(pair.a, int(row[0]), row[2:6])
    feature_b, corners_b = _piece(pair.b, int(row[1]), row[6:10])
    return OpenPair(
        float(row[-1]) - pair.slack,
        feature_a,
        feature_b,
        corners_a @ pair.ra.T + pair.pa,
        corners_b @ pair.rb.T + pair.pb,
    )


def _piece(solid: SolidModel, leaf: int, box: Array) -> tuple[Feature, Array]:
    """(its feature, the corners (8, 3) of a box around it, own frame) of a part of a leaf, or of a
    node of the tree, -1 - leaf."""
    if leaf < 0:
        o = int(solid.own[S.R_NODES]) + S.NODE_REALS * (-1 - leaf)
        node = solid.numbers[o : o + S.NODE_REALS]
        axes = node[S.AXES : S.AXES + 9].reshape(3, 3)
        return NO_FEATURE, node[:3] + (CORNERS * node[S.HALF : S.HALF + 3]) @ axes
    part = solid.leaves[leaf]
    out = np.zeros(6)
    axes = np.ascontiguousarray(part.axes)
    part_extents(solid.packed, axes.ravel(), leaf, np.ascontiguousarray(box), out)
    # within the leaf's own box, which may be the narrower one
    low, high = axes @ out[:3] - out[3:], axes @ out[:3] + out[3:]
    middle = axes @ part.centre
    low, high = np.maximum(low, middle - part.half), np.minimum(high, middle + part.half)
    corners = 0.5 * (low + high) + CORNERS * np.maximum(0.5 * (high - low), 0.0)
    return solid.feature_of(leaf), corners @ axes
