"""What a search for the time of impact found."""

from __future__ import annotations

from dataclasses import dataclass, fields
from enum import Enum
from typing import Any

from standoff.bodies.plain_data import PlainData, plain, without_roundoff
from standoff.read_only import KeepsReadOnly
from standoff.tracking.proximity import Proximity, shown_size
from standoff.typing import Array


class ImpactStatus(Enum):
    """How a search for the time of impact ended."""

    IMPACT = 0
    GRAZING = 1
    NO_IMPACT = 2
    AT_START = 3
    UNDECIDED = 4

    @property
    def advice(self) -> str:
        """What it means and what to do."""
        return _ADVICE[self]


_ADVICE = {
    ImpactStatus.IMPACT: (
        "The bodies reach the clearance after `time` and not after `latest`; both are proven."
    ),
    ImpactStatus.GRAZING: (
        "At `time` the bodies are within the tolerance of the clearance, and no instant soon "
        "after was found at which they are proven to reach it: count it as contact, tighten the "
        "tolerance, or continue from a `start` after `latest`."
    ),
    ImpactStatus.NO_IMPACT: (
        "The bodies stay farther apart than the clearance for the whole duration; proven."
    ),
    ImpactStatus.AT_START: (
        "The bodies are at or within the clearance at the start: move them apart, or start later."
    ),
    ImpactStatus.UNDECIDED: (
        "The bodies are proven apart up to `time`; no contact is proven after it. Either the "
        "budget of evaluations ran out: raise max_evaluations, shorten the duration or loosen the "
        "tolerance. Or the answers beyond `time` are not certified, or the motion is too fast for "
        "floating-point times: take a `start` nearer to zero, or a slower motion."
    ),
}


@dataclass(frozen=True, eq=False)
class Impact(KeepsReadOnly, PlainData):
    """The first time at which two bodies come to a clearance, bracketed.

    Attributes
    ----------
    time : float
        Proven lower bound of that time [s], on the paths' clock: from the start up to here the
        signed distance is greater than the clearance (AT_START: it is the start itself). For
        NO_IMPACT it is the end of the duration.
    latest : float
        IMPACT, AT_START: an instant at which the distance is proven to be the clearance or less
        [s]. GRAZING: the last instant looked at with a distance proven to be within the tolerance
        of the clearance. UNDECIDED: as for IMPACT if there is one. Else nan.
    status : ImpactStatus
    proximity : Proximity
        The answer at ``time``.
    clearance : float
        Length.
    tolerance : float
        Length: at ``time`` the certified distance is within this of the clearance (IMPACT,
        GRAZING), unless ``time`` and ``latest`` are neighbours in floating point.
    steps : int
        Intervals of time that were proven, one after the other.
    evaluations : int
        Instants at which the poses were evaluated.
    queries : int
        Instants at which the tracker was asked; at the others, bounding balls sufficed.
    """

    time: float
    latest: float
    status: ImpactStatus
    proximity: Proximity
    clearance: float
    tolerance: float
    steps: int
    evaluations: int
    queries: int

    @property
    def error(self) -> float:
        """``latest - time`` [s]: how much too early ``time`` can be; nan where nothing is hit."""
        return self.latest - self.time

    @property
    def normal(self) -> Array:
        """Unit vector from A to B at ``time``, world, (3,)."""
        return self.proximity.normal

    @property
    def point_a(self) -> Array:
        """Witness point on A at ``time``, world, (3,) [length]."""
        return self.proximity.point_a

    @property
    def point_b(self) -> Array:
        """Witness point on B at ``time``, world, (3,) [length]."""
        return self.proximity.point_b

    def as_dict(self) -> dict[str, Any]:
        """Return the answer as plain data, as `Proximity.as_dict` does; ``error`` is with it."""
        own = {part.name: plain(getattr(self, part.name)) for part in fields(self)}
        return own | {"error": plain(self.error), "proximity": self.proximity.as_dict()}

    def __repr__(self) -> str:
        (distance,) = without_roundoff([self.proximity.distance], shown_size(self.proximity))
        return (
            f"Impact(time={self.time + 0.0:.12g}, latest={self.latest + 0.0:.12g}, "
            f"{self.status.name}, distance={distance:.6g})"
        )
