"""``standoff clearance ASSEMBLY.step``: what is proven of all pairs of an assembly's parts."""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from standoff.cad import common_volumes, read_cad
from standoff.checks.units import conversion
from standoff.clearance.assembly import AssemblyFile
from standoff.clearance.checked_pairs import Scope, check
from standoff.clearance.facts import report_facts
from standoff.clearance.report import Instants, Report, Wanted
from standoff.clearance.verdicts import Verdict
from standoff.cli.arguments import ClearanceCommand
from standoff.cli.check_cad import no_cad_file
from standoff.cli.clearance_files import check_files, files_of
from standoff.cli.clearance_lines import print_report
from standoff.cli.clearance_options import option_error, scope_of, wanted_by
from standoff.cli.errors import CommandError, ExitCode
from standoff.cli.facts import json_text
from standoff.cli.output import write_whole
from standoff.cli.part_file import is_part_file, parts_of
from standoff.cli.progress import progress_bar
from standoff.cli.terminal import tell
from standoff.errors import StandoffError
from standoff.motion import Pose
from standoff.version import __version__
from standoff.world import World

NOTHING_MOVES = Instants(0.0, 0.0, 1)


def run_on_assembly(command: ClearanceCommand) -> int:
    """Print the clearance of all pairs of parts; the exit code as for a scene.

    Raises CommandError if the file or an option is not usable. Raises WriteError if the files could
    not be written after all.
    """
    if command.motion or command.time is not None:
        raise CommandError("--time and --motion: the parts of an assembly's file are at rest")
    wanted = wanted_by(command)
    check_files(command)
    if is_part_file(command.scene):
        no_cad_file(command.scene, command.cad)
        file, parts = _read_parts(command)
    else:
        file, parts, _solids = _read(command)  # the world finds these as long as they are here
    report = _report(file, parts, wanted, scope_of(command))
    if command.volume:
        report = with_volumes(file, report)
    write_whole(files_of(command, file, report, NOTHING_MOVES))
    written = [path for path in (command.files.page, command.files.plot) if path is not None]
    if command.report.json:
        tell(json_text(_facts(file, report, written)))
    else:
        listed = None if command.report.verbose else scope_of(command).closest
        print_report(file, report, NOTHING_MOVES, written, listed)
    return ExitCode.NOT_CERTIFIED if report.failures else ExitCode.DONE


def _report(file: AssemblyFile, parts: dict[str, Any], wanted: Wanted, scope: Scope) -> Report:
    try:
        world = World(parts)
        with progress_bar("distances of pairs") as progress:
            return check(world, file.poses(world, 0.0), wanted, scope, progress=progress)
    except StandoffError as error:
        raise option_error(error) or CommandError(str(error)) from error


def _read_parts(command: ClearanceCommand) -> tuple[AssemblyFile, dict[str, Any]]:
    """A file of a drawing or of meshes, and its parts in their own frames."""
    read = parts_of(command.scene, command.meshes)
    places = {name: part.pose for name, part in read.found.items()}
    parts = {name: part.shape for name, part in read.found.items()}
    return AssemblyFile(command.scene, command.scene.name, read.unit, read.notes, places), parts


def _read(command: ClearanceCommand) -> tuple[AssemblyFile, dict[str, Any], list[Any]]:
    """A CAD file, its parts in their own frames, and their solids where some are not convex:
    beside these convex parts are asked as solids too, which the store may have."""
    try:
        assembly = read_cad(command.scene, workers=command.workers, **asdict(command.cad))
        parts = assembly.by_name
        places = {name: Pose.of(part.pose) for name, part in parts.items()}
        bodies = {name: part.body for name, part in parts.items()}
        mixed = not all(part.report.convex for part in parts.values())
        solids = [part.solid for part in parts.values()] if mixed else []
    except (StandoffError, OSError) as error:
        raise CommandError(str(error)) from error
    converted = conversion(assembly.unit, assembly.file_unit)
    notes = (f"lengths were {converted}",) if converted else ()
    colours = {name: part.colour[:3] for name, part in parts.items() if part.colour is not None}
    file = AssemblyFile(command.scene, assembly.source, assembly.unit, notes, places, colours)
    return file, bodies, solids


def with_volumes(file: AssemblyFile, report: Report) -> Report:
    """The report with the volumes that its parts have in common where they may overlap."""
    over = Verdict.OVERLAPPING, Verdict.UNDECIDED, Verdict.CONTAINED
    pairs = [row.names for row in report.rows if row.verdict in over]
    found = common_volumes(file.file, pairs, unit=file.length_unit)
    told = {names: math.nan if volume is None else volume for names, volume in found.items()}
    rows = tuple(replace(row, common=told.get(row.names)) for row in report.rows)
    return replace(report, rows=rows)


def _facts(file: AssemblyFile, report: Report, written: list[Path]) -> dict[str, Any]:
    told = {
        "standoff": __version__,
        "file": str(file.file),
        "title": file.title,
        "length_unit": file.length_unit,
        "notes": list(file.notes),
    }
    return told | report_facts(report) | {"files": [str(path) for path in written]}
