"""The MuJoCo model of a robot, and the numbers that the robot's geometries and pairs have."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from standoff.errors import StandoffError
from standoff.robots.mujoco import MujocoKinematics
from standoff.robots.robot import Robot


def model_of(robot: Robot) -> tuple[Any, list[int]]:
    """The MuJoCo model of a robot, and the number in it of each of the robot's geometries.

    Raises StandoffError.
    """
    if not isinstance(robot.kinematics, MujocoKinematics):
        raise StandoffError(
            f"The robot is one of {robot.loaded.source}: make it by so.Robot.from_mujoco.", "robot"
        )
    if robot.obstacles:
        raise StandoffError(
            f"The obstacles {', '.join(robot.obstacles)} are no geoms of the MuJoCo model, and "
            "nothing of it can touch them: write them into the model.",
            "robot",
        )
    at = {report.name: k for k, report in enumerate(robot.loaded.reports)}
    return robot.kinematics.model, [at[name] for name in robot.geoms.names]


def watched(robot: Robot, pairs: Sequence[tuple[str, str]]) -> list[tuple[int, int]]:
    """Numbers i < j of the robot's geometries, of pairs given by names.

    Raises StandoffError: a pair that the robot does not watch.
    """
    names = robot.geoms.names
    known = {frozenset(pair) for pair in robot.pairs}
    found = []
    for pair in pairs:
        if frozenset(pair) not in known:
            raise StandoffError(
                f"The robot does not watch the pair {tuple(pair)}: robot.pairs has those that it "
                "does.",
                "pairs",
                pair,
            )
        i, j = sorted(names.index(name) for name in pair)
        found.append((i, j))
    return found
