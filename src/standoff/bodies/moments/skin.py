"""Cells of what a swept ball adds: canals along a core's edges, parts of spheres at its vertices.

The outward normals of a core at a point of an edge form an arc from one face's normal to the
other's; at a vertex they form a part of the unit sphere whose boundary consists of the arcs of its
edges and of the normals along its collapsed sides.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.polynomial.chebyshev import Chebyshev

from standoff.bodies.charts import surface_normal
from standoff.bodies.moments.cells import MomentCell
from standoff.bodies.moments.directions import BoundaryArc, OverSphere, part_cells, sphere_cells
from standoff.bodies.moments.faces import MomentChart, TrimmingCurve
from standoff.bodies.moments.flux import IntegralFrame, flux
from standoff.bodies.moments.tolerances import NORMALS_RESOLVED
from standoff.bodies.packed_parts import PackedParts
from standoff.bodies.support_sets import curve_breaks
from standoff.bodies.tessellation import chart_row
from standoff.errors import StandoffError
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import coedge_conormal
from standoff.typing import Array

# A normal shorter than this is not a unit vector: its chart has collapsed there.
HALF = 0.5
# Degrees of the polynomials that interpolate the normals along a collapsed side.
DEGREES = (8, 16, 32, 64, 128)


@dataclass(frozen=True, eq=False)
class Fan:
    """The normals along an edge: first (n, 3), rotated about the tangents (n, 3) by turns (n,),
    radians, from the face on the left to the face on the right."""

    first: Array
    tangents: Array
    turns: Array

    def at(self, shares: Array) -> Array:
        """(n, k, 3): the normals at fractions (k,) or (n, k) of the turns."""
        angles = (self.turns[:, None] * shares)[..., None]
        aside = np.cross(self.tangents, self.first)
        return np.asarray(np.cos(angles) * self.first[:, None] + np.sin(angles) * aside[:, None])


def skin_cells(body: PackedParts, frame: IntegralFrame) -> list[MomentCell]:
    """The cells of canals and parts of spheres of a body with a swept radius."""
    if body.n_vertices == 1 and not body.n_edges and not body.n_faces:
        return sphere_cells(_ball(frame, body.vertex_points[0]))
    cells = [cell for edge in range(body.n_edges) for cell in _canal_cells(body, edge, frame)]
    return cells + [
        cell for vertex in range(body.n_vertices) for cell in _vertex_cells(body, vertex, frame)
    ]


def _edge_row(body: PackedParts, edge: int) -> int:
    return int(body.ints[L.EDGES]) + L.EDGE_STRIDE * edge


def _sides(body: PackedParts, edge: int) -> tuple[int, int] | None:
    """The coedges left and right of an edge, seen from outside; None if it has no faces."""
    row = _edge_row(body, edge)
    pair = [int(k) for k in body.ints[row + L.EDGE_COEDGE_0 : row + L.EDGE_COEDGE_1 + 1]]
    if min(pair) < 0:
        return None
    curve = TrimmingCurve(body, pair[0])
    left = curve.side * _outward(body, int(body.ints[curve.row + L.COEDGE_CHART])) > 0.0
    return (pair[0], pair[1]) if left else (pair[1], pair[0])


def _outward(body: PackedParts, chart: int) -> float:
    return float(body.reals[int(chart_row(body, chart)[L.CHART_REALS]) + L.OUTWARD])


def _has_fan(body: PackedParts, edge: int) -> bool:
    """Is there an arc of normals along an edge? Not if its faces have the same normals, or if it is
    the seam of one face."""
    row = _edge_row(body, edge)
    one, other = (int(body.ints[row + k]) for k in (L.EDGE_COEDGE_0, L.EDGE_COEDGE_1))
    if body.ints[row + L.EDGE_FLAGS] & L.CREASED or (one >= 0 and other < 0):
        return False
    return other >= 0 or not body.n_faces


def fan(body: PackedParts, edge: int, times: Array) -> tuple[Fan, Array, Array, Array]:
    """(normals, x, x_t, x_tt) of an edge at its parameters (n,)."""
    jets = np.array([body.edge_parts[edge].curve.jet(float(t)) for t in times])
    x, xt, xtt = np.moveaxis(jets, 1, 0)
    tangents = xt / np.linalg.norm(xt, axis=1)[:, None]
    sides = _sides(body, edge)
    if sides is None:  # a segment: normals all around
        axis = np.eye(3)[int(np.abs(tangents[0]).argmin())]
        first = np.cross(tangents, axis)
        first = first / np.linalg.norm(first, axis=1)[:, None]
        return Fan(first, tangents, np.full(len(times), 2.0 * np.pi)), x, xt, xtt
    left, right = (
        np.array([_normal(body, k, d, float(t)) for d, t in zip(tangents, times, strict=True)])
        for k in sides
    )
    left = left - (left * tangents).sum(axis=1)[:, None] * tangents
    left = left / np.linalg.norm(left, axis=1)[:, None]
    aside = np.cross(tangents, left)
    turns = np.arctan2((aside * right).sum(axis=1), (left * right).sum(axis=1))
    return Fan(left, tangents, turns), x, xt, xtt


def _normal(body: PackedParts, coedge: int, tangent: Array, t: float) -> Array:
    """Outward normal of a coedge's face at its edge's parameter; its limit at a collapsed side."""
    normal = np.array(coedge_conormal(body.ints, body.reals, coedge, tuple(tangent.tolist()), t)[1])
    if float(np.linalg.norm(normal)) > HALF:
        return normal
    curve = TrimmingCurve(body, coedge)
    number = int(body.ints[curve.row + L.COEDGE_CHART])
    u, v = curve.parameters(np.array([t]))[:2, 0]
    surface = MomentChart(body, number, IntegralFrame(np.zeros(3), 1.0, 0.0)).surface
    return _outward(body, number) * surface_normal(surface, float(u), float(v))


def _canal_cells(body: PackedParts, edge: int, frame: IntegralFrame) -> list[MomentCell]:
    """The canal along an edge: x + r n with area vectors r (|x_t| - r n · x_tt / |x_t|) n dt dα."""
    if not _has_fan(body, edge):
        return []

    def values(_: Sequence[None], t: Array, s: Array) -> Array:
        normals, x, xt, xtt = fan(body, edge, t.ravel())
        n = normals.at(np.repeat(s, t.shape[1], axis=0))
        speed = np.linalg.norm(xt, axis=1)[:, None]
        rise = (n * xtt[:, None]).sum(axis=2)
        areas = frame.radius * (speed - frame.radius * rise / speed) * normals.turns[:, None]
        found = flux(frame, x[:, None] + frame.radius * n, areas[..., None] * n)
        return found.reshape(*t.shape, s.shape[1], -1)

    ends = curve_breaks(body.edge_parts[edge].curve)
    return [MomentCell(values, (float(a), 0.0), (float(b), 1.0)) for a, b in pairwise(ends)]


def _ball(frame: IntegralFrame, point: Array) -> OverSphere:
    def values(n: Array) -> Array:
        return flux(frame, point + frame.radius * n, frame.radius**2 * n)

    return values


def _vertex_cells(body: PackedParts, vertex: int, frame: IntegralFrame) -> list[MomentCell]:
    """The part of a sphere about a vertex.

    All its normals make at most 90 degrees with the direction from a point inside the core to the
    vertex. The triangles start at that direction, whose opposite is therefore not a normal.
    """
    point = body.vertex_points[vertex]
    arcs = []
    for edge, part in enumerate(body.edge_parts):
        for end, number in ((part.curve.first, part.first), (part.curve.last, part.last)):
            if number == vertex and _has_fan(body, edge):
                sign = -1 if end == part.curve.first else 1
                arcs.append(BoundaryArc(_turning(body, edge, end), 0.0, 1.0, sign))
    for number in range(int(body.ints[L.N_CHARTS])):
        chart = MomentChart(body, number, frame)
        arcs += [arc for k in chart.coedges for arc in _collapsed_arcs(chart, k, vertex)]
    away = point - frame.centre
    start = away / float(np.linalg.norm(away))
    return part_cells(arcs, start, _ball(frame, point))


def _turning(body: PackedParts, edge: int, end: float) -> Callable[[Array], tuple[Array, Array]]:
    """The arc of normals at an edge's end, parametrised by the fraction of its turn."""
    normals = fan(body, edge, np.array([end]))[0]

    def piece(s: Array) -> tuple[Array, Array]:
        n = normals.at(s)[0]
        return n, normals.turns[0] * np.cross(normals.tangents[0], n)

    return piece


