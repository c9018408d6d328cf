"""Joint paths in files: comma-separated waypoints, a row each."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import NamedTuple

import numpy as np

from standoff.checks.names import did_you_mean
from standoff.checks.real_numbers import shown
from standoff.cli.errors import CommandError
from standoff.robots.robot_model import RobotModel
from standoff.typing import Array
from standoff.wording import counted

TIMES = ("time", "t")
"""What the column of the times may be called."""


class JointTable(NamedTuple):
    """A path as its file gives it.

    Attributes
    ----------
    waypoints : (n, nq) array
    times : (n,) array or None
        [s]
    """

    waypoints: Array
    times: Array | None


def load_table(file: Path, robot: RobotModel) -> JointTable:
    """Read waypoints: numbers of q in their order, or columns named as the joints; with times if
    the first row names a column time or t.

    Raises CommandError: the file is not there, not text, has no rows, rows of another length, words
    for numbers, or names that no joint has.
    """
    try:
        text = file.read_text("utf-8-sig")
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is no text"
        raise CommandError(f"{file}: cannot be read ({reason})") from error
    rows = [(k, row) for k, row in enumerate(csv.reader(text.splitlines()), 1) if any(row)]
    rows = [(k, row) for k, row in rows if not row[0].lstrip().startswith("#")]
    if not rows:
        raise CommandError(f"{file}: has no rows; give waypoints, a row of numbers each")
    names: list[str] | None = None
    if not _is_number(rows[0][1][0]):
        names = [name.strip() for name in rows[0][1]]
        rows = rows[1:]
    width = len(names) if names is not None else robot.nq
    numbers = np.array([_numbers(file, k, row, width) for k, row in rows]).reshape(-1, width)
    if names is None:
        return JointTable(numbers, None)
    return _named(file, robot, names, numbers)


def _named(file: Path, robot: RobotModel, names: list[str], numbers: Array) -> JointTable:
    """Columns in the order of q."""
    times = None
    if names[0].casefold() in TIMES:
        times, names, numbers = numbers[:, 0], names[1:], numbers[:, 1:]
    if names == [f"q{k}" for k in range(robot.nq)] or not any(names):
        known = {name: k for k, name in enumerate(names)}
    else:
        known = _columns(robot)
    for name in names:
        if name not in known:
            raise CommandError(
                f"{file}: the robot has no joint {name!r}.{did_you_mean(name, known)}"
                f" Its columns are {', '.join(known)}"
            )
    twice = [name for name in names if names.count(name) > 1]
    missing = [name for name in known if name not in names]
    if twice or missing:
        what = f"{twice[0]!r} twice" if twice else f"no column {missing[0]!r}"
        raise CommandError(f"{file}: has {what}; give each of {', '.join(known)} once")
    found = np.empty_like(numbers)
    found[:, [known[name] for name in names]] = numbers
    return JointTable(found, times)


def _columns(robot: RobotModel) -> dict[str, int]:
    """Names of the numbers of q: the joint's, with a number behind where it has several."""
    joints = robot.joints
    starts = sorted({int(at) for at in joints.q_at})
    ends = [*starts[1:], robot.nq]
    found: dict[str, int] = {}
    for at, end in zip(starts, ends, strict=True):
        name = joints.names[joints.owner(at)]
        for k in range(at, end):
            found[name if end - at == 1 else f"{name}.{k - at}"] = k
    return found


def _numbers(file: Path, k: int, row: list[str], width: int) -> list[float]:
    if len(row) != width:
        raise CommandError(
            f"{file}, line {k}: has {counted(len(row), 'column')}, but {width} are asked for"
        )
    for text in row:
        if not _is_number(text):
            raise CommandError(f"{file}, line {k}: {shown(text.strip())} is not a number")
    return [float(text) for text in row]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
