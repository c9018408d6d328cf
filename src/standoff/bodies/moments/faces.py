"""Cells of a trimmed face with one chart: Green's theorem along its trimming curves.

∬ F du dv over the inside of a loop is ∮ -Q du with Q(u, v) = ∫ F(u, s) ds from a fixed v0 to v. Q
is an integral too, so a trimming curve gives a rectangle: its own parameter, and v from v0 to the
curve. Lines of constant u, like the seams of a band that goes once around, give nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby, pairwise
from typing import TypeVar

import numpy as np
import scipy

from standoff.bodies.moments.cells import Integrand, MomentCell
from standoff.bodies.moments.flux import IntegralFrame, flux, offset_areas
from standoff.bodies.moments.tolerances import LEVEL_CURVE
from standoff.bodies.packed_parts import PackedParts
from standoff.bodies.tessellation import chart_row, surface_of
from standoff.errors import StandoffError
from standoff.geometry.surfaces import Surface
from standoff.geometry.vectors import crosses
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import coedge_places, surface_jets
from standoff.typing import Array

# Points of a trimming curve between which it crosses a line of constant u or v at most once.
SAMPLES = 65
# Near a coordinate plane a superellipsoid varies as powers of a parameter. Where these are not even
# integers, the parameter is replaced by a power that makes them at least this, so that few nodes
# suffice.
SMOOTH_POWER = 6.0

Value = TypeVar("Value")


@dataclass(frozen=True, eq=False)
class MomentChart:
    """A chart of a body and the frame of integration."""

    body: PackedParts
    number: int
    frame: IntegralFrame

    def flux(self, u: Array, v: Array) -> Array:
        """The integrand of `flux` times du dv: (..., columns) for u and v of the same shape."""
        return _surface_flux(self.frame, self.jets(np.stack([u, v], axis=-1)), self.outward)

    def jets(self, parameters: Array) -> Array:
        """The surface's jets (..., 6, 3) at parameters (..., 2)."""
        row = chart_row(self.body, self.number)
        kind, at = int(row[L.CHART_KIND]), int(row[L.CHART_REALS])
        jets = np.empty((parameters.size // 2, 18))
        surface_jets(self.body.reals, kind, at, parameters.reshape(-1, 2), jets)
        return jets.reshape(*parameters.shape[:-1], 6, 3)

    @cached_property
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


def _surface_flux(frame: IntegralFrame, jets: Array, outward: float | Array) -> Array:
    """The integrand of `flux` times du dv for jets (..., 6, 3) and signs (...) of x_u × x_v."""
    x, xu, xv, xuu, xuv, xvv = (jets[..., k, :] for k in range(6))
    areas = outward * crosses(xu, xv)
    if frame.radius > 0.0:
        slopes = (
            outward * (crosses(xuu, xv) + crosses(xu, xuv)),
            outward * (crosses(xuv, xv) + crosses(xu, xvv)),
        )
        normals, moved = offset_areas((xu, xv), areas, slopes, frame.radius)
        x, areas = x + frame.radius * normals, outward * moved
    return flux(frame, x, areas)


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


def chart_cells(chart: MomentChart) -> list[MomentCell]:
    """The cells of a face with a single chart."""
    curves = [TrimmingCurve(chart.body, k) for k in chart.coedges]
    samples = [curve.samples() for curve in curves]
    start = _start(samples)
    breaks = chart.surface.analytic_breaks()
    strips, cells = Strips(chart.frame), []
    for curve, (u, v, du, _) in zip(curves, samples, strict=True):
        if np.abs(du).max() == 0.0 or (np.abs(v - start).max() == 0.0):
            continue
        for first, last in pairwise(_cuts(curve, u, v, breaks)):
            level = float(curve.parameters(np.array([0.5 * (first + last)]))[1, 0])
            for low, high in _layers(start, level, breaks[1]):
                strip = Strip(chart, curve, low, high)
                cells.append(MomentCell(strips, (first, 0.0), (last, 1.0), piece=strip))
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
        if not len(breaks[axis]):
            continue
        away = values[:, None] - breaks[axis]
        for k, m in np.argwhere(away[:-1] * away[1:] < 0.0):

            def miss(t: float, axis: int = axis, level: float = breaks[axis][m]) -> float:
                return float(curve.parameters(np.array([t]))[axis, 0] - level)

            cuts.append(float(scipy.optimize.brentq(miss, times[k], times[k + 1])))
        cuts += times[1:-1][(away[1:-1] == 0.0).any(axis=1)].tolist()
    return [float(t) for t in np.unique(cuts)]


def _layers(start: float, level: float, breaks: Array) -> Iterator[tuple[float, float]]:
    """The range of v from the start to a trimming curve near a level, cut at breaks: (from, to),
    where to is nan for the curve itself."""
    between = breaks[(breaks > min(start, level)) & (breaks < max(start, level))]
    stops = [start, *(between if level > start else between[::-1])]
    yield from ((float(a), float(b)) for a, b in pairwise(stops))
    yield float(stops[-1]), np.nan


@dataclass(frozen=True, eq=False)
class Strip:
    """What lies between low and a trimming curve, or high unless it is nan."""

    chart: MomentChart
    curve: TrimmingCurve
    low: float
    high: float


@dataclass(frozen=True)
class Strips:
    """The integrand over strips of any faces, all at once."""

    frame: IntegralFrame

    def __call__(self, strips: Sequence[Strip], t: Array, s: Array) -> Array:
        rows = [(a.low, a.high, a.curve.side, a.chart.outward) for a in strips]
        low, high, side, outward = np.array(rows).T[..., None]
        runs = _runs([strip.curve for strip in strips])
        places = [c.parameters(t[k].ravel()).reshape(4, -1, t.shape[1]) for c, k in runs]
        u, v, du, _ = np.concatenate(places, axis=1)
        width = np.where(np.isnan(high), v, high) - low
        across = low[..., None] + width[..., None] * s[:, None]
        uv = np.stack([np.broadcast_to(u[..., None], across.shape), across], axis=-1)
        jets = np.concatenate([c.jets(uv[k]) for c, k in _runs([strip.chart for strip in strips])])
        inner = _surface_flux(self.frame, jets, outward[..., None, None])
        return np.asarray((-side * du * width)[..., None, None] * inner)


def _runs(values: Sequence[Value]) -> Iterator[tuple[Value, slice]]:
    """Values that follow each other, and where they are."""
    first = 0
    for value, run in groupby(values):
        last = first + sum(1 for _ in run)
        yield value, slice(first, last)
        first = last


def superellipsoid_cells(charts: list[MomentChart], loop: bool) -> list[MomentCell]:
    """The cells of a superellipsoid's face that has several charts: all of it, or an octant.

    The charts' squares |u|, |v| <= 1 tile it. They are cut along the coordinate planes, where the
    surface varies as powers of u and v, and into triangles at their centres, where it varies as
    powers of both.

    Raises StandoffError: a face with edges other than those of an octant.
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
        MomentCell(_triangle(chart, su, sv, swap))
        for chart in charts
        for su in signs
        for sv in signs
        for swap in (False, True)
    ]


def _is_octant(chart: MomentChart) -> bool:
    """Do a chart's trimming curves run along u = 0 and v = 0, with the face at u, v >= 0?"""
    for k in chart.coedges:
        u, v = TrimmingCurve(chart.body, k).samples()[:2]
        if (
            min(np.abs(u).max(), np.abs(v).max()) > LEVEL_CURVE
            or min(u.min(), v.min()) < -LEVEL_CURVE
        ):
            return False
    return len(chart.coedges) > 0


def _triangle(chart: MomentChart, su: float, sv: float, swap: bool) -> Integrand:
    """Half of the square [0, su] x [0, sv], in parameters (r, w): (r, r w), or (r w, r)."""

    powers = [m for m in chart.surface.data[:2] if m % 2.0 != 0.0]
    p = max(float(np.ceil(SMOOTH_POWER / (1.0 + min(powers, default=SMOOTH_POWER)))), 1.0)

    def values(_: Sequence[None], t: Array, s: Array) -> Array:
        t, s = t[:, :, None], s[:, None, :]
        r, w = t**p, s**p
        rate = p * t ** (p - 1.0) * p * s ** (p - 1.0) * r
        near = r * w
        far = np.broadcast_to(r, near.shape)
        u, v = (near, far) if swap else (far, near)
        return np.asarray(rate[..., None] * chart.flux(su * u, sv * v))

    return values
