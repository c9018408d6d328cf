"""External Voronoi regions of a spatial body: ruled surfaces along edges, sectors at vertices."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.charts import surface_normal
from standoff.bodies.features import Feature
from standoff.bodies.tessellation import chart_row, coedges_of, packed_pcurve, surface_of
from standoff.bodies.topology import Apex
from standoff.bodies.voronoi.regions import NormalCone, RegionBoundary, VoronoiRegions
from standoff.bodies.voronoi.tolerances import CORNER_TURN
from standoff.geometry.curves import Line
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import coedge_parameters
from standoff.typing import Array

# Rays along an edge and in a fan: enough that a drawn surface shows no corners.
ALONG_EDGE = 49
# Greatest angle between two rays of a sector at a vertex, radians.
SECTOR_STEP = np.pi / 48.0


class _Side(NamedTuple):
    """A face of an edge: its number, and its outward normals (n, 3) along the edge."""

    face: int
    normals: Array


def spatial_regions(body: Body, reach: float) -> VoronoiRegions:
    """See ``voronoi_regions``."""
    external: list[RegionBoundary] = []
    if body.n_edges and not body.n_faces:
        external += _of_segment(body)
    for j in range(body.n_edges if body.n_faces else 0):
        external += _of_edge(body, j)
    for i, face in enumerate(body.face_parts):
        for apex in face.apexes:
            external += _of_apex(body, i, apex)
    return VoronoiRegions(body, reach, tuple(external), (), _cones(body, external))


def _edge_row(body: Body, j: int) -> tuple[int, ...]:
    start = int(body.ints[L.EDGES]) + L.EDGE_STRIDE * j
    return tuple(int(n) for n in body.ints[start : start + L.EDGE_STRIDE])


def _of_edge(body: Body, j: int) -> list[RegionBoundary]:
    """The surfaces between an edge and its faces, and the sectors between it and its vertices."""
    row = _edge_row(body, j)
    if row[L.EDGE_FLAGS] & L.SMOOTH:
        return []
    curve = body.edge_parts[j].curve
    coedges = _coedges_by_face(body, j)
    count = 2 if _is_flat(body, list(coedges)) and isinstance(curve, Line) else ALONG_EDGE
    ts = np.linspace(curve.first, curve.last, count)
    points = np.array([curve.point(float(t)) for t in ts])
    sides = [_Side(face, _normals(body, found, ts)) for face, found in coedges.items()]
    if len(sides) == 1:  # a seam of one face with itself
        return []
    turns = [_turn(sides[0].normals[k], sides[1].normals[k]) for k in range(count)]
    if max(turns) <= CORNER_TURN:  # a crease, or a kept smooth edge: its region has no interior
        return []
    edge = Feature("edge", j)
    found = [
        RegionBoundary((Feature("face", side.face), edge), points, side.normals) for side in sides
    ]
    for k, vertex in ((0, row[L.EDGE_FIRST]), (-1, row[L.EDGE_LAST])):
        if vertex >= 0 and turns[k] > CORNER_TURN:
            sector = _sector(sides[0].normals[k], sides[1].normals[k], turns[k])
            origins = np.tile(body.vertex_points[vertex], (len(sector), 1))
            found.append(RegionBoundary((edge, Feature("vertex", vertex)), origins, sector))
    return found


def _is_flat(body: Body, faces: Sequence[int]) -> bool:
    return all(body.face_parts[i].charts[0].flat for i in faces)


class _Coedge(NamedTuple):
    """A packed coedge: number, chart, and the first and last parameter that it covers."""

    number: int
    chart: int
    first: float
    last: float


def _coedges_by_face(body: Body, j: int) -> dict[int, list[_Coedge]]:
    """The coedges of an edge by face: one, or one per chart that sees it, or one per piece."""
    found: dict[int, list[_Coedge]] = {}
    for number, chart, edge in coedges_of(body):
        if edge == j:
            curve = packed_pcurve(body, number)
            face = int(chart_row(body, chart)[L.CHART_FACE])
            found.setdefault(face, []).append(_Coedge(number, chart, curve.first, curve.last))
    return found


def _normals(body: Body, coedges: Sequence[_Coedge], ts: Array) -> Array:
    """A face's outward normals (n, 3) along an edge."""
    normals = []
    for t in ts.tolist():
        seen: list[tuple[float, float, int, float, float]] = []
        for c in coedges:
            u, v, _, _, depth = coedge_parameters(body.ints, body.reals, c.number, t)
            if depth > 0.0:
                miss = max(c.first - t, t - c.last, 0.0)
                reach = max(abs(u), abs(v)) if len(coedges) > 1 else 0.0
                seen.append((miss, reach, c.chart, u, v))
        _, _, chart, u, v = min(seen)
        normals.append(outward_normal(body, chart, u, v))
    return np.array(normals)


