"""A pair of bodies as the compiled frames reach it, and what they refuse or leave open."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.kernels.compiler.entry import WrongKind
from standoff.kernels.entries import blocks
from standoff.kernels.entries.preparing import prepare
from standoff.kernels.state import arrays as K
from standoff.motion import PoseLike, TwistLike
from standoff.read_only import KeepsReadOnly, locked
from standoff.tracking.address_table import AddressTable
from standoff.tracking.block import Block
from standoff.tracking.inputs import (
    check_in_plane,
    flat_and_mark,
    flat_twist,
    plain,
    refuse_twists,
    repair,
)
from standoff.tracking.law_options import Law
from standoff.tracking.laws import PaperLaw
from standoff.tracking.options import with_smooth_frame
from standoff.tracking.proximity import Proximity
from standoff.tracking.rows import motion_row, poses_of, twists_of
from standoff.tracking.specialised import smooth_address
from standoff.tracking.state import FrameBuffer, TrackerState

Array = NDArray[np.float64]

Given = tuple[Any, Any, Any, Any]
"""Poses and twists of both bodies, in any form."""


class ReachedPair(KeepsReadOnly):
    """Two bodies, a law and its options by address, for single frames.

    Attributes
    ----------
    packed : tuple of arrays
        What the kernels read of both bodies.
    table : AddressTable
        Where these and the options lie.
    value, in_place, moved, values
        The law's compiled frames: from block to block, on one long block, on one whose poses are
        given, and many in a row.
    """

    a: Body
    b: Body
    law: Law
    options: Array
    planar: bool
    specialise: bool | None

    def _reach(self) -> None:
        """What the kernels read of both bodies, and the entries of the law."""
        self.packed = self.a.ints, self.a.reals, self.b.ints, self.b.reals
        paper = isinstance(self.law, PaperLaw)
        smooth = 0 if paper else smooth_address(self.a, self.b, self.specialise)
        self.options = with_smooth_frame(self.options, smooth)
        self.table = AddressTable((*self.packed, self.options))
        self.value = blocks.value_paper if paper else blocks.value_predicted
        self.in_place = blocks.step_paper if paper else blocks.step_predicted
        self.moved = blocks.moved_paper if paper else blocks.moved_predicted
        self.values = blocks.values_paper if paper else blocks.values_predicted

    def _prepare(self) -> None:
        """Load, or compile, what the frames can reach: none of them waits for it."""
        prepare(paper=isinstance(self.law, PaperLaw), planar=self.planar)

    def __getstate__(self) -> Any:
        # in another process the bodies' formulas, and all arrays, have other addresses
        reached = ("packed", "table", "value", "in_place", "moved", "values")
        state = {name: x for name, x in self.__dict__.items() if name not in reached}
        return state, list(locked(state))

    def __setstate__(self, stored: Any) -> None:
        super().__setstate__(stored)
        self._reach()
        self._prepare()

    def _repair(self, why: int, motion: Array) -> int:
        """Repair what the kernel has refused, in place, if it is a rounded pose: 1 of them.

        Raises
        ------
        ValueError
            It is something worse.
        """
        if why == K.BAD_TWIST:
            refuse_twists(*twists_of(motion))
        first = why == K.BAD_POSE_A
        flat_a, flat_b = poses_of(motion)
        repair(flat_a if first else flat_b, "pose_a" if first else "pose_b")
        return 1

    def _motion(
        self,
        pose_a: PoseLike,
        pose_b: PoseLike,
        twist_a: TwistLike | None,
        twist_b: TwistLike | None,
    ) -> tuple[Array, bool, int]:
        """The poses and twists as the kernels read them; are there twists; poses repaired."""
        (flat_a, mark_a), (flat_b, mark_b) = flat_and_mark(pose_a), flat_and_mark(pose_b)
        xi_a, xi_b = flat_twist(twist_a, pose_a), flat_twist(twist_b, pose_b)
        has_twist = twist_a is not None or twist_b is not None
        if self.planar:
            check_in_plane(flat_a, flat_b)
        return motion_row(flat_a, flat_b, xi_a, xi_b), has_twist, mark_a + mark_b

    def _step_in(self, block: Block) -> int:
        """One frame in a long block; returns how many poses were repaired in it."""
        repaired = 0
        while (done := self.in_place(self.table.address, block.data)) != K.FINE:
            repaired += self._repair(done, block.motion)
        return repaired

    def _put_in(self, buffer: FrameBuffer, given: Given, h: float) -> float:
        """A frame in place, of poses and twists in any form, or of those in the buffer."""
        pose_a, pose_b = given[:2]
        if pose_a is None and pose_b is None:
            return self._in_place(buffer, h)
        if self.planar:
            return self._put_anew(buffer, given, h)
        numbers, repaired = plain(*given)
        moved, table, block = buffer._call
        try:
            distance: float = moved(table, *numbers, h, block)
        except WrongKind:
            return self._put_anew(buffer, given, h)
        buffer.repaired = repaired
        return distance if distance == distance else self._mended(buffer, given, h)

    def _put_anew(self, buffer: FrameBuffer, given: Given, h: float) -> float:
        """A frame in place of what the compiled one does not read: says what is wrong with it, or
        mends it."""
        motion, buffer.has_twist, repaired = self._motion(*given)
        buffer.motion[:] = motion
        distance = self._in_place(buffer, h)
        buffer.repaired += repaired
        return distance

    def _in_place(self, buffer: FrameBuffer, h: float) -> float:
        """A frame of the poses that stand in the buffer."""
        data = buffer._block
        if self.planar:
            check_in_plane(buffer.pose_a, buffer.pose_b)
        data[K.BLOCK_TIME_STEP], data[K.BLOCK_HAS_TWIST] = h, buffer.has_twist
        buffer.repaired = 0
        done = self.in_place(self.table.address, data)
        if done != K.FINE:
            buffer.repaired = self._step_in(Block(data))
        return data.item(K.DISTANCE)

    def _mended(self, buffer: FrameBuffer, given: Given, h: float) -> float:
        """The distance of a frame in place that was refused at first."""
        data = buffer._block
        if data[K.BLOCK_DONE] == K.BAD_ARRAYS:
            return self._put_anew(buffer, given, h)
        if data[K.BLOCK_DONE] != K.FINE:
            buffer.repaired += self._step_in(Block(data))
        return data.item(K.DISTANCE)

    def _answered(self, block: Array, repaired: int) -> tuple[TrackerState, Proximity]:
        """State and answer of a block that is done."""
        answer = Proximity(self.a, self.b, block, repaired)
        return TrackerState(answer), answer
