"""A run of two solids along two paths, as it is recorded."""

from __future__ import annotations

import math
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.features import Feature
from standoff.motion import Pose, PoseLike, PosesLike
from standoff.motion.moving import Moving
from standoff.progress import Progress
from standoff.recording.changes import changes
from standoff.recording.instants import MOST_ANSWERS, NotKnown, resolution_between
from standoff.recording.local_minima import LocalMinima, MinimumEvent
from standoff.recording.recording import RecordedEvent, Recording, RunInfo
from standoff.recording.track import BLOCK, Moves, moves_along
from standoff.solids.answer import SolidProximity
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.tolerances import PROOF_TOLERANCE
from standoff.solids.tracked.answers import SolidAnswers
from standoff.solids.tracked.state import SolidState
from standoff.tracking.branches import NONE, Birth
from standoff.tracking.rows import Counts
from standoff.tracking.status import Status
from standoff.typing import Array
from standoff.version import __version__

Mode = tuple[Feature, Feature]

LOOKED_INTO = (Status.CONVERGED, Status.CONTAINED)
"""Frames between which a switch is dated: at one place, or at several that are told apart."""


class Tracking(Protocol):
    """What a run asks of a `SolidTracker`."""

    a: SolidModel
    b: SolidModel
    dt: float
    tolerance: float | None
    deadline: int
    minima: float | None

    def start(self, pose_a: PoseLike, pose_b: PoseLike) -> SolidState: ...
    def step(
        self, state: SolidState, pose_a: PoseLike, pose_b: PoseLike
    ) -> tuple[SolidState, SolidProximity]: ...
    def run(
        self, state: SolidState, poses_a: PosesLike, poses_b: PosesLike
    ) -> tuple[SolidState, SolidAnswers]: ...
    def answers_of(self, state: SolidState, poses_a: Array, poses_b: Array) -> SolidAnswers: ...
    def telling_features(self) -> Tracking: ...


def recorded(
    tracker: Tracking,
    paths: tuple[Moving, Moving],
    times: Array,
    state: SolidState | None,
    *,
    locate: bool,
    progress: Progress | None,
) -> Recording:
    """Track two solids at given times [s]; `SolidTracker.recorded_along` describes it."""
    run = _SolidRun(tracker, paths, times, locate)
    run.go(state, progress)
    return run.recording()


class _FeaturesAtTime(NamedTuple):
    """The features of the witness points at one time, s."""

    time: float
    mode: Mode


