"""What a tracker carries from frame to frame, as a value."""

from __future__ import annotations

import numpy as np

from standoff.read_only import KeepsReadOnly
from standoff.tracking.block import FrameBlock
from standoff.tracking.proximity import Proximity
from standoff.tracking.rows import StateRow
from standoff.typing import Array


class TrackerState(KeepsReadOnly):
    """The warm start, as a value: goes into a step and comes out of it, never changed.

    Parameters
    ----------
    proximity : Proximity
        Of a tracker: the block of memory that it reads has the state in it.

    Attributes
    ----------
    data : (56,) array
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
        return FrameBlock(self._proximity._out).state

    @property
    def warm_start(self) -> Array:
        """``data``, followed by what a frame in penetration has kept of its proof: a polytope that
        the next frame moves with the bodies and tries first; then (566,)."""
        return FrameBlock(self._proximity._out).warm_start

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
