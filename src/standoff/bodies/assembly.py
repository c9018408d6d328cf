"""From parts to an oriented boundary: charts, coedges, sectors, normal cones, and their checks."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence

import numpy as np

from standoff.bodies.packing import Assembled, Chart, Coedge, Sector
from standoff.bodies.topology import BodyError, Edge, Face
from standoff.geometry.pcurves import Pcurve, pcurve_of
from standoff.geometry.surfaces import Plane, Surface
from standoff.geometry.validation import Array
from standoff.kernels import layout as L

# Endpoints of curves and their vertices must agree to this fraction of the body's size.
JOIN_TOLERANCE = 1e-9
# Dihedral angles below this (sine) make an edge smooth (G1).
SMOOTH_ANGLE = 1e-7
# |u|, |v| of an atlas's gnomonic charts: they overlap from RECHART (1.2) to here.
ATLAS_LIMIT = 2.0
# A face's angle at a vertex of 180 degrees less this (radians) counts as wide.
WIDE_ANGLE = 1e-6
# A chart sees a point whose depth (cosine from its centre) is above this.
CHART_RIM = 1e-3
EDGE_POINTS = np.linspace(0.05, 0.95, 7)


def edge_points(edge: Edge) -> Array:
    """Points inside an edge, (7, 3), body frame."""
    c = edge.curve
    return np.array([c.point(c.first + s * (c.last - c.first)) for s in EDGE_POINTS])


def interior_point(vertices: Array, edges: Sequence[Edge], faces: Sequence[Face]) -> Array:
    """A point inside the convex hull of the boundary."""
    points = [vertices] if len(vertices) else []
    points += [edge_points(e) for e in edges]
    points += [_amid(face, edges) for face in faces]
    return np.asarray(np.concatenate(points).mean(axis=0))


def _amid(face: Face, edges: Sequence[Edge]) -> Array:
    """Points of a face's surface amid its loop, (n, 3). An atlas's first chart is centred on it."""
    if not face.loop:
        return np.array([chart.jet(0.0, 0.0)[0] for chart in face.charts])
    surface = face.charts[0]
    if len(face.charts) > 1:
        return surface.jet(0.0, 0.0)[0][None]
    curves = [edges[j].curve for j, _ in face.loop if 0 <= j < len(edges)]
    spots = [
        pcurve_of(c, surface).point(t) for c in curves for t in np.linspace(c.first, c.last, 9)
    ]
    u, v = np.mean([p[:2] for p in spots if p[2] > 0.0] or [(0.0, 0.0)], axis=0)
    return surface.jet(float(u), float(v))[0][None]


def surface_normal(surface: Surface, u: float, v: float) -> Array:
    jet = surface.jet(u, v)
    normal = np.cross(jet[1], jet[2])
    return np.asarray(normal / np.linalg.norm(normal))


def _make_charts(
    faces: Sequence[Face], edges: Sequence[Edge], inside: Array, bounded: bool
) -> list[Chart]:
    charts = []
    for i, face in enumerate(faces):
        for surface in face.charts:
            chart = Chart(surface, i, limit=ATLAS_LIMIT if len(face.charts) > 1 else np.inf)
            for a in face.apexes:
                line = Pcurve(L.LINE, np.array([[1.0, 0, 0], [0, 0, a.level], [0, 0, 1.0]]))
                chart.coedges.append(Coedge(-1 - a.vertex, line, a.lo, a.hi, 1))
            for j, orientation in face.loop:
                if not 0 <= j < len(edges):
                    raise BodyError(f"Face {i} names edge {j}; there are {len(edges)} edges.")
                curve = edges[j].curve
                pcurve = pcurve_of(curve, surface)
                spans = visible_spans(pcurve, curve.first, curve.last)
                if len(face.charts) == 1 and spans != [(curve.first, curve.last)]:
                    raise BodyError(
                        f"Face {i} does not see the whole of edge {j} in its one gnomonic chart: "
                        "the face reaches past a hemisphere; give it an atlas of charts."
                    )
                chart.coedges += [Coedge(j, pcurve, a, b, orientation) for a, b in spans]
            u, v = _somewhere(chart, edges)
            x = surface.jet(u, v)[0]
            facing = surface_normal(surface, u, v) @ (x - inside) if bounded else 1.0
            chart.outward = 1.0 if facing > 0.0 else -1.0
            charts.append(chart)
    return charts


def visible_spans(pcurve: Pcurve, first: float, last: float) -> list[tuple[float, float]]:
    """The parameter ranges of a pcurve that its chart sees, with a small margin to its rim."""
    if pcurve.kind == L.LINE:
        return [(first, last)]
    a, b, c = pcurve.matrix[2]
    reach = float(np.hypot(a, b))
    rim = CHART_RIM * float(np.abs(pcurve.matrix).max()) - c
    if reach == 0.0 or abs(rim) >= reach:
        return [(first, last)] if -rim > reach or (reach == 0.0 and rim < 0.0) else []
    middle, half = float(np.arctan2(b, a)), float(np.arccos(rim / reach))
    spans = []
    start = middle - half + 2.0 * np.pi * np.floor((first - middle - half) / (2.0 * np.pi))
    while start < last:
        low, high = max(start, first), min(start + 2.0 * half, last)
        if low < high:
            spans.append((low, high))
        start += 2.0 * np.pi
    return spans


def _somewhere(chart: Chart, edges: Sequence[Edge]) -> tuple[float, float]:
    """Parameters near the face, for signs only."""
    points = [
        c.pcurve.point(t)
        for c in chart.coedges
        if c.edge >= 0
        for t in np.linspace(c.first, c.last, 9)
    ]
    visible = [p for p in points if p[2] > 0.0]
    if not visible or chart.limit < np.inf:
        return 0.0, 0.0
    mean = np.mean([p[:2] for p in visible], axis=0)
    return float(mean[0]), float(mean[1])


def _orient(
    charts: list[Chart], faces: Sequence[Face], edges: Sequence[Edge]
) -> tuple[list[bool], list[str]]:
    """Set every coedge's side; find smooth edges. Returns (smooth, notes of what was turned)."""
    users: dict[int, list[tuple[int, int]]] = {j: [] for j in range(len(edges))}
    for i, face in enumerate(faces):
        for j, orientation in face.loop:
            if orientation not in (-1, 1):
                raise BodyError(f"Face {i}, edge {j}: orientation {orientation}; give +1 or -1.")
            users[j].append((i, orientation))
    if faces:
        for j, used in users.items():
            if len(used) != 2:
                word = "open" if len(used) < 2 else "used too often"
                raise BodyError(
                    f"Edge {j} is {word}: it bounds {len(used)} faces; every edge must bound two."
                )
    smooth = [False] * len(edges)
    turned: dict[int, list[bool]] = {i: [] for i in range(len(faces))}
    for j, used in users.items():
        if not used:
            continue
        t = edges[j].curve.first + 0.43 * (edges[j].curve.last - edges[j].curve.first)
        tangent = edges[j].curve.jet(t)[1]
        tangent = tangent / np.linalg.norm(tangent)
        (f0, s0), (f1, s1) = used
        n0, n1 = (_normal_at(charts, f, j, t) for f in (f0, f1))
        smooth[j] = bool(np.linalg.norm(np.cross(n0, n1)) < SMOOTH_ANGLE)
        if edges[j].smooth is not None and edges[j].smooth != smooth[j]:
            raise BodyError(
                f"Edge {j} is said to be {'smooth' if edges[j].smooth else 'sharp'}, but its "
                f"faces' normals differ by {np.linalg.norm(np.cross(n0, n1)):.3g} (sine)."
            )
        if smooth[j]:
            continue
        for f, s, n, other in ((f0, s0, n0, n1), (f1, s1, n1, n0)):
            # a convex edge: the inward conormal of one face goes below the other's plane
            turned[f].append(bool(s * (np.cross(n, tangent) @ other) > 0.0))
    notes = []
    signs = {}
    for i, wrong in turned.items():
        if wrong and any(wrong) and not all(wrong):
            bad = [faces[i].loop[k][0] for k in range(len(wrong)) if wrong[k]]
            raise BodyError(
                f"Face {i}: its loop runs both ways round (edges {bad} against the others), or "
                "the body is not convex there."
            )
        signs[i] = -1 if wrong and all(wrong) else 1
        if signs[i] < 0:
            notes.append(f"face {i}: loop given inward, turned outward")
    for chart in charts:
        for c in chart.coedges:
            if c.edge >= 0:
                c.side = int(c.side * signs[chart.face] * chart.outward)
    return smooth, notes


