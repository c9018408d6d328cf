"""A body's boundary as its patches, with a count of every vector of theirs that is evaluated."""

from __future__ import annotations

from itertools import combinations_with_replacement, product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies import Body
from standoff.motion import Pose
from standoff.typing import Array

SAME = 1e-7
"""Points of two patches nearer than this are one [length]: they are sewn to far less, and the sides
of the bodies here are longer than 0.1."""

COLLAPSED = 1e-9
"""A tangent shorter than this is that of a side that has collapsed to a point [length]."""

VECTORS = {0: (0, 0, 0), 1: (1, 2, 3), 2: (1, 3, 6)}
"""Vectors of a jet, by the number of parameters, and by its order: the point, the first and the
second derivatives."""


class Spot(NamedTuple):
    """A place on a boundary: a patch, and parameters from 0 to 1 on it."""

    patch: int
    q: Array


class Jet(NamedTuple):
    """A point [length] (3,), its tangents (n, 3) and second derivatives (n, n, 3), in the world."""

    x: Array
    tangents: Array
    bends: Array


class Shell:
    """The patches of a body: faces, or the curves of a planar body, or a single point.

    Attributes
    ----------
    n : int
        Parameters of a patch: 2, 1 or 0.
    vectors : int
        How many vectors have been evaluated.
    rotation, shift : ndarray
        The pose.
    inside : ndarray
        A point inside, in the body's frame.
    """

    def __init__(self, body: Body) -> None:
        self.body = body
        self.patches: list[Any]
        if body.n_faces:
            self.n, self.patches = 2, [part.charts[0] for part in body.face_parts]
        elif body.n_edges:
            self.n, self.patches = 1, [part.curve for part in body.edge_parts]
        else:
            self.n, self.patches = 0, [None]
        self.vectors = 0
        self.move(Pose.identity())
        self.sides = [
            (k, axis, end)
            for k in range(len(self.patches))
            for axis, end in product(range(self.n), (0.0, 1.0))
        ]
        self.ends = {side: self._points_of(side) for side in self.sides}
        self.inside = np.mean(
            [points.mean(axis=0) for points in self.ends.values()] or [np.zeros(3)], axis=0
        )

    def move(self, pose: Pose) -> None:
        """Put the body at a pose."""
        self.rotation, self.shift = pose.rotation, pose.translation

    @property
    def full(self) -> int:
        """Vectors of a jet of second order."""
        return VECTORS[self.n][2]

    def jet(self, spot: Spot, order: int) -> Jet:
        """Evaluate a patch up to an order, and count its vectors."""
        self.vectors += VECTORS[self.n][order]
        return self._placed(self._rows(spot))

    def point(self, spot: Spot) -> Array:
        """Return a place's point in the world, which is not counted."""
        return self._placed(self._rows(spot)).x

    def is_bottom(self, x: Array, way: Array) -> bool:
        """Is a point where the boundary is level along a direction its bottom, and not its top?"""
        return bool((x - self.rotation @ self.inside - self.shift) @ way < 0.0)

    def _rows(self, spot: Spot) -> Array:
        if self.n == 0:
            return np.asarray(self.body.vertex_points)
        return np.array(self.patches[spot.patch].jet(*spot.q.tolist()))

    def _placed(self, rows: Array) -> Jet:
        rows = rows @ self.rotation.T
        n = self.n
        bends = np.zeros((n, n, 3))
        for row, ij in zip(rows[1 + n :], combinations_with_replacement(range(n), 2), strict=True):
            bends[ij] = bends[ij[::-1]] = row
        return Jet(rows[0] + self.shift, rows[1 : 1 + n], bends)

    def _points_of(self, side: tuple[int, int, float]) -> Array:
        """First, middle and last point of a side, in the body's frame, (3, 3)."""
        k, axis, end = side
        points = []
        for t in (0.0, 0.5, 1.0):
            q = np.full(self.n, t)
            q[axis] = end
            points.append(self._rows(Spot(k, q))[0])
        return np.array(points)

    def beyond(self, spot: Spot) -> list[tuple[Spot, Array]]:
        """Return where the boundary continues at a side or a corner: places on other patches or
        sides, and the unit tangent that leads inward there, evaluated to first order."""
        at = [(a, spot.q[a]) for a in range(self.n) if spot.q[a] in (0.0, 1.0)]
        if not at:
            return []
        here = self._rows(spot)[0]
        found = []
        for side in self.sides:
            k, axis, end = side
            if k == spot.patch and (axis, end) in at:
                continue
            for t in self._met(side, spot, here):
                q = np.full(self.n, t)
                q[axis] = end
                tangent = (1.0 - 2.0 * end) * self.jet(Spot(k, q), 1).tangents[axis]
                length = float(np.linalg.norm(tangent))
                if length > COLLAPSED:
                    found.append((Spot(k, q), tangent / length))
        return found

    def _met(self, side: tuple[int, int, float], spot: Spot, here: Array) -> tuple[float, ...]:
        """Parameters along a side at which it passes a point of another side."""
        ends = self.ends[side]
        own = [
            self.ends[spot.patch, a, q] for a, q in enumerate(spot.q.tolist()) if q in (0.0, 1.0)
        ]
        if len(own) == self.n or any(np.ptp(points, axis=0).max() < SAME for points in own):
            off = np.linalg.norm(ends - here, axis=1) < SAME
            if off.all():
                return (0.0, 0.5, 1.0) if self.n == 2 else (0.0,)
            return (0.0,) if off[0] else (1.0,) if off[2] else ()
        if side[0] == spot.patch:
            return ()
        along = float(spot.q[1 - next(a for a in range(2) if spot.q[a] in (0.0, 1.0))])
        for t, points in ((along, own[0]), (1.0 - along, own[0][::-1])):
            if np.abs(points - ends).max() < SAME:
                return (t,)
        return ()


def held(q: Array, slope: Array, tangents: Array) -> NDArray[np.bool_]:
    """Return which parameters may not move down a slope: at a side, or without a tangent."""
    at_side = ((q <= 0.0) & (slope > 0.0)) | ((q >= 1.0) & (slope < 0.0))
    return np.asarray(at_side | (np.linalg.norm(tangents, axis=1) < COLLAPSED))
