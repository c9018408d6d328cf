"""One tracker for each local minimum of the distance from a point to a planar body's curves."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.features import Feature
from standoff.points.answer import Minimum
from standoff.points.minima import descend, measured, parameter_rate, within
from standoff.points.planar_boundary import INTERVALS, Bracket, Place, PlanarBoundary
from standoff.points.tolerances import SAME_PARAMETER, SETTLED_RESIDUAL
from standoff.read_only import KeepsReadOnly
from standoff.tracking.state import TrackerState
from standoff.tracking.tracker import Tracker

Array = NDArray[np.float64]

HOME = np.eye(4)
AT_HOME = np.zeros(3), np.zeros(3)
POINT = ("vertex", 0)


LAG = 1.5 / INTERVALS
"""How far, in parts of a curve's range, a tracker may be from the minimum that it follows: it is
known to half a sample, and the paper's law lags."""


class Parallel(NamedTuple):
    """The minima that are tracked, with a state of the paper's law each (none in the other law).

    Attributes
    ----------
    minima : tuple of Minimum
    laws : tuple of TrackerState
    next_key : int
        Of the next minimum that is found.
    brackets : tuple of Bracket
        Where samples showed minima, found or not, at the last point.
    """

    minima: tuple[Minimum, ...]
    laws: tuple[TrackerState, ...]
    next_key: int
    brackets: tuple[Bracket, ...] = ()

    def least(self, active: int, tie: float) -> Minimum:
        """The least minimum; the active one unless another is less by more than `tie` [length]."""
        least = min(self.minima, key=lambda m: m.distance)
        held = self.of_key(active)
        return held if held is not None and held.distance <= least.distance + tie else least

    def of_key(self, key: int) -> Minimum | None:
        """The minimum of a key, if it is still tracked."""
        return next((m for m in self.minima if m.key == key), None)

    def without(self, keys: Iterable[int]) -> Parallel:
        """Without the minima of some keys."""
        gone = set(keys)
        kept = [k for k, m in enumerate(self.minima) if m.key not in gone]
        laws = tuple(self.laws[k] for k in kept) if self.laws else ()
        return self._replace(minima=tuple(self.minima[k] for k in kept), laws=laws)


