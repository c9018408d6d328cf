"""``standoff certify``: a joint path proven to keep a clearance, or where it does not."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from standoff import __version__
from standoff.bodies.plain_data import plain
from standoff.checks.names import did_you_mean
from standoff.checks.real_numbers import shown
from standoff.cli.arguments import CertifyCommand
from standoff.cli.errors import CommandError, ExitCode, MissingExtra
from standoff.cli.facts import json_text
from standoff.cli.output import (
    PLOT_ENDINGS,
    Writer,
    check_target,
    kind_of_picture,
    write_whole,
)
from standoff.cli.progress import progress_bar
from standoff.cli.robot_model import robot_of
from standoff.cli.terminal import tell
from standoff.errors import StandoffError
from standoff.robots.certify_tolerances import ASKED_CLEARANCE
from standoff.robots.model_files import among
from standoff.robots.proof import How, PathProof
from standoff.robots.robot import Robot
from standoff.robots.robot_model import RobotModel
from standoff.scene import load_scene
from standoff.typing import Array
from standoff.wording import at_least, counted

MOST_SPANS = 8
"""Undecided spans that are printed; the JSON has all."""


def run_certify(command: CertifyCommand) -> int:
    """Print what is proven of a path; the exit code says whether it is all of it.

    Raises CommandError, SceneError: the model, the path, an option or a file is not usable. Raises
    WriteError: the files could not be written after all.
    """
    _check_files(command)
    robot = _among(robot_of(command.model, command.robot), command.obstacles)
    table = load_table(command.path, robot)
    proof = _proof(command, robot, table)
    files = _files(command, robot, proof)
    write_whole(files)
    facts = _facts(command, robot, table) | proof.as_dict()
    if command.json:
        tell(json_text(facts | {"files": [str(path) for path in files]}))
    else:
        for line in _lines(command, robot, table, proof, list(files)):
            tell(line)
    return ExitCode.DONE if proof else ExitCode.NOT_CERTIFIED


def _check_files(command: CertifyCommand) -> None:
    """Refuse files that could not be written, and import what draws them."""
    if command.output is not None:
        check_target(command.output, "-o", (".json",))
    if command.plot is not None:
        check_target(command.plot, "--plot", PLOT_ENDINGS)
        try:
            import standoff.robots.proof_plot  # noqa: F401
        except ModuleNotFoundError as error:
            raise MissingExtra(str(error.name)) from error


def _among(robot: Robot, scene: Path | None) -> Robot:
    """The robot among the bodies of a scene, where they are at its start."""
    return robot if scene is None else among(robot, load_scene(scene))


def _proof(command: CertifyCommand, robot: Robot, table: JointTable) -> PathProof:
    try:
        with progress_bar("proving") as progress:
            return robot.certify(
                table.waypoints,
                ASKED_CLEARANCE if command.clearance is None else command.clearance,
                times=table.times,
                max_steps=command.max_steps,
                progress=progress,
            )
    except StandoffError as error:
        option = {"clearance": "--clearance", "max_steps": "--max-steps"}.get(error.argument)
        where = str(command.path) if option is None else option
        raise CommandError(f"{where}: {error}") from error


def _facts(command: CertifyCommand, robot: Robot, table: JointTable) -> dict[str, Any]:
    return {
        "standoff": __version__,
        "model": command.model.name,
        "path": command.path.name,
        "waypoints": len(table.waypoints),
        "pairs_watched": len(robot.pairs),
    }


def _files(command: CertifyCommand, robot: Robot, proof: PathProof) -> dict[Path, Writer]:
    files: dict[Path, Writer] = {}
    if command.output is not None:
        steps = plain(proof.steps._asdict())
        steps["how"] = [How(number).name for number in steps["how"]]
        text = json_text({"standoff": __version__} | proof.as_dict() | {"steps": steps})
        files[command.output] = lambda file: file.write(text.encode())
    if command.plot is not None:
        from standoff.robots.proof_plot import proof_figure

        figure = proof_figure(proof, title=f"{command.path.stem} of {robot.loaded.source}")
        ending = kind_of_picture(command.plot)
        files[command.plot] = lambda file: figure.savefig(file, format=ending)
    return files


def _lines(
    command: CertifyCommand,
    robot: Robot,
    table: JointTable,
    proof: PathProof,
    written: list[Path],
) -> list[str]:
    span = f"{proof.start:g} to {proof.end:g} s"
    lines = [
        f"robot     {robot.loaded.source}: {counted(len(robot.pairs), 'pair')}",
        f"path      {command.path.name}: {counted(len(table.waypoints), 'waypoint')}, {span}",
        f"verdict   {proof.verdict.name}",
        f"clearance {proof.clearance:g} asked for",
    ]
    if proof:
        lines.append(f"proven    no pair comes nearer than {at_least(proof.proven)} at any instant")
    else:
        lines.append(f"proven    until {proof.time:.9g} s")
    if proof.witness is not None:
        (a, b), (link_a, link_b) = proof.witness.names, proof.witness.links
        at = proof.time if np.isnan(proof.latest) else proof.latest
        lines += [
            f"pair      {a} ({link_a}) - {b} ({link_b})",
            f"          {proof.witness.distance:.9g} apart at {at:.9g} s",
            "q         " + " ".join(f"{number:.9g}" for number in proof.witness.q),
        ]
        lines += [f"undecided {span}" for span in proof.undecided[:MOST_SPANS]]
        if len(proof.undecided) > MOST_SPANS:
            lines.append(f"          and {len(proof.undecided) - MOST_SPANS} more")
        lines.append(f"advice    {proof.verdict.advice}")
    counts = proof.counts
    lines.append(
        f"took      {counted(counts.steps, 'step')}, "
        f"{counted(counts.configurations, 'configuration')}, {counted(counts.queries, 'distance')}"
    )
    return lines + [f"written   {path}" for path in written]


# Joint paths in files: comma-separated waypoints, a row each.

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
