"""A point tracker's state, and its answer in the making."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.features import Feature
from standoff.points.answer import Minimum, PointCounts, PointEvent, PointProximity
from standoff.points.events import Leg, Moment
from standoff.points.parallel_minima import Parallel
from standoff.points.planar_boundary import PlanarBoundary
from standoff.read_only import KeepsReadOnly
from standoff.tracking.state import TrackerState
from standoff.tracking.status import Status

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PointState(KeepsReadOnly):
    """The warm start, as a value: goes into a step and comes out of it, never changed.

    Attributes
    ----------
    proximity : PointProximity
        The answer at the frame of this state.
    point : ndarray, shape (3,)
    velocity : ndarray or None, shape (3,)
        Of the point at that frame; None where none was given.
    parallel : Parallel
        The minima with their states.
    outside : TrackerState or None
        Of the automaton outside; None inside.
    """

    proximity: PointProximity
    point: Array
    velocity: Array | None
    parallel: Parallel
    outside: TrackerState | None

    @property
    def time(self) -> float:
        """Time since the start [s]."""
        return self.proximity.time

    @property
    def moment(self) -> Moment:
        """What switches depend on."""
        p = self.proximity
        return Moment(p.inside, p.feature, next(m for m in p.minima if m.key == p.active))


class Found(NamedTuple):
    """An answer for the body's core, in the making; distance and bounds are signed [length]."""

    parallel: Parallel
    active: int
    distance: float
    bounds: tuple[float, float]
    witness: Array
    feature: Feature
    parameters: tuple[float, ...]
    residual: float
    outside: TrackerState | None = None
    told: tuple[Leg, ...] = ()
    restarts: int = 0
    samples: int = 0

    @property
    def nearest(self) -> Minimum:
        """The least of the minima."""
        nearest = self.parallel.of_key(self.active)
        assert nearest is not None  # the active one is tracked
        return nearest

    def moment(self, inside: bool) -> Moment:
        """What switches depend on."""
        return Moment(inside, self.feature, self.nearest)

    def normal(self, boundary: PlanarBoundary, x: Array) -> Array:
        """Outward unit normal, (3,): a curve's own; at a vertex the direction to the point."""
        away = x - self.witness
        d = float(np.linalg.norm(away))
        if self.feature.kind == "vertex" and d > 0.0:
            return np.asarray(away / d)
        edge, t = self.nearest.feature.index, self.nearest.parameter
        if self.feature.kind == "edge":
            edge, t = self.feature.index, self.parameters[0]
        return np.append(boundary.normal(edge, t), 0.0)


class Answering(NamedTuple):
    """What turns a core's answer into the body's.

    Attributes
    ----------
    boundary : PlanarBoundary
        Of the core.
    radius : float
        Swept around it [length].
    gap : float
        Between the bounds, below which an answer is certified [length].
    doubt : Status
        Of an answer that is not.
    """

    boundary: PlanarBoundary
    radius: float
    gap: float
    doubt: Status

    def state(
        self,
        found: Found,
        inside: bool,
        x: Array,
        v: Array | None,
        time: float,
        fresh: int = 0,
        events: tuple[PointEvent, ...] = (),
    ) -> PointState:
        """The state with its answer; `fresh` minima were added."""
        normal = found.normal(self.boundary, x)
        lower, upper = found.bounds
        proximity = PointProximity(
            distance=found.distance - self.radius,
            lower_bound=lower - self.radius,
            upper_bound=upper - self.radius,
            witness=found.witness + self.radius * normal,
            normal=normal,
            inside=inside,
            feature=found.feature,
            parameters=found.parameters,
            minima=found.parallel.minima,
            active=found.active,
            rate=math.nan if v is None else float(normal @ v),
            residual=found.residual,
            status=Status.CONVERGED if upper - lower <= self.gap else self.doubt,
            counts=PointCounts(len(events), fresh, found.restarts, found.samples),
            events=events,
            time=time,
        )
        return PointState(proximity, x, v, found.parallel, found.outside)
