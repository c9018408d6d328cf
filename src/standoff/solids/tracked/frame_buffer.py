"""One frame's arrays of two solids, reused, for loops that must not allocate."""

from __future__ import annotations

import math
from operator import attrgetter
from typing import Any

import numpy as np

from standoff.errors import StandoffError
from standoff.kernels.entries import tracked_solids as T
from standoff.kernels.entries.solid_contact import (
    ALONG,
    AT_BOTH,
    DEPTH,
    DISTANCE,
    FIRST,
    PARTING,
    follow_contact,
)
from standoff.kernels.state.arrays import BAD_POSE_A
from standoff.motion import PoseLike
from standoff.solids.answer import SolidProximity
from standoff.solids.tracked.asks import TrackedPair
from standoff.solids.tracked.contact import ContactFrames, new_contact_room
from standoff.solids.tracked.front import FrontFrames, KeptFront, new_room, room_for
from standoff.solids.tracked.run import Run, status_of
from standoff.solids.tracked.state import SolidState
from standoff.tracking.inputs import LAST_ROW, flat_and_mark, repair
from standoff.tracking.status import Status
from standoff.typing import Array

ARRAY = np.ndarray


class SolidFrameBuffer:
    """Arrays of one frame, reused: write into the poses (12 numbers: R row-major, p).

    The arrays are written into, not replaced. ``normal``, ``point_a`` and ``point_b`` are views of
    the answer, made once: each frame changes them, so copy what must outlive it.

    Parameters
    ----------
    asks : TrackedPair
        What the tracker asks whose ``step_into`` will be called.
    state : SolidState
        Where it begins; copied.

    Attributes
    ----------
    distance, lower_bound, upper_bound : float
    status : Status
        As in `SolidProximity`.
    repaired : int
        How many of the last frame's two poses were rounded, and replaced by the nearest rotation.
    """

    def __init__(self, asks: TrackedPair, state: SolidState) -> None:
        self.asks, self._room = asks, new_room()
        self._slack = asks.a.slack + asks.b.slack
        self._a, self._b = np.zeros((2, 1, 12))
        for row in (self._a, self._b):
            row[0, [0, 4, 8]] = 1.0
        self._pose_a, self._pose_b = self._a[0], self._b[0]
        self._now, self._told = np.empty((1, 12)), room_for(1)
        self._turn, self._shift = self._pose_a[:9].reshape(3, 3).T, self._pose_a[9:]
        self._own = self._told[0, T.POINT_A : T.POINT_A + 6].reshape(2, 3)
        self._points, self._away = np.empty((2, 3)), np.empty(3)
        views = self._away.view(), self._points[0], self._points[1]
        for view in views:
            view.flags.writeable = False
        self._normal, self._point_a, self._point_b = views
        self._pair, self.repaired = (asks.a, asks.b), 0
        self._answer: SolidProximity | None = None
        self._frames: FrontFrames | None = None
        self._contact: ContactFrames | None = None
        self._call: tuple[Any, ...] = ()
        self._room_of_contact = new_contact_room()
        pressed = self._room_of_contact.told[AT_BOTH : ALONG + 3].reshape(3, 3)
        self._pressed_at, self._pressed_along = pressed[:2], pressed[2]
        self._load(state.front, state.born)
        self._tell(state.proximity)

    def __reduce__(self) -> Any:
        raise StandoffError(
            "A buffer of solids is not stored: store buffer.state, and make a buffer of it with "
            "tracker.buffer."
        )

    pose_a = property(attrgetter("_pose_a"), doc="(12,) pose of A.")
    pose_b = property(attrgetter("_pose_b"), doc="(12,) pose of B.")
    normal = property(attrgetter("_normal"), doc="(3,) unit vector from A to B, read-only.")
    point_a = property(attrgetter("_point_a"), doc="(3,) witness point on A, read-only.")
    point_b = property(attrgetter("_point_b"), doc="(3,) witness point on B, read-only.")

    @property
    def certified(self) -> bool:
        """Is the distance proven?"""
        return self.status.certified

    @property
    def state(self) -> SolidState:
        """What ``step`` would go on from, as a value."""
        frames = self._frames or self._contact
        front = self._front if frames is None else frames.kept()
        born = self._born if front is None else front.born
        return SolidState(self.proximity(), self._pair, front, born)

    def proximity(self) -> SolidProximity:
        """The last answer as a value."""
        if self._answer is None and self._contact is not None:
            places = self._contact.places()
            self._answer = self.asks.in_contact(self._run().pair(0), places)
        elif self._answer is None:
            assert self._frames is not None
            self._answer = self._run().made(self._told, self._inside, self._frames.told(self._told))
        return self._answer

    def put(self, pose_a: PoseLike, pose_b: PoseLike) -> None:
        """Write the poses of a frame, given in any form."""
        given = [_flat(pose) for pose in (pose_a, pose_b)]
        for row, (flat, _) in zip((self._pose_a, self._pose_b), given, strict=True):
            row[:] = flat
        self.repaired = given[0][1] + given[1][1]

    def put_arrays(self, pose_a: Array, pose_b: Array) -> bool:
        """Write the poses of a frame if they are plain matrices (4, 4)."""
        for pose in (pose_a, pose_b):
            if pose.shape != (4, 4) or pose.dtype != np.float64 or pose[3].tolist() != LAST_ROW:
                return False
        for row, pose in ((self._pose_a, pose_a), (self._pose_b, pose_b)):
            row[:9].reshape(3, 3)[:], row[9:] = pose[:3, :3], pose[:3, 3]
        self.repaired = 0
        return True

    def step(self) -> float:
        """The distance of a frame with the poses in the buffer."""
        while why := T.placed_beside(self._a, self._b, self._now):
            side = (self._pose_a, "pose_a") if why == BAD_POSE_A else (self._pose_b, "pose_b")
            repair(*side)
            self.repaired += 1
        if self._frames is None:
            return self._anew() if self._contact is None else self._in_contact(self._contact)
        T.solid_frames(*self._call)
        row = self._told[0]
        if row.item(T.ENDED) != T.SINGLE or row.item(T.SURE) == 0.0:
            before = self._frames.before[:12].copy()
            self._frames.went_to(self._now, row)
            return self._looked_at(self._frames, before)
        self._frames.went_to(self._now, row)
        self._answer, self.status = None, self._plain
        np.dot(self._own, self._turn, out=self._points)
        self._points += self._shift
        np.subtract(self._point_b, self._point_a, out=self._away)
        length = math.sqrt(self._away.dot(self._away))
        if length > 0.0:
            self._away /= length
        distance: float = row.item(T.DISTANCE)
        self.distance = distance
        self.lower_bound = row.item(T.BOUND) - self._slack
        self.upper_bound = distance + self._slack
        return distance

    def _run(self, front: KeptFront | None = None) -> Run:
        """The poses as a run of one frame."""
        before: Any = self._answer  # which such a run is not asked for
        state = SolidState(before, self._pair, front, self._born)
        return Run(self.asks, state, self._a.copy(), self._b.copy())

    def _anew(self) -> float:
        """A frame after one that nothing is kept of."""
        state, answer = self._run(self._front).single()
        self._load(state.front, state.born)
        return self._tell(answer)

    def _in_contact(self, frames: ContactFrames) -> float:
        """A frame after one in which the solids overlapped."""
        follow_contact(*self._call)
        told = frames.told
        if told.item(FIRST) < 0.0:
            front = frames.kept()._replace(contact=None)
            self._born = front.born
            state, answer = self._run(front).parted(self._now[0])
            self._load(state.front, state.born)
            return self._tell(answer)
        self._answer, self.status = None, Status.OVERLAPPING
        np.dot(self._pressed_at, self._turn, out=self._points)
        self._points += self._shift
        np.dot(self._pressed_along, self._turn, out=self._away)
        upper = -told.item(DEPTH)
        distance: float = min(upper, told.item(DISTANCE))
        way = self._turn.T @ told[PARTING : PARTING + 3]
        self.distance, self.lower_bound = distance, -float(np.linalg.norm(way)) - self._slack
        self.upper_bound = upper + self._slack
        return distance

    def _looked_at(self, frames: FrontFrames, before: Array) -> float:
        """A frame that the kernel does not tell alone, after one with B at a pose in A's frame."""
        run = self._run()
        answer, front = run.taken_up(frames, self._told, self._inside, before)
        if front is not frames:
            assert not isinstance(front, FrontFrames)
            self._load(front, run.born)
        return self._tell(answer)

    def _load(self, front: KeptFront | None, born: int) -> None:
        """Go on from a front; without one the next frame is a step."""
        self._front, self._born, self._frames, self._contact = front, born, None, None
        if front is None:
            return
        if front.contact is not None:
            self._contact = self.asks.contact(front, self._room_of_contact)
            self._call = self._contact.call(self._now[0])
            return
        self._frames, self._inside = self.asks.frames(front, self._room), front.inside
        self._plain = status_of(front.inside)
        self._call = self._frames.call(self._now, self._told)

    def _tell(self, answer: SolidProximity) -> float:
        self._answer, self.status = answer, answer.status
        self.lower_bound, self.upper_bound = answer.lower_bound, answer.upper_bound
        self._points[0], self._points[1] = answer.point_a, answer.point_b
        self._away[:] = answer.normal
        self.distance = answer.distance
        return answer.distance


def _flat(pose: PoseLike) -> tuple[Array, int]:
    flat, repaired = flat_and_mark(pose)
    return flat, int(repaired)
