"""Packing: the writer of the two flat arrays that ``kernels.body.layout`` describes.

It goes part by part. Of polyhedra, ``bodies.hulls.packed`` writes the same arrays all at once.
"""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from standoff.bodies.topology import Apex, Edge, Face
from standoff.errors import BodyError
from standoff.geometry.surfaces import Surface
from standoff.kernels.body import layout as L
from standoff.typing import Array, Ints

if TYPE_CHECKING:
    from standoff.geometry.pcurves import Pcurve


@dataclass
class Coedge:
    """One side of an edge in one chart, or an apex's collapsed side (edge = -1 - vertex).

    entry : the number of its edge in the face's loop.
    """

    edge: int
    pcurve: Pcurve
    first: float
    last: float
    side: int
    entry: int = -1


@dataclass
class Chart:
    """A surface with its trimming loops; `holed` if one loop may lie inside another. `period` is
    where the one of an angle u begins in which they lie; None where that does not matter."""

    surface: Surface
    face: int
    outward: float = 1.0
    limit: float = np.inf
    coedges: list[Coedge] = field(default_factory=list)
    holed: bool = False
    period: float | None = None


@dataclass
class Sector:
    """Directions of a face at a vertex that edges alone do not bound (see layout)."""

    chart: int
    kind: int
    u: float
    v: float
    lo: float
    hi: float


@dataclass
class Assembled:
    """A body's boundary with orientations, ready to pack.

    What is not known yet about edges and vertices is False or empty. `reflex` holds the layout's
    flags REFLEX and MIXED for each edge.
    """

    dimension: int
    vertices: Array
    edges: Sequence[Edge]
    faces: Sequence[Face]
    charts: list[Chart]
    smooth: list[bool] = field(default_factory=list)
    outward_right: list[bool] = field(default_factory=list)
    sectors: list[list[Sector]] = field(default_factory=list)
    cones: list[list[Array]] = field(default_factory=list)
    reflex: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        edges, vertices = len(self.edges), len(self.vertices)
        self.smooth = self.smooth or [False] * edges
        self.outward_right = self.outward_right or [False] * edges
        self.reflex = self.reflex or [0] * edges
        self.sectors = self.sectors or [[] for _ in range(vertices)]
        self.cones = self.cones or [[] for _ in range(vertices)]

    @property
    def moved(self) -> float:
        """How far the boundary may lie from the given one because knots were removed, length."""
        surfaces = [chart.surface.moved for chart in self.charts]
        return max([0.0, *surfaces, *(edge.curve.moved for edge in self.edges)])


def without_charts(body: Assembled, dropped: Sequence[int]) -> Assembled:
    """The body without some charts; the sectors' chart numbers are adjusted."""
    kept = [k for k in range(len(body.charts)) if k not in dropped]
    number = {old: new for new, old in enumerate(kept)}
    sectors = [[replace(s, chart=number[s.chart]) for s in row] for row in body.sectors]
    return replace(body, charts=[body.charts[k] for k in kept], sectors=sectors)


@dataclass
class Sample:
    """A boundary point where a cold start may begin."""

    point: Array
    normal: Array
    feature: int
    chart: int
    u: float
    v: float


class PartCounts(NamedTuple):
    """How many parts a body has."""

    dimension: int
    faces: int
    edges: int
    vertices: int
    charts: int
    samples: int


