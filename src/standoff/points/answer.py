"""What a point tracker answers: signed distance, witness, the parallel minima, and switches."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Literal, NamedTuple

import numpy as np

from standoff.bodies.features import Feature
from standoff.bodies.plain_data import PlainData, plain, without_roundoff
from standoff.read_only import KeepsReadOnly
from standoff.tracking.branches import BranchCounts, Change
from standoff.tracking.status import Status
from standoff.typing import Array

Kind = Literal["medial", "crossing", "voronoi"]


class PointEvent(NamedTuple):
    """A switch of the witness point.

    Attributes
    ----------
    time : float
        Since the start [s]: that of the frame, or, where `located`, the instant itself.
    kind : "medial", "crossing" or "voronoi"
        Inside, another local minimum has become the least, which is on the medial axis; the point
        crosses the boundary; or outside, it crosses a Voronoi line between a curve and a vertex.
    source, target : Feature
        Equal at a crossing, and at a medial jump within one curve.
    value : float
        Switching function: at a medial jump the target's distance less the source's [length], at
        a crossing the signed distance [length], at a Voronoi line the slope of the distance along
        the curve into it [-]. nan where it is not known.
    slope : float
        Rate of the switching function [its unit/s]; nan where no velocity was given.
    located : bool
        Was the instant found within the step, or is it only the time of the frame?
    """

    time: float
    kind: Kind
    source: Feature
    target: Feature
    value: float
    slope: float
    located: bool = False


class Minimum(NamedTuple):
    """A local minimum of the distance from the point to the boundary, or to one curve of it.

    Attributes
    ----------
    feature : Feature
        It lies on.
    parameters : tuple of float
        (u, v) on a face, (u, v, chart) on one with an atlas, (t,) on an edge, () on a vertex.
    distance : float
        Without sign [length].
    witness, normal : ndarray, shape (3,)
        Its place on the boundary, and the outward unit normal there.
    residual : float
        Length of the witness vector's projection on the boundary's tangents; zero at the minimum,
        and at the end of a curve that holds it [length].
    key : int
        Distinguishes it from the other minima of the run.
    """

    feature: Feature
    parameters: tuple[float, ...]
    distance: float
    witness: Array
    normal: Array
    residual: float
    key: int


class PointCounts(NamedTuple):
    """What an answer took.

    Attributes
    ----------
    switches : int
        Events of the frame.
    born, ended : int
        Minima that are tracked from this frame on, and that are no longer tracked; the answer's
        ``changes`` have the reasons.
    restarts : int
        Nearer points that the proof met inside, or global starts of the tracker outside.
    samples : int
        Points of the boundary, or evaluations, that the proof inside took.
    """

    switches: int
    born: int
    ended: int
    restarts: int
    samples: int


@dataclass(frozen=True, eq=False, repr=False)
class PointProximity(KeepsReadOnly, PlainData):
    """The signed distance of a point to a body, and how it was proven. Vectors in the body's frame.

    Attributes
    ----------
    distance : float
        Negative inside, where it is minus the depth [length].
    lower_bound, upper_bound : float
        The true signed distance is between them [length].
    witness : ndarray, shape (3,)
        Nearest point of the body's boundary.
    normal : ndarray, shape (3,)
        Unit, outward, from the body to the point outside; it is kept through zero distance.
    inside : bool
        Is the point inside the body? Of a planar body with a swept radius: inside its core.
    feature : Feature
        Active feature.
    parameters : tuple of float
        As in `Minimum`.
    minima : tuple of Minimum
        All that are tracked in parallel, the least first: of a planar body one at least of each
        curve of its core, outside too; of a spatial one those found, none outside.
    active : int
        Key of the one that answers inside; -1 where there is none.
    rate : float
        Time derivative of the distance; nan where no velocity was given.
    residual : float
        As in `Minimum`, of the active feature.
    status : Status
        As of a pair. Outside CONVERGED, where the bounds are within the tolerance. Inside GLOBAL,
        where it is proven that no other minimum is less: of a planar body to within the tolerance,
        of a spatial one to a part of 0.999; else LOCAL.
    counts : PointCounts
    events : tuple of PointEvent
        The switches of this step, in their order.
    time : float
        Since the start [s].
    changes : tuple of Change
        Minima that have begun or ended in this frame, each with the reason.
    total : BranchCounts
        How many have since the start, by reason.
    """

    distance: float
    lower_bound: float
    upper_bound: float
    witness: Array
    normal: Array
    inside: bool
    feature: Feature
    parameters: tuple[float, ...]
    minima: tuple[Minimum, ...]
    active: int
    rate: float
    residual: float
    status: Status
    counts: PointCounts
    events: tuple[PointEvent, ...]
    time: float
    changes: tuple[Change, ...]
    total: BranchCounts

    @property
    def certified(self) -> bool:
        """Is the signed distance proven: CONVERGED outside, GLOBAL inside?"""
        return self.status.certified

    @property
    def mode(self) -> tuple[bool, Feature, int]:
        """Side, active feature, and inside the key of the least minimum (outside -1)."""
        return self.inside, self.feature, self.active if self.inside else -1

    def of_curve(self, index: int) -> Minimum:
        """The nearest of the minima that are followed on one curve of a planar body."""
        own = [m for m in self.minima if m.feature == Feature("edge", index)]
        return min(own, key=lambda m: m.distance)

    def as_dict(self) -> dict[str, Any]:
        """Return the answer as plain data, by the attributes' names; as `Proximity.as_dict`."""
        return {part.name: plain(getattr(self, part.name)) for part in fields(self)}

    def __repr__(self) -> str:
        numbers = [self.distance, self.distance - self.lower_bound]
        distance, gap = without_roundoff(numbers, float(np.abs(self.witness).max()))
        side = "inside" if self.inside else "outside"
        kind = type(self).__name__
        return f"{kind}(distance={distance:.12g}, gap={gap:.2g}, {self.feature}, {side})"