class _SolidRun:
    """One run under way."""

    def __init__(
        self, tracker: Tracking, paths: tuple[Moving, Moving], times: Array, locate: bool
    ) -> None:
        self.asked, self.tracker = tracker, tracker.telling_features()
        self.paths, self.times, self.locate = paths, times, locate
        self.blocks: list[dict[str, Any]] = []
        self.events: list[RecordedEvent] = []
        self.minima: list[LocalMinima] = []
        self.minima_events: list[MinimumEvent] = []
        self.repaired = 0
        self.last: _Frame | None = None

    def go(self, state: SolidState | None, progress: Progress | None) -> None:
        total = len(self.times)
        moves = moves_along(self.paths, self.times[:1])
        if state is None:
            state = self.tracker.start(moves.poses_a[0], moves.poses_b[0])
        self._first(state, moves)
        done = 1
        while done < total:
            if progress is not None:
                progress(done, total)
            end = min(done + BLOCK, total)
            state = self._block(state, done, end)
            done = end
        if progress is not None:
            progress(total, total)

    def _first(self, state: SolidState, moves: Moves) -> None:
        """Frame 0, whose answer is that of a state."""
        answers = self.tracker.answers_of(state, moves.poses_a, moves.poses_b)
        counts = self._keep(answers, moves, 0)
        counts[:, Counts._fields.index("restarts")] = 0  # as it is the first
        places = answers.places
        self.last = _Frame(answers.status[0], (places.feature_a[0], places.feature_b[0]))
        if self.asked.minima is not None:
            told = answers.minima
            self.minima_events += [
                MinimumEvent(0, "birth", int(told.key[k]), float(told.distance[k]),
                             (told.feature_a[k], told.feature_b[k]), Birth.START)
                for k in np.flatnonzero(told.key != NONE)
            ]  # fmt: skip

    def _block(self, state: SolidState, first: int, end: int) -> SolidState:
        """Answer frames first .. end - 1 from the state of the frame before."""
        moves = moves_along(self.paths, self.times[first:end])
        last, answers = self.tracker.run(state, moves.poses_a, moves.poses_b)
        counts = self._keep(answers, moves, first)
        if self.asked.minima is not None:
            self.minima_events += [e._replace(frame=e.frame + first) for e in answers.events]
        self._switches(_Stretch(self.tracker, state, moves), answers, first, counts)
        return last

    def _keep(self, answers: SolidAnswers, moves: Moves, first: int) -> Any:
        """Keep the columns of frames, from frame `first` on; returns their counts."""
        told = _columns(answers) | {"rate": _rates(answers, moves)}
        self.repaired += moves.repaired
        self.blocks.append(told)
        if self.asked.minima is not None:
            minima = answers.minima
            self.minima.append(minima._replace(frame=minima.frame + first))
        return told["counts"]

    def _switches(
        self, stretch: _Stretch, answers: SolidAnswers, first: int, counts: NDArray[np.int64]
    ) -> None:
        """Add the switches of a block's frames, from frame `first` on."""
        places, before = answers.places, self.last
        for k, status in enumerate(answers.status):
            now = _Frame(status, (places.feature_a[k], places.feature_b[k]))
            if not all(feature.kind for feature in now.mode):
                continue
            if before is not None and before.mode != now.mode:
                found = self._dated(stretch, (before, now), k, first + k)
                counts[k, Counts._fields.index("switches")] = len(found)
                self.events += found
            before = now
        self.last = before

    def _dated(
        self, stretch: _Stretch, ends: tuple[_Frame, _Frame], k: int, frame: int
    ) -> list[RecordedEvent]:
        """The switches of a frame, the k-th of a stretch, with their times where they are found."""
        before, now = ends
        if self.locate and before.status in LOOKED_INTO and now.status in LOOKED_INTO:
            span = float(self.times[frame - 1]), float(self.times[frame])
            try:
                found = _located(stretch, self.paths, k, span, (before.mode, now.mode))
                return [e for known in found for e in _events_of(frame, *known, located=True)]
            except NotKnown:
                pass
        return _events_of(frame, float(self.times[frame]), before.mode, now.mode, located=False)

    def recording(self) -> Recording:
        """All that was told."""
        arrays = {
            name: np.concatenate([block[name] for block in self.blocks]) for name in self.blocks[0]
        }
        n = len(self.times)
        minima = None
        if self.asked.minima is not None:
            columns = zip(*self.minima, strict=True)
            minima = LocalMinima(*(np.concatenate(each) for each in columns))
        return Recording(
            time=self.times,
            residual=np.full(n, np.nan),
            velocity_a=np.full((n, 3), np.nan),
            velocity_b=np.full((n, 3), np.nan),
            events=tuple(self.events),
            info=self._info(),
            pair=(_as_given(self.tracker.a), _as_given(self.tracker.b)),
            paths=self.paths,
            minima=minima,
            minima_events=tuple(self.minima_events),
            **arrays,
        )

    def _info(self) -> RunInfo:
        tracker = self.asked
        a, b = tracker.a, tracker.b
        options = {
            "tolerance": in_sizes(tracker.tolerance, a, b),
            "deadline": tracker.deadline,
            "minima": tracker.minima,
            "dt": tracker.dt,
            "locate": self.locate,
        }
        names, digests = (a.name, b.name), (a._given.digest, b._given.digest)
        return RunInfo(names, digests, options, version=__version__, repaired=self.repaired)


