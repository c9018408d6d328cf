"""Vertices of a sewn body, and the parts of sides between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from standoff.bodies.sewing.patches import SewnPatch
from standoff.bodies.sewing.sides import SIDE_NAMES, PatchSide
from standoff.bodies.tolerances import MAX_SPREAD
from standoff.errors import BodyError
from standoff.typing import Array

# Corners of a patch in the order of SIDE_NAMES: side k runs from corner k to corner k + 1.
_CORNERS = ((0, 2), (1, 2), (1, 3), (0, 3))


@dataclass(frozen=True, eq=False)
class Stretch:
    """A side, or the part of it between two vertices, which is sewn to one other stretch.

    patch, side : numbers; first, last : vertices at the ends of its free parameter.
    """

    patch: int
    number: int
    side: PatchSide
    first: int
    last: int

    @property
    def label(self) -> str:
        return self.side.label


@dataclass(frozen=True, eq=False)
class SewnOutline:
    """All vertices, every patch's stretches for each side, and its collapsed sides (side, vertex).

    spread : the greatest distance between a corner and its vertex, length.
    """

    vertices: Array
    stretches: list[list[Stretch]]
    collapsed: list[list[tuple[PatchSide, int]]]
    spread: float


def outline(patches: Sequence[SewnPatch], tolerance: float) -> SewnOutline:
    """Merge corners within the tolerance and cut sides where corners of other sides lie on them."""
    sides = [[patch.side(name) for name in SIDE_NAMES] for patch in patches]
    flat = [[side.collapsed(tolerance) for side in row] for row in sides]
    corners = np.array([_corner(patch, k) for patch in patches for k in range(4)])
    number, vertices, spread = _merge(patches, corners, flat, tolerance)
    tree = scipy.spatial.KDTree(vertices)
    stretches: list[list[Stretch]] = []
    collapsed: list[list[tuple[PatchSide, int]]] = []
    for p, row in enumerate(sides):
        stretches.append([])
        collapsed.append([])
        for k, side in enumerate(row):
            start, stop = int(number[4 * p + k]), int(number[4 * p + (k + 1) % 4])
            if side.name in ("v1", "u0"):  # they run clockwise
                start, stop = stop, start
            if flat[p][k]:
                collapsed[p].append((side, start))
                continue
            stretches[p] += _cut(p, k, side, start, stop, vertices, tree, tolerance)
    return SewnOutline(vertices, stretches, collapsed, spread)


def _corner(patch: SewnPatch, k: int) -> Array:
    domain = patch.surface.domain
    i, j = _CORNERS[k]
    return patch.surface.jet(domain[i], domain[j])[0]


def _merge(
    patches: Sequence[SewnPatch], corners: Array, flat: list[list[bool]], tolerance: float
) -> tuple[Array, Array, float]:
    """(vertex of every corner, vertex points, spread)."""
    pairs = [(int(a), int(b)) for a, b in scipy.spatial.KDTree(corners).query_pairs(tolerance)]
    for p, row in enumerate(flat):
        pairs += [(4 * p + k, 4 * p + (k + 1) % 4) for k in range(4) if row[k]]
    n = len(corners)
    rows = np.array(pairs, dtype=np.intp).reshape(-1, 2)
    graph = scipy.sparse.coo_matrix((np.ones(len(rows)), (rows[:, 0], rows[:, 1])), shape=(n, n))
    count, number = scipy.sparse.csgraph.connected_components(graph, directed=False)
    sums = np.zeros((count, 3))
    np.add.at(sums, number, corners)
    means = sums / np.bincount(number, minlength=count)[:, None]
    # one of the corners, the nearest to their mean: exact patches keep their exact corners
    away = np.linalg.norm(corners - means[number], axis=1)
    order = np.lexsort((away, number))
    chosen = order[np.searchsorted(number[order], np.arange(count))]
    vertices = corners[chosen]
    misses = np.linalg.norm(corners - vertices[number], axis=1)
    worst = int(misses.argmax())
    if misses[worst] > MAX_SPREAD * tolerance:
        raise BodyError(
            f"{patches[worst // 4].label}: its corner {corners[worst]} is chained to a vertex "
            f"{misses[worst]:.3g} away by corners within the tolerance {tolerance:.3g} of each "
            "other: give a smaller tolerance.",
            "tolerance",
            tolerance,
        )
    return number, vertices, float(misses[worst])


def _cut(
    patch: int,
    number: int,
    side: PatchSide,
    start: int,
    stop: int,
    vertices: Array,
    tree: scipy.spatial.KDTree,
    tolerance: float,
) -> list[Stretch]:
    """The stretches of a side between the vertices that lie on it (T-junctions)."""
    if start == stop:
        raise BodyError(
            f"{side.label} begins and ends at the same vertex {vertices[start]} (tolerance "
            f"{tolerance:.3g}): split the patch or give a smaller tolerance.",
            "tolerance",
            tolerance,
        )
    centre = side.polyline.mean(axis=0)
    # the curve is nearer to a link of its polyline than the length of the link
    reach = float(np.linalg.norm(side.polyline - centre, axis=1).max()) + side.length / 16.0
    inside: list[tuple[float, int]] = []
    for k in tree.query_ball_point(centre, reach + tolerance):
        if k in (start, stop):
            continue
        t, miss = side.nearest(vertices[k])
        if miss <= tolerance and side.first < t < side.last:
            inside.append((t, int(k)))
    inside.sort()
    ends = [(side.first, start), *inside, (side.last, stop)]
    return [Stretch(patch, number, side.part(a[0], b[0]), a[1], b[1]) for a, b in pairwise(ends)]
