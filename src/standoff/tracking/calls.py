"""The compiled starts and frames with named arguments, for whoever has flat arrays at hand."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from standoff.kernels.entries import tracker as kernels
from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.kernels.state import arrays as K
from standoff.tracking.block import FrameBlock
from standoff.tracking.inputs import ABSENT
from standoff.tracking.reached import AddressTable
from standoff.tracking.rows import NO_TWIST, AnswerRows, StateRow, motion_row, poses_of, twists_of
from standoff.typing import Array


class FrameInput(NamedTuple):
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


def start(
    table: AddressTable, frame: FrameInput, state: StateRow, given: int = ANYWHERE
) -> tuple[AnswerRows, bool]:
    """Begin as `given` says: the answer, and whether it is one. The state is changed in place."""
    block = FrameBlock.empty(state.data, frame.row, 0.0, frame.has_twist)
    done = kernels.start_anywhere(table.address, block.data, given)
    state.data[:] = block.state
    return AnswerRows(block.out), done == K.FINE


def step(
    table: AddressTable, frame: FrameInput, h: float, state: StateRow
) -> tuple[AnswerRows, bool]:
    """One frame, h seconds after the last: as `start`."""
    block = FrameBlock.empty(state.data, frame.row, h, frame.has_twist)
    done = kernels.step(table.address, block.data)
    state.data[:] = block.state
    return AnswerRows(block.out), done == K.FINE


class FrameSequence(NamedTuple):
    """Many frames.

    Attributes
    ----------
    rows : (n, N_OUT) array
        The answers; nan from a refused frame on.
    refused : int
        The frame that was refused; -1 if none was.
    """

    rows: Array
    refused: int


def run(
    table: AddressTable, motions: Array, has_twist: bool, steps: Array, state: Array
) -> FrameSequence:
    """Many frames in one compiled loop from a state, which is changed in place.

    Parameters
    ----------
    motions : (n, N_MOTION) array
        Poses and twists, one row per frame.
    steps : (n,) array
        Time since the frame before, s.
    state : (N_STATE,) array
    """
    n = len(motions)
    blocks, polytopes = np.full((n + 1, K.N_BLOCK), np.nan), np.zeros((2, N_POLYTOPE))
    blocks[0, K.BLOCK_STATE : K.BLOCK_MOTION] = state
    given = [matrices(poses) for poses in poses_of(motions)]
    absent = np.tile(ABSENT, (n, 1))
    given += [np.ascontiguousarray(x) if has_twist else absent for x in twists_of(motions)]
    at = 0
    while at < n:
        at, done = kernels.values(table.address, *given, steps, at, (blocks, polytopes))
        if done == K.MORE_EVENTS:
            last = blocks[at, K.BLOCK_STATE : K.BLOCK_MOTION]
            block = FrameBlock.empty(last, motions[at], float(steps[at]), has_twist)
            done = kernels.step(table.address, block.data)
            blocks[at + 1] = block.data[: K.N_BLOCK]
            polytopes[(at + 1) % 2] = block.polytope
        if done != K.FINE:
            blocks[at + 1 :, : K.N_OUT] = np.nan
            break
        at += 1
    refused = at if at < n else -1
    state[:] = blocks[min(at, n), K.BLOCK_STATE : K.BLOCK_MOTION]
    return FrameSequence(blocks[1:, : K.N_OUT], refused)


def matrices(flats: Array) -> Array:
    """Poses (n, 4, 4) of flat ones (n, 12)."""
    found = np.zeros((len(flats), 4, 4))
    found[:, :3, :3], found[:, :3, 3] = flats[:, :9].reshape(-1, 3, 3), flats[:, 9:]
    found[:, 3, 3] = 1.0
    return found
