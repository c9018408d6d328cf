"""The kernels' starts and steps with named arguments."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.packing import Ints
from standoff.kernels.entries import blocks
from standoff.kernels.entries import tracker as kernels
from standoff.kernels.state import arrays as K
from standoff.kernels.state.options import names_paper_law
from standoff.tracking.address_table import AddressTable
from standoff.tracking.block import Block
from standoff.tracking.rows import NO_TWIST, AnswerRows, StateRow, motion_row

Array = NDArray[np.float64]
Pair = tuple[Ints, Array, Ints, Array]


def packed(a: Body, b: Body) -> Pair:
    """What the kernels read of two bodies."""
    return a.ints, a.reals, b.ints, b.reals


class Frame(NamedTuple):
    """What is given of one frame: poses (12,) and twists (6,) in world axes."""

    pose_a: Array
    pose_b: Array
    twist_a: Array = NO_TWIST
    twist_b: Array = NO_TWIST
    has_twist: bool = False

    @property
    def row(self) -> Array:
        """All four as the kernels read them."""
        return motion_row(*self[:4])


ANYWHERE, DESCEND, HERE = K.START_ANYWHERE, K.START_DESCEND, K.START_HERE
"""How a start begins: with a global query, by descent from the state's places, or just there."""


def start_anywhere(pair: Pair, frame: Frame, options: Array, state: StateRow) -> AnswerRows:
    """Find the witness points globally: the answer, and the state in place.

    Nothing is compiled for contact while the bodies are apart.
    """
    answer = AnswerRows.empty()
    motion, has_twist = frame.row, frame.has_twist
    kernels.start_anywhere(pair, motion, has_twist, options, state.data, ANYWHERE, answer.data)
    return answer


def start(
    pair: Pair, frame: Frame, options: Array, state: StateRow, given: int = ANYWHERE
) -> tuple[AnswerRows, bool]:
    """Begin as `given` says: the answer, and is it one? The state is changed in place."""
    answer = AnswerRows.empty()
    motion, has_twist = frame.row, frame.has_twist
    bad = kernels.start(pair, motion, has_twist, options, state.data, given, answer.data)
    return answer, bad == K.FINE


def step(
    pair: Pair, frame: Frame, h: float, options: Array, state: StateRow
) -> tuple[AnswerRows, bool]:
    """One frame of the law that the options name, h seconds after the last: as `start`."""
    block = Block.empty(state.data, frame.row, h, frame.has_twist)
    table = AddressTable((*pair, options))
    in_place = blocks.step_paper if names_paper_law(options) else blocks.step_predicted
    bad = in_place(table.address, block.data)
    state.data[:] = block.state
    return AnswerRows(block.out), bad == K.FINE
