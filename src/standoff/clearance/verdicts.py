"""What an answer says of two bodies: apart, touching, overlapping, or not decided."""

from __future__ import annotations

from standoff.clearance.tolerances import TOUCHING_PART
from standoff.tracking.status import Ordered, Status
from standoff.world import PairAnswer, SolidPairAnswer
from standoff.world.shapes import is_bounded, slack_of


class Verdict(Ordered):
    """Of two bodies; each is proven, but for UNDECIDED."""

    OVERLAPPING = 0
    UNDECIDED = 1
    TOUCHING = 2
    APART = 3
    CONTAINED = 4

    @property
    def meaning(self) -> str:
        """In a sentence."""
        return _MEANING[self]


_MEANING = {
    Verdict.OVERLAPPING: "The bodies are proven to overlap, and by more than counts as touching.",
    Verdict.UNDECIDED: (
        "Neither is proven: the bounds are on both sides of 0, and farther apart than the touching "
        "tolerance."
    ),
    Verdict.TOUCHING: "The gap or depth is within the touching tolerance of 0.",
    Verdict.APART: "The bodies are proven to be apart.",
    Verdict.CONTAINED: (
        "One is wholly inside the other's material; the gap is the least wall around it."
    ),
}


def touching_tolerance(answer: PairAnswer | SolidPairAnswer) -> float:
    """Return the gap or depth up to which two bodies count as touching [length].

    It is `TOUCHING_PART` of the larger body's size, and the slack of both: how far their surfaces
    may be from what they are taken for.
    """
    size = max((body.size for body in answer.bodies if is_bounded(body)), default=0.0)
    return TOUCHING_PART * size + pair_slack(answer)


def pair_slack(answer: PairAnswer | SolidPairAnswer) -> float:
    """Return the slack of both bodies, which the lower bound has subtracted [length]."""
    return sum(slack_of(body) for body in answer.bodies)


def verdict_of(answer: PairAnswer | SolidPairAnswer) -> Verdict:
    """Return the verdict on a pair."""
    if answer.far:
        return Verdict.APART
    if answer.status is Status.CONTAINED:
        return Verdict.CONTAINED
    tolerance = touching_tolerance(answer)
    lower, upper = answer.lower_bound, answer.upper_bound
    if -tolerance <= lower and upper <= tolerance:
        return Verdict.TOUCHING
    if lower > 0.0:
        return Verdict.APART
    if answer.status.penetrating and upper < 0.0:
        return Verdict.OVERLAPPING
    return Verdict.UNDECIDED
