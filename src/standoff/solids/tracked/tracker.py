"""The tracker of two solids: a proven distance in each frame, from the bounds of the last one."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from standoff.checks.numbers import positive, whole_number
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.entries import tracked_solids as T
from standoff.kernels.entries.preparing import prepare_tracked_solids
from standoff.motion import Pose
from standoff.read_only import KeepsReadOnly
from standoff.shown_names import hides
from standoff.solids.answer import SolidProximity
from standoff.solids.asked import DEADLINE, PATCH_ALONE, Asked
from standoff.solids.spatial.bare_point import BarePoint
from standoff.solids.spatial.distance import (
    Told,
    answer_of,
    inside_of,
    reach_of_minima,
    senses_of,
    spatial_distance,
    told_apart,
)
from standoff.solids.spatial.minimum import Found, Sought
from standoff.solids.spatial.models import as_model
from standoff.solids.spatial.pair import PlacedPair
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.tolerances import PROOF_TOLERANCE
from standoff.solids.tracked.answers import SolidAnswers, world_places
from standoff.solids.tracked.front import Frames, Front, front_at, room_for
from standoff.tracking.derivatives import Smoothness
from standoff.tracking.pose_arrays import flat_poses, mended, read_poses
from standoff.tracking.status import Status

if TYPE_CHECKING:
    from standoff.motion import PoseLike, PosesLike

Array = NDArray[np.float64]


@hides("front")
class SolidState(KeepsReadOnly):
    """What a tracker of solids carries from frame to frame, as a value: it is never changed.

    Attributes
    ----------
    proximity : SolidProximity
        The answer at the frame of this state.
    rows : int
        Pairs of pieces whose bounds are kept; 0 after a frame in which the solids meet.
    """

    __slots__ = ("_pair", "front", "proximity")

    def __init__(
        self, proximity: SolidProximity, pair: tuple[SolidModel, SolidModel], front: Front | None
    ) -> None:
        self.proximity, self._pair, self.front = proximity, pair, front

    @property
    def rows(self) -> int:
        return int(self.front.store[0]) if self.front else 0

    def __repr__(self) -> str:
        return f"<SolidState of {self.rows} rows: {self.proximity!r}>"


class SolidTracker(KeepsReadOnly):
    """Keeps the proven distance of two solids while they move; ``so.Tracker`` of solids makes it.

    In each frame the witness points go on by Newton's method, and only pairs of pieces whose bounds
    the motion has used up are looked at again. An answer is that of ``so.solids.distance`` at the
    same poses: the same statuses, and proven to the same tolerance.

    Parameters
    ----------
    a, b : Solid or Body
        At least one of them a `Solid`.
    dt : float
        Frame time, s, for who asks the tracker: no answer depends on it.
    tolerance : float, optional
        As of ``so.solids.distance``.
    deadline : int, optional
        Most evaluations of a frame. What is then open stays an interval, with the status DEADLINE,
        and the next frame goes on from there.
    minima : float, optional
        All local minima of the distance below this one are kept in each frame, length.
    patch : float, optional
        Of each of them up to four pairs of points, as of ``so.solids.distance``.

    Raises
    ------
    TypeError
        Neither a solid nor a body.
    StandoffError
        A body that is not bounded or has no volume.
    """

    def __init__(
        self,
        a: Any,
        b: Any,
        dt: float = 1e-3,
        *,
        tolerance: float | None = None,
        deadline: int = DEADLINE,
        minima: float | None = None,
        patch: float | None = None,
    ) -> None:
        self.dt = positive(dt, "dt")
        self.a, self.b = as_model(a), as_model(b)
        for name, body in (("A", self.a), ("B", self.b)):
            why = untracked(body)
            if why:
                raise StandoffError(f"Body {name} {why}", name.lower(), body)
        self.tolerance = None if tolerance is None else positive(tolerance, "tolerance")
        self.deadline = whole_number(deadline, "deadline")
        self.minima = None if minima is None else positive(minima, "minima")
        self.patch = None if patch is None else positive(patch, "patch")
        if self.patch is not None and self.minima is None:
            raise StandoffError(PATCH_ALONE.format(patch=patch), "patch", patch)
        prepare_tracked_solids()

    def start(self, pose_a: PoseLike, pose_b: PoseLike) -> SolidState:
        """Find the witness points globally, and prove it.

        Parameters
        ----------
        pose_a, pose_b : Pose or what ``Pose.of`` reads
            World poses of the solids' frames.

        Returns
        -------
        SolidState

        Raises
        ------
        ValueError
            No pose.
        """
        pair = PlacedPair(self.a, self.b, Pose.of(pose_a), Pose.of(pose_b))
        return SolidState(*self._cold(pair))

    def step(
        self, state: SolidState, pose_a: PoseLike, pose_b: PoseLike
    ) -> tuple[SolidState, SolidProximity]:
        """The answer at the given poses, from the state of the frame before.

        Parameters
        ----------
        state : SolidState
            Of this pair; it is not changed.
        pose_a, pose_b : Pose or what ``Pose.of`` reads
            World poses of the solids' frames.

        Returns
        -------
        (SolidState, SolidProximity)

        Raises
        ------
        TypeError
            `state` is no state.
        ValueError
            A state of another pair, or no pose.
        """
        made, _ = self.run(state, Pose.of(pose_a), Pose.of(pose_b))
        return made, made.proximity

    def run(
        self, state: SolidState, poses_a: PosesLike, poses_b: PosesLike
    ) -> tuple[SolidState, SolidAnswers]:
        """Many frames, each from the state of the one before, as with ``step``.

        Parameters
        ----------
        state : SolidState
            Of this pair; it is not changed.
        poses_a, poses_b : array_like, shape (n, 4, 4) or (n, 12), or one pose for all frames
            World poses; any form that ``so.distances`` reads.

        Returns
        -------
        (SolidState, SolidAnswers)
            The state after the last frame, and all answers as arrays.

        Raises
        ------
        TypeError, ValueError
            As ``step``, with the number of the frame; nothing is answered then.
        """
        self._check(state)
        a, b = _read(poses_a, "poses_a"), _read(poses_b, "poses_b")
        n = max(len(a), len(b))
        if len(a) not in (1, n) or len(b) not in (1, n):
            raise StandoffError(
                f"poses_a are of {len(a)} frames, poses_b of {len(b)}: give all for n frames, or "
                "one for all of them.",
                "poses_b",
            )
        a, b = np.broadcast_to(a, (n, 12)), np.broadcast_to(b, (n, 12))
        return _Run(self, state, a, b).answers()

    def _cold(self, pair: PlacedPair) -> tuple[SolidProximity, tuple[Any, Any], Front | None]:
        """An answer from nothing, with the front that frames go on from where there is one."""
        asked = Asked(None, self.tolerance, self.minima, self.deadline, self.patch)
        answer = spatial_distance(self.a, self.b, *_poses_of(pair), asked)
        answer = replace(answer, counts=answer.counts._replace(restarts=1))
        front = None
        if answer.lower_bound > 0.0:
            sought, senses = self._sought(pair), senses_of(answer.inside)
            front = front_at(pair, pair.least(senses, sought), senses, sought)
            frames = self.frames(front)
            frames.go(pair.relative[None], room_for(1))
            front = frames.kept()
        return answer, (self.a, self.b), front

    @property
    def proof(self) -> float:
        """To what the distance is proven where roundings are smaller, length."""
        default = PROOF_TOLERANCE * (self.a.size + self.b.size)
        return default if self.tolerance is None else self.tolerance

    def frames(self, front: Front) -> Frames:
        """Frames from a front on, with what this tracker asks."""
        return Frames(
            (self.a.packed, self.b.packed), front, self.proof, self.deadline, self.minima or 0.0
        )

    def _sought(self, pair: PlacedPair) -> Sought:
        reach = reach_of_minima(self.minima, self.patch)
        return Sought(pair.provable(self.proof), self.deadline, np.inf, *reach)

    def _check(self, state: SolidState) -> None:
        if not isinstance(state, SolidState):
            raise StandoffTypeError(
                f"{state!r} is no SolidState: get one from tracker.start.", "state", state
            )
        for name, own, other in zip("AB", (self.a, self.b), state._pair, strict=True):
            if own is not other:
                raise StandoffError(
                    f"The state belongs to another pair: its body {name} is {other!r}, the "
                    f"tracker's is {own!r}.",
                    "state",
                    state,
                )


def untracked(body: SolidModel) -> str:
    """Why a tracker does not keep a body's distance, and what to do; "" where it does."""
    if not body.bounded:
        return (
            "is a half-space, which is not bounded: a tracker keeps bounds of pieces of both; ask "
            "so.distance in each frame."
        )
    if isinstance(body, BarePoint):
        return (
            "is a point: so.distance asks it in each frame, and solid.signed_distance many of them "
            "at once."
        )
    return ""


