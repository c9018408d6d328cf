"""A start or a frame on a long block, with repair of poses that are only rounded."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.bodies.body import Body
from standoff.kernels.compiler.entry import WrongKind
from standoff.kernels.entries import tracker as kernels
from standoff.kernels.entries.tracker import query_anywhere
from standoff.kernels.state import arrays as K
from standoff.tracking.block import FrameBlock
from standoff.tracking.inputs import mend, motion_of, plain
from standoff.tracking.proximity import Proximity
from standoff.tracking.reached import AddressTable
from standoff.tracking.rows import StateRow

Given = tuple[Any, Any, Any, Any]
"""Poses and twists of both bodies, in any form."""


def found_anywhere(bodies: tuple[Body, Body], table: AddressTable, given: Given) -> Proximity:
    """The answer of a global query.

    Raises StandoffError: no pose or twist, or a planar pair out of its plane.
    """
    numbers, repaired = plain(*given)
    block = np.empty(K.N_BLOCK)
    try:
        done = query_anywhere(table.address, *numbers, block)
    except WrongKind:
        done = K.BAD_ARRAYS
    if done != K.FINE:
        made, repaired = started(table, given, StateRow().data, K.START_ANYWHERE)
        block = made.kept()
    return Proximity(*bodies, block, repaired)


def started(table: AddressTable, given: Given, data: Any, how: int) -> tuple[FrameBlock, int]:
    """A start from the places in a state's data: its block, and how many poses were repaired.

    Raises StandoffError: no pose or twist, or a planar pair out of its plane.
    """
    motion, has_twist, repaired = motion_of(*given)
    block = FrameBlock.empty(data, motion, 0.0, has_twist)
    while (done := kernels.start_anywhere(table.address, block.data, how)) != K.FINE:
        repaired += mend(done, block.motion)
    return block, repaired


def stepped(table: AddressTable, given: Given, data: Any, h: float) -> tuple[FrameBlock, int]:
    """A frame from a state's data (its warm start), as `started`."""
    motion, has_twist, repaired = motion_of(*given)
    block = FrameBlock.empty(data, motion, h, has_twist)
    return block, repaired + step_in(table, block)


def step_in(table: AddressTable, block: FrameBlock) -> int:
    """A frame in a long block; how many of its poses were repaired in it."""
    repaired = 0
    while (done := kernels.step(table.address, block.data)) != K.FINE:
        repaired += mend(done, block.motion)
    return repaired
