"""What a frame is given, and B's motion seen from A by it."""

from __future__ import annotations

from typing import Any, NamedTuple

from standoff.kernels.algebra.rigid import mean_motion, relative_pose, relative_twist
from standoff.kernels.body.layout import DIMENSION
from standoff.kernels.compiler.decorators import ahead, kernel
from standoff.kernels.state.arrays import POSE_A, POSE_B, TWIST_A, TWIST_B, refusal
from standoff.kernels.values import Motion

# What the parameters change by over a frame, where the bodies' own method has integrated them: all
# of it, and what the first stage alone would give.
CHANGE, FIRST_CHANGE = 0, 4
N_CHANGE = 8


class Inputs(NamedTuple):
    """What a frame is given, in world axes, as pointers."""

    pose_a: Any  # R (9, row-major), p (3)
    pose_b: Any
    twist_a: Any  # 6 numbers
    twist_b: Any
    change: Any  # of a law that is integrated with the bodies: N_CHANGE numbers; else unused
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


@kernel
def inputs_at(motion, has_twist):
    """Where a frame's poses and twists stand, from the first of them on."""
    return Inputs(
        ahead(motion, POSE_A),
        ahead(motion, POSE_B),
        ahead(motion, TWIST_A),
        ahead(motion, TWIST_B),
        motion,  # of no meaning: nothing was integrated
        has_twist,
    )


@kernel
def refused(pair, inputs):
    """FINE, or what of a frame's poses and twists is refused."""
    planar = pair.ints_a[DIMENSION] == 2 or pair.ints_b[DIMENSION] == 2
    return refusal(planar, inputs.pose_a, inputs.pose_b, inputs.twist_a, inputs.twist_b)


@kernel
def with_change(inputs, change):
    """The same, with what the bodies' own method has changed the parameters by."""
    return Inputs(
        inputs.pose_a, inputs.pose_b, inputs.twist_a, inputs.twist_b, change, inputs.has_twist
    )
