"""What a tracker carries from frame to frame: a value, or arrays that are reused."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from standoff.kernels import events as N
from standoff.kernels import frame as K
from standoff.read_only import KeepsReadOnly
from standoff.tracking.proximity import Proximity

if TYPE_CHECKING:
    from standoff.tracking.tracker import Tracker

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TrackerState(KeepsReadOnly):
    """The warm start, as a value: goes into a step and comes out of it, never changed.

    Attributes
    ----------
    data : (55,) array
        Read-only, laid out in ``standoff.kernels.frame``.
    proximity : Proximity
        The answer at the frame of this state.
    """

    data: Array
    proximity: Proximity

    @property
    def time(self) -> float:
        """Time since ``start``, s."""
        return float(self.data[K.TIME])

    @property
    def errors(self) -> Array:
        """Psi as the paper's law integrates it (Fig. 3), (4,): u, v of A, r, s of B; 0 for those
        that do not exist. ``so.pair_system`` evaluates Eqs. (1)-(4)."""
        return self.data[K.ERRORS : K.ERRORS + 4].copy()

    @property
    def gain(self) -> float:
        """K at the last stage of the paper's law, 1/s; 0 before its first step."""
        return float(self.data[K.GAIN])

    @property
    def integral(self) -> Array:
        """Time integral of Psi since the last change of feature or chart, (4,)."""
        return self.data[K.INTEGRAL : K.INTEGRAL + 4].copy()


class FrameBuffer:
    """Arrays of one frame, reused: write into the poses (12 numbers: R row-major, p) and twists.

    The arrays are written into, not replaced: the kernels read them by address.

    Parameters
    ----------
    tracker : Tracker
        Whose ``step_into`` will be called.
    state : TrackerState
        Where it begins; copied.
    """

    def __init__(self, tracker: Tracker, state: TrackerState) -> None:
        self.tracker = tracker
        self.has_twist = True
        identity = np.zeros(12)
        identity[[0, 4, 8]] = 1.0
        self._pose_a, self._pose_b = identity, identity.copy()
        self._twist_a, self._twist_b = np.zeros(6), np.zeros(6)
        self._state = state.data.copy()
        self._out = np.full(K.N_OUT, np.nan)
        self._events = np.zeros(N.MAX_EVENTS * N.EVENT_COLUMNS)

    pose_a = property(lambda self: self._pose_a, doc="(12,) pose of A.")
    pose_b = property(lambda self: self._pose_b, doc="(12,) pose of B.")
    twist_a = property(lambda self: self._twist_a, doc="(6,) twist of A, (v, omega) in world.")
    twist_b = property(lambda self: self._twist_b, doc="(6,) twist of B, (v, omega) in world.")
    state = property(lambda self: self._state, doc="The warm start, changed in place.")
    out = property(lambda self: self._out, doc="The answer, as standoff.kernels.frame lays it out.")
    events = property(lambda self: self._events, doc="The log of switches, flat.")

    def proximity(self) -> Proximity:
        """The last answer as a value."""
        return self.tracker._answer(
            self.state.copy(), self.out.copy(), self.events, self.pose_a, self.pose_b
        )[1]
