"""The instants of the switches within one step of a point tracker.

Where the point is known at any time of the step, so is the answer: by the step cut short. A
switch's instant is the root of its switching function, proven by the answers a little before and
after; where there is no such function, as in the paper's law, that of the halving alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy

from standoff.kernels.tolerances import SLOPE
from standoff.points.answer import PointEvent
from standoff.points.minima import PointMinima
from standoff.points.state import Leg, PointState
from standoff.points.tolerances import RELEASE_SLOPES
from standoff.recording.changes import Found, changes
from standoff.recording.tolerances import (
    INSTANT_RESOLUTION,
    INSTANT_ROUNDINGS,
    RATE_STENCIL,
    SWITCH_PROOF,
)
from standoff.typing import Array

ROOT_TRIES = 3
"""Roots that may fail their proof before the halving goes on alone."""

MOST_ANSWERS = 1000
"""Answers within one step: a switch by halving takes some 35."""


class PointWay(NamedTuple):
    """The point's way through a step.

    Attributes
    ----------
    begin, end : float
        Times [s].
    place : function
        Of the time [s]: place and velocity, (3,), or None where no velocity is known.
    """

    begin: float
    end: float
    place: Callable[[float], tuple[Array, Array | None]]


def way_between(before: PointState, x: Array, v: Array | None, h: float) -> PointWay:
    """The way of `h` [s] from a state to a place, (3,): cubic where both velocities are known, else
    straight."""
    start, chord = before.point, x - before.point

    def place(time: float) -> tuple[Array, Array | None]:
        tau = (time - before.time) / h
        if before.velocity is None or v is None:
            return np.asarray(start + tau * chord), None
        first, last = h * before.velocity - chord, h * v - chord
        bow = (1.0 - tau) * first - tau * last
        rate = chord + (1.0 - 2.0 * tau) * bow - tau * (1.0 - tau) * (first + last)
        return start + tau * chord + tau * (1.0 - tau) * bow, rate / h

    return PointWay(before.time, before.time + h, place)


class TooMany(ArithmeticError):
    """More answers than one step is worth."""


class At(NamedTuple):
    """The state at a time [s]."""

    time: float
    state: PointState


class PointStep:
    """One step, to be looked into.

    Parameters
    ----------
    minima : PointMinima
    before : PointState
        At the step's start.
    way : PointWay
    stepped : function
        From a place, (3,), a velocity and the time since the step's start [s] to the state there.
    """

    def __init__(
        self,
        minima: PointMinima[object],
        before: PointState,
        way: PointWay,
        stepped: Callable[[Array, Array | None, float], PointState],
    ) -> None:
        self.minima, self.before, self.way, self.stepped = minima, before, way, stepped
        self.length = way.end - way.begin
        spacing = float(np.spacing(max(abs(way.begin), abs(way.end))))
        self.resolution = max(INSTANT_RESOLUTION * self.length, INSTANT_ROUNDINGS * spacing)
        self.answers = 0

    def switches(self, after: PointState) -> list[PointEvent] | None:
        """The switches up to the state at the step's end; None where they are too many."""
        try:
            found = changes(
                At(self.way.begin, self.before),
                At(self.way.end, after),
                self._look,
                self.resolution,
                self._by_halving,
                self._by_root,
                ROOT_TRIES,
                self._changed,
            )
        except TooMany:
            return None
        return [event for events in found for event in events]

    def _changed(self, low: At, high: At) -> bool:
        return self.minima.changed(low.state, high.state, self.before.branches.next_key)

    def _look(self, time: float, *_: At) -> At:
        """The answer at a time within the step."""
        self.answers += 1
        if self.answers > MOST_ANSWERS:
            raise TooMany(f"more than {MOST_ANSWERS} answers in one step")
        return At(time, self.stepped(*self.way.place(time), time - self.way.begin))

    def _switches(self, low: At, high: At, time: float) -> list[PointEvent]:
        place = self.way.place(time)
        found = self.minima.switches(low.state, high.state, *place, time)
        return [event._replace(located=True) for event in found]

    def _by_halving(self, low: At, high: At) -> list[PointEvent]:
        return [self._sharpened(event) for event in self._switches(low, high, high.time)]

    def _by_root(self, low: At, high: At) -> Found[list[PointEvent]]:
        """The switch where the switching function vanishes, if the answers around are its own."""
        root = self._root(low, high)
        if root is None:
            return None, False
        time, aside = root
        if low.time < time - aside and self._changed(low, self._look(time - aside)):
            return None, True
        if time + aside < high.time and self._changed(self._look(time + aside), high):
            return None, True
        return self._switches(low, high, time), False

    def _root(self, low: At, high: At) -> tuple[float, float] | None:
        """Where the switching function between two states vanishes, and within what of it [s] it
        is below its threshold; None where it does not vanish, or there is none."""
        function = self.minima.function(low.state, high.state)
        if function is None:
            return None

        def value(time: float) -> float:
            return function(self.way.place(time)[0])

        first, last = value(low.time), value(high.time)
        if not first * last <= 0.0 or first == last:
            return None
        root = low.time if first == 0.0 else high.time
        if first != 0.0 != last:
            finest = 2.0 * float(np.spacing(max(abs(low.time), abs(high.time))))
            root = float(scipy.optimize.brentq(value, low.time, high.time, xtol=finest))
        # An event belongs to the frame after its instant, never to the one before.
        root = max(root, math.nextafter(low.time, high.time))
        left = max(root - RATE_STENCIL * self.length, self.way.begin)
        right = min(root + RATE_STENCIL * self.length, self.way.end)
        slope = abs(value(right) - value(left)) / (right - left)
        aside = max(SWITCH_PROOF * self.length, self.resolution)
        if slope > 0.0:
            aside = max(aside, self.minima.threshold(low.state, high.state) / slope)
        return root, aside

    def _sharpened(self, event: PointEvent) -> PointEvent:
        """Move a switch at a Voronoi line from the threshold of release to the line itself."""
        line = self.minima.line(Leg(event.source, event.target))
        near = 0.0 < abs(event.value) <= RELEASE_SLOPES * SLOPE
        if event.kind != "voronoi" or line is None or not near:
            return event
        time = event.time - event.value / event.slope if event.slope else event.time
        if not abs(time - event.time) <= self.length:
            return event
        value, slope = line(*self.way.place(time))
        return event._replace(time=time, value=value, slope=slope)
