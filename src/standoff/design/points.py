"""Points of boundaries at places, as answers name these: many at once, grouped by feature."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from standoff.bodies.boundary import Boundary
from standoff.bodies.features import Feature, charts_of
from standoff.errors import StandoffError
from standoff.kernels.body import layout as L
from standoff.kernels.entries import queries
from standoff.solids.planar.solid import PlanarSolid
from standoff.typing import Array, Ints

SURFACE_JET, CURVE_JET = 18, 9  # numbers of a row that the kernels write, the point first


class Group(NamedTuple):
    """Rows whose places are on one feature.

    Attributes
    ----------
    feature : int
        Its packed number: faces first, then edges, then vertices.
    chart : int
        Packed, of a face; else -1.
    rows : (m,) array of int
    parameters : (m, 2) array
    """

    feature: int
    chart: int
    rows: Ints
    parameters: Array


def group_of(
    body: Boundary | PlanarSolid,
    feature: Feature,
    parameters: Sequence[float],
    witness: Array | None = None,
) -> Group:
    """The group of a single place.

    Raises StandoffError: the boundary has no such feature, or no such chart of it.

    Parameters
    ----------
    body : Boundary or PlanarSolid
    feature, parameters
        As answers name them.
    witness : (3,) array, optional
        About where it is, body frame: tells the chart where the parameters do not (of solids).
    """
    counts = _counts(body)
    if not 0 <= feature.index < counts.get(feature.kind, 0):
        told = ", ".join(f"{count} of kind {kind}" for kind, count in counts.items())
        raise StandoffError(f"{body!r} has no {str(feature) or 'such feature'}: it has {told}.")
    before = list(counts).index(feature.kind)
    number = feature.index + sum(list(counts.values())[:before])
    given = np.array([(*parameters[:2], 0.0, 0.0)[:2]])
    alone = np.zeros(1, dtype=np.int64)
    if feature.kind != "face" or isinstance(body, PlanarSolid):
        return Group(number, -1, alone, given)
    first, charts = charts_of(body, feature.index)
    if len(parameters) > 2:
        chart = int(parameters[2])
        if not 0 <= chart < charts:
            raise StandoffError(f"{feature} of {body!r} has {charts} charts, and no chart {chart}.")
        return Group(number, first + chart, alone, given)
    each = [Group(number, first + k, alone, given) for k in range(charts)]
    if witness is None or charts == 1:
        return each[0]
    return min(each, key=lambda one: float(np.linalg.norm(points_of(body, one)[0] - witness)))


def groups_of(body: Boundary, modes: Array, parameters: Array) -> list[Group]:
    """The groups of n rows, without those that have no witness points.

    Parameters
    ----------
    body : Boundary
    modes : (n, 2) array
        Packed feature and chart, as the kernels write them; nan or negative: none.
    parameters : (n, 2) array
    """
    seen = np.flatnonzero(modes[:, 0] >= 0.0)
    features, charts = modes[seen].astype(np.int64).T
    charts = np.where(features < body.n_faces, charts, -1)
    keys, inverse = np.unique(features * (int(charts.max(initial=-1)) + 2) + charts, False, True)
    rows = np.split(np.argsort(inverse, kind="stable"), np.cumsum(np.bincount(inverse))[:-1])
    return [
        Group(int(features[at[0]]), int(charts[at[0]]), seen[at], parameters[seen[at]])
        for at, _ in zip(rows, keys, strict=False)
    ]


def points_of(body: Boundary | PlanarSolid, group: Group) -> Array:
    """The points (m, 3) of the core at a group's places, body frame."""
    if isinstance(body, PlanarSolid):
        return _planar_points(body, group)
    ints, reals = body.ints, body.reals
    if group.chart >= 0:
        at = L.chart_record(ints, group.chart)
        jets = np.empty((len(group.rows), SURFACE_JET))
        kind, first = int(ints[at + L.CHART_KIND]), int(ints[at + L.CHART_REALS])
        queries.surface_jets(reals, kind, first, group.parameters, jets)
        return jets[:, :3]
    if group.feature >= body.n_faces + body.n_edges:
        point = reals[int(ints[L.vertex_record(ints, group.feature)]) :][:3]
        return np.broadcast_to(point, (len(group.rows), 3))
    at = L.edge_record(ints, group.feature)
    kind, ts = int(ints[at + L.EDGE_KIND]), np.ascontiguousarray(group.parameters[:, 0])
    if kind == L.ON_SURFACE:
        return np.array([queries.edge_jet(ints, reals, group.feature, t)[0] for t in ts.tolist()])
    found = np.empty((len(ts), CURVE_JET))
    queries.curve_jets(reals, kind, int(ints[at + L.EDGE_REALS]) + L.CURVE_DATA, ts, found)
    return found[:, :3]


def _counts(body: Boundary | PlanarSolid) -> dict[str, int]:
    """How many features of each kind, in the order of their packed numbers."""
    if isinstance(body, PlanarSolid):
        return {"edge": len(body.edges), "vertex": len(body.edges)}
    return {"face": body.n_faces, "edge": body.n_edges, "vertex": body.n_vertices}


def _planar_points(body: PlanarSolid, group: Group) -> Array:
    edges = body.edges
    if group.feature < len(edges):
        ts = group.parameters[:, 0].tolist()
        return np.array([edges[group.feature].point(t) for t in ts])
    curves = [pair for loop in body.loops for pair in zip(loop.curves, loop.backward, strict=True)]
    curve, backward = curves[group.feature - len(edges)]
    return np.array([curve.point(curve.last if backward else curve.first)] * len(group.rows))
