"""One call of a tracker of solids: its frames, in compiled loops as far as these go."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.errors import StandoffError
from standoff.kernels.entries import tracked_solids as T
from standoff.kernels.solids.minima_sets import SET_BRANCH
from standoff.kernels.solids.spatial_progress import POINTS
from standoff.motion import Pose
from standoff.recording.local_minima import LocalMinima, MinimumEvent
from standoff.solids.answer import SolidProximity
from standoff.solids.spatial.distance import inside_of, senses_of
from standoff.solids.spatial.minimum import LeastFound
from standoff.solids.spatial.pair import PlacedPair
from standoff.solids.spatial.patches import patch_told
from standoff.solids.spatial.told import AnswerFacts, answer_of
from standoff.solids.tracked.answers import SolidAnswers, WitnessPlaces, world_places
from standoff.solids.tracked.asks import TrackedPair, numbered
from standoff.solids.tracked.events import EventCourse, events_of, features_at, minima_of
from standoff.solids.tracked.front import NO_ROWS, FrontFrames, KeptFront, moved_by, room_for
from standoff.solids.tracked.state import SolidState
from standoff.tracking.derivatives import Smoothness
from standoff.tracking.status import Status
from standoff.typing import Array


class Run:
    """Frames with A and B at world poses (n, 12), from the state of the frame before on."""

    def __init__(self, asks: TrackedPair, state: SolidState, a: Array, b: Array) -> None:
        self.asks, self.state, self.born = asks, state, state.born
        self.a, self.b = a, b
        self.relative = _relative(a, b)
        self.told = room_for(len(a))
        self.inside = np.full(len(a), "", dtype=object)
        self.special: dict[int, SolidProximity] = {}
        self.merged: dict[tuple[int, int], int] = {}
        self.minima, self.first = [NO_ROWS], np.zeros(len(a) + 1, dtype=np.int64)
        self._before: Array | None = None
        self._parted = False

    def single(self) -> tuple[SolidState, SolidProximity]:
        """Of a run of one frame, without arrays."""
        front = self._through()
        answer = self.special[0] if self.special else self._made(0)
        return self._state(answer, front), answer

    def parted(self, before: Array) -> tuple[SolidState, SolidProximity]:
        """`single`, after a frame in which the solids overlapped with B at the pose `before` (12,)
        in A's frame, where their places do not prove that they do any more."""
        self._before, self._parted = before, True
        return self.single()

    @property
    def _first(self) -> Array:
        """B's pose (12,) in A's frame in the answer that the run begins from."""
        if self._before is not None:
            return self._before
        a, b = self.state.proximity.poses
        first: Array = _relative(a[None], b[None])[0]
        return first

    def _overlapped(self, k: int) -> bool:
        """Did the solids overlap in a frame, -1: in the answer that the run begins from? A frame
        that is not among the special ones tells that they are apart."""
        if k < 0 and self._before is not None:
            return self._parted
        answer = self.state.proximity if k < 0 else self.special.get(k)
        return answer is not None and answer.overlap is not None

    def _state(self, answer: SolidProximity, front: KeptFront | None) -> SolidState:
        born = self.born if front is None else front.born
        return SolidState(answer, (self.asks.a, self.asks.b), front, born)

    def answers(self) -> tuple[SolidState, SolidAnswers]:
        front = self._through()
        answers = self._all_answers()
        return self._state(answers[len(answers) - 1], front), answers

    def of_state(self) -> SolidAnswers:
        """The answer of the state, at whose poses the only frame is."""
        self.special[0] = self.state.proximity
        self.told[0, T.MOTION] = np.nan
        return self._all_answers()

    def _all_answers(self) -> SolidAnswers:
        slack = self.asks.a.slack + self.asks.b.slack
        statuses = np.array([status_of(inside) for inside in self.inside], dtype=object)
        places = world_places(self.told, self.a)
        plain = statuses, slack
        later = self._made, self.minima_told, self.places_told
        return SolidAnswers(self.told, places, self.special, plain, *later)

    def places_told(self) -> WitnessPlaces:
        """The features and parameters of the witness points of all frames."""
        at = self.told[:, T.LEAVES : T.PARAMETERS + 4].copy()
        rows, first = self._all_minima()
        has = np.flatnonzero(np.diff(first))
        at[has] = rows[first[has], 1:7]  # as a point of a face may be told as one of its edge
        solids, found, values = (self.asks.a, self.asks.b), list[Any](), list[Array]()
        for side, solid in enumerate(solids):
            leaves, own = at[:, side], at[:, 2 + 2 * side : 4 + 2 * side]
            features, parameters = features_at(solid, leaves), np.full((len(leaves), 3), np.nan)
            for k, row in enumerate(own):
                if k not in self.special:
                    given = solid.parameters_of(int(leaves[k]), row)
                    parameters[k, : len(given)] = given
            for k, answer in self.special.items():
                features[k] = (answer.feature_a, answer.feature_b)[side]
                given = (answer.parameters_a, answer.parameters_b)[side]
                parameters[k, : len(given)] = given
            found.append(features)
            values.append(parameters)
        return WitnessPlaces(*found, *values)

    def minima_told(self) -> tuple[LocalMinima, tuple[MinimumEvent, ...]]:
        """The local minima of all frames, and what becomes of them.

        Raises StandoffError: none were asked.
        """
        length = self.asks.options.minima
        if length is None:
            raise StandoffError(
                "These frames tell no local minima: give the tracker minima=, a length below which "
                "they are kept.",
                "minima",
                None,
            )
        solids = self.asks.a, self.asks.b
        told = minima_of(solids, *self._all_minima(), self.special, self.a)
        course = EventCourse(told, self.told[:, T.MOTION], length, self.merged)
        return told, tuple(events_of(course, self.state.proximity))

    def _through(self) -> KeptFront | None:
        """All frames; the front after the last."""
        front, at = self.state.front, 0
        while at < len(self.relative):
            if front is None or front.contact is not None:
                front, at = self._meet(front, at)
            else:
                front, at = self._gone(front, at)
        return front

    def _meet(
        self, front: KeptFront | None, at: int, motion: float = np.nan
    ) -> tuple[KeptFront | None, int]:
        """A frame in which the solids may overlap, after a motion, length, and those after it if
        they do not; the front after them."""
        pair, in_contact = self.pair(at), front is not None and front.contact is not None
        before = self.relative[at - 1] if at else self._first
        if in_contact:
            motion = moved_by(before, pair.relative, self.asks.b.size)
        placed = pair, self.relative[at]
        told = self.asks.met(placed, front, self.born, None if self._overlapped(at - 1) else before)
        if told is not None:
            self.special[at], front, merged = told
            for _, key, into in merged.tolist():
                self.merged[at, key] = into
            self.born = front.born
            self.told[at, T.MOTION], self.told[at, T.ANEW] = motion, 0.0
            return front, at + 1
        if front is None or not in_contact:
            return self._ask(at), at + 1
        front, after = self._gone(front._replace(contact=None), at)
        self.told[at, T.MOTION] = motion  # and not since they were apart
        return front, after

    def _gone(self, front: KeptFront, at: int) -> tuple[KeptFront | None, int]:
        """Frames from a front on, as far as they are answered by it; the front after them."""
        frames = self.asks.frames(front)
        while at < len(self.relative):
            first, at = at, at + frames.go(self.relative[at:], self.told[at:])
            if not self._taken(frames, first, at, front.inside):
                self.born = frames.born
                return self._meet(frames.kept(), at - 1, float(self.told[at - 1, T.MOTION]))
        return frames.kept(), at

    def _taken(self, frames: FrontFrames, first: int, end: int, inside: str) -> bool:
        """Take what the kernel told of frames first .. end - 1: is the last one answered?"""
        self.minima.append(frames.minima)
        self.inside[first:end] = inside
        settled = self._settled(end - 1, frames, inside)
        if not settled:  # what is proven of the boundaries does not hold the solids apart
            frames.not_apart()
        for k, key, into in frames.merged().tolist():
            self.merged[first + k, key] = into
        return settled

    def taken_up(
        self, frames: FrontFrames, told: Array, inside: str, before: Array
    ) -> tuple[SolidProximity, FrontFrames | KeptFront | None]:
        """The answer of a run of one frame, whose row the kernel has told, after one in which the
        solids were apart with B at the pose `before` (12,) in A's frame; and what the next one goes
        on from, `frames` themselves where they go on."""
        self._before = before
        self.told[:], frames.minima = told, frames.told(told)
        after: FrontFrames | KeptFront | None = frames
        if not self._taken(frames, 0, 1, inside):
            self.born = frames.born
            after, _ = self._meet(frames.kept(), 0, float(self.told[0, T.MOTION]))
        return self.special[0] if self.special else self._made(0), after

    def made(self, told: Array, inside: str, minima: Array) -> SolidProximity:
        """The answer of a run of one frame, of what the kernel told of it alone."""
        self.told[:], self.inside[0] = told, inside
        self.minima.append(minima)
        return self._made(0)

    def pair(self, k: int) -> PlacedPair:
        """Both at their poses in a frame."""
        poses = (_checked(row) for row in (self.a[k], self.b[k]))
        return PlacedPair(self.asks.a, self.asks.b, *poses)

    def _ask(self, k: int) -> KeptFront | None:
        """A frame from nothing."""
        self.special[k], front = self.asks.cold(self.pair(k), self.born)
        if front is not None:
            self.born = front.born
        self.told[k, T.MOTION], self.told[k, T.ANEW] = np.nan, 0.0
        return front

    def _settled(self, k: int, frames: FrontFrames, inside: Any) -> bool:
        """Is a frame answered, the last that was done? False: it is to be asked from nothing."""
        row = self.told[k]
        if row[T.ENDED] == T.TO_ASK:
            return False
        if row[T.ENDED] == T.SINGLE and row[T.SURE]:
            return True
        pair = self.pair(k)
        if not row[T.SURE] and inside_of(pair) != inside:
            return False
        if row[T.ENDED] != T.SINGLE:
            answer = self.asks.apart(pair, frames, inside, float(row[T.MOTION]))
            self.special[k] = _counted(answer, row)
        return True

    def _made(self, k: int) -> SolidProximity:
        """The answer of a frame that is proven at one place."""
        row, pair, inside = self.told[k], self.pair(k), self.inside[k]
        found = _found(row, self.asks.sought(pair).tolerance)
        minima = self._minima_of(k)
        senses, rows = senses_of(inside), list(minima[:, :POINTS]) or [found.best]
        patches = [patch_told(pair, each) for each in minima] if self.asks.options.patch else []
        told = AnswerFacts(status_of(inside), Smoothness.SMOOTH, inside=inside, patches=patches)
        places = [pair.place(each, senses) for each in rows]
        answer = answer_of(pair, found, places, told)
        if len(minima):
            answer = numbered(answer, minima[:, SET_BRANCH])
        return _counted(answer, row)

    def _all_minima(self) -> tuple[Array, NDArray[np.int64]]:
        """What the kernel told of local minima, rows of all frames, and where each frame's
        begin."""
        if len(self.minima) != 1:
            self.minima = [np.concatenate(self.minima)]
            np.cumsum(self.told[:, T.N_SETS], out=self.first[1:], dtype=np.int64)
        return self.minima[0], self.first

    def _minima_of(self, k: int) -> Array:
        rows, first = self._all_minima()
        return rows[first[k] : first[k + 1]]