def _normal_at(charts: list[Chart], face: int, edge: int, t: float) -> Array:
    chart, u, v = chart_at(charts, face, edge, t)
    return chart.outward * surface_normal(chart.surface, u, v)


def chart_at(charts: list[Chart], face: int, edge: int, t: float) -> tuple[Chart, float, float]:
    """The chart of a face that sees an edge's point most centrally, and the parameters there.

    `charts` are in the order of their faces.
    """
    best: tuple[float, Chart, float, float] | None = None
    first = bisect_left(charts, face, key=lambda chart: chart.face)
    for k in range(first, len(charts)):
        chart = charts[k]
        if chart.face != face:
            break
        for c in chart.coedges:
            if c.edge == edge:
                u, v, depth = c.pcurve.point(t)
                reach = max(abs(u), abs(v))
                if depth > 0.0 and (best is None or reach < best[0]):
                    best = (reach, chart, u, v)
    if best is None:
        raise BodyError(f"Face {face}: no chart sees edge {edge} at parameter {t}.")
    return best[1], best[2], best[3]


def _check_joins(vertices: Array, edges: Sequence[Edge], size: float) -> None:
    for j, edge in enumerate(edges):
        curve = edge.curve
        if curve.closed != (edge.first is None and edge.last is None):
            raise BodyError(
                f"Edge {j} is {'closed and has vertices' if curve.closed else 'open'}: an open "
                "edge needs a first and a last vertex, a closed one none."
            )
        for vertex, t in ((edge.first, curve.first), (edge.last, curve.last)):
            if vertex is None:
                continue
            if not 0 <= vertex < len(vertices):
                raise BodyError(f"Edge {j} names vertex {vertex}; there are {len(vertices)}.")
            miss = float(np.linalg.norm(curve.point(t) - vertices[vertex]))
            if miss > JOIN_TOLERANCE * size:
                raise BodyError(
                    f"Edge {j} misses its vertex {vertex} by {miss:.3g} (size {size:.3g}): move "
                    "the vertex or trim the curve."
                )


