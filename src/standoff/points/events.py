"""The switches between two answers of a point tracker, with their switching functions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.features import Feature
from standoff.points.answer import Kind, Minimum, PointEvent
from standoff.points.planar_boundary import PlanarBoundary

Array = NDArray[np.float64]
Leg = tuple[Feature, Feature]


class Moment(NamedTuple):
    """Where a point tracker is: what its switches depend on.

    Attributes
    ----------
    inside : bool
    feature : Feature
        Active feature.
    nearest : Minimum
        The least of the minima that are tracked in parallel.
    """

    inside: bool
    feature: Feature
    nearest: Minimum


class Switching(NamedTuple):
    """Switching functions at a place and velocity, (2,), in the body's frame.

    Attributes
    ----------
    boundary : PlanarBoundary
    x : ndarray, shape (2,)
    v : ndarray or None, shape (2,)
    """

    boundary: PlanarBoundary
    x: Array
    v: Array | None

    def medial(self, source: Minimum | None, target: Minimum) -> tuple[float, float]:
        """The target's distance less the source's [length], and its rate [length/s]."""
        if source is None:
            return math.nan, math.nan
        slope = self._rate(self._away(target)) - self._rate(self._away(source))
        return target.distance - source.distance, slope

    def crossing(self, minimum: Minimum) -> tuple[float, float]:
        """The signed distance by a minimum's normal [length], and its rate [length/s]."""
        edge, t = minimum.feature.index, minimum.parameter
        normal = self.boundary.normal(edge, t)
        return float(normal @ (self.x - self.boundary.point(edge, t))), self._rate(normal)

    def voronoi(self, leg: Leg) -> tuple[float, float]:
        """The slope of the distance at a vertex along the curve into it [-], and its rate [1/s].

        Negative in the curve's region.
        """
        vertex = next((f.index for f in leg if f.kind == "vertex"), None)
        edge = next((f.index for f in leg if f.kind == "edge"), None)
        if vertex is None or edge is None:
            return math.nan, math.nan
        part = self.boundary.body.edge_parts[edge]
        first = part.first == vertex
        tangent = part.curve.jet(part.curve.first if first else part.curve.last)[1][:2]
        into = tangent / (math.hypot(*tangent) * (1.0 if first else -1.0))
        away = self.x - self.boundary.body.vertex_points[vertex][:2]
        d = math.hypot(*away)
        if d == 0.0:
            return math.nan, math.nan
        n = away / d
        if self.v is None:
            return float(-into @ n), math.nan
        return float(-into @ n), float(-into @ (self.v - n * (n @ self.v)) / d)

    def _away(self, minimum: Minimum) -> Array:
        away = self.x - self.boundary.point(minimum.feature.index, minimum.parameter)
        d = math.hypot(*away)
        return np.asarray(away / d if d > 0.0 else np.zeros(2))

    def _rate(self, direction: Array) -> float:
        return math.nan if self.v is None else float(direction @ self.v)


def events_between(
    before: Moment,
    after: Moment,
    left: Minimum | None,
    told: Sequence[Leg],
    at: Switching,
    time: float,
) -> tuple[PointEvent, ...]:
    """Return the switches from one moment to another, in their order.

    Parameters
    ----------
    before, after : Moment
    left : Minimum or None
        What has become of the minimum that was the least before, at the place of `at`.
    told : sequence of (Feature, Feature)
        Switches that the automaton outside tells of this step.
    at : Switching
        At the moment after.
    time : float
        For the events [s].
    """
    found: list[PointEvent] = []

    def note(kind: Kind, leg: Leg, value_and_slope: tuple[float, float]) -> None:
        found.append(PointEvent(time, kind, *leg, *value_and_slope))

    if before.inside and before.nearest.key != after.nearest.key:
        leg = before.nearest.feature, after.nearest.feature
        note("medial", leg, at.medial(left, after.nearest))
    if before.inside and not after.inside:
        note("crossing", (after.nearest.feature,) * 2, at.crossing(after.nearest))
    if not (before.inside and after.inside):
        source = after.nearest.feature if before.inside else before.feature
        for leg in _legs(source, after.feature, told):
            note("voronoi", leg, at.voronoi(leg))
    if after.inside and not before.inside:
        note("crossing", (after.feature, after.feature), at.crossing(after.nearest))
    return tuple(found)


def _legs(source: Feature, target: Feature, told: Sequence[Leg]) -> list[Leg]:
    """The way that was told, if it leads from source to target, else the one leg."""
    if source == target:
        return []
    joined = all(a[1] == b[0] for a, b in pairwise(told))
    if told and joined and told[0][0] == source and told[-1][1] == target:
        return list(told)
    return [(source, target)]
