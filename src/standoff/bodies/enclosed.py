"""The volume that faces enclose, by the divergence theorem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from standoff.bodies.moments.cells import integrate
from standoff.bodies.moments.face_cells import face_cells
from standoff.bodies.moments.flux import AREA, COLUMNS, VOLUME, IntegralFrame
from standoff.bodies.packed_parts import PackedParts
from standoff.bodies.packing import Assembled
from standoff.bodies.tolerances import VOLUME_ROUNDINGS
from standoff.bodies.topology import Edge
from standoff.geometry.curves import Curve, Line
from standoff.typing import Array

EPS = float(np.finfo(float).eps)
# Gauss points for each span of a curve in a plane face.
SPAN_POINTS = 16
NOTHING = np.zeros((0, 3))
# About the greatest number of boundary points used for the volume of one shell.
MOST_NODES = 200_000


@dataclass(frozen=True)
class Enclosed:
    """What a shell encloses: its signed volume, length cubed, a bound on the error of that, and its
    area, length squared; of each face, where they are known, its area and how far that may be off.
    """

    volume: float
    error: float
    area: float
    areas: dict[int, tuple[float, float]] = field(default_factory=dict)

    @property
    def settled(self) -> float:
        """The volume; 0 where it is within its error of 0."""
        return self.volume if abs(self.volume) > self.error else 0.0


def enclosed_by(boundary: PackedParts, shell: Sequence[int], tolerance: float) -> Enclosed:
    """What the faces of a shell enclose, refined to the relative `tolerance`."""
    points = _points(boundary.vertex_points, [e.curve for e in boundary.edge_parts])
    charts = [chart for i in shell for chart in boundary.face_parts[i].charts]
    reaches = [chart.farthest() or float(np.linalg.norm(chart.shift)) for chart in charts]
    centre = points.mean(axis=0) if len(points) else charts[0].shift
    away = np.linalg.norm(points - centre, axis=1).max(initial=0.0)
    reach = float(away) or max(reaches)
    frame = IntegralFrame(centre, reach, 0.0)
    cells = [replace(cell, owner=i) for i in shell for cell in face_cells(boundary, i, frame)]

    def scale(values: Array) -> Array:
        sizes = np.full(COLUMNS, np.inf)
        sizes[VOLUME] = max(abs(float(values[VOLUME])), EPS)
        return sizes

    found = integrate(cells, scale, tolerance, MOST_NODES)
    rounding = VOLUME_ROUNDINGS * EPS * float(found.magnitude[VOLUME])
    return Enclosed(
        float(found.values[VOLUME]) * reach**3,
        (float(found.remainder[VOLUME]) + rounding) * reach**3,
        float(found.values[AREA]) * reach**2,
        {
            i: (float(a[AREA]) * reach**2, float(b[AREA]) * reach**2)
            for i, (a, b) in found.of.items()
        },
    )


def all_flat(parts: Assembled, shell: Sequence[int]) -> bool:
    """Are all faces of a shell planes, judged by their kind?"""
    return all(chart.flat for i in shell for chart in parts.faces[i].charts)


def enclosed_by_planes(parts: Assembled, shell: Sequence[int]) -> Enclosed:
    """The same for plane faces, from their edges only: exact up to rounding for straight ones."""
    points = _points(parts.vertices, [e.curve for e in parts.edges])
    centre = points.mean(axis=0)
    within = {c.edge for chart in parts.charts if chart.face in shell for c in chart.coedges}
    areas = {j: _swept(parts.edges[j].curve, centre) for j in within}
    volume = size = area = 0.0
    for chart in parts.charts:
        if chart.face in shell:
            own = sum((c.side * chart.outward * areas[c.edge] for c in chart.coedges), np.zeros(3))
            first = parts.edges[chart.coedges[0].edge].curve
            part = float((first.point(first.first) - centre) @ own) / 3.0
            volume, size = volume + part, size + abs(part)
            area += float(np.linalg.norm(own))
    reach = float(np.linalg.norm(points - centre, axis=1).max())
    rounding = VOLUME_ROUNDINGS * EPS * (size + area * reach)
    return Enclosed(volume, rounding, area)


def outward_right(edges: Sequence[Edge]) -> list[bool]:
    """For every edge of closed loops in z = 0, with two edges at each vertex, whether outside is on
    its right: where it follows its loop counterclockwise, so that the area is positive.
    """
    right = [False] * len(edges)
    waiting = set(range(len(edges)))
    while waiting:
        chain = _chain(edges, waiting)
        waiting -= {j for j, _ in chain}
        middle = np.mean([p for j, _ in chain for p in _points(NOTHING, [edges[j].curve])], axis=0)
        area = sum(sense * _swept(edges[j].curve, middle)[2] for j, sense in chain)
        for j, sense in chain:
            right[j] = bool(sense * area > 0.0)
    return right


def _chain(edges: Sequence[Edge], waiting: set[int]) -> list[tuple[int, int]]:
    """(edge, sense) along a loop of the edges that are waiting, from the first of them."""
    chain = [(min(waiting), 1)]
    left = waiting - {chain[0][0]}
    at = edges[chain[0][0]].last
    while at is not None:
        j = next((k for k in sorted(left) if at in (edges[k].first, edges[k].last)), None)
        if j is None:
            break
        left.discard(j)
        sense = 1 if edges[j].first == at else -1
        chain.append((j, sense))
        at = edges[j].last if sense > 0 else edges[j].first
    return chain


def _points(vertices: Array, curves: Sequence[Curve]) -> Array:
    """Points of a boundary: its vertices, and three on each edge."""
    spots = [c.point(t) for c in curves for t in np.linspace(c.first, c.last, 4)[:-1]]
    return np.vstack([vertices, np.reshape(spots, (-1, 3))])


def _swept(curve: Curve, centre: Array) -> Array:
    """The vector area swept by the segment from a point to a curve, ½ ∫ (x - c) × x_t dt."""
    if isinstance(curve, Line):
        first, last = (curve.point(t) - centre for t in (curve.first, curve.last))
        return 0.5 * np.cross(first, last)
    nodes, weights = np.polynomial.legendre.leggauss(SPAN_POINTS)
    total = np.zeros(3)
    for a, b in pairwise(curve.spans()):
        for node, weight in zip(nodes, weights, strict=True):
            x, slope, _ = curve.jet(float(0.5 * (a + b + node * (b - a))))
            total += 0.25 * (b - a) * weight * np.cross(x - centre, slope)
    return total
