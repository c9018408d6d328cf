"""Polytopes opened by a ball: everything that balls inside the polytope can reach."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .facets import Facets
from .support import Polytope, Swept

Array = NDArray[Any]

FEASIBLE = 1e-11
"""How far a vertex of the core may lie outside its planes, over the size: roundoff of solving."""
REGULAR = 1e-9
"""Least determinant of three unit normals that meet in a vertex worth solving for."""
SAME = 1e-9
"""Distance, over the size, below which two vertices are one: more than three planes meet."""


def inner_vertices(normals: Array, offsets: Array, size: float) -> Array:
    """Return the vertices (m, 3) of ``normals @ x <= offsets``: all triples of planes, tried."""
    triples = np.array(list(combinations(range(len(normals)), 3)))
    matrices = normals[triples]
    determinants = np.abs(np.linalg.det(matrices))
    sound = determinants > REGULAR
    spots = np.linalg.solve(matrices[sound], offsets[triples[sound]][:, :, None])[:, :, 0]
    kept = (spots @ normals.T <= offsets + FEASIBLE * size).all(axis=1)
    steepest_first = np.argsort(-determinants[sound][kept])
    found: list[Array] = []
    for spot in spots[kept][steepest_first]:
        if all(np.linalg.norm(spot - known) > SAME * size for known in found):
            found.append(spot)
    return np.array(found)


def distances_to_segments(point: Array, starts: Array, ends: Array) -> Array:
    """Return the distances (m,) of one point from segments."""
    along = ends - starts
    share = ((point - starts) * along).sum(axis=1) / (along * along).sum(axis=1)
    nearest = starts + np.clip(share, 0, 1)[:, None] * along
    return np.asarray(np.linalg.norm(point - nearest, axis=1))


class RoundedPolytope(Swept):
    """The opening of the hull of ``vertices`` (m, 3) by a ball of radius ``rounding``."""

    core: Polytope

    def __init__(self, vertices: ArrayLike, rounding: float) -> None:
        sharp = np.asarray(vertices, dtype=float)
        facets = Facets(sharp)
        size = float(np.linalg.norm(sharp, axis=1).max())
        core = inner_vertices(facets.normals, facets.offsets - rounding, size)
        super().__init__(Polytope(core), rounding)

    def outside(self, point: ArrayLike) -> float:
        """Signed distance to the surface: exact outside of the core, which is where it counts."""
        p = np.asarray(point, dtype=float)
        facets = self.core.facets
        heights = facets.normals @ p - facets.offsets
        if heights.max() <= 0:
            return float(heights.max()) - self.sweep
        feet = p - heights[:, None] * facets.normals
        slack = FEASIBLE * self.bounding_radius
        on_face = (feet @ facets.normals.T <= facets.offsets + slack).all(axis=1)
        corners = self.core.vertices[facets.edges]
        to_edges = distances_to_segments(p, corners[:, 0], corners[:, 1])
        to_faces = np.where(on_face & (heights > 0), heights, np.inf)
        return float(min(to_edges.min(), to_faces.min())) - self.sweep