class ParallelTracker(KeepsReadOnly):
    """Begins, carries and completes the minima.

    Parameters
    ----------
    boundary : PlanarBoundary
    law : Tracker or None
        The paper's law without switching, of the body and a point; None where the minima are
        predicted with the feedforward and corrected to roundoff.
    """

    def __init__(self, boundary: PlanarBoundary, law: Tracker | None) -> None:
        self.boundary, self.law = boundary, law

    def begun(self, places: Iterable[Place], x: Array, v: Array | None) -> Parallel:
        """Begin at some places, as they stand; `x` and `v`, (3,), are the point's."""
        parallel = Parallel((), (), 0, self.boundary.brackets(x[:2]))
        for place in places:
            parallel = self.joined(parallel, place, x, v)
        return parallel

    def joined(self, parallel: Parallel, place: Place, x: Array, v: Array | None) -> Parallel:
        """With one minimum more."""
        edge, t = place
        laws = parallel.laws
        if self.law is not None:
            feature = Feature("edge", edge)
            state = self.law.start_from(
                HOME, pose_of(x), (feature, (t,)), (POINT, ()), *twists(v), settle=False
            )
            laws = (*laws, state)
        minimum = self._measured(edge, t, x, parallel.next_key)
        minima = (*parallel.minima, minimum)
        return parallel._replace(minima=minima, laws=laws, next_key=parallel.next_key + 1)

    def carried(
        self,
        parallel: Parallel,
        before: tuple[Array, Array | None],
        x: Array,
        v: Array | None,
        h: float,
    ) -> Parallel:
        """Carry every minimum over a step of `h` [s] from the point and velocity before."""
        minima, laws = [], []
        for k, m in enumerate(parallel.minima):
            edge = m.feature.index
            if self.law is None:
                t = self._corrected(edge, m.parameter, before, x, h)
            else:
                state, answer = self.law.step(parallel.laws[k], HOME, pose_of(x), *twists(v), dt=h)
                laws.append(state)
                # a walk to the bound may end a rounding beyond it
                t = within(self.boundary, edge, answer.parameters_a[0])
            minima.append(self._measured(edge, t, x, m.key))
        return parallel._replace(minima=tuple(minima), laws=tuple(laws))

    def covered(
        self, parallel: Parallel, active: int, x: Array, v: Array | None
    ) -> tuple[Parallel, int]:
        """Add the minima that samples show and no tracker has; drop those that others have, too.

        A curve whose trackers are still on their way is left alone, unless a minimum is new since
        the last point. Returns how many were added.
        """
        added = 0
        brackets = self.boundary.brackets(x[:2])
        for edge in range(len(self.boundary.curves)):
            own = [m for m in parallel.minima if m.feature.index == edge]
            inner = [b for b in brackets if b.edge == edge]
            new = len(inner) > sum(b.edge == edge for b in parallel.brackets)
            if not new and not all(self.at_rest(m) for m in own):
                continue
            for bracket in inner:
                if not self.known(parallel, edge, bracket.middle):
                    place = edge, descend(self.boundary, edge, bracket.middle, x[:2])
                    parallel = self.joined(parallel, place, x, v)
                    added += 1
            parallel = parallel.without(self._doubles(parallel, edge, active))
        return parallel._replace(brackets=brackets), added

    def known(self, parallel: Parallel, edge: int, t: float) -> bool:
        """Is a parameter one that a tracker stands at, or lags behind by a sample or so?"""
        curve = self.boundary.curves[edge]
        lag = LAG * (curve.last - curve.first)
        own = [m for m in parallel.minima if m.feature.index == edge]
        return any(self._apart(edge, t, m.parameter) <= lag for m in own)

    def at_rest(self, minimum: Minimum) -> bool:
        """Has a tracker settled on a minimum?"""
        return self.law is None or minimum.residual <= SETTLED_RESIDUAL * self.boundary.body.size

    def _corrected(
        self, edge: int, t: float, before: tuple[Array, Array | None], x: Array, h: float
    ) -> float:
        """Predict with the feedforward of the frame before, then correct to roundoff."""
        at, velocity = before
        if velocity is not None:
            rate = parameter_rate(self.boundary, edge, t, at[:2], velocity[:2])
            t = within(self.boundary, edge, t + h * rate)
        return descend(self.boundary, edge, t, x[:2])

    def _measured(self, edge: int, t: float, x: Array, key: int) -> Minimum:
        return Minimum(
            Feature("edge", edge), float(t), *measured(self.boundary, edge, t, x[:2]), key
        )

    def _apart(self, edge: int, t: float, s: float) -> float:
        curve = self.boundary.curves[edge]
        away = abs(t - s)
        return min(away, curve.last - curve.first - away) if curve.closed else away

    def _doubles(self, parallel: Parallel, edge: int, active: int) -> list[int]:
        """Keys of minima that are another's too, or are ends while the curve has others."""
        curve = self.boundary.curves[edge]
        near = SAME_PARAMETER * (curve.last - curve.first)
        own = [m for m in parallel.minima if m.feature.index == edge]
        own.sort(key=lambda m: (m.key != active, m.key))
        kept: list[Minimum] = []
        gone = []
        ends = () if curve.closed else (curve.first, curve.last)
        inner = [m for m in own if m.parameter not in ends]
        for m in own:
            double = any(self._apart(edge, m.parameter, k.parameter) <= near for k in kept)
            if double or (inner and m.parameter in ends and m.key != active):
                gone.append(m.key)
            else:
                kept.append(m)
        return gone


def pose_of(x: Array) -> Array:
    """The pose of a point, (4, 4)."""
    pose = np.eye(4)
    pose[:3, 3] = x
    return pose


def twists(v: Array | None) -> tuple[tuple[Array, Array] | None, tuple[Array, Array] | None]:
    """Twists of the body at home and of a point's velocity."""
    return (None, None) if v is None else (AT_HOME, (v, np.zeros(3)))
