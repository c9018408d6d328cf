"""``standoff robot``: what became of a robot model's geometries, and its nearest pair."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff import __version__
from standoff.checks.real_numbers import shown
from standoff.cli.arguments import RobotCommand
from standoff.cli.errors import CommandError, ExitCode
from standoff.cli.facts import json_text
from standoff.cli.robot_model import robot_of
from standoff.cli.terminal import tell
from standoff.errors import StandoffError
from standoff.robots.answer import RobotAnswer
from standoff.robots.robot import Robot
from standoff.wording import at_least


def run_robot(command: RobotCommand) -> int:
    """Print the nearest pair at a configuration, and the report if it is asked for.

    Raises CommandError: the model, an option or the configuration is not usable.
    """
    robot = robot_of(command.model, command.robot)
    q = robot.kinematics.neutral() if command.q is None else _numbers(command.q)
    try:
        nearest = robot.clearance(q) if robot.pairs else None
        outside = robot.outside(q)
    except StandoffError as error:
        raise CommandError(f"--q: {error}") from error
    if command.json:
        tell(json_text(_facts(command, robot, nearest, outside)))
    else:
        for line in _lines(command, robot, nearest, outside):
            tell(line)
    certified = nearest is None or nearest.certified
    return ExitCode.DONE if certified else ExitCode.NOT_CERTIFIED


def _numbers(text: str) -> Any:
    try:
        return np.array([float(part) for part in text.replace(",", " ").split()])
    except ValueError as error:
        raise CommandError(f"--q: give numbers, such as '0 0.5 -1', not {shown(text)}") from error


def _lines(
    command: RobotCommand, robot: Robot, nearest: RobotAnswer | None, outside: tuple[str, ...]
) -> list[str]:
    report = robot.report()
    lines = str(report).splitlines() if command.report else str(report).splitlines()[:1]
    if command.report:
        lines += [f"pair: {a} - {b}" for a, b in report.pairs]
    where = "the model's own zero" if command.q is None else "q"
    lines += [f"at {where}, {name} is outside its limits" for name in outside]
    if nearest is None:
        return [*lines, "no pair is watched: there is no clearance"]
    (a, b), (link_a, link_b) = nearest.names, nearest.links
    return [
        *lines,
        f"nearest at {where}: {a} ({link_a}) - {b} ({link_b}), {nearest.distance:.9g}",
        f"proven for all pairs: {at_least(nearest.clearance, 9)}",
    ]


def _facts(
    command: RobotCommand, robot: Robot, nearest: RobotAnswer | None, outside: tuple[str, ...]
) -> dict[str, Any]:
    report = robot.report()
    facts = {
        "standoff": __version__,
        "model": command.model.name,
        "nq": robot.nq,
        "nv": robot.nv,
        "joints": list(report.joints),
        "pairs_watched": len(report.pairs),
        "outside_limits": list(outside),
        "nearest": None if nearest is None else nearest.as_dict(),
    }
    if command.report:
        facts["geometries"] = [geom._asdict() for geom in report.geoms]
        facts["pairs"] = [list(pair) for pair in report.pairs]
        facts["notes"] = list(report.notes)
    return facts
