"""What a tracker carries from frame to frame: a value, or arrays that are reused."""

from __future__ import annotations

from operator import attrgetter
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.errors import StandoffError
from standoff.kernels.state import arrays as K
from standoff.read_only import KeepsReadOnly
from standoff.tracking.block import Block
from standoff.tracking.proximity import Proximity
from standoff.tracking.rows import AnswerRows, StateRow, motion_row, poses_of, twists_of
from standoff.tracking.status import BY_NUMBER, Status

Array = NDArray[np.float64]


class TrackerState(KeepsReadOnly):
    """The warm start, as a value: goes into a step and comes out of it, never changed.

    Parameters
    ----------
    proximity : Proximity
        Of a tracker: the block of memory that it reads has the state in it.

    Attributes
    ----------
    data : (55,) array
        Read-only, laid out in ``standoff.kernels.state.arrays``.
    proximity : Proximity
        The answer at the frame of this state.
    """

    __slots__ = ("_proximity",)

    def __init__(self, proximity: Proximity) -> None:
        self._proximity = proximity

    @property
    def proximity(self) -> Proximity:
        return self._proximity

    @property
    def data(self) -> Array:
        return Block(self._proximity._out).state

    @property
    def warm_start(self) -> Array:
        """``data``, and behind it what a frame in penetration has kept of its proof: a polytope
        that the next frame moves with the bodies and asks first, (565,) then."""
        return Block(self._proximity._out).warm_start

    @property
    def time(self) -> float:
        """Time since ``start``, s."""
        return float(StateRow(self.data).time)

    @property
    def errors(self) -> Array:
        """Psi as the paper's law integrates it (Fig. 3), (4,): u, v of A, r, s of B; 0 for those
        that do not exist. ``so.tracking.pair_system`` evaluates Eqs. (1)-(4)."""
        return np.array(StateRow(self.data).errors)

    @property
    def gain(self) -> float:
        """K at the last stage of the paper's law, 1/s; 0 before its first step."""
        return float(StateRow(self.data).gain)

    @property
    def integral(self) -> Array:
        """Time integral of Psi since the last change of feature or chart, (4,)."""
        return np.array(StateRow(self.data).integral)


class Answering(Protocol):
    """A tracker, as its buffers see it."""

    a: Body
    b: Body
    moved: Any
    table: Any


class FrameBuffer:
    """Arrays of one frame, reused: write into the poses (12 numbers: R row-major, p) and twists.

    The arrays are written into, not replaced: the kernels read them by address. ``normal``,
    ``point_a`` and ``point_b`` are views of the answer, made once: each frame changes them, so copy
    what is to outlive it.

    Parameters
    ----------
    tracker : Tracker
        Whose ``step_into`` will be called.
    state : TrackerState
        Where it begins; copied.

    Attributes
    ----------
    repaired : int
        How many of the last frame's two poses were rounded, and brought to the nearest rotation.
    """

    def __init__(self, tracker: Answering, state: TrackerState) -> None:
        self.tracker = tracker
        self.has_twist = True
        self.repaired = 0
        block = Block.empty(state.warm_start, motion_row(*np.zeros((2, 12))))
        block.events[:] = 0.0
        for pose in poses_of(block.motion):
            pose[[0, 4, 8]] = 1.0
        self._take(block.data)

    def _take(self, block: Array) -> None:
        self._block = block
        # what a frame of given poses calls, in one look
        self._call = self.tracker.moved, self.tracker.table.address, block
        named = Block(block)
        self._motion, self._state, self._out = named.motion, named.state, named.out
        self._pose_a, self._pose_b = poses_of(self._motion)
        self._twist_a, self._twist_b = twists_of(self._motion)
        answer = AnswerRows(self._out)
        self._normal, self._point_a, self._point_b = answer.normal, answer.point_a, answer.point_b
        for view in (self._normal, self._point_a, self._point_b):
            view.flags.writeable = False

    def __getstate__(self) -> dict[str, Any]:
        # views of one block, which copies of each would not be
        kept = ("tracker", "has_twist", "repaired", "_block")
        return {name: getattr(self, name) for name in kept}

    def __setstate__(self, stored: dict[str, Any]) -> None:
        self.__dict__.update(stored)
        self._take(self._block)

    pose_a = property(lambda self: self._pose_a, doc="(12,) pose of A.")
    pose_b = property(lambda self: self._pose_b, doc="(12,) pose of B.")
    twist_a = property(lambda self: self._twist_a, doc="(6,) twist of A, (v, omega) in world.")
    twist_b = property(lambda self: self._twist_b, doc="(6,) twist of B, (v, omega) in world.")
    motion = property(lambda self: self._motion, doc="(36,) all four, one behind the other.")
    state = property(lambda self: self._state, doc="The warm start, changed in place.")
    out = property(lambda self: self._out, doc="The answer, as kernels.state.arrays lays it out.")
    events = property(lambda self: Block(self._block).events, doc="The log of switches, flat.")
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
        return Proximity(self.tracker.a, self.tracker.b, Block(self._block).kept(), self.repaired)
