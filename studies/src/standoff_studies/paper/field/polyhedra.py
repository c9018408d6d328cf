"""Lin and Canny's walk over the features of two polyhedra, as V-Clip does it, on tessellations."""

from __future__ import annotations

from collections import defaultdict
from copy import copy
from functools import cache
from itertools import combinations

import numpy as np
from scipy.spatial import ConvexHull

from standoff.motion import Pose
from standoff.typing import Array
from standoff_studies.paper.bodies import lens_of_patches
from standoff_studies.paper.field.shells import Shell, Spot
from standoff_studies.paper.field.support import Lost, nearest

Feature = tuple[int, ...]
"""A vertex, an edge or a triangle, by its vertices in order."""

OUTWARD = 1e-10
"""Cosine by which a neighbouring feature must lead nearer: roundoff of points 1e-3 apart."""

EXACT = 1e-13
"""Part of the squared distance to which two features' closest points are found: roundoff."""

MERGED = 12
"""Decimals to which points of two patches are one corner [length]: roundoff of their sides."""

MOST_FEATURES = 500
"""Features after which a walk gives up."""


class Polyhedron:
    """The hull of a body's points on a grid of each patch, with the neighbours of its features.

    Attributes
    ----------
    corners : ndarray, shape (n, 3)
        In the world.
    read : set of int
        The corners that have been read in a frame, each put into the world once.
    planes_read : int
    """

    def __init__(self, shell: Shell, cells: int) -> None:
        self.shell, self.cells, self.flat = shell, cells, shell.n == 1
        self.grid = _grid(shell, np.linspace(0.0, 1.0, cells + 1))
        _, self.kept = np.unique(np.round(self.grid, MERGED), axis=0, return_index=True)
        self.planes = np.zeros((0, 4))
        self.top: list[Feature] = []
        if len(self.kept) > 1:
            self._hull()
        self.home = self.grid[self.kept]
        self.number = {one: k for k, one in enumerate(self.top)}
        self.above: dict[Feature, set[Feature]] = defaultdict(set)
        for one in self.top:
            for size in range(1, len(one)):
                for part in combinations(one, size):
                    for more in set(one) - set(part):
                        self.above[part].add(tuple(sorted((*part, more))))
        self.move(Pose.identity())

    def _hull(self) -> None:
        columns = 2 if self.flat else 3
        hull = ConvexHull(self.grid[self.kept][:, :columns])
        normals = np.zeros((len(hull.simplices), 3))
        normals[:, :columns] = hull.equations[:, :-1]
        self.planes = np.column_stack([normals, hull.equations[:, -1]])
        # points inside flat faces are no corners
        place = np.empty(len(self.kept), dtype=int)
        place[hull.vertices] = np.arange(len(hull.vertices))
        self.kept = self.kept[hull.vertices]
        self.top = [tuple(sorted(one)) for one in place[hull.simplices].tolist()]

    def stretched(self, shell: Shell) -> Polyhedron | None:
        """The polyhedron of an affine image of the body, whose features are the same; None if the
        other body is none."""
        grid = _grid(shell, np.linspace(0.0, 1.0, self.cells + 1))
        if grid.shape != self.grid.shape:
            return None
        ones = np.ones((len(grid), 1))
        image, *_ = np.linalg.lstsq(np.hstack([self.grid, ones]), grid, rcond=None)
        if np.abs(np.hstack([self.grid, ones]) @ image - grid).max() > 10.0**-MERGED:
            return None
        other = copy(self)
        other.shell, other.grid, other.home = shell, grid, grid[self.kept]
        normals = np.linalg.solve(image[:3], self.planes[:, :3].T).T
        offsets = self.planes[:, 3] - normals @ image[3]
        lengths = np.linalg.norm(normals, axis=1)
        other.planes = np.column_stack([normals, offsets]) / lengths[:, None]
        other.move(Pose.identity())
        return other

    def sag(self) -> float:
        """Return how far the body's boundary is outside at the middles of the cells [length]."""
        middle = _grid(self.shell, (np.arange(self.cells) + 0.5) / self.cells)
        return float((middle @ self.planes[:, :3].T + self.planes[:, 3]).max(axis=1).max())

    def move(self, pose: Pose) -> None:
        """Put it at a pose, at the beginning of a frame."""
        self.rotation, self.shift = pose.rotation, pose.translation
        self.read: set[int] = set()
        self.planes_read = 0

    @property
    def vectors(self) -> int:
        """How many corners and planes have been read in a frame."""
        return len(self.read) + self.planes_read

    def at(self, feature: Feature) -> Array:
        """Read a feature's corners, in the world."""
        self.read.update(feature)
        return np.asarray(self.home[list(feature)] @ self.rotation.T + self.shift)

    def nearer(self, feature: Feature, x: Array, y: Array) -> Feature | None:
        """The larger feature at x that leads most towards y, if any does; or, where y is behind a
        side of the polyhedron, the side of which it is farthest in front."""
        best, found = OUTWARD * float(np.linalg.norm(y - x)), None
        here = self.at(feature)
        for larger in self.above.get(feature, ()):
            (corner,) = set(larger) - set(feature)
            way = self.at((corner,))[0] - here[0]
            if len(feature) == 2:
                edge = here[1] - here[0]
                way = way - edge * (way @ edge) / (edge @ edge)
            gain = float(way @ (y - x) / np.linalg.norm(way))
            if gain > best:
                best, found = gain, larger
        if found is not None or feature not in self.number:
            return found
        local = (y - self.shift) @ self.rotation
        number = self.number[feature]
        self.planes_read += 1
        if self.planes[number, :3] @ local + self.planes[number, 3] >= 0.0:
            return None
        self.planes_read += len(self.planes)
        front = int(np.argmax(self.planes[:, :3] @ local + self.planes[:, 3]))
        return None if front == number else self.top[front]

    def feature_near(self, x: Array) -> Feature:
        """The corner nearest to a point of the world, to start from."""
        local = (x - self.shift) @ self.rotation
        return (int(np.argmin(np.linalg.norm(self.home - local, axis=1))),)


