"""The block of memory that holds a frame: what was given, and what came of it, by name.

The kernels write it; ``standoff.kernels.state.arrays`` says where each part stands.
"""

from __future__ import annotations

import numpy as np

from standoff.kernels.pair import events as N
from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.kernels.state import arrays as K
from standoff.typing import Array


def with_polytope(data: Array, polytope: Array) -> Array:
    """A copy of a block: the answer and its switches, followed by the polytope, if any."""
    some = bool(len(polytope)) and polytope[0] > 0.0
    block = np.concatenate([data, polytope]) if some else data.copy()
    block[K.BLOCK_POLYTOPE] = len(data) if some else 0.0
    return block


class FrameBlock:
    """One frame's block of memory by name, views of it: what was given, and the result.

    Attributes
    ----------
    out : (40,) array
        The answer.
    state : (56,) array
        The state after it.
    motion : (36,) array
        Poses and twists.
    events : (...,) array
        The switches, flat.
    polytope : (510,) array
        What a frame in penetration keeps for the next one; (0,) where it has no place.
    """

    __slots__ = ("data",)

    def __init__(self, data: Array) -> None:
        self.data = data

    @classmethod
    def empty(
        cls, state: Array, motion: Array, h: float = 0.0, has_twist: bool = False
    ) -> FrameBlock:
        """A long block before its frame; the state is copied, a polytope behind it as well."""
        block = cls(np.empty(K.N_LONG_BLOCK))
        block.data[: K.N_OUT] = np.nan
        block.data[K.BLOCK_POLYTOPE] = K.FIRST_POLYTOPE
        block.state[:], block.motion[:] = state[: K.N_STATE], motion
        block.polytope[:] = state[K.N_STATE :] if len(state) > K.N_STATE else 0.0
        block.data[K.BLOCK_TIME_STEP], block.data[K.BLOCK_HAS_TWIST] = h, has_twist
        return block

    @property
    def out(self) -> Array:
        return self.data[: K.N_OUT]

    @property
    def state(self) -> Array:
        return self.data[K.BLOCK_STATE : K.BLOCK_MOTION]

    @property
    def motion(self) -> Array:
        return self.data[K.BLOCK_MOTION : K.BLOCK_TIME_STEP]

    @property
    def events(self) -> Array:
        end = int(self.data[K.BLOCK_POLYTOPE]) or len(self.data)
        return self.data[K.BLOCK_EVENTS : end]

    @property
    def polytope(self) -> Array:
        first = int(self.data[K.BLOCK_POLYTOPE])
        return self.data[first : first + N_POLYTOPE] if first else self.data[:0]

    @property
    def warm_start(self) -> Array:
        """A copy of the state, followed by a polytope if one has been kept."""
        polytope = self.polytope
        if not (len(polytope) and polytope[0]):
            return self.state.copy()
        return np.concatenate([self.state, polytope])

    def kept(self) -> Array:
        """A copy as short as its switches and its polytope allow, for an answer to keep."""
        count = max(K.KEPT_EVENTS, int(self.data[K.OUT_COUNTS + N.EVENTS]))
        end = K.BLOCK_EVENTS + N.EVENT_COLUMNS * count
        return with_polytope(self.data[:end], self.polytope)