def in_sizes(tolerance: float | None, a: SolidModel, b: SolidModel) -> float:
    """A tolerance, length, in sizes of the pair, as laws have it."""
    return PROOF_TOLERANCE if tolerance is None else tolerance / (a.size + b.size)


class _Frame(NamedTuple):
    """What is known of a frame where a switch is looked for."""

    status: Status
    mode: Mode


class _Stretch:
    """Frames from a state on; the state before any of them is found by running up to it."""

    def __init__(self, tracker: Tracking, state: SolidState, moves: Moves) -> None:
        self.tracker, self.moves = tracker, moves
        self._state, self._at = state, 0

    def before(self, k: int) -> SolidState:
        """The state before frame k; asked for in order."""
        if k > self._at:
            part = slice(self._at, k)
            poses = self.moves.poses_a[part], self.moves.poses_b[part]
            self._state, self._at = self.tracker.run(self._state, *poses)[0], k
        return self._state


def _located(
    stretch: _Stretch,
    paths: tuple[Moving, Moving],
    k: int,
    span: tuple[float, float],
    modes: tuple[Mode, Mode],
) -> list[tuple[float, Mode, Mode]]:
    """The instants of the switches between two times [s], by halving; raises NotKnown."""
    state, asked = stretch.before(k), 0

    def look(time: float, low: _FeaturesAtTime, high: _FeaturesAtTime) -> _FeaturesAtTime:
        nonlocal asked
        asked += 1
        if asked > MOST_ANSWERS:
            raise NotKnown(f"more than {MOST_ANSWERS} answers in one step")
        poses = (Pose.of(path.pose(time)) for path in paths)
        answer = stretch.tracker.step(state, *poses)[1]
        if not answer.certified or answer.penetrating:
            raise NotKnown(f"no certified answer at {time} s")
        return _FeaturesAtTime(time, (answer.feature_a, answer.feature_b))

    low, high = (_FeaturesAtTime(time, mode) for time, mode in zip(span, modes, strict=True))
    return changes(
        low, high, look, resolution_between(*span), lambda x, y: (y.time, x.mode, y.mode)
    )


def _events_of(
    frame: int, time: float, source: Mode, target: Mode, *, located: bool
) -> list[RecordedEvent]:
    """A switch of the mode as one of each body that leaves its feature."""
    return [
        RecordedEvent(frame, time, body, was, now, math.nan, math.nan, located)
        for body, was, now in zip("AB", source, target, strict=True)
        if was != now
    ]


def _columns(answers: SolidAnswers) -> dict[str, Any]:
    """The columns of frames, but for their rates."""
    told = {name: getattr(answers, name) for name in _COLUMNS}
    counts = np.zeros((len(answers), len(Counts._fields)), dtype=np.int64)
    counts[:, Counts._fields.index("evaluations")] = answers.evaluations
    counts[:, Counts._fields.index("restarts")] = answers.restarts
    return told | answers.places._asdict() | {"counts": counts}


_COLUMNS = ("distance", "lower_bound", "upper_bound", "point_a", "point_b", "normal", "status")


def _rates(answers: SolidAnswers, moves: Moves) -> Array:
    """The time derivative of the distance (n,): how fast both witness points, fixed to their
    bodies, go apart along the normal. nan where they are not unique."""
    apart = np.zeros(len(answers))
    sides = (
        (answers.point_a, moves.poses_a, moves.twists_a, -1.0),
        (answers.point_b, moves.poses_b, moves.twists_b, 1.0),
    )
    for points, poses, twists, sign in sides:
        velocity = twists[:, :3] + np.cross(twists[:, 3:], points - poses[:, :3, 3])
        apart += sign * np.einsum("ni,ni->n", answers.normal, velocity)
    return np.where(answers.unique, apart, np.nan)


def _as_given(model: SolidModel) -> Any:
    """A `Solid`, or the `Body` that was given in place of one."""
    return model if hasattr(model, "tracked") else model._given
