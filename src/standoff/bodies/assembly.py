"""From parts to an oriented boundary, with sectors and normal cones, and its checks."""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from standoff.bodies.charts import edge_points, make_charts, surface_normal
from standoff.bodies.enclosed import Enclosed, all_flat, enclosed_by, enclosed_by_planes
from standoff.bodies.orientation import chart_at, orient
from standoff.bodies.packed_parts import packed_parts
from standoff.bodies.packing import Assembled, Chart, Sector
from standoff.bodies.tolerances import (
    JOIN_TOLERANCE,
    SINGULAR_CORNER,
    VOLUME_END,
    WIDE_ANGLE,
    coordinate_roundoff,
)
from standoff.bodies.topology import SIDES, Apex, Edge, Face, check_parts, extent_of, parts_of
from standoff.checks.arrays import finite
from standoff.checks.numbers import magnitude
from standoff.checks.real_numbers import shape_of, shown
from standoff.errors import BodyError
from standoff.geometry.curves import Curve
from standoff.kernels.body import layout as L
from standoff.long_loops import told
from standoff.typing import Array

# Points of each span of an edge that are compared with the adjacent surface.
SPAN_POINTS = 9
# Generators that a collapsed side adds to its vertex's normal cone.
APEX_NORMALS = 9


@dataclass(frozen=True, eq=False)
class Joined:
    """An oriented boundary.

    notes : what was turned; residual : the greatest distance between parts that were joined,
    length; tolerance : what it was allowed to be, length; shells, claims : as in ``Oriented``;
    enclosed : what shells enclose, where it was found to turn them, by their faces.
    """

    parts: Assembled
    notes: list[str]
    residual: float
    tolerance: float
    shells: list[list[int]]
    claims: list[int]
    enclosed: dict[tuple[int, ...], Enclosed] = field(default_factory=dict)


def _check_joins(vertices: Array, edges: Sequence[Edge], size: float, tolerance: float) -> float:
    """The greatest distance between an edge's end and its vertex."""
    worst = 0.0
    for j, edge in enumerate(edges):
        curve = edge.curve
        if curve.closed != (edge.first is None and edge.last is None):
            raise BodyError(
                f"Edge {j} is {'closed and has vertices' if curve.closed else 'open'}: an open "
                "edge needs a first and a last vertex, a closed one none.",
                part=("edge", j),
            )
        for vertex, t in ((edge.first, curve.first), (edge.last, curve.last)):
            if vertex is None:
                continue
            if not 0 <= vertex < len(vertices):
                raise BodyError(
                    f"Edge {j} names vertex {vertex}; there are {len(vertices)}.", part=("edge", j)
                )
            miss = float(np.linalg.norm(curve.point(t) - vertices[vertex]))
            worst = max(worst, miss)
            if miss > tolerance:
                raise BodyError(
                    f"Edge {j} misses its vertex {vertex} by {miss:.3g} (size {size:.3g}), more "
                    f"than tolerance={tolerance:.3g} allows: move the vertex, trim the curve or "
                    "give a greater tolerance.",
                    part=("edge", j),
                )
    return worst


def _check_on_surface(
    charts: list[Chart], edges: Sequence[Edge], size: float, tolerance: float
) -> float:
    """The greatest distance between an edge and its trimming curves, as points of the surface."""
    worst = 0.0
    for chart in told(charts, "comparing edges with faces"):
        for c in chart.coedges:
            if c.edge < 0:
                continue
            curve = edges[c.edge].curve
            ts = _stations(curve, c.first, c.last)
            places = c.pcurve.places(ts)
            seen = np.abs(places).max(axis=1) <= chart.limit  # nan where it sees nothing
            ts, places = ts[seen], places[seen]
            if not len(ts):
                continue
            away = chart.surface.points(places) - curve.points(ts)
            misses = np.linalg.norm(away, axis=1)
            k = int(misses.argmax())
            worst = max(worst, float(misses[k]))
            if worst > tolerance:
                raise BodyError(
                    f"Edge {c.edge} leaves the surface of face {chart.face} by {worst:.3g} "
                    f"(size {size:.3g}) at its parameter {ts[k]:.6g}, more than tolerance="
                    f"{tolerance:.3g} allows.",
                    part=("edge", c.edge),
                )
    return worst


def _stations(curve: Curve, first: float, last: float) -> Array:
    """Parameters in every span of a curve, so that no analytic piece lies between two samples."""
    inside = curve.spans()
    ends = np.concatenate([[first], inside[(inside > first) & (inside < last)], [last]])
    return np.unique(np.linspace(ends[:-1], ends[1:], SPAN_POINTS))


