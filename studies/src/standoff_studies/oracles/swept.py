"""Shapes swept by a ball: spheres, capsules, rounded boxes and polytopes."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff_studies.oracles.facets import Facets
from standoff_studies.oracles.flats import Flat
from standoff_studies.oracles.polytopes import Point, Polytope, Segment, SharpBox
from standoff_studies.oracles.shape import Region, Shape, directions, unit

Array = NDArray[Any]

FEASIBLE = 1e-11
"""How far a vertex of the core may lie outside its planes, over the size: roundoff of solving."""
REGULAR = 1e-9
"""Least determinant of three unit normals for which a vertex is computed."""
SAME = 1e-9
"""Distance, over the size, below which two vertices are one, where more than three planes meet."""


class Swept(Shape):
    """Minkowski sum of ``core`` and a ball of radius ``sweep``."""

    def __init__(self, core: Shape, sweep: float) -> None:
        self.core = core
        self.sweep = float(sweep)
        self.bounding_radius = core.bounding_radius + self.sweep

    def points(self, normals: Array) -> Array:
        return self.core.points(normals) + self.sweep * unit(normals)

    def maximisers(self, normal: ArrayLike, tolerance: float) -> Array:
        direction = unit(directions(normal))
        return self.core.maximisers(normal, tolerance) + self.sweep * direction

    def special_normals(self, rng: np.random.Generator) -> Array:
        return self.core.special_normals(rng)

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        return [flat.moved_out(self.sweep) for flat in self.core.flats(rng)]


class Sphere(Swept):
    """A ball of radius ``radius``."""

    def __init__(self, radius: float) -> None:
        super().__init__(Point(), radius)
        self.radius = float(radius)


class Capsule(Swept):
    """A segment of ``length`` along z swept by a ball of radius ``radius``."""

    def __init__(self, radius: float, length: float) -> None:
        super().__init__(Segment(length), radius)
        self.radius, self.length = float(radius), float(length)


class Box(Swept):
    """A box of outer full lengths ``x, y, z``, edges and corners rounded by ``rounding``."""

    def __init__(self, x: float, y: float, z: float, rounding: float = 0.0) -> None:
        if not 0 <= 2 * rounding < min(x, y, z):
            raise ValueError(f"rounding {rounding} must be less than half of {min(x, y, z)}")
        core = SharpBox(x - 2 * rounding, y - 2 * rounding, z - 2 * rounding)
        super().__init__(core, rounding)
        self.half: Array = core.half


class RoundedPolytope(Swept, Region):
    """The opening of the hull of ``vertices`` (m, 3) by a ball of radius ``rounding``.

    That is the union of all such balls inside the polytope.
    """

    core: Polytope

    def __init__(self, vertices: ArrayLike, rounding: float) -> None:
        sharp = np.asarray(vertices, dtype=float)
        facets = Facets(sharp)
        size = float(np.linalg.norm(sharp, axis=1).max())
        core = inner_vertices(facets.normals, facets.offsets - rounding, size)
        super().__init__(Polytope(core), rounding)

    def outside(self, points: Array) -> Array:
        """Signed distance to the surface: exact outside the core, where it matters."""
        return np.array([self._outside(point) for point in points])

    def _outside(self, p: Array) -> float:
        facets = self.core.facets
        heights = facets.normals @ p - facets.offsets
        if heights.max() <= 0:
            return float(heights.max()) - self.sweep
        feet = p - heights[:, None] * facets.normals
        slack = FEASIBLE * self.bounding_radius
        on_face = (feet @ facets.normals.T <= facets.offsets + slack).all(axis=1)
        corners = self.core.vertices[facets.edges]
        to_edges = _distances_to_segments(p, corners[:, 0], corners[:, 1])
        to_faces = np.where(on_face & (heights > 0), heights, np.inf)
        return float(min(to_edges.min(), to_faces.min())) - self.sweep


def inner_vertices(normals: Array, offsets: Array, size: float) -> Array:
    """Return the vertices (m, 3) of ``normals @ x <= offsets``, by trying all triples of planes."""
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


def _distances_to_segments(point: Array, starts: Array, ends: Array) -> Array:
    """The distances (m,) of one point from segments."""
    along = ends - starts
    share = ((point - starts) * along).sum(axis=1) / (along * along).sum(axis=1)
    nearest = starts + np.clip(share, 0, 1)[:, None] * along
    return np.asarray(np.linalg.norm(point - nearest, axis=1))
