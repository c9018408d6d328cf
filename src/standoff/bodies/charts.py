"""The charts of a body's faces with their coedges, made from the parts as they were given."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from standoff.bodies.packing import Chart, Coedge
from standoff.bodies.periods import in_one_period
from standoff.bodies.tolerances import CHART_RIM, COLLAPSED_TANGENT, INWARD_STEP
from standoff.bodies.topology import Apex, Edge, Face
from standoff.errors import BodyError
from standoff.geometry.surfaces import Surface
from standoff.kernels.body import layout as L
from standoff.kernels.tolerances import EPS, NORMAL_NOISE
from standoff.motion.vectors import cross
from standoff.typing import Array

if TYPE_CHECKING:
    from standoff.geometry.pcurves import Pcurve

# Greatest |u| and |v| in an atlas's gnomonic charts: they overlap from RECHART (1.2) to here.
ATLAS_LIMIT = 2.0
EDGE_POINTS = np.linspace(0.05, 0.95, 7)


def edge_points(edge: Edge) -> Array:
    """Points between the ends of an edge, (7, 3), body frame."""
    c = edge.curve
    return np.array([c.point(c.first + s * (c.last - c.first)) for s in EDGE_POINTS])


def loop_pcurve(face: Face, entry: int, edges: Sequence[Edge], surface: Surface) -> Pcurve:
    """The trimming curve of one entry of a face's loop: as given, or exact by construction."""
    from standoff.geometry.exact_pcurves import pcurve_of

    given = face.pcurves[entry] if face.pcurves else None
    return given or pcurve_of(edges[face.loop[entry][0]].curve, surface)


def surface_normal(surface: Surface, u: float, v: float) -> Array:
    """Unit f_u x f_v; its limit from inside the domain where one of the two has collapsed."""
    _, xu, xv, _, xuv, _ = surface.jet(u, v)
    normal = cross(xu, xv)
    length = float(np.linalg.norm(normal))
    a, b = float(np.linalg.norm(xu)), float(np.linalg.norm(xv))
    if min(a, b) > COLLAPSED_TANGENT * max(a, b) and length > 0.0:
        return np.asarray(normal / length)
    _, near_u, near_v, *_ = surface.jet(*_inwards(surface, u, v))
    near = cross(near_u, near_v)
    normal = cross(xuv, xv) if a < b else cross(xu, xuv)
    length = float(np.linalg.norm(normal))
    if length == 0.0:
        return np.asarray(near / np.linalg.norm(near))
    return np.asarray(np.copysign(1.0, normal @ near) * normal / length)


def normal_noise(surface: Surface, u: float, v: float, size: float) -> float:
    """How far roundoff may turn a normal near a collapsed side, radians; 0 where it does not.

    The same bound as in the kernels, where the certificate subtracts it at such a point: a surface
    turned by no more is within NORMAL_NOISE roundings of the exact one. `size` is the size of the
    body, length.
    """
    if not surface.noisy:
        return 0.0
    x, xu, xv, _, xuv, _ = surface.jet(u, v)
    a, b = float(np.linalg.norm(xu)), float(np.linalg.norm(xv))
    if min(a, b) <= COLLAPSED_TANGENT * max(a, b):
        return 0.0  # `surface_normal` takes the limit there, which keeps its digits
    lost = NORMAL_NOISE * EPS * (size + float(np.linalg.norm(x))) * float(np.linalg.norm(xuv))
    return min(lost / (a * b), 2.0)


def _inwards(surface: Surface, u: float, v: float) -> tuple[float, float]:
    """Parameters a little further inside the domain; a cone's domain is v >= 0."""
    u0, u1, v0, v1 = surface.domain
    if not np.isfinite([u0, u1, v0, v1]).all():
        return u, v + 1.0
    step = INWARD_STEP
    return u + step * (0.5 * (u0 + u1) - u), v + step * (0.5 * (v0 + v1) - v)


