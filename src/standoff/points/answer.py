"""What a point tracker answers: signed distance, witness, the parallel minima, and switches."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.features import Feature
from standoff.bodies.plain_data import PlainData, plain, without_roundoff
from standoff.read_only import KeepsReadOnly
from standoff.tracking.status import Status

Array = NDArray[np.float64]
Kind = Literal["medial", "crossing", "voronoi"]


class PointEvent(NamedTuple):
    """A switch of the witness point.

    Attributes
    ----------
    time : float
        s; that of the frame, or, where `located`, the instant itself.
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
        Was the instant found within the step, or is it only dated to the frame?
    """

    time: float
    kind: Kind
    source: Feature
    target: Feature
    value: float
    slope: float
    located: bool = False


class Minimum(NamedTuple):
    """A local minimum of the distance on one curve, as it is tracked in parallel.

    Attributes
    ----------
    feature : Feature
        Its curve.
    parameter : float
    distance : float
        Without sign [length].
    residual : float
        Length of the witness vector's projection on the curve's unit tangent; zero at the minimum
        and at an end that holds it [length].
    key : int
        Tells it from the other minima of the run.
    """

    feature: Feature
    parameter: float
    distance: float
    residual: float
    key: int


class PointCounts(NamedTuple):
    """What an answer took.

    Attributes
    ----------
    switches : int
        Events of the frame.
    found : int
        Minima that were new and are tracked from this frame on.
    restarts : int
        Nearer points that the certificate met, or global starts of the tracker outside.
    samples : int
        Points of the boundary that the certificate took.
    """

    switches: int
    found: int
    restarts: int
    samples: int


@dataclass(frozen=True, eq=False, repr=False)
class PointDistance(KeepsReadOnly, PlainData):
    """What the answers of both kinds of point tracker begin with; they say what each field is."""

    distance: float
    lower_bound: float
    upper_bound: float
    witness: Array
    normal: Array
    inside: bool
    feature: Feature
    parameters: tuple[float, ...]

    def as_dict(self) -> dict[str, Any]:
        """Return the answer as plain data, by the attributes' names; as `Proximity.as_dict`."""
        return {part.name: plain(getattr(self, part.name)) for part in fields(self)}

    def __repr__(self) -> str:
        numbers = [self.distance, self.distance - self.lower_bound]
        distance, gap = without_roundoff(numbers, float(np.abs(self.witness).max()))
        side = "inside" if self.inside else "outside"
        kind = type(self).__name__
        return f"{kind}(distance={distance:.12g}, gap={gap:.2g}, {self.feature}, {side})"


@dataclass(frozen=True, eq=False, repr=False)
class PointProximity(PointDistance):
    """The signed distance of a point to a body, and how it was proven. Vectors in world axes.

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
        Is the point in the body's core? Decided by the point's place alone.
    feature : Feature
        Active feature.
    parameters : tuple of float
        (t,) on a curve, () on a vertex.
    minima : tuple of Minimum
        All that are tracked in parallel, at least one of each curve.
    active : int
        Key of the least of them.
    rate : float
        Time derivative of the distance; nan where no velocity was given.
    residual : float
        As in `Minimum`, of the active feature.
    status : Status
        CONVERGED: the bounds are within the tolerance.
    counts : PointCounts
    events : tuple of PointEvent
        The switches of this step, dated to its frame.
    time : float
        Since the start [s].
    """

    minima: tuple[Minimum, ...]
    active: int
    rate: float
    residual: float
    status: Status
    counts: PointCounts
    events: tuple[PointEvent, ...]
    time: float

    @property
    def certified(self) -> bool:
        """Are the bounds within the tolerance?"""
        return self.status is Status.CONVERGED

    @property
    def mode(self) -> tuple[bool, Feature, int]:
        """Side, active feature, and inside the key of the least minimum (outside -1)."""
        return self.inside, self.feature, self.active if self.inside else -1

    def of_curve(self, index: int) -> Minimum:
        """The nearest minimum of one curve."""
        own = [m for m in self.minima if m.feature.index == index]
        return min(own, key=lambda m: m.distance)
