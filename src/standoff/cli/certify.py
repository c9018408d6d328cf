"""``standoff certify``: a joint path proven to keep a clearance, or where it does not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from standoff import __version__
from standoff.bodies.plain_data import plain
from standoff.cli.arguments import CertifyCommand
from standoff.cli.errors import CommandError, ExitCode, MissingExtra
from standoff.cli.facts import json_text
from standoff.cli.joint_table import JointTable, load_table
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
from standoff.scene import load_scene
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