class ArrayWriter:
    """Appends to the two arrays; every table's offset is known when it is written."""

    def __init__(self) -> None:
        self.ints = array("q", [0] * L.INT_HEADER)
        self.reals = array("d", [0.0] * L.REAL_HEADER)

    def real_block(self, values: Sequence[float] | Array) -> int:
        offset = len(self.reals)
        self.reals.frombytes(np.asarray(values, dtype=np.float64).tobytes())
        return offset

    def int_block(self, values: Sequence[int] | Ints) -> int:
        offset = len(self.ints)
        self.ints.frombytes(np.asarray(values, dtype=np.int64).tobytes())
        return offset

    def table(self, header: int, rows: Sequence[Sequence[int]] | Ints) -> None:
        self.ints[header] = self.int_block(np.asarray(rows, dtype=np.int64).ravel())

    def arrays(self) -> tuple[Ints, Array]:
        ints = np.array(self.ints, dtype=np.int64)
        reals = np.array(self.reals, dtype=np.float64)
        ints.flags.writeable = False
        reals.flags.writeable = False
        return ints, reals


def pack(
    body: Assembled,
    samples: Sequence[Sample],
    box: tuple[Array, Array] | None,
    radius: float,
    slack: float,
    inner: Sequence[Sequence[float]] | None = None,
) -> tuple[Ints, Array]:
    """The (ints, reals) of a body. `box` is (low, high) of its core, None if it is unbounded;
    `inner` are its charts' rectangles of parameters (``inner_boxes``), None while not known.
    """
    w = ArrayWriter()
    counts = (len(part) for part in (body.faces, body.edges, body.vertices, body.charts, samples))
    put_header(w, PartCounts(body.dimension, *counts), box, radius, slack)
    _pack_faces(w, body, inner)
    _pack_edges(w, body)
    _pack_vertices(w, body)
    put_samples(w, samples)
    return w.arrays()


def put_header(
    w: ArrayWriter, counts: PartCounts, box: tuple[Array, Array] | None, radius: float, slack: float
) -> None:
    """Write how many parts there are, and the body's size and place."""
    w.ints[L.DIMENSION] = counts.dimension
    w.ints[L.N_FACES] = counts.faces
    w.ints[L.N_EDGES] = counts.edges
    w.ints[L.N_VERTICES] = counts.vertices
    w.ints[L.N_CHARTS] = counts.charts
    w.ints[L.N_SAMPLES] = counts.samples
    w.ints[L.UNBOUNDED] = int(box is None)
    w.reals[L.RADIUS] = radius
    w.reals[L.SLACK] = slack
    if box is not None:
        low, high = box
        w.reals[L.SIZE] = float(np.linalg.norm(high - low))
        w.reals[L.BOX_CENTRE : L.BOX_CENTRE + 3] = array("d", 0.5 * (low + high))
        w.reals[L.OFFSET] = float(np.linalg.norm(0.5 * (low + high)))
        w.reals[L.BOX_HALF : L.BOX_HALF + 3] = array("d", 0.5 * (high - low))


def put_samples(w: ArrayWriter, samples: Sequence[Sample]) -> None:
    """Write the samples, which come last."""
    w.table(L.SAMPLES, [(s.feature, s.chart) for s in samples])
    w.ints[L.SAMPLE_REALS] = len(w.reals)
    for s in samples:
        w.real_block([*s.point, *s.normal, s.u, s.v])


def _pack_faces(w: ArrayWriter, body: Assembled, inner: Sequence[Sequence[float]] | None) -> None:
    owned: list[list[int]] = [[] for _ in body.faces]
    for k, chart in enumerate(body.charts):
        owned[chart.face].append(k)
    face_rows = [(own[0], len(own)) for own in owned]
    w.table(L.FACES, face_rows)
    chart_rows: list[tuple[int, ...]] = []
    coedge_rows: list[tuple[int, ...]] = []
    for k, chart in enumerate(body.charts):
        reals = chart.surface.reals.copy()
        reals[L.OUTWARD] = chart.outward
        reals[L.LIMIT] = chart.limit
        if inner is not None:
            reals[L.INNER : L.INNER + 4] = inner[k]
        offset = w.real_block(reals)
        periodic = int(chart.surface.periodic)
        if chart.period is not None:
            periodic = w.real_block([chart.period])
        chart_rows.append(
            (
                chart.surface.kind,
                offset,
                len(coedge_rows),
                len(chart.coedges),
                chart.face,
                periodic,
            )
        )
        for c in chart.coedges:
            block = w.real_block([c.first, c.last, *c.pcurve.data])
            coedge_rows.append((c.edge, c.pcurve.kind, block, c.side, k))
    w.table(L.CHARTS, chart_rows)
    w.table(L.COEDGES, coedge_rows)


