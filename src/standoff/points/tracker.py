"""The signed distance of a moving point to a planar body, outside and inside.

Outside it is the hybrid automaton of `Tracker`. Inside, the depth is the least of the distances to
the curves: one tracker for each local minimum runs in parallel, and the least wins. The switches
between them are on the medial axes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff.bodies import shapes
from standoff.bodies.body import Body
from standoff.bodies.features import Feature
from standoff.checks.arrays import finite
from standoff.checks.numbers import positive
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.points.answer import PointProximity
from standoff.points.events import Switching, events_between
from standoff.points.minima import descend
from standoff.points.parallel_minima import (
    HOME,
    POINT,
    Parallel,
    ParallelTracker,
    pose_of,
    twists,
)
from standoff.points.planar_boundary import Place, PlanarBoundary
from standoff.points.state import Answering, Found, PointState
from standoff.points.tolerances import ENTRY_INSTANT, TIE
from standoff.read_only import KeepsReadOnly
from standoff.shown_names import hides
from standoff.tracking.law_options import Law
from standoff.tracking.laws import DEFAULT_LAW, PaperLaw
from standoff.tracking.state import TrackerState
from standoff.tracking.status import Status
from standoff.tracking.tracker import Tracker

Array = NDArray[np.float64]


MOST_RESTARTS = 4
"""Nearer points, met by the certificate, that one frame follows up."""


@hides("answering", "boundary", "outer", "parallel")
class PointTracker(KeepsReadOnly):
    """Keeps the signed distance of a moving point to a planar body, inside and outside.

    The body is at home in the world, and the point moves in z = 0; for a moving body give the
    point in the body's frame.

    Parameters
    ----------
    body : Body
        Planar: ``body.dimension`` is 2.
    dt : float
        Frame time [s].
    law : PredictorCorrector or PaperLaw
        As in `Tracker`. In the first the minima are predicted with the feedforward and corrected
        to roundoff; in the paper's law each is kept by its feedback. Its switching is that of the
        automaton outside; the instants of "voronoi", as printed, do not depend on the parameters.

    Raises
    ------
    TypeError
        No body, no law.
    ValueError
        A body that is not planar, no switching, and as `Tracker`.

    Notes
    -----
    The point's place alone tells on which side it is (`PlanarBoundary.inside`). The depth is
    proven by chords of the boundary, taken closer until the bound is within the tolerance; where
    that meets a nearer point than the answer, a tracker is started there, and counted. A local
    minimum that appears on a curve is seen by sampling every frame.
    """

    def __init__(self, body: Body, dt: float = 1e-3, law: Law = DEFAULT_LAW) -> None:
        if not isinstance(body, Body):
            raise StandoffTypeError(
                f"{shown(body)} is not a Body: make one by so.shapes.planar_loop.", "body", body
            )
        if body.dimension != 2:
            raise StandoffError(
                f"{body!r} is not planar: give one of so.shapes.planar_loop, or give it to "
                "so.points.SpatialPointTracker.",
                "body",
                body,
            )
        paper = isinstance(law, PaperLaw)
        if isinstance(law, PaperLaw) and law.switching == "none":
            raise StandoffError(
                "switching='none' stays on one feature: give 'multipliers' or 'voronoi'.",
                "law",
                law,
            )
        self.body = body
        core = body if body.radius == 0.0 else _core(body)
        self.boundary = PlanarBoundary(core)
        point = shapes.point()
        self.outer = Tracker(core, point, dt, law)
        self.law, self.dt, self.tolerance = law, self.outer.dt, law.tolerance
        inner = None
        if isinstance(law, PaperLaw):
            held = replace(law, tolerance=math.inf, switching="none", saturation=None)
            inner = Tracker(core, point, dt, held)
        self.parallel = ParallelTracker(self.boundary, inner)
        doubt = Status.TRACKING if paper else Status.NOT_CERTIFIED
        gap = self.tolerance * body.size
        self.answering = Answering(self.boundary, body.radius, gap, doubt)

    def start(self, point: ArrayLike, velocity: ArrayLike | None = None) -> PointState:
        """Find all minima, and the least of them.

        Parameters
        ----------
        point, velocity : array_like, shape (2,) or (3,)
            Place [length] and velocity [length/s].

        Raises
        ------
        ValueError
            Numbers that are not finite, or out of z = 0.
        """
        x, v = _in_plane(point, "point"), _velocity(velocity)
        places: list[Place] = []
        brackets = self.boundary.brackets(x[:2])
        for edge in range(len(self.boundary.curves)):
            starts = [b.middle for b in brackets if b.edge == edge]
            starts = starts or [self.boundary.nearest_sample(edge, x[:2])]
            places += [(edge, descend(self.boundary, edge, t, x[:2])) for t in starts]
        return self._begun(x, v, places, None)

    def start_from(
        self,
        point: ArrayLike,
        parameters: Sequence[float] | Mapping[int, float],
        velocity: ArrayLike | None = None,
        feature: Feature | tuple[str, int] | None = None,
    ) -> PointState:
        """Begin at given parameters, one for each curve.

        The paper's law begins there as it stands; the other descends from there.

        Parameters
        ----------
        point, velocity : array_like, shape (2,) or (3,)
        parameters : sequence, or mapping of int, to float
            Of curve 0, 1, ...
        feature : Feature, optional
            Of the automaton, where the point is outside: a vertex, or a curve at its parameter.
            By default the curve that is nearest at its parameter.

        Raises
        ------
        ValueError
            As `start`; parameters too few, too many or outside their curves; no such feature.
        """
        x, v = _in_plane(point, "point"), _velocity(velocity)
        table = parameters if isinstance(parameters, Mapping) else dict(enumerate(parameters))
        curves = self.boundary.curves
        if sorted(table) != list(range(len(curves))):
            raise StandoffError(
                f"parameters = {parameters!r}: give one for each of {len(curves)} curves.",
                "parameters",
                parameters,
            )
        for edge, curve in enumerate(curves):
            if not curve.first <= table[edge] <= curve.last:
                raise StandoffError(
                    f"Parameter {table[edge]} lies outside curve {edge}: "
                    f"[{curve.first}, {curve.last}].",
                    "parameters",
                    parameters,
                )
        places = [(edge, float(table[edge])) for edge in range(len(curves))]
        if not isinstance(self.law, PaperLaw):
            places = [(edge, descend(self.boundary, edge, t, x[:2])) for edge, t in places]
        return self._begun(x, v, places, feature)

    def step(
        self,
        state: PointState,
        point: ArrayLike,
        velocity: ArrayLike | None = None,
        dt: float | None = None,
    ) -> tuple[PointState, PointProximity]:
        """The answer at a point, from the state of the frame before.

        Parameters
        ----------
        state : PointState
            Of this body; it is not changed.
        point, velocity : array_like, shape (2,) or (3,)
            At the end of the step; without velocities nothing is fed forward but the secant of
            the last frames in the paper's law, and the rates are nan.
        dt : float, optional
            Time since the frame before [s]; the tracker's own if not given.

        Returns
        -------
        (PointState, PointProximity)

        Raises
        ------
        TypeError
            ``state`` is none.
        ValueError
            As `start`; a time that is not positive, or too long for the paper's law.
        """
        if not isinstance(state, PointState):
            raise StandoffTypeError(
                f"{state!r} is no PointState: get one from tracker.start.", "state", state
            )
        x, v = _in_plane(point, "point"), _velocity(velocity)
        h = self.dt if dt is None else positive(dt, "dt")
        side = self.boundary.inside(x[:2])
        inside = state.proximity.inside if side is None else side
        before = state.point, state.velocity
        parallel = self.parallel.carried(state.parallel, before, x, v, h)
        active = state.proximity.active
        left = parallel.of_key(active)
        parallel, fresh = self.parallel.covered(parallel, active, x, v)
        if inside:
            found = self._inside(parallel, active, x, v)
        else:
            found = self._outside(parallel, active, state.outside, None, x, v, h)
        after = found.moment(inside)
        at = Switching(self.boundary, x[:2], None if v is None else v[:2])
        time = state.time + h
        events = events_between(state.moment, after, left, found.told, at, time)
        following = self.answering.state(found, inside, x, v, time, fresh, events)
        return following, following.proximity

    def _begun(
        self,
        x: Array,
        v: Array | None,
        places: Sequence[Place],
        feature: Feature | tuple[str, int] | None,
    ) -> PointState:
        parallel = self.parallel.begun(places, x, v)
        inside = self.boundary.inside(x[:2]) is not False
        if inside:
            found = self._inside(parallel, -1, x, v)
        else:
            found = self._outside(parallel, -1, None, feature, x, v, self.dt)
        return self.answering.state(found, inside, x, v, 0.0)

    def _inside(self, parallel: Parallel, active: int, x: Array, v: Array | None) -> Found:
        """The least minimum, certified; nearer points that the certificate meets are followed."""
        size = self.body.size
        restarts = samples = 0
        while True:
            best = parallel.least(active, TIE * size)
            place = best.feature.index, best.parameter
            goal = best.distance - self.tolerance * size
            bounds = self.boundary.bounds(x[:2], place, goal)
            samples += bounds.samples
            if bounds.distance >= goal or restarts == MOST_RESTARTS:
                break
            edge, t = bounds.nearest
            own = [m for m in parallel.minima if m.feature.index == edge]
            on_the_way = not all(self.parallel.at_rest(m) for m in own)
            if on_the_way or (
                isinstance(self.law, PaperLaw) and self.parallel.known(parallel, edge, t)
            ):
                break  # the law will come to it
            restarts += 1
            place = edge, descend(self.boundary, edge, t, x[:2])
            parallel = self.parallel.joined(parallel, place, x, v)
        return Found(
            parallel,
            best.key,
            -best.distance,
            (-best.distance, -bounds.depth),
            np.append(self.boundary.point(*place), 0.0),
            best.feature,
            (best.parameter,),
            best.residual,
            restarts=restarts,
            samples=samples,
        )

    def _outside(
        self,
        parallel: Parallel,
        active: int,
        before: TrackerState | None,
        feature: Feature | tuple[str, int] | None,
        x: Array,
        v: Array | None,
        h: float,
    ) -> Found:
        """The automaton's answer; it is entered at the least minimum, or at a given feature."""
        best = parallel.least(active, TIE * self.body.size)
        pose = pose_of(x)
        if before is None:
            at = best.feature if feature is None else Feature(*feature)
            own = [m for m in parallel.minima if m.feature == at]
            t = (min(own, key=lambda m: m.distance).parameter,) if own else ()
            outside = self.outer.start_from(HOME, pose, (at, t), (POINT, ()), *twists(v))
            answer = outside.proximity
            if isinstance(self.law, PaperLaw) and feature is None:
                instant = ENTRY_INSTANT * h
                outside, answer = self.outer.step(outside, HOME, pose, *twists(v), dt=instant)
        else:
            outside, answer = self.outer.step(before, HOME, pose, *twists(v), dt=h)
        if answer.status.penetrating:  # within roundoff of the boundary
            edge, t0 = best.feature.index, best.parameter
            witness = np.append(self.boundary.point(edge, t0), 0.0)
            return Found(
                parallel,
                best.key,
                best.distance,
                (0.0, best.distance),
                witness,
                best.feature,
                (t0,),
                best.residual,
            )
        return Found(
            parallel,
            best.key,
            answer.distance,
            (max(answer.lower_bound, 0.0), answer.distance),
            answer.point_a,
            answer.feature_a,
            answer.parameters_a,
            answer.residual,
            outside,
            tuple((e.source, e.target) for e in answer.events if e.body == "A"),
            answer.counts.restarts if before is not None else 0,
        )


def _core(body: Body) -> Body:
    """A body without its swept radius."""
    return Body.from_brep(
        body.vertex_points, body.edge_parts, dimension=2, name=f"core of {body.name}"
    )


def _in_plane(value: ArrayLike, name: str) -> Array:
    """A point or velocity, (3,), in z = 0."""
    shape = (2,) if np.shape(value) == (2,) else (3,)
    given = finite(value, name, shape)
    if shape == (3,) and given[2] != 0.0:
        raise StandoffError(
            f"{name} = {given} is out of z = 0, where a planar body is.", name, value
        )
    return np.append(given[:2], 0.0)


def _velocity(value: ArrayLike | None) -> Array | None:
    return None if value is None else _in_plane(value, "velocity")
