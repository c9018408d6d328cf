"""A start or a frame on a long block, with poses mended that are only rounded."""

from __future__ import annotations

from typing import Any

from standoff.kernels.entries import tracker as kernels
from standoff.kernels.state import arrays as K
from standoff.tracking.address_table import AddressTable
from standoff.tracking.block import Block
from standoff.tracking.inputs import mend, motion_of

Given = tuple[Any, Any, Any, Any]
"""Poses and twists of both bodies, in any form."""


def started(table: AddressTable, given: Given, data: Any, how: int) -> tuple[Block, int]:
    """A start from the places in a state's data: its block, and how many poses were repaired.

    Raises
    ------
    StandoffError
        No pose or twist, or a planar pair out of its plane.
    """
    motion, has_twist, repaired = motion_of(*given)
    block = Block.empty(data, motion, 0.0, has_twist)
    while (done := kernels.start_anywhere(table.address, block.data, how)) != K.FINE:
        repaired += mend(done, block.motion)
    return block, repaired


def stepped(table: AddressTable, given: Given, data: Any, h: float) -> tuple[Block, int]:
    """A frame from a state's data (its warm start), as `started`."""
    motion, has_twist, repaired = motion_of(*given)
    block = Block.empty(data, motion, h, has_twist)
    return block, repaired + step_in(table, block)


def step_in(table: AddressTable, block: Block) -> int:
    """A frame in a long block; how many of its poses were repaired in it."""
    repaired = 0
    while (done := kernels.step(table.address, block.data)) != K.FINE:
        repaired += mend(done, block.motion)
    return repaired
