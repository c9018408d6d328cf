"""Solids by closed forms: their signed distance, and their boundary as patches that are sampled.

Nothing of the library is used. A cell of a patch is a rectangle of (u, v) in [0, 1]²; every point
of the boundary in it is within its radius of its point. The formulas are those of `solid_forms` and
`solid_cells`.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from standoff_studies.soak import solid_cells, solid_forms
from standoff_studies.soak.solid_forms import Form
from standoff_studies.soak.solid_outlines import Arc, Array, Outline, Piece, Segment, row_of

FULL = 2.0 * np.pi


class Truth(Protocol):
    """A solid by a closed form."""

    @property
    def form(self) -> Form:
        """For the compiled functions."""

    @property
    def patches(self) -> Array:
        """(p, PATCH): they cover the boundary."""


def signed(truth: Truth, points: Array) -> Array:
    """(n,): distances of points (n, 3) from the boundary, negative inside."""
    spots = np.ascontiguousarray(points, dtype=float)
    return np.asarray(solid_forms.signed_of(truth.form, spots))


def turned_patch(
    piece: Piece,
    first: float = 0.0,
    last: float = FULL,
    axes: Array | None = None,
    origin: Array | None = None,
) -> Array:
    """A piece (rho, z) turned about an axis, in a frame: columns of `axes`, the last the axis."""
    return solid_cells.patch_row(
        solid_cells.TURNED_PATCH,
        first,
        last,
        speed=piece.speed,
        axes=np.eye(3) if axes is None else axes,
        origin=np.zeros(3) if origin is None else origin,
        curve=row_of(piece),
    )


def swept_patches(outline: Outline, low: float, high: float, which: int) -> list[Array]:
    """Walls along z of an outline's pieces, and what it holds at both ends."""
    wall, level = solid_cells.WALL, solid_cells.LEVEL
    rows = [
        solid_cells.patch_row(wall, low, high, speed=piece.speed, curve=row_of(piece))
        for piece in outline.pieces
    ]
    box = np.concatenate(outline.box)
    return [*rows, *(solid_cells.patch_row(level, z, z, which=which, box=box) for z in (low, high))]


def form_of(
    kind: int, *numbers: float, rows: Array | None = None, cavity: Array | None = None
) -> Form:
    """A form with what it has."""
    held = np.zeros(8)
    held[: len(numbers)] = numbers
    none = solid_forms.no_rows()
    return Form(kind, held, none if rows is None else rows, none if cavity is None else cavity)


class Turned(NamedTuple):
    """A profile (rho, z) turned about the axis z."""

    outline: Outline

    @property
    def form(self) -> Form:
        return form_of(solid_forms.TURNED, rows=self.outline.rows)

    @property
    def patches(self) -> Array:
        return np.array([turned_patch(piece) for piece in self.outline.pieces])


class Swept(NamedTuple):
    """A figure swept along z."""

    outline: Outline
    low: float
    high: float

    @property
    def form(self) -> Form:
        return form_of(solid_forms.SWEPT, self.low, self.high, rows=self.outline.rows)

    @property
    def patches(self) -> Array:
        return np.array(swept_patches(self.outline, self.low, self.high, 0))


class Hollowed(NamedTuple):
    """A swept solid with a swept cavity."""

    outer: Swept
    cavity: Swept

    @property
    def form(self) -> Form:
        (one, *ends), (two, *more) = self.outer, self.cavity
        return form_of(solid_forms.HOLLOWED, *ends, *more, rows=one.rows, cavity=two.rows)

    @property
    def patches(self) -> Array:
        return np.array([*swept_patches(*self.outer, 0), *swept_patches(*self.cavity, 1)])


class Elbow(NamedTuple):
    """A pipe: along y from (major, -leg, 0) to (major, 0, 0), a quarter turn about the axis z, and
    along -x to (-leg, major, 0); radii of its bore and its outside."""

    major: float
    bore: float
    outside: float
    leg: float

    @property
    def form(self) -> Form:
        return form_of(solid_forms.ELBOW, *self)

    @property
    def legs(self) -> list[tuple[Array, Array]]:
        """(axes, origin) of both; the axis leads from the bend to the open end."""
        x, y, z = np.eye(3)
        return [
            (np.column_stack([z, x, -y]), self.major * x),
            (np.column_stack([z, -y, -x]), self.major * y),
        ]

    @property
    def patches(self) -> Array:
        found = []
        centre = np.array([self.major, 0.0])
        for radius in (self.bore, self.outside):
            found.append(turned_patch(Arc(centre, radius, -np.pi, np.pi), 0.0, 0.5 * np.pi))
            straight = Segment(np.array([radius, 0.0]), np.array([radius, self.leg]))
            found += [turned_patch(straight, 0.0, FULL, *leg) for leg in self.legs]
        rim = Segment(np.array([self.bore, self.leg]), np.array([self.outside, self.leg]))
        return np.array([*found, *(turned_patch(rim, 0.0, FULL, *leg) for leg in self.legs)])


class Egg(NamedTuple):
    """An ellipsoid about the origin, its axes along those of the frame."""

    semiaxes: Array

    @property
    def form(self) -> Form:
        return form_of(solid_forms.EGG, *self.semiaxes)

    @property
    def patches(self) -> Array:
        return np.array([solid_cells.patch_row(solid_cells.EGG_PATCH, 0.0, 0.0)])
