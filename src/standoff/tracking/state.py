"""What a tracker carries from frame to frame: a value, or arrays that are reused."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.pair import events as N
from standoff.read_only import KeepsReadOnly
from standoff.tracking.proximity import Proximity
from standoff.tracking.rows import AnswerRows, StateRow, motion_row, poses_of, twists_of

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TrackerState(KeepsReadOnly):
    """The warm start, as a value: goes into a step and comes out of it, never changed.

    Attributes
    ----------
    data : (55,) array
        Read-only, laid out in ``standoff.kernels.state.arrays``.
    proximity : Proximity
        The answer at the frame of this state.
    """

    data: Array
    proximity: Proximity

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

    def _answer(
        self, data: Array, out: Array, log: Array, motion: Array, repaired: int
    ) -> tuple[TrackerState, Proximity]: ...


class FrameBuffer:
    """Arrays of one frame, reused: write into the poses (12 numbers: R row-major, p) and twists.

    The arrays are written into, not replaced: the kernels read them by address.

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
        self._motion = motion_row(*np.zeros((2, 12)))
        for pose in poses_of(self._motion):
            pose[[0, 4, 8]] = 1.0
        self._pose_a, self._pose_b = poses_of(self._motion)
        self._twist_a, self._twist_b = twists_of(self._motion)
        self._state = state.data.copy()
        self._out = np.full(AnswerRows.size, np.nan)
        self._events = np.zeros(N.MAX_EVENTS * N.EVENT_COLUMNS)

    pose_a = property(lambda self: self._pose_a, doc="(12,) pose of A.")
    pose_b = property(lambda self: self._pose_b, doc="(12,) pose of B.")
    twist_a = property(lambda self: self._twist_a, doc="(6,) twist of A, (v, omega) in world.")
    twist_b = property(lambda self: self._twist_b, doc="(6,) twist of B, (v, omega) in world.")
    motion = property(lambda self: self._motion, doc="(36,) all four, one behind the other.")
    state = property(lambda self: self._state, doc="The warm start, changed in place.")
    out = property(lambda self: self._out, doc="The answer, as kernels.state.arrays lays it out.")
    events = property(lambda self: self._events, doc="The log of switches, flat.")

    def proximity(self) -> Proximity:
        """The last answer as a value."""
        return self.tracker._answer(
            self.state.copy(), self.out.copy(), self.events, self.motion.copy(), self.repaired
        )[1]
