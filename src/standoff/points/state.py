"""A point tracker's state, and an answer in the making."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from standoff.bodies.features import Feature
from standoff.points.answer import Minimum, PointCounts, PointEvent, PointProximity
from standoff.read_only import KeepsReadOnly
from standoff.tracking.branches import Branches, End
from standoff.tracking.state import TrackerState
from standoff.tracking.status import Status
from standoff.typing import Array


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
    branches : Branches
        The minima with their states.
    pair : TrackerState or None
        Of the body and the point as a pair: tracked outside; in a spatial body the last proof of
        the depth, in a planar one None.
    """

    proximity: PointProximity
    point: Array
    velocity: Array | None
    branches: Branches[Any]
    pair: TrackerState | None

    @property
    def time(self) -> float:
        """Time since the start [s]."""
        return self.proximity.time

    @property
    def inside(self) -> bool:
        """Is the point inside?"""
        return self.proximity.inside

    def with_events(self, events: Iterable[PointEvent]) -> PointState:
        """The state with the switches of its step."""
        told = tuple(events)
        counts = self.proximity.counts._replace(switches=len(told))
        return replace(self, proximity=replace(self.proximity, events=told, counts=counts))


class Leg(NamedTuple):
    """A change of the feature outside; value and slope as in `PointEvent`."""

    source: Feature
    target: Feature
    value: float = math.nan
    slope: float = math.nan


class AnswerDraft(NamedTuple):
    """An answer in the making.

    Attributes
    ----------
    inside : bool
    distance : float
        Signed [length].
    bounds : (float, float)
        Of the signed distance, from below and from above [length].
    witness, normal, feature, parameters, residual, status
        As in `PointProximity`.
    branches : Branches
        Settled.
    pair : TrackerState or None
        As in `PointState`.
    told : tuple of Leg
        Changes of feature that the tracker outside reports for this step.
    restarts, samples : int
        As in `PointCounts`.
    """

    inside: bool
    distance: float
    bounds: tuple[float, float]
    witness: Array
    normal: Array
    feature: Feature
    parameters: tuple[float, ...]
    residual: float
    status: Status
    branches: Branches[Any]
    pair: TrackerState | None
    told: tuple[Leg, ...] = ()
    restarts: int = 0
    samples: int = 0

    def state(
        self, minima: Iterable[Minimum], x: Array, v: Array | None, time: float
    ) -> PointState:
        """The state with its answer; without the switches of the step."""
        changes = self.branches.changes
        ended = sum(isinstance(change.reason, End) for change in changes)
        proximity = PointProximity(
            distance=self.distance,
            lower_bound=self.bounds[0],
            upper_bound=self.bounds[1],
            witness=self.witness,
            normal=self.normal,
            inside=self.inside,
            feature=self.feature,
            parameters=self.parameters,
            minima=tuple(sorted(minima, key=lambda m: (m.distance, m.key))),
            active=self.branches.active,
            rate=math.nan if v is None else float(self.normal @ v),
            residual=self.residual,
            status=self.status,
            counts=PointCounts(0, len(changes) - ended, ended, self.restarts, self.samples),
            events=(),
            time=time,
            changes=changes,
            total=self.branches.counts,
        )
        return PointState(proximity, x, v, self.branches, self.pair)
