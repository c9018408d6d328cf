"""What a spatial point tracker answers: signed distance, the parallel minima, its state."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.features import Feature
from standoff.points.answer import PointCounts, PointDistance, PointEvent
from standoff.points.depth_branches import Branch
from standoff.read_only import KeepsReadOnly
from standoff.tracking.state import TrackerState
from standoff.tracking.status import Status

Array = NDArray[np.float64]


class DepthMinimum(NamedTuple):
    """A local minimum of the distance from a point inside to the boundary.

    Attributes
    ----------
    feature : Feature
        It lies on.
    parameters : tuple of float
        (u, v) on a face, (u, v, chart) on one with an atlas, (t,) on an edge, () on a vertex.
    distance : float
        Without sign [length].
    witness, normal : ndarray, shape (3,)
        Its place on the boundary, and the outward unit normal there, in the body's frame.
    key : int
        Tells it from the other minima of the run.
    """

    feature: Feature
    parameters: tuple[float, ...]
    distance: float
    witness: Array
    normal: Array
    key: int


@dataclass(frozen=True, eq=False, repr=False)
class SpatialPointProximity(PointDistance):
    """The signed distance of a point to a spatial body. Vectors in the body's frame.

    Attributes
    ----------
    distance : float
        Negative inside, where it is minus the depth [length].
    lower_bound, upper_bound : float
        The true signed distance is between them [length].
    witness, normal : ndarray, shape (3,)
        Nearest point of the body's boundary, and the outward unit normal.
    inside : bool
        Is the point inside the body, its swept radius included?
    feature : Feature
        Active feature.
    parameters : tuple of float
        As in `DepthMinimum`.
    minima : tuple of DepthMinimum
        All that are tracked in parallel, the least first; none outside.
    active : int
        Key of the least of them; -1 outside.
    rate : float
        Time derivative of the distance; nan where no velocity was given.
    status : Status
        CONVERGED outside; inside GLOBAL, or LOCAL where no proof was found.
    counts : PointCounts
        ``restarts`` are those of the tracker outside, ``samples`` the evaluations of the proof.
    events : tuple of PointEvent
        The switches of this step, in their order.
    time : float
        Since the start [s].
    """

    minima: tuple[DepthMinimum, ...]
    active: int
    rate: float
    status: Status
    counts: PointCounts
    events: tuple[PointEvent, ...]
    time: float

    @property
    def certified(self) -> bool:
        """Is the signed distance proven: CONVERGED outside, GLOBAL inside?"""
        return self.status.certified


@dataclass(frozen=True, eq=False)
class SpatialPointState(KeepsReadOnly):
    """The warm start, as a value: goes into a step and comes out of it, never changed.

    Attributes
    ----------
    proximity : SpatialPointProximity
        The answer at the frame of this state.
    point : ndarray, shape (3,)
    velocity : ndarray or None, shape (3,)
    branches : tuple of Branch
        The minima with their states.
    next_key : int
        Of the next minimum that is found.
    proof : TrackerState
        Of the whole pair: tracked outside, a cold start inside.
    """

    proximity: SpatialPointProximity
    point: Array
    velocity: Array | None
    branches: tuple[Branch, ...]
    next_key: int
    proof: TrackerState

    @property
    def time(self) -> float:
        """Time since the start [s]."""
        return self.proximity.time

    def with_events(self, events: tuple[PointEvent, ...]) -> SpatialPointState:
        """The state with the switches of its step."""
        counts = self.proximity.counts._replace(switches=len(events))
        return replace(self, proximity=replace(self.proximity, events=events, counts=counts))

    @property
    def least(self) -> Branch:
        """The active minimum's branch; only inside."""
        return next(b for b in self.branches if b.key == self.proximity.active)


def minimum_of(branch: Branch) -> DepthMinimum:
    """A branch as it is shown."""
    p = branch.state.proximity
    return DepthMinimum(
        p.feature_a, p.parameters_a, -p.distance, p.point_a.copy(), p.normal.copy(), branch.key
    )


def answer_of(
    best: TrackerState,
    proof: TrackerState,
    branches: tuple[Branch, ...],
    active: int,
    velocity: Array | None,
    found: int,
    time: float,
) -> SpatialPointProximity:
    """The answer: `best` is the least minimum inside, the tracker's state outside."""
    p, whole = best.proximity, proof.proximity
    restarts = whole.counts.restarts if active < 0 else 0
    normal = p.normal.copy()
    return SpatialPointProximity(
        distance=p.distance,
        lower_bound=p.lower_bound,
        upper_bound=max(p.distance, whole.upper_bound),
        witness=p.point_a.copy(),
        normal=normal,
        inside=active >= 0,
        feature=p.feature_a,
        parameters=p.parameters_a,
        minima=tuple(sorted(map(minimum_of, branches), key=lambda m: m.distance)),
        active=active,
        rate=math.nan if velocity is None else float(normal @ velocity),
        status=whole.status,
        counts=PointCounts(0, found, restarts, whole.counts.evaluations),
        events=(),
        time=time,
    )
