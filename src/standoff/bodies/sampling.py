"""Points on a packed body's boundary: starts for cold queries, its box, a check of convexity; and
rectangles inside its faces."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np

from standoff.bodies.packing import Assembled, Chart, Sample
from standoff.bodies.topology import Edge
from standoff.errors import BodyError
from standoff.geometry.curves import ConicArc, Curve, Line, RationalBezier
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import (
    chart_normal,
    inner_box,
    on_face,
    planar_edge_normal,
)
from standoff.kernels.tolerances import RECHART
from standoff.typing import Array, Ints

# About how many samples a body gets: a cold start compares all pairs of two bodies' samples.
FACE_BUDGET = 120
EDGE_BUDGET = 60
VERTEX_BUDGET = 120
# Samples that estimate the box of a curve whose kind does not provide one.
CURVE_SAMPLES = 65


def _parameter_box(chart: Chart) -> tuple[float, float, float, float]:
    if chart.limit < np.inf:
        return -1.0, 1.0, -1.0, 1.0
    points = np.array(
        [c.pcurve.point(t)[:2] for c in chart.coedges for t in np.linspace(c.first, c.last, 25)]
    )
    if not len(points):
        return 0.0, 0.0, 0.0, 0.0
    low, high = points.min(axis=0), points.max(axis=0)
    return float(low[0]), float(high[0]), float(low[1]), float(high[1])


def blind_charts(body: Assembled, ints: Ints, reals: Array) -> list[int]:
    """Charts of a trimmed face's atlas that see no edge and lie off the face.

    A chart without edges is entirely on the face or off it. Which it is, is decided at its centre
    in another chart of the face that sees an edge and that point.
    """
    found = []
    for k, chart in enumerate(body.charts):
        if chart.coedges or not body.faces[chart.face].loop:
            continue
        centre = chart.surface.jet(0.0, 0.0)[0]
        for m, other in enumerate(body.charts):
            if other.face != chart.face or not other.coedges:
                continue
            y = other.surface.canonical(centre) + np.array([0.0, 0.0, 1.0])
            if y[2] <= 0.5:
                continue
            if not on_face(ints, reals, m, float(y[0] / y[2]), float(y[1] / y[2])):
                found.append(k)
            break
    return found


def stride(features: int, budget: int) -> int:
    """Every how many-th feature of a kind is sampled."""
    return max(1, -(-features // budget))


def first_grid(charts: int, budget: int = FACE_BUDGET) -> int:
    """Points along either parameter of a chart."""
    return int(np.clip(np.sqrt(budget / charts), 1, 6))


def second_grid(first: int) -> int:
    """Points along either parameter of a chart of which the first grid has missed the face."""
    return 3 * first + 2


def along_each(edges: int, budget: int = EDGE_BUDGET) -> Array:
    """Shares of an edge's parameter where it is sampled."""
    n = int(np.clip(budget / edges, 1, 12))
    return np.asarray((np.arange(n) + 0.5) / n)


def face_samples(body: Assembled, ints: Ints, reals: Array, budget: int) -> list[Sample]:
    """Grid points over the charts that lie on their faces."""
    if not body.charts:
        return []
    n = first_grid(len(body.charts), budget)
    samples = []
    for k in range(0, len(body.charts), stride(len(body.charts), budget)):
        chart = body.charts[k]
        u0, u1, v0, v1 = _parameter_box(chart)
        nu = 2 * n if chart.surface.periodic else n
        kept = 0
        for count in (n, second_grid(n)):  # a slender face may miss the first grid
            if kept:
                break
            for a in (np.arange(nu if count == n else count) + 0.5) / (nu if count == n else count):
                for b in (np.arange(count) + 0.5) / count:
                    u, v = float(u0 + a * (u1 - u0)), float(v0 + b * (v1 - v0))
                    if not on_face(ints, reals, k, u, v):
                        continue
                    kept += 1
                    x = chart.surface.jet(u, v)[0]
                    normal = np.array(chart_normal(ints, reals, k, u, v))
                    samples.append(Sample(x, normal, chart.face, k, u, v))
    return samples


def edge_samples(body: Assembled, ints: Ints, reals: Array, budget: int) -> list[Sample]:
    if not body.edges:
        return []
    samples = []
    shares = along_each(len(body.edges), budget)
    for j in range(0, len(body.edges), stride(len(body.edges), budget)):
        edge = body.edges[j]
        feature = len(body.faces) + j
        for s in shares:
            c = edge.curve
            t = float(c.first + s * (c.last - c.first))
            normal = np.zeros(3)
            if body.dimension == 2:
                normal = np.array(planar_edge_normal(ints, reals, feature, t))
            samples.append(Sample(c.point(t), normal, feature, -1, t, 0.0))
    return samples


def vertex_samples(body: Assembled, budget: int) -> list[Sample]:
    base = len(body.faces) + len(body.edges)
    return [
        Sample(body.vertices[k], np.zeros(3), base + k, -1, 0.0, 0.0)
        for k in range(0, len(body.vertices), stride(len(body.vertices), budget))
    ]