def _check_loops(faces: Sequence[Face], edges: Sequence[Edge]) -> None:
    for i, face in enumerate(faces):
        ends: dict[int, int] = {}
        for j, s in face.loop:
            e = edges[j]
            if e.first is None or e.last is None:
                continue
            a, b = (e.first, e.last) if s > 0 else (e.last, e.first)
            ends[a] = ends.get(a, 0) - 1
            ends[b] = ends.get(b, 0) + 1
        loose = [vertex for vertex, balance in ends.items() if balance != 0]
        if loose:
            raise BodyError(f"Face {i}: its loop is open at vertices {loose}.")


def _check_on_surface(charts: list[Chart], edges: Sequence[Edge], size: float) -> None:
    for chart in charts:
        for c in chart.coedges:
            if c.edge < 0:
                continue
            curve = edges[c.edge].curve
            for t in np.linspace(c.first, c.last, 9):
                u, v, depth = c.pcurve.point(t)
                if depth <= 0.0 or max(abs(u), abs(v)) > chart.limit:
                    continue
                miss = float(np.linalg.norm(chart.surface.jet(u, v)[0] - curve.point(t)))
                if miss > JOIN_TOLERANCE * size:
                    raise BodyError(
                        f"Edge {c.edge} leaves the surface of face {chart.face} by {miss:.3g} "
                        f"(size {size:.3g}) at its parameter {t:.6g}."
                    )


