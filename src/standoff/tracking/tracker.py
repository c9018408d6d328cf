"""The hybrid tracker: two moving bodies, their witness points kept frame by frame."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.packing import Ints
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.entries import tracker as kernels
from standoff.kernels.entries.preparing import prepare
from standoff.kernels.pair import events as N
from standoff.kernels.state import arrays as K
from standoff.motion import PoseLike, TwistLike
from standoff.read_only import KeepsReadOnly
from standoff.shown_names import hides
from standoff.spellings import no_attribute
from standoff.tracking.choices import positive_number
from standoff.tracking.inputs import (
    check_in_plane,
    check_pair,
    flat_and_mark,
    flat_twist,
    refuse_twists,
    repair,
    same_body,
)
from standoff.tracking.law_options import Law
from standoff.tracking.laws import DEFAULT_LAW, PaperLaw, checked_law
from standoff.tracking.old_spellings import ATTRIBUTES, takes_a_law, takes_places
from standoff.tracking.options import resolved_options
from standoff.tracking.overlap_proof import cores_overlap
from standoff.tracking.places import PlaceLike, put
from standoff.tracking.proximity import Proximity, events_of
from standoff.tracking.rows import StateRow, motion_row, poses_of, twists_of
from standoff.tracking.state import FrameBuffer, TrackerState
from standoff.tracking.status import Status

Array = NDArray[np.float64]


# Statuses of answers that a proof of overlap may decide.
UNDECIDED = (float(Status.NOT_CERTIFIED.value),)


@hides("check_state", "options", "packed", "planar")
class Tracker(KeepsReadOnly):
    """Keeps the minimum distance of two convex bodies while they move.

    Parameters
    ----------
    a, b : Body
        Two spatial bodies, or two planar ones (a point, or another body without faces in z = 0,
        goes with both).
    dt : float
        Frame time, s; ``step`` may be given another where frames are uneven.
    law : PredictorCorrector or PaperLaw
        How the witness points are kept, with all options.

    Attributes
    ----------
    a, b, dt, law
        As given.

    Raises
    ------
    TypeError
        Not a body; no law.
    ValueError
        A number that is not positive, a feedback that is not stable at `dt`, a planar body with a
        spatial one, two half-spaces.
    """

    @takes_a_law("so.Tracker(a, b, dt, law={law})", ("self", "a", "b", "dt"))
    def __init__(self, a: Body, b: Body, dt: float = 1e-3, law: Law = DEFAULT_LAW) -> None:
        check_pair(a, b)
        self.a, self.b = a, b
        self.dt = positive_number(dt, "dt")
        self.law = checked_law(law)
        self.resolved_law, self.options = resolved_options(law, self.dt)
        self.packed = self._packed()
        self.planar = a.dimension == 2 or b.dimension == 2
        self._prepare()

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            raise no_attribute(self, name, ATTRIBUTES)

    def _prepare(self) -> None:
        """Load, or compile, what the frames can reach: none of them waits for it."""
        prepare(paper=isinstance(self.law, PaperLaw), planar=self.planar)

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

    @takes_places
    def start_from(
        self,
        pose_a: PoseLike,
        pose_b: PoseLike,
        place_a: PlaceLike,
        place_b: PlaceLike,
        twist_a: TwistLike | None = None,
        twist_b: TwistLike | None = None,
        *,
        settle: bool | None = None,
    ) -> TrackerState:
        """Begin at a given place of each body, as ``Proximity.place_a`` and ``place_b`` give them.

        Parameters
        ----------
        pose_a, pose_b, twist_a, twist_b
            As in ``start``.
        place_a, place_b : (feature, parameters)
            A feature, ``("face", 0)`` and the like, and its parameters: (u, v) on a face,
            (u, v, chart) on a face with an atlas (without the chart: the first that holds them),
            (t,) on an edge, () on a vertex.
        settle : bool
            True descends from there to the certified minimum (the default of the
            predictor-corrector), False begins there as it stands (the default of the paper's
            law, whose feedback then does the work).

        Raises
        ------
        ValueError
            As ``start``; no place, no such feature, or parameters outside it.
        """
        state = StateRow()
        put(state, 0, self.a, place_a)
        put(state, 1, self.b, place_b)
        settle = not isinstance(self.law, PaperLaw) if settle is None else settle
        return self._start(pose_a, pose_b, twist_a, twist_b, state.data, 1 if settle else 2)

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
        motion, has_twist, repaired = self._motion(pose_a, pose_b, twist_a, twist_b)
        h = self.dt if dt is None else self._frame_time(dt)
        data = state.data.copy()
        out = np.empty(K.N_OUT)
        events = np.empty(N.MAX_EVENTS * N.EVENT_COLUMNS)
        options = self.options
        while bad := kernels.step(self.packed, motion, has_twist, h, options, data, out, events):
            repaired += self._repair(bad, motion)
        return self._answer(data, out, events, motion, repaired)

    def step_into(
        self,
        buffer: FrameBuffer,
        dt: float | None = None,
    ) -> float:
        """One frame on preallocated arrays, for loops that must not allocate.

        Reads ``buffer.pose_a`` and the others, writes ``buffer.out`` (laid out in
        ``standoff.kernels.state.arrays``) and ``buffer.state`` in place. A rounded rotation is
        repaired in the buffer, which ``buffer.repaired`` counts. Returns the distance; where
        the answer is uncertified, ``buffer.proximity()`` says why.
        """
        if buffer.tracker is not self:
            raise StandoffError(
                "The buffer belongs to another tracker: make one with tracker.buffer.", "buffer"
            )
        if self.planar:
            check_in_plane(buffer.pose_a, buffer.pose_b)
        h = self.dt if dt is None else self._frame_time(dt)
        written = buffer.state, buffer.out, buffer.events
        buffer.repaired = 0
        while bad := kernels.step(
            self.packed, buffer.motion, buffer.has_twist, h, self.options, *written
        ):
            buffer.repaired += self._repair(bad, buffer.motion)
        if buffer.out[K.STATUS] in UNDECIDED:
            self._name_overlap(buffer.state, buffer.out, buffer.motion)
        return float(buffer.out[K.DISTANCE])

    def buffer(self, state: TrackerState) -> FrameBuffer:
        """Arrays for ``step_into`` that begin at a state."""
        self.check_state(state)
        return FrameBuffer(self, state)

    def _frame_time(self, dt: float) -> float:
        """A frame's own time, s: positive, and short enough for the paper's law to be stable."""
        dt = positive_number(dt, "dt")
        self.resolved_law.check_step(dt)
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
            raise StandoffTypeError(
                f"{state!r} is not a TrackerState: get one from tracker.start.", "state", state
            )
        for name, own, other in zip("AB", (self.a, self.b), state.proximity.bodies, strict=True):
            if own is not other and not same_body(own, other):
                raise StandoffError(
                    f"The state belongs to another pair: its body {name} is {other!r}, the "
                    f"tracker's is {own!r}.",
                    "state",
                    state,
                )
        if state.data.shape != (K.N_STATE,) or state.data.dtype != np.float64:
            # the kernels write to it by address
            raise StandoffError(
                f"The state holds {state.data.dtype} {state.data.shape}, not ({K.N_STATE},) "
                "float64: it was stored by another version; begin with tracker.start.",
                "state",
                state,
            )

    def _motion(
        self,
        pose_a: PoseLike,
        pose_b: PoseLike,
        twist_a: TwistLike | None,
        twist_b: TwistLike | None,
    ) -> tuple[Array, bool, int]:
        """The poses and twists as the kernels read them; are there twists; poses repaired."""
        (flat_a, mark_a), (flat_b, mark_b) = flat_and_mark(pose_a), flat_and_mark(pose_b)
        xi_a, xi_b = flat_twist(twist_a, pose_a), flat_twist(twist_b, pose_b)
        has_twist = twist_a is not None or twist_b is not None
        if self.planar:
            check_in_plane(flat_a, flat_b)
        return motion_row(flat_a, flat_b, xi_a, xi_b), has_twist, mark_a + mark_b

    def _start(
        self,
        pose_a: PoseLike,
        pose_b: PoseLike,
        twist_a: TwistLike | None,
        twist_b: TwistLike | None,
        data: Array,
        given: int,
    ) -> TrackerState:
        motion, has_twist, repaired = self._motion(pose_a, pose_b, twist_a, twist_b)
        out = np.empty(K.N_OUT)
        while bad := kernels.start_anywhere(
            self.packed, motion, has_twist, self.options, data, given, out
        ):
            repaired += self._repair(bad, motion)
        events = np.empty(0)
        return self._answer(data, out, events, motion, repaired)[0]

    def _packed(self) -> tuple[Ints, Array, Ints, Array]:
        """What the kernels read of both bodies."""
        return self.a.ints, self.a.reals, self.b.ints, self.b.reals

    def __setstate__(self, stored: Any) -> None:
        super().__setstate__(stored)
        # the bodies' own: in another process their formulas have other addresses
        self.packed = self._packed()
        self._prepare()

    def _repair(self, why: int, motion: Array) -> int:
        """Repair what the kernel has refused, in place, if it is a rounded pose: 1 of them.

        Raises
        ------
        ValueError
            It is something worse.
        """
        if why == K.BAD_TWIST:
            refuse_twists(*twists_of(motion))
        first = why == K.BAD_POSE_A
        flat_a, flat_b = poses_of(motion)
        repair(flat_a if first else flat_b, "pose_a" if first else "pose_b")
        return 1

    def _answer(
        self, data: Array, out: Array, log: Array, motion: Array, repaired: int
    ) -> tuple[TrackerState, Proximity]:
        if out[K.STATUS] in UNDECIDED:
            self._name_overlap(data, out, motion)
        data.flags.writeable = False
        time = float(data[K.TIME])
        count = int(out[K.OUT_COUNTS + N.EVENTS])
        events = events_of(self.a, self.b, log[: N.EVENT_COLUMNS * count], time) if count else ()
        proximity = Proximity(self.a, self.b, out, events, time, poses_of(motion), repaired)
        return TrackerState(data, proximity), proximity

    def _name_overlap(self, data: Array, out: Array, motion: Array) -> None:
        """Give an uncertified pair without a positive bound the status OVERLAPPING, if proven."""
        held = isinstance(self.law, PaperLaw) and self.law.left_alone
        if out[K.DISTANCE] <= 0.0 or out[K.LOWER_BOUND] > 0.0 or held:
            return
        if cores_overlap(self.a, self.b, *poses_of(motion)):
            out[K.DISTANCE] = out[K.UPPER_BOUND] = 0.0
            out[K.STATUS] = float(Status.OVERLAPPING.value)
            data[K.LOST] = 1.0


class ColdQuery(Tracker):
    """A tracker that is asked for starts only: what frames need is not compiled for it."""

    def _prepare(self) -> None:
        pass


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
