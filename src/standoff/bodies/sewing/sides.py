"""The sides of patches: isolines in space, with projection onto them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from standoff.bodies.tolerances import PROJECTION_STEP
from standoff.geometry.surfaces import Surface
from standoff.geometry.validation import inside
from standoff.typing import Array

# Counterclockwise in (u, v), and for each, +1 if its free parameter increases in that direction.
SIDE_NAMES = ("v0", "u1", "v1", "u0")
SENSES = {"v0": 1, "u1": 1, "v1": -1, "u0": -1}
# Points of the polyline from which a projection starts.
POLYLINE_POINTS = 17
# A link that is a larger fraction of the polyline's length is halved, at most this often: with a
# very uneven parametrisation, as from weights of a ratio of 1e6, uniform parameters are all close
# together in space.
LONGEST_LINK = 0.25
LINK_HALVINGS = 40
# Newton steps of one projection: it starts within a link of the polyline, and bisects the range
# where a step would leave it.
PROJECTION_STEPS = 60
# Fractions of a side where it is compared with another: not symmetric, and none at an end.
PROBES = np.array([0.03, 0.17, 0.31, 0.48, 0.64, 0.81, 0.96])
# The same for every span between knots: a bulge of a spline covers at least one span.
SPAN_PROBES = np.array([0.12, 0.38, 0.61, 0.9])


@dataclass(frozen=True, eq=False)
class PatchSide:
    """The isoline of a patch at `level`, its free parameter from first to last, or a part of it."""

    surface: Surface
    patch: str
    name: str
    level: float
    first: float
    last: float

    @staticmethod
    def of(surface: Surface, patch: str, name: str) -> PatchSide:
        u0, u1, v0, v1 = surface.domain
        level = {"u0": u0, "u1": u1, "v0": v0, "v1": v1}[name]
        first, last = (u0, u1) if name[0] == "v" else (v0, v1)
        return PatchSide(surface, patch, name, level, first, last)

    @property
    def label(self) -> str:
        return f"{self.patch} side {self.name}"

    def part(self, first: float, last: float) -> PatchSide:
        return replace(self, first=first, last=last)

    def parameters(self, t: float) -> tuple[float, float]:
        return (t, self.level) if self.name[0] == "v" else (self.level, t)

    def jet(self, t: float) -> tuple[Array, Array, Array]:
        """(x, x_t, x_tt) along the side."""
        jet = self.surface.jet(*self.parameters(t))
        return (jet[0], jet[1], jet[3]) if self.name[0] == "v" else (jet[0], jet[2], jet[5])

    def point(self, t: float) -> Array:
        return self.jet(t)[0]

    @cached_property
    def breaks(self) -> Array:
        """The side's ends and the knots of its curve between them; only the ends if none."""
        knots = self.surface.pieces()[0 if self.name[0] == "v" else 1]
        return np.concatenate([[self.first], inside(knots, self.first, self.last), [self.last]])

    @cached_property
    def knots(self) -> Array:
        """Parameters of the polyline, ascending: POLYLINE_POINTS uniform ones, the curve's knots,
        and more where its links would be long."""
        return self._halved(self._even)

    @cached_property
    def _even(self) -> Array:
        return np.union1d(np.linspace(self.first, self.last, POLYLINE_POINTS), self.breaks)

    def _halved(self, knots: Array) -> Array:
        points = np.array([self.point(float(t)) for t in knots])
        for _ in range(LINK_HALVINGS):
            links = np.linalg.norm(np.diff(points, axis=0), axis=1)
            middles = 0.5 * (knots[:-1] + knots[1:])
            long = (links > LONGEST_LINK * links.sum()) & (middles > knots[:-1])
            if not long.any():
                break
            more = np.array([self.point(float(t)) for t in middles[long]])
            places = np.flatnonzero(long) + 1
            knots = np.insert(knots, places, middles[long])
            points = np.insert(points, places, more, axis=0)
        return knots

    @cached_property
    def middle(self) -> float:
        """About the parameter that halves the side's length, that of a point of its polyline."""
        links = np.linalg.norm(np.diff(self.polyline, axis=0), axis=1)
        way = np.concatenate([[0.0], np.cumsum(links)])
        inner = np.abs(way[1:-1] - 0.5 * way[-1])
        return float(self.knots[1 + int(inner.argmin())])

    @cached_property
    def polyline(self) -> Array:
        """(len(knots), 3) points from the first to the last."""
        return np.array([self.point(float(t)) for t in self.knots])

    @cached_property
    def length(self) -> float:
        return float(np.linalg.norm(np.diff(self.polyline, axis=0), axis=1).sum())

    @cached_property
    def probes(self) -> Array:
        """Points inside the side, (n, 3): at PROBES, then in every span between knots."""
        ts = self.first + PROBES * (self.last - self.first)
        if len(self.breaks) > 2:
            ts = np.concatenate([ts, in_spans(self.breaks)])
        if self.uneven:
            ts = np.concatenate([ts, 0.5 * (self.knots[:-1] + self.knots[1:])])
        return np.array([self.point(float(t)) for t in ts])

    @property
    def uneven(self) -> bool:
        """Are points at uniform parameters too far apart in space to represent the side?"""
        return len(self.knots) > len(self._even)

    def collapsed(self, tolerance: float) -> bool:
        """Is the whole side within the tolerance of one point?"""
        points = self.polyline
        return float(np.linalg.norm(points - points.mean(axis=0), axis=1).max()) <= tolerance

    def closed(self, tolerance: float) -> bool:
        """Does the side end where it begins, without having collapsed?"""
        ends = float(np.linalg.norm(self.polyline[-1] - self.polyline[0]))
        return ends <= tolerance and not self.collapsed(tolerance)

    def nearest(self, x: Array) -> tuple[float, float]:
        """(parameter, distance) of the side's point that is nearest to x."""
        k = int(((self.polyline - x) ** 2).sum(axis=1).argmin())
        low = float(self.knots[max(k - 1, 0)])
        high = float(self.knots[min(k + 1, len(self.knots) - 1)])
        t = float(self.knots[k])
        met_low = met_high = False  # has the projection been at that end and turned back?
        for _ in range(PROJECTION_STEPS):
            y, yt, ytt = self.jet(t)
            away = y - x
            slope = float(away @ yt)
            speed = float(yt @ yt)
            bend = speed + float(away @ ytt)
            if speed == 0.0:
                break
            step = -slope / (bend if bend > 0.1 * speed else speed)
            if slope < 0.0:
                low, met_low = t, True
            elif slope > 0.0:
                high, met_high = t, True
            new = t + step
            if new <= low:
                new = 0.5 * (low + high) if met_low and new < low else low
            elif new >= high:
                new = 0.5 * (low + high) if met_high and new > high else high
            if abs(new - t) <= PROJECTION_STEP * (self.last - self.first):
                t = new
                break
            t = new
        return t, float(np.linalg.norm(self.point(t) - x))


def in_spans(breaks: Array) -> Array:
    """Parameters inside every span between two breaks."""
    spans: Array = breaks[:-1, None] + SPAN_PROBES * np.diff(breaks)[:, None]
    return spans.ravel()


def gap(one: PatchSide, other: PatchSide) -> float:
    """The greatest distance from points inside one side to the other side, in both directions."""
    forth = max(other.nearest(x)[1] for x in one.probes)
    return max(forth, max(one.nearest(x)[1] for x in other.probes))
