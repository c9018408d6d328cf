"""How an answer ended, with a sentence of advice each."""

from __future__ import annotations

from enum import Enum


class Status(Enum):
    """The numbers are those of ``standoff.kernels.frame``."""

    CONVERGED = 0
    TRACKING = 1
    OVERLAPPING = 2
    NOT_CERTIFIED = 3

    @property
    def advice(self) -> str:
        """What it means and what to do."""
        return _ADVICE[self]


_ADVICE = {
    Status.CONVERGED: (
        "The gap between distance and lower bound, less the bodies' own slack, is within the "
        "tolerance."
    ),
    Status.TRACKING: (
        "The law is still converging, or lags behind the motion: the lower bound holds; raise the "
        "paper's gain towards so.max_gain, shorten the step, or give a finite tolerance."
    ),
    Status.OVERLAPPING: (
        "The bodies touch or overlap: there is no distance until they part. The next step starts "
        "globally."
    ),
    Status.NOT_CERTIFIED: (
        "No start reached a gap within the tolerance: the distance is an upper bound and the "
        "lower bound holds; loosen the tolerance, or report the pair with its poses."
    ),
}
