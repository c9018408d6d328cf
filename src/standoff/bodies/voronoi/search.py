"""Search of a spatial body's whole boundary for its nearest point: faces, edges, vertices."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import scipy

from standoff.bodies.body import Body
from standoff.bodies.features import Feature
from standoff.bodies.tessellation import chart_box, chart_outline, chart_row
from standoff.bodies.voronoi.tolerances import FOOT_AT_REST, OFF_NORMAL
from standoff.errors import StandoffError
from standoff.geometry.curves import Curve
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import chart_normal, feature_jet, on_face
from standoff.kernels.tolerances import EPS
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array

# Samples along an edge, and along each side of a chart.
ALONG, GRID, COARSE_GRID, FEW_CHARTS = 65, 13, 5, 24
# Starts of a descent on one chart, its steps, and how often a step is halved.
STARTS, STEPS, HALVINGS = 2, 30, 12


class Candidate(NamedTuple):
    """A boundary point where the distance is stationary."""

    distance: float
    feature: Feature
    inside: bool


class _Samples(NamedTuple):
    """Points (n, 3) of one chart and their parameters (n, 2), the first `outer` on its outline;
    the box (2, 2) of low and high parameters within which a descent stays."""

    points: Array
    parameters: Array
    outer: int
    box: Array

    def starts(self, x: Array) -> list[Array]:
        """Parameters of the points nearest to x, on the outline and inside it: on a collapsed side
        all are equally near, and most do not lead to a minimum."""
        squares = ((self.points - x) ** 2).sum(axis=1)
        rim = np.argsort(squares[: self.outer])[:STARTS]
        within = self.outer + np.argsort(squares[self.outer :])[:STARTS]
        return [self.parameters[k].copy() for k in (*rim, *within)]


class SampledBoundary(KeepsReadOnly):
    """A body's boundary, sampled once; `nearest` refines from the samples."""

    def __init__(self, body: Body) -> None:
        self.body = body
        self.scale = body.size if body.bounded else 1.0
        charts = range(int(body.ints[L.N_CHARTS]))
        self.charts = [_sampled(body, chart, len(charts) <= FEW_CHARTS) for chart in charts]

    def nearest(self, x: Array) -> Feature:
        """The feature nearest to a point (3,) outside.

        Raises ValueError: the point lies inside.
        """
        found = [*self._vertices(x), *self._edges(x), *self._faces(x)]
        best = min(found, key=lambda c: c.distance)
        if best.inside and best.distance > EPS * self.scale:
            raise StandoffError(
                f"point = {x} lies {best.distance:.6g} inside {self.body!r}: regions of a spatial "
                "body are only defined outside.",
                "point",
                x,
            )
        return best.feature

    def _vertices(self, x: Array) -> list[Candidate]:
        distances = np.linalg.norm(self.body.vertex_points - x, axis=1).tolist()
        return [Candidate(d, Feature("vertex", k), False) for k, d in enumerate(distances)]

    def _edges(self, x: Array) -> list[Candidate]:
        found = []
        for j, edge in enumerate(self.body.edge_parts):
            row = int(self.body.ints[L.EDGES]) + L.EDGE_STRIDE * j
            if self.body.ints[row + L.EDGE_FLAGS] & L.SMOOTH:
                continue  # its faces meet there
            distances = _stationary(edge.curve, x)
            found += [Candidate(d, Feature("edge", j), False) for d in distances]
        return found

    def _faces(self, x: Array) -> list[Candidate]:
        found = []
        for chart, samples in enumerate(self.charts):
            if samples is None:
                continue
            face = int(chart_row(self.body, chart)[L.CHART_FACE])
            for start in samples.starts(x):
                distance, inside = self._descend(chart, face, start, samples.box, x)
                if distance < np.inf:
                    found.append(Candidate(distance, Feature("face", face), inside))
        return found

    def _descend(self, chart: int, face: int, q: Array, box: Array, x: Array) -> tuple[float, bool]:
        """(distance, is x inside) of a stationary point on the face; inf if there is none.

        Newton's method on |x - f(u, v)|²/2, with a Hessian shifted to be positive definite and
        steps halved until it decreases within the box: beyond an apex there is a second nappe.
        """
        ints, reals = self.body.ints, self.body.reals
        jet = np.array(feature_jet(ints, reals, face, chart, q[0], q[1]))
        energy = 0.5 * float((jet[0] - x) @ (jet[0] - x))
        for _ in range(STEPS):
            step = _newton(jet, x)
            for _ in range(HALVINGS):
                trial = np.clip(q + step, box[0], box[1])
                ahead = np.array(feature_jet(ints, reals, face, chart, trial[0], trial[1]))
                lower = 0.5 * float((ahead[0] - x) @ (ahead[0] - x))
                if lower <= energy * (1.0 + 4.0 * EPS):
                    break
                step = 0.5 * step
            else:
                break
            moved = float(np.linalg.norm(ahead[0] - jet[0]))
            q, jet, energy = trial, ahead, lower
            if moved <= FOOT_AT_REST * (self.scale + np.sqrt(2.0 * energy)):
                break
        if not on_face(ints, reals, chart, float(q[0]), float(q[1])):
            return np.inf, False
        way, normal = x - jet[0], np.array(chart_normal(ints, reals, chart, q[0], q[1]))
        distance = float(np.linalg.norm(way))
        off = float(np.linalg.norm(np.cross(way, normal)))
        if not normal.any() or off > OFF_NORMAL * distance + FOOT_AT_REST * self.scale:
            return np.inf, False
        return distance, bool(way @ normal < 0.0)


