"""Pairs of bodies whose separation along every direction has a closed form, as kernels take them.

``s(n) = h_A(n) + h_B(-n)`` by the support functions of balls, ellipsoids, boxes, points, segments
and half-spaces: nothing of the kernels takes part.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pointed import pointed
from scipy.optimize import minimize

import standoff as so
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import feature_jet
from standoff.kernels.body.jets import chart_parameters
from standoff.kernels.values import NO_CHART, Pair, Place, Pose, Side, together

Array = NDArray[np.float64]
Vector = tuple[float, float, float]

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


def vector(x: Sequence[float] | Array) -> Vector:
    """Three floats, as kernels take them."""
    a, b, c = map(float, x)
    return a, b, c


def unit(*x: float) -> Vector:
    return vector(np.array(x) / np.linalg.norm(x))


def turn(axis: Sequence[float], angle: float) -> tuple[float, ...]:
    """The rotation about an axis by an angle (rad), nine numbers by rows."""
    k = np.array(unit(*axis))
    K = np.array([[0.0, -k[2], k[1]], [k[2], 0.0, -k[0]], [-k[1], k[0], 0.0]])
    R = np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K
    return tuple(float(x) for x in R.ravel())


def square_ways(n: Sequence[float] | Array) -> tuple[Vector, Vector]:
    """Two unit vectors square to n and to each other."""
    e = unit(*np.cross(n, X if abs(n[0]) < 0.6 else Y))
    return e, vector(np.cross(n, e))


@dataclass(frozen=True)
class Solid:
    """A body and the support function of its core, in its own frame, of (..., 3) directions; of a
    half-space along its normal alone."""

    body: so.Body
    support: Callable[[Array], Array]


def ellipsoid(*axes: float) -> Solid:
    """A curved face; a ball where the semi-axes are alike."""
    return Solid(so.shapes.ellipsoid(*axes), lambda n: np.linalg.norm(np.array(axes) * n, axis=-1))


def ball(radius: float) -> Solid:
    return ellipsoid(radius, radius, radius)


def box(*halves: float) -> Solid:
    """By its half widths."""
    whole = so.shapes.box(*(2.0 * h for h in halves))
    return Solid(whole, lambda n: np.abs(n) @ np.array(halves))


def point(radius: float = 0.0) -> Solid:
    """A point, or a sphere whose core it is."""
    body = so.shapes.sphere(radius) if radius else so.shapes.point()
    return Solid(body, lambda n: 0.0 * n[..., 0])


def segment(start: Sequence[float], end: Sequence[float]) -> Solid:
    ends = np.array([start, end], dtype=float)
    return Solid(so.shapes.segment(start, end), lambda n: (n @ ends.T).max(axis=-1))


def half_space(normal: Sequence[float], offset: float) -> Solid:
    return Solid(so.shapes.halfspace(normal, offset), lambda n: offset + 0.0 * n[..., 0])


@dataclass(frozen=True)
class Placed:
    """Two solids, B at x -> R x + p in A's frame."""

    a: Solid
    b: Solid
    p: Vector
    R: tuple[float, ...] = IDENTITY

    @property
    def pair(self) -> Pair:
        return pair_of(self.a.body, self.b.body)

    @property
    def pose(self) -> Pose:
        return Pose(self.R, vector(self.p))

    @property
    def both(self) -> tuple[Pair, Pose]:
        return self.pair, self.pose

    @property
    def size(self) -> float:
        """The sum of both diameters."""
        return float(self.a.body.reals[L.SIZE] + self.b.body.reals[L.SIZE])

    def at(self, *p: float) -> Placed:
        """B somewhere else."""
        return Placed(self.a, self.b, vector(p), self.R)

    def depth(self, n: Sequence[float]) -> float:
        """s(n): how far B must be moved along the unit vector n until it just touches A."""
        return float(self.depths(np.array(n)))

    def depths(self, n: Array) -> Array:
        """The same along unit vectors (..., 3)."""
        R = np.array(self.R).reshape(3, 3)
        return self.a.support(n) + self.b.support(-n @ R) - n @ np.array(self.p)

    def least_depth(self) -> float:
        """The least s(n), by 10⁴ directions all round and a search from the best of them."""
        k = np.arange(10_000) + 0.5
        z, angle = 1.0 - 2.0 * k / len(k), np.pi * (1.0 + 5.0**0.5) * k
        rho = np.sqrt(1.0 - z * z)
        ways = np.stack([rho * np.cos(angle), rho * np.sin(angle), z], axis=1)
        best = ways[np.argmin(self.depths(ways))]
        exact = {"xatol": 1e-12, "fatol": 1e-15, "maxiter": 2000}
        e, f = (np.array(way) for way in square_ways(best))

        def near(x: Array) -> float:
            return self.depth(unit(*(best + x[0] * e + x[1] * f)))

        start = np.array([[0.0, 0.0], [0.02, 0.0], [0.0, 0.02]])
        found = minimize(
            near, start[0], method="Nelder-Mead", options={**exact, "initial_simplex": start}
        )
        return float(found.fun)

    def rises_around(self, n: Sequence[float], angle: float = 1e-3) -> bool:
        """Is s(n) less than at every direction of a ring, but for roundoff?"""
        n = np.array(n)
        e, f = (np.array(way) for way in square_ways(n))
        k = np.linspace(0.0, 2.0 * np.pi, 24)[:, None]
        ring = np.cos(angle) * n + np.sin(angle) * (np.cos(k) * e + np.sin(k) * f)
        return bool((self.depths(ring) >= self.depth(n) - 1e-13 * self.size).all())

    def points(self, place: Place) -> tuple[Array, Array]:
        """The witness points of a place, in A's frame."""
        of_a = point_at(self.a.body, Side(place.feature_a, place.chart_a, place.u, place.v))
        of_b = point_at(self.b.body, Side(place.feature_b, place.chart_b, place.r, place.s))
        return of_a, np.array(self.R).reshape(3, 3) @ of_b + self.p

    def gap(self, place: Place) -> Array:
        """From A's witness point to B's."""
        x_a, x_b = self.points(place)
        return x_b - x_a

    def place(self, x_a: Sequence[float], x_b: Sequence[float]) -> Place:
        """The place of two points, each in its own body's frame."""
        return together(side_at(self.a.body, x_a), side_at(self.b.body, x_b))

    def over_plane(self, x_b: Sequence[float]) -> Place:
        """The place of B's point, in its frame, and of the point of the half-space A below it."""
        R = np.array(self.R).reshape(3, 3)
        x, along_u, along_v = feature_jet(*packed(self.a.body), 0, 0, 0.0, 0.0)[:3]
        away = R @ np.array(x_b) + self.p - np.array(x)
        side = Side(np.int64(0), np.int64(0), float(away @ along_u), float(away @ along_v))
        return together(side, side_at(self.b.body, x_b))