def walk(
    bodies: tuple[Polyhedron, Polyhedron], features: tuple[Feature, Feature]
) -> tuple[tuple[Feature, Feature], Array]:
    """Walk from a pair of features to the closest one: the pair, and its witness points (2, 3)."""
    pair = list(features)
    for _ in range(MOST_FEATURES):
        corners = [body.at(one) for body, one in zip(bodies, pair, strict=True)]
        points, pair = _closest(corners, pair)
        for k, body in enumerate(bodies):
            larger = body.nearer(pair[k], points[k], points[1 - k])
            if larger is not None:
                pair[k] = larger
                break
        else:
            return (pair[0], pair[1]), points
    raise Lost("the walk over features did not end")


def _closest(corners: list[Array], pair: list[Feature]) -> tuple[Array, list[Feature]]:
    """The closest points of two features, and the least features that they lie in."""
    a, b = corners

    def support(way: Array) -> tuple[Array, tuple[int, int]]:
        i, j = int(np.argmax(a @ way)), int(np.argmin(b @ way))
        return a[i] - b[j], (i, j)

    got = nearest(support, (a[0] - b[0], (0, 0)), EXACT)
    weights = np.zeros(len(a)), np.zeros(len(b))
    for weight, which in zip(got.weights, got.corners, strict=True):
        for own, k in zip(weights, which, strict=True):
            own[k] += weight
    points = np.array([own @ each for own, each in zip(weights, corners, strict=True)])
    least = [
        tuple(v for v, w in zip(one, own, strict=True) if w > 0.0)
        for one, own in zip(pair, weights, strict=True)
    ]
    return points, least


def _grid(shell: Shell, at: Array) -> Array:
    """Points of all patches at a grid of parameters, in the body's frame."""
    if shell.n == 0:
        return np.asarray(shell.body.vertex_points, dtype=float)
    axes = np.meshgrid(*[at] * shell.n, indexing="ij")
    rows = np.stack([axis.ravel() for axis in axes], axis=1)
    rows = rows[:, 0] if shell.n == 1 else rows
    return np.concatenate([patch.points(rows) for patch in shell.patches])


@cache
def _lens(cells: int) -> Polyhedron:
    """The polyhedron of the lens of patches, of which most bodies here are stretched images."""
    return Polyhedron(Shell(lens_of_patches()), cells)


def tessellated(shells: tuple[Shell, Shell], cells: int) -> tuple[Polyhedron, Polyhedron]:
    """Return the polyhedra of two bodies, with so many cells along a side of a patch."""
    a, b = (_lens(cells).stretched(shell) or Polyhedron(shell, cells) for shell in shells)
    return a, b


def begun(
    bodies: tuple[Polyhedron, Polyhedron], shells: tuple[Shell, Shell], spots: tuple[Spot, Spot]
) -> tuple[Feature, Feature]:
    """Return the corners nearest to two places."""
    a, b = (
        body.feature_near(shell.jet(spot, 0).x)
        for body, shell, spot in zip(bodies, shells, spots, strict=True)
    )
    return a, b