def _vertex_geometry(
    vertices: Array, edges: Sequence[Edge], faces: Sequence[Face], charts: list[Chart]
) -> tuple[list[list[Sector]], list[list[Array]]]:
    sectors: list[list[Sector]] = [[] for _ in vertices]
    cones: list[list[Array]] = [[] for _ in vertices]
    for i, face in enumerate(faces):
        number = bisect_left(charts, i, key=lambda chart: chart.face)
        for a in face.apexes:
            sectors[a.vertex].append(Sector(number, L.SECTOR_APEX, 0.0, a.level, a.lo, a.hi))
        touching: dict[int, list[tuple[int, int]]] = {}
        for j, _ in face.loop:
            for end, vertex in enumerate((edges[j].first, edges[j].last)):
                if vertex is not None:
                    touching.setdefault(vertex, []).append((j, end))
        for vertex, ends in touching.items():
            j, end = ends[0]
            curve = edges[j].curve
            chart, u, v = chart_at(charts, i, j, curve.last if end else curve.first)
            cones[vertex].append(chart.outward * surface_normal(chart.surface, u, v))
            sector = _wide_sector(charts, chart, i, edges, ends, u, v)
            if sector is not None:
                sectors[vertex].append(sector)
    return sectors, cones


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
    start = stop = None
    for j, end in ends:
        curve = edges[j].curve
        side = next(c.side for c in chart.coedges if c.edge == j)
        out = curve.jet(curve.last if end else curve.first)[1] * (-1.0 if end else 1.0)
        direction = np.linalg.lstsq(tangents, out, rcond=None)[0]
        angle = float(np.arctan2(direction[1], direction[0]))
        # the face lies to the left of the way out where side and sense agree
        if side * (-1 if end else 1) > 0:
            start = angle
        else:
            stop = angle
    if start is None or stop is None:
        return None
    width = (stop - start) % (2.0 * np.pi)
    middle = tangents @ [np.cos(start), np.sin(start)]
    other = tangents @ [np.cos(stop), np.sin(stop)]
    normal = np.cross(jet[1], jet[2])
    turn = np.cross(middle, other) @ normal / np.linalg.norm(normal)
    flat = abs(turn) <= WIDE_ANGLE * np.linalg.norm(middle) * np.linalg.norm(other)
    if width < np.pi and not (flat and middle @ other < 0.0):
        return None
    number = next(k for k, c in enumerate(charts) if c is chart)
    return Sector(number, L.SECTOR_WIDE, u, v, start, start + width)


def assemble(
    vertices: Array,
    edges: Sequence[Edge],
    faces: Sequence[Face],
    dimension: int,
    size: float,
    bounded: bool,
) -> tuple[Assembled, list[str]]:
    """Orient and check a boundary. Returns it with notes of what was turned."""
    _check_joins(vertices, edges, size)
    inside = interior_point(vertices, edges, faces)
    charts = _make_charts(faces, edges, inside, bounded)
    smooth, notes = _orient(charts, faces, edges)
    _check_loops(faces, edges)
    _check_on_surface(charts, edges, size)
    sectors, cones = _vertex_geometry(vertices, edges, faces, charts)
    right = [False] * len(edges)
    if dimension == 2:
        right, cones = _planar_geometry(vertices, edges, inside, size)
    return (
        Assembled(dimension, vertices, edges, faces, charts, smooth, right, sectors, cones),
        notes,
    )


def _planar_geometry(
    vertices: Array, edges: Sequence[Edge], inside: Array, size: float
) -> tuple[list[bool], list[list[Array]]]:
    """Outward sides of a planar loop's edges and the normal cones of its vertices."""
    right: list[bool] = []
    cones: list[list[Array]] = [[] for _ in vertices]
    for edge in edges:
        c = edge.curve
        x, tangent, _ = c.jet(0.5 * (c.first + c.last))
        outward = np.array([tangent[1], -tangent[0], 0.0])
        right.append(bool(outward @ (x - inside) > 0.0))
        for vertex, t in ((edge.first, c.first), (edge.last, c.last)):
            if vertex is not None:
                tangent = c.jet(t)[1]
                sign = 1.0 if right[-1] else -1.0
                normal = sign * np.array([tangent[1], -tangent[0], 0.0])
                cones[vertex].append(normal / np.linalg.norm(normal))
    for vertex, cone in enumerate(cones):
        if len(cone) != 2:
            raise BodyError(
                f"Planar loop: {len(cone)} curves meet at vertex {vertex} "
                f"{vertices[vertex][:2]}; exactly two must."
            )
    return right, cones


__all__ = ["ATLAS_LIMIT", "Plane", "assemble", "edge_points", "interior_point"]