def point_at(body: so.Body, side: Side) -> Array:
    """In the body's frame."""
    return np.array(feature_jet(*packed(body), *side)[0])


def side_at(body: so.Body, x: Sequence[float]) -> Side:
    """A point of an ellipsoid, of a box's face (well inside) or of a vertex, by its coordinates."""
    x = vector(x)
    for k, corner in enumerate(body.vertex_points):
        if tuple(corner) == x:
            return Side(np.int64(body.n_faces + body.n_edges + k), NO_CHART, 0.0, 0.0)
    if body.n_faces == 1:
        return on_atlas(body, x)
    for face in range(body.n_faces):
        origin, along_u, along_v = (
            np.array(y) for y in feature_jet(*packed(body), face, face, 0.0, 0.0)[:3]
        )
        u, v = np.linalg.lstsq(np.array([along_u, along_v]).T, np.subtract(x, origin), rcond=None)[
            0
        ]
        side = Side(np.int64(face), np.int64(face), float(u), float(v))
        if np.linalg.norm(point_at(body, side) - x) < 1e-12:
            return side
    raise LookupError(x)


def packed(body: so.Body) -> tuple[Array, Array]:
    return pointed(body.ints), pointed(body.reals)


def pair_of(a: so.Body, b: so.Body) -> Pair:
    return Pair(*packed(a), *packed(b))


def on_atlas(body: so.Body, x: Vector) -> Side:
    """In the most central of the charts of the only face."""
    best, side = np.inf, None
    for chart in range(body.ints[L.N_CHARTS]):
        o = body.ints[L.chart_record(body.ints, chart) + L.CHART_REALS]
        u, v, depth = chart_parameters(packed(body)[1], o, x)
        if depth > 0.0 and max(abs(u), abs(v)) < best:
            best, side = max(abs(u), abs(v)), Side(np.int64(0), np.int64(chart), u, v)
    if side is None:
        raise LookupError(x)
    assert np.linalg.norm(point_at(body, side) - x) < 1e-12
    return side


def edge_side(feature: int, t: float) -> Side:
    """A parameter of an edge, by its feature's number."""
    return Side(np.int64(feature), NO_CHART, t, 0.0)


def wedge(apex: float) -> tuple[so.Body, int]:
    """A body with an edge along y through its origin, its sides `apex` (degrees) apart, the upper
    one 5 degrees below z = 0; and the edge's number. 0 degrees: the edge alone, from -1 to 1."""
    if not apex:
        return so.shapes.segment((0.0, -1.0, 0.0), (0.0, 1.0, 0.0)), 0
    corners = [
        (length * np.cos(way), y, length * np.sin(way))
        for y in (-1.0, 1.0)
        for length, way in ((0.0, 0.0), (1.0, np.radians(-5.0)), (1.0, np.radians(-5.0 - apex)))
    ]
    body = so.shapes.polytope(corners)
    for k, edge in enumerate(body.edge_parts):
        ends = body.vertex_points[[edge.first, edge.last]]
        if not ends[:, [0, 2]].any():
            return body, body.n_faces + k
    raise LookupError(apex)


def across(height: float, spin: float) -> Pose:
    """The pose of a wedge that stands upside down above another, across its edge; a spin of pi lets
    its edge run the other way."""
    upside_down = np.array(turn(Y, np.pi)).reshape(3, 3)
    R = np.array(turn(Z, 0.5 * np.pi + spin)).reshape(3, 3) @ upside_down
    return Pose(tuple(R.ravel().tolist()), (0.0, 0.0, height))
