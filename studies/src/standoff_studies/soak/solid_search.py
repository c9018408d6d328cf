"""A solid's boundary in cells, and the distance of two boundaries by an exhaustive search."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from standoff_studies.soak import solid_cells
from standoff_studies.soak.solid_cells import Boundary
from standoff_studies.soak.solid_outlines import Array
from standoff_studies.soak.solid_truth import Truth

COARSE = 1.0 / 12.0
"""Radius of the cells of the start, of the size."""
FOUR = np.array([[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]])


class Bounds(NamedTuple):
    """Of n poses.

    Attributes
    ----------
    lower, upper : (n,) arrays
        The distance between both boundaries is between these.
    below, above : (n,) arrays
        Least and greatest signed distance that was seen of points of A's boundary from B.
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

    Attributes
    ----------
    boundary : Boundary
    points : (m, 3) array
        One of each cell.
    """

    def __init__(self, truth: Truth, size: float) -> None:
        form, patches = truth.form, truth.patches
        done = []
        for number, patch in enumerate(patches):
            boxes = np.array([[0.5, 0.5, 0.5, 0.5]])
            while len(boxes):
                found = solid_cells.cells_of(form, patch, boxes)
                fine = found[:, 3] <= COARSE * size
                there = fine & (found[:, 3] >= 0.0)
                rows = np.column_stack([np.full(len(boxes), float(number)), boxes, found])
                done.append(rows[there])
                boxes = _cut(boxes[~fine])
        self.boundary = Boundary(form, patches, np.concatenate(done), size)
        self.points: Array = self.boundary.cells[:, 5:8]

    def least(self, other: Boundary, turns: Array, shifts: Array) -> Bounds:
        """Bounds of the distance from another solid at n poses.

        Parameters
        ----------
        other : Boundary
        turns, shifts : (n, 3, 3) and (n, 3) arrays
            From this solid's frame into the other's.
        """
        found = solid_cells.least_distances(
            self.boundary,
            other.form,
            np.ascontiguousarray(turns),
            np.ascontiguousarray(shifts),
        )
        return Bounds(*np.asarray(found).T)


def _cut(boxes: Array) -> Array:
    """Each in four."""
    half = 0.5 * boxes[:, 2:]
    corners = boxes[:, None, :2] + 2.0 * FOUR * half[:, None]
    pieces = np.concatenate([corners, np.broadcast_to(half[:, None], corners.shape)], axis=2)
    return pieces.reshape(-1, 4)
