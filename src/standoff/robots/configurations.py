"""Configurations that a user gives: their size, numbers and unit parts."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.checks.arrays import finite
from standoff.checks.real_numbers import shape_of
from standoff.errors import StandoffError
from standoff.robots.joints import JointKind, Joints
from standoff.robots.tolerances import UNIT_LENGTH
from standoff.typing import Array

UNIT_PARTS = {
    JointKind.BALL: (0, 4, "quaternion"),
    JointKind.FREE: (3, 7, "quaternion"),
    JointKind.CONTINUOUS: (0, 2, "(cos, sin)"),
}
"""Where a joint's numbers of length 1 begin and end, and what they are."""


class Configurations:
    """Checks configurations of a robot.

    Parameters
    ----------
    joints : Joints
    nq : int
    neutral : str
        How its package makes a configuration, for messages.
    """

    def __init__(self, joints: Joints, nq: int, neutral: str) -> None:
        self.nq, self._neutral = nq, neutral
        self._units: list[tuple[slice, str, str]] = []
        for name, kind, at in zip(joints.names, joints.kinds, joints.q_at, strict=True):
            if JointKind(kind) in UNIT_PARTS:
                first, end, what = UNIT_PARTS[JointKind(kind)]
                self._units.append((slice(int(at) + first, int(at) + end), what, name))

    def __call__(self, q: Any) -> Array:
        """A configuration (nq,), with unit parts of length 1.

        Raises StandoffError.
        """
        shape = shape_of(q)
        if shape is not None and shape != (self.nq,):
            raise StandoffError(
                f"q has the shape {shape}, but the robot's configurations have nq = {self.nq} "
                f"numbers: begin with {self._neutral}.",
                "q",
                q,
            )
        read = finite(q, "q", (self.nq,))
        if not self._units:
            return read
        made = read.copy()
        for part, what, name in self._units:
            length = float(np.linalg.norm(read[part]))
            if not abs(length - 1.0) <= UNIT_LENGTH:
                raise StandoffError(
                    f"q[{part.start}:{part.stop}] = {read[part]}, the {what} of joint {name!r}, "
                    f"has the length {length:.6g}: give one of length 1, or begin with "
                    f"{self._neutral}.",
                    "q",
                    q,
                )
            made[part] /= length
        made.flags.writeable = False
        return made


def made_unit(joints: Joints, q: Array) -> Array:
    """The configuration with quaternions, and (cos, sin), scaled to length 1, however long; a part
    that is zero stays so."""
    found = np.array(q, dtype=float)
    for kind, at in zip(joints.kinds, joints.q_at, strict=True):
        if JointKind(kind) in UNIT_PARTS:
            first, end, _ = UNIT_PARTS[JointKind(kind)]
            part = slice(int(at) + first, int(at) + end)
            found[part] /= float(np.linalg.norm(found[part])) or 1.0
    return found
