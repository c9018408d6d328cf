"""Cells of a trimmed face with one chart: Green's theorem along its trimming curves.

∬ F du dv over the inside of a loop is ∮ -Q du with Q(u, v) = ∫ F(u, s) ds from a fixed v0 to v. Q
is an integral too, so a trimming curve gives a rectangle: its own parameter, and v from v0 to the
curve. Lines of constant u, like the seams of a band that goes once around, give nothing.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from standoff.bodies.moments.cells import Cell, Integrand
from standoff.bodies.moments.flux import Frame, flux, offset_areas
from standoff.bodies.moments.tolerances import LEVEL_CURVE
from standoff.bodies.packed_parts import PackedParts
from standoff.bodies.tessellation import chart_row, surface_of
from standoff.errors import StandoffError
from standoff.geometry.surfaces import Surface
from standoff.geometry.validation import Array
from standoff.geometry.vectors import crosses
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import coedge_places, surface_jets

# Points of a trimming curve between which it crosses a line of constant u or v at most once.
SAMPLES = 65
# Near a coordinate plane a superellipsoid varies as powers of a parameter. Where these are not even
# integers, the parameter is replaced by a power that makes them at least this, so that few nodes
# suffice.
SMOOTH_POWER = 6.0


@dataclass(frozen=True, eq=False)
class Chart:
    """A chart of a body and the frame of integration."""

    body: PackedParts
    number: int
    frame: Frame

    def flux(self, u: Array, v: Array) -> Array:
        """The integrand of `flux` times du dv: (..., columns) for u and v of the same shape."""
        reals, row = self.body.reals, chart_row(self.body, self.number)
        kind, at = int(row[L.CHART_KIND]), int(row[L.CHART_REALS])
        jets = np.empty((u.size, 18))
        surface_jets(reals, kind, at, np.column_stack([u.ravel(), v.ravel()]), jets)
        jets = jets.reshape(*u.shape, 6, 3)
        x, xu, xv, xuu, xuv, xvv = (jets[..., k, :] for k in range(6))
        outward, radius = float(reals[at + L.OUTWARD]), self.frame.radius
        areas = outward * crosses(xu, xv)
        if radius > 0.0:
            slopes = (
                outward * (crosses(xuu, xv) + crosses(xu, xuv)),
                outward * (crosses(xuv, xv) + crosses(xu, xvv)),
            )
            normals, moved = offset_areas((xu, xv), areas, slopes, radius)
            x, areas = x + radius * normals, outward * moved
        return flux(self.frame, x, areas)

    @property
    def outward(self) -> float:
        """+1 if x_u × x_v points outward, else -1."""
        row = chart_row(self.body, self.number)
        return float(self.body.reals[int(row[L.CHART_REALS]) + L.OUTWARD])

    @property
    def surface(self) -> Surface:
        row = chart_row(self.body, self.number)
        return surface_of(self.body, self.body.face_parts[row[L.CHART_FACE]].charts, self.number)

    @property
    def coedges(self) -> range:
        row = chart_row(self.body, self.number)
        first = int(row[L.CHART_COEDGE])
        return range(first, first + int(row[L.CHART_N_COEDGES]))


@dataclass(frozen=True, eq=False)
class TrimmingCurve:
    """A coedge: (u, v) as functions of its edge's parameter, from first to last; the face is on its
    left if side is 1, on its right if it is -1."""

    body: PackedParts
    coedge: int

    @property
    def row(self) -> int:
        return int(self.body.ints[L.COEDGES]) + L.COEDGE_STRIDE * self.coedge

    @property
    def ends(self) -> tuple[float, float]:
        at = int(self.body.ints[self.row + L.COEDGE_REALS])
        first, last = self.body.reals[at : at + 2].tolist()
        return first, last

    @property
    def side(self) -> int:
        return int(self.body.ints[self.row + L.COEDGE_SIDE])

    @property
    def edge(self) -> int:
        """Number of the edge; -1 - vertex for a collapsed side."""
        return int(self.body.ints[self.row + L.COEDGE_EDGE])

    def parameters(self, t: Array) -> Array:
        """(4, n): u, v, u_t, v_t at parameters (n,)."""
        found = np.empty((len(t), 4))
        coedge_places(self.body.ints, self.body.reals, self.coedge, np.ascontiguousarray(t), found)
        return found.T

    def samples(self) -> Array:
        return self.parameters(np.linspace(*self.ends, SAMPLES))


def chart_cells(chart: Chart) -> list[Cell]:
    """The cells of a face with a single chart."""
    curves = [TrimmingCurve(chart.body, k) for k in chart.coedges]
    samples = [curve.samples() for curve in curves]
    start = _start(samples)
    breaks = chart.surface.analytic_breaks()
    cells = []
    for curve, (u, v, du, _) in zip(curves, samples, strict=True):
        if np.abs(du).max() == 0.0 or (np.abs(v - start).max() == 0.0):
            continue
        for first, last in pairwise(_cuts(curve, u, v, breaks)):
            level = float(curve.parameters(np.array([0.5 * (first + last)]))[1, 0])
            for low, high in _layers(start, level, breaks[1]):
                strip = _strip(chart, curve, low, high)
                cells.append(Cell(strip, (first, 0.0), (last, 1.0)))
    return cells


def _start(samples: list[Array]) -> float:
    """v0: that of a trimming curve of constant v, which then gives nothing, else the middle."""
    level = [v[0] for _, v, du, _ in samples if np.ptp(v) == 0.0 and np.abs(du).max() > 0.0]
    every = np.concatenate([v for _, v, _, _ in samples])
    return float(min(level)) if level else float(0.5 * (every.min() + every.max()))


def _cuts(curve: TrimmingCurve, u: Array, v: Array, breaks: tuple[Array, Array]) -> list[float]:
    """Ends of the pieces of a trimming curve that do not cross a break."""
    first, last = curve.ends
    times = np.linspace(first, last, SAMPLES)
    cuts = [first, last]
    for axis, values in enumerate((u, v)):
        away = values[:, None] - breaks[axis]
        for k, m in np.argwhere(away[:-1] * away[1:] < 0.0):

            def miss(t: float, axis: int = axis, level: float = breaks[axis][m]) -> float:
                return float(curve.parameters(np.array([t]))[axis, 0] - level)

            cuts.append(float(scipy.optimize.brentq(miss, times[k], times[k + 1])))
        cuts += times[1:-1][(away[1:-1] == 0.0).any(axis=1)].tolist()
    return [float(t) for t in np.unique(cuts)]


def _layers(start: float, level: float, breaks: Array) -> Iterator[tuple[float, float | None]]:
    """The range of v from the start to a trimming curve near a level, cut at breaks: (from, to),
    where to is None for the curve itself."""
    between = breaks[(breaks > min(start, level)) & (breaks < max(start, level))]
    stops = [start, *(between if level > start else between[::-1])]
    yield from ((float(a), float(b)) for a, b in pairwise(stops))
    yield float(stops[-1]), None


def _strip(chart: Chart, curve: TrimmingCurve, low: float, high: float | None) -> Integrand:
    def values(t: Array, s: Array) -> Array:
        u, v, du, _ = curve.parameters(t)
        width = (v if high is None else np.full_like(v, high)) - low
        inner = chart.flux(np.repeat(u[:, None], len(s), axis=1), low + np.outer(width, s))
        return np.asarray(-curve.side * (du * width)[:, None, None] * inner)

    return values


def superellipsoid_cells(charts: list[Chart], loop: bool) -> list[Cell]:
    """The cells of a superellipsoid's face that has several charts: all of it, or an octant.

    The charts' squares |u|, |v| <= 1 tile it. They are cut along the coordinate planes, where the
    surface varies as powers of u and v, and into triangles at their centres, where it varies as
    powers of both.

    Raises
    ------
    StandoffError
        A face with edges other than those of an octant.
    """
    signs: tuple[float, ...] = (1.0, -1.0)
    if loop:
        if not all(_is_octant(chart) for chart in charts):
            raise StandoffError(
                "A face of a superellipsoid with several charts, unless it is whole or an octant, "
                "cannot be integrated: give each part one chart, or give mass, centre and inertia "
                "yourself (so.simulation.MassProperties.of).",
                "body",
                charts[0].body,
            )
        signs = (1.0,)
    return [
        Cell(_triangle(chart, su, sv, swap))
        for chart in charts
        for su in signs
        for sv in signs
        for swap in (False, True)
    ]


def _is_octant(chart: Chart) -> bool:
    """Do a chart's trimming curves run along u = 0 and v = 0, with the face at u, v >= 0?"""
    for k in chart.coedges:
        u, v = TrimmingCurve(chart.body, k).samples()[:2]
        if (
            min(np.abs(u).max(), np.abs(v).max()) > LEVEL_CURVE
            or min(u.min(), v.min()) < -LEVEL_CURVE
        ):
            return False
    return len(chart.coedges) > 0


def _triangle(chart: Chart, su: float, sv: float, swap: bool) -> Integrand:
    """Half of the square [0, su] x [0, sv], in parameters (r, w): (r, r w), or (r w, r)."""

    powers = [m for m in chart.surface.data[:2] if m % 2.0 != 0.0]
    p = max(float(np.ceil(SMOOTH_POWER / (1.0 + min(powers, default=SMOOTH_POWER)))), 1.0)

    def values(t: Array, s: Array) -> Array:
        r, w = t[:, None] ** p, s[None, :] ** p
        rate = p * t[:, None] ** (p - 1.0) * p * s[None, :] ** (p - 1.0) * r
        far, near = np.broadcast_to(r, (len(t), len(s))), r * w
        u, v = (near, far) if swap else (far, near)
        return np.asarray(rate[..., None] * chart.flux(su * u, sv * v))

    return values
