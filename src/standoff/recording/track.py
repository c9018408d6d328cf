"""A pair tracked along two paths: the frames in compiled blocks, the switches one by one."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np

from standoff.checks.numbers import positive
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffTypeError
from standoff.kernels.entries.preparing import prepare
from standoff.kernels.pair import events as N
from standoff.kernels.state import arrays as K
from standoff.motion import PoseLike, TwistLike
from standoff.motion.moving import MotionLike, Moving, moving
from standoff.progress import Progress
from standoff.recording.instants import FrameStep, Motion, located_events
from standoff.recording.recording import RecordedEvent, Recording, RunInfo
from standoff.recording.times import even_times
from standoff.tracking.inputs import (
    flat_pose,
    flat_twist,
    matrix_and_mark,
)
from standoff.tracking.proximity import Event, Proximity
from standoff.tracking.state import TrackerState
from standoff.tracking.status import Status
from standoff.tracking.tracker import Tracker
from standoff.typing import Array
from standoff.version import __version__

BLOCK = 128
"""Frames of one compiled loop. It is run again up to a frame that needs a look, one with a switch
or a doubtful answer: shorter blocks would call more often, longer ones repeat more."""


@runtime_checkable
class RecordingTracker(Protocol):
    """A tracker of another kind, as that of solids, which are above this layer: it records its own
    runs."""

    dt: float

    def recorded_along(
        self,
        paths: tuple[Moving, Moving],
        times: Array,
        state: Any = None,
        *,
        locate: bool = True,
        progress: Progress | None = None,
    ) -> Recording:
        """As `track_along`."""


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

    Raises ValueError: times that give fewer than two frames or more than ten million, or what a
    path refuses. Raises TypeError if there is no tracker, or a path is neither a path nor a
    function nor a pose.

    Parameters
    ----------
    tracker : Tracker or SolidTracker
        Of the pair, with its options; frames are its ``dt`` apart.
    path_a, path_b : path, function or pose
        A path of ``standoff.motion``, or anything with ``pose(t)`` and ``twist(t)``; a function of
        time that returns a pose, which is called only from the first frame to the last and
        differentiated as in ``standoff.motion.PoseFunction``; with a pose the body is at rest.
    duration : float
        Time from the first frame to the last [s]; frames are at ``start + k dt``, as many as fit.
    start : float
        Time of the first frame on the paths' clock [s].
    locate : bool
        Find the instants of the switches within their steps; else they get the times of the frames.
        Paths are asked for poses between the frames.
    progress : callable, optional
        Called now and then with the frames done and the frames in all.

    Returns
    -------
    Recording
    """
    if not isinstance(tracker, Tracker | RecordingTracker):
        raise StandoffTypeError(
            f"{shown(tracker)} is not a Tracker: make one with so.Tracker(a, b, dt).",
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

    Raises TypeError if the state is not one. Raises ValueError: what a path or the tracker refuses;
    a state of another pair.

    Parameters
    ----------
    tracker : Tracker or SolidTracker
    path_a, path_b : Moving
    times : ndarray, shape (n,)
        Frame times [s], strictly increasing, at least one.
    locate : bool
    progress : callable, optional
    state : TrackerState or SolidState, optional
        Of this tracker, at the poses of ``times[0]``: the run begins there, as from a wrong start
        that ``Tracker.start_from`` gave, and its answer is the first frame's. Without it the
        first frame is answered by a global start.

    Returns
    -------
    Recording
    """
    if isinstance(tracker, RecordingTracker):
        paths = path_a, path_b
        return tracker.recorded_along(paths, times, state, locate=locate, progress=progress)
    if state is not None:
        tracker.check_state(state)
    prepare(runs=True)
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
        steps = np.diff(self.times[first - 1 : end])
        moves = moves_along(self.paths, self.times[first:end])
        self.repaired += moves.repaired
        last, found = self.tracker.run(state, *moves[:4], steps)
        self.answers[first:end] = found.blocks[:, : K.N_OUT]
        self.repaired += int(found.repaired.sum())
        for k in np.flatnonzero(found.blocks[:, K.OUT_COUNTS + N.EVENTS]).tolist():
            before = TrackerState(found[k - 1]) if k else state
            self.events += self._events(before, found[k], first + k)
        return last

    def _events(self, state: TrackerState, answer: Proximity, frame: int) -> list[RecordedEvent]:
        """Return the events of a frame, from the state of the frame before it."""
        before, time = float(self.times[frame - 1]), float(self.times[frame])
        known = answer.status in (Status.CONVERGED, Status.TRACKING)
        # in contact the switching functions are those of the pair shifted out: dated to frames
        outside = state.data[K.LOST] == 0.0 and state.data[K.INSIDE] == 0.0
        # beyond the horizon there are none: what came of a switch there is dated to a frame
        outside = outside and not state.proximity.far
        if self.locate and known and outside:
            step = FrameStep(self.tracker, self._flat, state, before, time, answer.row)
            events = located_events(step, frame, answer.events)
            if events is not None:
                return events
        return [dated(event, frame, time) for event in answer.events]

    def _flat(self, time: float) -> Motion:
        pose_a, pose_b, twist_a, twist_b = self.placed(time)
        poses = flat_pose(pose_a), flat_pose(pose_b)
        return *poses, flat_twist(twist_a, pose_a), flat_twist(twist_b, pose_b)


class Moves(NamedTuple):
    """Poses (n, 4, 4) and twists (n, 6) of frames, and how many rounded poses were repaired."""

    poses_a: Array
    poses_b: Array
    twists_a: Array
    twists_b: Array
    repaired: int


def moves_along(paths: tuple[Moving, Moving], times: Array) -> Moves:
    """What two paths say at some times [s]."""
    poses, twists = np.empty((2, len(times), 4, 4)), np.empty((2, len(times), 6))
    repaired = 0
    for k, time in enumerate(times.tolist()):
        for body, path in enumerate(paths):
            pose = path.pose(time)
            poses[body, k], mark = matrix_and_mark(pose)
            twists[body, k] = flat_twist(path.twist(time), pose)
            repaired += mark
    return Moves(poses[0], poses[1], twists[0], twists[1], repaired)


def dated(event: Event, frame: int, time: float) -> RecordedEvent:
    """Return an event that is dated to its frame."""
    # Only a release tells its switching function; at a boundary reached it is not evaluated.
    value = event.slope if event.slope < 0.0 else math.nan
    return RecordedEvent(
        frame, time, event.body, event.source, event.target, value, math.nan, located=False
    )
