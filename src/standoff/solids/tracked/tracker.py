"""The tracker of two solids: a proven distance in each frame, from the bounds of the last one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from standoff.checks.numbers import positive, whole_number
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.entries.preparing import prepare_tracked_solids
from standoff.motion import Pose
from standoff.motion.vectors import pose_row
from standoff.read_only import KeepsReadOnly
from standoff.shown_names import hides
from standoff.solids.answer import SolidProximity
from standoff.solids.asked import DEADLINE, PATCH_ALONE, QueryOptions
from standoff.solids.spatial.bare_point import BarePoint
from standoff.solids.spatial.models import as_model
from standoff.solids.spatial.pair import PlacedPair
from standoff.solids.spatial.sides import vertex_normals_of
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.stationary import fans_of
from standoff.solids.spatial.tolerances import NEAREST_ALONE
from standoff.solids.tracked.answers import SolidAnswers
from standoff.solids.tracked.asks import TrackedPair
from standoff.solids.tracked.frame_buffer import SolidFrameBuffer
from standoff.solids.tracked.front import FrontFrames, KeptFront
from standoff.solids.tracked.run import Run
from standoff.solids.tracked.state import SolidState
from standoff.tracking.pose_arrays import flat_poses, mended, read_poses
from standoff.typing import Array

if TYPE_CHECKING:
    from standoff.motion import PoseLike, PosesLike
    from standoff.motion.moving import Moving
    from standoff.progress import Progress
    from standoff.recording import Recording


@hides("answers_of", "asks", "frames", "recorded_along", "telling_features")
class SolidTracker(KeepsReadOnly):
    """Keeps the proven distance of two solids while they move; ``so.Tracker`` of solids makes it.

    In each frame the witness points go on by Newton's method, and only pairs of pieces whose bounds
    the motion has used up are looked at again. An answer is that of ``so.solids.distance`` at the
    same poses: the same statuses, and proven to the same tolerance.

    Raises TypeError: neither a solid nor a body. Raises StandoffError: a body that is not bounded
    or has no volume.

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
        Local minima below this length are kept in each frame; after a leap one may be missing.
    patch : float, optional
        Of each of them up to four pairs of points, as of ``so.solids.distance``.
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
            raise StandoffError(PATCH_ALONE.format(patch=shown(patch)), "patch", patch)
        asked = QueryOptions(None, self.tolerance, self.minima, self.deadline, self.patch)
        self._asks = TrackedPair(self.a, self.b, asked)
        prepare_tracked_solids()

    def start(self, pose_a: PoseLike, pose_b: PoseLike) -> SolidState:
        """Find the witness points globally, and prove it, whatever time a frame has.

        Raises ValueError: no pose.

        Parameters
        ----------
        pose_a, pose_b : Pose or what ``Pose.of`` reads
            World poses of the solids' frames.

        Returns
        -------
        SolidState
        """
        pair = PlacedPair(self.a, self.b, Pose.of(pose_a), Pose.of(pose_b))
        for body in (self.a, self.b):  # no frame waits for what a contact asks of its vertices
            fans_of(body), vertex_normals_of(body)
        answer, front = self._asks.in_time().cold(pair)
        return SolidState(answer, (self.a, self.b), front, 0 if front is None else front.born)

    def step(
        self, state: SolidState, pose_a: PoseLike, pose_b: PoseLike
    ) -> tuple[SolidState, SolidProximity]:
        """The answer at the given poses, from the state of the frame before.

        Raises TypeError: `state` is no state. Raises ValueError: a state of another pair, or no
        pose.

        Parameters
        ----------
        state : SolidState
            Of this pair; it is not changed.
        pose_a, pose_b : Pose or what ``Pose.of`` reads
            World poses of the solids' frames.

        Returns
        -------
        (SolidState, SolidProximity)
        """
        self._check(state)
        poses = Pose.of(pose_a), Pose.of(pose_b)
        a, b = (pose_row(p.rotation, p.translation)[None] for p in poses)
        return Run(self._asks, state, a, b).single()

    def buffer(self, state: SolidState) -> SolidFrameBuffer:
        """Arrays for ``step_into`` that begin at a state.

        Raises TypeError, ValueError as ``step``.
        """
        self._check(state)
        return SolidFrameBuffer(self._asks, state)

    def step_into(
        self,
        buffer: SolidFrameBuffer,
        pose_a: PoseLike | None = None,
        pose_b: PoseLike | None = None,
    ) -> float:
        """One frame in place, for loops that must not allocate.

        ``buffer.distance``, ``lower_bound``, ``upper_bound``, ``normal``, ``point_a``, ``point_b``
        and ``status`` read its answer without making an object. A frame that ties, or in which the
        solids begin or cease to overlap, or only touch, is made as ``step`` makes it.

        Raises StandoffError: a buffer of another tracker. Raises ValueError: no pose.

        Parameters
        ----------
        buffer : SolidFrameBuffer
            Of this tracker. Without poses the frame reads ``buffer.pose_a`` and ``pose_b``.
        pose_a, pose_b : Pose or what ``Pose.of`` reads, optional
            World poses of the solids' frames. Arrays (4, 4) of float64 are read as they are;
            anything else is converted first.

        Returns
        -------
        float
            The distance.
        """
        if buffer.asks is not self._asks:
            raise StandoffError(
                "The buffer belongs to another tracker: make one with tracker.buffer.", "buffer"
            )
        if type(pose_a) is type(pose_b) is np.ndarray:
            if not buffer.put_arrays(pose_a, pose_b):
                buffer.put(pose_a, pose_b)
        elif pose_a is not None or pose_b is not None:
            buffer.put(pose_a, pose_b)  # type: ignore[arg-type]
        else:
            buffer.repaired = 0
        return buffer.step()

    def run(
        self, state: SolidState, poses_a: PosesLike, poses_b: PosesLike
    ) -> tuple[SolidState, SolidAnswers]:
        """Many frames, each from the state of the one before, as with ``step``.

        Raises TypeError, ValueError as ``step``, with the number of the frame; nothing is answered
        then.

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
        return Run(self._asks, state, a, b).answers()

    def recorded_along(
        self,
        paths: tuple[Moving, Moving],
        times: Array,
        state: SolidState | None = None,
        *,
        locate: bool = True,
        progress: Progress | None = None,
    ) -> Recording:
        """Track along two paths at given times, s; `standoff.recording.track` asks for it."""
        from standoff.solids.tracked.record import recorded

        if state is not None:
            self._check(state)
        return recorded(self, paths, times, state, locate=locate, progress=progress)

    def telling_features(self) -> SolidTracker:
        """This tracker, or one that asks the same and tells in each frame the feature with the
        fewest parameters that a witness point is on, as trackers with ``minima=`` do."""
        if self.minima is not None:
            return self
        a, b, dt, tolerance, deadline = self.a, self.b, self.dt, self.tolerance, self.deadline
        return SolidTracker(a, b, dt, tolerance=tolerance, deadline=deadline, minima=NEAREST_ALONE)

    def answers_of(self, state: SolidState, poses_a: Array, poses_b: Array) -> SolidAnswers:
        """The answer of a state as arrays, with the poses (1, 4, 4) that it is of."""
        return Run(self._asks, state, flat_poses(poses_a), flat_poses(poses_b)).of_state()

    def frames(self, front: KeptFront) -> FrontFrames:
        """Frames from a front on, with what this tracker asks."""
        return self._asks.frames(front)

    @property
    def asks(self) -> TrackedPair:
        """What each frame is asked."""
        return self._asks

    def _check(self, state: SolidState) -> None:
        if not isinstance(state, SolidState):
            raise StandoffTypeError(
                f"{shown(state)} is no SolidState: get one from tracker.start.", "state", state
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