def is_tracked(a: Any, b: Any) -> bool:
    """Are two models of solids in space such that a tracker keeps their distance?"""
    return all(isinstance(each, SolidModel) and not untracked(each) for each in (a, b))


class _Run:
    """One call of `SolidTracker.run`."""

    def __init__(self, tracker: SolidTracker, state: SolidState, a: Array, b: Array) -> None:
        self.tracker, self.state = tracker, state
        self.a, self.b = a, b
        self.relative = _relative(a, b)
        self.told = room_for(len(a))
        self.inside = np.full(len(a), "", dtype=object)
        self.special: dict[int, SolidProximity] = {}

    def answers(self) -> tuple[SolidState, SolidAnswers]:
        front, at, n = self.state.front, 0, len(self.relative)
        while at < n:
            if front is None:
                front, at = self._ask(at), at + 1
            else:
                front, at = self._gone(front, at)
        slack = self.tracker.a.slack + self.tracker.b.slack
        statuses = np.array([_status(inside) for inside in self.inside], dtype=object)
        places = world_places(self.told, self.a)
        answers = SolidAnswers(self.told, places, self.special, (statuses, slack), self._made)
        return SolidState(answers[n - 1], (self.tracker.a, self.tracker.b), front), answers

    def _gone(self, front: Front, at: int) -> tuple[Front | None, int]:
        """Frames from a front on, as far as they are answered by it; the front after them."""
        frames = self.tracker.frames(front)
        while at < len(self.relative):
            first, at = at, at + frames.go(self.relative[at:], self.told[at:])
            self.inside[first:at] = front.inside
            if not self._settled(at - 1, frames, front.inside):
                return self._ask(at - 1), at
        return frames.kept(), at

    def _pair(self, k: int) -> PlacedPair:
        poses = (_checked(row) for row in (self.a[k], self.b[k]))
        return PlacedPair(self.tracker.a, self.tracker.b, *poses)

    def _ask(self, k: int) -> Front | None:
        """A frame from nothing."""
        self.special[k], _, front = self.tracker._cold(self._pair(k))
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
            sought, found = self.tracker._sought(pair), frames.found()
            answer = told_apart(pair, found, senses_of(inside), inside, sought)
            self.special[k] = _counted(answer, row)
        return True

    def _made(self, k: int) -> SolidProximity:
        """The answer of a frame that is proven at one place."""
        row, pair, inside = self.told[k], self._pair(k), self.inside[k]
        found = _found(row, self.tracker._sought(pair).tolerance)
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


def _poses_of(pair: PlacedPair) -> tuple[Pose, Pose]:
    one, other = (_checked(row) for row in pair.poses)
    return one, other


def _checked(row: Array) -> Pose:
    return Pose.from_checked(row[:9].reshape(3, 3), row[9:])


def _read(given: Any, name: str) -> Array:
    """World poses (n, 12)."""
    found = mended(read_poses(given, name).matrices)
    if found.refused.any():
        k = int(found.refused.argmax())
        raise StandoffError(
            f"{name}, frame {k}, is no pose: its rotation is not one, or a number is not finite "
            f"or too large:\n{found.matrices[k]}",
            name,
            found.matrices[k],
        )
    return flat_poses(found.matrices)


def _relative(a: Array, b: Array) -> Array:
    """B's poses (n, 12) in A's frame."""
    turns = a[:, :9].reshape(-1, 3, 3)
    rotation = np.einsum("nji,njk->nik", turns, b[:, :9].reshape(-1, 3, 3))
    shift = np.einsum("nji,nj->ni", turns, b[:, 9:] - a[:, 9:])
    return np.ascontiguousarray(np.concatenate([rotation.reshape(-1, 9), shift], axis=1))
