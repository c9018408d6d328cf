"""What a frame is given, and B's motion seen from A by it."""

from __future__ import annotations

from typing import Any, NamedTuple

from standoff.kernels.algebra.rigid import mean_motion, relative_pose, relative_twist
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.values import Motion


class Inputs(NamedTuple):
    """What a frame is given, in world axes, as pointers."""

    pose_a: Any  # R (9, row-major), p (3)
    pose_b: Any
    twist_a: Any  # 6 numbers
    twist_b: Any
    has_twist: bool


@kernel
def twisted(inputs, pose):
    """B's motion seen from A, by the twists given."""
    v, w = relative_twist(inputs.pose_a, inputs.pose_b, inputs.twist_a, inputs.twist_b)
    return Motion(pose, v, w)


@kernel
def moving(inputs, before, h):
    """B's motion seen from A: by the twists, or else that which has led here since the frame
    before."""
    pose = relative_pose(inputs.pose_a, inputs.pose_b)
    if inputs.has_twist:
        return twisted(inputs, pose)
    return mean_motion(before.motion.pose, pose, h)
