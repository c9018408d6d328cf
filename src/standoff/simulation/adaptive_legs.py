"""Solutions by SciPy's adaptive methods, leg by leg: each ends where the equations have a kink."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
import scipy

from standoff.errors import StandoffError
from standoff.recording.changes import changes
from standoff.simulation.loaded_bodies import Features
from standoff.simulation.tolerances import EVENT_INSTANT
from standoff.typing import Array

METHODS: Final = ("RK23", "RK45", "DOP853", "Radau", "BDF", "LSODA")

MOST_EVENTS: Final = 10_000
"""Contacts and releases of one solution: bodies that settle touch more and more often."""


class SystemEvent(NamedTuple):
    """Something that happened at an instant.

    Attributes
    ----------
    time : float
        [s]
    kind : str
        "contact", "release" or "switch".
    pair : int
    source, target : str
        Features of A and B before and after a switch; empty for the others.
    """

    time: float
    kind: str
    pair: int
    source: str = ""
    target: str = ""


class Solved(NamedTuple):
    """(m,) times, the states at them, and the events in order of time."""

    times: Array
    states: list[Array]
    events: tuple[SystemEvent, ...]


class Legs(ABC):
    """Equations of motion with contacts, which are solved from kink to kink.

    A subclass gives the right-hand side and the distances and features of its pairs at a state; it
    may end legs by its own events, and change a state's coordinates between them.
    """

    evaluations = 0

    @abstractmethod
    def slope(self, t: float, y: Array) -> Array:
        """Rates of the state."""

    @abstractmethod
    def distances(self, t: float, y: Array) -> Sequence[float]:
        """Signed distances of the pairs."""

    @abstractmethod
    def features(self, t: float, y: Array) -> Features:
        """Active features of the pairs."""

    def ends(self) -> list[Callable[[float, Array], float]]:
        """Other events that end a leg: where these fall through zero."""
        return []

    def kept(self, t: float, y: Array) -> Array:
        """What of a state is kept for the record."""
        return y

    def begun(self, t: float, y: Array) -> Array:
        """The state as the next leg begins with it."""
        return y

    def solve(self, start: float, y: Array, end: float, options: dict[str, Any]) -> Solved:
        """Return the solution from a time to a later one."""
        y = self.begun(start, y)
        times, states, events = [start], [self.kept(start, y)], list[SystemEvent]()
        t, inside = start, [distance < 0.0 for distance in self.distances(start, y)]
        while t < end:
            crossing = [self._crossing(k, within) for k, within in enumerate(inside)]
            crossing += [_falling(function) for function in self.ends()]
            part = scipy.integrate.solve_ivp(
                self.slope, (t, end), y, events=crossing, dense_output=True, **options
            )
            if not part.success:
                raise StandoffError(
                    f"{options['method']} failed at {part.t[-1]:g} s: {part.message}"
                )
            events += self._switches(part)
            times += list(part.t[1:])
            states += [self.kept(*row) for row in zip(part.t[1:], part.y.T[1:], strict=True)]
            t = float(part.t[-1])
            y = self.begun(t, part.y[:, -1])
            for k, found in enumerate(part.t_events[: len(inside)]):
                if len(found):
                    kind = "release" if inside[k] else "contact"
                    events.append(SystemEvent(float(found[-1]), kind, k))
                    inside[k] = not inside[k]
            if len(events) > MOST_EVENTS:
                raise StandoffError(
                    f"more than {MOST_EVENTS} contacts, releases and switches until {t:g} s: give "
                    "the contact more damping, or a shorter duration.",
                    "duration",
                )
        ordered = tuple(sorted(events, key=lambda event: event.time))
        return Solved(np.array(times), states, ordered)

    def _crossing(self, pair: int, inside: bool) -> Any:
        """Where a pair that is apart touches, or one that touches separates."""

        def distance(t: float, y: Array) -> float:
            return float(self.distances(t, y)[pair])

        distance.terminal = True  # type: ignore[attr-defined]
        distance.direction = 1.0 if inside else -1.0  # type: ignore[attr-defined]
        return distance

    def _switches(self, part: Any) -> list[SystemEvent]:
        """Changes of features between the steps, each located by halving."""

        def look(time: float, *_: _ActiveFeatures) -> _ActiveFeatures:
            return _ActiveFeatures(time, self.features(time, part.sol(time)))

        found = []
        before = _ActiveFeatures(float(part.t[0]), self.features(float(part.t[0]), part.y[:, 0]))
        for end in part.t[1:].tolist():
            after = look(end)
            resolution = EVENT_INSTANT * max(1.0, end)
            for events in changes(before, after, look, resolution, _switched):
                found += events
            before = after
        return found


class _ActiveFeatures(NamedTuple):
    """The active features of all pairs at a time."""

    time: float
    mode: Features


def _switched(before: _ActiveFeatures, after: _ActiveFeatures) -> list[SystemEvent]:
    return [
        SystemEvent(after.time, "switch", pair, " ".join(old), " ".join(new))
        for pair, (old, new) in enumerate(zip(before.mode, after.mode, strict=True))
        if old != new
    ]


def _falling(function: Callable[[float, Array], float]) -> Any:
    """A function as an event that ends a leg where it falls through zero."""

    def event(t: float, y: Array) -> float:
        return function(t, y)

    event.terminal = True  # type: ignore[attr-defined]
    event.direction = -1.0  # type: ignore[attr-defined]
    return event
