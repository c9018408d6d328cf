"""Convex sets in a plane: points, segments, polygons, and what two of them have in common."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from standoff.geometry.tolerances import KEPT_EXTENT, NARROWED, WIDENINGS
from standoff.typing import Array


@dataclass(frozen=True)
class FlatSet:
    """The convex hull of points in a plane.

    Attributes
    ----------
    dimension : 0, 1 or 2.
    corners : (1, 2), (2, 2) or (k, 2) array, the extreme points, counterclockwise.
    """

    dimension: int
    corners: Array

    @staticmethod
    def of(points: Array, least: float) -> FlatSet:
        """The hull of points (n, 2); extents below `least` [length] count as zero."""
        centre = points.mean(axis=0)
        axes = np.linalg.svd(points - centre, full_matrices=False)[2]
        along = (points - centre) @ axes.T
        extents = np.ptp(along, axis=0)
        if extents[0] <= least:
            return FlatSet(0, points[:1])
        if len(extents) < 2 or extents[1] <= least:
            return FlatSet(1, points[[int(along[:, 0].argmin()), int(along[:, 0].argmax())]])
        return FlatSet(2, points[scipy.spatial.ConvexHull(points).vertices])

    def half_planes(self, widened: float) -> tuple[Array, Array]:
        """Normals (k, 2) and offsets (k,): the widened set is {x: normals @ x <= offsets}."""
        c = self.corners
        if self.dimension == 0:
            normals = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
        elif self.dimension == 1:
            t = (c[1] - c[0]) / np.linalg.norm(c[1] - c[0])
            normals = np.array([t, -t, [t[1], -t[0]], [-t[1], t[0]]])
        else:
            sides = np.roll(c, -1, axis=0) - c
            normals = np.column_stack([sides[:, 1], -sides[:, 0]])
            normals = normals / np.linalg.norm(normals, axis=1)[:, None]
        return normals, (normals @ c.T).max(axis=1) + widened


def shared(a: FlatSet, b: FlatSet, tolerance: float, least: float) -> FlatSet | None:
    """The intersection of two sets; None if they are further apart than the tolerance [length].

    An extent below `least` [length] counts as zero. The corners are exact to roundoff.
    """
    if (a.dimension, -len(a.corners)) > (b.dimension, -len(b.corners)):
        a, b = b, a  # fewer half-planes to cut with
    wide = _clipped(a.corners, *b.half_planes(tolerance))
    narrow = _clipped(a.corners, *b.half_planes(NARROWED * tolerance))
    if not len(wide):
        return None
    if not len(narrow):
        return FlatSet(0, wide.mean(axis=0)[None])
    found = _settled(FlatSet.of(wide, least), FlatSet.of(narrow, least))
    for part in WIDENINGS:
        cut = _clipped(a.corners, *b.half_planes(part * tolerance))
        if not len(cut):
            continue
        sharp = FlatSet.of(cut, least)
        whole = _extents(sharp)[0] >= _extents(found)[0] - tolerance
        if sharp.dimension == found.dimension and whole:
            return sharp
    return found


def _settled(wide: FlatSet, narrow: FlatSet) -> FlatSet:
    """The set of lower dimension, if an extent of the wider set exists only by the tolerance."""
    kept = [x > KEPT_EXTENT * y for x, y in zip(_extents(narrow), _extents(wide), strict=True)]
    dimension = min(narrow.dimension, wide.dimension, sum(kept))
    if dimension == narrow.dimension:
        return narrow
    return FlatSet.of(narrow.corners, float(np.nextafter(_extents(narrow)[dimension], np.inf)))


def _extents(s: FlatSet) -> tuple[float, float]:
    """Length and width along the principal axes."""
    c = s.corners - s.corners.mean(axis=0)
    if s.dimension == 0:
        return 0.0, 0.0
    along = np.ptp(c @ np.linalg.svd(c, full_matrices=False)[2].T, axis=0)
    return float(along[0]), float(along[1]) if s.dimension == 2 else 0.0


def _clipped(corners: Array, normals: Array, offsets: Array) -> Array:
    """The part of a polygon, segment or point in half-planes (Sutherland and Hodgman, 1974)."""
    points = corners
    for normal, offset in zip(normals, offsets, strict=True):
        if not len(points):
            break
        rises = points @ normal - offset
        if (rises <= 0.0).all():
            continue
        follow, next_rises = np.roll(points, -1, axis=0), np.roll(rises, -1)
        crosses = (rises > 0.0) != (next_rises > 0.0)
        share = rises[crosses] / (rises[crosses] - next_rises[crosses])
        cuts = points[crosses] + share[:, None] * (follow - points)[crosses]
        inside = rises <= 0.0
        order = np.concatenate([np.flatnonzero(inside), np.flatnonzero(crosses) + 0.5])
        points = np.vstack([points[inside], cuts])[np.argsort(order, kind="stable")]
    return points


__all__ = ["FlatSet", "shared"]
