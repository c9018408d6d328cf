"""What the minima of a planar and of a spatial body have in common: the switches between them."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any, Generic, TypeVar

import numpy as np

from standoff.bodies.features import Feature
from standoff.kernels.tolerances import SLOPE
from standoff.points.answer import Minimum, PointEvent
from standoff.points.state import AnswerDraft, Leg, PointState
from standoff.points.tolerances import EQUAL_DEPTHS, RELEASE_SLOPES
from standoff.read_only import KeepsReadOnly
from standoff.tracking.branches import Branch
from standoff.tracking.tracker import Tracker
from standoff.typing import Array

S = TypeVar("S")

HOME = np.eye(4)
STANDING = np.zeros(3), np.zeros(3)


class PointMinima(KeepsReadOnly, ABC, Generic[S]):
    """The local minima of the distance from a point to a body's boundary, each a branch.

    Attributes
    ----------
    size : float
        Of the body [length].
    outer : Tracker
        Of the body and the point as a pair.
    """

    size: float
    outer: Tracker

    @abstractmethod
    def read(self, value: Any, name: str) -> Array:
        """A point or a velocity as it is given, (3,)."""

    @abstractmethod
    def begun(self, x: Array, v: Array | None) -> AnswerDraft:
        """The first answer."""

    @abstractmethod
    def stepped(self, state: PointState, x: Array, v: Array | None, h: float) -> AnswerDraft:
        """The answer after a step of `h` [s]."""

    @abstractmethod
    def shown(self, branch: Branch[S]) -> Minimum:
        """A branch as the answer has it."""

    @abstractmethod
    def same(self, one: S, other: S) -> bool:
        """Do two states stand at one minimum?"""

    @abstractmethod
    def at(self, state: S, x: Array) -> S:
        """A minimum, followed to a point, (3,)."""

    @abstractmethod
    def feature(self, state: S) -> Feature:
        """The feature that a minimum is on."""

    @abstractmethod
    def depth(self, state: S, x: Array) -> tuple[float, Array]:
        """Distance of a minimum from the point that it is at, and the unit vector to it, (3,)."""

    @abstractmethod
    def height(self, state: S, x: Array) -> tuple[float, Array]:
        """How far that point is above the boundary, and the outward normal, (3,)."""

    @abstractmethod
    def line(self, leg: Leg) -> Callable[[Array, Array | None], tuple[float, float]] | None:
        """What vanishes between the regions of two features outside, and its rate; None: unknown.

        Of a place and a velocity, (3,).
        """

    @abstractmethod
    def legs(self, before: PointState, after: PointState, told: Sequence[Leg]) -> list[Leg]:
        """The changes of feature outside from one state to another."""

    def threshold(self, before: PointState, after: PointState) -> float:
        """How far from zero a switching function may be at its switch, in its unit."""
        within = before.inside or after.inside
        return EQUAL_DEPTHS * self.size if within else RELEASE_SLOPES * SLOPE

    def least_of_both(
        self, before: PointState, after: PointState, x: Array
    ) -> tuple[S | None, S | None]:
        """The minima that are the least before and after, both followed to a point between."""
        one, other = (
            self.at(state.branches.least.state, x) if len(state.branches) else None
            for state in (before, after)
        )
        return one, other

    def mode(self, state: PointState) -> tuple[bool, Feature | int]:
        """What a switch changes: the side, and the least minimum inside, the feature outside."""
        p = state.proximity
        return p.inside, p.active if p.inside else p.feature

    def changed(self, before: PointState, after: PointState, known: int) -> bool:
        """Are there switches between two states, the earlier one first?

        Keys from `known` on are of branches that have begun since, each state for itself: such a
        key does not tell which minimum it is.
        """
        if not (before.inside and after.inside):
            return self.mode(before) != self.mode(after)
        one, other = before.branches.active, after.branches.active
        if max(one, other) < known:
            if one == other:
                return False
            if after.branches.of_key(one) is not None:
                return True
        # one minimum may have two keys; near the boundary it is followed less surely
        deeper = min(before, after, key=lambda state: state.proximity.distance)
        source, target = self.least_of_both(before, after, deeper.point)
        return source is None or target is None or not self.same(source, target)

    def function(self, before: PointState, after: PointState) -> Callable[[Array], float] | None:
        """What vanishes at the one switch between two states, of a point, (3,); None: unknown."""
        if before.inside and after.inside:
            return lambda x: self._excess(*self.least_of_both(before, after, x), x)
        one, other = before.proximity, after.proximity
        if one.inside == other.inside:
            line = self.line(Leg(one.feature, other.feature))
            return None if line is None else lambda x: line(x, None)[0]
        if one.feature != other.feature:
            return None  # more than the one switch
        state = (before if one.inside else after).branches.least.state
        return lambda x: self.height(self.at(state, x), x)[0]

    def _excess(self, source: S | None, target: S | None, x: Array) -> float:
        """The target's distance less the source's [length]."""
        if source is None or target is None:
            return math.nan
        return self.depth(target, x)[0] - self.depth(source, x)[0]

    def switches(
        self,
        before: PointState,
        after: PointState,
        x: Array,
        v: Array | None,
        time: float,
        told: Sequence[Leg] = (),
    ) -> list[PointEvent]:
        """The switches between two states that have `changed`, in their order.

        Valued at a place and velocity, (3,).
        """
        source, target = self.least_of_both(before, after, x)
        found = []
        another = after.inside or before.branches.active != after.branches.active
        if before.inside and target is not None and another:
            found += self._medial(before, source, target, (x, v, time))
        last = source if target is None else target
        if before.inside and not after.inside and last is not None:
            found.append(self._crossing(last, x, v, time))
        found += self.outer_switches(before, after, x, v, time, told)
        if after.inside and not before.inside and target is not None:
            found.append(self._crossing(target, x, v, time))
        return found

    def outer_switches(
        self,
        before: PointState,
        after: PointState,
        x: Array,
        v: Array | None,
        time: float,
        told: Sequence[Leg],
    ) -> list[PointEvent]:
        """The changes of feature outside alone."""
        found = []
        for leg in self.legs(before, after, told):
            line = self.line(leg)
            value, slope = leg[2:] if line is None else line(x, v)
            found.append(PointEvent(time, "voronoi", leg.source, leg.target, value, slope))
        return found

    def _medial(
        self,
        before: PointState,
        source: S | None,
        target: S,
        at: tuple[Array, Array | None, float],
    ) -> list[PointEvent]:
        x, v, time = at
        feature, value, slope = before.proximity.feature, math.nan, math.nan
        if source is not None:
            if self.same(source, target):
                return []
            feature, value = self.feature(source), self._excess(source, target, x)
            slope = _rate(self.depth(source, x)[1] - self.depth(target, x)[1], v)
        return [PointEvent(time, "medial", feature, self.feature(target), value, slope)]

    def _crossing(self, state: S, x: Array, v: Array | None, time: float) -> PointEvent:
        height, normal = self.height(state, x)
        feature = self.feature(state)
        return PointEvent(time, "crossing", feature, feature, height, _rate(normal, v))


def pose_of(x: Array) -> Array:
    """The pose of a point, (4, 4)."""
    pose = np.eye(4)
    pose[:3, 3] = x
    return pose


def twists(v: Array | None) -> tuple[tuple[Array, Array] | None, tuple[Array, Array] | None]:
    """Twists of the body at home and of a point's velocity."""
    return (None, None) if v is None else (STANDING, (v, np.zeros(3)))


def _rate(direction: Array, v: Array | None) -> float:
    return math.nan if v is None else float(direction @ v)
