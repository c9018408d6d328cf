"""Points of a polyhedron's boundary where a cold start may begin, as ``bodies.sampling`` has them
of any body: the same grids and budgets."""

from __future__ import annotations

import numpy as np

from standoff.bodies.hulls.polyhedron import Polyhedron
from standoff.bodies.packing import Sample
from standoff.bodies.sampling import (
    EDGE_BUDGET,
    FACE_BUDGET,
    VERTEX_BUDGET,
    along_each,
    first_grid,
    second_grid,
    stride,
)
from standoff.bodies.tolerances import ON_SIDE
from standoff.typing import Array


def polyhedron_samples(solid: Polyhedron, pcurves: Array) -> list[Sample]:
    """Points on every kind of feature, the budgets shared among the features of a kind."""
    edges, vertices = len(solid.ends), len(solid.vertices)
    found = []
    normals = solid.normals
    for face in range(0, solid.n_faces, stride(solid.n_faces, FACE_BUDGET)):
        columns, shift = solid.planes[face, :, :2], solid.shifts[face]
        for u, v in _spots(solid, pcurves, face).tolist():
            point = shift + columns @ (u, v)
            found.append(Sample(point, normals[face], face, face, u, v))
    shares = along_each(edges)
    for edge in range(0, edges, stride(edges, EDGE_BUDGET)):
        first, last = solid.vertices[solid.ends[edge]]
        for t in shares.tolist():
            point = first + t * (last - first)
            found.append(Sample(point, np.zeros(3), solid.n_faces + edge, -1, t, 0.0))
    for vertex in range(0, vertices, stride(vertices, VERTEX_BUDGET)):
        feature = solid.n_faces + edges + vertex
        found.append(Sample(solid.vertices[vertex], np.zeros(3), feature, -1, 0.0, 0.0))
    return found


def _spots(solid: Polyhedron, pcurves: Array, face: int) -> Array:
    """(n, 2) parameters on a face."""
    own = slice(*solid.starts[face : face + 2])
    ahead = (solid.senses[own] > 0)[:, None]
    corners = np.where(ahead, pcurves[own, :, 2], pcurves[own].sum(axis=2))
    steps = np.where(ahead, pcurves[own, :, 0], -pcurves[own, :, 0])
    low, high = corners.min(axis=0), corners.max(axis=0)
    n = first_grid(solid.n_faces)
    for count in (n, second_grid(n)):  # a slender face may miss the first grid
        ticks = (np.arange(count) + 0.5) / count
        grid = np.stack(np.meshgrid(ticks, ticks, indexing="ij"), axis=-1).reshape(-1, 2)
        spots = low + grid * (high - low)
        away = spots[:, None] - corners
        left = steps[:, 0] * away[:, :, 1] - steps[:, 1] * away[:, :, 0]
        inside = (left >= -ON_SIDE * np.prod(high - low)).all(axis=1)
        if inside.any():
            return np.asarray(spots[inside])
    return np.zeros((0, 2))