def _collapsed_arcs(chart: MomentChart, coedge: int, vertex: int) -> list[BoundaryArc]:
    """The normals along a collapsed side, if it is at the vertex."""
    curve = TrimmingCurve(chart.body, coedge)
    if curve.edge != -1 - vertex:
        return []
    first, last = curve.ends
    u = curve.parameters(np.array([first, last]))[0]
    axis = 0 if u[0] != u[1] else 1
    inner = chart.surface.analytic_breaks()[axis]
    cuts = [first, *(float(b) for b in np.sort(inner) if first < b < last), last]
    # the vertex's normals lie on the other side of the curve than the face's
    sense = -int(curve.side * _outward(chart.body, chart.number))
    return [BoundaryArc(_followed(chart, curve, a, b), a, b, sense) for a, b in pairwise(cuts)]


def _followed(
    chart: MomentChart, curve: TrimmingCurve, first: float, last: float
) -> Callable[[Array], tuple[Array, Array]]:
    """Normals along a collapsed side and their derivatives, by polynomial interpolation."""
    surface, outward = chart.surface, _outward(chart.body, chart.number)

    def normal(t: float) -> Array:
        u, v = curve.parameters(np.array([t]))[:2, 0]
        return outward * surface_normal(surface, float(u), float(v))

    for degree in DEGREES:
        nodes = np.polynomial.chebyshev.chebpts1(degree + 1)
        times = first + 0.5 * (last - first) * (nodes + 1.0)
        rows = np.array([normal(float(t)) for t in times])
        fits = [Chebyshev.fit(times, rows[:, k], degree, domain=[first, last]) for k in range(3)]
        tail = max(float(np.abs(f.coef[-2:]).max()) for f in fits)
        if tail <= NORMALS_RESOLVED:
            break
    else:
        raise StandoffError(
            f"The normals along the side collapsed to vertex {-1 - curve.edge} vary too fast (the "
            f"last of {degree} terms is {tail:.2g}) for the moments of the swept ball there.",
            "body",
            chart.body,
        )
    slopes = [f.deriv() for f in fits]

    def piece(t: Array) -> tuple[Array, Array]:
        n = np.column_stack([f(t) for f in fits])
        dn = np.column_stack([f(t) for f in slopes])
        return n, dn

    return piece


__all__ = ["skin_cells"]
