"""Plane figures of segments, arcs and cubics: their signed distance by formulas of the study's own.

They are the sections of the solids of `solid_parts`; nothing of the library is used.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

BLOCK = 4096
"""Points whose distances from a cubic are computed at once: what they take stays in the cache."""

DIGITS = 13
"""Of the ends of pieces, lengths near 1."""


class Piece(Protocol):
    """A curve in the plane, t from 0 to 1."""

    def at(self, t: Array) -> Array:
        """(n, 2) points."""

    def nearest(self, points: Array) -> Array:
        """(n, 2): the point of the piece that is nearest to each one."""

    def beyond_chord(self, points: Array) -> Flags:
        """Which points lie between the piece and its chord."""

    @property
    def speed(self) -> float:
        """No less than the speed anywhere."""


class Segment(NamedTuple):
    """From p to q."""

    p: Array
    q: Array

    @property
    def speed(self) -> float:
        return float(np.hypot(*(self.q - self.p)))

    def at(self, t: Array) -> Array:
        return np.asarray(self.p + t[:, None] * (self.q - self.p))

    def nearest(self, points: Array) -> Array:
        along = self.q - self.p
        t = np.clip((points - self.p) @ along / (along @ along), 0.0, 1.0)
        return self.at(t)

    def beyond_chord(self, points: Array) -> Flags:
        return np.zeros(len(points), dtype=bool)


class Arc(NamedTuple):
    """About a centre, from an angle to another, radians; at most half a turn, or a full one."""

    centre: Array
    radius: float
    first: float
    last: float

    @property
    def full(self) -> bool:
        return abs(self.last - self.first) > 6.28

    @property
    def speed(self) -> float:
        return self.radius * abs(self.last - self.first)

    def at(self, t: Array) -> Array:
        angle = self.first + t * (self.last - self.first)
        return self.centre + self.radius * np.column_stack([np.cos(angle), np.sin(angle)])

    def nearest(self, points: Array) -> Array:
        away = points - self.centre
        length = np.hypot(away[:, 0], away[:, 1])
        unit = np.where(length[:, None] > 0.0, away, [1.0, 0.0])
        unit = unit / np.where(length > 0.0, length, 1.0)[:, None]
        on_it = self.centre + self.radius * unit
        if self.full:
            return on_it
        ends = self.at(np.array([0.0, 1.0]))
        low, high = min(self.first, self.last), max(self.first, self.last)
        angle = np.mod(np.arctan2(unit[:, 1], unit[:, 0]) - low, 2.0 * np.pi)
        second = _lengths(points - ends[1]) < _lengths(points - ends[0])
        end = np.where(second[:, None], ends[1], ends[0])
        return np.where((angle <= high - low)[:, None], on_it, end)

    def beyond_chord(self, points: Array) -> Flags:
        inside = _lengths(points - self.centre) < self.radius
        if self.full:
            return inside
        p, m, q = self.at(np.array([0.0, 0.5, 1.0]))
        across = np.array([p[1] - q[1], q[0] - p[0]])
        return np.asarray(inside & ((points - p) @ across * ((m - p) @ across) > 0.0))


class Cubic(NamedTuple):
    """A Bézier curve of degree three, control points (4, 2), y monotone along it."""

    control: Array

    @property
    def speed(self) -> float:
        return 3.0 * float(_lengths(np.diff(self.control, axis=0)).max())

    def at(self, t: Array) -> Array:
        return _bernstein(self.control, t)

    def nearest(self, points: Array) -> Array:
        blocks = [self._near(points[k : k + BLOCK]) for k in range(0, len(points), BLOCK)]
        return np.vstack(blocks) if blocks else points

    def _near(self, points: Array) -> Array:
        """Newton's method from the best of 33 places, and a comparison with both ends."""
        grid = np.linspace(0.0, 1.0, 33)
        spots = self.at(grid)
        square = (points[:, None, 0] - spots[:, 0]) ** 2 + (points[:, None, 1] - spots[:, 1]) ** 2
        t = grid[np.argmin(square, axis=1)]
        first, second = self.control[1:] - self.control[:-1], np.diff(self.control, 2, axis=0)
        low, high = np.maximum(t - 1 / 32, 0.0), np.minimum(t + 1 / 32, 1.0)
        for _ in range(12):
            away = self.at(t) - points
            speed = 3.0 * _bernstein(first, t)
            slope = (away * speed).sum(axis=1)
            low, high = np.where(slope < 0.0, t, low), np.where(slope > 0.0, t, high)
            bend = (speed * speed).sum(axis=1) + (away * 6.0 * _bernstein(second, t)).sum(axis=1)
            step = t - slope / np.where(bend > 0.0, bend, 1.0)
            middle = 0.5 * (low + high)
            good = (bend > 0.0) & (step >= low) & (step <= high)
            t = np.where(slope == 0.0, t, np.where(good, step, middle))
        found = self.at(t)
        for end in (self.control[0], self.control[-1]):
            nearer = _lengths(points - end) < _lengths(points - found)
            found = np.where(nearer[:, None], end, found)
        return found

    def beyond_chord(self, points: Array) -> Flags:
        """Between the curve and its chord, at the same height."""
        p, q = self.control[0], self.control[-1]
        y = points[:, 1]
        low, high = min(p[1], q[1]), max(p[1], q[1])
        there = (y > low) & (y < high)
        a, b = np.zeros(len(y)), np.ones(len(y))
        for _ in range(54):
            t = 0.5 * (a + b)
            less = (self.at(t)[:, 1] < y) == (q[1] > p[1])
            a, b = np.where(less, t, a), np.where(less, b, t)
        curve = self.at(0.5 * (a + b))[:, 0]
        chord = p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0])
        x = points[:, 0]
        return np.asarray(there & ((x < curve) != (x < chord)))


