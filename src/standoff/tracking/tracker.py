"""The hybrid tracker: two moving bodies, their witness points kept frame by frame."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.features import Feature, feature_of
from standoff.bodies.packing import Ints
from standoff.kernels import events as N
from standoff.kernels import frame as K
from standoff.kernels import tracker as kernels
from standoff.kernels.preparing import prepare
from standoff.motion import Pose, PoseLike, TwistLike
from standoff.read_only import KeepsReadOnly
from standoff.tracking.choices import positive_number
from standoff.tracking.feedback import Feedback, check_stable
from standoff.tracking.inputs import (
    check_in_plane,
    check_pair,
    flat_pose,
    flat_twist,
    place,
    same_body,
)
from standoff.tracking.options import Variants, pack_options
from standoff.tracking.overlap_proof import cores_overlap
from standoff.tracking.proximity import Event, Proximity
from standoff.tracking.state import FrameBuffer, TrackerState
from standoff.tracking.status import Status

Array = NDArray[np.float64]


# Statuses of answers that a proof of overlap may decide.
UNDECIDED = (float(Status.NOT_CERTIFIED.value),)


class Tracker(KeepsReadOnly):
    """Keeps the minimum distance of two convex bodies while they move.

    Parameters
    ----------
    a, b : Body
        Two spatial bodies, or two planar ones (a point, or another body without faces in z = 0,
        goes with both).
    dt : float
        Frame time, s; ``step`` may be given another where frames are uneven.
    law : "predictor-corrector" or "paper"
        Predict with the feedforward and correct with one Newton step (docs/laws.md), or integrate
        the paper's law w = -M⁻¹(K Psi + b), Eq. (12), from the previous frame to this one.
    predictor : "feedforward-2", "feedforward", "secant" or "none"
        Two-step or one-step prediction with the twists; the secant of the last two frames, which
        also serves where no twists are given. For the paper's law "none" leaves the feedforward
        b out.
    integrator : "euler", "heun", "midpoint" or "rk4"
        For the paper's law.
    gain : float
        K of the paper's law, 1/s; default 1/dt. Must be below ``so.max_gain(integrator, dt)``.
    feedback : of so.feedback, optional
        Another feedback for the paper's law, in place of ``gain``.
    realisation : "evaluated" or "integrated"
        The paper's block diagrams: the errors Psi evaluated from Eqs. (1)-(4) at the parameters
        (Fig. 4), or integrated beside them from Psi' = M w + b (Fig. 3).
    saturation : "hold" or "zero"
        At a boundary enter the edge, or, as printed, zero the components of the solved step that
        lead out; "zero" goes with the two switchings below.
    switching : "multipliers", "voronoi" or "none"
        By the slopes at a stationary point, or, as printed, by Voronoi tests on the opposing
        witness point alone, or not at all: the witness points stay on their features.
    solve : "ranked" or "plain"
        By the rank rule (docs/laws.md), or by H as it is, without a safeguard: the raw law.
    tolerance : float
        Gap between distance and lower bound, less the bodies' own slack (``Body.check``),
        relative to the pair's size, above which the predictor-corrector corrects again, then
        restarts. inf: one correction, whatever the gap.
    depth : "global" or "local"
        In penetration, prove in every frame that no direction has a lesser depth, and search for
        it where one may; or follow the local minimum alone, which costs less.
    deadline : int, optional
        Most evaluations a step may take; then it ends with the best certified answer so far, and
        the status DEADLINE where that is not within the tolerance. One more may be made for the
        rates.

    Raises
    ------
    TypeError
        Not a body.
    ValueError
        Unknown names, numbers that are not positive, an unstable feedback, variants that do not
        go together, a planar body with a spatial one, two half-spaces.
    """

    def __init__(
        self,
        a: Body,
        b: Body,
        dt: float = 1e-3,
        law: str = "predictor-corrector",
        predictor: str = "feedforward-2",
        integrator: str = "heun",
        gain: float | None = None,
        tolerance: float = 1e-10,
        *,
        feedback: Feedback | None = None,
        realisation: str = "evaluated",
        saturation: str | None = None,
        switching: str = "multipliers",
        solve: str = "ranked",
        depth: str = "global",
        deadline: int | None = None,
    ) -> None:
        check_pair(a, b)
        self.a, self.b = a, b
        self.dt = positive_number(dt, "dt")
        self.law, self.predictor, self.integrator = law, predictor, integrator
        self.variants = Variants.of(realisation, saturation, switching, solve)
        self.options, self.feedback = pack_options(
            law,
            predictor,
            integrator,
            gain,
            dt,
            tolerance,
            feedback,
            self.variants,
            depth,
            deadline,
        )
        self.depth = depth
        self.deadline = None if deadline is None else int(self.options[K.O_DEADLINE])
        self.packed = self._packed()
        self.planar = a.dimension == 2 or b.dimension == 2
        self._prepare()

    def _prepare(self) -> None:
        """Load, or compile, what the frames can reach: none of them waits for it."""
        prepare(paper=self.law == "paper", planar=self.planar)

    def start(
        self,
        pose_a: PoseLike,
        pose_b: PoseLike,
        twist_a: TwistLike | None = None,
        twist_b: TwistLike | None = None,
    ) -> TrackerState:
        """Find the witness points globally and certify them.

        Parameters
        ----------
        pose_a, pose_b : Pose or what ``Pose.of`` reads
            World poses of the bodies' frames.
        twist_a, twist_b : Twist or what ``Twist.of`` reads, optional
            Velocities at this instant, (v, omega) in world axes.

        Returns
        -------
        TrackerState
            Its ``proximity`` is the answer at these poses.

        Raises
        ------
        ValueError
            No pose or twist, or a planar pair out of its plane.
        """
        return self._start(pose_a, pose_b, twist_a, twist_b, np.zeros(K.N_STATE), 0)

    def start_from(
        self,
        pose_a: PoseLike,
        pose_b: PoseLike,
        feature_a: Feature | tuple[str, int],
        parameters_a: Any,
        feature_b: Feature | tuple[str, int],
        parameters_b: Any,
        twist_a: TwistLike | None = None,
        twist_b: TwistLike | None = None,
        settle: bool | None = None,
    ) -> TrackerState:
        """Begin at given features and parameters, as ``Proximity`` gives them.

        Parameters
        ----------
        pose_a, pose_b, twist_a, twist_b
            As in ``start``.
        feature_a, feature_b : Feature or pair
            ``("face", 0)`` and the like.
        parameters_a, parameters_b : sequence of float
            (u, v) on a face, (u, v, chart) on a face with an atlas (without the chart: the first
            that holds them), (t,) on an edge, () on a vertex.
        settle : bool
            True descends from there to the certified minimum (the default of the
            predictor-corrector), False begins there as it stands (the default of the paper's
            law, whose feedback then does the work).

        Raises
        ------
        ValueError
            As ``start``; no such feature, or parameters outside it.
        """
        state = np.zeros(K.N_STATE)
        place(state, 0, self.a, feature_a, parameters_a)
        place(state, 2, self.b, feature_b, parameters_b)
        settle = self.law != "paper" if settle is None else settle
        return self._start(pose_a, pose_b, twist_a, twist_b, state, 1 if settle else 2)

    def step(
        self,
        state: TrackerState,
        pose_a: PoseLike,
        pose_b: PoseLike,
        twist_a: TwistLike | None = None,
        twist_b: TwistLike | None = None,
        dt: float | None = None,
    ) -> tuple[TrackerState, Proximity]:
        """The witness points at the given poses, from the state of the frame before.

        Parameters
        ----------
        state : TrackerState
            Of this pair; it is not changed.
        pose_a, pose_b : Pose or what ``Pose.of`` reads
            World poses at the end of the step: the answer holds for them.
        twist_a, twist_b : Twist or what ``Twist.of`` reads, optional
            Those at this instant; without any, the prediction is the secant of the last two
            frames and the rates are nan. One twist given, the other body is at rest.
        dt : float, optional
            Time since the frame before, s; the tracker's own if not given.

        Returns
        -------
        (TrackerState, Proximity)

        Raises
        ------
        TypeError
            ``state`` is none.
        ValueError
            A state of another pair; no pose or twist; a time that is not positive, or too long for
            the paper's law; a planar pair out of its plane.
        """
        self.check_state(state)
        flat_a, flat_b, xi_a, xi_b, has_twist = self._motion(pose_a, pose_b, twist_a, twist_b)
        h = self.dt if dt is None else self._frame_time(dt)
        data = state.data.copy()
        out = np.empty(K.N_OUT)
        events = np.empty(N.MAX_EVENTS * N.EVENT_COLUMNS)
        bad = kernels.step(
            self.packed, flat_a, flat_b, xi_a, xi_b, has_twist, h, self.options, data, out, events
        )
        self._refuse(bad, pose_a, pose_b)
        return self._answer(data, out, events, flat_a, flat_b)

    def step_into(
        self,
        buffer: FrameBuffer,
        dt: float | None = None,
    ) -> float:
        """One frame on preallocated arrays, for loops that must not allocate.

        Reads ``buffer.pose_a`` and the others, writes ``buffer.out`` (laid out in
        ``standoff.kernels.frame``) and ``buffer.state`` in place. Returns the distance; where
        the answer is uncertified, ``buffer.proximity()`` says why.
        """
        if buffer.tracker is not self:
            raise ValueError("The buffer belongs to another tracker: make one with tracker.buffer.")
        if self.planar:
            check_in_plane(buffer.pose_a, buffer.pose_b)
        bad = kernels.step(
            self.packed,
            buffer.pose_a,
            buffer.pose_b,
            buffer.twist_a,
            buffer.twist_b,
            buffer.has_twist,
            self.dt if dt is None else self._frame_time(dt),
            self.options,
            buffer.state,
            buffer.out,
            buffer.events,
        )
        if bad:
            self._refuse(bad, _matrix(buffer.pose_a), _matrix(buffer.pose_b))
        if buffer.out[K.STATUS] in UNDECIDED:
            self._name_overlap(buffer.state, buffer.out, buffer.pose_a, buffer.pose_b)
        return float(buffer.out[K.DISTANCE])

    def buffer(self, state: TrackerState) -> FrameBuffer:
        """Arrays for ``step_into`` that begin at a state."""
        self.check_state(state)
        return FrameBuffer(self, state)

    def _frame_time(self, dt: float) -> float:
        """A frame's own time, s: positive, and short enough for the paper's law to be stable."""
        dt = positive_number(dt, "dt")
        if self.law == "paper":
            check_stable(self.feedback, self.integrator, dt)
        return dt

    def check_state(self, state: TrackerState) -> None:
        """Refuse what is no state of this pair: it would be read with this one's features.

        Raises
        ------
        TypeError
            ``state`` is none.
        ValueError
            A state of another pair, or stored by another version.
        """
        if not isinstance(state, TrackerState):
            raise TypeError(f"{state!r} is not a TrackerState: get one from tracker.start.")
        for name, own, other in zip("AB", (self.a, self.b), state.proximity.bodies, strict=True):
            if own is not other and not same_body(own, other):
                raise ValueError(
                    f"The state belongs to another pair: its body {name} is {other!r}, the "
                    f"tracker's is {own!r}."
                )
        if state.data.shape != (K.N_STATE,) or state.data.dtype != np.float64:
            # the kernels write to it by address
            raise ValueError(
                f"The state holds {state.data.dtype} {state.data.shape}, not ({K.N_STATE},) "
                "float64: it was stored by another version; begin with tracker.start."
            )

    def _motion(
        self,
        pose_a: PoseLike,
        pose_b: PoseLike,
        twist_a: TwistLike | None,
        twist_b: TwistLike | None,
    ) -> tuple[Array, Array, Array, Array, bool]:
        flat_a, flat_b = flat_pose(pose_a), flat_pose(pose_b)
        xi_a, xi_b = flat_twist(twist_a, pose_a), flat_twist(twist_b, pose_b)
        has_twist = twist_a is not None or twist_b is not None
        if self.planar:
            check_in_plane(flat_a, flat_b)
        return flat_a, flat_b, xi_a, xi_b, has_twist

    def _start(
        self,
        pose_a: PoseLike,
        pose_b: PoseLike,
        twist_a: TwistLike | None,
        twist_b: TwistLike | None,
        data: Array,
        given: int,
    ) -> TrackerState:
        flat_a, flat_b, xi_a, xi_b, has_twist = self._motion(pose_a, pose_b, twist_a, twist_b)
        out = np.empty(K.N_OUT)
        bad = kernels.start_anywhere(
            self.packed, flat_a, flat_b, xi_a, xi_b, has_twist, self.options, data, given, out
        )
        self._refuse(bad, pose_a, pose_b)
        events = np.empty(0)
        return self._answer(data, out, events, flat_a, flat_b)[0]

    def _packed(self) -> tuple[Ints, Array, Ints, Array]:
        """What the kernels read of both bodies."""
        return self.a.ints, self.a.reals, self.b.ints, self.b.reals

    def __setstate__(self, stored: Any) -> None:
        super().__setstate__(stored)
        # the bodies' own: in another process their formulas have other addresses
        self.packed = self._packed()
        self._prepare()

    def _refuse(self, why: int, pose_a: PoseLike, pose_b: PoseLike) -> None:
        if why == K.FINE:
            return
        if why == K.BAD_TWIST:
            raise ValueError("A twist has a NaN or infinite number: give six finite ones.")
        Pose.of(pose_a if why == K.BAD_POSE_A else pose_b)  # says what is wrong with it
        raise ValueError(
            f"pose_{'ab'[why - K.BAD_POSE_A]}: its rotation is not orthonormal to 1e-9, or its "
            "position is not a length below 1e100."
        )

    def _answer(
        self, data: Array, out: Array, log: Array, flat_a: Array, flat_b: Array
    ) -> tuple[TrackerState, Proximity]:
        if out[K.STATUS] in UNDECIDED:
            self._name_overlap(data, out, flat_a, flat_b)
        data.flags.writeable = False
        time = float(data[K.TIME])
        count = int(out[K.OUT_COUNTS + N.EVENTS])
        events = self._events(log, count, time) if count else ()
        proximity = Proximity(self.a, self.b, out, events, time, (flat_a, flat_b))
        return TrackerState(data, proximity), proximity

    def _events(self, log: Array, count: int, time: float) -> tuple[Event, ...]:
        events = []
        for row in log[: N.EVENT_COLUMNS * count].reshape(count, N.EVENT_COLUMNS):
            body = self.a if row[N.BODY] == 0 else self.b
            source, target = (feature_of(body, int(row[k])) for k in (N.SOURCE, N.TARGET))
            name = "AB"[int(row[N.BODY])]
            value, slope = float(row[N.VALUE]), float(row[N.SLOPE_COLUMN])
            events.append(Event(time, name, source, target, value, slope))
        return tuple(events)

    def _name_overlap(self, data: Array, out: Array, flat_a: Array, flat_b: Array) -> None:
        """Give an uncertified pair without a positive bound the status OVERLAPPING, if proven."""
        if out[K.DISTANCE] <= 0.0 or out[K.LOWER_BOUND] > 0.0 or self.variants.switching == "none":
            return
        if cores_overlap(self.a, self.b, flat_a, flat_b):
            out[K.DISTANCE] = out[K.UPPER_BOUND] = 0.0
            out[K.STATUS] = float(Status.OVERLAPPING.value)
            data[K.LOST] = 1.0


class ColdQuery(Tracker):
    """A tracker that is asked for starts only: what frames need is not compiled for it."""

    def _prepare(self) -> None:
        pass


def _matrix(flat: Array) -> Array:
    matrix = np.eye(4)
    matrix[:3, :3] = flat[:9].reshape(3, 3)
    matrix[:3, 3] = flat[9:]
    return matrix


def distance(a: Body, b: Body, pose_a: PoseLike, pose_b: PoseLike) -> Proximity:
    """The signed minimum distance of two bodies at two poses: cold, global, certified.

    Parameters
    ----------
    a, b : Body
        Two spatial bodies, or two planar ones.
    pose_a, pose_b : Pose or what ``Pose.of`` reads
        World poses of the bodies' frames.

    Returns
    -------
    Proximity
        In penetration ``distance`` is less than 0, the least depth, and ``status`` GLOBAL (or
        LOCAL, where it could not be proven to be the least).

    Raises
    ------
    TypeError
        Not a body.
    ValueError
        No pose; a planar body with a spatial one or out of its plane; two half-spaces.
    """
    return ColdQuery(a, b).start(pose_a, pose_b).proximity