def _coedges_of_edges(body: Assembled) -> list[list[int]]:
    """For every edge the first coedge of each face (each chart of an atlas has one more).

    A curve on a surface is evaluated on its first coedge, so there that surface's comes first.
    """
    found: list[dict[int, int]] = [{} for _ in body.edges]
    own: list[set[int]] = [set() for _ in body.edges]
    number = 0
    for chart in body.charts:
        for c in chart.coedges:
            if c.edge >= 0:
                found[c.edge].setdefault(chart.face, number)
                curve = body.edges[c.edge].curve
                if curve.kind == L.ON_SURFACE and curve.pcurve_on(chart.surface):
                    own[c.edge].add(chart.face)
            number += 1
    for j, edge in enumerate(body.edges):
        if edge.curve.kind == L.ON_SURFACE and not own[j]:
            raise BodyError(
                f"Edge {j} is a curve on a surface that none of its faces has as a chart.",
                part=("edge", j),
            )
    return [
        [faces[f] for f in sorted(faces, key=lambda f: f not in own[j])]
        for j, faces in enumerate(found)
    ]


def _pack_edges(w: ArrayWriter, body: Assembled) -> None:
    rows = []
    coedges_of = _coedges_of_edges(body)
    for j, edge in enumerate(body.edges):
        curve = edge.curve
        offset = w.real_block([curve.first, curve.last, *curve.data])
        flags = (
            (L.CLOSED if curve.closed else 0)
            | (L.SMOOTH if body.smooth[j] else 0)
            | (L.OUTWARD_RIGHT if body.outward_right[j] else 0)
            | (L.CREASED if edge.creased else 0)
            | body.reflex[j]
        )
        coedges = [*coedges_of[j], -1, -1][:2]
        first = -1 if edge.first is None else edge.first
        last = -1 if edge.last is None else edge.last
        rows.append((curve.kind, offset, flags, first, last, *coedges))
    w.table(L.EDGES, rows)


def _pack_vertices(w: ArrayWriter, body: Assembled) -> None:
    n = len(body.vertices)
    w.ints[L.VERTICES] = len(w.ints)
    start = len(w.ints)
    w.int_block([0] * (L.VERTEX_STRIDE * n))
    fans: list[list[tuple[int, int]]] = [[] for _ in range(n)]
    for j, edge in enumerate(body.edges):
        for end, vertex in enumerate((edge.first, edge.last)):
            if vertex is not None:
                fans[vertex].append((j, end))
    for k, point in enumerate(body.vertices):
        fan = fans[k]
        row = start + L.VERTEX_STRIDE * k
        w.ints[row + L.VERTEX_REALS] = w.real_block(point)
        w.ints[row + L.VERTEX_FAN] = len(w.ints)
        w.ints[row + L.VERTEX_N_FAN] = len(fan)
        for entry in fan:
            w.ints.extend(entry)
        w.ints[row + L.VERTEX_SECTORS] = len(w.ints)
        w.ints[row + L.VERTEX_N_SECTORS] = len(body.sectors[k])
        for s in body.sectors[k]:
            w.ints.extend((s.chart, w.real_block([float(s.kind), s.u, s.v, s.lo, s.hi])))
        cone = body.cones[k]
        w.ints[row + L.VERTEX_CONE] = w.real_block(np.concatenate(cone) if cone else [])
        w.ints[row + L.VERTEX_N_CONE] = len(cone)


__all__ = ["Apex", "Assembled", "Chart", "Coedge", "Sample", "Sector", "pack"]
