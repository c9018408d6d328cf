"""Leaves: rectangles of parameters that cover the faces of a boundary, with bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.packed_parts import PackedParts
from standoff.bodies.tessellation import TILE, chart_row, coedge_range, packed_pcurve, surface_of
from standoff.bodies.tolerances import BOX_REACH
from standoff.geometry.pcurve_boxes import equal_boxes
from standoff.geometry.surfaces import Surface
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import on_face
from standoff.typing import Array

# Parts of a trimming curve, each with its own box.
PARTS = 16
# How often a chart's rectangle is quartered to find a box.
BOX_QUARTERINGS = 8
# How often it is quartered for leaves: next to a pole the normals never fit a narrow cone.
MOST_QUARTERINGS = 7


class FaceRectangles(NamedTuple):
    """Rectangles (n, 4), rows (u0, u1, v0, v1), of which the face may cover only part, or nothing,
    and cones of the normals x_u × x_v over each, axes (n, 3) and half angles (n,)."""

    rectangles: Array
    axes: Array
    angles: Array


@dataclass(frozen=True, eq=False)
class FaceChart:
    """A packed chart of a boundary.

    Attributes
    ----------
    number : packed number; face : its face; surface : what it is a chart of.
    outward : +1 where x_u × x_v points outward, else -1.
    rectangle : (4,) contains the chart's part of the face.
    borders : (low, high), each (m, 2), of boxes around parts of its trimming curves.
    """

    number: int
    face: int
    surface: Surface
    outward: float
    rectangle: Array
    borders: tuple[Array, Array]


def face_charts(boundary: PackedParts, faces: Sequence[int] | None = None) -> list[FaceChart]:
    """The charts of the given faces, by default of all."""
    found = []
    for number in range(int(boundary.ints[L.N_CHARTS])):
        row = chart_row(boundary, number)
        face = int(row[L.CHART_FACE])
        if faces is not None and face not in faces:
            continue
        surface = surface_of(boundary, boundary.face_parts[face].charts, number)
        outward = float(boundary.reals[int(row[L.CHART_REALS]) + L.OUTWARD])
        borders = _borders(boundary, number)
        rectangle = _rectangle(boundary, number, borders)
        found.append(FaceChart(number, face, surface, outward, rectangle, borders))
    return found


def _rectangle(boundary: PackedParts, number: int, borders: tuple[Array, Array]) -> Array:
    """Around the trimming curves; for a chart of an atlas, its own square of the tiling."""
    row = chart_row(boundary, number)
    if np.isfinite(boundary.reals[int(row[L.CHART_REALS]) + L.LIMIT]):
        return np.array([-TILE, TILE, -TILE, TILE])
    low, high = borders
    return np.array([low[:, 0].min(), high[:, 0].max(), low[:, 1].min(), high[:, 1].max()])


def _may_be_on(boundary: PackedParts, chart: FaceChart, rows: Array) -> NDArray[np.bool_]:
    """(n,) which rectangles may contain a point of the face: a trimming curve may cross them, or
    their middle is on it."""
    low, high = chart.borders
    packed = boundary.ints, boundary.reals, chart.number
    kept = np.zeros(len(rows), dtype=bool)
    for k, (u0, u1, v0, v1) in enumerate(rows):
        meets = (low <= [u1, v1]).all(axis=1) & (high >= [u0, v0]).all(axis=1)
        kept[k] = meets.any() or on_face(*packed, 0.5 * (u0 + u1), 0.5 * (v0 + v1))
    return kept


def _borders(boundary: PackedParts, number: int) -> tuple[Array, Array]:
    """(low, high), each (m, 2), of boxes around parts of a chart's trimming curves."""
    curves = [packed_pcurve(boundary, k) for k in coedge_range(boundary, number)]
    boxes = [equal_boxes(c.kind, c.matrix, c.first, c.last, PARTS) for c in curves]
    if not boxes:
        return np.empty((0, 2)), np.empty((0, 2))
    return np.concatenate([b[0] for b in boxes]), np.concatenate([b[1] for b in boxes])


def leaves_of(boundary: PackedParts, chart: FaceChart, widest: float) -> FaceRectangles:
    """Rectangles that cover a chart's part of its face. Over each the normals fit a cone of half
    angle `widest`, radians, unless it was quartered MOST_QUARTERINGS times."""
    parts, rows = [], chart.rectangle[None]
    for quartering in range(MOST_QUARTERINGS + 1):
        if quartering < MOST_QUARTERINGS:
            rows = rows[_may_be_on(boundary, chart, rows)]
        axes, angles = chart.surface.normal_cones(rows)
        kept = (angles <= widest) | (quartering == MOST_QUARTERINGS)
        parts.append((rows[kept], axes[kept], angles[kept]))
        rows = quartered(rows[~kept])
        if not len(rows):
            break
    return FaceRectangles(*map(np.concatenate, zip(*parts, strict=True)))


def grown_box(
    boundary: PackedParts, charts: Sequence[FaceChart], low: Array, high: Array
) -> tuple[Array, Array]:
    """A box (low, high) of points of a boundary, grown to contain the charts' parts of its faces.

    Rectangles are quartered while they reach past the known points by more than BOX_REACH.
    """
    found_low, found_high = low, high
    waiting = [(chart, chart.rectangle[None]) for chart in charts]
    for round_ in range(BOX_QUARTERINGS):
        reaching = []
        for chart, rows in waiting:
            rows = rows[_may_be_on(boundary, chart, rows)]
            reaching.append((chart, rows, *chart.surface.extents(rows, np.eye(3))))
            inner = _middles(boundary, chart, rows)
            low = np.minimum(low, inner.min(axis=0, initial=np.inf))
            high = np.maximum(high, inner.max(axis=0, initial=-np.inf))
        share = BOX_REACH * float(np.linalg.norm(high - low))
        share = np.inf if round_ == BOX_QUARTERINGS - 1 else share
        waiting = []
        for chart, rows, least, most in reaching:
            past = ((low - share > least.T) | (high + share < most.T)).any(axis=1)
            found_low = np.minimum(found_low, least[:, ~past].min(axis=1, initial=np.inf))
            found_high = np.maximum(found_high, most[:, ~past].max(axis=1, initial=-np.inf))
            if past.any():
                waiting.append((chart, quartered(rows[past])))
    return found_low, found_high


def _middles(boundary: PackedParts, chart: FaceChart, rows: Array) -> Array:
    """(n, 3) points of the face at the middles of rectangles."""
    packed = boundary.ints, boundary.reals, chart.number
    middles = 0.5 * (rows[:, [0, 2]] + rows[:, [1, 3]])
    spots = [chart.surface.jet(u, v)[0] for u, v in middles.tolist() if on_face(*packed, u, v)]
    return np.reshape(spots, (-1, 3))


def quartered(rectangles: Array) -> Array:
    """(4 n, 4) from (n, 4)."""
    u0, u1, v0, v1 = rectangles.T
    u, v = 0.5 * (u0 + u1), 0.5 * (v0 + v1)
    parts = ((u0, u, v0, v), (u, u1, v0, v), (u0, u, v, v1), (u, u1, v, v1))
    return np.concatenate([np.stack(part, 1) for part in parts])
