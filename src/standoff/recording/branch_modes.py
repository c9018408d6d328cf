"""The automaton of solids, as a recording tells it: local minima are branches that go in parallel.

A recording tells of every minimum the first frame in which something is new. Of the nearest pair it
also tells the instants; they are used where it is plain which branch they are of.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from standoff.automaton.branches import BranchAutomaton, BranchEvent, several, unlisted
from standoff.automaton.parallel import SolidAutomaton, automaton_of_branches
from standoff.automaton.transitions import Transition
from standoff.automaton.visits import Mode, Visit
from standoff.bodies.features import Feature
from standoff.errors import StandoffError
from standoff.recording.local_minima import LocalMinima, MinimumEvent
from standoff.recording.recorded import RecordedEvent, RecordedFrames
from standoff.tracking.branches import NONE

Meaning = Callable[[str, Feature, Feature], Transition]


def branch_automaton(recording: RecordedFrames, listed: SolidAutomaton | None) -> SolidAutomaton:
    """Return the automaton of a recording of solids.

    Raises StandoffError if it does not hold the local minima.

    Parameters
    ----------
    recording : RecordedFrames
    listed : SolidAutomaton, optional
        What the solids allow, if they are at hand.
    """
    if recording.minima is None:
        raise StandoffError(
            "The automaton of solids follows each local minimum by itself, and this recording has "
            "the nearest pair alone: track with so.Tracker(a, b, minima=LENGTH), in a scene with "
            "`minima = LENGTH` in [track]. `modes()` has the modes of the nearest, and `events` "
            "its switches."
        )
    run = _Branches(recording, recording.minima, listed)
    for frame in sorted({event.frame for event in recording.minima_events}):
        run.change(frame)
    return automaton_of_branches(listed, recording.info.bodies, run.branches(), run.between)


class _Stay(NamedTuple):
    """Where a branch is, and since when, s."""

    mode: Mode
    since: float


class _Branches:
    """Branches on their way through the frames of a recording."""

    def __init__(
        self, recording: RecordedFrames, minima: LocalMinima, listed: SolidAutomaton | None
    ) -> None:
        self.times = [float(time) for time in recording.time]
        self.nearest = _nearest(minima, len(self.times))
        self.events: dict[int, list[MinimumEvent]] = defaultdict(list)
        for event in recording.minima_events:
            self.events[event.frame].append(event)
        self.switches: dict[int, list[RecordedEvent]] = defaultdict(list)
        for switch in recording.events:
            self.switches[switch.frame].append(switch)
        self.meaning = _meaning(listed)
        self.live: dict[int, _Stay] = {}
        self.visits: dict[int, list[Visit]] = defaultdict(list)
        self.taken: dict[int, list[tuple[float, Transition]]] = defaultdict(list)
        self.between: list[BranchEvent] = []
        self.handed: dict[int, float] = {}

    def change(self, frame: int) -> None:
        """Go on to what is new in a frame."""
        before = {key: stay.mode for key, stay in self.live.items()}
        for event in self.events[frame]:
            if event.kind == "switch":
                self._switch(event)
            elif event.kind == "birth":
                self.live[event.key] = _Stay(event.features, self.times[frame])
            elif event.kind == "end":
                self._leave(event.key, self.times[frame])
                del self.live[event.key]
            elif (found := self._handed_over(event, before)) is not None:
                self.handed[frame] = found
            if event.kind != "switch":
                located = event.kind == "handover" and frame in self.handed
                time = self.handed[frame] if located else self.times[frame]
                self.between.append(
                    BranchEvent(time, event.kind, event.key, event.features, event.distance,
                                event.reason, event.other, located)
                )  # fmt: skip

    def branches(self) -> list[BranchAutomaton]:
        """All of them, by key."""
        last = self.times[-1]
        for key in self.live:
            self._leave(key, last)
        self.between.sort(key=lambda event: event.time)
        spans = self._spans()
        return [
            BranchAutomaton(
                key,
                tuple(self.visits[key]),
                tuple(self.taken[key]),
                tuple(spans[key]),
                tuple(event for event in self.between if event.key == key),
            )
            for key in sorted({event.key for event in self.between})
        ]

    def _leave(self, key: int, time: float) -> None:
        """End the visit of a branch; of several switches at one instant only the last mode is
        visited, as in `Recording.modes`."""
        mode, since = self.live[key]
        if time > since:
            self.visits[key].append(Visit(*mode, since, time))

    def _switch(self, event: MinimumEvent) -> None:
        key, frame, mode = event.key, event.frame, self.live[event.key].mode
        steps = [
            (self.times[frame], body, mode[side], event.features[side])
            for side, body in enumerate("AB")
            if mode[side] != event.features[side]
        ]
        found = self.switches[frame]
        if self._nearest_at(frame - 1) == key == self._nearest_at(frame):
            dated = all(each.located for each in found)
            if dated and _leads(found, mode) == event.features:
                steps = [(each.time, each.body, each.source, each.target) for each in found]
        for time, body, source, target in steps:
            stay = self.live[key]
            self._leave(key, time)
            a, b = stay.mode
            self.live[key] = _Stay(
                (target, b) if body == "A" else (a, target), max(stay.since, time)
            )
            self.taken[key].append((time, self.meaning(body, source, target)))

    def _handed_over(self, event: MinimumEvent, before: dict[int, Mode]) -> float | None:
        """The instant of a handover [s], if it is all that changed the nearest pair's features."""
        old, new = event.other, event.key
        stays = all(key in before and key in self.live for key in (old, new)) and all(
            before[key] == self.live[key].mode for key in (old, new)
        )
        found = self.switches[event.frame]
        if not (stays and found and all(each.located for each in found)):
            return None
        if len({each.time for each in found}) > 1 or _leads(found, before[old]) != before[new]:
            return None
        return found[0].time

    def _nearest_at(self, frame: int) -> int:
        return self.nearest[frame] if frame >= 0 else NONE

    def _spans(self) -> dict[int, list[tuple[float, float]]]:
        """From when to when each branch was the nearest [s], by key."""
        spans: dict[int, list[tuple[float, float]]] = defaultdict(list)
        key, since = NONE, self.times[0]
        for frame, now in enumerate(self.nearest):
            if now == key:
                continue
            time = self.handed.get(frame, self.times[frame])
            if key != NONE:
                spans[key].append((since, time))
            key, since = now, time
        if key != NONE:
            spans[key].append((since, self.times[-1]))
        return spans


def _meaning(listed: SolidAutomaton | None) -> Meaning:
    """What a switch from a feature of a body to another one is."""
    if listed is None:
        return unlisted
    known = {(t.body, t.source, t.target): t for t in listed.transitions}
    return lambda body, source, target: (
        known.get((body, source, target)) or several(body, source, target)
    )


def _nearest(minima: LocalMinima, frames: int) -> list[int]:
    """The key of the nearest minimum that has one, of each frame; -1 where none has."""
    keys = np.full(frames, NONE)
    named = np.flatnonzero(minima.key != NONE)
    each, first = np.unique(minima.frame[named], return_index=True)
    keys[each] = minima.key[named[first]]
    return [int(key) for key in keys]


def _leads(switches: Sequence[RecordedEvent], mode: Mode) -> Mode | None:
    """The mode that switches lead to from another one; None where they do not begin there."""
    features = list(mode)
    for each in switches:
        side = "AB".index(each.body)
        if features[side] != each.source:
            return None
        features[side] = each.target
    return features[0], features[1]
