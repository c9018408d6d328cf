"""Plane figures of segments, arcs and cubics: their signed distance by formulas of the study's own.

They are the sections of the solids of `solid_parts`; the formulas are those of `solid_forms`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from standoff_studies.soak import solid_forms

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

DIGITS = 13
"""Of the ends of pieces, lengths near 1."""


class Piece(Protocol):
    """A curve in the plane, t from 0 to 1."""

    def at(self, t: Array) -> Array:
        """(n, 2) points."""

    @property
    def numbers(self) -> tuple[float, ...]:
        """Its form and what it is made of, as in `solid_forms`."""

    @property
    def speed(self) -> float:
        """No less than the speed anywhere."""


class Segment(NamedTuple):
    """From p to q."""

    p: Array
    q: Array

    @property
    def numbers(self) -> tuple[float, ...]:
        return (solid_forms.SEGMENT, *self.p, *self.q)

    @property
    def speed(self) -> float:
        return float(np.hypot(*(self.q - self.p)))

    def at(self, t: Array) -> Array:
        return points_of(self, t)


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
    def numbers(self) -> tuple[float, ...]:
        return (solid_forms.ARC, *self.centre, self.radius, self.first, self.last)

    @property
    def speed(self) -> float:
        return self.radius * abs(self.last - self.first)

    def at(self, t: Array) -> Array:
        return points_of(self, t)


class Cubic(NamedTuple):
    """A Bézier curve of degree three, control points (4, 2), y monotone along it."""

    control: Array

    @property
    def numbers(self) -> tuple[float, ...]:
        return (solid_forms.CUBIC, *self.control.ravel())

    @property
    def speed(self) -> float:
        return 3.0 * float(np.linalg.norm(np.diff(self.control, axis=0), axis=1).max())

    def at(self, t: Array) -> Array:
        return points_of(self, t)


def row_of(piece: Piece, *, closing: bool = False) -> Array:
    """A piece as a row of `solid_forms`."""
    row = np.zeros(solid_forms.ROW)
    form, *numbers = piece.numbers
    row[:2] = form, closing
    row[2 : 2 + len(numbers)] = numbers
    # neighbours end in the same numbers, and a full circle where it begins
    row[10:] = np.round(_spots(row, np.array([0.0, 1.0])), DIGITS).ravel()
    return row


def points_of(piece: Piece, t: Array) -> Array:
    """(n, 2) points of a piece."""
    return _spots(row_of(piece), np.asarray(t, dtype=float))


def _spots(row: Array, t: Array) -> Array:
    return np.array([solid_forms.place(row, float(each)) for each in t]).reshape(-1, 2)


class Outline:
    """The boundary of a plane figure.

    Parameters
    ----------
    pieces : sequence of Piece
    closing : sequence of Segment, optional
        What closes them to loops and is no boundary: of a profile, its part of the axis.

    Attributes
    ----------
    pieces, closing
    rows : (n, ROW) array
        They as `solid_forms` reads them.
    """

    def __init__(self, pieces: Sequence[Piece], closing: Sequence[Segment] = ()) -> None:
        self.pieces, self.closing = pieces, closing
        rows = [row_of(piece) for piece in pieces]
        self.rows: Array = np.array(rows + [row_of(each, closing=True) for each in closing])

    def signed(self, points: Array) -> Array:
        """(n,): distance from the boundary, negative inside."""
        return np.asarray(solid_forms.flat_signed_of(self.rows, np.ascontiguousarray(points)))

    @property
    def box(self) -> tuple[Array, Array]:
        """(low, high) of 65 points of each piece."""
        spots = np.vstack([piece.at(np.linspace(0.0, 1.0, 65)) for piece in self.pieces])
        return spots.min(axis=0), spots.max(axis=0)


def polygon(*corners: tuple[float, float]) -> list[Segment]:
    """The segments between corners, the last one to the first."""
    points = np.asarray(corners, dtype=float)
    return [Segment(p, q) for p, q in zip(points, np.roll(points, -1, axis=0), strict=True)]
