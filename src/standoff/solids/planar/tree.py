"""The tree over the leaves of a planar boundary, of capsules."""

from __future__ import annotations

import numpy as np

from standoff.kernels.solids import planar_layout as P
from standoff.typing import Array, Ints

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
