"""The input of a frame, and the motion of B relative to A that follows from it."""

from __future__ import annotations

from typing import Any, NamedTuple

from standoff.kernels.algebra.rigid import mean_motion, relative_pose, relative_twist
from standoff.kernels.body.layout import DIMENSION
from standoff.kernels.compiler.decorators import ahead, kernel
from standoff.kernels.state.arrays import POSE_A, POSE_B, TWIST_A, TWIST_B, refusal
from standoff.kernels.values import Motion

# The change of the parameters over a frame, if they were integrated with the bodies: all of it, and
# that of the first stage alone.
CHANGE, FIRST_CHANGE = 0, 4
N_CHANGE = 8


class Inputs(NamedTuple):
    """The input of a frame, in world axes, as pointers."""

    pose_a: Any  # R (9, row-major), p (3)
    pose_b: Any
    twist_a: Any  # 6 numbers
    twist_b: Any
    change: Any  # N_CHANGE numbers, for a law that is integrated with the bodies; otherwise unused
    has_twist: bool


@kernel
def twisted(inputs, pose):
    """The motion of B relative to A, from the given twists."""
    v, w = relative_twist(inputs.pose_a, inputs.pose_b, inputs.twist_a, inputs.twist_b)
    return Motion(pose, v, w)


@kernel
def moving(inputs, before, h):
    """The motion of B relative to A: from the twists or, without them, the mean motion since the
    last frame."""
    pose = relative_pose(inputs.pose_a, inputs.pose_b)
    if inputs.has_twist:
        return twisted(inputs, pose)
    return mean_motion(before.motion.pose, pose, h)


@kernel
def inputs_at(motion, has_twist):
    """The poses and twists of a frame, in an array that begins with the first of them."""
    return Inputs(
        ahead(motion, POSE_A),
        ahead(motion, POSE_B),
        ahead(motion, TWIST_A),
        ahead(motion, TWIST_B),
        motion,  # unused: nothing was integrated
        has_twist,
    )


@kernel
def refused(pair, inputs):
    """FINE, or which of a frame's poses and twists is rejected."""
    planar = pair.ints_a[DIMENSION] == 2 or pair.ints_b[DIMENSION] == 2
    return refusal(planar, inputs.pose_a, inputs.pose_b, inputs.twist_a, inputs.twist_b)


@kernel
def with_change(inputs, change):
    """The same, with the change of the parameters by the bodies' integrator."""
    return Inputs(
        inputs.pose_a, inputs.pose_b, inputs.twist_a, inputs.twist_b, change, inputs.has_twist
    )
