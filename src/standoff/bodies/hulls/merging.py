"""Facets of one plane, or nearly so, become one face."""

from __future__ import annotations

import numpy as np
import scipy

from standoff.bodies.hulls.qhull import Triangles
from standoff.bodies.tolerances import COPLANAR_FACETS, MERGED_TURN
from standoff.typing import Array, Ints


def merged(points: Array, triangles: Triangles, tolerance: float) -> Ints:
    """For every triangle the number of its face; faces are numbered by their first triangles.

    Neighbours are of one face where their normals are the same to COPLANAR_FACETS, or their corners
    within `tolerance`, length, of the plane of the face's greatest triangle.
    """
    n = len(triangles.corners)
    alike = _alike(points, triangles, tolerance)
    one, side = np.nonzero(alike)
    graph = scipy.sparse.coo_matrix(
        (np.ones(len(one)), (one, triangles.neighbours[one, side])), shape=(n, n)
    )
    _, part = scipy.sparse.csgraph.connected_components(graph, directed=False)
    group = -np.ones(n, dtype=np.int64)
    several = np.flatnonzero(np.bincount(part)[part] > 1)
    _spread(points, triangles, tolerance, several, group)
    alone = group < 0
    group[alone] = group.max(initial=-1) + 1 + np.arange(int(alone.sum()))
    return by_first(group)


def by_first(group: Ints) -> Ints:
    """The same groups, numbered by their first members."""
    _, first, group = np.unique(group, return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    return rank[group]


def areas(points: Array, triangles: Triangles) -> Array:
    """(n,) twice the areas of triangles, length squared."""
    a, b, c = (points[triangles.corners[:, k]] for k in range(3))
    return np.asarray(np.linalg.norm(np.cross(b - a, c - a), axis=1))


def _alike(points: Array, triangles: Triangles, tolerance: float) -> Array:
    """(n, 3) of bool: may a triangle and its neighbour be of one face?"""
    corners, neighbours, normals = triangles
    beyond = normals[neighbours]
    alike = np.abs(beyond - normals[:, None, :]).max(axis=2) < COPLANAR_FACETS
    theirs = corners[neighbours]
    for k in range(3):
        on_side = (theirs[:, k] == corners[:, [k]]) | (theirs[:, k] == corners[:, [(k + 1) % 3]])
        # the neighbour's corner that is not on the side
        apex = np.take_along_axis(theirs[:, k], np.argmin(on_side, axis=1)[:, None], axis=1)[:, 0]
        rise = np.einsum("ij,ij->i", normals, points[apex] - points[corners[:, k]])
        turn = np.einsum("ij,ij->i", normals, beyond[:, k])
        alike[:, k] |= (np.abs(rise) <= tolerance) & (turn > MERGED_TURN)
    return np.asarray(alike)


def _spread(
    points: Array, triangles: Triangles, tolerance: float, members: Ints, group: Ints
) -> None:
    """Number the groups among the members, each from its greatest triangle over its neighbours."""
    corners, neighbours, normals = triangles
    area = areas(points, triangles)[members]
    number = 0
    for seed in members[np.argsort(-area, kind="stable")].tolist():
        if group[seed] >= 0:
            continue
        normal, origin = normals[seed], points[corners[seed, 0]]
        group[seed] = number
        front = np.array([seed])
        while len(front):
            near = np.unique(neighbours[front])
            near = near[group[near] < 0]
            same = np.abs(normals[near] - normal).max(axis=1) < COPLANAR_FACETS
            rise = np.abs((points[corners[near]] - origin) @ normal).max(axis=1)
            same |= (rise <= tolerance) & (normals[near] @ normal > MERGED_TURN)
            front = near[same]
            group[front] = number
        number += 1
