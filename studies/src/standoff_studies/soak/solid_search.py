"""The distance of two boundaries by an exhaustive search over the cells of one of them.

The signed distance from the other solid is a closed form and changes by no more than the length of
a move, so its value at the middle of a cell, less the cell's radius, bounds it over the cell. Cells
that may hold something nearer are cut in four. What is left at the end gives a lower bound; the
best cells are then cut on until they are smaller than a rounding, which gives an upper bound.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff_studies.soak.solid_outlines import Array
from standoff_studies.soak.solid_truth import Patch, Truth

Ints = NDArray[np.int64]

COARSE = 1.0 / 12.0
"""Radius of the cells of the start, of the size."""
LEVELS = 5
"""How often cells are cut in four while all are kept that may hold the minimum."""
MOST = 320
"""Cells of a pose that are kept at each level; the bound of the others still counts."""
BEST = 16
"""Cells of a pose that are cut on."""
FINEST = 1e-12
"""Radius of the last cells, of the size."""
CLEAR = 1e-9
"""Of the size: a point is on one side of a boundary if it is farther from it."""
STEPS = 56
"""Of a walk downhill, one on each patch: along a narrow valley that cells do not follow."""
STRIDE = 0.05
"""Of a patch: the first step."""
EIGHT = np.array([[i, j] for i in (-1.0, 0.0, 1.0) for j in (-1.0, 0.0, 1.0) if i or j])
FOUR = np.array([[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]])


class Cells(NamedTuple):
    """Rectangles (u, v, du, dv), half widths, of patches; of each its point and its radius."""

    patch: Ints
    box: Array
    point: Array
    radius: Array

    def rows(self, keep: Ints) -> Cells:
        return Cells(self.patch[keep], self.box[keep], self.point[keep], self.radius[keep])


class Bounds(NamedTuple):
    """Of n poses.

    Attributes
    ----------
    lower, upper : (n,) arrays
        The distance between both boundaries is between these.
    below, above : (n,) arrays
        Least and greatest signed distance of points of A's boundary from B: exact where they are
        of one sign and the least of their magnitudes is `upper`, else of the cells of the start.
    """

    lower: Array
    upper: Array
    below: Array
    above: Array


class Sampled:
    """A solid's boundary in coarse cells.

    Parameters
    ----------
    truth : Truth
    size : float
        Length; what radii are measured by.
    """

    def __init__(self, truth: Truth, size: float) -> None:
        self.patches: Sequence[Patch] = truth.patches
        self.size = size
        n = len(self.patches)
        cells = self._at(np.arange(n), np.tile([0.5, 0.5, 0.5, 0.5], (n, 1)))
        done = []
        while len(cells.radius):
            fine = cells.radius <= COARSE * size
            done.append(cells.rows(np.flatnonzero(fine)))
            cells = self._cut(cells.rows(np.flatnonzero(~fine)))[1]
        self.start = Cells(*(np.concatenate(columns) for columns in zip(*done, strict=True)))

    def _at(self, patch: Ints, box: Array) -> Cells:
        points, radii = np.zeros((len(box), 3)), np.full(len(box), -1.0)
        for k in np.unique(patch).tolist():
            here = np.flatnonzero(patch == k)
            points[here], radii[here] = self.patches[k].cells(*box[here].T)
        return Cells(patch, box, points, radii)

    def _cut(self, cells: Cells) -> tuple[Ints, Cells]:
        """(which cell each piece comes from, the pieces that hold some of the boundary)."""
        half = 0.5 * cells.box[:, 2:]
        corners = cells.box[:, None, :2] + 2.0 * FOUR * half[:, None]
        box = np.concatenate([corners, np.broadcast_to(half[:, None], corners.shape)], axis=2)
        whole = np.repeat(np.arange(len(half)), 4)
        found = self._at(cells.patch[whole], box.reshape(-1, 4))
        there = np.flatnonzero(found.radius >= 0.0)
        return whole[there], found.rows(there)

    def least(self, other: Truth, turns: Array, shifts: Array) -> Bounds:
        """Bounds of the distance from another solid at n poses.

        Parameters
        ----------
        other : Truth
        turns, shifts : (n, 3, 3) and (n, 3) arrays
            From this solid's frame into the other's.
        """
        n, m = len(turns), len(self.start.radius)
        pose = np.repeat(np.arange(n), m)
        cells = self.start.rows(np.tile(np.arange(m), n))
        signed = _seen(other, cells, pose, turns, shifts)
        table = signed.reshape(n, m)
        below, above = table.min(axis=1), table.max(axis=1)
        state = _State(np.full(n, np.inf), np.abs(table).min(axis=1))
        crossed = (below < -CLEAR * self.size) & (above > CLEAR * self.size)
        state.lower[crossed] = state.upper[crossed] = 0.0
        value, going = np.abs(signed), ~crossed[pose]
        for level in range(LEVELS + 1):
            keep = state.kept(pose, value - cells.radius, going)
            pose, cells, value = pose[keep], cells.rows(keep), value[keep]
            if level == LEVELS or not len(pose):
                break
            whole, cells = self._cut(cells)
            pose = pose[whole]
            signed = _seen(other, cells, pose, turns, shifts)
            value, going = np.abs(signed), np.ones(len(pose), dtype=bool)
            np.minimum.at(state.upper, pose, value)
            np.minimum.at(below, pose, signed)
            np.maximum.at(above, pose, signed)
        np.minimum.at(state.lower, pose, value - cells.radius)
        self._walk(other, cells, pose, value, turns, shifts, state)
        self._refine(other, cells, pose, value, turns, shifts, state)
        crossed = (below < -CLEAR * self.size) & (above > CLEAR * self.size)
        state.lower[crossed] = state.upper[crossed] = 0.0
        lower = np.clip(state.lower, 0.0, state.upper)
        return Bounds(lower, state.upper, below, above)

    def _refine(
        self, other: Truth, cells: Cells, pose: Ints, value: Array, turns: Array, shifts: Array,
        state: _State,
    ) -> None:  # fmt: skip
        """Cut the best cells until they are small; lowers `state.upper` in place."""
        while len(pose):
            keep = _first(pose, value, BEST)
            whole, cells = self._cut(cells.rows(keep))
            pose = pose[keep][whole]
            value = np.abs(_seen(other, cells, pose, turns, shifts))
            np.minimum.at(state.upper, pose, value)
            if float(cells.radius.max(initial=0.0)) < FINEST * self.size:
                return

    def _walk(
        self, other: Truth, cells: Cells, pose: Ints, value: Array, turns: Array, shifts: Array,
        state: _State,
    ) -> None:  # fmt: skip
        """Compass search from the best cell of each patch; lowers `state.upper` in place."""
        start = _first(pose * len(self.patches) + cells.patch, value, 1)
        patch, at, pose, least = cells.patch[start], cells.box[start, :2], pose[start], value[start]
        stride = np.full(len(at), STRIDE)

        def value_at(spots: Array) -> Array:
            """(n, k) distances at (n, k, 2) parameters."""
            k = spots.shape[1]
            box = np.hstack([spots.reshape(-1, 2), np.zeros((len(at) * k, 2))])
            tried = self._at(np.repeat(patch, k), box)
            seen = _seen(other, tried, np.repeat(pose, k), turns, shifts)
            return np.abs(seen).reshape(-1, k)

        rows = np.arange(len(at))
        for _ in range(STEPS if len(at) else 0):
            trial = np.clip(at[:, None] + stride[:, None, None] * EIGHT, 0.0, 1.0)
            found = value_at(trial)
            best = np.argmin(found, axis=1)
            better = found[rows, best] < least
            at = np.where(better[:, None], trial[rows, best], at)
            least = np.where(better, found[rows, best], least)
            stride *= np.where(better, 1.5, 0.5)
        np.minimum.at(state.upper, pose, least)


class _State(NamedTuple):
    """Bounds of n poses so far."""

    lower: Array
    upper: Array

    def kept(self, pose: Ints, bound: Array, going: NDArray[np.bool_]) -> Ints:
        """The cells to cut, at most MOST of a pose; bounds of the others join `lower`."""
        may = np.flatnonzero(going & (bound < self.upper[pose]))
        chosen = may[_first(pose[may], bound[may], MOST)]
        left = np.setdiff1d(may, chosen, assume_unique=True)
        np.minimum.at(self.lower, pose[left], bound[left])
        return chosen


def _first(pose: Ints, value: Array, most: int) -> Ints:
    """Of each pose the rows of its least values, at most so many."""
    order = np.lexsort((value, pose))
    sorted_pose = pose[order]
    start = np.searchsorted(sorted_pose, sorted_pose)
    return order[np.arange(len(order)) - start < most]


def _seen(other: Truth, cells: Cells, pose: Ints, turns: Array, shifts: Array) -> Array:
    """Signed distances of the cells' points from the other solid."""
    points = np.einsum("nij,nj->ni", turns[pose], cells.point) + shifts[pose]
    return other.signed(points)
