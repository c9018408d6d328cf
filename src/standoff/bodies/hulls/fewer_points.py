"""Fewer points whose hull is nearly that of all: facets nearly in one plane become few."""

from __future__ import annotations

from itertools import product

import numpy as np
import scipy

from standoff.bodies.hulls.heights import highest
from standoff.bodies.hulls.qhull import unit_of
from standoff.geometry.validation import Array

# Directions whose extreme points come first: to a cube's faces, edges and corners.
DIRECTIONS = np.array([d for d in product((-1.0, 0.0, 1.0), repeat=3) if any(d)])
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1)[:, None]


def fewer_points(points: Array, tolerance: float, word: str) -> Array:
    """Some of the points, in their order; no other is more than `tolerance`, length, above a facet
    of their hull, which lies within that of all.

    From the extreme ones on, of every facet the highest point above it is added, until none is too
    high. All are returned where the extreme ones span no volume.
    """
    unit = unit_of(points, word)
    local = (points - points.mean(axis=0)) / unit
    chosen = np.unique((local @ DIRECTIONS.T).argmax(axis=0))
    while True:
        try:
            planes = scipy.spatial.ConvexHull(local[chosen]).equations
        except (scipy.spatial.QhullError, ValueError):
            return points
        planes = np.unique(planes, axis=0)  # triangles of one facet have one plane
        heights, numbers = highest(local, planes[:, :3], -planes[:, 3])
        added = np.setdiff1d(numbers[heights > tolerance / unit], chosen)
        if not len(added):
            return np.asarray(points[chosen])
        chosen = np.union1d(chosen, added)