def _vertex_geometry(
    vertices: Array, edges: Sequence[Edge], faces: Sequence[Face], charts: list[Chart]
) -> tuple[list[list[Sector]], list[list[Array]]]:
    sectors: list[list[Sector]] = [[] for _ in vertices]
    cones: list[list[Array]] = [[] for _ in vertices]
    for i, face in enumerate(told(faces, "measuring corners of faces")):
        number = bisect_left(charts, i, key=lambda chart: chart.face)
        for a in face.apexes:
            side = float(SIDES.index(a.side))
            sectors[a.vertex].append(Sector(number, L.SECTOR_APEX, side, a.level, a.lo, a.hi))
            cones[a.vertex] += _apex_normals(charts[number], a)
        touching: dict[int, list[tuple[int, int]]] = {}
        for j, _ in face.loop:
            for end, vertex in enumerate((edges[j].first, edges[j].last)):
                if vertex is not None:
                    touching.setdefault(vertex, []).append((j, end))
        collapsed = {a.vertex for a in face.apexes}
        for vertex, ends in touching.items():
            if vertex in collapsed:
                continue
            j, end = ends[0]
            curve = edges[j].curve
            chart, u, v = chart_at(charts, i, j, curve.last if end else curve.first)
            cones[vertex].append(chart.outward * surface_normal(chart.surface, u, v))
            sector = _wide_sector(charts, chart, i, edges, ends, u, v)
            if sector is not None:
                sectors[vertex].append(sector)
    return sectors, [_around(cone) for cone in cones]


def _apex_normals(chart: Chart, apex: Apex) -> list[Array]:
    """Outward normals along a collapsed side: generators of the vertex's cone. None on a surface
    whose u is an angle, where the kernels' sector is enough."""
    if chart.surface.periodic:
        return []
    ts = [float(t) for t in np.linspace(apex.lo, apex.hi, APEX_NORMALS)]
    spots = [(t, apex.level) if apex.side[0] == "v" else (apex.level, t) for t in ts]
    return [chart.outward * surface_normal(chart.surface, u, v) for u, v in spots]


def _around(cone: list[Array]) -> list[Array]:
    """A vertex's normals in order around it: the certificate pairs neighbours."""
    if len(cone) < 4:
        return cone
    axis = np.sum(cone, axis=0)
    axis = axis / np.linalg.norm(axis)
    x = np.cross(axis, np.eye(3)[int(np.abs(axis).argmin())])
    y = np.cross(axis, x)
    return sorted(cone, key=lambda n: float(np.arctan2(n @ y, n @ x)))


def _wide_sector(
    charts: list[Chart],
    chart: Chart,
    face: int,
    edges: Sequence[Edge],
    ends: list[tuple[int, int]],
    u: float,
    v: float,
) -> Sector | None:
    """The sector of a face at a vertex where its angle is 180 degrees or more."""
    jet = chart.surface.jet(u, v)
    tangents = np.column_stack([jet[1], jet[2]])
    normal = np.cross(jet[1], jet[2])
    area = float(np.linalg.norm(normal))
    if area <= SINGULAR_CORNER * float(np.prod(np.linalg.norm(tangents, axis=0))):
        return None  # from such a corner no direction in (u, v) leads into the face
    start = stop = None
    for j, end in ends:
        curve = edges[j].curve
        side = next(c.side for c in chart.coedges if c.edge == j)
        out = curve.jet(curve.last if end else curve.first)[1] * (-1.0 if end else 1.0)
        direction = np.linalg.lstsq(tangents, out, rcond=None)[0]
        angle = float(np.arctan2(direction[1], direction[0]))
        # the face lies to the left of the outgoing direction where side and sense agree
        if side * (-1 if end else 1) > 0:
            start = angle
        else:
            stop = angle
    if start is None or stop is None:
        return None
    width = (stop - start) % (2.0 * np.pi)
    middle = tangents @ [np.cos(start), np.sin(start)]
    other = tangents @ [np.cos(stop), np.sin(stop)]
    turn = np.cross(middle, other) @ normal / area
    flat = abs(turn) <= WIDE_ANGLE * np.linalg.norm(middle) * np.linalg.norm(other)
    if width < np.pi and not (flat and middle @ other < 0.0):
        return None
    number = next(k for k, c in enumerate(charts) if c is chart)
    return Sector(number, L.SECTOR_WIDE, u, v, start, start + width)


def joined_parts(
    vertices: Any,
    edges: Sequence[Edge],
    faces: Sequence[Face],
    tolerance: float | None,
    dimension: int = 3,
    *,
    closed: bool = False,
    senses: Sequence[int | None] | None = None,
) -> Joined:
    """Parts as they are given, checked, and joined; raises as `Body.from_brep` does.

    closed : are they shells that bound a volume, each turned so that it faces outward; senses : as
    in `Boundary.from_brep`, which tells what such parts are refused for.
    """
    points = np.zeros((0, 3))
    if shape_of(vertices) not in ((0,), (0, 3)):
        points = finite(vertices, "vertices", (-1, 3))
    edges, faces = parts_of(edges, "edges"), parts_of(faces, "faces")
    check_parts(points, edges, faces, dimension)
    spots = [points, *(edge_points(e) for e in edges)]
    if closed:
        _check_closed(faces)
        spots.append(_charts_points(faces))
    cloud, what = np.concatenate(spots), "the boundary" if closed else "the body"
    rough = extent_of(cloud, what) if len(cloud) > 1 else float(not len(cloud))
    tolerance = None if tolerance is None else magnitude(tolerance, "tolerance")
    return assemble(points, edges, faces, dimension, rough, tolerance, _checked(senses, faces))


