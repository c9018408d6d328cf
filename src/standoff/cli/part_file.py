"""DXF drawings and files of meshes as arguments of commands."""

from __future__ import annotations

from pathlib import Path

from standoff.cad.files import ENDINGS as CAD
from standoff.cli.errors import CommandError
from standoff.cli.option_groups import MeshFlags
from standoff.errors import StandoffError
from standoff.scene.files import file_problem
from standoff.scene.part_files import ENDINGS, MESHES, FileParts, file_parts

OPTIONS = {"Give hull = true": "Give --hulls", "pieces = true": "--pieces"}
"""What messages say to do, as commands say it."""


def is_part_file(name: str | Path) -> bool:
    """Does its ending say that it is a drawing or of meshes?"""
    ending = Path(name).suffix.lower()
    return ending in ENDINGS and ending not in CAD


def parts_of(path: Path, meshes: MeshFlags) -> FileParts:
    """The parts of a file, with lengths in mm where it tells their unit.

    Raises CommandError: a file that is missing or refused, options that do not fit it, a package
    that is missing.
    """
    problem = file_problem(path, str(path), "the current folder")
    if problem is not None:
        raise CommandError(problem)
    check_meshes(path, meshes)
    try:
        return file_parts(
            path, instead="hull" if meshes.hulls else "pieces" if meshes.pieces else ""
        )
    except (StandoffError, OSError, ImportError) as error:
        message = str(error)
        for key, option in OPTIONS.items():
            message = message.replace(key, option)
        raise CommandError(message) from error


def check_meshes(path: Path, meshes: MeshFlags) -> None:
    """Refuse options of meshes for another file, and both at once.

    Raises CommandError.
    """
    if meshes.hulls and meshes.pieces:
        raise CommandError("--hulls and --pieces: give one of them")
    if (meshes.hulls or meshes.pieces) and path.suffix.lower() not in MESHES:
        option = "--hulls" if meshes.hulls else "--pieces"
        raise CommandError(f"{option}: is for files of meshes ({', '.join(MESHES)})")