def boundary_samples(body: Assembled, ints: Ints, reals: Array) -> list[Sample]:
    """Points on every kind of feature; each kind's budget is shared among its features."""
    return (
        face_samples(body, ints, reals, FACE_BUDGET)
        + edge_samples(body, ints, reals, EDGE_BUDGET)
        + vertex_samples(body, VERTEX_BUDGET)
    )


def curve_box(edge: Edge) -> tuple[Array, Array]:
    """(low, high) of a box around an edge: exact for lines and conic arcs, else a bound; estimated
    from samples for a curve whose kind does not provide a box."""
    from standoff.geometry.hulls import tight_box

    c = edge.curve
    if isinstance(c, RationalBezier):
        return tight_box(c.data[1:].reshape(-1, 4).T[None, ..., None])
    box = c.box()
    if box is not None:
        return box
    if not isinstance(c, Line | ConicArc):
        return _sampled_box(c)
    ends = [c.point(c.first), c.point(c.last)]
    if isinstance(c, ConicArc):
        basis = c.basis()
        for i in range(3):
            angle = np.arctan2(basis[i, 1], basis[i, 0])
            for t in (angle, angle + np.pi):
                t = c.first + (t - c.first) % (2.0 * np.pi)
                if t <= c.last:
                    ends.append(c.point(t))
    return np.min(ends, axis=0), np.max(ends, axis=0)


def _sampled_box(curve: Curve) -> tuple[Array, Array]:
    """Around the samples of a curve, with a margin for its bend between them."""
    ts = np.linspace(curve.first, curve.last, CURVE_SAMPLES)
    jets = [curve.jet(float(t)) for t in ts]
    points = np.array([jet[0] for jet in jets])
    bend = np.max([np.abs(jet[2]) for jet in jets], axis=0)
    margin = 0.5 * bend * ((curve.last - curve.first) / (CURVE_SAMPLES - 1)) ** 2
    return points.min(axis=0) - margin, points.max(axis=0) + margin


def body_box(body: Assembled, ints: Ints, reals: Array) -> tuple[Array, Array] | None:
    """(low, high) around the core; None for an unbounded body.

    On a convex face, n.x is greatest at the surface's support point if that lies on the face, or
    else on the face's boundary.
    """
    lows, highs = [], []
    boxed = {c.edge for chart in body.charts if chart.surface.box() for c in chart.coedges}
    for j, edge in enumerate(body.edges):
        if j in boxed:
            continue
        low, high = curve_box(edge)
        lows.append(low)
        highs.append(high)
    if len(body.vertices):
        lows.append(body.vertices.min(axis=0))
        highs.append(body.vertices.max(axis=0))
    for k, chart in enumerate(body.charts):
        if not chart.coedges and chart.limit == np.inf:
            return None
        box = chart.surface.box()
        if box is not None:
            lows.append(box[0])
            highs.append(box[1])
            continue
        for direction in (*np.eye(3), *-np.eye(3)):
            top = chart.surface.highest(direction)
            if top is None or max(abs(top[0]), abs(top[1])) > chart.limit:
                continue
            if on_face(ints, reals, k, *top):
                x = chart.surface.jet(*top)[0]
                lows.append(x)
                highs.append(x)
    return np.min(lows, axis=0), np.max(highs, axis=0)


def check_convex(samples: Sequence[Sample], size: float, allowed: float) -> float:
    """Greatest height of a sample above another's tangent plane; raises above `allowed`, length.

    It detects what no single patch, edge or vertex shows.
    """
    points = np.array([s.point for s in samples])
    faces = [s for s in samples if s.normal.any()]
    if not faces or not len(points):
        return 0.0
    normals = np.array([s.normal for s in faces])
    heights = (
        normals @ points.T
        - np.einsum("ij,ij->i", normals, np.array([s.point for s in faces]))[:, None]
    )
    i, j = (int(k) for k in np.unravel_index(int(heights.argmax()), heights.shape))
    worst = float(heights[i, j])
    if worst > allowed:
        raise BodyError(
            f"Not convex: the point {points[j]} (feature {samples[j].feature}) lies {worst:.3g} "
            f"above the tangent plane at {faces[i].point} (feature {faces[i].feature}); size "
            f"{size:.3g}. Split the body into convex parts.",
        )
    return worst


def inner_boxes(body: Assembled, ints: Ints, reals: Array) -> list[tuple[float, ...]]:
    """Rectangles (u0, u1, v0, v1) of parameters where a frame need not check the boundary: one of
    each chart, u0 > u1 where none was found.

    In a chart of an atlas, only as far as a witness point stays in that chart. None is sought in a
    face with holes, because it could contain a hole.
    """
    faces = [chart.face for chart in body.charts]
    shared = {face for face, n in Counter(faces).items() if n > 1}
    return [
        L.NO_INNER
        if body.charts[k].holed
        else inner_box(ints, reals, k, RECHART if face in shared else math.inf)
        for k, face in enumerate(faces)
    ]


__all__ = ["body_box", "boundary_samples", "check_convex", "inner_boxes"]
