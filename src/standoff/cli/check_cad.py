"""``standoff check part.step``: what reading a CAD file found about its parts."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from standoff import __version__
from standoff.cli.arguments import CheckCommand
from standoff.cli.errors import CommandError, ExitCode, MissingExtra
from standoff.cli.option_groups import READ_AS_IT_IS, CadFlags
from standoff.cli.output import Writer, kind_of_picture, picture_targets, write_whole
from standoff.cli.terminal import tell
from standoff.errors import StandoffError

if TYPE_CHECKING:
    from standoff.cad import Part

MOST_NAMED = 8
"""Parts that a message names."""


def no_cad_file(what: object, flags: CadFlags) -> None:
    """Raise CommandError if options that are for CAD files are given with another one."""
    if flags != READ_AS_IT_IS:
        raise CommandError(
            f"--tolerance and --heal: they are for CAD files, and {what} is none; of a scene's "
            "parts, give them as keys of the body"
        )


def run_check_cad(command: CheckCommand) -> int:
    """Report every part, refused ones too.

    Raises CommandError if the file can't be read, has no readable part, or none of the name asked
    for. Raises WriteError if a picture could not be written.
    """
    if command.meshes.hulls or command.meshes.pieces:
        from standoff.cli.part_file import check_meshes

        check_meshes(Path(command.what), command.meshes)
    try:
        from standoff.cad import read_cad

        how = asdict(command.cad) | {"workers": command.workers}
        assembly = read_cad(Path(command.what), keep="readable", **how)
    except (StandoffError, OSError, ModuleNotFoundError) as error:
        raise CommandError(str(error)) from error
    chosen = _chosen(list(assembly), command.body)
    files = _files(chosen, command.plot, assembly.unit)
    write_whole(files)
    if not command.json:
        if command.body is None:
            tell(assembly.report())
        else:
            for part in chosen:
                tell("\n".join(part.report.lines(assembly.unit)))
        for target in files:
            tell(f"wrote {target}")
        return ExitCode.DONE
    from standoff.cli.facts import json_text

    parts: list[dict[str, Any]] = [
        {
            "name": part.name,
            "pose": part.pose.tolist(),
            "colour": part.colour,
            "report": asdict(part.report),
        }
        for part in chosen
    ]
    facts = {
        "standoff": __version__,
        "file": command.what,
        "length_unit": assembly.unit,
        "file_unit": assembly.file_unit,
        "parts": parts,
        "left_out": list(assembly.refusals),
        "files": [str(target) for target in files],
    }
    tell(json_text(facts))
    return ExitCode.DONE


def _chosen(parts: list[Part], name: str | None) -> list[Part]:
    """The parts of a name, or all."""
    found = [part for part in parts if name is None or part.name == name]
    if not found:
        known = ", ".join(part.name for part in parts[:MOST_NAMED])
        dots = ", ..." if len(parts) > MOST_NAMED else ""
        raise CommandError(f"--body {name}: no such part; there are {known}{dots}")
    return found


def _files(parts: list[Part], plot: Path | None, unit: str) -> dict[Path, Writer]:
    """A picture for each solid, under the name of its first instance."""
    if plot is None:
        return {}
    try:
        from standoff.solids.drawing.spatial_picture import solid_figure
    except ModuleNotFoundError as error:
        raise MissingExtra(str(error.name)) from error
    shapes = {id(part.shape): part for part in reversed(parts)}
    drawn = list(shapes.values())[::-1]

    def writer(part: Part, ending: str) -> Writer:
        def write(file: BinaryIO) -> None:
            solid_figure(part.shape, part.name, unit).savefig(file, format=ending)

        return write

    targets = picture_targets(plot, [part.name for part in drawn])
    return {
        target: writer(part, kind_of_picture(target))
        for target, part in zip(targets, drawn, strict=True)
    }
