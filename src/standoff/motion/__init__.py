"""Poses, twists, and paths in time."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.motion.bounds import Bounded, BoundedPath, MotionBounds
    from standoff.motion.paths import Carried, ConstantTwist, Fixed, Offset, Path, Screw
    from standoff.motion.pose import Pose, PoseLike
    from standoff.motion.pose_function import PoseFunction
    from standoff.motion.poses import Poses, PosesLike
    from standoff.motion.samples import PoseSamples
    from standoff.motion.samples_file import read_pose_samples
    from standoff.motion.twist import Frame, Twist, TwistLike
    from standoff.motion.winding import Helix, Orientation, Spiral
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = [
    "Bounded",
    "BoundedPath",
    "Carried",
    "ConstantTwist",
    "Fixed",
    "Frame",
    "Helix",
    "MotionBounds",
    "Offset",
    "Orientation",
    "Path",
    "Pose",
    "PoseFunction",
    "PoseLike",
    "PoseSamples",
    "Poses",
    "PosesLike",
    "Screw",
    "Spiral",
    "Twist",
    "TwistLike",
    "read_pose_samples",
]
