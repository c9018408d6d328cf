"""The signed distance of a moving point to a spatial body, outside and inside.

Outside it is the tracker of the pair. Inside, the depth is the least of several local minima: one
tracker for each runs in parallel, and the least wins. The switches between them are on the medial
axis.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff.bodies.body import Body
from standoff.checks.arrays import finite
from standoff.checks.numbers import positive
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.points.answer import PointEvent
from standoff.points.depth_branches import Branch, DepthBranches
from standoff.points.parallel_minima import HOME, pose_of, twists
from standoff.points.spatial_answer import (
    SpatialPointProximity,
    SpatialPointState,
    answer_of,
)
from standoff.points.spatial_events import Switches, Way, states_of
from standoff.points.tolerances import TIE
from standoff.read_only import KeepsReadOnly
from standoff.shown_names import hides
from standoff.tracking.laws import PredictorCorrector
from standoff.tracking.state import TrackerState
from standoff.tracking.tracker import Tracker

Array = NDArray[np.float64]


@hides("minima", "outer")
class SpatialPointTracker(KeepsReadOnly):
    """Keeps the signed distance of a moving point to a spatial body, inside and outside.

    The body is at home in the world; for a moving body give the point in the body's frame.

    Parameters
    ----------
    body : Body
        Spatial; its swept radius is part of it. For a planar one there is `PointTracker`.
    dt : float
        Frame time [s].
    tolerance : float
        Of the tracker outside, as in `Tracker`.

    Raises
    ------
    TypeError
        No body.
    ValueError
        A planar body; numbers that are not positive.

    Notes
    -----
    In every frame inside, a cold global start proves the least depth; a minimum that it finds and
    that is not tracked yet is tracked from then on. At the start, and where the point enters,
    rays to the boundary find further minima, so ``minima`` lists those found, not certainly all.
    Switches are located on the point's way between the frames: straight, or the cubic through
    both velocities where both frames have one.
    """

    def __init__(self, body: Body, dt: float = 1e-3, tolerance: float = 1e-10) -> None:
        if not isinstance(body, Body):
            raise StandoffTypeError(
                f"{shown(body)} is not a Body: make one with so.shapes.", "body", body
            )
        if body.dimension == 2:
            raise StandoffError(f"{body!r} is planar: give it to so.PointTracker.", "body", body)
        self.body = body
        self.minima = DepthBranches(body)
        law = PredictorCorrector(tolerance=tolerance)
        self.outer = Tracker(body, self.minima.local.b, dt, law)
        self.dt = self.outer.dt

    def start(self, point: ArrayLike, velocity: ArrayLike | None = None) -> SpatialPointState:
        """Find the least minimum, with its proof, and others.

        Parameters
        ----------
        point, velocity : array_like, shape (3,)
            Place [length] and velocity [length/s] in the body's frame.

        Raises
        ------
        ValueError
            Numbers that are not finite.
        """
        x, v = _given(point, velocity)
        proof = self.outer.start(HOME, pose_of(x), *twists(v))
        branches, key = self._begun(proof, x, 0)
        return self._state(branches, key, -1, proof, x, v, 0.0)

    def step(
        self,
        state: SpatialPointState,
        point: ArrayLike,
        velocity: ArrayLike | None = None,
        dt: float | None = None,
    ) -> tuple[SpatialPointState, SpatialPointProximity]:
        """The answer at a point, from the state of the frame before.

        Parameters
        ----------
        state : SpatialPointState
            Of this body; it is not changed.
        point, velocity : array_like, shape (3,)
            At the end of the step; without velocities the rates are nan.
        dt : float, optional
            Time since the frame before [s]; the tracker's own if not given.

        Returns
        -------
        (SpatialPointState, SpatialPointProximity)

        Raises
        ------
        TypeError
            ``state`` is none.
        ValueError
            As `start`; a time that is not positive.
        """
        if not isinstance(state, SpatialPointState):
            raise StandoffTypeError(
                f"{state!r} is no SpatialPointState: get one from tracker.start.", "state", state
            )
        x, v = _given(point, velocity)
        h = self.dt if dt is None else positive(dt, "dt")
        was_inside, key = state.proximity.inside, state.next_key
        if not was_inside:
            proof = self.outer.step(state.proof, HOME, pose_of(x), *twists(v), dt=h)[0]
        if was_inside or proof.proximity.distance < 0.0:
            proof = self.outer.start(HOME, pose_of(x), *twists(v))
        carried: list[Branch] = []
        if proof.proximity.distance >= 0.0:
            branches = carried
        elif was_inside:
            carried, key = self.minima.carried(state.branches, state.point, x, key)
            branches, key = self.minima.joined(carried, [proof], key)
        else:
            branches, key = self._begun(proof, x, key)
        following = self._state(
            branches,
            key,
            state.proximity.active,
            proof,
            x,
            v,
            state.time + h,
            len(branches) - len(carried),
        )
        following = following.with_events(self._events(state, following, h))
        return following, following.proximity

    def _begun(self, proof: TrackerState, x: Array, key: int) -> tuple[list[Branch], int]:
        if proof.proximity.distance >= 0.0:
            return [], key
        return self.minima.joined([], [proof, *self.minima.seeds(x)], key)

    def _state(
        self,
        branches: list[Branch],
        key: int,
        active: int,
        proof: TrackerState,
        x: Array,
        v: Array | None,
        time: float,
        found: int = 0,
    ) -> SpatialPointState:
        best, chosen = proof, -1
        if branches:
            least = min(branches, key=lambda b: b.depth)
            tie = least.depth + TIE * self.body.size
            held = [b for b in branches if b.key == active and b.depth <= tie]
            best, chosen = (held or [least])[0].state, (held or [least])[0].key
        answer = answer_of(best, proof, tuple(branches), chosen, v, found, time)
        return SpatialPointState(answer, x, v, tuple(branches), key, proof)

    def _events(
        self, before: SpatialPointState, after: SpatialPointState, h: float
    ) -> tuple[PointEvent, ...]:
        was, now = before.proximity, after.proximity
        if not (was.inside or now.inside):
            told = [e for e in after.proof.proximity.events if e.body == "A"]
            return tuple(
                PointEvent(now.time, "voronoi", e.source, e.target, e.value, e.slope) for e in told
            )
        if was.active == now.active:
            return ()
        both = None
        if before.velocity is not None and after.velocity is not None:
            both = before.velocity, after.velocity
        way = Way(before.point, after.point, both, h)
        others = states_of(before.branches, after.branches)
        switches = Switches(self.minima, way, was.time, others)
        if was.inside and now.inside:
            return tuple(switches.medial(before.least.state, after.least.state))
        crossing, there, tau = switches.crossing()
        if was.inside:
            return (*switches.medial(before.least.state, there, 0.0, tau), crossing)
        return (crossing, *switches.medial(there, after.least.state, tau, 1.0))


def _given(point: ArrayLike, velocity: ArrayLike | None) -> tuple[Array, Array | None]:
    """A point and its velocity, (3,), writable: the kernels are compiled for such arrays."""
    x = finite(point, "point", (3,)).copy()
    return x, None if velocity is None else finite(velocity, "velocity", (3,)).copy()
