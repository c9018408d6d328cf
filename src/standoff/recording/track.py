"""A pair tracked along two paths: the frames in compiled blocks, the switches one by one."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from standoff.checks.numbers import positive
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffTypeError
from standoff.kernels.entries import tracker as kernels
from standoff.kernels.entries.preparing import prepare
from standoff.kernels.pair import events as N
from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.kernels.state import arrays as K
from standoff.motion import PoseLike, TwistLike
from standoff.motion.moving import MotionLike, Moving, moving
from standoff.progress import Progress
from standoff.recording.instants import Motion, Step, located_events
from standoff.recording.recording import RecordedEvent, Recording, RunInfo
from standoff.recording.times import even_times
from standoff.tracking.block import Block
from standoff.tracking.inputs import (
    check_in_plane,
    flat_and_mark,
    flat_pose,
    flat_twist,
    repair_rows,
)
from standoff.tracking.laws import PaperLaw
from standoff.tracking.proximity import Event, Proximity
from standoff.tracking.rows import poses_of, twists_of
from standoff.tracking.state import TrackerState
from standoff.tracking.status import Status
from standoff.tracking.tracker import Tracker
from standoff.version import __version__

Array = NDArray[np.float64]

BLOCK = 128
"""Frames of one compiled loop. It is run again up to a frame that needs a look, one with a switch
or a doubtful answer: shorter blocks would call more often, longer ones repeat more."""

AFTER_A_LOOK = 4
"""Frames of the compiled loop after such a frame, doubled while none needs a look."""


def track(
    tracker: Tracker,
    path_a: MotionLike,
    path_b: MotionLike,
    duration: float,
    *,
    start: float = 0.0,
    locate: bool = True,
    progress: Progress | None = None,
) -> Recording:
    """Track a pair along two paths and record every frame.

    Parameters
    ----------
    tracker : Tracker
        Of the pair, with its law; frames are its ``dt`` apart.
    path_a, path_b : path, function or pose
        A path of ``standoff.motion``, or anything with ``pose(t)`` and ``twist(t)``; a function of
        the time that returns a pose, which is asked from the first frame to the last only and
        differentiated as ``standoff.motion.PoseFunction`` tells; with a pose the body is at rest.
    duration : float
        Time from the first frame to the last [s]; frames are at ``start + k dt``, as many as fit.
    start : float
        Time of the first frame on the paths' clock [s].
    locate : bool
        Find the instants of the switches within their steps; else they are dated to the frames.
        Paths are asked for poses between the frames.
    progress : callable, optional
        Called now and then with the frames done and the frames in all.

    Returns
    -------
    Recording

    Raises
    ------
    ValueError
        Times that give fewer than two frames or more than ten million, or what a path refuses.
    TypeError
        If there is no tracker, or a path is neither path nor function nor pose.
    """
    if not isinstance(tracker, Tracker):
        raise StandoffTypeError(
            f"{shown(tracker)} is not a Tracker: make one by so.Tracker(a, b, dt).",
            "tracker",
            tracker,
        )
    times = even_times(start, positive(duration, "duration"), tracker.dt)
    span = float(times[0]), float(times[-1])
    paths = moving(path_a, "path_a", *span), moving(path_b, "path_b", *span)
    return track_along(tracker, *paths, times, locate=locate, progress=progress)


def track_along(
    tracker: Tracker,
    path_a: Moving,
    path_b: Moving,
    times: Array,
    *,
    locate: bool = True,
    progress: Progress | None = None,
    state: TrackerState | None = None,
) -> Recording:
    """Track a pair at given times along two paths; `track` with the parts in hand.

    Parameters
    ----------
    tracker : Tracker
    path_a, path_b : Moving
    times : ndarray, shape (n,)
        Frame times [s], strictly increasing, at least one.
    locate : bool
    progress : callable, optional
    state : TrackerState, optional
        Of this tracker, at the poses of ``times[0]``: the run begins there, as from a wrong start
        that ``Tracker.start_from`` gave, and its answer is the first frame's. Without it the
        first frame is answered by a global start.

    Returns
    -------
    Recording

    Raises
    ------
    TypeError
        If the state is none.
    ValueError
        What a path or the tracker refuses; a state of another pair.
    """
    if state is not None:
        tracker.check_state(state)
    prepare(paper=isinstance(tracker.law, PaperLaw), planar=tracker.planar, runs=True)
    run = _Run(tracker, path_a, path_b, times, locate)
    run.go(progress, state)
    pair = tracker.a, tracker.b
    info = replace(_run_info(tracker, locate), repaired=run.repaired)
    return Recording.of_answers(times, run.answers, tuple(run.events), pair, info, (path_a, path_b))


def _run_info(tracker: Tracker, locate: bool) -> RunInfo:
    a, b = tracker.a, tracker.b
    options = tracker.resolved_law.facts() | {"dt": tracker.dt, "locate": locate}
    return RunInfo(
        (a.name, b.name),
        (a.digest, b.digest),
        options,
        version=__version__,
    )


class _Run:
    """One run under way."""

    def __init__(
        self, tracker: Tracker, path_a: Moving, path_b: Moving, times: Array, locate: bool
    ) -> None:
        self.tracker, self.locate = tracker, locate
        self.paths = path_a, path_b
        self.times = times
        self.answers = np.empty((len(times), K.N_OUT))
        self.stretch = BLOCK
        self.events: list[RecordedEvent] = []
        self.repaired = 0

    def go(self, progress: Progress | None, state: TrackerState | None = None) -> None:
        total = len(self.times)
        if state is None:
            state = self.tracker.start(*self.placed(float(self.times[0])))
        self.answers[0] = state.proximity.row
        self.repaired = state.proximity.repaired
        done = 1
        while done < total:
            if progress is not None:
                progress(done, total)
            state = self._block(state, done, min(done + BLOCK, total))
            done = min(done + BLOCK, total)
        if progress is not None:
            progress(total, total)

    def placed(self, time: float) -> tuple[PoseLike, PoseLike, TwistLike, TwistLike]:
        """Return the poses and twists of A and B at a time [s]."""
        a, b = self.paths
        return a.pose(time), b.pose(time), a.twist(time), b.twist(time)

    def _block(self, state: TrackerState, first: int, end: int) -> TrackerState:
        """Answer frames first .. end - 1 from the state of the frame before."""
        moves = self._moves(first, end)
        steps = np.diff(self.times[first - 1 : end])
        at = first
        while at < end:
            stop = min(at + self.stretch, end)
            state, at = self._quiet(state, moves, steps, first, at, stop)
            if at < stop:
                state = self._watched(state, at)
                at += 1
                self.stretch = AFTER_A_LOOK
            else:
                self.stretch = min(2 * self.stretch, BLOCK)
        return state

    def _moves(self, first: int, end: int) -> Array:
        """The poses and twists of frames first .. end - 1, a row each."""
        moves = np.empty((end - first, K.N_MOTION))
        poses, twists = poses_of(moves), twists_of(moves)
        for k, time in enumerate(self.times[first:end].tolist()):
            pose_a, pose_b, twist_a, twist_b = self.placed(time)
            poses[0][k], mark_a = flat_and_mark(pose_a)
            poses[1][k], mark_b = flat_and_mark(pose_b)
            twists[0][k], twists[1][k] = flat_twist(twist_a, pose_a), flat_twist(twist_b, pose_b)
            self.repaired += mark_a + mark_b
        self.repaired += repair_rows(poses[0]) + repair_rows(poses[1])
        if self.tracker.planar:
            for flat_a, flat_b in zip(*poses, strict=True):
                check_in_plane(flat_a, flat_b)
        return moves

    def _quiet(
        self,
        state: TrackerState,
        moves: Array,
        steps: Array,
        first: int,
        at: int,
        end: int,
    ) -> tuple[TrackerState, int]:
        """Answer frames from `at` on up to one that needs a look: it switches, may
        overlap, or is refused.

        Returns the state before that frame, and its number; `end` where there is none.
        """
        data = self._loop(state, moves, steps, first, at, end)
        rows = self.answers[at:end]
        doubtful = np.isin(rows[:, K.STATUS], (K.TRACKING, K.NOT_CERTIFIED))
        looks = (rows[:, K.OUT_COUNTS + N.EVENTS] > 0.0) | (
            doubtful & ~(rows[:, K.LOWER_BOUND] > 0.0)
        )
        stop = at + int(looks.argmax()) if looks.any() else end
        if stop == at:
            return state, at
        if stop < end:
            data = self._loop(state, moves, steps, first, at, stop)
        block = Block.empty(data, moves[stop - 1 - first], steps[stop - 1 - first], True)
        block.out[:] = self.answers[stop - 1]
        answer = Proximity(self.tracker.a, self.tracker.b, block.kept())
        return TrackerState(answer), stop

    def _loop(
        self,
        state: TrackerState,
        moves: Array,
        steps: Array,
        first: int,
        at: int,
        end: int,
    ) -> Array:
        """Answer frames at .. end - 1 in compiled code; returns the last one's state."""
        tracker, part = self.tracker, slice(at - first, end - first)
        data = np.zeros(K.N_STATE + N_POLYTOPE)
        known = state.warm_start
        data[: len(known)] = known
        log = np.empty(N.MAX_EVENTS * N.EVENT_COLUMNS)
        rows = self.answers[at:end]
        refused, _ = kernels.run(
            tracker.packed,
            moves[part],
            True,
            steps[part],
            tracker.options,
            data,
            rows,
            log,
        )
        if refused >= 0:  # the single step will say why
            rows[refused:, K.STATUS], rows[refused:, K.LOWER_BOUND] = K.NOT_CERTIFIED, np.nan
        return data

    def _watched(self, state: TrackerState, frame: int) -> TrackerState:
        """Answer one frame by itself and note its events."""
        time, before = float(self.times[frame]), float(self.times[frame - 1])
        following, answer = self.tracker.step(state, *self.placed(time), dt=time - before)
        self.answers[frame] = answer.row
        if answer.events:
            self.events += self._events(state, answer, frame, before, time)
        return following

    def _events(
        self, state: TrackerState, answer: Proximity, frame: int, before: float, time: float
    ) -> list[RecordedEvent]:
        known = answer.status in (Status.CONVERGED, Status.TRACKING)
        # in contact the switching functions are those of the pair shifted out: dated to frames
        outside = state.data[K.LOST] == 0.0 and state.data[K.INSIDE] == 0.0
        if self.locate and known and outside:
            step = Step(self.tracker, self._flat, state, before, time, answer.row)
            events = located_events(step, frame, answer.events)
            if events is not None:
                return events
        return [dated(event, frame, time) for event in answer.events]

    def _flat(self, time: float) -> Motion:
        pose_a, pose_b, twist_a, twist_b = self.placed(time)
        poses = flat_pose(pose_a), flat_pose(pose_b)
        return *poses, flat_twist(twist_a, pose_a), flat_twist(twist_b, pose_b)


def dated(event: Event, frame: int, time: float) -> RecordedEvent:
    """Return an event that is dated to its frame."""
    # Only a release tells its switching function; at a boundary reached it is not evaluated.
    value = event.slope if event.slope < 0.0 else math.nan
    return RecordedEvent(
        frame, time, event.body, event.source, event.target, value, math.nan, located=False
    )
