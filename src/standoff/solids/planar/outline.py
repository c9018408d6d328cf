"""The packed boundary of a planar solid: what compiled loops read."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from standoff.kernels.entries import planar_solids as entries
from standoff.kernels.solids import planar_layout as P
from standoff.solids.planar.loops import Loop, packed_loop
from standoff.solids.planar.tolerances import BOUND_ROUNDED
from standoff.typing import Array, Ints


class PlanarOutline(NamedTuple):
    """Arrays of a boundary, read-only.

    Attributes
    ----------
    reals, leaves, leaf_ints, nodes, node_ints : (n,) arrays
        See ``kernels.solids.planar_layout``.
    low, high : (2,) arrays
        A box around the boundary.
    """

    reals: Array
    leaves: Array
    leaf_ints: Ints
    nodes: Array
    node_ints: Ints
    low: Array
    high: Array

    @property
    def arrays(self) -> tuple[Array, Array, Ints, Array, Ints]:
        """What the kernels take."""
        return self[:5]

    @property
    def n_leaves(self) -> int:
        return len(self.leaves) // P.N_LEAF

    @property
    def size(self) -> float:
        """The box's diagonal, length."""
        return float(np.linalg.norm(self.high - self.low))

    @property
    def extent(self) -> float:
        """The greatest coordinate and the size, length."""
        return self.size + float(np.abs([self.low, self.high]).max())

    @property
    def starts(self) -> Array:
        """(n, 2) first points of the leaves."""
        return self.leaves.reshape(-1, P.N_LEAF)[:, P.START : P.START + 2]

    def heights(self, ways: Array) -> Array:
        """How far it reaches along unit vectors (n, 2), at most, lengths (n,)."""
        rows = self.leaves.reshape(-1, P.N_LEAF)
        ends = np.maximum(self.starts @ ways.T, rows[:, P.END : P.END + 2] @ ways.T)
        return np.asarray((ends + leaf_radii(rows)[:, None]).max(axis=0))

    def leaf_int(self, leaf: int, which: int) -> int:
        return int(self.leaf_ints[P.N_LEAF_INT * leaf + which])

    def leaf_real(self, leaf: int, which: int) -> float:
        return float(self.leaves[P.N_LEAF * leaf + which])

    def foot(self, points: Array, tolerance: float) -> tuple[Array, Ints, Array]:
        """Of points (n, 2): distances from the boundary, whether inside (0 or 1), and rows of
        (proven distance, foot point, leaf, parameter)."""
        n = len(points)
        distances, inside, feet = np.empty(n), np.empty(n, dtype=np.int64), np.empty((n, 5))
        extent = self.extent + float(np.abs(points).max(initial=0.0))
        proof = max(tolerance, BOUND_ROUNDED * extent)
        entries.points(self.arrays, points, proof, extent, distances, inside, feet)
        return distances, inside, feet


def packed_outline(loops: tuple[Loop, ...]) -> PlanarOutline:
    """Pack loops, the solid on the left of each."""
    data: list[Array] = []
    leaves: list[Array] = []
    ints: list[Ints] = []
    ranges: list[tuple[int, int]] = []
    n_data = n_curves = n_leaves = 0
    for loop in loops:
        offsets = []
        for curve in loop.curves:
            offsets.append(n_data)
            data.append(np.asarray(curve.data, dtype=np.float64))
            n_data += len(curve.data)
        part = packed_loop(loop, n_curves, offsets, n_leaves)
        ranges.append((n_leaves, n_leaves + len(part.reals)))
        leaves.append(part.reals)
        ints.append(part.ints)
        n_curves += len(loop.curves)
        n_leaves += len(part.reals)
    rows = np.concatenate(leaves)
    nodes, node_ints = built(rows, ranges)
    radii = leaf_radii(rows)[:, None]
    ends = rows[:, P.START : P.START + 2], rows[:, P.END : P.END + 2]
    low = np.minimum(*ends) - radii
    high = np.maximum(*ends) + radii
    packed = (
        np.concatenate(data),
        rows.ravel(),
        np.concatenate(ints).ravel(),
        nodes.ravel(),
        node_ints.ravel(),
        low.min(axis=0),
        high.max(axis=0),
    )
    for array in packed:
        array.flags.writeable = False
    return PlanarOutline(*packed)


# The tree over the leaves of a planar boundary, of capsules.

# Rounding outward of radii: a few operations.
OUTWARD = 1.0 + 64.0 * float(np.finfo(np.float64).eps)


def leaf_radii(leaves: Array) -> Array:
    """How far a leaf leaves its chord: max |x_tt| dt² / 8, and the padding."""
    step = np.abs(leaves[:, P.UNTIL] - leaves[:, P.FROM])
    radii: Array = (0.125 * leaves[:, P.BEND] * step**2 + leaves[:, P.PAD]) * OUTWARD
    return radii


def built(leaves: Array, loops: list[tuple[int, int]]) -> tuple[Array, Ints]:
    """Nodes (n, N_NODE) and their integers (n, N_NODE_INT): node 0 is the root; loops are ranges
    [first, end) of leaves."""
    radii = leaf_radii(leaves)
    starts, ends = leaves[:, P.START : P.START + 2], leaves[:, P.END : P.END + 2]
    nodes: list[Array] = []
    ints: list[tuple[int, int, int]] = []

    def add(capsule: Array, parts: tuple[int, int, int]) -> int:
        nodes.append(capsule)
        ints.append(parts)
        return len(nodes) - 1

    def chain(first: int, end: int, whole: bool) -> int:
        own = add(
            _disc(starts, ends, radii, first, end)
            if whole
            else _capsule(starts, ends, radii, first, end),
            (-1, -1, first),
        )
        if end - first > 1:
            middle = (first + end) // 2
            ints[own] = (chain(first, middle, False), chain(middle, end, False), -1)
        return own

    def together(group: list[tuple[int, int]]) -> int:
        if len(group) == 1:
            return chain(*group[0], True)
        own = add(_disc(starts, ends, radii, group[0][0], group[-1][1]), (-1, -1, -1))
        half = len(group) // 2
        ints[own] = (together(group[:half]), together(group[half:]), -1)
        return own

    together(loops)
    return np.array(nodes), np.array(ints, dtype=np.int64)


def _capsule(starts: Array, ends: Array, radii: Array, first: int, end: int) -> Array:
    p, q = starts[first], ends[end - 1]
    if end - first == 1:
        return np.array([*p, *q, radii[first]])
    points = np.concatenate([starts[first:end], ends[first:end]])
    along = q - p
    size = float(along @ along)
    s = np.clip((points - p) @ along / size, 0.0, 1.0) if size > 0.0 else np.zeros(len(points))
    away = np.linalg.norm(points - p - s[:, None] * along, axis=1)
    reach = float((away + np.tile(radii[first:end], 2)).max())
    return np.array([*p, *q, reach * OUTWARD + radii[first:end].min()])


def _disc(starts: Array, ends: Array, radii: Array, first: int, end: int) -> Array:
    """Round the middle of the box: a closed chain has no chord."""
    points = np.concatenate([starts[first:end], ends[first:end]])
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    away = np.linalg.norm(points - middle, axis=1) + np.tile(radii[first:end], 2)
    reach = float(away.max()) * OUTWARD + float(radii[first:end].min())
    return np.array([*middle, *middle, reach])