def status_of(inside: str) -> Status:
    """Of a frame that is proven at one place."""
    return Status.CONTAINED if inside else Status.CONVERGED


def _counted(answer: SolidProximity, row: Array) -> SolidProximity:
    """With what a frame took."""
    taken, rebuilds = int(row[T.TAKEN]), int(row[T.ANEW])
    return replace(answer, counts=answer.counts._replace(evaluations=taken, rebuilds=rebuilds))


def _found(row: Array, tolerance: float) -> LeastFound:
    best = np.array([row[T.DISTANCE], *row[T.LEAVES : T.LEAVES + 2],
                     *row[T.PARAMETERS : T.PARAMETERS + 4], 0.0])  # fmt: skip
    return LeastFound(
        float(row[T.DISTANCE]), float(row[T.BOUND]), tolerance, False, best[None], best,
        np.empty((0, 11)), 0, (0, 0, 0, 0, 0), 0,
    )  # fmt: skip


def _checked(row: Array) -> Pose:
    return Pose.from_checked(row[:9].reshape(3, 3), row[9:])


def _relative(a: Array, b: Array) -> Array:
    """B's poses (n, 12) in A's frame, of world poses that were checked."""
    found = np.empty((len(a), 12))
    T.placed_beside(np.ascontiguousarray(a), np.ascontiguousarray(b), found)
    return found
