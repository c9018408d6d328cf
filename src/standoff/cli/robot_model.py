"""A robot from the arguments of a command."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from standoff.cli.errors import CommandError
from standoff.errors import StandoffError

if TYPE_CHECKING:
    from standoff.cli.option_groups import RobotFlags
    from standoff.robots.robot import Robot

OPTIONS = {
    "meshes='hull'": "--hulls",
    ", or meshes={name: a body}": "",
    "mimic=True": "--mimic follow",
    "mimic=False": "--mimic free",
    "skip=[name]": "--skip NAME",
}
"""What the library's messages say to do, as this command says it."""

OF_URDF = ("srdf", "packages", "free_base")


def robot_of(model: Any, flags: RobotFlags, *, within: float | None = None) -> Robot:
    """The robot of an MJCF file (.xml, .mjcf) or of a URDF file (.urdf).

    Raises CommandError: the file is not there or not usable, an option does not fit it, or its
    package is missing.
    """
    from standoff.robots.model_files import ModelOptions, robot_of_file

    options = ModelOptions(
        hulls=flags.hulls,
        skip=flags.skip,
        srdf=flags.srdf,
        packages=flags.packages,
        free_base=flags.free_base,
        mimic=flags.mimic,
    )
    try:
        return robot_of_file(model, options, within=within)
    except StandoffError as error:
        option = f"--{error.argument.replace('_', '-')}: " if error.argument in OF_URDF else ""
        raise CommandError(_as_options(f"{option}{error}")) from error
    except (FileNotFoundError, ModuleNotFoundError) as error:
        raise CommandError(_as_options(str(error))) from error


def _as_options(message: str) -> str:
    """A message whose fixes are those of the command line."""
    for argument, option in OPTIONS.items():
        message = message.replace(argument, option)
    return message
