"""Triangles of a body's faces and points along its edges: for pictures, never for distances."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from standoff.bodies.packed_parts import PackedParts
from standoff.geometry.surfaces import Surface
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import (
    chart_normal,
    coedge_parameters,
    on_face,
    planar_edge_normal,
)
from standoff.typing import Array

# Points along each coedge, and along each edge: a full circle is drawn without visible corners.
ALONG = 33
ALONG_EDGE = 97
# Grid points along each side of a chart: for a body of few charts, a finer grid for it, and for a
# body of many charts.
GRID, FINE_GRID, COARSE_GRID = 21, 41, 7
FEW_CHARTS = 20
# An unbounded face is shown over this half width, in units of its parameters.
UNBOUNDED_HALF = 1.0
# The charts of an atlas, restricted to |u|, |v| up to this, tile their surface without overlap.
TILE = 1.0
# Grid points nearer to the boundary than this fraction of a grid step would make slivers.
CLEARANCE = 0.35


@dataclass(frozen=True)
class FaceMesh:
    """Triangles of one chart of a face.

    Attributes
    ----------
    face : int
    points : (n, 3) array, body frame.
    normals : (n, 3) array, outward unit normals at the points; zero at a cone's apex.
    triangles : (m, 3) array of indices of points.
    inner : indices of the points that lie inside the face, not on its boundary.
    """

    face: int
    points: Array
    normals: Array
    triangles: NDArray[np.int64]
    inner: NDArray[np.int64]


@dataclass(frozen=True)
class EdgeLine:
    """Points along an edge, with the outward normals of its faces.

    Attributes
    ----------
    edge : int
    points : (n, 3) array, body frame.
    normals : (k, n, 3) array, of its k faces; its own in a planar body; none (k = 0) for a segment.
    smooth : bool
    """

    edge: int
    points: Array
    normals: Array
    smooth: bool


def face_meshes(body: PackedParts, *, fine: bool = False) -> list[FaceMesh]:
    """Return the triangles of every chart of every face, within the face.

    With `fine`, they suit pictures whose outlines should look smooth.
    """
    few = body.ints[L.N_CHARTS] <= FEW_CHARTS
    grid = (FINE_GRID if fine else GRID) if few else COARSE_GRID
    meshes = []
    for face, part in enumerate(body.face_parts):
        row = int(body.ints[L.FACES]) + L.FACE_STRIDE * face
        first, count = (int(n) for n in body.ints[row : row + 2])
        for chart in range(first, first + count):
            mesh = _chart_mesh(body, face, chart, surface_of(body, part.charts, chart), grid)
            if mesh is not None:
                meshes.append(mesh)
    return meshes


def edge_lines(body: PackedParts) -> list[EdgeLine]:
    """Return points along every edge."""
    coedges: list[dict[int, int]] = [{} for _ in range(body.n_edges)]
    for k, chart, edge in coedges_of(body):
        if edge >= 0:
            coedges[edge].setdefault(chart_row(body, chart)[L.CHART_FACE], k)
    return [_edge_line(body, edge, list(found.values())) for edge, found in enumerate(coedges)]


def chart_row(body: PackedParts, chart: int) -> NDArray[np.int64]:
    """The packed record of a chart, laid out as in ``kernels.body.layout``."""
    start = int(body.ints[L.CHARTS]) + L.CHART_STRIDE * chart
    return body.ints[start : start + L.CHART_STRIDE]


def coedge_range(body: PackedParts, chart: int) -> range:
    """The packed numbers of a chart's coedges."""
    row = chart_row(body, chart)
    first = int(row[L.CHART_COEDGE])
    return range(first, first + int(row[L.CHART_N_COEDGES]))


class PackedPcurve(NamedTuple):
    """A packed trimming curve: its kind, its range, and a (3, 3) matrix or the homogeneous points
    (n, 3) of a Bezier curve over all of the range."""

    kind: int
    first: float
    last: float
    matrix: Array


def packed_pcurve(body: PackedParts, coedge: int) -> PackedPcurve:
    row = int(body.ints[L.COEDGES]) + L.COEDGE_STRIDE * coedge
    at, kind = int(body.ints[row + L.COEDGE_REALS]), int(body.ints[row + L.COEDGE_KIND])
    first, last = body.reals[at : at + L.PCURVE_DATA].tolist()
    at, count = at + L.PCURVE_DATA, 9
    if kind == L.BEZIER:
        at, count = at + 1, 3 * (int(body.reals[at]) + 1)
    return PackedPcurve(kind, first, last, body.reals[at : at + count].reshape(-1, 3))