def outward_normal(body: Body, chart: int, u: float, v: float) -> Array:
    """A face's outward unit normal, (3,), body frame; its limit where a tangent has collapsed."""
    row = chart_row(body, chart)
    outward = float(body.reals[int(row[L.CHART_REALS]) + L.OUTWARD])
    surface = surface_of(body, body.face_parts[int(row[L.CHART_FACE])].charts, chart)
    return np.asarray(outward * surface_normal(surface, u, v))


def _turn(a: Array, b: Array) -> float:
    """The angle between two unit normals, radians, 0 to pi."""
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))


def _sector(a: Array, b: Array, turn: float) -> Array:
    """Unit directions from one normal to another, (n, 3), equal angles apart."""
    across = b - (a @ b) * a
    across = across / np.linalg.norm(across)
    angles = np.linspace(0.0, turn, max(2, int(np.ceil(turn / SECTOR_STEP)) + 1))
    return np.asarray(np.outer(np.cos(angles), a) + np.outer(np.sin(angles), across))


def _of_apex(body: Body, face: int, apex: Apex) -> list[RegionBoundary]:
    """The fan between a face and the vertex to which its side is collapsed."""
    first = int(body.ints[int(body.ints[L.FACES]) + L.FACE_STRIDE * face])
    ts = np.linspace(apex.lo, apex.hi, 2 * ALONG_EDGE - 1)
    spots = [(t, apex.level) if apex.side[0] == "v" else (apex.level, t) for t in ts.tolist()]
    normals = np.array([outward_normal(body, first, u, v) for u, v in spots])
    if max(_turn(a, b) for a, b in pairwise(normals)) <= CORNER_TURN:
        return []
    origins = np.tile(body.vertex_points[apex.vertex], (len(normals), 1))
    features = Feature("face", face), Feature("vertex", apex.vertex)
    return [RegionBoundary(features, origins, normals)]


def _of_segment(body: Body) -> list[RegionBoundary]:
    """The discs perpendicular to a segment at its two ends."""
    curve = body.edge_parts[0].curve
    tangent = curve.jet(curve.first)[1]
    tangent = tangent / np.linalg.norm(tangent)
    x = np.cross(tangent, np.eye(3)[int(np.abs(tangent).argmin())])
    x = x / np.linalg.norm(x)
    angles = np.linspace(0.0, 2.0 * np.pi, 2 * ALONG_EDGE - 1)
    around = np.outer(np.cos(angles), x) + np.outer(np.sin(angles), np.cross(tangent, x))
    edge = body.edge_parts[0]
    return [
        RegionBoundary(
            (Feature("edge", 0), Feature("vertex", vertex)),
            np.tile(body.vertex_points[vertex], (len(around), 1)),
            around,
        )
        for vertex in (edge.first, edge.last)
        if vertex is not None
    ]


def _cones(body: Body, external: list[RegionBoundary]) -> tuple[NormalCone, ...]:
    """The packed normals at every vertex; the fan if a whole collapsed side of a cone is there."""
    cones = []
    for k, point in enumerate(body.vertex_points):
        vertex = Feature("vertex", k)
        row = int(body.ints[L.VERTICES]) + L.VERTEX_STRIDE * k
        start, count = (int(n) for n in body.ints[row + L.VERTEX_CONE : row + L.VERTEX_STRIDE])
        normals = body.reals[start : start + 3 * count].reshape(-1, 3)
        if not count:
            fans = [ray.directions for ray in external if ray.features[1] == vertex]
            normals = np.concatenate(fans) if fans else np.zeros((0, 3))
        cones.append(NormalCone(vertex, point, normals))
    return tuple(cones)
