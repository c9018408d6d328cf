"""How an answer ended, with a sentence of advice each."""

from __future__ import annotations

from enum import Enum
from typing import Any


class Ordered(Enum):
    """An enumeration in the order of its values.

    For ``numpy.unique``, which sorts: the order itself means nothing.
    """

    def __lt__(self, other: Any) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        less: bool = self._value_ < other._value_
        return less


class Status(Ordered):
    """The numbers are those of ``standoff.kernels.state.arrays``."""

    CONVERGED = 0
    TRACKING = 1
    OVERLAPPING = 2
    NOT_CERTIFIED = 3
    LOCAL = 4
    GLOBAL = 5
    DEADLINE = 6
    NOT_RESTARTED = 7
    FAR = 8
    REFUSED = 9
    WITHIN = 10
    CONTINUUM = 11
    TOUCHING = 12
    CONTAINED = 13

    @property
    def certified(self) -> bool:
        """Is what was asked proven: the signed distance (CONVERGED or CONTINUUM while apart,
        GLOBAL in penetration, TOUCHING between them), the least wall of a solid inside another
        (CONTAINED), or that the bodies are beyond the horizon (FAR)?"""
        return self in _CERTIFIED

    @property
    def penetrating(self) -> bool:
        """Do the bodies touch or overlap?"""
        return self in _PENETRATING

    @property
    def advice(self) -> str:
        """What it means and what to do."""
        return _ADVICE[self]


OF_SOLIDS = (Status.WITHIN, Status.CONTINUUM, Status.TOUCHING, Status.CONTAINED)
"""What only an answer of solids that need not be convex can end with."""

_CERTIFIED = (
    Status.CONVERGED,
    Status.GLOBAL,
    Status.FAR,
    Status.CONTINUUM,
    Status.TOUCHING,
    Status.CONTAINED,
)
_PENETRATING = (Status.LOCAL, Status.GLOBAL, Status.OVERLAPPING)
_ADVICE = {
    Status.CONVERGED: (
        "The gap between distance and lower bound, less the bodies' own slack, is within the "
        "tolerance."
    ),
    Status.TRACKING: (
        "The law is still converging, or lags behind the motion: the lower bound holds; take the "
        "paper's gain nearer 1/dt, shorten the step, or give a finite tolerance."
    ),
    Status.OVERLAPPING: (
        "The bodies are proven to overlap, but no depth is proven within the tolerance: the "
        "distance is at most 0 and both bounds hold: use them. Of solids `overlap.reason` says why "
        "they are apart; of convex bodies loosen the tolerance, or report the pair with its poses."
    ),
    Status.NOT_CERTIFIED: (
        "No search brought the distance and its lower bound within the tolerance of each other: "
        "the distance is an upper bound and the lower bound holds; loosen the tolerance, or report "
        "the pair with its poses."
    ),
    Status.LOCAL: (
        "The bodies overlap, and moving B by depth * normal separates them; a shorter move in "
        "another direction may be enough, down to the upper bound: depth='global' searches for "
        "it, as far as a deadline allows."
    ),
    Status.GLOBAL: (
        "The bodies overlap, moving B by depth * normal separates them, and it is proven that no "
        "direction needs less than 0.999 of it."
    ),
    Status.DEADLINE: (
        "The evaluations allowed ran out before the bounds met; both bounds hold: allow more "
        "(`deadline`), or use the bounds as they are. A tracker's next step continues from here."
    ),
    Status.NOT_RESTARTED: (
        "The local minimum that is followed was lost, or another may be less, and the law has "
        "restarts=False: the bounds hold and the next step goes on from here; start anew, or leave "
        "restarts at True."
    ),
    Status.FAR: (
        "The bodies are proven to be farther apart than the horizon: the lower bound holds, and no "
        "distance was asked for; for one, raise `within`."
    ),
    Status.WITHIN: (
        "The distance is proven to lie between the lower and the upper bound, but of some pieces "
        "of the surfaces the search could not bring these as near to each other as the tolerance: "
        "use the bounds as they are, loosen the tolerance, or report the pair with its poses."
    ),
    Status.CONTINUUM: (
        "The distance is proven, and a whole set of pairs of points has it: the witness points are "
        "one of them, and the ends of the set are in `continuum`."
    ),
    Status.TOUCHING: (
        "The solids are proven to be closer than the tolerance and the slack, and no point was "
        "found inside both: they touch, or overlap by less than that."
    ),
    Status.CONTAINED: (
        "One solid is wholly inside the other's material: the distance is the least wall between "
        "their boundaries."
    ),
    Status.REFUSED: (
        "There is no answer, because a pose of this row is invalid: `errors` of so.distances' "
        "result says what is wrong with it."
    ),
}
BY_NUMBER = tuple(sorted(Status))
"""The status of each number."""
