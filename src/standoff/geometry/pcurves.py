"""Trimming curves in (u, v), found exactly from a curve and the surface that carries it.

A pcurve has its edge's parameter. Homogeneous (u, v) is P (t, 0, 1) or P (cos t, sin t, 1): in a
plane an affine image of the curve, in a gnomonic chart its central projection (every section of a
sphere is a conic there), on a cylinder or cone the angle or the generator.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import brentq

from standoff.geometry.curves import ConicArc, Curve, Line, fill_curve
from standoff.geometry.surfaces import Cone, Cylinder, Plane, Sphere, Surface
from standoff.geometry.validation import Array, finite
from standoff.kernels import layout as L
from standoff.kernels.jets import pcurve_jet
from standoff.kernels.tolerances import MAX_DEGREE

# A piece of a NURBS pcurve turns by less than this (radians): 180 degrees with a margin.
MOST_TURN = 0.9 * np.pi
TURN_POINTS = 65
# Curvature below this part of the greatest (dimensionless) is roundoff of a straight piece.
STRAIGHT = 1e-11


@dataclass(frozen=True, eq=False)
class Pcurve:
    """kind LINE or CONIC, and its 3x3 matrix."""

    kind: int
    matrix: Array

    @property
    def data(self) -> Array:
        """What the kernels read."""
        return self.matrix.ravel()

    def homogeneous(self, t: float) -> tuple[Array, Array, Array]:
        """(h, h_t, h_tt), each (3,): homogeneous (u, v) and its derivatives."""
        h, ht, htt = pcurve_jet(self.data, self.kind, 0, t)
        return np.array(h), np.array(ht), np.array(htt)

    def point(self, t: float) -> tuple[float, float, float]:
        """(u, v, depth): depth > 0 where the chart sees the point, else u and v are nan."""
        h = self.homogeneous(t)[0]
        if h[2] <= 0.0:
            return np.nan, np.nan, float(h[2])
        return float(h[0] / h[2]), float(h[1] / h[2]), float(h[2])

    def pieces(self, first: float, last: float) -> list[tuple[Pcurve, float, float]]:
        """(pcurve, first, last) of the parts that a straight line meets at most twice."""
        return [(self, first, last)]


class BezierPcurve(Pcurve):
    """A rational Bezier curve of (u, v) over [first, last]: points (n + 1, 3), (w u, w v, w)."""

    first: float
    last: float

    def __init__(self, points: Array, first: float, last: float) -> None:
        object.__setattr__(self, "kind", L.BEZIER)
        object.__setattr__(self, "matrix", np.asarray(points, dtype=np.float64))
        object.__setattr__(self, "first", float(first))
        object.__setattr__(self, "last", float(last))

    @property
    def data(self) -> Array:
        return np.concatenate([[len(self.matrix) - 1.0], self.matrix.ravel()])

    def homogeneous(self, t: float) -> tuple[Array, Array, Array]:
        block = np.concatenate([[self.first, self.last], self.data])
        h, ht, htt = pcurve_jet(block, self.kind, 2, t)
        return np.array(h), np.array(ht), np.array(htt)


class NurbsPcurve(Pcurve):
    """A NURBS of (u, v) whose parameter is its edge's.

    Parameters
    ----------
    control_points : (n, 2) array, surface parameters
    knots : (n + degree + 1,) array, edge parameter; clamped or not, uneven allowed
    weights : (n,) array, positive; default 1

    Raises
    ------
    ValueError
        Counts that disagree, unsorted knots, weights that are not positive, numbers not finite.
    """

    spans: list[BezierPcurve]

    def __init__(self, control_points: Any, knots: Any, weights: Any = None) -> None:
        points = finite(control_points, "control_points", (-1, 2))
        w = finite(np.ones(len(points)) if weights is None else weights, "weights", (len(points),))
        t = finite(knots, "knots", (-1,))
        degree = len(t) - len(points) - 1
        if not 1 <= degree <= MAX_DEGREE or len(points) <= degree:
            raise ValueError(
                f"NURBS pcurve with {len(points)} control points and {len(t)} knots: degree "
                f"{degree}; give n points and n + degree + 1 knots, degree 1 to {MAX_DEGREE}."
            )
        if (np.diff(t) < 0.0).any():
            raise ValueError(f"NURBS pcurve with unsorted knots {t}.")
        if (w <= 0.0).any():
            raise ValueError(f"NURBS pcurve weights must be positive: {w}")
        object.__setattr__(self, "kind", L.BEZIER)
        object.__setattr__(self, "matrix", np.column_stack([points * w[:, None], w]))
        object.__setattr__(self, "spans", _bezier_spans(self.matrix, t, degree))

    def homogeneous(self, t: float) -> tuple[Array, Array, Array]:
        return next((s for s in self.spans if t <= s.last), self.spans[-1]).homogeneous(t)

    def pieces(self, first: float, last: float) -> list[tuple[Pcurve, float, float]]:
        found: list[tuple[Pcurve, float, float]] = []
        for span in self.spans:
            a = max(first, span.first)
            b = min(last, span.last)
            if a < b:
                found += [(p, p.first, p.last) for p in _turning_pieces(_part(span, a, b))]
        return found


def _bezier_spans(points: Array, knots: Array, degree: int) -> list[BezierPcurve]:
    spline = BSpline(knots, points, degree)
    first, last = knots[degree], knots[len(points)]
    for knot in np.unique(knots[(knots >= first) & (knots <= last)]):
        missing = degree - int((spline.t == knot).sum())
        if missing > 0:
            spline = spline.insert_knot(knot, missing)
    breaks = np.unique(spline.t[(spline.t >= first) & (spline.t <= last)])
    spans = []
    for a, b in pairwise(breaks):
        start = int(np.searchsorted(spline.t, a, side="right")) - 1 - degree
        spans.append(BezierPcurve(spline.c[start : start + degree + 1], a, b))
    return spans


def _part(span: BezierPcurve, a: float, b: float) -> BezierPcurve:
    """The part of a Bezier span over [a, b], by de Casteljau."""
    first, last = span.first, span.last
    points = span.matrix
    if b < last:
        points = _split(points, (b - first) / (last - first))[0]
    if a > first:
        points = _split(points, (a - first) / (b - first))[1]
    return BezierPcurve(points, a, b)


def _split(points: Array, s: float) -> tuple[Array, Array]:
    left, right = [points[0]], [points[-1]]
    while len(points) > 1:
        points = (1.0 - s) * points[:-1] + s * points[1:]
        left.append(points[0])
        right.append(points[-1])
    return np.array(left), np.array(right[::-1])


def _turning_pieces(piece: BezierPcurve) -> list[BezierPcurve]:
    """Cut at inflections, then until each part turns by less than 180 degrees."""
    first, last = piece.first, piece.last

    def bend(t: float) -> float:
        return float(np.linalg.det(np.array(piece.homogeneous(t))))

    ts = np.linspace(first, last, 16 * len(piece.matrix))
    bends = np.array([bend(t) for t in ts])
    bends[np.abs(bends) <= STRAIGHT * np.abs(bends).max(initial=0.0)] = 0.0
    cuts = [
        float(brentq(bend, ts[k], ts[k + 1], xtol=1e-15))
        for k in range(len(ts) - 1)
        if bends[k] * bends[k + 1] < 0.0
    ]
    parts = [_part(piece, a, b) for a, b in pairwise([first, *cuts, last]) if a < b]
    return [q for p in parts for q in _halved(p)]


def _halved(piece: BezierPcurve) -> list[BezierPcurve]:
    first, last = piece.first, piece.last
    total, before = 0.0, None
    for t in np.linspace(first, last, TURN_POINTS):
        h, ht, _ = piece.homogeneous(float(t))
        way = (ht[:2] - ht[2] * h[:2] / h[2]) / h[2]
        angle = float(np.arctan2(way[1], way[0]))
        if before is not None:
            total += abs((angle - before + np.pi) % (2.0 * np.pi) - np.pi)
        before = angle
    if total < MOST_TURN:
        return [piece]
    middle = 0.5 * (first + last)
    return [*_halved(_part(piece, first, middle)), *_halved(_part(piece, middle, last))]


def pcurve_of(curve: Curve, surface: Surface) -> Pcurve:
    """The trimming curve of an edge on a surface, exact.

    Raises
    ------
    ValueError
        The kinds do not meet in a line or conic of (u, v).
    """
    if isinstance(curve, SurfaceCurve):
        found = curve.pcurve_on(surface)
        if found is not None:
            return found
    if not isinstance(curve, Line | ConicArc):
        raise ValueError(
            f"{type(curve).__name__} has no exact pcurve on this "
            f"{type(surface).__name__}: give it in Face.pcurves, or use Line or ConicArc."
        )
    offset = np.outer(surface.shift, [0.0, 0.0, 1.0])
    basis = np.asarray(np.linalg.inv(surface.linear) @ (curve.basis() - offset), dtype=np.float64)
    if isinstance(surface, Plane):
        return Pcurve(curve.kind, np.vstack([basis[:2], [0.0, 0.0, 1.0]]))
    if isinstance(surface, Sphere):
        return Pcurve(curve.kind, basis)
    if isinstance(surface, Cylinder | Cone):
        return _round_pcurve(curve, surface, basis)
    raise ValueError(f"No pcurve rule for {type(surface).__name__}.")


def _round_pcurve(curve: Curve, surface: Surface, basis: Array) -> Pcurve:
    if isinstance(curve, Line):
        middle = basis @ np.array([0.5 * (curve.first + curve.last), 0.0, 1.0])
        angle = float(np.arctan2(middle[1], middle[0]))
        matrix = np.array([[0.0, 0.0, angle], [basis[2, 0], 0.0, basis[2, 2]], [0.0, 0.0, 1.0]])
        return Pcurve(L.LINE, matrix)
    a, b = basis[:2, 0], basis[:2, 1]
    radius = np.linalg.norm(a)
    height = basis[2, 2]
    level = np.abs(basis[2, :2]).max() <= 1e-12 * max(1.0, abs(height))
    round_ = abs(a @ b) <= 1e-12 * radius**2 and abs(np.linalg.norm(b) - radius) <= 1e-12 * radius
    centred = np.linalg.norm(basis[:2, 2]) <= 1e-12 * radius
    if not (level and round_ and centred):
        raise ValueError(
            f"On a {type(surface).__name__} only sections square to its axis and generators have "
            "a line as pcurve; this conic arc is neither."
        )
    turn = 1.0 if a[0] * b[1] - a[1] * b[0] > 0.0 else -1.0
    phase = float(np.arctan2(a[1], a[0]))
    return Pcurve(L.LINE, np.array([[turn, 0.0, phase], [0.0, 0.0, height], [0.0, 0.0, 1.0]]))


class SurfaceCurve(Curve):
    """The image of a pcurve on a surface, t from first to last: exact on every kind of surface.

    Its packed edge has no data: kernels evaluate the pcurve on the chart of the edge's first
    coedge, so one of the edge's two faces must have this surface as a chart.

    Parameters
    ----------
    surface, pcurve : a chart, and the trimming curve in it
    first, last : float
    others : the same curve in other charts: pairs (surface, pcurve). A point is taken from the
        chart that sees it most centrally.
    """

    kind = L.ON_SURFACE
    surface: Surface
    pcurve: Pcurve
    others: tuple[tuple[Surface, Pcurve], ...]

    def __init__(
        self,
        surface: Surface,
        pcurve: Pcurve,
        first: float,
        last: float,
        others: Sequence[tuple[Surface, Pcurve]] = (),
    ) -> None:
        if not first < last:
            raise ValueError(f"SurfaceCurve from t = {first} to {last}: give first < last.")
        object.__setattr__(self, "surface", surface)
        object.__setattr__(self, "pcurve", pcurve)
        object.__setattr__(self, "others", tuple(others))
        fill_curve(self, np.zeros(0), first, last)

    @staticmethod
    def isoline(surface: Surface, *, u: Any = None, v: Any = None) -> SurfaceCurve:
        """The curve u = const (v its parameter) or v = const over the surface's domain."""
        u0, u1, v0, v1 = surface.domain
        if u is not None:
            matrix = np.array([[0.0, 0.0, u], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
            return SurfaceCurve(surface, Pcurve(L.LINE, matrix), v0, v1)
        matrix = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, v], [0.0, 0.0, 1.0]])
        return SurfaceCurve(surface, Pcurve(L.LINE, matrix), u0, u1)

    def jet(self, t: float) -> tuple[Array, Array, Array]:
        surface, (h, ht, htt) = self._central(t)
        p = h[:2] / h[2]
        pt = (ht[:2] - p * ht[2]) / h[2]
        ptt = (htt[:2] - 2.0 * pt * ht[2] - p * htt[2]) / h[2]
        x, xu, xv, xuu, xuv, xvv = surface.jet(float(p[0]), float(p[1]))
        xtt = pt[0] ** 2 * xuu + 2.0 * pt[0] * pt[1] * xuv + pt[1] ** 2 * xvv
        return x, pt[0] * xu + pt[1] * xv, xtt + ptt[0] * xu + ptt[1] * xv

    @property
    def closed(self) -> bool:
        """Once round a surface whose u is an angle."""
        if not self.surface.periodic:
            return False
        turn = abs(self.pcurve.point(self.last)[0] - self.pcurve.point(self.first)[0])
        return bool(abs(turn - 2.0 * np.pi) <= 1e-14 * turn)

    def _central(self, t: float) -> tuple[Surface, tuple[Array, Array, Array]]:
        """The surface that sees the point at t most centrally, and the pcurve there."""
        seen = [(s, p.homogeneous(t)) for s, p in ((self.surface, self.pcurve), *self.others)]
        if len(seen) == 1:
            return seen[0]
        return max(seen, key=lambda one: one[1][0][2] / np.abs(one[1][0]).max())

    def pcurve_on(self, surface: Surface) -> Pcurve | None:
        """The trimming curve on a surface that the curve was made on, else None."""
        for s, p in ((self.surface, self.pcurve), *self.others):
            if s.kind == surface.kind and np.array_equal(s.reals, surface.reals):
                return p
        return None

    def transformed(self, linear: Array, shift: Array) -> Curve:
        return SurfaceCurve(
            self.surface.transformed(linear, shift),
            self.pcurve,
            self.first,
            self.last,
            [(s.transformed(linear, shift), p) for s, p in self.others],
        )
