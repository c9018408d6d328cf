"""A device's encoders: whole counts of position and angle, and velocities from them."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
import scipy

from standoff.checks.numbers import not_negative
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffTypeError
from standoff.motion.pose import Pose
from standoff.motion.twist import Twist
from standoff.simulation.six_axes import rotation_error


@dataclass(frozen=True, kw_only=True)
class Encoder:
    """How a simulated device measures.

    Raises StandoffError: a number that is not finite, or below zero; `velocities` that is neither
    True nor False.

    Parameters
    ----------
    position_step : float
        One count of position along each axis [length]; 0 measures exactly.
    angle_step : float
        One count of each component of the rotation vector since the device's home [rad].
    velocities : bool
        Whether readings have a twist, by differences of what was measured; otherwise None.
    velocity_time_constant : float
        Of the first-order filter (backward Euler) behind the differences [s].
    """

    position_step: float = 0.0
    angle_step: float = 0.0
    velocities: bool = True
    velocity_time_constant: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            if field.name != "velocities":
                value = not_negative(getattr(self, field.name), field.name)
                object.__setattr__(self, field.name, value)
        if not isinstance(self.velocities, bool):
            raise StandoffTypeError(
                f"velocities is {shown(self.velocities)}: give True or False",
                "velocities",
                self.velocities,
            )

    def measured(self, pose: Pose, home: Pose) -> Pose:
        """Return a pose in whole counts since `home`."""
        if self.position_step == 0.0 and self.angle_step == 0.0:
            return pose
        position, rotation = pose.translation, pose.rotation
        if self.position_step > 0.0:
            counts = np.round((position - home.translation) / self.position_step)
            position = home.translation + counts * self.position_step
        if self.angle_step > 0.0:
            since = scipy.spatial.transform.Rotation.from_matrix(home.rotation.T @ rotation)
            counts = np.round(since.as_rotvec() / self.angle_step)
            counted = scipy.spatial.transform.Rotation.from_rotvec(counts * self.angle_step)
            rotation = home.rotation @ counted.as_matrix()
        return Pose.from_checked(np.array(rotation), np.array(position))

    def velocity(self, pose: Pose, before: Pose, last: Twist, period: float) -> Twist:
        """Return the twist, world axes, by the way from `before` to `pose`, filtered."""
        rotations = (tuple(one.rotation.ravel().tolist()) for one in (pose, before))
        turn = np.array(rotation_error(*rotations))
        share = period / (period + self.velocity_time_constant)
        v = (pose.translation - before.translation) / period
        v, omega = last.v + share * (v - last.v), last.omega + share * (turn / period - last.omega)
        return Twist.from_checked(v, omega)
