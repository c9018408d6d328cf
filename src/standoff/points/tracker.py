"""The signed distance of a moving point to a body, outside and inside."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import ArrayLike

from standoff.bodies.body import Body
from standoff.bodies.features import Feature
from standoff.checks.numbers import positive
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.points.answer import PointProximity
from standoff.points.minima import PointMinima
from standoff.points.planar_minima import PlanarMinima
from standoff.points.spatial_minima import SpatialMinima
from standoff.points.state import AnswerDraft, PointState
from standoff.points.switches import PointStep, PointWay, way_between
from standoff.read_only import KeepsReadOnly
from standoff.shown_names import hides
from standoff.tracking.law_options import Law
from standoff.tracking.laws import DEFAULT_LAW, checked_law
from standoff.typing import Array


@hides("minima", "step_along")
class PointTracker(KeepsReadOnly):
    """Keeps the signed distance of a moving point to a body, inside and outside.

    The body is at home in the world; for a moving body give the point in the body's frame. With a
    planar body the point moves in z = 0.

    Raises TypeError: not a body; not a law. Raises ValueError: the paper's law without switching,
    or with a spatial body; a law with a horizon; and as `Tracker`.

    Parameters
    ----------
    body : Body
        Its swept radius is part of it.
    dt : float
        Frame time [s].
    law : PredictorCorrector or PaperLaw
        As in `Tracker`, which answers outside. Inside ``depth="global"`` proves in every frame that
        no minimum is less, to within ``tolerance`` of a planar body's; ``"local"`` follows those
        that were found. On a planar body the paper's law keeps the parameter on each curve by its
        feedback, where the other law descends to roundoff; it cannot be used for a spatial body.

    Notes
    -----
    Inside, the depth is the least of several local minima, each followed separately.

    A planar body has at least one on each curve, also while the point is outside, and only the
    point's place decides on which side it is. The depth is proven by chords of the boundary, taken
    closer until the bound is within the tolerance. Any nearer minimum that this meets, and any that
    samples of the curves show in a frame, is followed from then on.

    For a spatial body a cold global start proves the depth, and what it finds is followed too. At
    the start, and where the point enters, rays to the boundary find further minima, so ``minima``
    lists those found, not necessarily all.
    """

    def __init__(self, body: Body, dt: float = 1e-3, law: Law = DEFAULT_LAW) -> None:
        if not isinstance(body, Body):
            raise StandoffTypeError(
                f"{shown(body)} is not a Body: make one with so.shapes.", "body", body
            )
        if checked_law(law).within is not None:
            raise StandoffError(
                f"within = {law.within}: a point's minima are followed at any distance, so a "
                "PointTracker has no horizon.",
                "within",
                law.within,
            )
        kind = PlanarMinima if body.dimension == 2 else SpatialMinima
        self.minima: PointMinima[Any] = kind(body, dt, checked_law(law))
        self.body, self.law, self.dt = body, law, self.minima.outer.dt

    def start(self, point: ArrayLike, velocity: ArrayLike | None = None) -> PointState:
        """Find the minima, and the least of them with its proof.

        Raises ValueError: numbers that are not finite, or with a planar body out of z = 0.

        Parameters
        ----------
        point, velocity : array_like, shape (3,), with a planar body also (2,)
            Place [length] and velocity [length/s] in the body's frame.
        """
        x, v = self._read(point, velocity)
        return self._state(self.minima.begun(x, v), x, v, 0.0)

    def start_from(
        self,
        point: ArrayLike,
        parameters: Sequence[float] | Mapping[int, float],
        velocity: ArrayLike | None = None,
        feature: Feature | tuple[str, int] | None = None,
    ) -> PointState:
        """Begin at given parameters of a planar body, one for each curve.

        The paper's law begins exactly there; the other descends from there.

        Raises ValueError as `start`; a spatial body; parameters too few, too many or outside their
        curves; no such feature.

        Parameters
        ----------
        point, velocity : array_like, shape (2,) or (3,)
        parameters : sequence, or mapping of int, to float
            Of curve 0, 1, ...
        feature : Feature, optional
            Of the tracker outside, where the point is there: a vertex, or a curve at its parameter.
            By default the curve that is nearest at its parameter.
        """
        x, v = self._read(point, velocity)
        if not isinstance(self.minima, PlanarMinima):
            raise StandoffError(
                f"{self.body!r} is spatial: start_from begins on the curves of a planar one; call "
                "start.",
                "parameters",
                parameters,
            )
        return self._state(self.minima.begun_from(x, v, parameters, feature), x, v, 0.0)

    def step(
        self,
        state: PointState,
        point: ArrayLike,
        velocity: ArrayLike | None = None,
        dt: float | None = None,
        *,
        locate: bool = True,
    ) -> tuple[PointState, PointProximity]:
        """The answer at a point, from the state of the frame before.

        Raises TypeError: ``state`` is not a state. Raises ValueError as `start`; a time that is not
        positive, or too long for the paper's law; the state of a planar body with a spatial one.

        Parameters
        ----------
        state : PointState
            Of this body; it is not changed.
        point, velocity : array_like, shape (3,), with a planar body also (2,)
            At the end of the step; without velocities the rates are nan, and nothing is fed forward
            but the secant of the last frames.
        dt : float, optional
            Time since the frame before [s]; the tracker's own if not given.
        locate : bool
            Find the instants of the switches within the step, on the point's way between the
            frames: straight, or the cubic through both velocities where both frames have one. It
            takes some further answers in a frame with a switch. Else they get the time of the
            frame.

        Returns
        -------
        (PointState, PointProximity)
        """
        if not isinstance(state, PointState):
            raise StandoffTypeError(
                f"{shown(state)} is not a PointState: get one from tracker.start.", "state", state
            )
        x, v = self._read(point, velocity)
        h = self.dt if dt is None else positive(dt, "dt")
        following = self.step_along(state, x, v, way_between(state, x, v, h), locate)
        return following, following.proximity

    def step_along(
        self, state: PointState, x: Array, v: Array | None, way: PointWay, locate: bool
    ) -> PointState:
        """The state at the end of a way, at a place and velocity, (3,); its clock times the
        switches.
        """
        h = way.end - way.begin

        def stepped(x: Array, v: Array | None, since: float) -> PointState:
            found = self.minima.stepped(state, x, v, since)
            return self._state(found, x, v, state.time + since)

        found = self.minima.stepped(state, x, v, h)
        after = self._state(found, x, v, state.time + h)
        changed = self.minima.changed(state, after, state.branches.next_key)
        if changed and locate:
            events = PointStep(self.minima, state, way, stepped).switches(after)
            if events is not None:
                return after.with_events(events)
        seen = self.minima.switches if changed else self.minima.outer_switches
        return after.with_events(seen(state, after, x, v, way.end, found.told))

    def _read(self, point: ArrayLike, velocity: ArrayLike | None) -> tuple[Array, Array | None]:
        x = self.minima.read(point, "point")
        return x, None if velocity is None else self.minima.read(velocity, "velocity")

    def _state(self, found: AnswerDraft, x: Array, v: Array | None, time: float) -> PointState:
        return found.state(map(self.minima.shown, found.branches), x, v, time)
