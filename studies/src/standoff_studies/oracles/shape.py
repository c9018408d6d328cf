"""The base of all shapes: support values and points, affine images and placements.

For a direction ``n`` the support value is ``s(n) = max n.x`` over the shape; the support point
attains it. Both are homogeneous in ``n``, which need not be of unit length. Directions in
extended precision (``numpy.longdouble``) stay so, and so do the points: exact pairs need it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff_studies.oracles.flats import Flat

Array = NDArray[Any]

TINY = 1e-300
"""Replaces a zero length in a division; no length of a shape is near it."""


def directions(normals: ArrayLike) -> Array:
    """Return ``normals`` as a (k, 3) floating-point array; float64 unless already more precise."""
    array = np.atleast_2d(np.asarray(normals))
    if array.dtype != np.longdouble:
        array = array.astype(np.float64)
    if array.shape[-1] != 3:
        raise ValueError(f"directions must have 3 components, got shape {array.shape}")
    return array


def extended(values: ArrayLike) -> Array:
    """Return an array in extended precision, if the platform has it."""
    return np.asarray(values, dtype=np.longdouble)


def unit(vectors: Array) -> Array:
    """Return the rows of ``vectors`` scaled to unit length; a zero row stays zero."""
    length = lengths(vectors)[..., None]
    return np.asarray(vectors / np.where(length > 0, length, 1))


def dot(first: Array, second: Array) -> Array:
    """Return the row-wise inner products."""
    return np.asarray(np.einsum("...i,...i->...", first, second))


def lengths(vectors: Array) -> Array:
    """Return the lengths of the rows."""
    return np.asarray(np.sqrt(dot(vectors, vectors)))


class Shape(ABC):
    """A closed convex set. ``bounding_radius`` is the greatest |x| (inf for a half-space)."""

    dimension: int = 3
    bounding_radius: float
    sweep: float = 0.0
    """Radius of the ball swept over the shape's core (0 if the shape is its own core)."""

    @abstractmethod
    def points(self, normals: Array) -> Array:
        """Return support points (k, 3) for directions (k, 3)."""

    def heights(self, normals: Array) -> Array:
        """Return support values (k,) for directions (k, 3)."""
        return dot(normals, self.points(normals))

    def support_many(self, normals: ArrayLike) -> tuple[Array, Array]:
        """Return support values (k,) and points (k, 3) for directions (k, 3)."""
        rows = directions(normals)
        found = self.points(rows)
        return dot(rows, found), found

    def support(self, normal: ArrayLike) -> tuple[float, Array]:
        """Return the support value and one support point (3,) for one direction (3,)."""
        values, found = self.support_many(normal)
        return values[0], found[0]

    def maximisers(self, normal: ArrayLike, tolerance: float) -> Array:
        """Return points (m, 3) whose convex hull lies in the support set of ``normal``.

        Flat faces, straight edges and generators give several; a point counts if its support value
        is below the greatest by at most ``tolerance`` times the bounding radius.
        """
        del tolerance
        return self.support(normal)[1][None]

    def special_normals(self, rng: np.random.Generator) -> Array:
        """Return unit normals (m, 3) of flat or straight features; m = 0 if there are none."""
        del rng
        return np.zeros((0, 3))

    def flats(self, rng: np.random.Generator) -> list[Flat]:
        """Return flat faces and straight lines of the boundary, one drawn from each family."""
        del rng
        return []


class Region(Shape):
    """A shape that also computes how far a point is outside it."""

    @abstractmethod
    def outside(self, points: Array) -> Array:
        """Return how far points (k, 3) lie outside, (k,): zero on the boundary, negative inside.

        It is a length, exact to first order near the boundary. It is independent of `points`, so
        that the two check each other.
        """


class Affine(Shape):
    """The image ``x -> A x + t`` of a shape: ``s(n) = s_X(A^T n) + n.t``."""

    def __init__(self, shape: Shape, matrix: ArrayLike, shift: ArrayLike = (0, 0, 0)) -> None:
        self.shape = shape
        self.matrix: Array = np.asarray(matrix, dtype=float)
        self.shift: Array = np.asarray(shift, dtype=float)
        self.dimension = shape.dimension
        stretch = float(np.linalg.norm(self.matrix, 2))
        self.bounding_radius = stretch * shape.bounding_radius + float(np.linalg.norm(self.shift))

    def points(self, normals: Array) -> Array:
        return self.shape.points(normals @ self.matrix) @ self.matrix.T + self.shift

    def maximisers(self, normal: ArrayLike, tolerance: float) -> Array:
        inner = self.shape.maximisers(directions(normal)[0] @ self.matrix, tolerance)
        return inner @ self.matrix.T + self.shift

    def special_normals(self, rng: np.random.Generator) -> Array:
        return unit(self.shape.special_normals(rng) @ np.linalg.inv(self.matrix))


class Placed:
    """A shape at the pose ``(R, p)``: world = R body + p."""

    def __init__(self, shape: Shape, rotation: ArrayLike, position: ArrayLike) -> None:
        self.shape = shape
        self.rotation: Array = np.asarray(rotation, dtype=float)
        self.position: Array = np.asarray(position, dtype=float)

    def relative(self, normals: ArrayLike) -> tuple[Array, Array]:
        """Return support values and points in world axes, measured from ``position``."""
        rows = directions(normals)
        values, found = self.shape.support_many(rows @ self.rotation)
        return values, found @ self.rotation.T

    def support_many(self, normals: ArrayLike) -> tuple[Array, Array]:
        """Return world support values (k,) and points (k, 3)."""
        rows = directions(normals)
        values, found = self.relative(rows)
        return values + rows @ self.position, found + self.position

    def support(self, normal: ArrayLike) -> tuple[float, Array]:
        """Return the world support value and point (3,) for one direction."""
        values, found = self.support_many(normal)
        return values[0], found[0]

    def local(self, points: ArrayLike) -> Array:
        """Return world points in the body frame."""
        return (np.asarray(points, dtype=float) - self.position) @ self.rotation