class Outline(NamedTuple):
    """The boundary of a plane figure.

    Attributes
    ----------
    pieces : sequence of Piece
    closing : sequence of Segment
        What closes them to loops and is no boundary: of a profile, its part of the axis.
    """

    pieces: Sequence[Piece]
    closing: Sequence[Segment] = ()

    def nearest(self, points: Array) -> Array:
        """(n, 2): the nearest point of the boundary."""
        found = self.pieces[0].nearest(points)
        least = _lengths(points - found)
        for piece in self.pieces[1:]:
            other = piece.nearest(points)
            length = _lengths(points - other)
            nearer = length < least
            found = np.where(nearer[:, None], other, found)
            least = np.where(nearer, length, least)
        return found

    def signed(self, points: Array) -> Array:
        """(n,): distance from the boundary, negative inside."""
        length = _lengths(points - self.nearest(points))
        return np.where(self.holds(points), -length, length)

    def holds(self, points: Array) -> Flags:
        """Which points are inside: crossings of a ray with the chords, and what lies between
        these and the pieces."""
        x, y = points.T
        odd = np.zeros(len(points), dtype=bool)
        for piece in (*self.pieces, *self.closing):
            # neighbours end in the same numbers, and a full circle where it begins
            (px, py), (qx, qy) = np.round(piece.at(np.array([0.0, 1.0])), DIGITS)
            if py != qy:
                odd ^= ((py > y) != (qy > y)) & (x < px + (y - py) / (qy - py) * (qx - px))
            odd ^= piece.beyond_chord(points)
        return odd

    @property
    def box(self) -> tuple[Array, Array]:
        """(low, high) of 65 points of each piece."""
        spots = np.vstack([piece.at(np.linspace(0.0, 1.0, 65)) for piece in self.pieces])
        return spots.min(axis=0), spots.max(axis=0)


def polygon(*corners: tuple[float, float]) -> list[Segment]:
    """The segments between corners, the last one to the first."""
    points = np.asarray(corners, dtype=float)
    return [Segment(p, q) for p, q in zip(points, np.roll(points, -1, axis=0), strict=True)]


def _bernstein(control: Array, t: Array) -> Array:
    """De Casteljau's points of (m, 2) control points at t."""
    rows = [np.broadcast_to(c, (len(t), 2)) for c in control]
    while len(rows) > 1:
        rows = [a + t[:, None] * (b - a) for a, b in pairwise(rows)]
    return np.asarray(rows[0])


def _lengths(rows: Array) -> Array:
    return np.hypot(rows[:, 0], rows[:, 1])
