"""The instants of the switches within one frame's step.

The pose is known at any time from the paths, so the active features are, too: by a descent to the
minimum from a known answer near by, or, for the paper's law, by a step of the law cut short. What
lies between two answers with different features is halved until each part holds one switch; its
instant is the root of its switching function, proven by the features a little before and after;
where there is no such function, the halving goes on to the resolution.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy

from standoff.bodies.features import Feature, feature_of
from standoff.kernels.tolerances import SLOPE
from standoff.recording.changes import Found, changes
from standoff.recording.recording import RecordedEvent
from standoff.recording.switching_function import NoMinimum, switching_function
from standoff.recording.tolerances import (
    INSTANT_RESOLUTION,
    INSTANT_ROUNDINGS,
    PROOF_SLOPE,
    RATE_STENCIL,
    SWITCH_PROOF,
)
from standoff.tracking.calls import DESCEND, FrameInput, start, step
from standoff.tracking.laws import PaperLaw
from standoff.tracking.proximity import Event
from standoff.tracking.rows import AnswerRows, StateRow
from standoff.tracking.state import TrackerState
from standoff.tracking.status import Status
from standoff.tracking.tracker import Tracker
from standoff.typing import Array

Motion = tuple[Array, Array, Array, Array]
"""Flat poses of A and B, (12,), and their twists, (6,)."""


ROOT_TRIES = 3
"""Roots that may fail their proof before the halving goes on alone."""

MOST_ANSWERS = 1000
"""Answers within one step. A switch by halving takes some 40; a body that turns many times within
the step switches without end, and its switches are then not located."""


def resolution_between(before: float, after: float) -> float:
    """How finely a switch between two times [s] is dated, s."""
    spacing = INSTANT_ROUNDINGS * float(np.spacing(max(abs(before), abs(after))))
    return max(INSTANT_RESOLUTION * (after - before), spacing)


class ModeAtTime(NamedTuple):
    """The answer at one time: its mode is the pair of packed features."""

    time: float
    row: Array

    @property
    def mode(self) -> tuple[int, int]:
        a, _, b, _ = AnswerRows(self.row).mode
        return int(a), int(b)


class ModeSwitch(NamedTuple):
    """A change of mode at a time; value and slope are those of its switching function."""

    time: float
    before: tuple[int, int]
    after: tuple[int, int]
    value: float = math.nan
    slope: float = math.nan


class NotKnown(ArithmeticError):
    """The features at some time within the step are not certain."""


class FrameStep:
    """One frame's step, to be looked into.

    Parameters
    ----------
    tracker : Tracker
    motion : callable
        The motion at a time [s].
    state : TrackerState
        Of the frame before.
    before, after : float
        Times of that frame and this one [s].
    row : ndarray
        This frame's flat answer.
    """

    def __init__(
        self,
        tracker: Tracker,
        motion: Callable[[float], Motion],
        state: TrackerState,
        before: float,
        after: float,
        row: Array,
    ) -> None:
        self.tracker, self.motion, self.state = tracker, motion, state
        self.pair = tracker.a, tracker.b
        self.first, self.last = ModeAtTime(before, state.proximity.row), ModeAtTime(after, row)
        self.length = after - before
        self.resolution = resolution_between(before, after)
        self.paper = isinstance(tracker.law, PaperLaw)
        self.answers = 0

    def switches(self) -> list[ModeSwitch] | None:
        """Return the switches in order of time; None where one of them cannot be located."""
        try:
            if not self.paper:
                for end in self.first, self.last:
                    if self._descended(end.time, end).mode != end.mode:
                        return None
            return changes(
                self.first,
                self.last,
                self._known,
                self.resolution,
                lambda low, high: ModeSwitch(high.time, low.mode, high.mode),
                None if self.paper else self._by_root,
                ROOT_TRIES,
            )
        except NotKnown:
            return None

    def _known(self, time: float, low: ModeAtTime, high: ModeAtTime) -> ModeAtTime:
        self.answers += 1
        if self.answers > MOST_ANSWERS:
            raise NotKnown(f"more than {MOST_ANSWERS} answers in one step")
        if self.paper:
            return self._stepped(time)
        # From the higher features: a slope too small to release a feature does not hold it there.
        return self._descended(time, max(low, high, key=self._freedom))

    def _freedom(self, known: ModeAtTime) -> int:
        return sum(
            ("vertex", "edge", "face").index(feature_of(body, number).kind)
            for body, number in zip(self.pair, known.mode, strict=True)
        )

    def _descended(self, time: float, near: ModeAtTime) -> ModeAtTime:
        """Descend to the minimum at a time from the features and parameters of a known answer."""
        row, state = AnswerRows(near.row), StateRow()
        state.mode, state.q = row.mode, row.q
        tracker = self.tracker
        frame = FrameInput(*self.motion(time), True)
        found, fine = start(tracker.table, frame, state, DESCEND)
        if not fine or found.status != Status.CONVERGED.value:
            raise NotKnown(f"no certified answer at {time} s")
        return ModeAtTime(time, found.data)

    def _stepped(self, time: float) -> ModeAtTime:
        """Step the law from the frame before to a time within."""
        tracker, state = self.tracker, StateRow(self.state.data.copy())
        h = time - self.first.time
        found, fine = step(tracker.table, FrameInput(*self.motion(time), True), h, state)
        if not fine or found.status not in (Status.CONVERGED.value, Status.TRACKING.value):
            raise NotKnown(f"no answer at {time} s")
        return ModeAtTime(time, found.data)

    def _by_root(self, low: ModeAtTime, high: ModeAtTime) -> Found[ModeSwitch]:
        root = self._root(low, high)
        if root is None or self._proven(root, low, high):
            return root, False
        return None, True

    def _root(self, low: ModeAtTime, high: ModeAtTime) -> ModeSwitch | None:
        """Return the root of the switching function between two answers, if there is one."""
        bodies = [s for s in range(2) if low.mode[s] != high.mode[s]]
        if len(bodies) > 1:
            return None
        rising = self._freedom(low) > self._freedom(high)
        lower, higher = (high, low) if rising else (low, high)
        function = switching_function(self.pair, bodies[0], lower.row, higher.row)
        if function is None:
            return None
        sign = 1.0 if rising else -1.0

        def value(time: float) -> float:
            return sign * function(*self.motion(time)[:2])

        try:
            # The end with the lower feature first: its own minimum is the held one.
            ends = {known.time: value(known.time) for known in (lower, higher)}
            at = _crossing(value, low.time, high.time, ends)
            if at is None:
                return None
            reach = RATE_STENCIL * self.length
            left, right = max(at - reach, self.first.time), min(at + reach, self.last.time)
            slope = sign * (value(right) - value(left)) / (right - left)
            return ModeSwitch(at, low.mode, high.mode, sign * value(at), slope)
        except NoMinimum:
            return None

    def _proven(self, root: ModeSwitch, low: ModeAtTime, high: ModeAtTime) -> bool:
        """Are the features just before and after a root those of the two answers around it?"""
        aside = max(SWITCH_PROOF * self.length, self.resolution)
        if root.slope != 0.0:
            aside = max(aside, PROOF_SLOPE / abs(root.slope))
        for at, end in (root.time - aside, low), (root.time + aside, high):
            inside = low.time < at < high.time
            if inside and self._known(at, low, high).mode != end.mode:
                return False
        return True


def _crossing(
    value: Callable[[float], float], low: float, high: float, ends: dict[float, float]
) -> float | None:
    """Return where a function that is negative at `low` and positive at `high` is zero.

    None where it is not so; within the threshold of release an end itself may be the root.
    """
    # An event belongs to the frame after its instant, never to the one before.
    if ends[low] >= 0.0:
        return math.nextafter(low, high) if ends[low] <= SLOPE else None
    if ends[high] <= 0.0:
        return high if ends[high] >= -SLOPE else None
    finest = 2.0 * float(np.spacing(max(abs(low), abs(high))))
    root = float(
        scipy.optimize.brentq(value, low, high, xtol=finest, rtol=4.0 * np.finfo(float).eps)
    )
    return max(root, math.nextafter(low, high))


def located_events(
    step: FrameStep, frame: int, told: tuple[Event, ...]
) -> list[RecordedEvent] | None:
    """Return a frame's events with their instants; None where they cannot be located.

    Parameters
    ----------
    step : FrameStep
    frame : int
    told : tuple of Event
        The tracker's own events of this frame. Where several lie at one instant their features
        are in its order.
    """
    switches = step.switches()
    if switches is None:
        return None
    events = []
    for switch in switches:
        for s, body in enumerate(step.pair):
            source, target = (feature_of(body, mode[s]) for mode in (switch.before, switch.after))
            if source != target:
                way = _way([event for event in told if event.body == "AB"[s]], source, target)
                events += [
                    RecordedEvent(
                        frame, switch.time, "AB"[s], *leg, switch.value, switch.slope, located=True
                    )
                    for leg in way
                ]
    return events


def _way(told: list[Event], source: Feature, target: Feature) -> list[tuple[Feature, Feature]]:
    """Return the legs from source to target that the tracker told, else the one leg."""
    legs = [(event.source, event.target) for event in told]
    sources, targets = [leg[0] for leg in legs], [leg[1] for leg in legs]
    if source in sources and target in targets:
        first, last = sources.index(source), targets.index(target)
        if first <= last:
            return legs[first : last + 1]
    return [(source, target)]
