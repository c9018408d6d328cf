"""``standoff check part.step``: what reading a CAD file found about its parts."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from standoff import __version__
from standoff.cad.files import ENDINGS
from standoff.cli.arguments import CheckCommand
from standoff.cli.errors import CommandError, ExitCode
from standoff.cli.facts import json_text
from standoff.cli.terminal import tell
from standoff.errors import StandoffError


def is_cad_file(what: str) -> bool:
    """Does an argument name a CAD file?"""
    return Path(what).suffix.lower() in ENDINGS


def run_check_cad(command: CheckCommand) -> int:
    """Report every part, refused ones too.

    Raises
    ------
    CommandError
        If the file can't be read, has no readable part, or an option does not belong to it.
    """
    if command.plot is not None or command.body is not None:
        raise CommandError("--plot and --body: for a scene or a body, not for a CAD file")
    try:
        from standoff.cad import read_cad

        assembly = read_cad(Path(command.what), keep="readable")
    except (StandoffError, OSError, ModuleNotFoundError) as error:
        raise CommandError(str(error)) from error
    if not command.json:
        tell(assembly.report())
        return ExitCode.DONE
    parts: list[dict[str, Any]] = [
        {
            "name": part.name,
            "pose": part.pose.tolist(),
            "colour": part.colour,
            "report": asdict(part.report),
        }
        for part in assembly
    ]
    facts = {
        "standoff": __version__,
        "file": command.what,
        "length_unit": assembly.unit,
        "file_unit": assembly.file_unit,
        "parts": parts,
        "left_out": list(assembly.refusals),
    }
    tell(json_text(facts))
    return ExitCode.DONE
