"""One frame's arrays, reused, for loops that must not allocate."""

from __future__ import annotations

from operator import attrgetter
from typing import Any

import numpy as np

from standoff.errors import StandoffError
from standoff.kernels.compiler.entry import WrongKind
from standoff.kernels.entries.preparing import prepare_buffer
from standoff.kernels.entries.tracker import moved
from standoff.kernels.state import arrays as K
from standoff.tracking.block import FrameBlock
from standoff.tracking.inputs import motion_of, plain
from standoff.tracking.mended_calls import Given, step_in
from standoff.tracking.proximity import Proximity
from standoff.tracking.reached import Reached
from standoff.tracking.rows import AnswerRows, motion_row, poses_of, twists_of
from standoff.tracking.state import TrackerState
from standoff.tracking.status import BY_NUMBER, Status
from standoff.typing import Array


class FrameBuffer:
    """Arrays of one frame, reused: write into the poses (12 numbers: R row-major, p) and twists.

    The arrays are written into, not replaced: the kernels read them by address. ``normal``,
    ``point_a`` and ``point_b`` are views of the answer, made once: each frame changes them, so copy
    what must outlive it.

    Parameters
    ----------
    reached : Reached
        Of the tracker whose ``step_into`` will be called.
    state : TrackerState
        Where it begins; copied.

    Attributes
    ----------
    repaired : int
        How many of the last frame's two poses were rounded, and replaced by the nearest rotation.
    """

    def __init__(self, reached: Reached, state: TrackerState) -> None:
        prepare_buffer()
        self.reached = reached
        self.has_twist = True
        self.repaired = 0
        block = FrameBlock.empty(state.warm_start, motion_row(*np.zeros((2, 12))))
        block.events[:] = 0.0
        for pose in poses_of(block.motion):
            pose[[0, 4, 8]] = 1.0
        self._take(block.data)

    def _take(self, block: Array) -> None:
        self._block = block
        # what a frame of given poses is called with, in one look
        self._call = self.reached.address, block
        named = FrameBlock(block)
        self._motion, self._state, self._out = named.motion, named.state, named.out
        self._pose_a, self._pose_b = poses_of(self._motion)
        self._twist_a, self._twist_b = twists_of(self._motion)
        answer = AnswerRows(self._out)
        self._normal, self._point_a, self._point_b = answer.normal, answer.point_a, answer.point_b
        for view in (self._normal, self._point_a, self._point_b):
            view.flags.writeable = False

    def __getstate__(self) -> dict[str, Any]:
        # views of one block, which copies of each would not be
        kept = ("reached", "has_twist", "repaired", "_block")
        return {name: getattr(self, name) for name in kept}

    def __setstate__(self, stored: dict[str, Any]) -> None:
        prepare_buffer()
        self.__dict__.update(stored)
        self._take(self._block)

    pose_a = property(lambda self: self._pose_a, doc="(12,) pose of A.")
    pose_b = property(lambda self: self._pose_b, doc="(12,) pose of B.")
    twist_a = property(lambda self: self._twist_a, doc="(6,) twist of A, (v, omega) in world.")
    twist_b = property(lambda self: self._twist_b, doc="(6,) twist of B, (v, omega) in world.")
    motion = property(lambda self: self._motion, doc="(36,) all four, one after the other.")
    state = property(lambda self: self._state, doc="The warm start, changed in place.")
    out = property(lambda self: self._out, doc="The answer, as kernels.state.arrays lays it out.")
    events = property(lambda self: FrameBlock(self._block).events, doc="The log of switches, flat.")
    distance = property(lambda self: self._block.item(K.DISTANCE), doc="Signed, as in Proximity.")
    lower_bound = property(
        lambda self: self._block.item(K.LOWER_BOUND), doc="Certified lower bound of the distance."
    )
    upper_bound = property(
        lambda self: self._block.item(K.UPPER_BOUND), doc="Upper bound of the distance."
    )
    normal = property(attrgetter("_normal"), doc="(3,) unit vector from A to B, read-only.")
    point_a = property(attrgetter("_point_a"), doc="(3,) witness point on A, read-only.")
    point_b = property(attrgetter("_point_b"), doc="(3,) witness point on B, read-only.")

    @property
    def status(self) -> Status:
        """How the last frame ended."""
        number = self._block.item(K.STATUS)
        if number != number:
            raise StandoffError("The buffer has no answer yet: call tracker.step_into first.")
        return BY_NUMBER[int(number)]

    @property
    def certified(self) -> bool:
        """Is the distance proven?"""
        return self.status.certified

    def proximity(self) -> Proximity:
        """The last answer as a value."""
        return Proximity(
            self.reached.a, self.reached.b, FrameBlock(self._block).kept(), self.repaired
        )

    def step(self, h: float) -> float:
        """The distance of a frame with the poses and twists in the buffer, h seconds after the
        last."""
        data = self._block
        data[K.BLOCK_TIME_STEP], data[K.BLOCK_HAS_TWIST] = h, self.has_twist
        self.repaired = step_in(self.reached.table, FrameBlock(data))
        return data.item(K.DISTANCE)

    def step_to(self, given: Given, h: float) -> float:
        """The distance of a frame of given poses and twists, in any form."""
        numbers, repaired = plain(*given)
        table, block = self._call
        try:
            distance: float = moved(table, *numbers, h, block)
        except WrongKind:
            return self.step_anew(given, h)
        self.repaired = repaired
        return distance if distance == distance else self.mended(given, h)

    def mended(self, given: Given, h: float) -> float:
        """The distance of a frame that was refused at first."""
        done = self._block[K.BLOCK_DONE]
        if done == K.BAD_ARRAYS:
            return self.step_anew(given, h)
        if done != K.FINE:
            self.repaired += step_in(self.reached.table, FrameBlock(self._block))
        return self._block.item(K.DISTANCE)

    def step_anew(self, given: Given, h: float) -> float:
        """A frame of what the compiled one does not read: says what is wrong with it, or repairs
        it."""
        self._motion[:], self.has_twist, repaired = motion_of(*given)
        distance = self.step(h)
        self.repaired += repaired
        return distance
