"""The hybrid tracker: two moving bodies, their witness points kept frame by frame."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from standoff.bodies.body import Body
from standoff.checks.numbers import positive
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.compiler.entry import WrongKind
from standoff.kernels.entries.preparing import prepare
from standoff.kernels.entries.tracker import moved, moved_by_poses, value, value_by_poses
from standoff.kernels.state import arrays as K
from standoff.read_only import KeepsReadOnly
from standoff.shown_names import hides
from standoff.tracking.inputs import check_pair, plain, same_body
from standoff.tracking.law_options import Law
from standoff.tracking.laws import DEFAULT_LAW, PaperLaw, checked_law
from standoff.tracking.mended_calls import Given, found_anywhere, started, stepped
from standoff.tracking.proximity import Proximity
from standoff.tracking.reached import AddressTable, reach
from standoff.tracking.rows import StateRow
from standoff.tracking.specialised import checked_choice
from standoff.tracking.state import TrackerState
from standoff.typing import Array

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from standoff.motion import PoseLike, PosesLike, TwistLike
    from standoff.tracking.answers import Answers
    from standoff.tracking.frame_buffer import FrameBuffer
    from standoff.tracking.many_states import TrackerStates
    from standoff.tracking.places import PlaceLike


# The calls of a tracker that step many states at once.


class StepsMany:
    """A base of the tracker: many pairs of poses of its two bodies, frame after frame."""

    __slots__ = ()

    def start_many(
        self,
        poses_a: PosesLike,
        poses_b: PosesLike,
        twists_a: ArrayLike | TwistLike | None = None,
        twists_b: ArrayLike | TwistLike | None = None,
    ) -> TrackerStates:
        """Find the witness points of n pairs of poses globally, as ``start`` does.

        Raises TypeError, ValueError as ``start``.

        Parameters
        ----------
        poses_a, poses_b : array_like, shape (n, 4, 4) or (n, 12), and others, or one pose for all
            World poses, in any form that `distances` reads.
        twists_a, twists_b : array_like, shape (n, 6), or one twist for all, optional
            (v, omega) in world axes.

        Returns
        -------
        TrackerStates
        """
        from standoff.tracking.many_states import TrackerStates
        from standoff.tracking.runs import Frames, steps_of

        this: Any = self
        steps = steps_of(None, this.dt, this.check_frame_time)
        given = Frames.of(poses_a, poses_b, (twists_a, twists_b), steps)
        return TrackerStates.of([this.start(*given.frame(k)) for k in range(len(given.steps))])

    def step_many(
        self,
        states: TrackerStates,
        poses_a: PosesLike,
        poses_b: PosesLike,
        twists_a: ArrayLike | TwistLike | None = None,
        twists_b: ArrayLike | TwistLike | None = None,
        dt: ArrayLike | None = None,
        *,
        workers: int = 1,
    ) -> tuple[TrackerStates, Answers]:
        """One frame of n states in one compiled loop: each as ``step`` makes it.

        Between patches of ellipsoids frames are made in vectors; of these distance and bounds
        differ from those of ``step`` by 1e-13 of the size at most. All others are the same, to the
        last bit.

        Raises TypeError, ValueError as ``step``, with the number of the row; states of another
        pair, or of another number.

        Parameters
        ----------
        states : TrackerStates
            Of this pair; it is not changed.
        poses_a, poses_b : array_like, shape (n, 4, 4) or (n, 12), and others, or one pose for all
            World poses at the end of the step.
        twists_a, twists_b : array_like, shape (n, 6), or one twist for all, optional
            (v, omega) in world axes, as in ``step``.
        dt : float or array_like, shape (n,), optional
            Time since the frame before, s; the tracker's own if not given.
        workers : int
            Threads that share the rows; the answers are the same for any number.

        Returns
        -------
        (TrackerStates, Answers)
        """
        from standoff.errors import StandoffTypeError
        from standoff.tracking.many_states import TrackerStates, step_many
        from standoff.tracking.runs import Frames, steps_of

        this: Any = self
        if not isinstance(states, TrackerStates):
            raise StandoffTypeError(
                f"{shown(states)} is not TrackerStates: get them from tracker.start_many.",
                "states",
                states,
            )
        this.check_state(states[0])
        steps = steps_of(dt, this.dt, this.check_frame_time)
        given = Frames.of(poses_a, poses_b, (twists_a, twists_b), steps)
        return step_many(this, states, given.repeated(len(states)), workers)


# Which tracker a pair gets: bodies that are no `Body` make their own.


class MadeByKind:
    """A base of the tracker of bodies: of what makes a tracker by itself, as solids do, which are
    above this layer, it makes that one (`Solid.tracked`)."""

    __slots__ = ()

    def __new__(cls, a: Any = None, b: Any = None, *given: Any, **options: Any) -> Any:
        for each in (a, b):
            if hasattr(each, "tracked"):
                return each.tracked(a, b, *given, **options)
        return super().__new__(cls)


ARRAY, empty = np.ndarray, np.empty  # of every step: a name less to look up
N_BLOCK, N_KEEPING_BLOCK = K.N_BLOCK, K.N_KEEPING_BLOCK

INSIDE = K.BLOCK_STATE + K.INSIDE  # was a block's frame solved in contact?

HIDDEN = ("check_frame_time", "check_state", "options", "reached", "step_anew", "table")
"""What runs and the studies need but users do not."""


@hides(*HIDDEN)
class Tracker(StepsMany, MadeByKind, KeepsReadOnly):
    """Keeps the minimum distance of two bodies while they move; of solids as a `SolidTracker`.

    Raises TypeError: not a body or a law; `specialise` is not one of its choices. Raises
    ValueError: a number that is not positive, a feedback that is not stable at `dt`, a planar body
    with a spatial one, two half-spaces.

    Parameters
    ----------
    a, b : Body
        Two spatial bodies, or two planar ones (a point, or another body without faces in z = 0, can
        be paired with either).
    dt : float
        Frame time, s; ``step`` takes another one if frames are uneven.
    law : PredictorCorrector or PaperLaw
        How the witness points are kept, with all options.
    specialise : bool, optional
        A frame compiled for the kinds of the bodies' faces is tried before the general one; it
        gives the same answers, two to four times as fast while both witness points stay inside
        faces. If not given, it is used for pairs compiled ahead of time (ellipsoids and lenses with
        each other and with polytopes; two NURBS solids of the same degree, 2 to 5). True compiles
        one for any other pair, before the loop; False uses none. The paper's law has none.

    Attributes
    ----------
    a, b, dt, law, specialise
        As given.
    """

    def __init__(
        self,
        a: Body,
        b: Body,
        dt: float = 1e-3,
        law: Law = DEFAULT_LAW,
        *,
        specialise: bool | None = None,
    ) -> None:
        check_pair(a, b)
        self.a, self.b = a, b
        self.specialise = checked_choice(specialise)
        self.dt = positive(dt, "dt")
        self.law = checked_law(law)
        self._reach()

    def _reach(self) -> None:
        """Have at hand, by address, what the frames read; load or compile what they call."""
        self.reached = reach(self.a, self.b, self.law, self.dt, self.specialise)
        prepare()

    def __setstate__(self, stored: Any) -> None:
        super().__setstate__(stored)
        prepare()

    @property
    def table(self) -> AddressTable:
        """Where the bodies and the law's options lie."""
        return self.reached.table

    @property
    def options(self) -> Array:
        """The law as the kernels read it."""
        return self.reached.options

    @property
    def resolved_law(self) -> Law:
        """With the defaults that depend on the frame time filled in."""
        return self.reached.law

    def start(
        self,
        pose_a: PoseLike,
        pose_b: PoseLike,
        twist_a: TwistLike | None = None,
        twist_b: TwistLike | None = None,
    ) -> TrackerState:
        """Find the witness points globally and certify them.

        Raises ValueError: no pose or twist, or a planar pair out of its plane.

        Parameters
        ----------
        pose_a, pose_b : Pose or what ``Pose.of`` reads
            World poses of the bodies' frames.
        twist_a, twist_b : Twist or what ``Twist.of`` reads, optional
            Velocities at this instant, (v, omega) in world axes. The next frame is predicted from
            them and from its own.

        Returns
        -------
        TrackerState
            Its ``proximity`` is the answer at these poses.
        """
        given = pose_a, pose_b, twist_a, twist_b
        return TrackerState(found_anywhere((self.a, self.b), self.table, given))

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

        Raises ValueError as ``start``; no place, no such feature, or parameters outside it.

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
            predictor-corrector), False begins exactly there (the default of the paper's law, whose
            feedback then does the work).
        """
        from standoff.tracking.places import put

        state = StateRow()
        put(state, 0, self.a, place_a)
        put(state, 1, self.b, place_b)
        settle = not isinstance(self.law, PaperLaw) if settle is None else settle
        how = K.START_DESCEND if settle else K.START_HERE
        given = pose_a, pose_b, twist_a, twist_b
        block, repaired = started(self.table, given, state.data, how)
        return TrackerState(Proximity(self.a, self.b, block.kept(), repaired))

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

        Raises TypeError: ``state`` is not a state. Raises ValueError: a state of another pair; no
        pose or twist; a time that is not positive, or too long for the paper's law; a planar pair
        out of its plane.

        Parameters
        ----------
        state : TrackerState
            Of this pair; it is not changed.
        pose_a, pose_b : Pose or what ``Pose.of`` reads
            World poses at the end of the step: the answer holds for them.
        twist_a, twist_b : Twist or what ``Twist.of`` reads, optional
            Those at this instant; without any, the prediction is the secant of the last two frames
            and the rates are nan. If only one twist is given, the other body is at rest.
        dt : float, optional
            Time since the frame before, s; the tracker's own if not given.

        Returns
        -------
        (TrackerState, Proximity)
        """
        if type(state) is not TrackerState:
            self.check_state(state)
        before = state._proximity
        if before._a is not self.a or before._b is not self.b:
            self.check_state(state)
        h = self.dt if dt is None else self.check_frame_time(dt)
        last, table, repaired = before._out, self.reached.address, 0
        try:
            block = empty(N_BLOCK if last.item(INSIDE) == 0.0 else N_KEEPING_BLOCK)
            if twist_a is twist_b is None and type(pose_a) is type(pose_b) is ARRAY:
                done = value_by_poses(table, last, pose_a, pose_b, h, block)
            else:
                numbers, repaired = plain(pose_a, pose_b, twist_a, twist_b)
                done = value(table, last, *numbers, h, block)
        except (WrongKind, IndexError):
            done = K.BAD_ARRAYS
        if done != K.FINE:
            answer = self.step_anew(state, (pose_a, pose_b, twist_a, twist_b), h)
        else:
            answer = Proximity(self.a, self.b, block, repaired)
        return TrackerState(answer), answer

    def step_anew(self, state: TrackerState, given: Given, h: float) -> Proximity:
        """The answer of a frame that the compiled one does not make from its input: says what is
        wrong with it, or repairs it. Also for one with more switches than its block holds.
        """
        self.check_state(state)
        block, repaired = stepped(self.table, given, state.warm_start, h)
        return Proximity(self.a, self.b, block.kept(), repaired)

    def run(
        self,
        state: TrackerState,
        poses_a: PosesLike,
        poses_b: PosesLike,
        twists_a: ArrayLike | TwistLike | None = None,
        twists_b: ArrayLike | TwistLike | None = None,
        dt: ArrayLike | None = None,
    ) -> tuple[TrackerState, Answers]:
        """Many frames in one compiled loop, each from the state of the one before, as with
        ``step``.

        Raises TypeError, ValueError as ``step``, with the number of the frame; nothing is answered
        then.

        Parameters
        ----------
        state : TrackerState
            Of this pair; it is not changed.
        poses_a, poses_b : array_like, shape (n, 4, 4) or (n, 12), or one pose for all frames
            World poses at the end of each step; rows of 12 are R row-major, p. Also any other form
            that `distances` reads: (R, p) stacks, `Poses`, a list of poses.
        twists_a, twists_b : array_like, shape (n, 6), or one twist for all frames, optional
            (v, omega) in world axes, as in ``step``.
        dt : float or array_like, shape (n,), optional
            Time since the frame before, s; the tracker's own if not given.

        Returns
        -------
        (TrackerState, Answers)
            The state after the last frame, and all answers as arrays.
        """
        from standoff.tracking.runs import Frames, run, steps_of

        self.check_state(state)
        steps = steps_of(dt, self.dt, self.check_frame_time)
        given = Frames.of(poses_a, poses_b, (twists_a, twists_b), steps)
        return run(self.table, state, given, self.step_anew)

    def step_into(
        self,
        buffer: FrameBuffer,
        pose_a: PoseLike | None = None,
        pose_b: PoseLike | None = None,
        twist_a: TwistLike | None = None,
        twist_b: TwistLike | None = None,
        dt: float | None = None,
    ) -> float:
        """One frame in place, for loops that must not allocate.

        Writes ``buffer.out`` (laid out in ``standoff.kernels.state.arrays``) and ``buffer.state``.
        ``buffer.normal``, ``point_a``, ``point_b``, ``lower_bound``, ``upper_bound`` and ``status``
        read them without making an object.

        Raises TypeError, ValueError as ``step``.

        Parameters
        ----------
        buffer : FrameBuffer
            Of this tracker. Without poses the frame reads ``buffer.pose_a`` and the others.
        pose_a, pose_b, twist_a, twist_b
            As in ``step``. Arrays (4, 4) and (6,) of float64 are read as they are; anything else is
            converted first.
        dt : float, optional
            Time since the frame before, s; the tracker's own if not given.

        Returns
        -------
        float
            The distance; if the answer is uncertified, ``buffer.proximity()`` says why.
        """
        if buffer.reached is not self.reached:
            raise StandoffError(
                "The buffer belongs to another tracker: make one with tracker.buffer.", "buffer"
            )
        h = self.dt if dt is None else self.check_frame_time(dt)
        if type(pose_a) is type(pose_b) is ARRAY:
            table, block = buffer._call
            try:
                if twist_a is twist_b is None:
                    distance: float = moved_by_poses(table, pose_a, pose_b, h, block)
                elif type(twist_a) is type(twist_b) is ARRAY:
                    distance = moved(table, pose_a, pose_b, twist_a, twist_b, h, block)
                else:
                    return buffer.step_to((pose_a, pose_b, twist_a, twist_b), h)
            except WrongKind:
                return buffer.step_anew((pose_a, pose_b, twist_a, twist_b), h)
            buffer.repaired = 0
            if distance == distance:
                return distance
            return buffer.mended((pose_a, pose_b, twist_a, twist_b), h)
        if pose_a is None and pose_b is None:
            return buffer.step(h)
        return buffer.step_to((pose_a, pose_b, twist_a, twist_b), h)

    def buffer(self, state: TrackerState) -> FrameBuffer:
        """Arrays for ``step_into`` that begin at a state."""
        from standoff.tracking.frame_buffer import FrameBuffer

        self.check_state(state)
        return FrameBuffer(self.reached, state)

    def check_frame_time(self, dt: float) -> float:
        """A frame's own time, s: positive, and short enough for the paper's law to be stable."""
        dt = positive(dt, "dt")
        self.resolved_law.check_step(dt)
        return dt

    def check_state(self, state: TrackerState) -> None:
        """Refuse what is not a state of this pair: it would be read with this one's features.

        Raises TypeError: ``state`` is not a state. Raises ValueError: a state of another pair, or
        stored by another version.
        """
        if not isinstance(state, TrackerState):
            raise StandoffTypeError(
                f"{shown(state)} is not a TrackerState: get one from tracker.start.", "state", state
            )
        for name, own, other in zip("AB", (self.a, self.b), state.proximity.bodies, strict=True):
            if own is not other and not same_body(own, other):
                raise StandoffError(
                    f"The state belongs to another pair: its body {name} is {other!r}, the "
                    f"tracker's is {own!r}.",
                    "state",
                    state,
                )
        block = state.proximity._out
        if len(block) < K.N_BLOCK or block.dtype != np.float64:
            # the kernels read it by address
            raise StandoffError(
                f"The state's block holds {len(block)} numbers of {block.dtype}, not {K.N_BLOCK} "
                "or more of float64: it was stored by another version; begin with tracker.start.",
                "state",
                state,
            )