def coedges_of(body: PackedParts) -> list[tuple[int, int, int]]:
    """(number, chart, edge) of every coedge; the edge of a collapsed side is -1 - vertex."""
    found = []
    for chart in range(int(body.ints[L.N_CHARTS])):
        for k in coedge_range(body, chart):
            start = int(body.ints[L.COEDGES]) + L.COEDGE_STRIDE * k
            found.append((k, chart, int(body.ints[start + L.COEDGE_EDGE])))
    return found


def surface_of(body: PackedParts, charts: tuple[Surface, ...], chart: int) -> Surface:
    """The surface of a packed chart, found by its data as blind charts are not packed."""
    offset = int(chart_row(body, chart)[L.CHART_REALS])
    packed = body.reals[offset : offset + L.INVERSE]
    misses = [float(np.abs(surface.reals[: L.INVERSE] - packed).max()) for surface in charts]
    return charts[int(np.argmin(misses))]


def chart_outline(body: PackedParts, chart: int) -> Array:
    """Points of a chart's trimming curves in (u, v), (n, 2), as far as the chart shows them."""
    spots = []
    for k in coedge_range(body, chart):
        curve = packed_pcurve(body, k)
        for t in np.linspace(curve.first, curve.last, ALONG):
            u, v, _, _, depth = coedge_parameters(body.ints, body.reals, k, t)
            if depth > 0.0:
                spots.append((u, v))
    return np.array(spots).reshape(-1, 2)


def _chart_mesh(
    body: PackedParts, face: int, chart: int, surface: Surface, count: int
) -> FaceMesh | None:
    outline = chart_outline(body, chart)
    low, high = chart_box(body, chart, outline)
    tiled = _is_tile(body, chart)
    if tiled:
        outline = outline[np.abs(outline).max(axis=1, initial=0.0) <= TILE]
    step = (high - low) / (count - 1)
    u, v = np.meshgrid(*(np.linspace(low[k], high[k], count) for k in (0, 1)), indexing="ij")
    grid = np.column_stack([u.ravel(), v.ravel()])
    kept = np.array([on_face(body.ints, body.reals, chart, a, b) for a, b in grid], dtype=bool)
    if len(outline):
        gaps = np.abs((grid[:, None] - outline) / step).max(axis=2).min(axis=1)
        kept &= gaps > CLEARANCE
    spots = np.vstack([outline, grid[kept]])
    if len(spots) < 3:
        return None
    triangles = scipy.spatial.Delaunay(spots / step).simplices
    middles = spots[triangles].mean(axis=1)
    inside = [on_face(body.ints, body.reals, chart, a, b) for a, b in middles]
    triangles = triangles[np.array(inside, dtype=bool)]
    points = np.array([surface.jet(float(a), float(b))[0] for a, b in spots])
    normals = np.array([chart_normal(body.ints, body.reals, chart, a, b) for a, b in spots])
    inner = np.arange(len(outline), len(spots))
    return FaceMesh(face, points, normals, triangles.astype(np.int64), inner)


def _is_tile(body: PackedParts, chart: int) -> bool:
    offset = int(chart_row(body, chart)[L.CHART_REALS])
    return bool(np.isfinite(body.reals[offset + L.LIMIT]))


def chart_box(body: PackedParts, chart: int, outline: Array) -> tuple[Array, Array]:
    """The rectangle in (u, v) that contains a chart's part of its face."""
    if _is_tile(body, chart):
        return np.full(2, -TILE), np.full(2, TILE)
    if not len(outline):
        return np.full(2, -UNBOUNDED_HALF), np.full(2, UNBOUNDED_HALF)
    return outline.min(axis=0), outline.max(axis=0)


def _edge_line(body: PackedParts, edge: int, coedges: list[int]) -> EdgeLine:
    curve = body.edge_parts[edge].curve
    times = np.linspace(curve.first, curve.last, ALONG_EDGE)
    points = np.array([curve.point(float(t)) for t in times])
    feature = body.n_faces + edge
    normals = []
    if body.dimension == 2:
        own = [planar_edge_normal(body.ints, body.reals, feature, float(t)) for t in times]
        normals.append(np.array(own))
    for k in coedges:
        start = int(body.ints[L.COEDGES]) + L.COEDGE_STRIDE * k
        chart = int(body.ints[start + L.COEDGE_CHART])
        spots = [coedge_parameters(body.ints, body.reals, k, float(t)) for t in times]
        # Where this chart of an atlas does not see the edge, another one does: nan here.
        normals.append(
            np.array(
                [
                    chart_normal(body.ints, body.reals, chart, u, v)
                    if depth > 0.0
                    else [np.nan] * 3
                    for u, v, _, _, depth in spots
                ]
            )
        )
    start = int(body.ints[L.EDGES]) + L.EDGE_STRIDE * edge
    smooth = bool(body.ints[start + L.EDGE_FLAGS] & L.SMOOTH)
    return EdgeLine(edge, points, np.array(normals).reshape(-1, ALONG_EDGE, 3), smooth)
