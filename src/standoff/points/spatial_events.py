"""The switches between two frames of a spatial point tracker, located by root finding."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from standoff.points.answer import PointEvent
from standoff.points.depth_branches import Branch, DepthBranches
from standoff.points.tolerances import DEPTH_SWITCH_RESOLUTION, EQUAL_DEPTHS, SAME_NORMAL
from standoff.tracking.state import TrackerState

Array = NDArray[np.float64]


MOST_LEGS = 8
"""Most switches over the medial axis that one step is split into."""


@dataclass(frozen=True)
class Way:
    """The point's way through a step: cubic where both velocities are known, else straight.

    Attributes
    ----------
    start, end : ndarray, shape (3,)
    velocities : pair of ndarray, or None
        At start and end [length/s].
    h : float
        Duration [s].
    """

    start: Array
    end: Array
    velocities: tuple[Array, Array] | None
    h: float

    def point(self, tau: float) -> Array:
        """Place at a part of the step, 0 to 1."""
        chord = self.end - self.start
        if self.velocities is None:
            return np.asarray(self.start + tau * chord)
        first, last = (self.h * v - chord for v in self.velocities)
        bow = (1.0 - tau) * first - tau * last
        return np.asarray(self.start + tau * chord + tau * (1.0 - tau) * bow)

    def velocity(self, tau: float) -> Array | None:
        """Velocity at a part of the step [length/s]; None where none was given."""
        if self.velocities is None:
            return None
        chord = self.end - self.start
        first, last = (self.h * v - chord for v in self.velocities)
        bow = (1.0 - tau) * first - tau * last
        rate = chord + (1.0 - 2.0 * tau) * bow - tau * (1.0 - tau) * (first + last)
        return np.asarray(rate / self.h)


class Switches:
    """Looks into one step of the point for its switches.

    Parameters
    ----------
    minima : DepthBranches
    way : Way
    begin : float
        Time of the step's start [s].
    others : sequence of TrackerState
        Minima of both frames, which may be the least in between.
    """

    def __init__(
        self, minima: DepthBranches, way: Way, begin: float, others: Sequence[TrackerState]
    ) -> None:
        self.minima, self.way, self.begin, self.others = minima, way, begin, others

    def medial(
        self,
        source: TrackerState,
        target: TrackerState,
        first: float = 0.0,
        last: float = 1.0,
        legs: int = MOST_LEGS,
    ) -> list[PointEvent]:
        """Switches from the least minimum at `first` to that at `last`, parts of the step."""
        excess = self._excess(source, target)
        low, high = excess(first), excess(last)
        if self._one(source, target, last) or self._one(source, target, first):
            return []  # one minimum under two keys
        if not low >= 0.0 >= high:
            return [self._medial_event(source, target, last, located=False)]
        tau = _root(excess, first, last, low, high)
        lesser = self._lesser(source, target, tau)
        if lesser is not None and legs > 1:
            return [
                *self.medial(source, lesser, first, tau, legs // 2),
                *self.medial(lesser, target, tau, last, legs // 2),
            ]
        located = abs(excess(tau)) <= EQUAL_DEPTHS * self.minima.size
        if located and self._one(source, target, tau):
            return []
        return [self._medial_event(source, target, tau if located else last, located)]

    def crossing(self) -> tuple[PointEvent, TrackerState, float]:
        """The crossing of the boundary, the state there, and the part of the step."""

        def signed(tau: float) -> float:
            return self.minima.cold(self.way.point(tau)).proximity.distance

        low, high = signed(0.0), signed(1.0)
        located = low * high <= 0.0
        tau = _root(signed, 0.0, 1.0, low, high) if located else 1.0
        state = self.minima.cold(self.way.point(tau))
        p, v = state.proximity, self.way.velocity(tau)
        slope = math.nan if v is None else float(p.normal @ v)
        time = self._time(tau)
        feature = p.feature_a
        event = PointEvent(time, "crossing", feature, feature, p.distance, slope, located)
        return event, state, tau

    def _excess(self, source: TrackerState, target: TrackerState) -> Callable[[float], float]:
        def excess(tau: float) -> float:
            """The target's depth less the source's [length]."""
            one, other = self._both(source, target, tau)
            return one.proximity.distance - other.proximity.distance

        return excess

    def _both(
        self, source: TrackerState, target: TrackerState, tau: float
    ) -> tuple[TrackerState, TrackerState]:
        x = self.way.point(tau)
        return self.minima.at(source, x), self.minima.at(target, x)

    def _one(self, source: TrackerState, target: TrackerState, tau: float) -> bool:
        one, other = (state.proximity.normal for state in self._both(source, target, tau))
        return float(np.linalg.norm(one - other)) <= SAME_NORMAL

    def _lesser(
        self, source: TrackerState, target: TrackerState, tau: float
    ) -> TrackerState | None:
        """A minimum that is less than both at a part of the step, if one is."""
        x = self.way.point(tau)
        goal = max(s.proximity.distance for s in self._both(source, target, tau))
        best = None
        for other in self.others:
            d = self.minima.at(other, x).proximity.distance
            if d > goal + EQUAL_DEPTHS * self.minima.size:
                goal, best = d, other
        return best

    def _medial_event(
        self, source: TrackerState, target: TrackerState, tau: float, located: bool
    ) -> PointEvent:
        one, other = (s.proximity for s in self._both(source, target, tau))
        v = self.way.velocity(tau)
        slope = math.nan if v is None else float((one.normal - other.normal) @ v)
        value = one.distance - other.distance
        features = one.feature_a, other.feature_a
        return PointEvent(self._time(tau), "medial", *features, value, slope, located)

    def _time(self, tau: float) -> float:
        return self.begin + tau * self.way.h


def states_of(*groups: Sequence[Branch]) -> list[TrackerState]:
    """The states of branches."""
    return [branch.state for group in groups for branch in group]


def _root(
    function: Callable[[float], float], first: float, last: float, low: float, high: float
) -> float:
    """Where a function vanishes between two parts of the step, at which its values are given."""
    if low == 0.0:
        return first
    if high == 0.0:
        return last
    return float(scipy.optimize.brentq(function, first, last, xtol=DEPTH_SWITCH_RESOLUTION))
