"""Fewer points whose hull is nearly that of all: facets nearly in one plane become few."""

from __future__ import annotations

import numpy as np
import scipy

from standoff.bodies.hulls.heights import highest
from standoff.bodies.hulls.qhull import unit_of
from standoff.typing import Array

# How many directions there are whose extreme points come first.
FIRST = 32


def directions(count: int = FIRST) -> Array:
    """(count, 3) unit vectors all round, on a spiral: none is an axis of a part, along which the
    highest of many points is any of a face."""
    k = np.arange(count)
    height, around = 1.0 - (2.0 * k + 1.0) / count, np.pi * (3.0 - np.sqrt(5.0)) * k
    flat = np.sqrt(1.0 - height**2)
    return np.column_stack([flat * np.cos(around), flat * np.sin(around), height])


def fewer_points(points: Array, tolerance: float, word: str) -> Array:
    """Some of the points, in their order; no other is more than `tolerance`, length, above a facet
    of their hull, which lies within that of all.

    From the extreme ones on, of every facet the highest point above it is added, until none is too
    high. All are returned where the extreme ones span no volume.
    """
    unit = unit_of(points, word)
    if not len(points):
        return points
    local = (points - points.mean(axis=0)) / unit
    chosen = np.unique((local @ directions().T).argmax(axis=0))
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
