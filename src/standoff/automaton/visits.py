"""Where a run went: how long it stayed in each mode, and the switches that it took."""

from __future__ import annotations

from typing import NamedTuple

from standoff.automaton.transitions import Transition
from standoff.bodies.features import Feature

Mode = tuple[Feature, Feature]


class Visit(NamedTuple):
    """A stay in one mode.

    Attributes
    ----------
    feature_a, feature_b : Feature
        Active features of A and B.
    start, end : float
        Times, s.
    """

    feature_a: Feature
    feature_b: Feature
    start: float
    end: float


def mode_of(visit: Visit) -> Mode:
    """The mode of a visit."""
    return visit.feature_a, visit.feature_b


class Course:
    """Where a run went: `visits`, in order of time, and the switches `taken`, with times [s]."""

    visits: tuple[Visit, ...]
    taken: tuple[tuple[float, Transition], ...]

    @property
    def visited(self) -> tuple[Mode, ...]:
        """The modes of the visits, each once, in order of the first visit."""
        return tuple(dict.fromkeys(mode_of(visit) for visit in self.visits))

    def stays(self, mode: Mode) -> list[Visit]:
        """The visits of one mode, in order of time."""
        return [visit for visit in self.visits if mode_of(visit) == mode]

    def time_in(self, mode: Mode) -> float:
        """Time spent in a mode [s]."""
        return sum(visit.end - visit.start for visit in self.stays(mode))
