"""Configurations outside the joints' limits."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.errors import StandoffError
from standoff.robots.certify_tolerances import LIMIT_SLACK
from standoff.robots.robot_model import RobotModel
from standoff.typing import Array


def check_limits(robot: RobotModel, q: Array, argument: str, times: Any = None) -> None:
    """Refuse configurations (m, nq) outside the robot's limits.

    Raises StandoffError: the first of them, with its joint, and its time if times (m,) are given.
    """
    lower, upper = robot.lower, robot.upper
    size = LIMIT_SLACK * np.maximum(1.0, np.abs(q))
    wrong = (q < lower - size) | (q > upper + size)
    if not wrong.any():
        return
    k, i = (int(x[0]) for x in np.nonzero(wrong))
    when = "" if times is None else f" at {float(times[k])!r} s"
    raise StandoffError(
        f"{argument}: {joint_of(robot, i)} is {float(q[k, i])!r}{when}, outside its limits "
        f"{float(lower[i])!r} to {float(upper[i])!r}: keep to them, or give the model wider ones.",
        argument,
        q[k],
    )


def joint_of(robot: RobotModel, i: int) -> str:
    """The joint that a number of a configuration is of, as a message names it."""
    joints = robot.joints
    return f"joint {joints.names[joints.owner(i)]!r} (q[{i}])"