def _sampled(body: Body, chart: int, few: bool) -> _Samples | None:
    outline = chart_outline(body, chart)
    low, high = chart_box(body, chart, outline)
    count = GRID if few else COARSE_GRID
    shares = (np.arange(count) + 0.5) / count
    u, v = np.meshgrid(*(low[k] + shares * (high[k] - low[k]) for k in (0, 1)), indexing="ij")
    grid = np.column_stack([u.ravel(), v.ravel()])
    kept = [bool(on_face(body.ints, body.reals, chart, a, b)) for a, b in grid]
    spots = np.vstack([outline, grid[np.array(kept)]])
    if not len(spots):
        return None
    face = int(chart_row(body, chart)[L.CHART_FACE])
    points = [feature_jet(body.ints, body.reals, face, chart, a, b)[0] for a, b in spots]
    row = chart_row(body, chart)
    box = np.array([low, high])
    if row[L.CHART_PERIODIC]:
        box[:, 0] = -np.inf, np.inf
    if not row[L.CHART_N_COEDGES] or np.isfinite(body.reals[row[L.CHART_REALS] + L.LIMIT]):
        box = np.array([[-np.inf] * 2, [np.inf] * 2])
    return _Samples(np.array(points), spots, len(outline), box)


def _newton(jet: Array, x: Array) -> Array:
    """The step (2,) on |x - f|²/2 from a point's jet (6, 3)."""
    d = jet[0] - x
    gradient = jet[1:3] @ d
    metric = jet[1:3] @ jet[1:3].T
    second = np.array([[jet[3] @ d, jet[4] @ d], [jet[4] @ d, jet[5] @ d]])
    values, vectors = np.linalg.eigh(metric + second)
    # a direction in which the distance decreases both ways is treated as on a plane
    least = np.maximum(np.abs(values), EPS * float(np.abs(values).max(initial=0.0)))
    along = vectors.T @ gradient
    return np.asarray(-vectors @ np.where(least > 0.0, along / np.where(least > 0, least, 1.0), 0))


def _stationary(curve: Curve, x: Array) -> list[float]:
    """Distances of the places inside a curve where its distance to x has a minimum."""
    us = np.unique([np.linspace(a, b, ALONG) for a, b in pairwise(curve.spans())])

    def slope(t: float) -> float:
        y, tangent, _ = curve.jet(float(t))
        return float((y - x) @ tangent)

    slopes = np.array([slope(t) for t in us])
    found = []
    for i in np.flatnonzero((slopes[:-1] < 0.0) & (slopes[1:] >= 0.0)):
        t = us[i + 1]
        if slopes[i + 1] > 0.0:
            t = scipy.optimize.brentq(slope, us[i], us[i + 1], xtol=EPS, rtol=4.0 * EPS)
        found.append(float(np.linalg.norm(curve.point(float(t)) - x)))
    return found