def make_charts(faces: Sequence[Face], edges: Sequence[Edge]) -> list[Chart]:
    """The charts of all faces with their coedges; a coedge's side is its sense in the loop."""
    charts = []
    for i, face in enumerate(faces):
        for surface in face.charts:
            chart = Chart(surface, i, limit=ATLAS_LIMIT if len(face.charts) > 1 else np.inf)
            for a in face.apexes:
                chart.coedges.append(_collapsed_side(a))
            for k, (j, orientation) in enumerate(face.loop):
                if not 0 <= j < len(edges):
                    raise BodyError(
                        f"Face {i} names edge {j}; there are {len(edges)} edges.", part=("face", i)
                    )
                curve = edges[j].curve
                pcurve = loop_pcurve(face, k, edges, surface)
                # a given pcurve's weight is not a depth: it only has to be positive
                given = len(face.pcurves) > 0 and face.pcurves[k] is not None
                rim = 0.0 if given else CHART_RIM
                spans = visible_spans(pcurve, curve.first, curve.last, rim)
                if len(face.charts) == 1 and spans != [(curve.first, curve.last)]:
                    raise BodyError(
                        f"Face {i} does not see the whole of edge {j} in its one gnomonic chart: "
                        "the face reaches past a hemisphere; give it an atlas of charts.",
                        part=("face", i),
                    )
                chart.coedges += [
                    Coedge(j, piece, first, last, orientation, k)
                    for a, b in spans
                    for piece, first, last in pcurve.pieces(a, b)
                ]
            if surface.periodic:
                _join_angles(chart, edges)
            in_one_period(chart)
            charts.append(chart)
    return charts


def _collapsed_side(apex: Apex) -> Coedge:
    """A coedge with the face on its left: u increases along v0 and decreases along v1."""
    from standoff.geometry.pcurves import Pcurve

    along, across = [1.0, 0.0, 0.0], [0.0, 0.0, apex.level]
    rows = [along, across] if apex.side[0] == "v" else [across, along]
    line = Pcurve(L.LINE, np.array([*rows, [0.0, 0.0, 1.0]]))
    side = 1 if apex.side in ("v0", "u1") else -1
    return Coedge(-1 - apex.vertex, line, apex.lo, apex.hi, side)


def _join_angles(chart: Chart, edges: Sequence[Edge]) -> None:
    """Shift pcurves on a surface whose u is an angle by whole turns, so that they meet in u.

    The pieces of one entry of the loop are shifted together.
    """
    placed: dict[int, float] = {}
    entries: dict[int, list[Coedge]] = {}
    for c in chart.coedges:
        if c.edge >= 0 and edges[c.edge].first is not None:
            entries.setdefault(c.entry, []).append(c)
    waiting = list(entries.values())
    while waiting:
        k = next((k for k, e in enumerate(waiting) if _ends(e, edges).keys() & placed.keys()), 0)
        entry = waiting.pop(k)
        for vertex, u in _ends(entry, edges).items():
            if vertex in placed:
                turns = float(np.round((placed[vertex] - u) / (2.0 * np.pi)))
                for c in entry:
                    c.pcurve = c.pcurve.turned(2.0 * np.pi * turns)
                break
        for vertex, u in _ends(entry, edges).items():
            placed.setdefault(vertex, u)


def _ends(entry: Sequence[Coedge], edges: Sequence[Edge]) -> dict[int, float]:
    """u at the vertices of an entry's coedges, which follow each other along their edge."""
    edge = edges[entry[0].edge]
    pairs = ((edge.first, entry[0], entry[0].first), (edge.last, entry[-1], entry[-1].last))
    return {vertex: c.pcurve.point(t)[0] for vertex, c, t in pairs if vertex is not None}


def visible_spans(
    pcurve: Pcurve, first: float, last: float, margin: float = CHART_RIM
) -> list[tuple[float, float]]:
    """The parameter ranges of a pcurve that its chart sees, with a small margin at its rim."""
    if pcurve.kind == L.BEZIER:
        return [(first, last)]
    if pcurve.kind == L.LINE:
        return _visible_line(pcurve, first, last, margin)
    a, b, c = pcurve.matrix[2]
    reach = float(np.hypot(a, b))
    if reach == 0.0 and c == 1.0:  # parameters of a plane, not of a gnomonic chart: no rim
        return [(first, last)]
    rim = margin * float(np.abs(pcurve.matrix).max()) - c
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


def _visible_line(
    pcurve: Pcurve, first: float, last: float, margin: float
) -> list[tuple[float, float]]:
    slope, level = float(pcurve.matrix[2, 0]), float(pcurve.matrix[2, 2])
    if slope == 0.0:
        return [(first, last)] if level > 0.0 else []
    rim = (margin * float(np.abs(pcurve.matrix).max()) - level) / slope
    first, last = (max(first, rim), last) if slope > 0.0 else (first, min(last, rim))
    return [(first, last)] if first < last else []
