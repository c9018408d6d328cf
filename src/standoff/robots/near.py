"""The near pairs of a robot, from one configuration to the next."""

from __future__ import annotations

import math
from typing import Any

from standoff.checks.numbers import positive
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.robots.robot import Robot
from standoff.robots.rows import RobotRows
from standoff.robots.state import RobotState


class NearLinks:
    """What a controller asks again and again: the rows within a horizon, warm.

    Attributes
    ----------
    robot : Robot
        With the horizon.
    """

    def __init__(self, robot: Robot, minimum: float, within: float | None) -> None:
        """`minimum`: what the horizon must be greater than, length.

        Raises StandoffTypeError, StandoffError.
        """
        check_robot(robot)
        horizon = robot.within if within is None else positive(within, "within", infinite=True)
        if horizon <= minimum:
            raise StandoffError(
                f"within = {horizon}: pairs must be seen before they are at the minimum of "
                f"{minimum}; give a greater horizon.",
                "within",
                within,
            )
        if horizon != robot.within:
            own = None if horizon == math.inf else horizon
            robot = Robot(robot.loaded, within=own, obstacles=robot.obstacles)
        self.robot = robot
        self._state: RobotState | None = None

    def rows(self, q: Any) -> RobotRows:
        """All pairs within the horizon at a configuration (nq,)."""
        if self._state is None:
            self._state = self.robot.start(q)
            return self.robot.rows(self._state)
        self._state, found = self.robot.step(self._state, q)
        return found

    def check_model(self, model: Any) -> None:
        """Refuse a model whose configurations are not the robot's.

        Raises StandoffError.
        """
        robot = self.robot
        if (model.nq, model.nv) != (robot.nq, robot.nv):
            raise StandoffError(
                f"The configuration is that of a model with nq {model.nq} and nv {model.nv}, the "
                f"robot has nq {robot.nq} and nv {robot.nv}: make the robot of the same model.",
                "configuration",
            )


def check_robot(robot: Any) -> None:
    """Refuse what is no robot.

    Raises StandoffTypeError.
    """
    if not isinstance(robot, Robot):
        raise StandoffTypeError(
            f"robot = {shown(robot)}: give a so.Robot, as so.Robot.from_mujoco(model) makes.",
            "robot",
            robot,
        )
