"""Rectangles of parameters that cover the faces of a boundary, with bounds: the charts' leaves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.tessellation import TILE, chart_row, surface_of
from standoff.geometry.patch_bounds import PatchBounds
from standoff.geometry.pcurve_boxes import bezier_box, pcurve_box
from standoff.geometry.surfaces import Surface
from standoff.geometry.validation import Array
from standoff.kernels.body import layout as L

if TYPE_CHECKING:
    from standoff.bodies.boundary import Boundary

# Quarterings of a chart's rectangle at most: beside a pole the normals never fit a narrow cone.
MOST_QUARTERINGS = 7


@dataclass(frozen=True, eq=False)
class Leaves:
    """n rectangles, each of one chart.

    Attributes
    ----------
    charts : (n,) packed numbers.
    rectangles : (n, 4) rows (u0, u1, v0, v1); the face may cover a part of one, or nothing.
    bounds : of the surface over each.
    """

    charts: NDArray[np.int64]
    rectangles: Array
    bounds: PatchBounds

    def __len__(self) -> int:
        return len(self.charts)


@dataclass(frozen=True, eq=False)
class FaceChart:
    """A packed chart of a boundary.

    Attributes
    ----------
    number : packed number; face : of it; surface : what it is a chart of.
    outward : +1 where x_u × x_v points outward, else -1.
    rectangle : (4,) what holds the face's part of it.
    """

    number: int
    face: int
    surface: Surface
    outward: float
    rectangle: Array


def face_charts(boundary: Boundary, faces: Sequence[int] | None = None) -> list[FaceChart]:
    """The charts of some faces, of all by default."""
    found = []
    for number in range(int(boundary.ints[L.N_CHARTS])):
        row = chart_row(boundary, number)
        face = int(row[L.CHART_FACE])
        if faces is not None and face not in faces:
            continue
        surface = surface_of(boundary, boundary.face_parts[face].charts, number)
        outward = float(boundary.reals[int(row[L.CHART_REALS]) + L.OUTWARD])
        found.append(FaceChart(number, face, surface, outward, _rectangle(boundary, number)))
    return found


def _rectangle(boundary: Boundary, number: int) -> Array:
    """Round the trimming curves; of an atlas's chart the square in which it is not another's."""
    row = chart_row(boundary, number)
    if np.isfinite(boundary.reals[int(row[L.CHART_REALS]) + L.LIMIT]):
        return np.array([-TILE, TILE, -TILE, TILE])
    first, count = int(row[L.CHART_COEDGE]), int(row[L.CHART_N_COEDGES])
    boxes = np.array([_coedge_box(boundary, k) for k in range(first, first + count)])
    low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
    return np.array([low[0], high[0], low[1], high[1]])


def _coedge_box(boundary: Boundary, number: int) -> tuple[Array, Array]:
    """(low, high), each (2,), round a packed trimming curve."""
    row = int(boundary.ints[L.COEDGES]) + L.COEDGE_STRIDE * number
    at, kind = int(boundary.ints[row + L.COEDGE_REALS]), int(boundary.ints[row + L.COEDGE_KIND])
    first, last = boundary.reals[at : at + L.PCURVE_DATA].tolist()
    at += L.PCURVE_DATA
    if kind == L.BEZIER:
        count = 3 * (int(boundary.reals[at]) + 1)
        points = boundary.reals[at + 1 : at + 1 + count].reshape(-1, 3)
        return bezier_box(points)
    return pcurve_box(kind, boundary.reals[at : at + 9].reshape(3, 3), first, last)


def leaves_of(charts: Sequence[FaceChart], widest: float) -> Leaves:
    """Rectangles whose normals fit cones of half the angle `widest` (radians), where they do."""
    numbers, rectangles, bounds = [], [], []
    for chart in charts:
        rows = chart.rectangle[None]
        for _ in range(MOST_QUARTERINGS):
            found = chart.surface.bounds(rows)
            wide = found.angle > widest
            numbers.append(np.full(int((~wide).sum()), chart.number))
            rectangles.append(rows[~wide])
            bounds.append(found[~wide])
            rows = quartered(rows[wide])
            if not len(rows):
                break
        else:
            numbers.append(np.full(len(rows), chart.number))
            rectangles.append(rows)
            bounds.append(chart.surface.bounds(rows))
    return Leaves(np.concatenate(numbers), np.concatenate(rectangles), PatchBounds.joined(bounds))


def quartered(rectangles: Array) -> Array:
    """(4 n, 4) from (n, 4)."""
    u0, u1, v0, v1 = rectangles.T
    u, v = 0.5 * (u0 + u1), 0.5 * (v0 + v1)
    parts = ((u0, u, v0, v), (u, u1, v0, v), (u0, u, v, v1), (u, u1, v, v1))
    return np.concatenate([np.stack(part, 1) for part in parts])
