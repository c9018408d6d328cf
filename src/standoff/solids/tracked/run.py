"""One call of a tracker of solids: its frames, in compiled loops as far as these go."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.entries import tracked_solids as T
from standoff.motion import Pose
from standoff.solids.answer import SolidProximity
from standoff.solids.spatial.distance import Told, answer_of, inside_of, senses_of, told_apart
from standoff.solids.spatial.minimum import Found
from standoff.solids.spatial.pair import PlacedPair
from standoff.solids.tracked.answers import SolidAnswers, world_places
from standoff.solids.tracked.asks import Asks
from standoff.solids.tracked.front import Frames, Front, room_for
from standoff.solids.tracked.state import SolidState
from standoff.tracking.derivatives import Smoothness
from standoff.tracking.status import Status

Array = NDArray[np.float64]


class Run:
    """Frames with A and B at world poses (n, 12), from the state of the frame before on."""

    def __init__(self, asks: Asks, state: SolidState, a: Array, b: Array) -> None:
        self.asks, self.state = asks, state
        self.a, self.b = a, b
        self.relative = _relative(a, b)
        self.told = room_for(len(a))
        self.inside = np.full(len(a), "", dtype=object)
        self.special: dict[int, SolidProximity] = {}

    def single(self) -> tuple[SolidState, SolidProximity]:
        """Of a run of one frame, without arrays."""
        front = self._through()
        answer = self.special[0] if self.special else self._made(0)
        return SolidState(answer, (self.asks.a, self.asks.b), front), answer

    def answers(self) -> tuple[SolidState, SolidAnswers]:
        front = self._through()
        slack = self.asks.a.slack + self.asks.b.slack
        statuses = np.array([_status(inside) for inside in self.inside], dtype=object)
        places = world_places(self.told, self.a)
        answers = SolidAnswers(self.told, places, self.special, (statuses, slack), self._made)
        return SolidState(answers[len(answers) - 1], (self.asks.a, self.asks.b), front), answers

    def _through(self) -> Front | None:
        """All frames; the front after the last."""
        front, at = self.state.front, 0
        while at < len(self.relative):
            if front is None:
                front, at = self._ask(at), at + 1
            else:
                front, at = self._gone(front, at)
        return front

    def _gone(self, front: Front, at: int) -> tuple[Front | None, int]:
        """Frames from a front on, as far as they are answered by it; the front after them."""
        frames = self.asks.frames(front)
        while at < len(self.relative):
            first, at = at, at + frames.go(self.relative[at:], self.told[at:])
            self.inside[first:at] = front.inside
            if not self._settled(at - 1, frames, front.inside):
                return self._ask(at - 1), at
        return frames.kept(), at

    def _pair(self, k: int) -> PlacedPair:
        poses = (_checked(row) for row in (self.a[k], self.b[k]))
        return PlacedPair(self.asks.a, self.asks.b, *poses)

    def _ask(self, k: int) -> Front | None:
        """A frame from nothing."""
        self.special[k], front = self.asks.cold(self._pair(k))
        self.told[k, T.MOTION], self.told[k, T.ANEW] = np.nan, 0.0
        return front

    def _settled(self, k: int, frames: Frames, inside: Any) -> bool:
        """Is a frame answered, the last that was done? False: it is to be asked from nothing."""
        row = self.told[k]
        if row[T.ENDED] == T.TO_ASK:
            return False
        if row[T.ENDED] == T.SINGLE and row[T.SURE]:
            return True
        pair = self._pair(k)
        if not row[T.SURE] and inside_of(pair) != inside:
            return False
        if row[T.ENDED] != T.SINGLE:
            sought, found = self.asks.sought(pair), frames.found()
            answer = told_apart(pair, found, senses_of(inside), inside, sought)
            self.special[k] = _counted(answer, row)
        return True

    def _made(self, k: int) -> SolidProximity:
        """The answer of a frame that is proven at one place."""
        row, pair, inside = self.told[k], self._pair(k), self.inside[k]
        found = _found(row, self.asks.sought(pair).tolerance)
        place = pair.place(found.best, senses_of(inside))
        told = Told(_status(inside), Smoothness.SMOOTH, inside=inside)
        return _counted(answer_of(pair, found, [place], told), row)


def _status(inside: str) -> Status:
    """Of a frame that is proven at one place."""
    return Status.CONTAINED if inside else Status.CONVERGED


def _counted(answer: SolidProximity, row: Array) -> SolidProximity:
    """With what a frame took."""
    taken, rebuilds = int(row[T.TAKEN]), int(row[T.ANEW])
    return replace(answer, counts=answer.counts._replace(evaluations=taken, rebuilds=rebuilds))


def _found(row: Array, tolerance: float) -> Found:
    best = np.array([row[T.DISTANCE], *row[T.LEAVES : T.LEAVES + 2],
                     *row[T.PARAMETERS : T.PARAMETERS + 4], 0.0])  # fmt: skip
    return Found(
        float(row[T.DISTANCE]), float(row[T.BOUND]), tolerance, False, best[None], best,
        np.empty((0, 11)), 0, (0, 0, 0, 0, 0), 0,
    )  # fmt: skip


def _checked(row: Array) -> Pose:
    return Pose.from_checked(row[:9].reshape(3, 3), row[9:])


def _relative(a: Array, b: Array) -> Array:
    """B's poses (n, 12) in A's frame."""
    turns = a[:, :9].reshape(-1, 3, 3)
    rotation = np.einsum("nji,njk->nik", turns, b[:, :9].reshape(-1, 3, 3))
    shift = np.einsum("nji,nj->ni", turns, b[:, 9:] - a[:, 9:])
    return np.ascontiguousarray(np.concatenate([rotation.reshape(-1, 9), shift], axis=1))
