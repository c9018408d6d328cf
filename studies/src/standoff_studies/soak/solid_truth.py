"""Solids by closed forms: their signed distance, and their boundary as patches that are sampled.

Nothing of the library is used. A cell of a patch is a rectangle of (u, v) in [0, 1]²; every point
of the boundary in it is within its `radius` of its `middle`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np

from standoff_studies.soak.solid_outlines import Array, Outline, Piece

FULL = 2.0 * np.pi


class Patch(Protocol):
    """A part of a boundary, own frame of the solid."""

    def cells(self, u: Array, v: Array, du: Array, dv: Array) -> tuple[Array, Array]:
        """(n, 3) points of the boundary and (n,) radii: all of the boundary in a cell of half
        widths du, dv is within the radius; a radius below 0 where there is none of it."""


class Truth(Protocol):
    """A solid by a closed form."""

    @property
    def patches(self) -> Sequence[Patch]:
        """They cover the boundary."""

    def signed(self, points: Array) -> Array:
        """(n,): distance from the boundary, negative inside."""


class TurnedPatch(NamedTuple):
    """A piece (rho, z) turned about an axis, in a frame: columns of `axes`, the last the axis."""

    piece: Piece
    first: float = 0.0
    last: float = FULL
    axes: Array = np.eye(3)
    origin: Array = np.zeros(3)

    def cells(self, u: Array, v: Array, du: Array, dv: Array) -> tuple[Array, Array]:
        angle = self.first + u * (self.last - self.first)
        rho, z = self.piece.at(v).T
        local = np.column_stack([rho * np.cos(angle), rho * np.sin(angle), z])
        along = self.piece.speed * dv
        # chords: (rho' - rho)² + 2 rho rho' (1 - cos) + (z' - z)²
        across = (np.abs(rho) + along) * du * (self.last - self.first)
        return local @ self.axes.T + self.origin, np.hypot(along, across)


class Wall(NamedTuple):
    """A piece (x, y) swept along z."""

    piece: Piece
    low: float
    high: float

    def cells(self, u: Array, v: Array, du: Array, dv: Array) -> tuple[Array, Array]:
        z = self.low + v * (self.high - self.low)
        points = np.column_stack([self.piece.at(u), z])
        return points, np.hypot(self.piece.speed * du, (self.high - self.low) * dv)


class Level(NamedTuple):
    """What an outline holds, at a height."""

    outline: Outline
    height: float

    def cells(self, u: Array, v: Array, du: Array, dv: Array) -> tuple[Array, Array]:
        low, high = self.outline.box
        spots = low + np.column_stack([u, v]) * (high - low)
        radius = np.hypot(du * (high - low)[0], dv * (high - low)[1])
        nearest = self.outline.nearest(spots)
        away = np.hypot(*(spots - nearest).T)
        outside = ~self.outline.holds(spots)
        at = np.where(outside[:, None], nearest, spots)
        radius = np.where(outside, np.where(away <= radius, radius + away, -1.0), radius)
        return np.column_stack([at, np.full(len(at), self.height)]), radius


class Turned(NamedTuple):
    """A profile (rho, z) turned about the axis z."""

    outline: Outline

    @property
    def patches(self) -> list[Patch]:
        return [TurnedPatch(piece) for piece in self.outline.pieces]

    def signed(self, points: Array) -> Array:
        return self.outline.signed(
            np.column_stack([np.hypot(points[:, 0], points[:, 1]), points[:, 2]])
        )


class Swept(NamedTuple):
    """A figure swept along z."""

    outline: Outline
    low: float
    high: float

    @property
    def patches(self) -> list[Patch]:
        walls: list[Patch] = [Wall(piece, self.low, self.high) for piece in self.outline.pieces]
        return [*walls, Level(self.outline, self.low), Level(self.outline, self.high)]

    def signed(self, points: Array) -> Array:
        flat = self.outline.signed(points[:, :2])
        z = points[:, 2]
        tall = np.maximum(self.low - z, z - self.high)
        out = np.hypot(np.maximum(flat, 0.0), np.maximum(tall, 0.0))
        return np.asarray(out + np.minimum(np.maximum(flat, tall), 0.0))


class Hollowed(NamedTuple):
    """A solid with a cavity."""

    outer: Truth
    cavity: Truth

    @property
    def patches(self) -> list[Patch]:
        return [*self.outer.patches, *self.cavity.patches]

    def signed(self, points: Array) -> Array:
        return np.maximum(self.outer.signed(points), -self.cavity.signed(points))


class Elbow(NamedTuple):
    """A pipe: along y from (major, -leg, 0) to (major, 0, 0), a quarter turn about the axis z, and
    along -x to (-leg, major, 0); radii of its bore and its outside."""

    major: float
    bore: float
    outside: float
    leg: float

    @property
    def legs(self) -> list[tuple[Array, Array]]:
        """(axes, origin) of both; the axis leads from the bend to the open end."""
        x, y, z = np.eye(3)
        return [
            (np.column_stack([z, x, -y]), self.major * x),
            (np.column_stack([z, -y, -x]), self.major * y),
        ]

    @property
    def patches(self) -> list[Patch]:
        from standoff_studies.soak.solid_outlines import Arc, Segment

        found: list[Patch] = []
        centre = np.array([self.major, 0.0])
        for radius in (self.bore, self.outside):
            found.append(TurnedPatch(Arc(centre, radius, -np.pi, np.pi), 0.0, 0.5 * np.pi))
            straight = Segment(np.array([radius, 0.0]), np.array([radius, self.leg]))
            found += [TurnedPatch(straight, 0.0, FULL, *leg) for leg in self.legs]
        rim = Segment(np.array([self.bore, self.leg]), np.array([self.outside, self.leg]))
        return [*found, *(TurnedPatch(rim, 0.0, FULL, *leg) for leg in self.legs)]

    def signed(self, points: Array) -> Array:
        x, y, z = points.T
        off = np.hypot(np.hypot(x, y) - self.major, z)
        sector = (x >= 0.0) & (y >= 0.0)
        least = np.full(len(points), np.inf)
        for radius in (self.bore, self.outside):
            least = np.where(sector, np.minimum(least, np.abs(off - radius)), least)
        inside = sector & (off > self.bore) & (off < self.outside)
        for axes, origin in self.legs:
            local = (points - origin) @ axes
            rho, t = np.hypot(local[:, 0], local[:, 1]), local[:, 2]
            beyond = np.maximum(np.maximum(-t, t - self.leg), 0.0)
            for radius in (self.bore, self.outside):
                least = np.minimum(least, np.hypot(rho - radius, beyond))
            past = np.maximum(np.maximum(self.bore - rho, rho - self.outside), 0.0)
            least = np.minimum(least, np.hypot(past, t - self.leg))
            # closed at the bend, which the sector leaves open on its negative side only
            held = (t >= 0.0) & (t < self.leg) & (rho > self.bore) & (rho < self.outside)
            inside |= held
        return np.where(inside, -least, least)


class Egg(NamedTuple):
    """An ellipsoid about the origin, its axes along those of the frame."""

    semiaxes: Array

    @property
    def patches(self) -> list[Patch]:
        return [_EggPatch(self.semiaxes)]

    def signed(self, points: Array) -> Array:
        """By the root of the sum of (a y / (t + a²))² = 1, bisected and then polished."""
        square = self.semiaxes**2
        held = np.abs(points)
        least = square.min()
        low = np.full(len(points), -least) + self.semiaxes.min() * held[:, self.semiaxes.argmin()]
        high = np.linalg.norm(self.semiaxes * held, axis=1) - least + 1e-30
        for _ in range(80):
            t = 0.5 * (low + high)
            bottom = np.maximum(t[:, None] + square, 1e-300)
            more = ((self.semiaxes * held / bottom) ** 2).sum(axis=1) > 1.0
            low, high = np.where(more, t, low), np.where(more, high, t)
        t = 0.5 * (low + high)
        nearest = square * held / np.maximum(t[:, None] + square, 1e-300)
        length = np.linalg.norm(held - nearest, axis=1)
        return np.asarray(np.where(t < 0.0, -length, length))


class _EggPatch(NamedTuple):
    semiaxes: Array

    def cells(self, u: Array, v: Array, du: Array, dv: Array) -> tuple[Array, Array]:
        angle, height = FULL * u, np.pi * (v - 0.5)
        unit = np.column_stack(
            [np.cos(height) * np.cos(angle), np.cos(height) * np.sin(angle), np.sin(height)]
        )
        along = np.pi * dv
        across = FULL * du * np.minimum(1.0, np.cos(height) + along)
        return self.semiaxes * unit, self.semiaxes.max() * np.hypot(along, across)
