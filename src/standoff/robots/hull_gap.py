"""How far the surface of a mesh's hull is from the mesh."""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import NDArray

from standoff.bodies.hulls.qhull import hull_triangles
from standoff.bodies.meshes.columns import spread

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

MEASURED = 64
"""Points of the hull whose distance from all triangles is taken: those farthest from samples of
the mesh."""


def hull_gap(points: Array, triangles: Ints) -> float:
    """The greatest distance of the hull's surface from the triangles that was found, length.

    Points all over the hull's facets are tried, some 40,000; the distance of the farthest ones is
    exact. The mesh may have holes.
    """
    facets = hull_triangles(points, "vertices of the mesh").corners
    spots = spread(points, facets)
    near = scipy.spatial.cKDTree(spread(points, triangles)).query(spots)[0]
    farthest = spots[np.argsort(near)[-MEASURED:]]
    corners = points[triangles]
    return max(float(_from_triangles(spot, corners)) for spot in farthest)


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
