"""Cells over parts of the unit sphere: ellipsoidal faces by directions, normals at a vertex.

A part of the sphere is given by its boundary. Every piece of it gives a rectangle: the piece's own
parameter, and the great arc to it from a fixed direction, the start; their areas have signs. The
point opposite to the start must not be on the boundary. If it lies inside the part, the whole
sphere must be added: the signed areas are too small by 4 pi.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from standoff.bodies.moments.cells import Integrand, MomentCell
from standoff.bodies.moments.flux import IntegralFrame, flux, offset_areas
from standoff.geometry.curves import Curve
from standoff.geometry.quadrics import sphere_atlas
from standoff.geometry.surfaces import Surface
from standoff.typing import Array

OverSphere = Callable[[Array], Array]
"""Unit vectors (..., 3) to values (..., columns)."""
BoundaryPiece = Callable[[Array], tuple[Array, Array]]
"""Parameters (n,) to points of the unit sphere (n, 3) and their derivatives (n, 3)."""

# Samples of a piece of a boundary.
SAMPLES = 33
# Directions among which the one farthest from a boundary is chosen.
_EVENLY_AROUND = np.array([d for d in product((-1.0, 0.0, 1.0), repeat=3) if any(d)])
EVENLY_AROUND = _EVENLY_AROUND / np.linalg.norm(_EVENLY_AROUND, axis=1)[:, None]


@dataclass(frozen=True, eq=False)
class BoundaryArc:
    """A piece of a boundary, parameter from first to last; sign -1 if the part is on its right,
    seen from outside the sphere."""

    piece: BoundaryPiece
    first: float
    last: float
    sign: int


def sphere_cells(values: OverSphere) -> list[MomentCell]:
    """The whole sphere: six gnomonic squares, by angles from their middles."""
    quarter = 0.25 * np.pi
    return [
        MomentCell(_square(chart, values), (-quarter, -quarter), (quarter, quarter))
        for chart in _CHARTS
    ]


_CHARTS = sphere_atlas(np.eye(3), np.zeros(3))


def _square(chart: Surface, values: OverSphere) -> Integrand:
    def integrand(_: Sequence[None], t: Array, s: Array) -> Array:
        u, v = np.broadcast_arrays(np.tan(t)[:, :, None], np.tan(s)[:, None, :])
        y = chart.points(np.column_stack([u.ravel(), v.ravel()])).reshape(*u.shape, 3)
        areas = (1.0 + u * u) * (1.0 + v * v) * (1.0 + u * u + v * v) ** -1.5
        return np.asarray(areas[..., None] * values(y))

    return integrand


def part_cells(arcs: Sequence[BoundaryArc], start: Array, values: OverSphere) -> list[MomentCell]:
    """The part inside arcs; minus the whole sphere if it contains the point opposite the start."""
    return [
        MomentCell(_sector(arc, start, values), (arc.first, 0.0), (arc.last, 1.0)) for arc in arcs
    ]


def _sector(arc: BoundaryArc, start: Array, values: OverSphere) -> Integrand:
    """Over a signed triangle between the start and an arc, parametrised along and towards it."""

    def integrand(_: Sequence[None], t: Array, s: Array) -> Array:
        y, dy = arc.piece(t.ravel())
        across = np.cross(start, y)
        sine = np.linalg.norm(across, axis=1)
        angle = np.arctan2(sine, y @ start)[:, None]
        safe = np.where(sine > 0.0, sine, 1.0)[:, None]
        aside = (y - np.cos(angle) * start) / safe
        turn = arc.sign * (across * dy).sum(axis=1)[:, None] / safe**2
        ways = angle * np.repeat(s, t.shape[1], axis=0)
        spots = np.cos(ways)[..., None] * start + np.sin(ways)[..., None] * aside[:, None]
        found = (turn * angle * np.sin(ways))[..., None] * values(spots)
        return np.asarray(found.reshape(*t.shape, s.shape[1], -1))

    return integrand


def farthest_start(arcs: Sequence[BoundaryArc]) -> Array:
    """A start whose opposite point is far from the boundary."""
    times = [np.linspace(arc.first, arc.last, SAMPLES) for arc in arcs]
    spots = np.concatenate([arc.piece(t)[0] for arc, t in zip(arcs, times, strict=True)])
    mean = spots.mean(axis=0)
    length = float(np.linalg.norm(mean))
    starts = np.vstack([EVENLY_AROUND, mean[None] / length]) if length > 0.0 else EVENLY_AROUND
    nearest = (-starts @ spots.T).max(axis=1)
    return np.asarray(starts[int(nearest.argmin())])


@dataclass(frozen=True, eq=False)
class DirectedEllipsoid:
    """An ellipsoidal surface, linear @ (unit sphere) + shift, and the frame of integration."""

    linear: Array
    shift: Array
    frame: IntegralFrame

    def flux(self, y: Array) -> Array:
        """The integrand of `flux` times the solid angle, at directions (..., 3)."""
        inverse, det = np.linalg.inv(self.linear), float(np.linalg.det(self.linear))
        helper = np.eye(3)[np.abs(y).argmin(axis=-1)]
        one = np.cross(y, helper)
        one = one / np.linalg.norm(one, axis=-1, keepdims=True)
        other = np.cross(y, one)
        x = y @ self.linear.T + self.shift
        normals = y @ inverse
        areas = abs(det) * normals
        if self.frame.radius > 0.0:
            tangents = (one @ self.linear.T, other @ self.linear.T)
            slopes = (one @ inverse, other @ inverse)
            n, moved = offset_areas(tangents, normals, slopes, self.frame.radius)
            x, areas = x + self.frame.radius * n, np.sign(det) * moved
        return flux(self.frame, x, areas)

    def boundary(self, curve: Curve) -> BoundaryPiece:
        """An edge's directions."""
        inverse = np.linalg.inv(self.linear)

        def piece(t: Array) -> tuple[Array, Array]:
            jets = [curve.jet(float(x))[:2] for x in t]
            y = (np.array([x for x, _ in jets]) - self.shift) @ inverse.T
            dy = np.array([xt for _, xt in jets]) @ inverse.T
            length = np.linalg.norm(y, axis=1)[:, None]
            y = y / length
            return y, (dy - (dy * y).sum(axis=1)[:, None] * y) / length

        return piece

    @property
    def sense(self) -> int:
        """-1 if the map mirrors: left on the ellipsoid is then right on the sphere."""
        return 1 if np.linalg.det(self.linear) > 0.0 else -1
