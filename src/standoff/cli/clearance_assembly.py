"""``standoff clearance ASSEMBLY.step``: what is proven of all pairs of an assembly's parts."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from standoff.cad import read_cad
from standoff.clearance.assembly import AssemblyFile
from standoff.clearance.facts import report_facts
from standoff.clearance.fits import load_fits
from standoff.clearance.report import (
    Looked,
    Report,
    Wanted,
    bounds_of,
    nearest_of,
    report_on,
)
from standoff.cli.arguments import ClearanceCommand
from standoff.cli.clearance_lines import print_report
from standoff.cli.errors import CommandError, ExitCode
from standoff.cli.facts import json_text
from standoff.cli.output import Writer, kind_of_picture, write_whole
from standoff.cli.progress import progress_bar
from standoff.cli.terminal import tell
from standoff.errors import StandoffError
from standoff.motion import Pose
from standoff.version import __version__
from standoff.world import World

NOTHING_MOVES = Looked(0.0, 0.0, 1)


def run_on_assembly(command: ClearanceCommand, wanted_files: Any) -> int:
    """Print the clearance of all pairs of parts; the exit code as for a scene.

    Raises
    ------
    CommandError
        If the file or an option is not usable.
    WriteError
        If the files could not be written after all.
    """
    if command.motion or command.time is not None:
        raise CommandError("--time and --motion: the parts of an assembly's file are at rest")
    wanted = Wanted(command.min, None if command.allow is None else load_fits(command.allow))
    wanted_files(command)
    file, parts = _read(command.scene)
    within = math.inf if command.within is None else command.within
    if command.min is not None:
        within = max(within, command.min)
    report = _report(file, parts, within, wanted)
    write_whole(_files(command, file, report))
    written = [path for path in (command.files.page, command.files.plot) if path is not None]
    if command.report.json:
        tell(json_text(_facts(file, report, written)))
    else:
        print_report(file, report, NOTHING_MOVES, written, verbose=command.report.verbose)
    holds = report.certified and not report.failures
    return ExitCode.DONE if holds else ExitCode.NOT_CERTIFIED


def _report(file: AssemblyFile, parts: dict[str, Any], within: float, wanted: Wanted) -> Report:
    try:
        world = World(parts, within=within)
        with progress_bar() as progress:
            answer = world.distances(file.poses(world, 0.0), progress)
    except StandoffError as error:
        raise CommandError(str(error)) from error
    near = nearest_of(answer, 0.0)
    return report_on(world, near, bounds_of(world, answer, near), wanted)


def _read(path: Path) -> tuple[AssemblyFile, dict[str, Any]]:
    """The file, and the parts in their own frames."""
    try:
        assembly = read_cad(path)
        parts = assembly.by_name
        places = {name: Pose.of(part.pose) for name, part in parts.items()}
    except (StandoffError, OSError) as error:
        raise CommandError(str(error)) from error
    if assembly.file_unit and assembly.file_unit != assembly.unit:
        notes: tuple[str, ...] = (f"lengths were converted from {assembly.file_unit}",)
    else:
        notes = ()
    file = AssemblyFile(path, assembly.source, assembly.unit, notes, places)
    return file, {name: part.shape for name, part in parts.items()}


def _files(command: ClearanceCommand, told: AssemblyFile, report: Report) -> dict[Path, Writer]:
    files: dict[Path, Writer] = {}
    page, plot = command.files.page, command.files.plot
    if page is not None:
        from standoff.clearance.page import page_of

        text = page_of(told, report, NOTHING_MOVES)
        files[page] = lambda file: file.write(text.encode())
    if plot is not None:
        from standoff.clearance.matrix import matrix_figure

        figure = matrix_figure(report, told.title, told.length_unit)
        ending = kind_of_picture(plot)
        files[plot] = lambda file: figure.savefig(file, format=ending)
    return files


def _facts(file: AssemblyFile, report: Report, written: list[Path]) -> dict[str, Any]:
    told = {
        "standoff": __version__,
        "file": str(file.file),
        "title": file.title,
        "length_unit": file.length_unit,
        "notes": list(file.notes),
    }
    return told | report_facts(report) | {"files": [str(path) for path in written]}