def _check_closed(faces: Sequence[Face]) -> None:
    if not faces:
        raise BodyError("A boundary needs faces: points, segments and planar loops are bodies.")
    if len(faces) == 1 and not faces[0].loop and len(faces[0].charts) == 1:
        raise BodyError("A half-space has no closed boundary: give its face edges.")


def _charts_points(faces: Sequence[Face]) -> Array:
    """The centres of the charts of faces without loops."""
    whole = [chart.jet(0.0, 0.0)[0] for f in faces if not f.loop for chart in f.charts]
    return np.reshape(whole, (-1, 3))


def _checked(senses: Sequence[int | None] | None, faces: Sequence[Face]) -> list[int | None] | None:
    if senses is None:
        return None
    found = list(senses)
    if len(found) != len(faces) or any(s not in (1, -1, None) for s in found):
        raise BodyError(
            f"senses = {shown(senses)}: give +1, -1 or None for each of {len(faces)} faces.",
            "senses",
            senses,
        )
    return found


def assemble(
    vertices: Array,
    edges: Sequence[Edge],
    faces: Sequence[Face],
    dimension: int,
    size: float,
    tolerance: float | None = None,
    senses: Sequence[int | None] | None = None,
    trusted: bool = False,
) -> Joined:
    """Orient and check a boundary; its parts may miss each other by `tolerance`, length.

    Whatever the tolerance, they may miss each other by the roundoff of their coordinates.

    senses, trusted : as in ``orient``.
    """
    tolerance = JOIN_TOLERANCE * size if tolerance is None else tolerance
    roundoff = coordinate_roundoff(np.concatenate([vertices, *(edge_points(e) for e in edges)]))
    tolerance = max(tolerance, roundoff)
    miss = _check_joins(vertices, edges, size, tolerance)
    charts = make_charts(faces, edges)
    parts = Assembled(dimension, vertices, edges, faces, charts)
    enclosed: dict[tuple[int, ...], Enclosed] = {}
    found = orient(charts, faces, edges, _volume(parts, enclosed), senses, trusted)
    parts = replace(parts, smooth=found.smooth)
    if roundoff > JOIN_TOLERANCE * size > 0.0:
        found.notes.append(roundoff_note(roundoff))
    miss = max(miss, _check_on_surface(charts, edges, size, tolerance))
    sectors, cones = _vertex_geometry(vertices, edges, faces, charts)
    parts = replace(parts, sectors=sectors, cones=cones)
    if dimension == 2:
        right, cones = _planar_geometry(vertices, edges)
        parts = replace(parts, outward_right=right, cones=cones)
    return Joined(parts, found.notes, miss, tolerance, found.shells, found.claims, enclosed)


def roundoff_note(roundoff: float) -> str:
    """Of a boundary whose coordinates' roundoff, length, is above its own tolerance."""
    return (
        f"far from the origin: parts may miss each other by {roundoff:.3g}, the roundoff of "
        "their coordinates"
    )


def _volume(
    parts: Assembled, kept: dict[tuple[int, ...], Enclosed]
) -> Callable[[Sequence[int]], float]:
    """The volume that a shell encloses, as its charts face at the time of the call; what is found
    as accurately as a boundary tells it is kept."""

    def volume(shell: Sequence[int]) -> float:
        if all_flat(parts, shell):
            return enclosed_by_planes(parts, shell).settled
        found = enclosed_by(packed_parts(parts), shell, VOLUME_END)
        kept[tuple(sorted(shell))] = found
        return found.settled

    return volume


def _planar_geometry(
    vertices: Array, edges: Sequence[Edge]
) -> tuple[list[bool], list[list[Array]]]:
    """Outward sides of a planar loop's edges and the normal cones of its vertices."""
    from standoff.bodies.enclosed import outward_right

    cones: list[list[Array]] = [[] for _ in vertices]
    meeting = Counter(v for edge in edges for v in (edge.first, edge.last) if v is not None)
    for number in range(len(vertices)):
        if meeting[number] != 2:
            raise BodyError(
                f"Planar loop: {meeting[number]} curves meet at vertex {number} "
                f"{vertices[number][:2]}; exactly two must."
            )
    right = outward_right(edges)
    for j, edge in enumerate(edges):
        c = edge.curve
        for vertex, t in ((edge.first, c.first), (edge.last, c.last)):
            if vertex is not None:
                tangent = c.jet(t)[1]
                if not tangent.any():
                    raise BodyError(
                        f"Planar loop: edge {j} has no tangent at its vertex {vertex} "
                        f"{vertices[vertex][:2]}; leave out the doubled control point."
                    )
                sign = 1.0 if right[j] else -1.0
                normal = sign * np.array([tangent[1], -tangent[0], 0.0])
                cones[vertex].append(normal / np.linalg.norm(normal))
    return right, cones
