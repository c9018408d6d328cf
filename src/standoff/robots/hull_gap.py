"""How far the surface of a mesh's hull is from the mesh."""

from __future__ import annotations

import numpy as np
import scipy

from standoff.bodies.hulls.qhull import hull_triangles
from standoff.typing import Array, Ints

SPOTS, SAMPLES = 4096, 40_000
"""Points of the hull, and of the mesh beside its corners: evenly by area."""
MEASURED = 64
"""Points of the hull whose distance from all triangles is taken: those farthest from samples of
the mesh."""
GOLDEN = np.array([0.7548776662466927, 0.5698402909980532])
"""Steps of the sequence in the plane that is spread most evenly (of Roberts)."""


def hull_gap(points: Array, triangles: Ints) -> float:
    """The greatest distance of the hull's surface from the triangles that was found, length.

    It is exact for the points that are measured, so never more than the true one. The mesh may
    have holes.
    """
    facets = hull_triangles(points, "vertices of the mesh").corners
    spots = _samples(points[facets], SPOTS)
    corners = points[triangles]
    samples = np.concatenate([points, _samples(corners, SAMPLES)])
    near = scipy.spatial.cKDTree(samples, balanced_tree=False).query(spots)[0]
    middles = corners.mean(axis=1)
    radii = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)
    gap = 0.0
    for k in np.argsort(near)[-MEASURED:]:
        # a sample is this near, so triangles that are farther are not the nearest
        some = np.linalg.norm(middles - spots[k], axis=1) - radii <= near[k]
        gap = max(gap, _from_triangles(spots[k], corners[some]))
    return gap


def _samples(corners: Array, count: int) -> Array:
    """Points of triangles (t, 3, 3), as dense everywhere."""
    sides = corners[:, 1:] - corners[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    ends = np.cumsum(areas)
    owners = np.searchsorted(ends, (np.arange(count) + 0.5) / count * ends[-1])
    shares = np.modf((1.0 + np.arange(count))[:, None] * GOLDEN)[0]
    over = shares.sum(axis=1) > 1.0
    shares[over] = 1.0 - shares[over]
    return np.asarray(corners[owners, 0] + np.einsum("nk,nkj->nj", shares, sides[owners]))


def _from_triangles(spot: Array, corners: Array) -> float:
    """The least distance of a point from triangles (t, 3, 3)."""
    starts, ends = corners, np.roll(corners, -1, axis=1)
    sides = ends - starts
    lengths = np.maximum(np.einsum("tkj,tkj->tk", sides, sides), np.finfo(float).tiny)
    shares = np.clip(np.einsum("tkj,tkj->tk", spot - starts, sides) / lengths, 0.0, 1.0)
    from_sides = np.linalg.norm(spot - (starts + shares[..., None] * sides), axis=2).min()
    normals = np.cross(sides[:, 0], sides[:, 1])
    sizes = np.linalg.norm(normals, axis=1)
    firm = sizes > 0.0
    normals = normals[firm] / sizes[firm, None]
    inward = np.cross(normals[:, None], sides[firm])
    above = (np.einsum("tkj,tkj->tk", spot - starts[firm], inward) >= 0.0).all(axis=1)
    heights = np.abs(np.einsum("tj,tj->t", spot - starts[firm, 0], normals))
    return float(min(from_sides, heights[above].min(initial=np.inf)))
