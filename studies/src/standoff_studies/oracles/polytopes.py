"""Points, segments, boxes, polytopes and the half-space: shapes with only flat faces."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff_studies.oracles.facets import Facets
from standoff_studies.oracles.flats import Flat, arc_flat, face_flat
from standoff_studies.oracles.shape import Region, Shape, directions, extended, unit

Array = NDArray[Any]

BETWEEN = (0.05, 0.95)
"""Range between the normals of its two faces from which an edge's normal is drawn, as parts of the
angle."""


class Vertices(Shape):
    """Convex hull of ``vertices`` (m, 3): points, segments and polytopes."""

    def __init__(self, vertices: ArrayLike) -> None:
        self.vertices: Array = np.atleast_2d(np.asarray(vertices, dtype=float))
        if self.vertices.ndim != 2 or self.vertices.shape[1] != 3:
            raise ValueError(f"vertices must have shape (m, 3), got {self.vertices.shape}")
        self.bounding_radius = float(np.linalg.norm(self.vertices, axis=1).max())

    def points(self, normals: Array) -> Array:
        chosen = (normals @ self.vertices.T.astype(normals.dtype)).argmax(axis=1)
        return np.asarray(self.vertices[chosen].astype(normals.dtype))

    def maximisers(self, normal: ArrayLike, tolerance: float) -> Array:
        direction = unit(directions(normal))[0]
        values = self.vertices @ direction
        near = values >= values.max() - tolerance * self.bounding_radius
        return np.asarray(self.vertices[near])


class Point(Vertices, Region):
    """The origin."""

    def __init__(self) -> None:
        super().__init__(np.zeros((1, 3)))

    def points(self, normals: Array) -> Array:
        return np.zeros_like(normals)

    def outside(self, points: Array) -> Array:
        return np.asarray(np.linalg.norm(points, axis=1))


class Segment(Vertices, Region):
    """A segment of full ``length`` along z."""

    def __init__(self, length: float) -> None:
        self.length = float(length)
        super().__init__([[0, 0, -length / 2], [0, 0, length / 2]])

    def outside(self, points: Array) -> Array:
        beyond = np.maximum(np.abs(points[:, 2]) - self.length / 2, 0)
        return np.asarray(np.linalg.norm([points[:, 0], points[:, 1], beyond], axis=0))

    def special_normals(self, rng: np.random.Generator) -> Array:
        angle = rng.uniform(0, 2 * np.pi)
        return np.array([[np.cos(angle), np.sin(angle), 0.0]])

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        step = extended(self.vertices[1] - self.vertices[0])
        across = unit(np.cross(step, extended(rng.normal(size=3))))
        around = unit(np.cross(step, across))
        turn = float(rng.uniform(0, 2 * np.pi))
        return [arc_flat(across, around, extended(self.vertices), turn)]


class Polytope(Vertices, Region):
    """Convex hull of ``vertices`` (m, 3), not all in a plane; its faces and edges are Qhull's."""

    @cached_property
    def facets(self) -> Facets:
        """Its faces and edges."""
        return Facets(self.vertices)

    def outside(self, points: Array) -> Array:
        return np.asarray((points @ self.facets.normals.T - self.facets.offsets).max(axis=1))

    def special_normals(self, rng: np.random.Generator) -> Array:
        first, second = self.facets.edge_normals
        weight = rng.uniform(0, 1, (len(first), 1))
        return np.vstack([self.facets.normals, unit(weight * first + (1 - weight) * second)])

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        number = int(rng.integers(len(self.facets.corners)))
        corners = extended(self.vertices[self.facets.corners[number]])
        face = face_flat(self.facets.long_normals[number], corners)
        edge = self._edge(rng, number)
        return [face] if edge is None else [face, edge]

    def _edge(self, rng: np.random.Generator, number: int) -> Flat | None:
        """A random edge of a face, with a normal between those of its two faces."""
        normal, corners = self.facets.long_normals[number], self.facets.corners[number]
        for other in rng.permutation(len(self.facets.corners)):
            shared = np.intersect1d(corners, self.facets.corners[other])
            if len(shared) != 2 or other == number:
                continue
            beyond = self.facets.long_normals[other]
            ends = extended(self.vertices[shared])
            sideways = unit(beyond - (beyond @ normal) * normal)
            angle = float(np.arctan2(beyond @ sideways, beyond @ normal))
            return arc_flat(normal, sideways, ends, float(rng.uniform(*BETWEEN)) * angle)
        return None


class SharpBox(Polytope):
    """A box of full lengths ``x, y, z`` without rounding."""

    def __init__(self, x: float, y: float, z: float) -> None:
        self.half: Array = np.array([x, y, z], dtype=float) / 2
        signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
        super().__init__(signs * self.half)

    def points(self, normals: Array) -> Array:
        return np.where(normals >= 0, self.half, -self.half).astype(normals.dtype)

    def outside(self, points: Array) -> Array:
        return np.asarray((np.abs(points) - self.half).max(axis=1))


class HalfSpace(Region):
    """All points with z <= 0: finite support only along +z."""

    bounding_radius = float("inf")

    def points(self, normals: Array) -> Array:
        along = (normals[:, 0] == 0) & (normals[:, 1] == 0) & (normals[:, 2] > 0)
        point = np.full_like(normals, np.inf)
        point[along] = 0.0
        return point

    def outside(self, points: Array) -> Array:
        return np.asarray(points[:, 2])

    def heights(self, normals: Array) -> Array:
        return np.asarray(self.points(normals)[:, 2])

    def support_many(self, normals: ArrayLike) -> tuple[Array, Array]:
        found = self.points(directions(normals))
        return found[:, 2].copy(), found

    def special_normals(self, rng: np.random.Generator) -> Array:
        del rng
        return np.array([[0.0, 0.0, 1.0]])

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        corners = np.column_stack([rng.normal(size=(3, 2)), np.zeros(3)])
        return [face_flat(extended([0, 0, 1]), extended(corners))]
